//! The sections of a docstring that numpydoc reads: a line of source for each parameter, and one place for the words of those that many have.
//!
//! Implements: PYT-051.

/// `sections!(name: "type, shape" = "Meaning, unit.", shared; "type" = "What is given."; "What is refused.")`; either of the last two
/// may be missing, and `shared` is a name that [`parameter`] has words for.
macro_rules! sections {
    ($($name:ident $(: $kind:literal = $text:literal)?),+; $($given:literal = $of:literal)?; $($refused:literal)?) => {
        concat!(
            "\nParameters\n----------\n", $(parameter!($name $(: $kind = $text)?)),+
            $(, "\nReturns\n-------\n", $given, "\n    ", $of, "\n")?
            $(, "\nRaises\n------\nRefused\n    ", $refused, "\n")?
        )
    };
}

/// What is said of a parameter; without words those that it has everywhere. `own_` is of a record that may do without.
macro_rules! parameter {
    ($name:ident: $kind:literal = $text:literal) => { concat!(stringify!($name), " : ", $kind, "\n    ", $text, "\n") };
    (edits) => { "**edits : float or str\n    Numbers by the names of the phantom file behind that of their table, mm and kPa.\n" };
    (arguments) => { "**arguments : lists, arrays, numbers or texts\n    Those of the operation, by name, in SI.\n" };
    (path) => { parameter!(path: "str or PathLike" = "The file.") };
    (text) => { parameter!(text: "str" = "The JSON text.") };
    (ax) => { parameter!(ax: "matplotlib Axes, optional" = "Where to draw; by default Matplotlib's current axes.") };
    (mesh_mm) => { parameter!(mesh_mm: "float, optional" = "Mesh size, to which all elements are in proportion, mm; 0.5 gives about 10,000 nodes.") };
    (contact) => { parameter!(contact: "str, optional" = "The contact law, \"deformed-normal\" or \"vertical-gap\".") };
    (progress) => { parameter!(progress: "callable, optional" = "Called with how much is done and how much there is; what it raises stops the call and is raised.") };
    (depth_mm) => { parameter!(depth_mm: "float" = "Depth of the probe, mm.") };
    (own_lateral_mm) => { parameter!(lateral_mm: "float, optional" = "Lateral position of the probe, mm.") };
    (lateral_mm) => { parameter!(lateral_mm: "float" = "Lateral position of the probe, mm.") };
    (noise_sd_n) => { parameter!(noise_sd_n: "float or (float, float)" = "Standard deviation of a sample, of both channels or (lateral, normal), N.") };
    (f0) => { parameter!(f0: "array_like, shape (2, n)" = "Forces expected without an inclusion, N.") };
    (f1) => { parameter!(f1: "array_like, shape (2, n)" = "Forces expected with the inclusion, N.") };
    (level) => { parameter!(level: "str, optional" = "Size of the noise: \"known\", or \"unknown\" where the record tells it.") };
    (prior) => { parameter!(prior: "array_like, shape (maps,), optional" = "Probability of each map given an inclusion, no unit; by default all alike.") };
    (prior_h1) => { parameter!(prior_h1: "float or array_like" = "Probability of an inclusion before the record.") };
    (own_prior_h1) => { parameter!(prior_h1: "float, optional" = "Probability of an inclusion before the record.") };
    (positions_mm) => { parameter!(positions_mm: "array_like, shape (n,)" = "Lateral positions of the samples, mm.") };
    (forces_n) => { parameter!(forces_n: "array_like, shape (2, n) or (n,)" = "Lateral and normal forces, or normal ones alone, N.") };
    (own_noise_sd_n) => { parameter!(noise_sd_n: "float or (float, float), optional" = "As of theta, N; by default the record tells it.") };
    (zeroed) => { parameter!(zeroed: "bool, optional" = "Whether the sensor was set to zero on the gel, so that \"no inclusion\" is never the answer.") };
    (own_depths_mm) => { parameter!(depths_mm: "array_like, shape (n,), optional" = "Depth of each sample, in the order of time, mm, for a bank of several depths.") };
    (theta) => { parameter!(theta: "float or array_like" = "The log-likelihood ratio.") };
    (eta) => { parameter!(eta: "float or array_like" = "The threshold of theta.") };
    (gamma) => { parameter!(gamma: "float or array_like" = "The signal-to-noise ratio, d' of signal detection theory.") };
    (p_correct) => { parameter!(p_correct: "float or array_like" = "Share of right answers, 0 to 1.") };
    (false_alarm) => { parameter!(false_alarm: "float or array_like" = "The rate of false alarms.") };
    (c00) => { parameter!(c00: "float or array_like" = "Cost of a right \"no inclusion\", in any one unit.") };
    (c01) => { parameter!(c01: "float or array_like" = "Cost of a miss, in that unit.") };
    (c10) => { parameter!(c10: "float or array_like" = "Cost of a false alarm, in that unit.") };
    (c11) => { parameter!(c11: "float or array_like" = "Cost of a hit, in that unit.") };
    (max_miss) => { parameter!(max_miss: "float or array_like" = "The largest rate of misses.") };
    (max_false_alarm) => { parameter!(max_false_alarm: "float or array_like" = "The largest rate of false alarms.") };
    (own_max_miss) => { parameter!(max_miss: "float, optional" = "The largest rate of misses.") };
    (own_max_false_alarm) => { parameter!(max_false_alarm: "float, optional" = "The largest rate of false alarms.") };
}

//! The numbers that the paper prints, each with its place.

use palpate::phantom::{BUILTIN_NAMES, Phantom, PhantomParts};

pub use crate::psychophysics::FEM_PLAYBACK;
// Table 2, and what §5 infers from it.
pub use crate::psychophysics::noise::{
    BACKDRIVE_FRICTION, DIRECT_CONTACT_NOISE, HUMAN_PERCEPTION, PEAK_SIGNAL as PEAK_SIGNAL_6_6,
    PLAYBACK_NOISE, PRINTED_GAMMA as GAMMA_OF_ACCURACY, QUANTIZATION, SENSOR, SUBJECTS_NOISE,
    UNMODELLED_CONTACT,
};

/// "a nominal absolute force level of 1.6N" (§2), N.
pub const FORCE_LEVEL: f64 = 1.6;
/// "the force signal difference is roughly 0.5N" (§2), N.
pub const SIGNAL: f64 = 0.5;
/// "maximum 5% false alarm rate" (§2).
pub const MAX_FALSE_ALARM: f64 = 0.05;
/// "minimum 95% hit rate" (§2).
pub const MAX_MISS: f64 = 0.05;
/// "requires γ > 3.3" (§2).
pub const REQUIRED_GAMMA: f64 = 3.3;
/// "the overall noise level needs to be less than 0.5N/γ = 0.15N" (§2), N.
pub const ALLOWED_NOISE: f64 = 0.15;
/// "the human operating noise level is estimated at 0.1N" (§2), N.
pub const HUMAN_NOISE: f64 = 0.1;
/// "the haptic display must introduce less than … 0.11N" (§2), N.
pub const DISPLAY_NOISE: f64 = 0.11;
/// "playback of FEM data gave a 84% accuracy" (§5, 6.6 mm).
pub const ACCURACY_6_6: f64 = 0.84;
/// "the standard deviation in the error of the force is roughly 0.024N" (§4), N; not in Table 2.
pub const DISPLAY_ERROR: f64 = 0.024;

/// The rows of Table 2, N.
pub const NOISE_SOURCES: [(&str, f64); 5] = [
    ("Sensor (ATI)", SENSOR),
    ("Actuation quantization (Immersion)", QUANTIZATION),
    (
        "Actuation backdrive friction (Immersion)",
        BACKDRIVE_FRICTION,
    ),
    (
        "Unmodelled direct contact (friction, hysteresis, nonlinearity, etc)",
        UNMODELLED_CONTACT,
    ),
    ("Human perception (Jones (1998))", HUMAN_PERCEPTION),
];

/// Pairs that each subject judged at each depth in each experiment (§4).
pub const TRIALS: u32 = 30;
/// The four phantoms with inclusion, by the names of [`BUILTIN_NAMES`]: the columns of Table 1.
pub const INCLUSIONS: [&str; 4] = ["2.6", "4.6", "6.6", "8.6"];

/// The means that Table 1 prints below each condition, right answers in [`TRIALS`].
pub const PRINTED_MEANS: [[f64; 4]; 3] = [
    [28.8, 27.5, 24.7, 20.0],
    [29.2, 27.7, 25.3, 18.9],
    [26.8, 22.8, 22.9, 17.4],
];

/// The parts of a phantom without the names of itself and its layers.
pub(super) fn unnamed(phantom: &Phantom) -> PhantomParts {
    let mut parts = PhantomParts::from(phantom.clone());
    parts.name.clear();
    parts.layers.iter_mut().for_each(|layer| layer.name.clear());
    parts
}

/// Which of the paper's phantoms this is, whatever it and its layers are called: geometry, materials, supports and probe
/// decide.
///
/// Implements: REP-010.
pub(super) fn name_of(phantom: &Phantom) -> Option<&'static str> {
    let is_it = |name: &&str| Phantom::builtin(name).is_ok_and(|p| unnamed(&p) == unnamed(phantom));
    BUILTIN_NAMES.into_iter().find(is_it)
}

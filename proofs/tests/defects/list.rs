//! The planted defects: plausible bugs, each a few words of the source.

use std::fs;
use std::ops::Range;
use std::path::Path;

/// A bug to plant.
#[derive(Debug, Clone)]
pub struct Defect {
    /// What it is.
    pub name: String,
    /// Where.
    pub file: String,
    /// What is replaced, which must be there once, and by what.
    pub edit: [String; 2],
    /// A harness that must fail.
    pub found_by: String,
}

/// All, by the files that they are in: what each is, and the harness; below it the words. `\n` is a line's end.
const DEFECTS: &str = r#"
=== src/core/servo/axis.rs
the cell is one too far: locate_is_total_and_in_range
`index = ahead;` becomes `index = ahead.wrapping_add(1);`
the reciprocal of the wrong cell: a_fraction_is_near_the_exact_one
`self.reciprocal_widths.get(index)` becomes `self.reciprocal_widths.get(0)`
extrapolation without a bound: locate_is_total_and_in_range
`between(fraction, -EXTRAPOLATION_CELLS, 1.0)` becomes `fraction`
=== src/core/servo/limit.rs
a NaN let through: a_limited_number_is_within_its_limit
`if value.is_nan() { 0.0 } else { value }` becomes `value`
=== src/core/servo/table.rs
the clamp to the hull left out: a_blend_is_between_its_ends
`(0.0..=1.0).contains(&t)` becomes `t.is_nan()`
the table transposed: nodes_are_exact
`wrapping_mul(columns)` becomes `wrapping_mul(self.depths.knots().len())`
the upper row twice: adjoining_cells_agree_at_any_fraction
`self.forces.get(second..)` becomes `self.forces.get(first..)`
a force above the surface: force_of_a_table_is_bounded
`if depth < 0.0 { Force::ZERO } else { force }` becomes `force`
=== src/core/servo/step.rs
a force above the surface that the step plays: no_force_unless_permitted
`playing && sample.depth >= 0.0` becomes `playing`
=== src/core/servo/table.rs
a weight squared: force_is_near_the_bilinear_form
`(1.0 - t) * a + t * b` becomes `(1.0 - t) * a + t * t * b`
=== src/core/servo/step.rs
the limit of the force left out: force_is_bounded
`let target = limit(target, limits.force());` becomes ``
=== src/core/servo/limit.rs
a rise without a limit: slew_is_limited
`size + rise` becomes `sign * target`
a fall with the wrong sign: a_released_force_is_zero_in_three_cycles_of_half_the_limit
`size - fall\n` becomes `size + fall\n`
a force that turns in one cycle: slew_is_limited
`if size > fall` becomes `if size > 0.0`
=== src/core/servo/step.rs
a played force that falls as slowly as it rises: slew_is_limited
`if held && !fresh` becomes `if held`
a rise as fast as a release: slew_is_limited
`limits.slew(), fall` becomes `limits.release(), fall`
the release forgotten: a_released_force_is_zero_in_three_cycles_of_half_the_limit
`limits.release()\n    };` becomes `limits.slew()\n    };`
the latch forgotten: fault_latches
`if arm { Mode::Armed } else { mode }` becomes `if arm { Mode::Armed } else if cause.is_none() { Mode::Disarmed } else { mode }`
a later fault takes the place of the first: fault_latches
`if arm { Mode::Armed } else { mode }` becomes `if arm { Mode::Armed } else { cause.map_or(mode, Mode::Faulted) }`
a sample that repeats accepted: no_force_unless_permitted
`(1..=MOST_AHEAD)` becomes `(0..=MOST_AHEAD)`
a sample that goes back accepted: no_force_unless_permitted
`MOST_AHEAD: u16 = 32767` becomes `MOST_AHEAD: u16 = 32768`
the deadman ignored: no_force_unless_permitted
`Armed && sample.deadman` becomes `Armed`
the watchdog off: watchdog_drops_the_force
`missed > limits.watchdog()` becomes `false`
the watchdog a cycle late: watchdog_drops_the_force
`missed > limits.watchdog()` becomes `missed > limits.watchdog() + 1`
the count of missed samples wraps: fault_latches
`missed.saturating_add(1)` becomes `missed.wrapping_add(1)`
armed by a request that sticks: arming_needs_every_condition
` && !state.arming` becomes ``
armed with the deadman held: arming_needs_every_condition
`fresh && !sample.deadman` becomes `fresh`
a stale sample taken over while armed: stale_samples_are_not_taken_over_while_armed
`came && (fresh || mode != Mode::Armed)` becomes `came`
only the depth must be finite: fault_latches
` && sample.lateral.is_finite()` becomes ``
a state from nowhere trusted: force_is_bounded
`if sound { state.force } else { Force::ZERO }` becomes `state.force`
=== src/core/hid/report.rs
the number of a report not checked: decoding_a_force_report_is_total
`if found != expected` becomes `if found == 0`
=== src/core/hid/units.rs
a count cut off instead of rounded: a_count_is_the_nearest_whole_number
`(limited + ROUND)` becomes `(limited - 0.5 + ROUND)`
=== src/core/detect/decision.rs
no inclusion for a NaN: no_inclusion_is_never_decided_without_finite_numbers
`    check_finite("theta", theta)?;\n    check_finite("eta", eta)?;\n` becomes `    check_finite("eta", eta)?;\n`
"#;

/// The defects that harnesses must find.
pub fn defects() -> Vec<Defect> {
    read(DEFECTS)
}

impl Defect {
    /// Where in the text of its file it stands.
    pub fn place(&self, sound: &str) -> Range<usize> {
        let Defect { name, file, .. } = self;
        let [from, to] = &self.edit;
        let found: Vec<_> = sound.match_indices(from).collect();
        assert_eq!(found.len(), 1, "{name}: {file} must have once: {from}");
        assert_ne!(from, to, "{name}: nothing changes");
        found[0].0..found[0].0 + from.len()
    }

    /// The text with it.
    pub fn planted(&self, sound: &str) -> String {
        let mut text = sound.to_string();
        text.replace_range(self.place(sound), &self.edit[1]);
        text
    }
}

/// The classes of the ledger: two values of one type exchanged; a number that is nearly right; an order or a symmetry assumed; an old value
/// or shared state; an error lost; a size, index or wrap; a boundary; a sign, factor or term; a name, unit, escape or format.
pub const CLASSES: [&str; 9] = [
    "swap",
    "constant",
    "order",
    "stale",
    "swallowed",
    "counter",
    "edge",
    "formula",
    "text",
];

/// A defect of the ledger: of the kind that a careful person makes, anywhere.
#[derive(Debug, Clone)]
pub struct Entry {
    /// The defect; what must find it is a test, or `?` as long as that is not known.
    pub defect: Defect,
    /// One of [`CLASSES`].
    pub class: String,
    /// Whether it is built alone, since it does not compile behind the switch: the entry says `alone` behind its class.
    pub is_alone: bool,
    /// Whether its place was drawn by seed, so that it counts for the power of the tests.
    pub is_drawn: bool,
}

/// The ledger: `proofs/ledger/*.txt`, a file after the other.
pub fn ledger() -> Vec<Entry> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("ledger");
    let mut paths: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|end| end == "txt"))
        .collect();
    paths.sort();
    let file = |path: &Path| {
        let is_drawn = path.ends_with("drawn.txt");
        let defects = read(&fs::read_to_string(path).unwrap());
        defects
            .into_iter()
            .map(move |defect| Entry::of(defect, is_drawn))
    };
    paths.iter().flat_map(|path| file(path)).collect()
}

impl Entry {
    /// Takes the class off the name.
    fn of(mut defect: Defect, is_drawn: bool) -> Entry {
        let (class, name) = defect.name.split_once(": ").expect(&defect.name);
        let (class, is_alone) = match class.strip_suffix(" alone") {
            Some(class) => (class.to_string(), true),
            None => (class.to_string(), false),
        };
        assert!(CLASSES.contains(&&*class), "{}: no class", defect.name);
        defect.name = name.to_string();
        Entry {
            defect,
            class,
            is_alone,
            is_drawn,
        }
    }
}

/// Reads defects; a line that begins with `#` is a comment.
fn read(text: &str) -> Vec<Defect> {
    let mut defects = Vec::new();
    let mut file = "";
    let mut lines = text
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    while let Some(line) = lines.next() {
        if let Some(path) = line.strip_prefix("=== ") {
            file = path;
            continue;
        }
        let (name, found_by) = line.rsplit_once(": ").expect(line);
        let words: Vec<&str> = lines.next().expect(name).split('`').collect();
        assert_eq!(words.len(), 5, "{name}: `words` becomes `words`");
        let [from, to] = [1, 3].map(|at| words[at].replace("\\n", "\n"));
        defects.push(Defect {
            name: name.into(),
            file: file.into(),
            edit: [from, to],
            found_by: found_by.into(),
        });
    }
    defects
}

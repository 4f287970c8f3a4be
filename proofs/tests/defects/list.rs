//! The planted defects: plausible bugs, each a few words of the source.

/// A bug to plant.
pub struct Defect {
    /// What it is.
    pub name: &'static str,
    /// Where.
    pub file: &'static str,
    /// What is replaced by what; each must be there once.
    pub edits: &'static [(&'static str, &'static str)],
    /// A harness that must fail.
    pub found_by: &'static str,
}

const AXIS: &str = "src/servo/axis.rs";
const LIMIT: &str = "src/servo/limit.rs";
const STEP: &str = "src/servo/step.rs";
const TABLE: &str = "src/servo/table.rs";
const REPORT: &str = "src/hid/report.rs";
const UNITS: &str = "src/hid/units.rs";
const DECISION: &str = "src/detect/decision.rs";

pub const DEFECTS: &[Defect] = &[
    Defect {
        name: "the cell is one too far",
        file: AXIS,
        edits: &[("index = ahead;", "index = ahead.wrapping_add(1);")],
        found_by: "locate_is_total_and_in_range",
    },
    Defect {
        name: "the reciprocal of the wrong cell",
        file: AXIS,
        edits: &[(
            "self.reciprocal_widths.get(index)",
            "self.reciprocal_widths.get(0)",
        )],
        found_by: "a_fraction_is_near_the_exact_one",
    },
    Defect {
        name: "extrapolation without a bound",
        file: AXIS,
        edits: &[("between(fraction, -EXTRAPOLATION_CELLS, 1.0)", "fraction")],
        found_by: "locate_is_total_and_in_range",
    },
    Defect {
        name: "a NaN let through",
        file: LIMIT,
        edits: &[("if value.is_nan() { 0.0 } else { value }", "value")],
        found_by: "a_limited_number_is_within_its_limit",
    },
    Defect {
        name: "the clamp to the hull left out",
        file: TABLE,
        edits: &[("(0.0..=1.0).contains(&t)", "t.is_nan()")],
        found_by: "a_blend_is_between_its_ends",
    },
    Defect {
        name: "the table transposed",
        file: TABLE,
        edits: &[(
            "wrapping_mul(columns)",
            "wrapping_mul(self.depths.knots().len())",
        )],
        found_by: "nodes_are_exact",
    },
    Defect {
        name: "the upper row twice",
        file: TABLE,
        edits: &[("self.forces.get(second..)", "self.forces.get(first..)")],
        found_by: "adjoining_cells_agree_on_their_border",
    },
    Defect {
        name: "a force above the surface",
        file: TABLE,
        edits: &[("if depth < 0.0 { Force::ZERO } else { force }", "force")],
        found_by: "force_of_a_table_is_bounded",
    },
    Defect {
        name: "a force above the surface that the step plays",
        file: STEP,
        edits: &[("playing && sample.depth >= 0.0", "playing")],
        found_by: "no_force_unless_permitted",
    },
    Defect {
        name: "a weight squared",
        file: TABLE,
        edits: &[("(1.0 - t) * a + t * b", "(1.0 - t) * a + t * t * b")],
        found_by: "force_is_near_the_bilinear_form",
    },
    Defect {
        name: "the limit of the force left out",
        file: STEP,
        edits: &[("let target = limit(target, limits.force());", "")],
        found_by: "force_is_bounded",
    },
    Defect {
        name: "a rise without a limit",
        file: LIMIT,
        edits: &[("size + rise", "sign * target")],
        found_by: "slew_is_limited",
    },
    Defect {
        name: "a fall with the wrong sign",
        file: LIMIT,
        edits: &[("size - fall\n", "size + fall\n")],
        found_by: "a_released_force_is_zero_in_three_cycles_of_half_the_limit",
    },
    Defect {
        name: "a force that turns in one cycle",
        file: LIMIT,
        edits: &[("if size > fall", "if size > 0.0")],
        found_by: "slew_is_limited",
    },
    Defect {
        name: "a played force that falls as slowly as it rises",
        file: STEP,
        edits: &[("if held && !fresh", "if held")],
        found_by: "slew_is_limited",
    },
    Defect {
        name: "a rise as fast as a release",
        file: STEP,
        edits: &[("limits.slew(), fall", "limits.release(), fall")],
        found_by: "slew_is_limited",
    },
    Defect {
        name: "the release forgotten",
        file: STEP,
        edits: &[("limits.release()\n    };", "limits.slew()\n    };")],
        found_by: "a_released_force_is_zero_in_three_cycles_of_half_the_limit",
    },
    Defect {
        name: "the latch forgotten",
        file: STEP,
        edits: &[(
            "if arm { Mode::Armed } else { mode }",
            "if arm { Mode::Armed } else if cause.is_none() { Mode::Disarmed } else { mode }",
        )],
        found_by: "fault_latches",
    },
    Defect {
        name: "a later fault takes the place of the first",
        file: STEP,
        edits: &[(
            "if arm { Mode::Armed } else { mode }",
            "if arm { Mode::Armed } else { cause.map_or(mode, Mode::Faulted) }",
        )],
        found_by: "fault_latches",
    },
    Defect {
        name: "a sample that repeats accepted",
        file: STEP,
        edits: &[("(1..=MOST_AHEAD)", "(0..=MOST_AHEAD)")],
        found_by: "no_force_unless_permitted",
    },
    Defect {
        name: "a sample that goes back accepted",
        file: STEP,
        edits: &[("MOST_AHEAD: u16 = 32767", "MOST_AHEAD: u16 = 32768")],
        found_by: "no_force_unless_permitted",
    },
    Defect {
        name: "the deadman ignored",
        file: STEP,
        edits: &[("Armed && sample.deadman", "Armed")],
        found_by: "no_force_unless_permitted",
    },
    Defect {
        name: "the watchdog off",
        file: STEP,
        edits: &[("missed > limits.watchdog()", "false")],
        found_by: "watchdog_drops_the_force",
    },
    Defect {
        name: "the watchdog a cycle late",
        file: STEP,
        edits: &[(
            "missed > limits.watchdog()",
            "missed > limits.watchdog() + 1",
        )],
        found_by: "watchdog_drops_the_force",
    },
    Defect {
        name: "the count of missed samples wraps",
        file: STEP,
        edits: &[("missed.saturating_add(1)", "missed.wrapping_add(1)")],
        found_by: "fault_latches",
    },
    Defect {
        name: "armed by a request that sticks",
        file: STEP,
        edits: &[(" && !state.arming", "")],
        found_by: "arming_needs_every_condition",
    },
    Defect {
        name: "armed with the deadman held",
        file: STEP,
        edits: &[("fresh && !sample.deadman", "fresh")],
        found_by: "arming_needs_every_condition",
    },
    Defect {
        name: "a stale sample taken over while armed",
        file: STEP,
        edits: &[("came && (fresh || mode != Mode::Armed)", "came")],
        found_by: "stale_samples_are_not_taken_over_while_armed",
    },
    Defect {
        name: "only the depth must be finite",
        file: STEP,
        edits: &[(" && sample.lateral.is_finite()", "")],
        found_by: "fault_latches",
    },
    Defect {
        name: "a state from nowhere trusted",
        file: STEP,
        edits: &[(
            "if sound { state.force } else { Force::ZERO }",
            "state.force",
        )],
        found_by: "force_is_bounded",
    },
    Defect {
        name: "the number of a report not checked",
        file: REPORT,
        edits: &[("if found != expected", "if found == 0")],
        found_by: "decoding_a_force_report_is_total",
    },
    Defect {
        name: "a count cut off instead of rounded",
        file: UNITS,
        edits: &[("(limited + ROUND)", "(limited - 0.5 + ROUND)")],
        found_by: "a_count_is_the_nearest_whole_number",
    },
    Defect {
        name: "no inclusion for a NaN",
        file: DECISION,
        edits: &[(
            "    check_finite(\"theta\", theta)?;\n    check_finite(\"eta\", eta)?;\n",
            "    check_finite(\"eta\", eta)?;\n",
        )],
        found_by: "no_inclusion_is_never_decided_without_finite_numbers",
    },
];

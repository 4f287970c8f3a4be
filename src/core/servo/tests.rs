//! The kernel on tables small enough to compute by hand. Its properties over all inputs are checked
//! in `proofs/`.
use std::string::ToString;
use std::vec;
use std::vec::Vec;

use super::*;
use crate::stats::random::Generator;

/// Two cells of different widths, and their reciprocals.
const DEPTHS: ([f32; 3], [f32; 2]) = ([0.0, 0.25, 0.75], [4.0, 2.0]);
const LATERALS: ([f32; 3], [f32; 2]) = ([-0.5, 0.0, 0.25], [2.0, 4.0]);

fn force(lateral: f32, normal: f32) -> Force<f32> {
    Force { lateral, normal }
}

/// Forces that are bilinear over the whole table, all exact in f32.
fn bilinear(depth: f32, lateral: f32) -> Force<f32> {
    force(8.0 * lateral * depth, 4.0 * depth + 2.0 * lateral * depth)
}

fn with_table<R>(then: impl FnOnce(&Table) -> R) -> R {
    let forces = DEPTHS.0.map(|d| LATERALS.0.map(|x| bilinear(d, x)));
    let forces = forces.concat();
    let depths = Axis::new(&DEPTHS.0, &DEPTHS.1).unwrap();
    let laterals = Axis::new(&LATERALS.0, &LATERALS.1).unwrap();
    then(&Table::new(depths, laterals, &forces).unwrap())
}

// Verifies: SRV-004.
#[test]
fn a_position_lies_in_the_cell_that_encloses_it() {
    let axis = Axis::new(&LATERALS.0, &LATERALS.1).unwrap();
    let cell = |index, fraction| Cell { index, fraction };
    assert_eq!(axis.locate(-0.5), cell(0, 0.0));
    assert_eq!(axis.locate(-0.125), cell(0, 0.75));
    assert_eq!(axis.locate(0.0), cell(1, 0.0));
    assert_eq!(axis.locate(0.25), cell(1, 1.0));
}

// Verifies: SRV-004, SRV-012.
#[test]
fn the_fraction_saturates_one_cell_beyond_the_border() {
    let axis = Axis::new(&LATERALS.0, &LATERALS.1).unwrap();
    assert_eq!(axis.locate(-0.75).fraction, -0.5);
    assert_eq!(axis.locate(-1.0).fraction, -1.0);
    assert_eq!(axis.locate(-1.5).fraction, -1.0);
    assert_eq!(axis.locate(0.375).fraction, 1.5);
    assert_eq!(axis.locate(f32::INFINITY).fraction, 2.0);
    assert_eq!(axis.locate(f32::NEG_INFINITY).fraction, -1.0);
}

// Verifies: SRV-010, SRV-011, SRV-012.
#[test]
fn a_bilinear_force_is_reproduced_in_the_table_and_one_cell_beyond() {
    with_table(|table| {
        for depth in [0.0, 0.125, 0.25, 0.5, 0.75, 1.0, 1.25] {
            for lateral in [-1.0, -0.75, -0.5, -0.25, 0.0, 0.125, 0.25, 0.5] {
                let expected = bilinear(depth, lateral);
                assert_eq!(table.force(depth, lateral), expected, "{depth} {lateral}");
            }
        }
        assert_eq!(table.force(9.0, 9.0), bilinear(1.25, 0.5));
    });
}

// Verifies: SRV-014.
#[test]
fn there_is_no_force_above_the_surface() {
    with_table(|table| {
        assert_eq!(table.force(-1e-6, 0.0), Force::ZERO);
        assert_eq!(table.force(-0.1, 0.25), Force::ZERO);
    });
    // On the surface the table counts, should it hold a force there.
    let axis = Axis::new(&[0.0, 0.5], &[2.0]).unwrap();
    let touching = [force(0.0, 0.015); 4];
    let table = Table::new(axis, axis, &touching).unwrap();
    assert_eq!(table.force(0.0, 0.0), touching[0]);
    assert_eq!(table.force(-0.0, 0.0), touching[0]);
}

// Verifies: SRV-010.
#[test]
fn a_blend_of_equals_is_the_same_to_the_bit() {
    // (1 − t) a + t a is 0.100000001490116… or its neighbour, by rounding.
    for t in [0.1, 0.2, 0.3, 0.7, 0.9] {
        assert_eq!(blend(0.1, 0.1, t).to_bits(), 0.1f32.to_bits());
    }
    assert_eq!(blend(1.0, 3.0, 2.0), 5.0);
}

// Verifies: SRV-002.
#[test]
fn an_axis_is_refused_with_its_place() {
    let many = vec![0.0; MAX_KNOTS + 1];
    let (half, nan) = ([0.0, 0.5], f32::NAN);
    for (knots, reciprocals, expected) in [
        (&[0.0][..], &[][..], "Knots { found: 1 }"),
        (&many, &many[1..], "Knots { found: 1025 }"),
        (&[0.0, 1.0], &[], "Reciprocals { found: 0, expected: 1 }"),
        (&[0.0, 1.5], &[1.0], "Position { index: 1, value: 1.5 }"),
        (&[nan, 1.0], &[1.0], "Position { index: 0, value: NaN }"),
        (
            &[0.0, 0.5, 0.5],
            &[2.0, 1.0],
            "Width { index: 2, width: 0.0 }",
        ),
        (&half, &[2.5], "Reciprocal { index: 0, value: 2.5 }"),
        (&half, &[nan], "Reciprocal { index: 0, value: NaN }"),
    ] {
        let refusal = Axis::new(knots, reciprocals).unwrap_err();
        assert_eq!(format!("{refusal:?}"), expected);
    }
}

// Verifies: SRV-002.
#[test]
fn a_table_is_refused_with_its_place() {
    let axis = Axis::new(&[0.0, 0.5], &[2.0]).unwrap();
    let new = |forces: &[Force<f32>]| Table::new(axis, axis, forces).unwrap_err();
    let (found, expected) = (3, 4);
    assert_eq!(
        new(&[Force::ZERO; 3]),
        InvalidTable::Shape { found, expected }
    );
    for value in [force(100.1, 0.0), force(0.0, -f32::INFINITY)] {
        let (mut forces, index) = ([Force::ZERO; 4], 2);
        forces[index] = value;
        assert_eq!(new(&forces), InvalidTable::Force { index, value });
    }
    let nothing = new(&[force(0.0, f32::NAN); 4]);
    assert!(matches!(nothing, InvalidTable::Force { index: 0, .. }));
}

// Verifies: SRV-022.
#[test]
fn limits_are_refused_by_name() {
    let ok = Limits::new(2.0, 0.01, 0.125, 5);
    assert!(ok.is_ok());
    let refused = |force, slew, release, watchdog, expected| {
        assert_eq!(Limits::new(force, slew, release, watchdog), Err(expected));
    };
    for force in [0.0, -1.0, 20.5, f32::NAN] {
        refused(force, 0.01, 0.2, 5, InvalidLimits::Force);
    }
    for slew in [0.0, 9e-5, 2.5, f32::NAN] {
        refused(2.0, slew, 2.5, 5, InvalidLimits::Slew);
    }
    for release in [0.005, 0.12, f32::INFINITY, f32::NAN] {
        refused(2.0, 0.01, release, 5, InvalidLimits::Release);
    }
    for watchdog in [0, 101] {
        refused(2.0, 0.01, 0.2, watchdog, InvalidLimits::Watchdog);
    }
    for (limit, name) in [
        (InvalidLimits::Force, "the force limit "),
        (InvalidLimits::Slew, "the slew limit "),
        (InvalidLimits::Release, "the release limit "),
        (InvalidLimits::Watchdog, "the watchdog "),
    ] {
        assert!(limit.to_string().starts_with(name), "{limit}");
    }
}

// Verifies: SRV-022.
#[test]
fn limits_are_accepted_if_and_only_if_they_keep_the_four_rules() {
    let generator = Generator::new(22, 0);
    let mut accepted = 0;
    for trial in 0..200_000 {
        let [force, slew, release, watchdog] = generator.words([0, trial, 0, 0]);
        // From 10⁻⁶ to 10², or any bits.
        let number = |word: u64| match word % 8 {
            0 => f32::from_bits((word >> 32) as u32),
            _ => libm::powf(10.0, (word >> 40) as f32 / (1 << 21) as f32 - 6.0),
        };
        let [force, slew, release] = [force, slew, release].map(number);
        let watchdog = (watchdog % 128) as u16;
        let [f, s, r] = [force, slew, release].map(f64::from);
        let rules = f > 0.0 && f <= 20.0 && s >= f64::from(1e-4_f32) && s <= f;
        let rules = rules && r >= s && 16.0 * r >= f && r.is_finite();
        let rules = rules && (1..=100).contains(&watchdog);
        let limits = Limits::new(force, slew, release, watchdog);
        assert_eq!(limits.is_ok(), rules, "{force} {slew} {release} {watchdog}");
        accepted += u32::from(rules);
    }
    assert!(accepted > 2_000, "{accepted}");
}

/// A person at the device: feeds the kernel sample after sample.
struct Session {
    state: State,
    sequence: u16,
    limits: Limits,
}

impl Session {
    fn new() -> Session {
        let limits = Limits::new(2.0, 0.25, 0.5, 3).unwrap();
        Session {
            state: State::default(),
            sequence: 100,
            limits,
        }
    }

    /// A fresh sample at the depth 0.5 m, where the force is (0, 2) N.
    fn sample(&mut self, deadman: bool) -> Sample {
        self.sequence = self.sequence.wrapping_add(1);
        let sequence = self.sequence;
        Sample {
            sequence,
            deadman,
            device_fault: false,
            depth: 0.5,
            lateral: 0.0,
        }
    }

    fn cycle(&mut self, sample: Option<Sample>, request: Request) -> Command {
        let input = Input { sample, request };
        let (state, command) = with_table(|table| step(table, &self.limits, self.state, input));
        assert_eq!(state.force, command.force);
        self.state = state;
        command
    }

    /// A cycle with a fresh sample.
    fn ask(&mut self, deadman: bool, request: Request) -> Command {
        let sample = self.sample(deadman);
        self.cycle(Some(sample), request)
    }

    fn hold(&mut self, deadman: bool) -> Command {
        self.ask(deadman, Request::None)
    }

    /// The mode after a cycle with a fresh sample.
    fn mode_after(&mut self, deadman: bool, request: Request) -> Mode {
        self.ask(deadman, request);
        self.state.mode
    }

    fn arm(&mut self) {
        self.hold(false);
        assert_eq!(self.mode_after(false, Request::Arm), Mode::Armed);
    }

    /// Armed, deadman held, at the table's force.
    fn playing() -> Session {
        let mut session = Session::new();
        session.arm();
        for _ in 0..8 {
            session.hold(true);
        }
        assert_eq!(session.state.force, force(0.0, 2.0));
        session
    }
}

// Verifies: SRV-021, SRV-030.
#[test]
fn the_force_rises_by_the_slew_limit_and_falls_by_the_release_limit() {
    let mut session = Session::new();
    session.arm();
    let rise: Vec<f32> = (0..9).map(|_| session.hold(true).force.normal).collect();
    assert_eq!(rise, [0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.0]);
    let fall: Vec<f32> = (0..5).map(|_| session.hold(false).force.normal).collect();
    assert_eq!(fall, [1.5, 1.0, 0.5, 0.0, 0.0]);
    assert_eq!(session.state.mode, Mode::Armed);
}

// Verifies: SRV-021.
#[test]
fn a_force_that_is_played_falls_by_the_release_limit_and_without_a_sample_by_the_slew_limit() {
    let mut session = Session::playing();
    let lost = session.cycle(None, Request::None);
    assert_eq!(lost.force.normal, 1.75);
    let left: Vec<f32> = (0..5)
        .map(|_| {
            let mut sample = session.sample(true);
            sample.depth = -0.001;
            let command = session.cycle(Some(sample), Request::None);
            assert!(command.playing);
            command.force.normal
        })
        .collect();
    assert_eq!(left, [1.25, 0.75, 0.25, 0.0, 0.0]);
}

// Verifies: SRV-021.
#[test]
fn a_force_comes_to_zero_before_it_turns() {
    for sign in [1.0, -1.0] {
        let path: Vec<f32> = (0..6)
            .scan(0.75 * sign, |last, _| {
                *last = approach(*last, -5.0 * sign, 0.25, 0.5);
                Some(*last * sign)
            })
            .collect();
        assert_eq!(path, [0.25, 0.0, -0.25, -0.5, -0.75, -1.0]);
    }
}

// Verifies: SRV-030, SRV-033.
#[test]
fn arming_needs_a_fresh_sample_without_deadman_and_a_new_request() {
    let mut session = Session::new();
    // The first sample has nothing to be ahead of, then the request sticks.
    for _ in 0..2 {
        let mode = session.mode_after(false, Request::Arm);
        assert_eq!(mode, Mode::Disarmed);
    }
    // Deadman held.
    session.hold(false);
    let mode = session.mode_after(true, Request::Arm);
    assert_eq!(mode, Mode::Disarmed);
    assert!(!session.hold(true).playing);
    // No sample.
    session.cycle(None, Request::Arm);
    assert_eq!(session.state.mode, Mode::Disarmed);
    // The request has stuck meanwhile, and is none that is new.
    assert_eq!(session.mode_after(false, Request::Arm), Mode::Disarmed);
    session.arm();
}

// Verifies: SRV-033.
#[test]
fn arming_waits_until_the_force_has_come_to_zero() {
    let mut session = Session::playing();
    for request in [Request::Disarm, Request::Arm] {
        assert_eq!(session.mode_after(false, request), Mode::Disarmed);
    }
    session.hold(false);
    session.hold(false);
    assert_eq!(session.state.force, Force::ZERO);
    session.arm();
}

// Verifies: SRV-031, SRV-032, SRV-035.
#[test]
fn a_fault_latches_with_its_first_cause_and_releases_the_force() {
    type Defect = fn(&mut Sample);
    let wrong: [(Defect, Fault); 4] = [
        (|s| s.depth = f32::NAN, Fault::NotFinite),
        (|s| s.lateral = f32::NEG_INFINITY, Fault::NotFinite),
        (|s| s.device_fault = true, Fault::Device),
        (
            |s| (s.device_fault, s.depth) = (true, f32::INFINITY),
            Fault::NotFinite,
        ),
    ];
    for (spoil, cause) in wrong {
        let mut session = Session::playing();
        let mut sample = session.sample(true);
        spoil(&mut sample);
        let command = session.cycle(Some(sample), Request::None);
        assert_eq!((command.playing, command.force), (false, force(0.0, 1.5)));
        for _ in 0..3 {
            let mut sample = session.sample(true);
            sample.device_fault = cause != Fault::Device;
            session.cycle(Some(sample), Request::None);
        }
        assert_eq!(session.state.force, Force::ZERO);
        assert_eq!(session.state.mode, Mode::Faulted(cause));
        assert!(!cause.to_string().is_empty());
        session.arm();
    }
}

// Verifies: SRV-032, SRV-033.
#[test]
fn a_fault_ends_with_nothing_but_a_request_to_arm_when_all_is_well() {
    let mut session = Session::playing();
    let mut sample = session.sample(true);
    sample.device_fault = true;
    session.cycle(Some(sample), Request::None);
    for _ in 0..4 {
        session.hold(false);
    }
    // Each but the last lacks one of: the request, the hand off the deadman, a device without fault.
    for (request, deadman, device_fault, armed) in [
        (Request::None, false, false, false),
        (Request::Disarm, false, false, false),
        (Request::Arm, true, false, false),
        (Request::None, false, false, false),
        (Request::Arm, false, true, false),
        (Request::None, false, false, false),
        (Request::Arm, false, false, true),
    ] {
        let mut sample = session.sample(deadman);
        sample.device_fault = device_fault;
        session.cycle(Some(sample), request);
        assert_eq!(session.state.mode == Mode::Armed, armed, "{request:?}");
    }
}

// Verifies: SRV-035, SRV-070.
#[test]
fn a_state_that_no_step_left_is_a_fault_without_force() {
    for wrong in [f32::NAN, f32::INFINITY, 2.5] {
        let mut session = Session::playing();
        session.state.force.lateral = wrong;
        let command = session.hold(true);
        assert_eq!(command.force, Force::ZERO);
        assert_eq!(session.state.mode, Mode::Faulted(Fault::State));
    }
}

// Verifies: SRV-031, SRV-042.
#[test]
fn cycles_without_a_sample_lower_the_force_and_trip_the_watchdog() {
    let mut session = Session::playing();
    let normal: Vec<f32> = (0..6)
        .map(|_| session.cycle(None, Request::None).force.normal)
        .collect();
    assert_eq!(normal, [1.75, 1.5, 1.25, 0.75, 0.25, 0.0]);
    assert_eq!(session.state.mode, Mode::Faulted(Fault::Watchdog));
    session.arm();
}

// Verifies: SRV-040.
#[test]
fn samples_that_repeat_or_go_back_are_stale_until_the_watchdog_trips() {
    for back in [0, 1, 5000, 32768] {
        let mut session = Session::playing();
        for missed in 1..=4 {
            let mut sample = session.sample(true);
            // In order among themselves, but none ahead of the last fresh one.
            sample.sequence = sample.sequence.wrapping_sub(missed).wrapping_sub(back);
            let command = session.cycle(Some(sample), Request::None);
            assert!(!command.playing, "{back}");
        }
        assert_eq!(session.state.mode, Mode::Faulted(Fault::Watchdog));
    }
    let mut session = Session::playing();
    session.sequence = session.sequence.wrapping_add(32766);
    assert!(session.hold(true).playing);
}

// Verifies: SRV-040.
#[test]
fn a_device_that_restarts_its_count_can_be_armed_again() {
    let mut session = Session::playing();
    session.sequence = 0;
    for _ in 0..4 {
        session.hold(true);
    }
    assert_eq!(session.state.mode, Mode::Faulted(Fault::Watchdog));
    for _ in 0..4 {
        session.hold(false);
    }
    session.arm();
}

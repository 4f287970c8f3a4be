//! One cycle of the kernel, and a few in a row. What is expected is written down again here, in the
//! words of the specification.

use core::ops::Bound::Included;

use bolero::{Driver, TypeGenerator};
use palpate_core::force::Force;
use palpate_core::servo::{Command, Fault, Input, Limits, Mode, Request, Sample, State, step};

use crate::cases::{Cycle, QuickLimits, SoundCycle, ValidLimits, plain_table, sound_force, stale};

/// Ahead of the last one by 1 to 32767, modulo 65536 (SRV-040).
fn is_fresh(state: &State, sample: Option<Sample>) -> bool {
    let (Some(last), Some(sample)) = (state.sequence, sample) else {
        return false;
    };
    let ahead = i32::from(sample.sequence) - i32::from(last);
    let ahead = if ahead < 0 { ahead + 65536 } else { ahead };
    (1..=32767).contains(&ahead)
}

fn is_sound(state: &State, limits: &Limits) -> bool {
    state.force.lateral.abs() <= limits.force() && state.force.normal.abs() <= limits.force()
}

/// What is wrong, the gravest first (SRV-035, SRV-042).
fn expected_fault(case: &Cycle) -> Option<Fault> {
    let (limits, state, input) = case.parts();
    if !is_sound(&state, &limits) {
        return Some(Fault::State);
    }
    if let Some(sample) = input.sample {
        if !sample.depth.is_finite() || !sample.lateral.is_finite() {
            return Some(Fault::NotFinite);
        }
        if sample.device_fault {
            return Some(Fault::Device);
        }
    }
    let missed = u32::from(state.missed) + 1;
    let late = !is_fresh(&state, input.sample) && missed > u32::from(limits.watchdog());
    (state.mode == Mode::Armed && late).then_some(Fault::Watchdog)
}

/// What SRV-033 asks of a cycle that arms.
fn may_arm(case: &Cycle) -> bool {
    let Cycle { state, input, .. } = case;
    input.request == Request::Arm
        && !state.arming
        && is_fresh(state, input.sample)
        && expected_fault(case).is_none()
        && input.sample.is_some_and(|sample| !sample.deadman)
        && state.force == Force::ZERO
}

fn play(case: &Cycle) -> (State, Command) {
    step(&plain_table(), &case.limits, case.state, case.input)
}

// Verifies: SRV-001, SRV-013, SRV-020, SRV-070.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(6), kani::solver(minisat))]
fn force_is_bounded() {
    harness!(Cycle, |case| {
        let (limits, state, input) = case.parts();
        let (next, command) = play(case);
        for value in command.force.into_array() {
            // False for NaN, too.
            assert!(value.abs() <= limits.force() && limits.force() <= 20.0);
        }
        assert!(next.force == command.force);
        if !is_sound(&state, &limits) {
            assert!(command.force == Force::ZERO);
        }
        reached! {
            "a force at its limit": command.force.normal == limits.force(),
            "a force within its limit":
                command.force.normal != 0.0 && command.force.normal.abs() < limits.force(),
            "playing": command.playing,
            "a state that no step left": !is_sound(&state, &limits),
            "a sample that is not finite": input.sample.is_some_and(|s| !s.depth.is_finite()),
        }
    });
}

// Verifies: SRV-021.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(6), kani::solver(cadical))]
fn slew_is_limited() {
    harness!(SoundCycle, |case| {
        let SoundCycle(case) = case;
        let (limits, state, input) = case.parts();
        let (next, command) = play(case);
        let let_go = input.sample.is_some_and(|sample| !sample.deadman);
        let released = next.mode != Mode::Armed || let_go;
        let fall = if released || command.playing {
            limits.release()
        } else {
            limits.slew()
        };
        let above = input.sample.is_some_and(|sample| sample.depth < 0.0);
        for (value, last) in command.force.zip(state.force).into_array() {
            let grows = value.abs() > last.abs();
            let change = if grows { limits.slew() } else { fall };
            assert!(last - change <= value && value <= last + change);
            // Never through zero.
            assert!(value == 0.0 || last == 0.0 || (value < 0.0) == (last < 0.0));
            // A hand that has left the gel is not pushed any longer than the release takes.
            let rest = last.abs() - limits.release();
            assert!(!(command.playing && above) || value == 0.0 || value.abs() <= rest);
        }
        let rising = command.force.normal > state.force.normal;
        reached! {
            "a rise by the slew limit":
                rising && command.force.normal == state.force.normal + limits.slew(),
            "a rise to the table's force":
                command.playing && rising
                    && command.force.normal < state.force.normal + limits.slew(),
            "a release": released && state.force != Force::ZERO,
            "a force that would turn":
                command.playing && !above && command.force.normal == 0.0 && state.force.normal < 0.0,
            "a hand that left the gel": command.playing && above && state.force.normal != 0.0,
        }
    });
}

// Verifies: SRV-014, SRV-030.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(6), kani::solver(minisat))]
fn no_force_unless_permitted() {
    harness!(SoundCycle, |case| {
        let SoundCycle(case) = case;
        let (_, state, input) = case.parts();
        let (next, command) = play(case);
        let permitted = next.mode == Mode::Armed
            && is_fresh(&state, input.sample)
            && expected_fault(case).is_none()
            && input.sample.is_some_and(|sample| sample.deadman);
        assert!(command.playing == permitted);
        let sample_says = |what: fn(Sample) -> bool| input.sample.is_some_and(what);
        // Nothing is touched there (SRV-014).
        let above = sample_says(|s| s.depth < 0.0);
        for (value, last) in command.force.zip(state.force).into_array() {
            // Towards zero by a slew limit at least, and never through it.
            let nearer = value.abs() < last.abs() && (value < 0.0) == (last < 0.0);
            assert!(value == 0.0 || nearer || permitted && !above);
        }
        let moving = state.force != Force::ZERO;
        let armed = state.mode == Mode::Armed;
        reached! {
            "permitted": permitted,
            "above the surface": permitted && above && moving,
            "a deadman let go": armed && moving && sample_says(|s| !s.deadman),
            "no sample": armed && moving && input.sample.is_none(),
            "a stale sample":
                armed && moving && input.sample.is_some() && !is_fresh(&state, input.sample),
            "not armed": !armed && moving && sample_says(|s| s.deadman),
            "a device fault": armed && moving && sample_says(|s| s.device_fault),
        }
    });
}

// Verifies: SRV-033.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(6), kani::solver(minisat))]
fn arming_needs_every_condition() {
    harness!(ArmingCycle, |case| {
        let case = &case.0;
        let (next, command) = play(case);
        if case.state.mode != Mode::Armed {
            assert!((next.mode == Mode::Armed) == may_arm(case));
            assert!(command.force.lateral.abs() <= case.state.force.lateral.abs());
        }
        assert!(next.arming == (case.input.request == Request::Arm));
        reached! {
            "armed": case.state.mode != Mode::Armed && next.mode == Mode::Armed,
            "a request that sticks": case.input.request == Request::Arm && case.state.arming,
            "a force that has not come to zero":
                case.input.request == Request::Arm && case.state.force != Force::ZERO,
            "with the deadman held":
                case.input.request == Request::Arm && case.input.sample.is_some_and(|s| s.deadman),
            "with a stale sample":
                case.input.request == Request::Arm && !is_fresh(&case.state, case.input.sample),
        }
    });
}

/// A sound cycle, most of the time with nothing wrong in its sample.
#[derive(Debug, Clone)]
struct ArmingCycle(Cycle);

impl TypeGenerator for ArmingCycle {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let SoundCycle(mut cycle) = driver.produce()?;
        if let Some(sample) = &mut cycle.input.sample
            && driver.gen_variant(4, 0)? != 1
        {
            (sample.depth, sample.lateral, sample.device_fault) = (0.25, 0.25, false);
        }
        if driver.gen_variant(4, 0)? != 1 {
            cycle.input.request = Request::Arm;
        }
        Some(ArmingCycle(cycle))
    }
}

// Verifies: SRV-032, SRV-035, SRV-042.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(6), kani::solver(minisat))]
fn fault_latches() {
    harness!(Cycle, |case| {
        let (next, _) = play(case);
        let fault = expected_fault(case);
        let was_faulted = matches!(case.state.mode, Mode::Faulted(_));
        let expected = match (case.state.mode, fault) {
            (Mode::Faulted(first), _) if !may_arm(case) => Mode::Faulted(first),
            (Mode::Faulted(_), _) => Mode::Armed,
            (_, Some(cause)) => Mode::Faulted(cause),
            (Mode::Armed, None) if case.input.request == Request::Disarm => Mode::Disarmed,
            (Mode::Disarmed, None) if may_arm(case) => Mode::Armed,
            (mode, None) => mode,
        };
        assert!(next.mode == expected);
        reached! {
            "a state that no step left": !was_faulted && fault == Some(Fault::State),
            "a position that is not finite": !was_faulted && fault == Some(Fault::NotFinite),
            "a fault of the device": !was_faulted && fault == Some(Fault::Device),
            "samples that are late": fault == Some(Fault::Watchdog),
            "a second fault": was_faulted && fault.is_some(),
            "a fault that cleared": was_faulted && fault.is_none(),
        }
    });
}

// Verifies: SRV-040.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(6), kani::solver(minisat))]
fn stale_samples_are_not_taken_over_while_armed() {
    harness!(Cycle, |case| {
        let (next, _) = play(case);
        let (state, sample) = (&case.state, case.input.sample);
        let fresh = is_fresh(state, sample);
        let expected = match sample {
            Some(sample) if fresh || next.mode != Mode::Armed => Some(sample.sequence),
            _ => state.sequence,
        };
        assert!(next.sequence == expected);
        let missed = (u32::from(state.missed) + 1).min(65535);
        assert!(u32::from(next.missed) == if fresh { 0 } else { missed });
        reached! {
            "fresh": fresh,
            "stale while armed": next.mode == Mode::Armed && sample.is_some() && !fresh,
            "stale otherwise": next.mode != Mode::Armed && sample.is_some() && !fresh,
            "the first sample": sample.is_some() && state.sequence.is_none(),
        }
    });
}

/// A run of cycles without a fresh sample, from any state while armed.
#[derive(Debug, Clone)]
struct Silence {
    limits: Limits,
    state: State,
    inputs: [Input; 5],
}

impl TypeGenerator for Silence {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let QuickLimits(limits) = driver.produce()?;
        let last: u16 = driver.produce()?;
        let force = sound_force(driver, &limits)?;
        let state = State {
            mode: Mode::Armed,
            force,
            sequence: Some(last),
            missed: driver.gen_u16(Included(&0), Included(&2))?,
            arming: driver.produce()?,
        };
        let mut inputs = [Input::default(); 5];
        for input in &mut inputs {
            // Nobody arms: when that may be, `arming_needs_every_condition` says.
            let disarm = driver.gen_variant(8, 0)? == 1;
            *input = Input {
                sample: stale(driver, last)?,
                request: [Request::None, Request::Disarm][usize::from(disarm)],
            };
        }
        Some(Silence {
            limits,
            state,
            inputs,
        })
    }
}

// Verifies: SRV-031, SRV-042.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(7), kani::solver(minisat))]
fn watchdog_drops_the_force() {
    harness!(Silence, |case| {
        let table = plain_table();
        let allowed = usize::from(case.limits.watchdog());
        let mut state = case.state;
        let mut tripped = false;
        for cycle in 1..=5 {
            let (next, command) = step(&table, &case.limits, state, case.inputs[cycle - 1]);
            state = next;
            assert!(!command.playing);
            tripped |= state.mode == Mode::Faulted(Fault::Watchdog);
            if cycle > allowed {
                assert!(state.mode != Mode::Armed);
            }
            // The watchdog's cycle releases half, the next the rest but for rounding.
            if cycle >= allowed + 3 {
                assert!(state.force == Force::ZERO);
            }
        }
        reached! {
            "tripped by the watchdog": tripped,
            "from a force": case.state.force.normal != 0.0,
            "a watchdog of two cycles": allowed == 2,
        }
    });
}

/// One cycle of release after another.
#[derive(Debug, Clone)]
struct Released<L> {
    limits: L,
    state: State,
    /// A deadman let go in each sample; otherwise whatever comes while not armed.
    let_go: bool,
    sequence: u16,
}

fn released<D: Driver, L>(driver: &mut D, limits: L, plain: Limits) -> Option<Released<L>> {
    let let_go: bool = driver.produce()?;
    let sequence: u16 = driver.produce()?;
    let state = State {
        mode: if let_go {
            Mode::Armed
        } else {
            Mode::Faulted(Fault::Device)
        },
        force: sound_force(driver, &plain)?,
        sequence: Some(sequence),
        missed: 0,
        arming: false,
    };
    Some(Released {
        limits,
        state,
        let_go,
        sequence,
    })
}

impl TypeGenerator for Released<QuickLimits> {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let limits: QuickLimits = driver.produce()?;
        released(driver, limits, limits.0)
    }
}

impl TypeGenerator for Released<ValidLimits> {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let limits: ValidLimits = driver.produce()?;
        released(driver, limits, limits.0)
    }
}

impl<L> Released<L> {
    /// The force after so many cycles of release.
    fn force_after(&self, limits: &Limits, cycles: u16) -> Force<f32> {
        let table = plain_table();
        let mut state = self.state;
        for cycle in 1..=cycles {
            let sample = Sample {
                sequence: self.sequence.wrapping_add(cycle),
                deadman: !self.let_go,
                device_fault: false,
                depth: 0.25,
                lateral: 0.25,
            };
            let input = Input {
                sample: Some(sample),
                request: Request::None,
            };
            state = step(&table, limits, state, input).0;
        }
        state.force
    }
}

// Verifies: SRV-031.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(6), kani::solver(minisat))]
fn a_released_force_is_zero_in_three_cycles_of_half_the_limit() {
    harness!(Released<QuickLimits>, |case| {
        assert!(case.force_after(&case.limits.0, 3) == Force::ZERO);
        reached! {
            "deadman let go": case.let_go && case.state.force.normal != 0.0,
            "faulted": !case.let_go && case.state.force.normal != 0.0,
            "from the limit": case.state.force.normal.abs() == case.limits.0.force(),
        }
    });
}

// No Kani proof: 17 cycles are too many. `exhaustive.rs` has the worst case for each force limit.
// Verifies: SRV-031.
#[cfg(not(kani))]
#[test]
fn a_released_force_is_zero_in_seventeen_cycles() {
    harness!(Released<ValidLimits>, |case| {
        assert!(case.force_after(&case.limits.0, 17) == Force::ZERO);
        let limits = case.limits.0;
        reached! {
            "the slowest release":
                limits.release() * 16.0 == limits.force() && case.state.force.normal.abs() == limits.force(),
        }
    });
}

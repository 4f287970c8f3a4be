//! One cycle of the servo loop.

use super::{Command, Fault, Force, Input, Limits, Mode, Request, Sample, State, Table};
use super::{approach, limit};

/// A sample is fresh if it is at most this far ahead of the last one: half of all numbers, so that
/// forward and back can be told apart.
///
/// Implements: SRV-040.
pub const MOST_AHEAD: u16 = 32767;

/// What stands in for a sample that did not come, so that the time is the same with and without. The deadman counts as held: one
/// lost sample is no emergency.
const NO_SAMPLE: Sample = Sample {
    sequence: 0,
    deadman: true,
    device_fault: false,
    depth: 0.0,
    lateral: 0.0,
};

/// One cycle: from what was (`state`) and what came (`input`) to the next state and the command, with
/// the force of `table` within `limits`.
///
/// Total and bounded for every bit pattern of `state` and `input`.
///
/// ```
/// use palpate_core::force::Force;
/// use palpate_core::servo::{Axis, Input, Limits, Mode, Request, Sample, State, Table, step};
///
/// # let axis = Axis::new(&[0.0, 0.5], &[2.0]).expect("an axis");
/// # let forces = [0.0, 0.0, 4.0, 4.0].map(|normal| Force { lateral: 0.0, normal });
/// # let table = Table::new(axis, axis, &forces).expect("a table");
/// let limits = Limits::new(2.0, 0.05, 0.25, 10)?;
/// let input = |sequence, deadman, request| Input {
///     sample: Some(Sample { sequence, deadman, device_fault: false, depth: 0.1, lateral: 0.0 }),
///     request,
/// };
/// let (state, _) = step(&table, &limits, State::default(), input(1, false, Request::None));
/// let (state, _) = step(&table, &limits, state, input(2, false, Request::Arm));
/// assert_eq!(state.mode, Mode::Armed);
/// // The hand holds on. The table says 0.8 N, and the slew allows 0.05 N of it in this cycle.
/// let (_, command) = step(&table, &limits, state, input(3, true, Request::None));
/// assert!(command.playing && command.force.normal == 0.05);
/// # Ok::<(), palpate_core::servo::InvalidLimits>(())
/// ```
///
/// Implements: SRV-001, SRV-020, SRV-021, SRV-030, SRV-031, SRV-060, SRV-070, HID-024, SRV-040.
#[inline]
pub fn step(table: &Table, limits: &Limits, state: State, input: Input) -> (State, Command) {
    let sample = input.sample.unwrap_or(NO_SAMPLE);
    let came = input.sample.is_some();
    let fresh = came && is_fresh(state.sequence, sample.sequence);
    let missed = if fresh {
        0
    } else {
        state.missed.saturating_add(1)
    };
    let sound = is_sound(&state, limits);
    let last = if sound { state.force } else { Force::ZERO };

    let cause = fault(&sample, sound, state.mode, missed > limits.watchdog());
    let may_arm = fresh && !sample.deadman && last == Force::ZERO && !state.arming;
    let mode = next_mode(state.mode, cause, input.request, may_arm);

    let held = mode == Mode::Armed && sample.deadman;
    let playing = held && fresh;
    // A force that is played falls quickly, since one that lags behind a hand that withdraws would push it. Without a fresh
    // sample it falls slowly, and the watchdog decides.
    let fall = if held && !fresh {
        limits.slew()
    } else {
        limits.release()
    };
    // Computed in any case, so that the time is the same; `Table::force` in effect, since nothing is
    // played above the surface.
    let force = table.continued(sample.depth, sample.lateral);
    let target = if playing && sample.depth >= 0.0 {
        force
    } else {
        Force::ZERO
    };
    // Between the last force and the target, both within the limit.
    let component = |last, target| {
        let target = limit(target, limits.force());
        approach(last, target, limits.slew(), fall)
    };
    let force = Force::new(
        component(last.lateral, target.lateral),
        component(last.normal, target.normal),
    );
    let taken_over = came && (fresh || mode != Mode::Armed);
    let next = State {
        mode,
        force,
        sequence: if taken_over {
            Some(sample.sequence)
        } else {
            state.sequence
        },
        missed,
        arming: input.request == Request::Arm,
    };
    (next, Command { force, playing })
}

/// Whether the sample is ahead of the last one.
///
/// Implements: SRV-040.
#[inline]
fn is_fresh(last: Option<u16>, sequence: u16) -> bool {
    last.is_some_and(|last| (1..=MOST_AHEAD).contains(&sequence.wrapping_sub(last)))
}

/// Whether a step can have left this state: its force is within the limits.
#[inline]
fn is_sound(state: &State, limits: &Limits) -> bool {
    let Force { lateral, normal } = state.force;
    lateral.abs() <= limits.force() && normal.abs() <= limits.force()
}

/// What is wrong in this cycle, the gravest first.
///
/// Implements: SRV-035, SRV-042.
#[inline]
fn fault(sample: &Sample, sound: bool, mode: Mode, late: bool) -> Option<Fault> {
    if !sound {
        Some(Fault::State)
    } else if !(sample.depth.is_finite() && sample.lateral.is_finite()) {
        Some(Fault::NotFinite)
    } else if sample.device_fault {
        Some(Fault::Device)
    } else if late && mode == Mode::Armed {
        Some(Fault::Watchdog)
    } else {
        None
    }
}

/// The mode after this cycle: a fault before a request, and the first fault until it is armed again.
///
/// Implements: SRV-032, SRV-033.
#[inline]
fn next_mode(mode: Mode, cause: Option<Fault>, request: Request, may_arm: bool) -> Mode {
    if let Mode::Faulted(_) = mode {
        let arm = may_arm && cause.is_none() && request == Request::Arm;
        return if arm { Mode::Armed } else { mode };
    }
    match (cause, request) {
        (Some(cause), _) => Mode::Faulted(cause),
        (None, Request::Disarm) => Mode::Disarmed,
        (None, Request::Arm) if may_arm => Mode::Armed,
        (None, _) => mode,
    }
}

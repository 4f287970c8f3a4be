//! The servo kernel: a force table, and one cycle of the loop at 1 kHz.
//!
//! Implements: CLB-003, CLB-010, CLB-012.

use palpate_core::force::Force;
use palpate_core::servo::{self, Axis, Fault, Limits, Mode, Table};
pub use palpate_core::servo::{Cell, Request};

use crate::Error;
use crate::memory::{Kept, bytes, check_apart, give, list, list_mut, read};

/// A force on the probe, N.
pub type ServoForce = Force<f32>;

/// What `palpate_table_init` makes of knots and forces, to which it keeps pointers. Its content is the library's.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PreparedTable {
    kept: Kept,
}

const TAG: usize = 0x7ab1_e5e7;

/// The table at an address.
///
/// # Safety
/// As the crate says; knots, reciprocals and forces are where they were when the table was made.
unsafe fn table<'a>(place: *const PreparedTable) -> Result<&'a Table<'a>, Error> {
    unsafe { Kept::get(place.cast(), TAG) }
}

/// An axis with the reciprocals of its cells, which are written into `reciprocals`.
fn axis<'a>(knots: &'a [f32], reciprocals: &'a mut [f32]) -> Result<Axis<'a>, Error> {
    for (reciprocal, ends) in reciprocals.iter_mut().zip(knots.windows(2)) {
        *reciprocal = Axis::reciprocal_width(ends[0], ends[1]);
    }
    Ok(Axis::new(knots, reciprocals)?)
}

/// Makes a table of depths and lateral positions (m, increasing) and of the force at each pair (N): `depths` rows of `laterals`
/// forces. `scratch` has depths + laterals − 2 numbers.
///
/// The table keeps pointers to all four lists: they must stay where they are, unchanged, as long as it is used.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_table_init(
    depth_knots_m: *const f32,
    depths: usize,
    lateral_knots_m: *const f32,
    laterals: usize,
    forces_n: *const ServoForce,
    scratch: *mut f32,
    scratch_length: usize,
    table: *mut PreparedTable,
) -> Error {
    let make = || {
        if !(2..=servo::MAX_KNOTS).contains(&depths) || !(2..=servo::MAX_KNOTS).contains(&laterals)
        {
            return Err(Error::Knots);
        }
        let nodes = depths * laterals;
        if scratch_length != depths + laterals - 2 {
            return Err(Error::Length);
        }
        check_apart(
            &[bytes(scratch, scratch_length), bytes(table, 1)],
            &[
                bytes(depth_knots_m, depths),
                bytes(lateral_knots_m, laterals),
                bytes(forces_n, nodes),
            ],
        )?;
        let depth_knots = unsafe { list(depth_knots_m, depths) }?;
        let lateral_knots = unsafe { list(lateral_knots_m, laterals) }?;
        let forces = unsafe { list(forces_n, nodes) }?;
        let scratch = unsafe { list_mut(scratch, scratch_length) }?;
        let (depth_reciprocals, lateral_reciprocals) = scratch.split_at_mut(depths - 1);
        let depths = axis(depth_knots, depth_reciprocals)?;
        let laterals = axis(lateral_knots, lateral_reciprocals)?;
        Ok(PreparedTable {
            kept: Kept::new(TAG, Table::new(depths, laterals, forces)?),
        })
    };
    unsafe { give(table, make) }
}

/// The force of a table at a depth and lateral position (m): bilinear, continued one cell beyond the border, zero above the
/// surface. Total for every bit pattern of the position.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_table_force(
    prepared: *const PreparedTable,
    depth_m: f32,
    lateral_m: f32,
    force: *mut ServoForce,
) -> Error {
    let found = || Ok(unsafe { table(prepared) }?.force(depth_m, lateral_m));
    unsafe { give(force, found) }
}

/// Cell and fraction of a position on an axis of `count` knots (m). `scratch` has count − 1 numbers. To compare with another
/// kernel: it checks the axis anew in each call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_axis_locate(
    knots_m: *const f32,
    count: usize,
    scratch: *mut f32,
    scratch_length: usize,
    position_m: f32,
    cell: *mut Cell,
) -> Error {
    let found = || {
        if count != scratch_length.saturating_add(1) {
            return Err(Error::Length);
        }
        check_apart(&[bytes(scratch, scratch_length)], &[bytes(knots_m, count)])?;
        let knots = unsafe { list(knots_m, count) }?;
        let reciprocals = unsafe { list_mut(scratch, scratch_length) }?;
        Ok(axis(knots, reciprocals)?.locate(position_m))
    };
    unsafe { give(cell, found) }
}

/// What the commands must keep to, component by component (SRV-022).
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct ServoLimits {
    /// Largest magnitude of a force, N; at most 20.
    pub force_n: f32,
    /// Largest growth in one cycle, N; from 1e-4 to `force_n`.
    pub slew_n: f32,
    /// Largest fall in one cycle, N; at least `slew_n` and 1/16 of `force_n`.
    pub release_n: f32,
    /// Longest run of cycles without a fresh sample that is no fault, 1 to 100.
    pub watchdog_cycles: u16,
}

/// Whether there may be a force.
#[repr(u8)]
#[derive(Debug, Clone, Copy)]
pub enum ServoMode {
    /// Not yet.
    Disarmed,
    /// Yes, while the deadman is held and samples are fresh.
    Armed,
    /// Not until it is armed again: a position is NaN or infinite.
    FaultNotFinite,
    /// Not until it is armed again: the device reported a fault.
    FaultDevice,
    /// Not until it is armed again: too many cycles without a fresh sample.
    FaultWatchdog,
    /// Not until it is armed again: the state was overwritten.
    FaultState,
}

/// By their numbers.
const REQUESTS: [Request; 3] = [Request::None, Request::Arm, Request::Disarm];

/// In the order of `ServoMode`.
const MODES: [Mode; 6] = [
    Mode::Disarmed,
    Mode::Armed,
    Mode::Faulted(Fault::NotFinite),
    Mode::Faulted(Fault::Device),
    Mode::Faulted(Fault::Watchdog),
    Mode::Faulted(Fault::State),
];

/// What one cycle leaves to the next. All zero is the state to begin with.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct ServoState {
    /// The last command, N.
    pub force: ServoForce,
    /// The number of the last sample taken over.
    pub sequence: u16,
    /// Cycles since the last fresh sample.
    pub missed: u16,
    /// A `PALPATE_SERVO_MODE_…`.
    pub mode: u8,
    /// 1 if `sequence` is the number of a sample.
    pub has_sequence: u8,
    /// 1 if the last cycle had a request to arm.
    pub arming: u8,
    /// 0.
    pub reserved: u8,
}

impl From<ServoState> for servo::State {
    fn from(state: ServoState) -> servo::State {
        let mode = MODES.get(usize::from(state.mode)).copied();
        // No step leaves a NaN: of a mode that does not exist the kernel takes over nothing.
        let overwritten = Force::new(f32::NAN, f32::NAN);
        servo::State {
            mode: mode.unwrap_or(Mode::Faulted(Fault::State)),
            force: mode.map_or(overwritten, |_| state.force),
            sequence: (state.has_sequence != 0).then_some(state.sequence),
            missed: state.missed,
            arming: state.arming != 0,
        }
    }
}

impl From<servo::State> for ServoState {
    fn from(state: servo::State) -> ServoState {
        ServoState {
            force: state.force,
            sequence: state.sequence.unwrap_or(0),
            missed: state.missed,
            mode: match state.mode {
                Mode::Disarmed => ServoMode::Disarmed as u8,
                Mode::Armed => ServoMode::Armed as u8,
                Mode::Faulted(Fault::NotFinite) => ServoMode::FaultNotFinite as u8,
                Mode::Faulted(Fault::Device) => ServoMode::FaultDevice as u8,
                Mode::Faulted(Fault::Watchdog) => ServoMode::FaultWatchdog as u8,
                Mode::Faulted(Fault::State) => ServoMode::FaultState as u8,
            },
            has_sequence: state.sequence.is_some().into(),
            arming: state.arming.into(),
            reserved: 0,
        }
    }
}

/// One report of the device, in metres.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct ServoSample {
    /// Depth of the probe, m.
    pub depth_m: f32,
    /// Lateral position of the probe, m.
    pub lateral_m: f32,
    /// Its number, modulo 65536.
    pub sequence: u16,
    /// Not 0 while the deadman switch is held.
    pub deadman: u8,
    /// Not 0 if the device says that something is wrong with it.
    pub device_fault: u8,
}

/// What one cycle tells the device.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct ServoCommand {
    /// The force to play, N.
    pub force: ServoForce,
    /// 1 while the force follows the table; otherwise it is on its way to zero.
    pub playing: u8,
    /// 0.
    pub reserved: [u8; 3],
}

/// One cycle of the servo loop: from `state`, the newest sample (null if none came) and a `PALPATE_SERVO_REQUEST_…` to the next state and the
/// command. A refused call commands no force, from which the force of the next call grows, unless `command` is null or overlaps something;
/// it leaves the rest of the state, and all of a state that overlaps something.
///
/// Total and bounded for every bit pattern of state and sample: a mode that does not exist counts as memory overwritten, a request
/// that does not exist disarms.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_step(
    prepared: *const PreparedTable,
    limits: *const ServoLimits,
    sample: *const ServoSample,
    request: u8,
    state: *mut ServoState,
    command: *mut ServoCommand,
) -> Error {
    const NONE: ServoCommand = ServoCommand {
        force: Force::ZERO,
        playing: 0,
        reserved: [0; 3],
    };
    let inputs = || [bytes(prepared, 1), bytes(limits, 1), bytes(sample, 1)];
    let [of_prepared, of_limits, of_sample] = inputs();
    let others = [of_prepared, of_limits, of_sample, bytes(state, 1)];
    if let Err(error) = check_apart(&[bytes(command, 1)], &others) {
        return error;
    }
    // First, so that a call that is refused below leaves no old force.
    let given = unsafe { give(command, || Ok(NONE)) };
    if given != Error::Ok {
        return given;
    }
    if let Err(error) = check_apart(&[bytes(state, 1)], &inputs()) {
        return error;
    }
    let cycle = || {
        let table = unsafe { table(prepared) }?;
        let ServoLimits {
            force_n,
            slew_n,
            release_n,
            watchdog_cycles,
        } = unsafe { read(limits) }?;
        let limits = Limits::new(force_n, slew_n, release_n, watchdog_cycles)?;
        let sample = if sample.is_null() {
            None
        } else {
            Some(unsafe { read(sample) }?.into())
        };
        let input = servo::Input {
            sample,
            request: *REQUESTS
                .get(usize::from(request))
                .unwrap_or(&Request::Disarm),
        };
        let state = unsafe { read(state) }?;
        Ok(servo::step(table, &limits, state.into(), input))
    };
    let (next, played) = match cycle() {
        Ok(done) => done,
        Err(error) => {
            // The device was told 0 N: the next force grows from there, not from the last one. Without a state nothing grows.
            let rested = || {
                Ok(ServoState {
                    force: Force::ZERO,
                    ..unsafe { read(state) }?
                })
            };
            unsafe { give(state, rested) };
            return error;
        }
    };
    let played = ServoCommand {
        force: played.force,
        playing: played.playing.into(),
        reserved: [0; 3],
    };
    unsafe {
        give(state, || Ok(next.into()));
        give(command, || Ok(played))
    }
}

impl From<ServoSample> for servo::Sample {
    fn from(sample: ServoSample) -> servo::Sample {
        servo::Sample {
            sequence: sample.sequence,
            deadman: sample.deadman != 0,
            device_fault: sample.device_fault != 0,
            depth: sample.depth_m,
            lateral: sample.lateral_m,
        }
    }
}

impl From<servo::Sample> for ServoSample {
    fn from(sample: servo::Sample) -> ServoSample {
        ServoSample {
            depth_m: sample.depth,
            lateral_m: sample.lateral,
            sequence: sample.sequence,
            deadman: sample.deadman.into(),
            device_fault: sample.device_fault.into(),
        }
    }
}

//! The servo kernel, for tests of controllers.

use palpate::servo::{self, Fault, Input, LoadedTable, Mode, Request};
use pyo3::prelude::*;

use crate::classes::ForceMap;
use crate::convert::{refused, si};

/// A finite number of the kernel's, from mm or as it is.
fn single(name: &str, value: f64, power: i32) -> PyResult<f32> {
    let value = si(name, value, power)? as f32;
    let beyond = || refused(format!("{name} is beyond the largest f32"));
    value.is_finite().then_some(value).ok_or_else(beyond)
}

/// The table that the servo kernel plays: the forces of a force map (N over m) in single precision, with the surface in front.
#[pyclass(frozen, module = "palpate")]
pub struct ServoTable(LoadedTable);

#[pymethods]
impl ServoTable {
    #[new]
    fn new(map: &ForceMap) -> PyResult<ServoTable> {
        let table = LoadedTable::new(map.0.table());
        Ok(ServoTable(table.map_err(refused)?))
    }

    /// The force (lateral, normal) in N at a pose in mm, as the kernel computes it in single precision.
    fn force(&self, depth_mm: f64, lateral_mm: f64) -> PyResult<(f32, f32)> {
        let depth = single("depth_mm", depth_mm, -3)?;
        let lateral = single("lateral_mm", lateral_mm, -3)?;
        let force = self.0.table().force(depth, lateral);
        Ok((force.lateral, force.normal))
    }

    /// The stiffness of the table, N/m: its steepest slope.
    #[getter]
    fn stiffness_n_per_m(&self) -> f64 {
        servo::stiffness(&self.0.table())
    }
}

/// What commands must keep to, in N a component: the largest force, its growth and its fall in a cycle, and the longest run of cycles
/// without a fresh sample.
#[pyclass(frozen, module = "palpate")]
pub struct Limits(servo::Limits);

#[pymethods]
impl Limits {
    #[new]
    fn new(force_n: f32, slew_n: f32, release_n: f32, watchdog: u16) -> PyResult<Limits> {
        let limits = servo::Limits::new(force_n, slew_n, release_n, watchdog);
        Ok(Limits(limits.map_err(refused)?))
    }
}

/// One report of the device: its number modulo 65536, the pose in mm, whether the deadman switch is held, and whether the device
/// reports a fault. A pose may be NaN or infinite: the kernel makes a fault of it.
#[pyclass(frozen, module = "palpate")]
pub struct Sample(servo::Sample);

#[pymethods]
impl Sample {
    #[new]
    #[pyo3(signature = (sequence, depth_mm, lateral_mm, deadman, device_fault=false))]
    fn new(
        sequence: u16,
        depth_mm: f64,
        lateral_mm: f64,
        deadman: bool,
        device_fault: bool,
    ) -> Sample {
        let metres = |mm: f64| si("", mm, -3).unwrap_or(mm) as f32;
        Sample(servo::Sample {
            sequence,
            deadman,
            device_fault,
            depth: metres(depth_mm),
            lateral: metres(lateral_mm),
        })
    }
}

/// What one cycle leaves to the next; ServoState() is the first.
#[pyclass(frozen, module = "palpate")]
#[derive(Default)]
pub struct ServoState(servo::State);

#[pymethods]
impl ServoState {
    #[new]
    fn new() -> ServoState {
        ServoState::default()
    }

    /// "disarmed", "armed", or "faulted".
    #[getter]
    fn mode(&self) -> &'static str {
        match self.0.mode {
            Mode::Disarmed => "disarmed",
            Mode::Armed => "armed",
            Mode::Faulted(_) => "faulted",
        }
    }

    /// Why there is no force, in words; None without a fault.
    #[getter]
    fn fault(&self) -> Option<String> {
        match self.0.mode {
            Mode::Faulted(fault) => Some(Fault::to_string(&fault)),
            _ => None,
        }
    }

    /// The last command (lateral, normal), N.
    #[getter]
    fn force_n(&self) -> [f32; 2] {
        self.0.force.into_array()
    }

    /// Cycles since the last fresh sample.
    #[getter]
    fn missed(&self) -> u16 {
        self.0.missed
    }
}

/// One cycle of the servo kernel: (next state, force (lateral, normal) in N, playing), where playing says that the force follows the
/// table. sample: the newest report, None if none came; request: "none", "arm" or "disarm".
#[pyfunction]
#[pyo3(signature = (table, limits, state, sample=None, request="none"))]
pub fn step(
    table: &ServoTable,
    limits: &Limits,
    state: &ServoState,
    sample: Option<&Sample>,
    request: &str,
) -> PyResult<(ServoState, [f32; 2], bool)> {
    let request = match request {
        "none" => Request::None,
        "arm" => Request::Arm,
        "disarm" => Request::Disarm,
        other => {
            let message = format!("request is {other:?}, but must be none, arm or disarm");
            return Err(refused(message));
        }
    };
    let sample = sample.map(|sample| sample.0);
    let table = table.0.table();
    let (next, command) = servo::step(&table, &limits.0, state.0, Input { sample, request });
    Ok((
        ServoState(next),
        command.force.into_array(),
        command.playing,
    ))
}

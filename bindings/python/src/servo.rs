//! The servo kernel, for tests of controllers.

use palpate::servo::{self, Fault, Input, LoadedTable, Mode, Request};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::classes::ForceMap;
use crate::convert::{doubt_metres, in_unit, refused, si};

/// A finite number of the kernel's, from mm or as it is.
fn single(name: &str, value: f64, power: i32) -> PyResult<f32> {
    let value = si(name, value, power)? as f32;
    let beyond = || refused(format!("{name} is beyond the largest f32"));
    value.is_finite().then_some(value).ok_or_else(beyond)
}

/// The table that the servo kernel plays: the forces of a force map (N over m) in single precision, with the surface in front.
#[doc = sections!(map: "ForceMap" = "Both forces, N.";; "A map without lateral forces, or beyond what the kernel plays.")]
#[pyclass(frozen, module = "palpate")]
pub struct ServoTable {
    table: LoadedTable,
    map: Py<ForceMap>,
}

#[pymethods]
impl ServoTable {
    #[new]
    fn new(map: Py<ForceMap>) -> PyResult<ServoTable> {
        let table = LoadedTable::new(map.get().0.table()).map_err(refused)?;
        Ok(ServoTable { table, map })
    }

    /// The force of ForceMap.force as the kernel computes it in single precision. What the kernel plays beyond the map, step says.
    #[doc = sections!(depth_mm, lateral_mm; "(float, float)" = "Lateral and normal force, N."; "A pose beyond the map.")]
    // Implements: PYT-040.
    fn force(&self, py: Python<'_>, depth_mm: f64, lateral_mm: f64) -> PyResult<(f32, f32)> {
        doubt_metres(py, "depth_mm", &[depth_mm])?;
        let depth = single("depth_mm", depth_mm, -3)?;
        let lateral = single("lateral_mm", lateral_mm, -3)?;
        let [d, x] =
            [("depth_mm", depth_mm), ("lateral_mm", lateral_mm)].map(|(name, mm)| si(name, mm, -3));
        self.map.get().at(d?, x?).map_err(refused)?;
        let force = self.table.table().force(depth, lateral);
        Ok((force.lateral, force.normal))
    }

    /// The stiffness of the table, N/m: its steepest slope.
    #[getter]
    fn stiffness_n_per_m(&self) -> f64 {
        servo::stiffness(&self.table.table())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyType>, (Py<ForceMap>,)) {
        let map = slf.get().map.clone_ref(slf.py());
        (slf.get_type(), (map,))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("ServoTable({})", self.map.bind(py).repr()?))
    }
}

/// What commands must keep to.
#[doc = sections!(
    force_n: "float" = "The largest force of a component, N.",
    slew_n: "float" = "Its largest growth in a cycle, N.",
    release_n: "float" = "Its largest fall in a cycle, at least slew_n and 1/16 of force_n, N.",
    watchdog: "int" = "The longest run of cycles without a fresh sample, 1 to 100.";;
    "Limits that the kernel does not keep to."
)]
#[pyclass(frozen, module = "palpate")]
pub struct Limits(servo::Limits);

#[pymethods]
impl Limits {
    #[new]
    fn new(force_n: f32, slew_n: f32, release_n: f32, watchdog: u16) -> PyResult<Limits> {
        let limits = servo::Limits::new(force_n, slew_n, release_n, watchdog);
        Ok(Limits(limits.map_err(refused)?))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyType>, (f32, f32, f32, u16)) {
        let of = slf.get().0;
        let limits = (of.force(), of.slew(), of.release(), of.watchdog());
        (slf.get_type(), limits)
    }

    fn __repr__(&self) -> String {
        let (force, slew, release) = (self.0.force(), self.0.slew(), self.0.release());
        let watchdog = self.0.watchdog();
        format!(
            "Limits(force_n={force:?}, slew_n={slew:?}, release_n={release:?}, watchdog={watchdog})"
        )
    }
}

/// One report of the device. A pose may be NaN or infinite: the kernel makes a fault of it.
#[doc = sections!(
    sequence: "int" = "The number of the report, modulo 65536.",
    depth_mm, lateral_mm,
    deadman: "bool" = "Whether the deadman switch is held.",
    device_fault: "bool, optional" = "Whether the device reports a fault.";;
)]
#[pyclass(frozen, module = "palpate")]
pub struct Sample(servo::Sample);

impl Sample {
    /// Depth and lateral position, mm, with the digits that an f32 has.
    fn pose_mm(&self) -> [f64; 2] {
        let mm = |metres: f32| {
            metres
                .to_string()
                .parse()
                .map_or(f64::NAN, |metres| in_unit(metres, 3))
        };
        [self.0.depth, self.0.lateral].map(mm)
    }
}

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

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> (Bound<'py, PyType>, (u16, f64, f64, bool, bool)) {
        let of = slf.get();
        let [depth, lateral] = of.pose_mm();
        let arguments = (
            of.0.sequence,
            depth,
            lateral,
            of.0.deadman,
            of.0.device_fault,
        );
        (slf.get_type(), arguments)
    }

    fn __repr__(&self) -> String {
        let ([depth, lateral], sequence) = (self.pose_mm(), self.0.sequence);
        let [deadman, fault] =
            [self.0.deadman, self.0.device_fault].map(|is| if is { "True" } else { "False" });
        format!(
            "Sample({sequence}, depth_mm={depth:?}, lateral_mm={lateral:?}, deadman={deadman}, device_fault={fault})"
        )
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

    fn __repr__(&self) -> String {
        let (mode, force, missed) = (self.mode(), self.force_n(), self.missed());
        let fault = self
            .fault()
            .map_or(String::new(), |fault| format!(" ({fault})"));
        format!("<ServoState {mode}{fault}, force_n {force:?}, missed {missed}>")
    }
}

/// One cycle of the servo kernel.
///
/// To arm, ask in one cycle after the first, with a fresh sample and the deadman switch not held; then hold it.
#[doc = sections!(
    table: "ServoTable" = "What is played.",
    limits: "Limits" = "What commands must keep to.",
    state: "ServoState" = "What the last cycle left.",
    sample: "Sample, optional" = "The newest report; None if none came.",
    request: "str, optional" = "\"none\", \"arm\" or \"disarm\".";
    "(ServoState, [float, float], bool)" = "The next state; lateral and normal force, N; whether the force follows the table.";
    "Another request."
)]
/// Examples
/// --------
/// >>> table = ServoTable(Phantom("none").map([1, 4], [-5, 0, 5], mesh_mm=2))
/// >>> limits, state = Limits(3, 0.05, 0.25, 5), ServoState()
/// >>> for cycle in range(100):
/// ...     sample = Sample(cycle, 2.0, 0.0, deadman=cycle > 1)
/// ...     state, force, playing = step(table, limits, state, sample, "arm" if cycle == 1 else "none")
/// >>> state.mode, playing, force[1] == table.force(2, 0)[1]
/// ('armed', True, True)
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
    let table = table.table.table();
    let (next, command) = servo::step(&table, &limits.0, state.0, Input { sample, request });
    Ok((
        ServoState(next),
        command.force.into_array(),
        command.playing,
    ))
}

//! A force table, played on a simulated haptic display at 1 kHz: `cargo run -p palpate --example table_to_servo`.

use std::error::Error;
use std::time::Duration;

use palpate::force::Force;
use palpate::force_map::{ForceTable, Matrix};
use palpate::hid::simulated::{Mechanics, PAPER, SimulatedDevice, Trajectory};
use palpate::hid::{HapticDevice, Session};
use palpate::servo::{Limits, LoadedTable};

fn main() -> Result<(), Box<dyn Error>> {
    // A spring of 300 N/m with a bump about x = 0, over 4 mm of depth and 40 mm of width.
    let axis = |from: i32, to: i32| (from..=to).map(|step| 1e-3 * f64::from(step)).collect();
    let (depths, laterals): (Vec<f64>, Vec<f64>) = (axis(0, 4), axis(-20, 20));
    let normal = Matrix::from_fn(depths.len(), laterals.len(), |row, column| {
        let x = laterals[column] / 4e-3;
        depths[row] * (300.0 + 60.0 * (-x * x).exp())
    });
    let lateral = Matrix::from_fn(depths.len(), laterals.len(), |_, _| 0.0);
    let table = ForceTable::new(depths, laterals, Force::new(lateral, normal))?;

    // The hand presses 3 mm deep and sweeps over 20 mm; the loop answers each report with a force.
    let loaded = LoadedTable::new(&table)?;
    let hand = Trajectory::probing(3e-3, 10e-3, Duration::from_millis(500));
    let duration = hand.duration();
    let device = SimulatedDevice::new(PAPER, Mechanics::PAPER, hand, Vec::new());
    let limits = Limits::for_playback(4.0, PAPER.period_us)?;
    let mut session = Session::begin(device, loaded.table(), limits)?;
    let unit = 1e-6 * f64::from(session.capabilities().force_unit_un);
    let mut strongest = 0.0f64;
    let end = session.run(|cycle, _| {
        strongest = strongest.max(unit * f64::from(cycle.force.normal));
        cycle.written < duration
    });
    println!("{end:?} after {:?}", session.device().now());
    println!("strongest normal force: {strongest:.2} N");
    println!("{:?}", session.counters());
    Ok(())
}

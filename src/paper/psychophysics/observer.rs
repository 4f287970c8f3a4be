//! One sample, as a hand feels it: played through device, servo and table; and the ideal observer of the paper's theory, who knows
//! both force maps and his own noise, and takes the sample of the pair with the larger Θ.

use std::fmt::Display;
use std::time::Duration;

use super::Interval;
use palpate::detect::theta_of_record;
use palpate::force::Force;
use palpate::force_map::{ForceTable, Hypotheses};
use palpate::hid::{Counters, DeviceState, End, HapticDevice, Session};
use palpate::refusal::Refusal;
use palpate::servo::{Limits, Table};
use palpate::stats::random::Generator;

/// The stream of the generator that the observer's noise is drawn from.
const STREAM: u64 = 0x0B5E;

/// Where the handle was, and what was played, while the force followed the table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Felt {
    /// Depths, m.
    pub depths: Vec<f64>,
    /// Lateral positions, m.
    pub laterals: Vec<f64>,
    /// Forces as sent to the device: x lateral, y normal, N.
    pub forces: Force<Vec<f64>>,
    /// What happened.
    pub counters: Counters,
}

/// Plays `table` on `device` for `duration` of the device's time from the first force on, at most
/// `patience` from the beginning. `None` if `stop` said so before.
///
/// # Errors
/// The device was refused, or ended early; nothing was played.
///
/// Implements: PSY-010.
pub fn present<D: HapticDevice>(
    device: D,
    table: Table,
    limits: Limits,
    duration: Duration,
    patience: Duration,
    stop: impl Fn() -> bool,
) -> Result<Option<Felt>, Refusal> {
    let mut session = Session::begin(device, table, limits).map_err(refused)?;
    let capabilities = *session.capabilities();
    let metres = f64::from(capabilities.position_unit_nm) * 1e-9;
    let newtons = f64::from(capabilities.force_unit_un) * 1e-6;
    let mut felt = Felt::default();
    let mut began = None;
    let end = session.run(|cycle, _| {
        if let (true, Some(position)) = (cycle.playing, cycle.position) {
            began.get_or_insert(cycle.written);
            felt.depths.push(-f64::from(position.normal) * metres);
            felt.laterals.push(f64::from(position.lateral) * metres);
            let force = cycle.force;
            let forces = &mut felt.forces;
            forces.lateral.push(f64::from(force.lateral) * newtons);
            forces.normal.push(f64::from(force.normal) * newtons);
        }
        let until = began.map_or(patience, |began| began + duration);
        cycle.written < until && !stop()
    });
    felt.counters = session.counters();
    match end {
        End::Asked if stop() => Ok(None),
        // A signal that interrupts a read is the wish to stop, where there is one.
        End::Device(error) if error.state == DeviceState::Interrupted && stop() => Ok(None),
        End::Asked if began.is_none() => {
            let found = format!("nothing was played within {} s", patience.as_secs());
            Err(Refusal::state(
                found,
                "hold the deadman while a sample is played",
            ))
        }
        End::Asked => Ok(Some(felt)),
        end => Err(refused(end)),
    }
}

/// Knows what to expect.
///
/// ```
/// use palpate::force::Force;
/// use palpate::force_map::{ForceTable, Hypotheses, Matrix};
/// use palpate_paper::psychophysics::{Felt, IdealObserver, Interval};
///
/// let map = |force: f64| {
///     let matrix = |force| Matrix::from_fn(2, 2, |_, _| force);
///     ForceTable::new(vec![0.0, 0.004], vec![0.0, 0.01], Force::new(matrix(0.0), matrix(force)))
/// };
/// let felt = |force: f64| Felt {
///     depths: vec![0.004; 2],
///     laterals: vec![0.0, 0.005],
///     forces: Force { lateral: vec![0.0; 2], normal: vec![force; 2] },
///     ..Felt::default()
/// };
/// let (reference, inclusion) = (map(1.5)?, map(1.75)?);
/// let hypotheses = Hypotheses::of_tables(&reference, &inclusion)?;
/// let observer = IdealObserver { hypotheses, noise_sd: 0.025, seed: 1 };
/// // Two samples with Δ/s = 10: γ² = 200, and hardly ever a wrong answer.
/// let (_, gamma) = observer.theta(&felt(1.5), 0)?;
/// assert!((gamma - 200.0_f64.sqrt()).abs() < 1e-9);
/// assert_eq!(observer.choose(&felt(1.5), &felt(1.75), 0)?, Interval::Second);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct IdealObserver<'a> {
    /// The forces without and with the inclusion.
    pub hypotheses: Hypotheses<'a>,
    /// Standard deviation of the noise on each sample of each channel, N.
    pub noise_sd: f64,
    /// Seed of the noise.
    pub seed: u64,
}

impl IdealObserver<'_> {
    /// θ of one sample felt with noise, and γ of the way that the hand took; `draw` tells the noises
    /// apart.
    ///
    /// # Errors
    /// The maps give no force where the hand was, or the detector refuses the record.
    ///
    /// Implements: PSY-011.
    pub fn theta(&self, felt: &Felt, draw: u64) -> Result<(f64, f64), Refusal> {
        let expected = |table: &ForceTable| -> Result<_, Refusal> {
            let mut forces = Force::<Vec<f64>>::default();
            for (&depth, &lateral) in felt.depths.iter().zip(&felt.laterals) {
                // Nothing is played above the surface.
                let force = table.force(depth.max(0.0), lateral)?;
                forces.lateral.push(force.lateral);
                forces.normal.push(force.normal);
            }
            Ok(forces)
        };
        let f0 = expected(self.hypotheses.without())?;
        let f1 = expected(self.hypotheses.with())?;
        let noisy = |forces: &[f64], channel| -> Vec<f64> {
            let mut noise = vec![0.0; forces.len()];
            Generator::new(self.seed, STREAM + channel).normals(draw, 0, &mut noise);
            let noisy = noise.iter().zip(forces);
            noisy.map(|(n, force)| force + self.noise_sd * n).collect()
        };
        let observed = Force {
            lateral: noisy(&felt.forces.lateral, 0),
            normal: noisy(&felt.forces.normal, 1),
        };
        let statistic = theta_of_record(
            observed.as_deref(),
            f0.as_deref(),
            f1.as_deref(),
            Force::new(self.noise_sd, self.noise_sd),
        )?;
        Ok((statistic.theta, statistic.gamma))
    }

    /// Which of two samples has the inclusion, by the larger θ.
    ///
    /// # Errors
    /// As [`IdealObserver::theta`].
    ///
    /// Implements: PSY-011, PSY-013.
    pub fn choose(&self, first: &Felt, second: &Felt, pair: u64) -> Result<Interval, Refusal> {
        let (of_first, _) = self.theta(first, 2 * pair)?;
        let (of_second, _) = self.theta(second, 2 * pair + 1)?;
        Ok(if of_first >= of_second {
            Interval::First
        } else {
            Interval::Second
        })
    }
}

fn refused(reason: impl Display) -> Refusal {
    Refusal::state(reason, "")
}

//! Records as a laboratory would take them: a stage or a hand leads the probe along a path over a gel, and a sensor writes down what it
//! feels (`spec/simulation.md`).
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the gel and the sensor |
//! | `path.rs` | where the probe is sent, and when samples are taken |
//! | `motion.rs` | where a stage or a hand really is |

mod motion;
mod path;
#[cfg(test)]
mod tests;

use std::fmt::Write as _;

use crate::calibration::relaxed;
use crate::force::Force;
use crate::force_map::ForceTable;
use crate::refusal::Refusal;
use crate::stats::random::Generator;

pub use motion::{Hand, Motion, Tremor};
pub use path::Path;

/// A gel, what leads the probe over it, and a sensor.
#[derive(Debug, Clone)]
pub struct Simulation<'a> {
    /// Forces at depths from 0 on, and at all positions of the path.
    pub gel: &'a ForceTable,
    /// Where the probe is sent.
    pub path: &'a Path,
    /// What leads it there.
    pub motion: Motion,
    /// The share of the force that relaxes, and the time constant of that, s.
    pub relaxation: Option<[f64; 2]>,
    /// Coefficient of friction between probe and gel.
    pub friction: f64,
    /// What measures the forces and the depth.
    pub sensor: Sensor,
    /// Seed of all that is random.
    pub seed: u64,
}

/// A force sensor, and an encoder of the depth; by default without errors.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sensor {
    /// Standard deviation of the noise of a sample, N.
    pub noise_sd: Force<f64>,
    /// Correlation of the noise of neighbouring samples.
    pub correlation: f64,
    /// Standard deviation, from record to record, of the offset of each force, N.
    pub offset_sd: f64,
    /// The same of the drift from the first to the last sample, N.
    pub drift_sd: f64,
    /// Forces are multiples of it, N; 0 if they are exact.
    pub resolution: f64,
    /// Standard deviation of the error of each depth, m.
    pub depth_sd: f64,
}

/// A simulated record.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedRecord {
    /// The time of each sample, s.
    pub times: Vec<f64>,
    /// Where the probe was, m.
    pub positions: Vec<f64>,
    /// The measured depth, m.
    pub depths: Vec<f64>,
    /// The measured forces, N.
    pub forces: Force<Vec<f64>>,
}

/// Which deviates are for what.
const LATERAL: u64 = 0;
const NORMAL: u64 = 1;
const SENSOR: u64 = 2;
const DEPTH: u64 = 3;

impl Simulation<'_> {
    /// Record `number`, which does not depend on the others.
    ///
    /// # Errors
    /// A gel without lateral forces; a place outside its depths or positions, also where a hand goes; a depth or force beyond all numbers.
    ///
    /// Implements: SIM-001, SIM-002, SIM-003, SIM-005.
    pub fn record(&self, number: u64) -> Result<SimulatedRecord, Refusal> {
        let generator = Generator::new(self.seed, number);
        let places = self.motion.places(self.gel, self.path, &generator)?;
        let times = self.path.samples().to_vec();
        let elastic = places.iter().map(|&place| elastic(self.gel, place));
        let elastic = elastic.collect::<Result<Vec<_>, _>>()?;
        let [mut lateral, normal] = [0, 1].map(|channel| {
            let forces: Vec<f64> = elastic.iter().map(|of| of[channel]).collect();
            match self.relaxation {
                Some([share, time]) => relaxed(&[[share, 1.0 / time]], &times, &forces),
                None => forces,
            }
        });
        // The first sample goes the way of the second.
        let steps: Vec<f64> = places.windows(2).map(|of| of[1][0] - of[0][0]).collect();
        let ways = steps.first().into_iter().chain(&steps);
        for ((force, normal), &way) in lateral.iter_mut().zip(&normal).zip(ways) {
            if way != 0.0 {
                *force -= self.friction * normal * way.signum();
            }
        }
        let noise = |index| self.sensor.depth_sd * generator.normal(DEPTH, index);
        let depths = (0..).zip(&places).map(|(at, [_, depth])| depth + noise(at));
        let depths: Vec<f64> = depths.collect();
        let measured = |forces, channel| self.sensor.measured(forces, channel, &times, &generator);
        let forces = Force::new(measured(lateral, LATERAL), measured(normal, NORMAL));
        let mut values = depths.iter().chain(&forces.lateral).chain(&forces.normal);
        let found = "a measured depth or force is no finite number";
        Refusal::state(found, "give smaller errors of the sensor")
            .when(!values.all(|value| value.is_finite()))?;
        Ok(SimulatedRecord {
            positions: places.iter().map(|place| place[0]).collect(),
            depths,
            forces,
            times,
        })
    }
}

/// The lateral and the normal force of the gel at x and depth (m), N: none above it.
fn elastic(gel: &ForceTable, [x, depth]: [f64; 2]) -> Result<[f64; 2], Refusal> {
    if depth <= 0.0 {
        return Ok([0.0; 2]);
    }
    let forces = gel.path(&[depth], &[x])?;
    match forces.lateral[..] {
        [lateral] => Ok([lateral, forces.normal[0]]),
        _ => Err(Refusal::state(
            "the force map has no lateral forces",
            "give one that has",
        )),
    }
}

impl Sensor {
    /// What it makes of the forces of a channel.
    ///
    /// Implements: SIM-002.
    fn measured(
        &self,
        forces: Vec<f64>,
        channel: u64,
        times: &[f64],
        generator: &Generator,
    ) -> Vec<f64> {
        let sd = self.noise_sd.into_array()[channel as usize];
        let offset = self.offset_sd * generator.normal(SENSOR, channel);
        let drift = self.drift_sd * generator.normal(SENSOR, 2 + channel);
        let (first, last) = (times[0], times[times.len() - 1]);
        let whole = (last - first).max(f64::MIN_POSITIVE);
        let rest = (1.0 - self.correlation * self.correlation).sqrt();
        let mut noise = 0.0;
        let measured = |((index, force), time): ((u64, f64), &f64)| {
            let deviate = sd * generator.normal(channel, index);
            noise = match index {
                0 => deviate,
                _ => self.correlation * noise + rest * deviate,
            };
            let force = force + offset + drift * (time - first) / whole + noise;
            match self.resolution > 0.0 {
                true => (force / self.resolution).round() * self.resolution,
                false => force,
            }
        };
        (0..).zip(forces).zip(times).map(measured).collect()
    }
}

impl SimulatedRecord {
    /// The record as a file that the other commands read, without its depths if they are not to be told.
    ///
    /// Implements: SIM-004.
    pub fn to_csv(&self, with_depths: bool) -> String {
        let depth = if with_depths { "depth_mm," } else { "" };
        let mut text = format!("position_mm,{depth}lateral_force_n,normal_force_n\n");
        let Force { lateral, normal } = &self.forces;
        for sample in 0..self.times.len() {
            let depth = match with_depths {
                true => format!("{:.6},", 1e3 * self.depths[sample]),
                false => String::new(),
            };
            let x = 1e3 * self.positions[sample];
            let [lateral, normal] = [lateral, normal].map(|channel| channel[sample]);
            // A string takes all that is written.
            let _ = writeln!(text, "{x:.6},{depth}{lateral:.6},{normal:.6}");
        }
        text
    }
}

//! Where the probe is sent, and when samples are taken.

use crate::csv::{Column, Rows};
use crate::refusal::Refusal;
use crate::trace::Record;

/// A path: straight lines between waypoints, and the times at which samples are taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Time (s), lateral position and depth (m).
    waypoints: Vec<[f64; 3]>,
    samples: Vec<f64>,
}

/// How long the probe goes from one depth to the next, without samples, s.
const TURN: f64 = 0.5;
/// The share of a sample by which the last one may miss the end of a pass.
const ROUNDING: f64 = 1e-9;
/// Samples of a record at most.
const MOST: f64 = 1e6;

const COLUMNS: [Column; 3] = [
    &[&[("time_s", 0), ("time_ms", -3)]],
    &[&[("position_mm", -3), ("position_m", 0)]],
    &[&[("depth_mm", -3), ("depth_m", 0)]],
];
const EXPECTED: &str = "one that names time_s, position_mm and depth_mm once each";

impl Path {
    /// A pass at each of `depths` (m), there and back between two positions (m) at a `speed` (m/s), with `rate` samples a second.
    ///
    /// # Errors
    /// No depths; a speed or a rate that is not above 0; a pass of no length; too many samples.
    ///
    /// Implements: SIM-010.
    pub fn passes(depths: &[f64], ends: [f64; 2], speed: f64, rate: f64) -> Result<Path, Refusal> {
        let time = (ends[1] - ends[0]).abs() / speed;
        // One sample more where the last lies on the end but for rounding: it is there.
        let steps = (time * rate + ROUNDING).floor();
        let is_right = time > 0.0 && speed > 0.0 && rate > 0.0 && !depths.is_empty();
        let no = Refusal::state(
            "a path has no length, speed, rate or depth",
            "give a speed and a rate above 0, two positions and a depth",
        );
        no.when(!is_right)?;
        few(depths.len() as f64 * (steps + 1.0))?;
        let (mut waypoints, mut samples, mut start) = (Vec::new(), Vec::new(), 0.0);
        for (pass, &depth) in depths.iter().enumerate() {
            let [from, to] = [ends[pass % 2], ends[1 - pass % 2]];
            waypoints.extend([[start, from, depth], [start + time, to, depth]]);
            let at = |k: u64| match time * rate - k as f64 <= ROUNDING {
                true => time,
                false => k as f64 / rate,
            };
            samples.extend((0..=steps as u64).map(|k| start + at(k)));
            start += time + TURN;
        }
        Ok(Path { waypoints, samples })
    }

    /// The path of the waypoints in `text`, the content of `file`, with `rate` samples a second.
    ///
    /// # Errors
    /// Another header, or a row that is malformed; times that do not increase; a single waypoint; a rate that is not above 0; too many
    /// samples.
    ///
    /// Implements: SIM-011.
    pub fn from_csv(text: &str, file: &str, rate: f64) -> Result<Path, Refusal> {
        let found = format!("{rate} samples a second");
        Refusal::state(found, "give a rate above 0").when(rate <= 0.0)?;
        let read = || {
            let table = Rows::parse(text, COLUMNS, EXPECTED)?;
            for pair in table.rows.windows(2) {
                let [(_, before), (line, after)] = [pair[0], pair[1]];
                let found = format!("time {} s after {} s", after[0], before[0]);
                let refusal = Refusal::state(found, "give times that increase").at(line);
                refusal.when(after[0] <= before[0])?;
            }
            let waypoints: Vec<_> = table.rows.into_iter().map(|(_, row)| row).collect();
            let single = Refusal::state("a path of a single place", "give at least two waypoints");
            single.when(waypoints.len() < 2)?;
            let (first, last) = (waypoints[0][0], waypoints[waypoints.len() - 1][0]);
            let steps = ((last - first) * rate + 1e-9).floor();
            few(steps + 1.0)?;
            let samples = (0..=steps as u64).map(|k| (first + k as f64 / rate).min(last));
            Ok(Path {
                samples: samples.collect(),
                waypoints,
            })
        };
        read().map_err(|refusal: Refusal| refusal.in_file(file))
    }

    /// The times of the samples, s.
    pub fn samples(&self) -> &[f64] {
        &self.samples
    }

    /// The path as a record without forces, for what can be found along it.
    ///
    /// # Errors
    /// None that is known: a path has a sample.
    ///
    /// Implements: BNK-082.
    pub fn sweep(&self) -> Result<Record, Refusal> {
        let places: Vec<_> = self.samples.iter().map(|&time| self.at(time)).collect();
        let [positions, depths] =
            [0, 1].map(|axis| -> Vec<f64> { places.iter().map(|place| place[axis]).collect() });
        Record::planned(&positions, &depths)
    }

    /// The smallest and the largest position (m), and the largest depth (m).
    pub fn extent(&self) -> ([f64; 2], f64) {
        let of = |axis: usize| self.waypoints.iter().map(move |at| at[axis]);
        let low = of(1).fold(f64::INFINITY, f64::min);
        let high = of(1).fold(f64::NEG_INFINITY, f64::max);
        ([low, high], of(2).fold(0.0, f64::max))
    }

    /// The commanded position and depth at a time, m: the first before the path begins.
    pub(super) fn at(&self, time: f64) -> [f64; 2] {
        let next = self.waypoints.partition_point(|at| at[0] <= time);
        let [before, behind] = [next.max(1) - 1, next.min(self.waypoints.len() - 1)];
        let [[from, x0, d0], [to, x1, d1]] = [before, behind].map(|at| self.waypoints[at]);
        let share = if to > from {
            ((time - from) / (to - from)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        [x0 + share * (x1 - x0), d0 + share * (d1 - d0)]
    }
}

/// Refuses a record that is too long.
fn few(samples: f64) -> Result<(), Refusal> {
    let found = format!("a record of {samples} samples");
    let refusal = Refusal::state(found, "take at most 1,000,000, by a lower rate");
    // NaN is no number of samples.
    refusal.when(!(1.0..=MOST).contains(&samples))
}

//! γ where a hand tracks the path of the probe, beside the paper's assumption that a stage follows it (`spec/report.md`).

use serde::Serialize;

use super::gamma::gamma;
use palpate::force::Force;
use palpate::force_map::ForceMap;
use palpate::simulation::{Hand, Motion, Path, Sensor, SimulatedRecord, Simulation};

/// How far the path stays from the ends of a map, and its speed, m and m/s.
const MARGIN: f64 = 0.5e-3;
const SPEED: f64 = 10e-3;

/// γ of both forces along a path at one commanded depth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GammaOfHand {
    /// Where a stage follows the path.
    pub followed: f64,
    /// Where a hand tracks it and its place is measured, so that both hypotheses are of the same poses.
    pub tracked: f64,
    /// Where a hand tracks it and feels the force alone: each gel pushes it to other poses.
    pub felt: f64,
    /// The mean depth of the tracking hand over the reference, m.
    pub mean_depth_m: f64,
}

/// A path over the reference, by a stage that follows it and by a hand that tracks it.
pub(super) struct HandPath<'a> {
    reference: &'a ForceMap,
    path: Path,
    followed: SimulatedRecord,
    tracked: SimulatedRecord,
}

impl<'a> HandPath<'a> {
    /// The path at a commanded depth (m), with as many samples as the map has positions; none where it does not reach as far as the hand.
    pub fn over(reference: &'a ForceMap, depth: f64) -> Option<HandPath<'a>> {
        let laterals = reference.table().laterals();
        let (first, last) = (laterals[0] + MARGIN, laterals[laterals.len() - 1] - MARGIN);
        let rate = (laterals.len() - 1) as f64 * SPEED / (last - first);
        let path = Path::passes(&[depth], [first, last], SPEED, rate).ok()?;
        Some(HandPath {
            followed: record(reference, &path, None)?,
            tracked: record(reference, &path, Some(Hand::default()))?,
            reference,
            path,
        })
    }

    /// γ of a map in noise of `noise_sd` (N); none where the map does not reach as far as the hand.
    ///
    /// Implements: REP-017.
    pub fn gamma(&self, map: &ForceMap, noise_sd: f64) -> Option<GammaOfHand> {
        let between = |without: &Force<Vec<f64>>, with: &Force<Vec<f64>>| -> Option<f64> {
            let signal = with.as_ref().zip(without.as_ref());
            let Force { lateral, normal } = signal.map(|(with, without)| -> Vec<f64> {
                let pairs = with.iter().zip(without);
                pairs.map(|(with, without)| with - without).collect()
            });
            gamma(&lateral, &normal, noise_sd).ok()
        };
        let followed = record(map, &self.path, None)?;
        let tracked = record(map, &self.path, Some(Hand::default()))?;
        let same_poses = self.reference.table();
        let same_poses = same_poses.path(&tracked.depths, &tracked.positions);
        let depths = &self.tracked.depths;
        Some(GammaOfHand {
            followed: between(&self.followed.forces, &followed.forces)?,
            tracked: between(&same_poses.ok()?, &tracked.forces)?,
            felt: between(&self.tracked.forces, &tracked.forces)?,
            mean_depth_m: depths.iter().sum::<f64>() / depths.len() as f64,
        })
    }
}

/// The record of a path by an exact sensor; none where the gel's map does not reach as far.
fn record(gel: &ForceMap, path: &Path, hand: Option<Hand>) -> Option<SimulatedRecord> {
    let simulation = Simulation {
        gel: gel.table(),
        path,
        motion: Motion { hand, tremor: None },
        relaxation: None,
        friction: 0.0,
        sensor: Sensor::default(),
        seed: 0,
    };
    simulation.record(0).ok()
}

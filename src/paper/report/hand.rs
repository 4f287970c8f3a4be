//! γ where a hand tracks the path of the probe, beside the paper's assumption that a stage follows it (`spec/report.md`).

use serde::Serialize;

use super::maps::gamma;
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

impl GammaOfHand {
    /// In noise of `noise_sd` (N), with as many samples as the maps have positions; none where a map does not reach as far as the hand.
    ///
    /// Implements: REP-017.
    pub(super) fn of(
        reference: &ForceMap,
        map: &ForceMap,
        noise_sd: f64,
        depth: f64,
    ) -> Option<GammaOfHand> {
        let laterals = reference.table().laterals();
        let (first, last) = (laterals[0] + MARGIN, laterals[laterals.len() - 1] - MARGIN);
        let rate = (laterals.len() - 1) as f64 * SPEED / (last - first);
        let path = Path::passes(&[depth], [first, last], SPEED, rate).ok()?;
        let record = |gel: &ForceMap, hand: Option<Hand>| -> Option<SimulatedRecord> {
            let simulation = Simulation {
                gel: gel.table(),
                path: &path,
                motion: Motion { hand, tremor: None },
                relaxation: None,
                friction: 0.0,
                sensor: Sensor::default(),
                seed: 0,
            };
            simulation.record(0).ok()
        };
        let between = |without: &Force<Vec<f64>>, with: &Force<Vec<f64>>| -> Option<f64> {
            let signal = with.as_ref().zip(without.as_ref());
            let Force { lateral, normal } = signal.map(|(with, without)| -> Vec<f64> {
                let pairs = with.iter().zip(without);
                pairs.map(|(with, without)| with - without).collect()
            });
            gamma(&lateral, &normal, noise_sd).ok()
        };
        let hand = Some(Hand::default());
        let [without, with] = [record(reference, None)?, record(map, None)?];
        let [light, heavy] = [record(reference, hand)?, record(map, hand)?];
        let same_poses = (reference.table()).path(&heavy.depths, &heavy.positions);
        Some(GammaOfHand {
            followed: between(&without.forces, &with.forces)?,
            tracked: between(&same_poses.ok()?, &heavy.forces)?,
            felt: between(&light.forces, &heavy.forces)?,
            mean_depth_m: light.depths.iter().sum::<f64>() / light.depths.len() as f64,
        })
    }
}

//! γ of the pressure under the probe, read by a tactile array, against γ of the total force.

use serde::Serialize;

use super::maps::gamma;
use super::{Findings, MapFindings, Run, text};
use palpate::detect::DetectError;
use palpate::fem::{FemError, Model};
use palpate::force::Force;
use palpate::force_map::{ForceMap, SAME_POSITION};
use palpate::phantom::Phantom;

/// Numbers of elements, each of which divides the last.
const ELEMENTS: [usize; 6] = [1, 2, 4, 8, 16, FINEST];
/// The largest number.
const FINEST: usize = 32;

/// What a tactile array under the probe reads as it sweeps over a phantom at one depth.
#[derive(Debug, Clone, PartialEq)]
pub struct ArraySweep {
    pub(super) phantom: Phantom,
    /// m.
    pub(super) depth: f64,
    /// m.
    pub(super) laterals: Vec<f64>,
    /// The normal force on each of the most elements, at each lateral position, N.
    pub(super) forces: Vec<Vec<f64>>,
}

impl ArraySweep {
    /// The sweep over `model`'s phantom.
    ///
    /// # Errors
    /// As [`Model::solve`].
    pub fn solve(model: &Model, depth: f64, laterals: &[f64]) -> Result<ArraySweep, FemError> {
        Ok(ArraySweep {
            phantom: model.phantom().clone(),
            depth,
            laterals: laterals.to_vec(),
            forces: model.array_sweep(depth, laterals, FINEST)?,
        })
    }
}

/// γ of tactile arrays, all of which have the noise of one force sensor: of n elements each has the noise of the settings over √n.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArrayFindings {
    /// γ of both channels of the total force at x = 0 alone, if x = 0 is on the axis.
    pub press_of_total_force: Option<f64>,
    /// For each number of elements.
    pub arrays: Vec<GammaOfArray>,
}

/// γ of one tactile array.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GammaOfArray {
    /// The number of its elements.
    pub elements: usize,
    /// γ of the whole lateral sweep.
    pub sweep: f64,
    /// γ at x = 0 alone, if x = 0 is on the axis.
    pub press: Option<f64>,
}

impl ArrayFindings {
    /// What arrays make of a map whose total force has the `signal` at `depth`, a row of the map. `None` where the run holds no
    /// sweep of an array over these poses with the same probe for the map and for the reference.
    ///
    /// Implements: REP-018.
    pub(super) fn of(
        run: &Run,
        map: &ForceMap,
        signal: Force<&[f64]>,
        depth: f64,
    ) -> Result<Option<ArrayFindings>, DetectError> {
        let laterals = map.laterals();
        let sweep = |map: &ForceMap| {
            run.arrays.iter().find(|of| {
                Some(&of.phantom) == map.phantom() && of.depth == depth && of.laterals == laterals
            })
        };
        let (Some(with), Some(without)) = (sweep(map), sweep(&run.reference)) else {
            return Ok(None);
        };
        if with.phantom.probe != without.phantom.probe {
            return Ok(None);
        }
        let centre = laterals.iter().position(|x| x.abs() <= SAME_POSITION);
        let noise_sd = run.settings.noise_sd_n;
        let of_array = |elements: usize| {
            let differences = with.forces.iter().zip(&without.forces);
            let signals = differences.map(|(with, without)| merged(with, without, elements));
            let signals: Vec<Vec<f64>> = signals.collect();
            let gamma = |signal: &[f64]| {
                let none = vec![0.0; signal.len()];
                gamma(&none, signal, noise_sd / libm::sqrt(elements as f64))
            };
            Ok(GammaOfArray {
                elements,
                sweep: gamma(&signals.concat())?,
                press: centre.map(|at| gamma(&signals[at])).transpose()?,
            })
        };
        let Force { lateral, normal } = signal;
        let press = centre.map(|at| gamma(&lateral[at..=at], &normal[at..=at], noise_sd));
        let arrays = ELEMENTS.into_iter().map(of_array);
        Ok(Some(ArrayFindings {
            press_of_total_force: press.transpose()?,
            arrays: arrays.collect::<Result<_, DetectError>>()?,
        }))
    }
}

impl Findings {
    /// The maps with arrays.
    pub(super) fn arrays(&self) -> impl Iterator<Item = (&MapFindings, &ArrayFindings)> {
        self.maps
            .iter()
            .filter_map(|map| Some((map, map.array.as_ref()?)))
    }

    /// γ of both channels of the total force, and of the array with the most elements, over each sweep.
    pub(super) fn sweeps(&self) -> impl Iterator<Item = [f64; 2]> {
        self.arrays()
            .filter_map(|(map, array)| Some([map.gamma.both, array.arrays.last()?.sweep]))
    }

    /// The same of one press at x = 0.
    pub(super) fn presses(&self) -> impl Iterator<Item = [f64; 2]> {
        self.arrays().filter_map(|(_, array)| {
            Some([array.press_of_total_force?, array.arrays.last()?.press?])
        })
    }
}

/// What an inclusion adds to each of `elements` elements, N.
fn merged(with: &[f64], without: &[f64], elements: usize) -> Vec<f64> {
    let differences: Vec<f64> = with.iter().zip(without).map(|(a, b)| a - b).collect();
    let elements = differences.chunks(FINEST / elements);
    elements.map(|of| of.iter().sum()).collect()
}

/// "1.20 to 1.90 times": the least and the largest ratio of the second to the first, where that is above 0.
pub(super) fn times(pairs: impl Iterator<Item = [f64; 2]>) -> Option<String> {
    let pairs = pairs.filter(|pair| pair[0] > 0.0);
    let [least, most] = text::extremes(pairs.map(|[a, b]| b / a))?;
    let [least, most] = [least, most].map(|ratio| text::fixed(ratio, 2));
    Some(match least == most {
        true => format!("{least} times"),
        false => format!("{least} to {most} times"),
    })
}

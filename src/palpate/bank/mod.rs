//! A bank of signals: the force on the probe for every inclusion that may be there, over its position, depth, diameter and
//! stiffness, and what a record says of each (`spec/bank.md`; the last paragraphs of the paper's §5).
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the bank: hypotheses on a full grid, with their maps |
//! | `file.rs` | banks as JSON |
//! | `plan.rs` | which maps a bank needs, and their computation |
//! | `axis.rs` | signals between the points of the grid |
//! | `detector.rs` | the likelihood ratio of each point, beside nuisances |
//! | `cells.rs` | the cells between the points |
//! | `climb.rs` | the most likely place |
//! | `place.rs` | the posterior of position, depth, diameter and stiffness |
//! | `rates.rs` | rates of error of the largest of many |
//! | `information.rs` | how well a place can be known |
//! | `locate.rs` | a recorded sweep against a bank |
//! | `neighbours.rs` | whether the noise of neighbouring samples of a live record is correlated |
//! | `watch.rs` | a sweep against a bank while it is taken |
//! | `reach.rs` | how deep, and how small |

mod axis;
mod cells;
mod climb;
mod detector;
mod file;
mod information;
mod locate;
mod neighbours;
mod place;
mod plan;
mod rates;
mod reach;
#[cfg(test)]
mod tests;
mod watch;

pub use detector::{BankDetector, BankStatistic};
pub(crate) use detector::{likeliest, shares};
pub use file::{SCHEMA, SCHEMA_VERSION};
pub use information::PlaceBound;
pub use locate::{BankSearch, Location, SearchThreshold};
pub use place::PlacePosterior;
pub use plan::{BankPlan, BankSolve, MESH_SIZE};
pub use rates::{
    CONFIDENCE, CalibratedThreshold, RareRate, false_alarm_bound, false_alarm_threshold,
};
pub use reach::{BesideClass, Reach, Reached, deepest, smallest_diameters};
pub use watch::{
    LikeliestPlace, SampleCounts, Told, WatchAnswer, WatchQuestion, WatchedPlace, Watcher,
};

use crate::decimal::mm;
use crate::force_map::{ForceMap, ForceTable, SAME_POSITION, check_gel, increasing};
use crate::phantom::{Inclusion, Phantom, Shape};
use crate::refusal::Refusal;

/// What the hypotheses of a bank differ in.
///
/// Implements: BNK-001.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// x of the inclusion's centre.
    Position,
    /// Depth of its highest point.
    Depth,
    /// Its diameter, or the width of another shape than a disc.
    Diameter,
    /// Its Young's modulus.
    Modulus,
}

impl Parameter {
    /// All of them, in the order of the axes.
    pub const ALL: [Parameter; 4] = {
        use Parameter::{Depth, Diameter, Modulus, Position};
        [Position, Depth, Diameter, Modulus]
    };

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Parameter::Modulus => "Pa",
            _ => "m",
        }
    }

    /// That of `inclusion`, m or Pa.
    pub fn of(self, inclusion: &Inclusion) -> f64 {
        match (self, &inclusion.shape) {
            (Parameter::Position, _) => inclusion.centre_x,
            (Parameter::Depth, _) => inclusion.depth,
            (Parameter::Diameter, Shape::Disc { diameter }) => *diameter,
            (Parameter::Diameter, _) => {
                // At 0: elsewhere rounding gives each position a width of its own.
                let centre_x = 0.0;
                let [left, right, ..] = Inclusion {
                    centre_x,
                    ..inclusion.clone()
                }
                .extent();
                right - left
            }
            (Parameter::Modulus, _) => inclusion.material.youngs_modulus,
        }
    }
}

/// The forces of one gel without inclusion, and with each of the inclusions that may be there.
///
/// Implements: BNK-001.
#[derive(Debug, Clone, PartialEq)]
pub struct Bank {
    reference: ForceMap,
    /// The forces without inclusion at the depths of the maps.
    base: ForceTable,
    axes: [Vec<f64>; 4],
    maps: Vec<ForceMap>,
}

impl Bank {
    /// The bank of `maps`, in any order, and of `reference`, the gel without inclusion. Each of the maps holds the same depths of the
    /// probe, and a phantom with one inclusion; the reference holds these depths, and may hold others.
    ///
    /// # Errors
    /// No maps; a map without lateral forces, or that is not the reference's gel with one inclusion, at other lateral positions or other
    /// depths; maps that are no full grid of positions, depths, diameters and moduli; with the number of the map, from 0.
    ///
    /// Implements: BNK-001, BNK-003, MAP-084.
    pub fn new(reference: ForceMap, maps: Vec<ForceMap>) -> Result<Bank, Refusal> {
        let Some(first) = maps.first() else {
            return Err(Refusal::state("the bank has no maps", "give one at least"));
        };
        let both = reference.table().both();
        both.map_err(|refusal| refusal.of_part("reference"))?;
        let base = reference.table().at_depths(first.table().depths())?;
        let mut points = Vec::with_capacity(maps.len());
        for (number, map) in maps.iter().enumerate() {
            let of_map = |refusal: Refusal| refusal.of_part(&format!("maps[{number}]"));
            points.push(check_map(&reference, map, base.depths()).map_err(of_map)?);
        }
        let axes = [0, 1, 2, 3].map(|axis| increasing(points.iter().map(|point| point[axis])));
        // The last axis first: the bank's order.
        let rank = |point: &[f64; 4]| {
            let at = |axis: usize| axes[axis].partition_point(|&value| value < point[axis]);
            [at(3), at(2), at(1), at(0)]
        };
        let ranks = points.iter().map(rank);
        let mut maps: Vec<((_, usize), ForceMap)> = ranks.zip(0..).zip(maps).collect();
        maps.sort_by_key(|&(rank, _)| rank);
        let same = maps.windows(2).find(|pair| pair[0].0.0 == pair[1].0.0);
        if let Some([((_, a), _), ((_, b), _)]) = same {
            let found = format!("maps[{a}] and maps[{b}] have the same inclusion");
            return Err(Refusal::state(found, "give each inclusion once"));
        }
        let [positions, depths, diameters, moduli] = axes.each_ref().map(Vec::len);
        let expected = format!(
            "give one for each of {positions} positions × {depths} depths × {diameters} diameters × {moduli} moduli of their inclusions"
        );
        let all = positions * depths * diameters * moduli;
        Refusal::state(format!("{} maps", maps.len()), expected).when(maps.len() != all)?;
        Ok(Bank {
            maps: maps.into_iter().map(|(_, map)| map).collect(),
            reference,
            base,
            axes,
        })
    }

    /// The forces without inclusion.
    pub fn reference(&self) -> &ForceMap {
        &self.reference
    }

    /// The forces without inclusion at the depths of the maps alone: what a map adds to them is its signal, between its rows too.
    ///
    /// Implements: BNK-080.
    pub fn base(&self) -> &ForceTable {
        &self.base
    }

    /// The depths of the probe, m, increasing.
    pub fn probe_depths(&self) -> &[f64] {
        self.base.depths()
    }

    /// The greatest depth of the probe, m.
    pub fn depth(&self) -> f64 {
        self.probe_depths()[self.probe_depths().len() - 1]
    }

    /// Checks that the maps have a row at this depth of the probe, m.
    ///
    /// # Errors
    /// Another depth, with those of the bank.
    pub fn check_depth(&self, depth: f64) -> Result<(), Refusal> {
        let is_own = |own: &f64| (depth - own).abs() <= SAME_POSITION;
        let own: Vec<String> = self
            .probe_depths()
            .iter()
            .map(|own| mm(*own).to_string())
            .collect();
        let (own, given) = (own.join(", "), mm(depth));
        let found = format!("the bank is for a depth of {own} mm, not {given} mm");
        let remedy = format!("give {own}, or another bank");
        Refusal::state(found, remedy).when(!self.probe_depths().iter().any(is_own))
    }

    /// The values of each of [`Parameter::ALL`], increasing, m or Pa.
    pub fn axes(&self) -> &[Vec<f64>; 4] {
        &self.axes
    }

    /// The forces with each inclusion, N: those of all positions, then those of the next depth, diameter, modulus.
    pub fn maps(&self) -> &[ForceMap] {
        &self.maps
    }

    /// The parameters of the inclusion of the map with that number, in the order of [`Parameter::ALL`].
    pub fn point(&self, map: usize) -> [f64; 4] {
        axis::point(self.axes.each_ref().map(Vec::as_slice), map)
    }
}

/// The parameters of the one inclusion of `map`.
fn check_map(reference: &ForceMap, map: &ForceMap, depths: &[f64]) -> Result<[f64; 4], Refusal> {
    check_gel(reference, map)?;
    map.table().both()?;
    let Some([inclusion]) = map.phantom().map(Phantom::inclusions) else {
        let found = "its phantom has no inclusion, or several";
        return Err(Refusal::state(
            found,
            "give one, which says what the map is for",
        ));
    };
    let own = map.table().depths();
    let (found, right) = (own.len(), depths.len());
    let other = format!("it has {found} depths of the probe");
    Refusal::state(other, format!("give {right} as in maps[0]")).when(found != right)?;
    for (row, (own, depth)) in own.iter().zip(depths).enumerate() {
        let key = format!("depths_m[{row}]");
        let other = Refusal::value(&key, own, format!("{depth} as in maps[0]"));
        other.when((own - depth).abs() > SAME_POSITION)?;
    }
    let same = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME_POSITION;
    let (ours, theirs) = (map.table().laterals(), reference.table().laterals());
    let is_same = ours.len() == theirs.len() && ours.iter().zip(theirs).all(same);
    let found = "its lateral positions are not those of the reference";
    Refusal::state(found, "give the same").when(!is_same)?;
    Ok(Parameter::ALL.map(|parameter| parameter.of(inclusion)))
}

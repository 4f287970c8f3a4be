//! The gels beside that of a map: changed by what is usually not known of a gel, and on other supports.

use rayon::prelude::*;

use crate::bank::MESH_SIZE;
use crate::fem::{Contact, FemError, Model};
use crate::force_map::{ForceMap, ForceTable, Source};
use crate::phantom::{Phantom, PhantomParts, Support};
use crate::refusal::Refusal;
use crate::trace::Record;
use crate::trace::design::{difference, expected};

/// What is uncertain of a gel, at one depth of the probe.
///
/// Implements: ROB-020.
#[derive(Debug, Clone, PartialEq)]
pub struct GelChanges {
    /// Compressibility, width, height, thickness of the first layer, radius of the probe.
    pub gel: Vec<GelChange>,
    /// Walls, and floor, along which the gel slides.
    pub support: Vec<GelChange>,
    /// Radius of the probe, m.
    pub radius: f64,
}

/// The forces without inclusion of two gels, and which share of their difference is one standard deviation.
#[derive(Debug, Clone, PartialEq)]
pub struct GelChange {
    from: ForceTable,
    to: ForceTable,
    share: f64,
}

/// A standard deviation of Poisson's ratio.
const POISSON: f64 = 0.005;
/// Standard deviations as a share: of the width of the well, the height of the gel, the thickness of its first layer and the radius
/// of the probe. For the paper's gel 2, 1, 0.3 and 0.35 mm.
const SHARES: [f64; 4] = [0.06, 0.065, 0.6, 0.054];
/// The share of a whole change of a support.
const SUPPORT: f64 = 0.5;

/// The finest mesh, over the radius of the probe: a change is needed to a tenth of itself.
const COARSE: f64 = 0.154;

/// Changes are computed at about so many lateral positions.
const MOST_LATERALS: usize = 40;

/// The walls, and the floor, slide.
const SUPPORTS: [fn(&mut PhantomParts); 2] = [
    |gel| gel.well.walls = Support::Sliding,
    |gel| gel.well.floor = Support::Sliding,
];

/// A change by so many standard deviations.
const CHANGES: [fn(&mut PhantomParts, f64); 5] = [
    |gel, by| {
        let layers = gel.layers.iter_mut();
        layers.for_each(|layer| layer.material.poisson_ratio += by * POISSON);
    },
    |gel, by| gel.well.width *= 1.0 + by * SHARES[0],
    |gel, by| {
        let height: f64 = gel.layers.iter().map(|layer| layer.thickness).sum();
        if let Some(last) = gel.layers.last_mut() {
            last.thickness += by * SHARES[1] * height;
        }
    },
    |gel, by| gel.layers[0].thickness *= 1.0 + by * SHARES[2],
    |gel, by| gel.probe.radius *= 1.0 + by * SHARES[3],
];

impl GelChanges {
    /// Those of the gel of `reference`, without its inclusions, under the probe at `depth` (m); none of a measured map without a
    /// phantom. A change that the gel or the probe does not allow is made in the other direction alone, or left out.
    ///
    /// # Errors
    /// As [`Model::sweep`].
    pub fn new(reference: &ForceMap, depth: f64) -> Result<Option<GelChanges>, FemError> {
        let Some(phantom) = reference.phantom().map(Phantom::without_inclusions) else {
            return Ok(None);
        };
        let mesh_size = match reference.source() {
            Source::FiniteElements { certificate } => certificate.mesh_size,
            Source::Measured(_) => MESH_SIZE,
        };
        let mesh_size = f64::max(mesh_size, COARSE * phantom.probe().radius);
        let laterals = thinned(reference.table().laterals());
        let allowed = |change: &dyn Fn(&mut PhantomParts)| {
            let changed = phantom.changed(change).ok()?;
            let mut poses = laterals.iter();
            let stands = poses.all(|&x| changed.check_pose(depth, x).is_ok());
            stands.then_some(changed)
        };
        let sides = CHANGES.iter().filter_map(|change| {
            let [less, more] = [-1.0, 1.0].map(|by| allowed(&|parts| change(parts, by)));
            let share = if less.is_some() && more.is_some() {
                0.5
            } else {
                1.0
            };
            let is_some = less.is_some() || more.is_some();
            is_some.then(|| {
                (
                    less.unwrap_or(phantom.clone()),
                    more.unwrap_or(phantom.clone()),
                    share,
                )
            })
        });
        let sides: Vec<_> = sides.collect();
        let gels = sides.len();
        let slid = SUPPORTS
            .iter()
            .filter_map(|slide| Some((phantom.clone(), allowed(slide)?, SUPPORT)));
        let sides: Vec<_> = sides.into_iter().chain(slid).collect();
        let solved = |phantom: &Phantom| -> Result<ForceTable, FemError> {
            let model = Model::new(phantom, mesh_size, Contact::default())?;
            Ok(model.sweep(depth, &laterals)?.table().clone())
        };
        let change = |(from, to, share): &(Phantom, Phantom, f64)| {
            let (from, to) = rayon::join(|| solved(from), || solved(to));
            Ok(GelChange {
                from: from?,
                to: to?,
                share: *share,
            })
        };
        let changes = sides.par_iter().map(change);
        let mut gel = changes.collect::<Result<Vec<_>, FemError>>()?;
        let support = gel.split_off(gels);
        let radius = phantom.probe().radius;
        Ok(Some(GelChanges {
            gel,
            support,
            radius,
        }))
    }
}

/// At most some of the lateral positions, both ends among them: changes are smooth.
fn thinned(laterals: &[f64]) -> Vec<f64> {
    let stride = laterals.len().div_ceil(MOST_LATERALS).max(1);
    let last = laterals.len() - 1;
    let kept = (0..last).step_by(stride).chain([last]);
    kept.map(|at| laterals[at]).collect()
}

impl GelChange {
    /// What one standard deviation adds to the forces at the samples of `record`, N.
    ///
    /// # Errors
    /// A sample outside the map.
    pub fn at(&self, record: &Record, depth: f64) -> Result<Vec<f64>, Refusal> {
        let [from, to] = [&self.from, &self.to].map(|table| expected(record, table, depth));
        Ok(difference(&to?, &from?)
            .iter()
            .map(|change| self.share * change)
            .collect())
    }
}

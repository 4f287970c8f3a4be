//! The gels beside that of a map: changed by what is usually not known of a gel, and on other supports.

use std::path::Path;

use rayon::prelude::*;
use serde::Deserialize;

use super::classes::Part;
use super::expected;
use crate::bank::MESH_SIZE;
use crate::fem::{Contact, FemError, Model};
use crate::file;
use crate::force_map::{ForceMap, ForceTable, SAME_POSITION};
use crate::phantom::{Phantom, PhantomParts, Support};
use crate::refusal::Refusal;
use crate::text::extremes;
use crate::trace::Record;
use crate::trace::design::difference;

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
    /// The standard deviation of the depth, in percent of it.
    pub depth_percent: f64,
}

/// What is uncertain of a gel under a probe: standard deviations in percent of each quantity, 0 of what is known.
///
/// ```
/// use palpate::file::from_toml;
/// use palpate::robust::GelUncertainty;
///
/// let measured: GelUncertainty = from_toml("height_percent = 0.5", "gel.toml")?;
/// assert_eq!(measured.well_width_percent, 6.0);
/// # Ok::<(), palpate::refusal::Refusal>(())
/// ```
///
/// Implements: ROB-020.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GelUncertainty {
    /// Poisson's ratio of all layers together.
    pub poisson_ratio_percent: f64,
    /// The width of the well.
    pub well_width_percent: f64,
    /// The height of the gel.
    pub height_percent: f64,
    /// The thickness of the first layer.
    pub first_layer_percent: f64,
    /// The radius of the probe.
    pub probe_radius_percent: f64,
    /// The depth of the probe.
    pub depth_percent: f64,
    /// What a wall or a floor that slides would change.
    pub support_percent: f64,
}

/// Of the paper's gel 0.005, and 2, 1, 0.3, 0.35 and 0.2 mm; and half of a support's change.
impl Default for GelUncertainty {
    fn default() -> GelUncertainty {
        GelUncertainty {
            poisson_ratio_percent: 1.0,
            well_width_percent: 6.0,
            height_percent: 6.5,
            first_layer_percent: 60.0,
            probe_radius_percent: 5.4,
            depth_percent: 5.0,
            support_percent: 50.0,
        }
    }
}

impl GelUncertainty {
    /// Nothing is uncertain.
    pub const NONE: GelUncertainty = GelUncertainty {
        poisson_ratio_percent: 0.0,
        well_width_percent: 0.0,
        height_percent: 0.0,
        first_layer_percent: 0.0,
        probe_radius_percent: 0.0,
        depth_percent: 0.0,
        support_percent: 0.0,
    };

    /// What is left where parts are `known`.
    ///
    /// Implements: ROB-050.
    pub fn beside(self, known: &[Part]) -> GelUncertainty {
        let gel = if known.contains(&Part::Gel) {
            Self::NONE
        } else {
            self
        };
        let is_known = known.contains(&Part::Support);
        let support_percent = if is_known { 0.0 } else { self.support_percent };
        GelUncertainty {
            support_percent,
            ..gel
        }
    }

    /// From a TOML file; what it does not name is as by default.
    ///
    /// # Errors
    /// What is wrong with the file; a percentage below 0 or above 100.
    ///
    /// Implements: ROB-020.
    pub fn read(path: &Path) -> Result<GelUncertainty, Refusal> {
        file::read(path, |text, file| {
            let read: GelUncertainty = file::from_toml(text, file)?;
            for (key, percent) in read.percents() {
                let refusal = Refusal::value(key, percent, "from 0 to 100").in_file(file);
                refusal.when(!(0.0..=100.0).contains(&percent))?;
            }
            Ok(read)
        })
    }

    /// In the order of [`CHANGES`], then of the depth and of supports.
    fn percents(&self) -> [(&'static str, f64); 7] {
        [
            ("poisson_ratio_percent", self.poisson_ratio_percent),
            ("well_width_percent", self.well_width_percent),
            ("height_percent", self.height_percent),
            ("first_layer_percent", self.first_layer_percent),
            ("probe_radius_percent", self.probe_radius_percent),
            ("depth_percent", self.depth_percent),
            ("support_percent", self.support_percent),
        ]
    }
}

/// The forces without inclusion of two gels, and which share of their difference is one standard deviation.
#[derive(Debug, Clone, PartialEq)]
pub struct GelChange {
    from: ForceTable,
    to: ForceTable,
    share: f64,
}

/// The finest mesh, over the radius of the probe: a change is needed to a tenth of itself.
const COARSE: f64 = 0.154;

/// Changes are computed at about so many lateral positions, and depths.
const MOST_LATERALS: usize = 40;
const MOST_DEPTHS: usize = 8;

/// The walls, and the floor, slide.
const SUPPORTS: [fn(&mut PhantomParts); 2] = [
    |gel| gel.well.walls = Support::Sliding,
    |gel| gel.well.floor = Support::Sliding,
];

/// A change of each uncertain quantity by a share.
const CHANGES: [fn(&mut PhantomParts, f64); 5] = [
    |gel, by| {
        let all = gel.materials_mut();
        all.for_each(|material| material.poisson_ratio *= 1.0 + by);
    },
    |gel, by| gel.well.width *= 1.0 + by,
    |gel, by| {
        let height: f64 = gel.layers.iter().map(|layer| layer.thickness).sum();
        if let Some(last) = gel.layers.last_mut() {
            last.thickness += by * height;
        }
    },
    |gel, by| gel.layers[0].thickness *= 1.0 + by,
    |gel, by| gel.probe.radius *= 1.0 + by,
];

/// Two gels, and the share of their difference that is one standard deviation.
type Sides = (Phantom, Phantom, f64);

impl GelChanges {
    /// The depths for [`GelChanges::new`], m, under samples with depths of their own: the rows of `reference` that those of `records` are
    /// between.
    ///
    /// Implements: ROB-080.
    pub fn depths_along(reference: &ForceMap, records: &[&Record]) -> Vec<f64> {
        let own = records
            .iter()
            .flat_map(|record| record.depths().into_iter().flatten());
        let [least, most] = extremes(own.copied()).unwrap_or_default();
        let rows = reference.table().depths();
        let first = rows.partition_point(|row| *row <= least + SAME_POSITION);
        let last = rows.partition_point(|row| *row < most - SAME_POSITION);
        let rows = &rows[first.saturating_sub(1)..(last + 1).min(rows.len())];
        thinned(rows, MOST_DEPTHS)
    }

    /// Those of the gel of `reference`, without its inclusions, under the probe at `depths` (m, increasing): one, or all of
    /// [`GelChanges::depths_along`]; none of a measured map without a phantom. A change that the gel or the probe does not allow is made in
    /// the other direction alone, or left out.
    ///
    /// # Errors
    /// As [`Model::sweep`].
    ///
    /// Implements: ROB-080.
    pub fn new(
        reference: &ForceMap,
        depths: &[f64],
        uncertainty: &GelUncertainty,
    ) -> Result<Option<GelChanges>, FemError> {
        let Some(phantom) = reference.phantom().map(Phantom::without_inclusions) else {
            return Ok(None);
        };
        let certificate = reference.certificate();
        let mesh_size = certificate.map_or(MESH_SIZE, |of| of.mesh_size);
        let mesh_size = f64::max(mesh_size, COARSE * phantom.probe().radius);
        let laterals = thinned(reference.table().laterals(), MOST_LATERALS);
        let mut sides = sides(&phantom, depths, &laterals, uncertainty);
        let gels = sides.len();
        sides.extend(SUPPORTS.iter().filter_map(|slide| {
            let slid = allowed(&phantom, depths, &laterals, slide)?;
            let share = 0.01 * uncertainty.support_percent;
            (share > 0.0).then(|| (phantom.clone(), slid, share))
        }));
        let solved = |phantom: &Phantom| -> Result<ForceTable, FemError> {
            let model = Model::new(phantom, mesh_size, Contact::default())?;
            Ok(model.sweep(depths, &laterals)?.table().clone())
        };
        let change = |(from, to, share): &Sides| {
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
        Ok(Some(GelChanges {
            gel,
            support,
            radius: phantom.probe().radius,
            depth_percent: uncertainty.depth_percent,
        }))
    }
}

/// `phantom` with a change, if the probe can be there.
fn allowed(
    phantom: &Phantom,
    depths: &[f64],
    laterals: &[f64],
    change: impl Fn(&mut PhantomParts),
) -> Option<Phantom> {
    let changed = phantom.changed(change).ok()?;
    let mut poses = depths
        .iter()
        .flat_map(|depth| laterals.iter().map(move |x| (depth, x)));
    let stands = poses.all(|(&depth, &x)| changed.check_pose(depth, x).is_ok());
    stands.then_some(changed)
}

/// The gels at either side of `phantom` in each uncertain quantity, by its default standard deviation: that is more than another mesh
/// changes. A smaller one has its share.
fn sides(
    phantom: &Phantom,
    depths: &[f64],
    laterals: &[f64],
    uncertainty: &GelUncertainty,
) -> Vec<Sides> {
    let changes = CHANGES.iter().zip(uncertainty.percents());
    let sizes = GelUncertainty::default().percents();
    let side = |((change, (_, percent)), (_, size)): (_, (_, f64))| {
        let change: &fn(&mut PhantomParts, f64) = change;
        let at = |by: f64| allowed(phantom, depths, laterals, |gel| change(gel, by));
        let [less, more] = [-0.01, 0.01].map(|sign| at(sign * size));
        let own = || phantom.clone();
        let share = percent / size;
        match (less, more) {
            (None, None) => None,
            (Some(less), Some(more)) => Some((less, more, 0.5 * share)),
            (less, more) => Some((less.unwrap_or_else(own), more.unwrap_or_else(own), share)),
        }
    };
    let uncertain = changes
        .zip(sizes)
        .filter(|((_, (_, percent)), _)| *percent > 0.0);
    uncertain.filter_map(side).collect()
}

/// At most some of the entries of an axis, both ends among them: changes are smooth.
fn thinned(axis: &[f64], most: usize) -> Vec<f64> {
    let stride = axis.len().div_ceil(most).max(1);
    let last = axis.len() - 1;
    let kept = (0..last).step_by(stride).chain([last]);
    kept.map(|at| axis[at]).collect()
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

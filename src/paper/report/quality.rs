//! The certificates of the maps in short, and what a reader must be warned of.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::text::{fixed, millimetres};
use palpate::fem::SMALL_STRAIN_LIMIT;
use palpate::force_map::{Certificate, ForceMap};
use palpate::refusal::Refusal;

/// The certificate of a computed map; in JSON without what it says of every pose.
///
/// Implements: REP-041.
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// How good the computation was.
    pub certificate: Certificate,
    /// The version of the program that computed the map.
    pub program_version: String,
}

impl Quality {
    /// What is known of a map; `None` for measured forces.
    pub(super) fn of(map: &ForceMap) -> Option<Quality> {
        Some(Quality {
            certificate: map.certificate()?.clone(),
            program_version: map.program_version().into(),
        })
    }

    /// The largest half bands of the discretisation around a normal and a lateral force, N, where they were estimated.
    pub fn bands(&self) -> [Option<f64>; 2] {
        let discretization = self.certificate.discretization.as_ref();
        discretization.map_or([None; 2], |of| of.largest().map(Some))
    }
}

impl Serialize for Quality {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (of, [normal, lateral]) = (&self.certificate, self.bands());
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("worst_relative_residual", &of.worst_relative_residual)?;
        map.serialize_entry("worst_force_balance_n", &of.worst_force_balance)?;
        map.serialize_entry("largest_normal_band_n", &normal)?;
        map.serialize_entry("largest_lateral_band_n", &lateral)?;
        map.serialize_entry("largest_penetration_m", &of.largest_penetration)?;
        map.serialize_entry("smallest_det", &of.smallest_det.det)?;
        map.serialize_entry("smallest_det_depth_m", &of.smallest_det.depth)?;
        map.serialize_entry("smallest_det_lateral_m", &of.smallest_det.lateral)?;
        map.serialize_entry("mesh_size_m", &of.mesh_size)?;
        map.serialize_entry("nodes", &of.nodes)?;
        map.serialize_entry("element", &of.element)?;
        map.serialize_entry("contact", &of.contact)?;
        if let Some(law) = &of.law {
            map.serialize_entry("law", law)?;
        }
        map.serialize_entry("program_version", &self.program_version)?;
        map.end()
    }
}

/// The warning of a gel at the limit of small strain.
///
/// Implements: REP-015.
pub(super) fn small_strain(quality: Option<&Quality>) -> Option<String> {
    let certificate = &quality?.certificate;
    let smallest = certificate.smallest_det;
    let is_low = certificate.law.is_none() && smallest.det < SMALL_STRAIN_LIMIT;
    let (limit, forces) = match smallest.det > 0.0 {
        true => ("at", "are the linear model's, not a real gel's"),
        false => ("beyond", "mean nothing: the gel passes through itself"),
    };
    is_low.then(|| {
        format!(
            "Small strain is {limit} its limit: det(I + ∇u) falls to {} at depth {} mm, x = {} mm (below {SMALL_STRAIN_LIMIT}); forces near that pose {forces}.",
            fixed(smallest.det, 3),
            millimetres(smallest.depth),
            millimetres(smallest.lateral),
        )
    })
}

/// The warnings of a map with a γ, and of it and its reference as a `pair`.
///
/// Implements: REP-015.
pub(super) fn warnings(
    quality: Option<&Quality>,
    gamma: f64,
    pair: Result<(), Refusal>,
) -> Vec<String> {
    let mut warnings: Vec<String> = small_strain(quality).into_iter().collect();
    if gamma == 0.0 {
        warnings.push(
            "No signal: the forces equal the reference's, so nothing can be detected.".into(),
        );
    }
    if let Err(why) = pair {
        warnings.push(format!(
            "The signal is not that of an inclusion alone: {why}."
        ));
    }
    warnings
}

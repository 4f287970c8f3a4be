//! What a run found.

use serde::Serialize;

use super::comparison::{self, Comparison};
use super::gamma::gamma;
use super::inputs::check_study;
use super::maps::{MapFindings, ReferenceFindings, of_maps, of_reference};
use super::people::bridge_to;
use super::text::{millimetres, name_of_map};
use super::theories::{self, TheoryFindings};
use super::{Run, Settings, paper};
use crate::psychophysics::bridge::{Bridge, probe_depth};
use crate::psychophysics::{
    Analysis, AnswerTable, NoiseDecomposition, analyse, paper_noise_levels,
};
use palpate::detect::{DetectError, map_threshold};
use palpate::force_map::ForceMap;
use palpate::refusal::Refusal;

/// What a run found, in plain numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Findings {
    /// The depth of the probe, m, at which signals are taken.
    pub probe_depth_m: f64,
    /// Why this is not the paper's 4 mm.
    pub probe_depth_note: Option<String>,
    /// The number of lateral positions, and so of samples in each channel.
    pub samples: usize,
    /// The least γ that keeps both error rates of the settings.
    pub required_gamma: f64,
    /// The phantom without inclusion.
    pub reference: ReferenceFindings,
    /// One for each map of the run, in its order.
    pub maps: Vec<MapFindings>,
    /// What Table 1 says by itself.
    pub people: Analysis,
    /// The paper's noise levels beside ours.
    pub noise: NoiseDecomposition,
    /// Table 1 against the signals of the paper's phantoms; only with two of them or more at 4 mm.
    pub bridge: Option<Bridge>,
    /// Each number that the paper prints beside ours.
    pub comparison: Vec<Comparison>,
    /// The same phantoms under several theories of the gel.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub theories: Vec<TheoryFindings>,
}

impl Findings {
    /// Whether a hand could track the path over a map.
    pub(super) fn have_hand(&self) -> bool {
        self.maps.iter().any(|map| map.gamma_of_hand.is_some())
    }
}

/// Everything that the report says in numbers.
///
/// # Errors
/// If a map is over other poses than the reference, a setting is outside its range, a signal overflows, a measured map was
/// computed, or a study is of other phantoms or settings.
///
/// Implements: REP-002, REP-003, REP-004, REP-070.
pub fn findings(run: &Run) -> Result<Findings, Refusal> {
    let depths = run.reference.table().depths();
    let (probe_depth, is_quoted) = probe_depth(depths);
    let required_gamma = check(&run.settings).map_err(Refusal::because("settings"))?;
    if let Some(study) = &run.study {
        let phantoms = run.reference_and_maps().filter_map(ForceMap::phantom);
        let poses = (probe_depth, run.reference.table().laterals());
        check_study(study, &phantoms.collect::<Vec<_>>(), poses, &run.settings)?;
    }
    let is_computed = |map: &&ForceMap| map.certificate().is_some();
    if let Some(map) = run.measured.iter().find(is_computed) {
        let name = name_of_map(map);
        let found = format!("map {name:?} is among the measured maps, but was computed");
        return Err(Refusal::state(found, ""));
    }
    let (reference, settings) = (&run.reference, &run.settings);
    let maps = of_maps(reference, settings, &run.maps, probe_depth)?;
    let reference = of_reference(&run.reference, probe_depth)?;
    let is_paper_reference = run.reference.phantom().and_then(paper::name_of) == Some("none");
    let is_comparable = is_quoted && is_paper_reference;
    // Only maps of the paper's phantoms, against the paper's reference, at the paper's depth are compared with it.
    let compared: &[MapFindings] = if is_comparable { &maps } else { &[] };
    let table = AnswerTable::paper()?;
    let people = analyse(&table).map_err(Refusal::because("Table 1"))?;
    let noise = paper_noise_levels().map_err(Refusal::because("Table 1"))?;
    let bridged: &[ForceMap] = if is_comparable { &run.maps } else { &[] };
    let bridge = bridge_to(&table, &run.reference, bridged, paper::name_of);
    let bridge = bridge.map_err(Refusal::because("Table 1"))?;
    let level = reference.normal_force_at_centre_n.filter(|_| is_comparable);
    let comparison = comparison::table(level, compared, &people, &noise, bridge.as_ref());
    Ok(Findings {
        probe_depth_m: probe_depth,
        probe_depth_note: (!is_quoted).then(|| {
            format!(
                "The maps hold no depth of 4 mm, at which the paper quotes its forces: signals are taken at their deepest depth, {} mm, and are not compared with the paper.",
                millimetres(probe_depth)
            )
        }),
        samples: run.reference.table().laterals().len(),
        required_gamma,
        theories: theories::findings(&run.theories, settings)?,
        comparison: comparison.map_err(Refusal::because("the paper's numbers"))?,
        reference,
        maps,
        people,
        noise,
        bridge,
    })
}

/// Refuses settings outside their range even where there is no map to use them on, and gives the γ they need.
///
/// Implements: REP-004.
fn check(settings: &Settings) -> Result<f64, DetectError> {
    gamma(&[0.0], &[0.0], settings.noise_sd_n)?;
    map_threshold(settings.prior_h1)?;
    settings.required_gamma()
}

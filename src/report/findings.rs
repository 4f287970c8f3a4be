//! Signals, signal-to-noise ratios, thresholds and error rates of a study.

use serde::Serialize;

use super::comparison::{self, Comparison};
use super::people::bridge_to;
use super::quality::{Quality, quality, warnings};
use super::text::{millimetres, name_of_map};
use super::{ReportError, Settings, Study, paper};
use crate::detect::{
    DetectError, MatchedFilter, auc, error_rates, map_threshold,
    neyman_pearson_false_alarm_threshold, neyman_pearson_miss_threshold, required_gamma, two_afc,
};
use crate::force::Force;
use crate::force_map::{ForceMap, ForceTable, SAME_POSITION};
use crate::psychophysics::bridge::Bridge;
use crate::psychophysics::{Analysis, NoiseDecomposition, Table, analyse, paper_noise_levels};
use crate::refusal::Refusal;

/// What a study found, in plain numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Findings {
    /// The depth of the probe, m, at which signals are taken.
    #[serde(rename = "probe_depth_m")]
    pub probe_depth: f64,
    /// Why this is not the paper's 4 mm.
    pub probe_depth_note: Option<String>,
    /// The number of lateral positions, and so of samples in each channel.
    pub samples: usize,
    /// The least γ that keeps both error rates of the settings.
    pub required_gamma: f64,
    /// The phantom without inclusion.
    pub reference: ReferenceFindings,
    /// One for each map of the study, in its order.
    pub maps: Vec<MapFindings>,
    /// What Table 1 says by itself.
    pub people: Analysis,
    /// The paper's noise levels beside ours.
    pub noise: NoiseDecomposition,
    /// Table 1 against the signals of the paper's phantoms; only with two of them or more at 4 mm.
    pub bridge: Option<Bridge>,
    /// Each number that the paper prints beside ours.
    pub comparison: Vec<Comparison>,
}

/// What the reference map says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReferenceFindings {
    /// The name of its phantom: untrusted text.
    pub name: String,
    /// The normal force at x = 0, N, if x = 0 is on the axis.
    #[serde(rename = "normal_force_at_centre_n")]
    pub normal_force_at_centre: Option<f64>,
    /// How good the computation was; `None` for measured forces.
    pub quality: Option<Quality>,
}

/// What the map of one phantom says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapFindings {
    /// The name of its phantom: untrusted text.
    pub name: String,
    /// Which of the paper's phantoms it is, if any.
    pub paper_phantom: Option<&'static str>,
    /// The depth of the highest point of all inclusions, m; `None` without any.
    #[serde(rename = "inclusion_depth_m")]
    pub inclusion_depth: Option<f64>,
    /// Where F_1 − F_0 of the normal force is largest in magnitude.
    pub peak_normal: Peak,
    /// Where F_1 − F_0 of the lateral force is largest in magnitude.
    pub peak_lateral: Peak,
    /// γ of the matched filter over the whole lateral sweep.
    pub gamma: GammaByChannel,
    /// The maximum a-posteriori rule.
    pub map_rule: Threshold,
    /// Neyman–Pearson with the miss rate bounded; the fewest false alarms.
    pub bounded_miss: Threshold,
    /// Neyman–Pearson with the false-alarm rate bounded; the fewest misses. `None` if γ = 0.
    pub bounded_false_alarm: Option<Threshold>,
    /// The area under the curve of hits against false alarms.
    pub auc: f64,
    /// The share of right answers in pairs.
    pub two_afc: f64,
    /// How good the computation was; `None` for measured forces.
    pub quality: Option<Quality>,
    /// What a reader must know before using these numbers.
    pub warnings: Vec<String>,
}

impl MapFindings {
    /// The three thresholds, in the order of the fields.
    pub(super) fn thresholds(&self) -> [Option<Threshold>; 3] {
        [
            Some(self.map_rule),
            Some(self.bounded_miss),
            self.bounded_false_alarm,
        ]
    }
}

/// An extreme of a signal along the lateral sweep.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Peak {
    /// The signed force, N.
    #[serde(rename = "force_n")]
    pub force: f64,
    /// The lateral position, m; of mirror images the one with x ≥ 0.
    #[serde(rename = "lateral_m")]
    pub lateral: f64,
}

/// γ with both channels and with each alone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GammaByChannel {
    /// Both.
    pub both: f64,
    /// The normal force alone.
    pub normal: f64,
    /// The lateral force alone.
    pub lateral: f64,
}

/// A threshold with its error rates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Threshold {
    /// η of equation (9).
    pub eta: f64,
    /// Pr(Ĥ = 1 | H = 0).
    pub false_alarm: f64,
    /// Pr(Ĥ = 0 | H = 1).
    pub miss: f64,
}

/// Everything that the report says in numbers.
///
/// # Errors
/// [`ReportError::Map`] if a map is over other poses than the reference, [`ReportError::Detect`] if a setting is
/// outside its range or a signal overflows, [`ReportError::NotMeasured`] if a measured map was computed.
///
/// Implements: REP-002, REP-003, REP-004, REP-070.
pub fn findings(study: &Study) -> Result<Findings, ReportError> {
    let depths = study.reference.depths();
    let probe_depth = probe_depth(depths);
    let at_paper_depth = is_paper_depth(probe_depth);
    let required_gamma =
        check(&study.settings).map_err(|source| detect_error("settings", source))?;
    let is_computed = |map: &&ForceMap| map.certificate().is_some();
    if let Some(map) = study.measured.iter().find(is_computed) {
        return Err(ReportError::NotMeasured {
            name: name_of_map(map),
        });
    }
    let maps = study
        .maps
        .iter()
        .map(|map| of_map(study, map, probe_depth))
        .collect::<Result<Vec<_>, _>>()?;
    let reference = of_reference(&study.reference, probe_depth)?;
    let is_paper_reference = study.reference.phantom().and_then(paper::name_of) == Some("none");
    let comparable = at_paper_depth && is_paper_reference;
    // Only maps of the paper's phantoms, against the paper's reference, at the paper's depth are compared with it.
    let compared: &[MapFindings] = if comparable { &maps } else { &[] };
    let people_error = |source| ReportError::People { source };
    let table = Table::paper().map_err(|error| ReportError::Table { error })?;
    let people = analyse(&table).map_err(people_error)?;
    let noise = paper_noise_levels().map_err(people_error)?;
    let bridge = bridge_to(&table, study, compared)?;
    let level = reference.normal_force_at_centre.filter(|_| comparable);
    Ok(Findings {
        probe_depth,
        probe_depth_note: (!at_paper_depth).then(|| {
            format!(
                "The maps hold no depth of 4 mm, at which the paper quotes its forces: signals are taken at their deepest depth, {} mm, and are not compared with the paper.",
                millimetres(probe_depth)
            )
        }),
        samples: study.reference.laterals().len(),
        required_gamma,
        comparison: comparison::table(level, compared, &people, &noise, bridge.as_ref())?,
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
    gamma(&[0.0], &[0.0], settings.noise_sd)?;
    map_threshold(settings.prior_h1)?;
    required_gamma(settings.max_false_alarm, settings.max_miss)
}

/// The signal F_1 − F_0 of `map` over all poses.
pub(super) fn signal(study: &Study, map: &ForceMap) -> Result<ForceTable, ReportError> {
    map.signal(&study.reference).map_err(refused(map))
}

/// The refusal of a map.
pub(super) fn refused(map: &ForceMap) -> impl FnOnce(Refusal) -> ReportError {
    |source| ReportError::Map {
        name: name_of_map(map),
        source: source.into(),
    }
}

pub(super) fn detect_error(what: &str, source: DetectError) -> ReportError {
    ReportError::Detect {
        what: what.into(),
        source,
    }
}

fn is_paper_depth(depth: f64) -> bool {
    (depth - paper::PROBE_DEPTH).abs() <= SAME_POSITION
}

/// The paper's depth if the maps hold it, or else the deepest.
fn probe_depth(depths: &[f64]) -> f64 {
    let deepest = depths.last().copied().unwrap_or(0.0);
    depths
        .iter()
        .copied()
        .find(|&depth| is_paper_depth(depth))
        .unwrap_or(deepest)
}

fn of_reference(map: &ForceMap, depth: f64) -> Result<ReferenceFindings, ReportError> {
    let name = name_of_map(map);
    let row = map.row(depth).map_err(refused(map))?;
    let centre = map.laterals().iter().position(|x| x.abs() <= SAME_POSITION);
    Ok(ReferenceFindings {
        name,
        normal_force_at_centre: centre.map(|column| row.normal[column]),
        quality: quality(map),
    })
}

fn of_map(study: &Study, map: &ForceMap, depth: f64) -> Result<MapFindings, ReportError> {
    let name = name_of_map(map);
    let table = signal(study, map)?;
    let signal = table.row(depth).map_err(refused(map))?;
    let settings = &study.settings;
    let detect = |source| detect_error(&format!("map {name:?}"), source);
    let gamma = gamma_by_channel(signal, settings.noise_sd).map_err(detect)?;
    let at = |eta: Result<f64, DetectError>| threshold(gamma.both, eta?);
    let bounded_false_alarm = match at(neyman_pearson_false_alarm_threshold(
        gamma.both,
        settings.max_false_alarm,
    )) {
        // Two phantoms that feel the same: there is no threshold to state.
        Err(DetectError::NoSignal) => None,
        other => Some(other.map_err(detect)?),
    };
    let quality = quality(map);
    let phantom = map.phantom();
    Ok(MapFindings {
        paper_phantom: phantom.and_then(paper::name_of),
        inclusion_depth: phantom
            .and_then(|p| p.inclusions.iter().map(|i| i.depth).reduce(f64::min)),
        peak_normal: peak(table.laterals(), signal.normal),
        peak_lateral: peak(table.laterals(), signal.lateral),
        map_rule: at(map_threshold(settings.prior_h1)).map_err(detect)?,
        bounded_miss: at(neyman_pearson_miss_threshold(gamma.both, settings.max_miss))
            .map_err(detect)?,
        bounded_false_alarm,
        auc: auc(gamma.both).map_err(detect)?,
        two_afc: two_afc(gamma.both).map_err(detect)?,
        warnings: warnings(quality.as_ref(), gamma.both),
        gamma,
        quality,
        name,
    })
}

/// The largest magnitude; of equals the one nearest to x = 0, then the one at x > 0.
///
/// Implements: REP-011.
fn peak(laterals: &[f64], forces: &[f64]) -> Peak {
    let poses = laterals.iter().zip(forces);
    poses
        .map(|(&lateral, &force)| Peak { force, lateral })
        .max_by(|a, b| {
            a.force
                .abs()
                .total_cmp(&b.force.abs())
                .then(b.lateral.abs().total_cmp(&a.lateral.abs()))
                .then(a.lateral.total_cmp(&b.lateral))
        })
        .unwrap_or(Peak {
            force: 0.0,
            lateral: 0.0,
        })
}

/// γ of lateral and normal forces in noise of the same standard deviation.
fn gamma(lateral: &[f64], normal: &[f64], noise_sd: f64) -> Result<f64, DetectError> {
    let noise_sd = Force::new(noise_sd, noise_sd);
    let template = Force { lateral, normal };
    MatchedFilter::new(template, noise_sd).map(|filter| filter.gamma())
}

/// Implements: REP-012.
fn gamma_by_channel(signal: Force<&[f64]>, noise_sd: f64) -> Result<GammaByChannel, DetectError> {
    let zeros = vec![0.0; signal.normal.len()];
    Ok(GammaByChannel {
        both: gamma(signal.lateral, signal.normal, noise_sd)?,
        normal: gamma(&zeros, signal.normal, noise_sd)?,
        lateral: gamma(signal.lateral, &zeros, noise_sd)?,
    })
}

/// Implements: REP-013.
fn threshold(gamma: f64, eta: f64) -> Result<Threshold, DetectError> {
    let rates = error_rates(gamma, eta)?;
    Ok(Threshold {
        eta,
        false_alarm: rates.false_alarm,
        miss: rates.miss,
    })
}

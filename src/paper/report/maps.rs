//! What one force map says: its signal, signal-to-noise ratios, thresholds and error rates.

use serde::Serialize;

use super::gamma::{GammaByChannel, gamma};
use super::hand::{GammaOfHand, HandPath};
use super::nuisances::GammaLeft;
use super::quality::{Quality, small_strain, warnings};
use super::text::name_of_map;
use super::{Settings, paper};
use palpate::detect::{
    DetectError, ErrorRates, error_rates, map_threshold, neyman_pearson_false_alarm_threshold,
    neyman_pearson_miss_threshold, two_afc,
};
use palpate::force::Force;
use palpate::force_map::{ForceMap, Hypotheses, SAME_POSITION, peak};
use palpate::phantom::Phantom;
use palpate::refusal::Refusal;

/// What the reference map says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReferenceFindings {
    /// The name of its phantom: untrusted text.
    pub name: String,
    /// The normal force at x = 0, N, if x = 0 is on the axis.
    pub normal_force_at_centre_n: Option<f64>,
    /// How good the computation was; `None` for measured forces.
    pub quality: Option<Quality>,
    /// What a reader must know before using these numbers.
    pub warnings: Vec<String>,
}

/// What the map of one phantom says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapFindings {
    /// The name of its phantom: untrusted text.
    pub name: String,
    /// Which of the paper's phantoms it is, if any.
    pub paper_phantom: Option<&'static str>,
    /// The depth of the highest point of all inclusions, m; `None` without any.
    pub inclusion_depth_m: Option<f64>,
    /// Where F_1 − F_0 of the normal force is largest in magnitude.
    pub peak_normal: Peak,
    /// Where F_1 − F_0 of the lateral force is largest in magnitude.
    pub peak_lateral: Peak,
    /// γ of the matched filter over the whole lateral sweep, if all but the noise is known; the thresholds are for it.
    pub gamma: GammaByChannel,
    /// What is left of it if more is unknown.
    pub gamma_left: GammaLeft,
    /// γ where a hand tracks the path; none where the maps do not reach as far as the hand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gamma_of_hand: Option<GammaOfHand>,
    /// What the detector makes of γ of both channels.
    #[serde(flatten)]
    pub detection: Detection,
    /// How good the computation was; `None` for measured forces.
    pub quality: Option<Quality>,
    /// What a reader must know before using these numbers.
    pub warnings: Vec<String>,
}

/// The thresholds and rates of a γ.
///
/// Implements: REP-012.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Detection {
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
}

impl Detection {
    fn new(gamma: f64, settings: &Settings) -> Result<Detection, DetectError> {
        let at = |eta: f64| {
            let rates = error_rates(gamma, eta)?;
            Ok(Threshold { eta, rates })
        };
        let bounded = neyman_pearson_false_alarm_threshold(gamma, settings.max_false_alarm);
        Ok(Detection {
            map_rule: at(map_threshold(settings.prior_h1)?)?,
            bounded_miss: at(neyman_pearson_miss_threshold(gamma, settings.max_miss)?)?,
            bounded_false_alarm: match bounded.and_then(at) {
                // Two phantoms that feel the same: there is no threshold to state.
                Err(DetectError::NoSignal) => None,
                other => Some(other?),
            },
            auc: two_afc(gamma)?,
            two_afc: two_afc(gamma)?,
        })
    }
}

/// An extreme of a signal along the lateral sweep.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Peak {
    /// The signed force, N.
    pub force_n: f64,
    /// The lateral position, m; of mirror images the one with x ≥ 0.
    pub lateral_m: f64,
}

/// A threshold with its error rates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Threshold {
    /// η of equation (9).
    pub eta: f64,
    /// Its rates.
    #[serde(flatten)]
    pub rates: ErrorRates,
}

/// The refusal of a map.
///
/// Implements: REP-004.
pub(super) fn incomparable(map: &ForceMap) -> impl FnOnce(Refusal) -> Refusal {
    let name = name_of_map(map);
    Refusal::because(format!(
        "map {name:?} cannot be compared with the reference"
    ))
}

pub(super) fn of_reference(map: &ForceMap, depth: f64) -> Result<ReferenceFindings, Refusal> {
    let table = map.table();
    let row = table.row(depth).map_err(incomparable(map))?;
    let mut laterals = table.laterals().iter();
    let centre = laterals.position(|x| x.abs() <= SAME_POSITION);
    let quality = Quality::of(map);
    Ok(ReferenceFindings {
        name: name_of_map(map),
        normal_force_at_centre_n: centre.map(|column| row.normal[column]),
        warnings: small_strain(quality.as_ref()).into_iter().collect(),
        quality,
    })
}

/// F_1 − F_0 of a map at one depth.
pub(super) fn signal(
    reference: &ForceMap,
    map: &ForceMap,
    depth: f64,
) -> Result<Force<Vec<f64>>, Refusal> {
    let signal = map.signal(reference).map_err(incomparable(map))?;
    let row = signal.row(depth).map_err(incomparable(map))?;
    Ok(row.map(<[f64]>::to_vec))
}

/// Implements: REP-012.
pub(super) fn of_maps(
    reference: &ForceMap,
    settings: &Settings,
    maps: &[ForceMap],
    depth: f64,
) -> Result<Vec<MapFindings>, Refusal> {
    let hand = HandPath::over(reference, depth);
    let of = |map| of_map(reference, settings, map, depth, hand.as_ref());
    maps.iter().map(of).collect()
}

fn of_map(
    reference: &ForceMap,
    settings: &Settings,
    map: &ForceMap,
    depth: f64,
    hand: Option<&HandPath<'_>>,
) -> Result<MapFindings, Refusal> {
    let signal = signal(reference, map, depth)?;
    let signal = signal.as_deref();
    let gamma_left = GammaLeft::of(reference, settings.noise_sd_n, signal, depth);
    let gamma_left = gamma_left.map_err(incomparable(map))?;
    let judged = judged(settings, signal);
    let name = name_of_map(map);
    let (gamma, detection) = judged.map_err(Refusal::because(format!("map {name:?}")))?;
    let (quality, phantom) = (Quality::of(map), map.phantom());
    let pair = Hypotheses::new(reference, map).map(|_| ());
    let warnings = warnings(quality.as_ref(), gamma.both, pair);
    let peak = |forces: &[f64]| {
        let (force_n, lateral_m) = peak(map.table().laterals(), forces);
        Peak { force_n, lateral_m }
    };
    Ok(MapFindings {
        name,
        paper_phantom: phantom.and_then(paper::name_of),
        inclusion_depth_m: phantom.and_then(Phantom::inclusion_depth),
        peak_normal: peak(signal.normal),
        peak_lateral: peak(signal.lateral),
        gamma,
        gamma_left,
        gamma_of_hand: hand.and_then(|hand| hand.gamma(map, settings.noise_sd_n)),
        detection,
        warnings,
        quality,
    })
}

/// What the detector makes of a signal.
fn judged(
    settings: &Settings,
    Force { lateral, normal }: Force<&[f64]>,
) -> Result<(GammaByChannel, Detection), DetectError> {
    let gamma = |lateral: &[f64], normal: &[f64]| gamma(lateral, normal, settings.noise_sd_n);
    let zeros = vec![0.0; normal.len()];
    let gamma = GammaByChannel {
        both: gamma(lateral, normal)?,
        normal: gamma(&zeros, normal)?,
        lateral: gamma(lateral, &zeros)?,
    };
    Ok((gamma, Detection::new(gamma.both, settings)?))
}

//! The phantoms of a run by several theories of the gel: what finite strain and friction change.

use serde::Serialize;

use super::maps::{MapFindings, ReferenceFindings, of_maps, of_reference, signal};
use super::nuisances::{BOTH, BY_DEFAULT, columns, space};
use super::people::bridge_to;
use super::text::name_of_map;
use super::{Settings, Theory, paper};
use crate::psychophysics::AnswerTable;
use crate::psychophysics::bridge::{ConventionFit, probe_depth};
use palpate::detect::nuisance::dot;
use palpate::force_map::{ForceMap, SAME_POSITION};
use palpate::phantom::{Phantom, Strain};
use palpate::refusal::Refusal;
use palpate::stats::normal;

/// Templates of the first theory serve where they keep this part of γ,
const LEAST_KEPT: f64 = 0.95;
/// and where false alarms are no more than so many times as frequent as asked for.
const MOST_ALARMS: f64 = 1.5;

/// What one theory says at the probe depth.
///
/// Implements: REP-090.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TheoryFindings {
    /// "small strain", "finite strain, friction 0.3".
    pub name: String,
    /// The phantom without inclusion.
    pub reference: ReferenceFindings,
    /// d ln F_n / d ln ν of its normal force at x = 0.
    pub poisson_leverage: Option<f64>,
    /// One for each map, in the order of the run.
    pub maps: Vec<MapFindings>,
    /// Each explanation of the answers to FEM playback; none without two of the paper's phantoms.
    pub explanations: Vec<Explanation>,
    /// What the template of each map of the first theory does on a gel of this one; none for the first itself.
    pub templates: Vec<TemplateUse>,
}

/// How well an explanation fits the answers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// What of the force is taken to count.
    pub name: String,
    /// The larger p-value of the fits by subject.
    pub p_value: f64,
    /// Whether that is below the level.
    pub is_rejected: bool,
}

impl From<&ConventionFit> for Explanation {
    fn from(fit: &ConventionFit) -> Explanation {
        Explanation {
            name: fit.name.clone(),
            p_value: fit.p_value,
            is_rejected: fit.is_rejected,
        }
    }
}

/// What template and reference of one theory do on a gel of another.
///
/// Implements: REP-091.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TemplateUse {
    /// The name of the phantom: untrusted text.
    pub name: String,
    /// At each depth of the probe where there is a template.
    pub at: Vec<TemplateUseAtDepth>,
}

/// The same at one depth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TemplateUseAtDepth {
    /// The depth of the probe, m.
    pub depth_m: f64,
    /// The part of γ that the template keeps.
    pub kept: f64,
    /// The false-alarm rate in place of the one asked for.
    pub false_alarm: f64,
    /// Whether the template serves.
    pub serves: bool,
}

/// What the theories of a run say.
///
/// # Errors
/// Maps of one theory over different poses, or theories over different ones.
pub(super) fn findings(
    theories: &[Theory],
    settings: &Settings,
) -> Result<Vec<TheoryFindings>, Refusal> {
    let of = |theory: &Theory| {
        let reference = &theory.reference;
        let (depth, _) = probe_depth(reference.table().depths());
        Ok(TheoryFindings {
            name: theory.name(),
            reference: of_reference(reference, depth)?,
            poisson_leverage: theory.poisson_leverage,
            maps: of_maps(reference, settings, &theory.maps, depth)?,
            explanations: explanations(theory)?,
            templates: templates(&theories[0], theory, settings)?,
        })
    };
    theories.iter().map(of).collect()
}

/// The paper's name of a phantom, whatever its theory.
pub(super) fn name_of(phantom: &Phantom) -> Option<&'static str> {
    let plain = phantom.changed(|parts| {
        parts.strain = Strain::Small;
        parts.probe.friction = 0.0;
    });
    paper::name_of(&plain.ok()?)
}

fn explanations(theory: &Theory) -> Result<Vec<Explanation>, Refusal> {
    // The subjects felt the paper's depth.
    let (_, is_of_paper) = probe_depth(theory.reference.table().depths());
    if !is_of_paper || theory.reference.phantom().and_then(name_of) != Some("none") {
        return Ok(Vec::new());
    }
    // Half a sweep is the whole one only of a gel that is its own mirror image, and with friction none is.
    let is_half = theory.reference.table().laterals()[0] > -SAME_POSITION;
    let own_image = |map: &ForceMap| map.phantom().is_some_and(Phantom::is_symmetric);
    let mut maps = std::iter::once(&theory.reference).chain(&theory.maps);
    if is_half && !maps.all(own_image) {
        return Ok(Vec::new());
    }
    let table = AnswerTable::paper()?;
    let bridge = bridge_to(&table, &theory.reference, &theory.maps, name_of)?;
    let playback = bridge
        .iter()
        .filter_map(|of| of.conditions.get(paper::FEM_PLAYBACK));
    let fits = playback.flat_map(|condition| &condition.conventions);
    Ok(fits.map(Explanation::from).collect())
}

fn templates(
    first: &Theory,
    theory: &Theory,
    settings: &Settings,
) -> Result<Vec<TemplateUse>, Refusal> {
    if std::ptr::eq(first, theory) {
        return Ok(Vec::new());
    }
    let pairs = first.maps.iter().zip(&theory.maps);
    let depths = theory.reference.table().depths().iter();
    let of = |(template, there): (&ForceMap, &ForceMap)| {
        let at = |&depth: &f64| {
            let references = [&first.reference, &theory.reference];
            template_use(references, [template, there], settings, depth).transpose()
        };
        Ok(TemplateUse {
            name: name_of_map(there),
            at: depths.clone().filter_map(at).collect::<Result<_, _>>()?,
        })
    };
    pairs.map(of).collect()
}

/// What the first of two maps, over the first of two references, does where the second of each is true; `None` where either has no
/// signal, as at depth 0.
fn template_use(
    references: [&ForceMap; 2],
    maps: [&ForceMap; 2],
    settings: &Settings,
    depth: f64,
) -> Result<Option<TemplateUseAtDepth>, Refusal> {
    let mut columns = columns(references[0], BY_DEFAULT, depth, BOTH)?;
    let off = BOTH(signal(references[0], references[1], depth)?.as_deref());
    let space = space(&mut columns, off.len())?;
    let projected = |mut vector: Vec<f64>| {
        let length = space.project(&mut vector)?;
        Ok::<_, Refusal>((vector, length))
    };
    let of = |which: usize| -> Result<_, Refusal> {
        let signal = signal(references[which], maps[which], depth)?;
        projected(BOTH(signal.as_deref()))
    };
    let ((template, length), (there, strength)) = (of(0)?, of(1)?);
    if length == 0.0 || strength == 0.0 {
        return Ok(None);
    }
    let asked = settings.max_false_alarm;
    let quantile = normal::quantile(asked).map_err(Refusal::because("settings"))?;
    let bias = dot(&template, &projected(off)?.0) / (length * settings.noise_sd_n);
    let kept = dot(&template, &there) / (length * strength);
    let false_alarm = normal::lower_tail(quantile + bias);
    Ok(Some(TemplateUseAtDepth {
        depth_m: depth,
        kept,
        false_alarm,
        serves: kept >= LEAST_KEPT && false_alarm <= MOST_ALARMS * asked,
    }))
}

impl TheoryFindings {
    /// The template that has a signal at the most depths, which head the table.
    pub(super) fn longest_template(&self) -> Option<&TemplateUse> {
        self.templates
            .iter()
            .max_by_key(|template| template.at.len())
    }
}

impl Theory {
    /// "small strain", "finite strain", "finite strain, friction 0.3".
    pub fn name(&self) -> String {
        let of = |phantom: &Phantom| match (phantom.strain(), phantom.probe().friction) {
            (Strain::Small, _) => "small strain".into(),
            (Strain::Finite, 0.0) => "finite strain".into(),
            (Strain::Finite, friction) => format!("finite strain, friction {friction}"),
        };
        self.reference.phantom().map_or("measured".into(), of)
    }
}

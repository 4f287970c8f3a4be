//! The page: one file that opens from disk, without scripts and without anything from a network.
//!
//! What it says stands in the templates `templates/report/`, one for each section; here is what they choose from. Text is escaped
//! by the template engine.

use core::iter::once;

use askama::Template;

use super::comparison::named;
use super::inputs::{Survival, survival};
use super::text::printable;
use super::{
    Comparison, Explanation, Figure, Findings, MapFindings, Quality, Run, Settings, TheoryFindings,
    Topic, Value, paper, text,
};
use crate::psychophysics::noise::SUMS;
use crate::study::{Band, Change, Conclusion, Kind, StudyResults};
use palpate::phantom::Geometry;

/// How the page looks.
///
/// Implements: REP-034, REP-064.
pub const STYLE: &str = include_str!("style.css");
/// What the name of the SVG namespace is called inside HTML: nothing, since HTML knows `<svg>` by itself.
const NAMESPACE: &str = " xmlns=\"http://www.w3.org/2000/svg\"";

/// The sections below the opening: what the contents link to, and their headings.
const CONTENTS: [(&str, &str); 10] = [
    ("setup", "Set-up"),
    ("forces", "Forces and signals"),
    ("detection", "Detection"),
    ("theories", "Small and finite strain"),
    ("inputs", "Uncertain inputs"),
    ("people", "People"),
    ("noise", "Noise"),
    ("comparison", "Paper | here | why"),
    ("quality", "Quality of the maps"),
    ("closing", "How to rerun, and limits"),
];

/// What the page is made of.
#[derive(Template)]
#[template(path = "report/page.html")]
struct Page<'a> {
    run: &'a Run,
    settings: &'a Settings,
    found: &'a Findings,
    figures: &'a [Figure],
}

/// One self-contained page: what was found, the figures and tables, the comparison, the certificates.
///
/// Implements: REP-040, REP-041, REP-042, REP-060, REP-061, REP-064, REP-081, REP-083.
pub fn html(run: &Run, findings: &Findings, figures: &[Figure]) -> String {
    let page = Page {
        run,
        settings: &run.settings,
        found: findings,
        figures,
    };
    // Neither writing to a String nor any of our formats fails.
    printable(&page.render().expect("a page of text and numbers"))
}

impl Page<'_> {
    /// All figures of a topic, in their order.
    fn figures(&self, topic: Topic) -> impl Iterator<Item = &Figure> {
        let figures = self.figures.iter();
        figures.filter(move |figure| figure.topic == topic)
    }

    /// The number of maps whose signal is strong enough for both error rates, and of those where it is with more unknown.
    fn detected(&self) -> [usize; 2] {
        let count = |gamma: fn(&MapFindings) -> f64| {
            let gammas = self.found.maps.iter().map(gamma);
            let is_enough = |gamma: &f64| *gamma >= self.found.required_gamma;
            gammas.filter(is_enough).count()
        };
        [
            count(|map| map.gamma.both),
            count(|map| map.gamma_left.by_default.both),
        ]
    }

    /// The least and the largest peak of the normal signals, N.
    fn peaks(&self) -> Option<[f64; 2]> {
        let maps = self.found.maps.iter();
        text::extremes(maps.map(|map| map.peak_normal.force_n.abs()))
    }

    /// What the answers to FEM playback say of the whole level of the normal force, over the sweeps that the maps hold.
    ///
    /// Implements: PSY-085.
    fn felt(&self) -> Option<String> {
        let bridge = self.found.bridge.as_ref()?;
        let weights = &bridge.conditions.get(paper::FEM_PLAYBACK)?.weights;
        let [from, to] =
            [weights.first()?, weights.last()?].map(|of| text::millimetres(of.half_sweep_m));
        let (range, on) = match from == to {
            true => (format!("±{from} mm"), "what of it counts"),
            false => (format!("±{from} to ±{to} mm"), "how far they swept"),
        };
        let worst = "explained worst by the whole level of the normal force, whose peak the paper's noise estimate rests on";
        let is_worst = weights.iter().filter(|of| of.level_fits_worst()).count();
        Some(if is_worst == 0 {
            format!("are not {worst}, over any sweep of {range}")
        } else if is_worst < weights.len() {
            format!(
                "do not tell whether subjects feel the level of the normal force or its change along the sweep: over sweeps of {range}, \
                 that depends on {on}"
            )
        } else if weights.iter().all(|of| of.left.upper < 1.0) {
            format!("are {worst}, over every sweep of {range}, and reject it")
        } else {
            let rejecting = weights.iter().filter(|of| of.left.upper < 1.0).count();
            let of = weights.len();
            format!(
                "are {worst}, over every sweep of {range}, but reject it in {rejecting} of {of} fits"
            )
        })
    }

    /// The phantoms whose gel passes through itself at some pose, where forces mean nothing.
    fn inverted(&self) -> Vec<&str> {
        let is_inverted = |of: &&Quality| of.certificate.smallest_det.det <= 0.0;
        let all = self.certificates();
        let inverted = all.filter(|(_, of)| of.as_ref().is_some_and(is_inverted));
        inverted.map(|(name, _)| &**name).collect()
    }

    /// Whether the gel of the reference is a body of revolution.
    fn is_axisymmetric(&self) -> bool {
        let phantom = self.run.reference.phantom();
        phantom.is_some_and(|of| of.geometry() == Geometry::Axisymmetric)
    }

    /// The noise that explains the answers to FEM playback at 6.6 mm by the peak signal: ours beside the paper's.
    fn subjects_noise(&self) -> Option<&Comparison> {
        let paper = Value::ForceN(paper::SUBJECTS_NOISE);
        self.found.comparison.iter().find(|row| row.paper == paper)
    }

    /// What a study says of the explanations of the answers: a sentence for each fate that some have.
    ///
    /// Implements: REP-083.
    fn explanations(&self, study: &StudyResults) -> Vec<String> {
        let fates = [
            (Survival::Holds, "are rejected whatever the inputs"),
            (Survival::Depends, "are rejected or not, as the inputs are"),
            (Survival::Fails, "are rejected for hardly any inputs"),
        ];
        // The subjects felt the paper's depth.
        let fates = fates
            .into_iter()
            .filter(|_| self.found.probe_depth_note.is_none());
        let sentence = |(fate, words): (Survival, &str)| {
            let conclusions = study.conclusions.iter().filter(|of| survival(of) == fate);
            let named = conclusions.filter_map(|of| match &of.quantity.kind {
                Kind::ConventionP { convention } => {
                    Some(format!("{convention} ({})", text::percent(of.share)))
                }
                _ => None,
            });
            let names: Vec<_> = named.collect();
            let listed = (!names.is_empty()).then(|| names.join("; "));
            listed.map(|named| format!("These explanations of the answers to FEM playback {words} (share of the draws): {named}."))
        };
        fates.filter_map(sentence).collect()
    }

    /// The band of the force without inclusion at x = 0; only for the paper's reference at the paper's depth.
    ///
    /// Implements: REP-083.
    fn level(&self, study: &StudyResults) -> Option<Band> {
        let reference = &study.plan.reference;
        let is_paper_depth = self.found.probe_depth_note.is_none();
        if !is_paper_depth || paper::name_of(reference) != Some("none") {
            return None;
        }
        let force = Kind::NormalForceN { lateral_m: 0.0 };
        study.of(reference.name(), &force)?.band
    }

    /// Whether the gel of the reference is at finite strain.
    fn is_finite(&self) -> bool {
        let certificate = self.run.reference.certificate();
        certificate.is_some_and(|of| of.law.is_some())
    }

    /// Name and certificate of the reference and of every map.
    fn certificates(&self) -> impl Iterator<Item = (&String, Option<&Quality>)> {
        let reference = &self.found.reference;
        let maps = self.found.maps.iter();
        let of_maps = maps.map(|map| (&map.name, map.quality.as_ref()));
        once((&reference.name, reference.quality.as_ref())).chain(of_maps)
    }
}

/// The variance of the sum of independent sources of noise, N².
fn variance(sources: &[f64]) -> f64 {
    sources.iter().map(|sd| sd * sd).sum()
}

/// The share of a source in the variance of the sum of some, if it belongs to them.
fn share(sources: &[f64], source: f64) -> Option<f64> {
    let belongs = sources.contains(&source);
    belongs.then(|| variance(&[source]) / variance(sources))
}

/// Whether a conclusion survives, in words.
fn fate(of: &Conclusion) -> &'static str {
    match survival(of) {
        Survival::Holds => "this conclusion survives the uncertainty of the inputs",
        Survival::Depends => "this conclusion depends on the inputs",
        Survival::Fails => "this conclusion does not survive the uncertainty of the inputs",
    }
}

/// An explanation by the forces of another theory, where it has a signal.
fn explained<'a>(theory: &'a TheoryFindings, explanation: &Explanation) -> Option<&'a Explanation> {
    let mut explanations = theory.explanations.iter();
    explanations.find(|of| of.name == explanation.name)
}

/// To which depth of the probe each map of one theory serves on a gel of another, in words.
fn serving(on: &TheoryFindings, of: &TheoryFindings) -> String {
    let each = on.templates.iter().map(|template| {
        let first = template.at.iter().position(|at| !at.serves);
        let how_far = match (first, &template.at[..]) {
            (_, []) => "at a depth that is unknown, for want of a signal".into(),
            (None, _) => "at every depth".into(),
            (_, at) if at.iter().all(|at| !at.serves) => "at no depth".into(),
            (Some(next), at) if at[next..].iter().all(|at| !at.serves) => {
                format!("to {} mm", text::millimetres(at[next - 1].depth_m))
            }
            (_, at) => {
                let served = at.iter().filter(|at| at.serves);
                let served = served.map(|at| text::millimetres(at.depth_m));
                format!("at {} mm alone", text::joined(served, " and "))
            }
        };
        format!("{} {how_far}", template.name)
    });
    let each = text::joined(each, ", ");
    text::prose(format!(
        "On a gel of {}, the maps of {} serve: {each}.",
        on.name, of.name
    ))
}

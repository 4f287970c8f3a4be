//! The page: one file that opens from disk, without scripts and without anything from a network.
//!
//! What it says stands in the templates `templates/report/`, one for each section; here is what they choose from. Text is escaped
//! by the template engine.

pub mod table;

use askama::Template;

use super::text::{escape, printable};
use super::{Comparison, Figure, Findings, Quality, Settings, Study, Topic, Value, paper, text};
use crate::psychophysics::bridge::WeightRange;

/// How the page looks.
///
/// Implements: REP-034, REP-064, REP-067, REP-068.
pub const STYLE: &str = include_str!("style.css");
/// What the name of the SVG namespace is called inside HTML: nothing, since HTML knows `<svg>` by itself.
const NAMESPACE: &str = " xmlns=\"http://www.w3.org/2000/svg\"";

/// The sections below the opening: what the contents link to, and their headings.
const CONTENTS: [(&str, &str); 8] = [
    ("setup", "Set-up"),
    ("forces", "Forces and signals"),
    ("detection", "Detection"),
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
    study: &'a Study,
    settings: &'a Settings,
    found: &'a Findings,
    figures: &'a [Figure],
}

/// One self-contained page: what was found, the figures and tables, the comparison, the certificates.
///
/// Implements: REP-040, REP-041, REP-042, REP-043, REP-044, REP-060, REP-061, REP-062, REP-063, REP-065, REP-066.
pub fn html(study: &Study, findings: &Findings, figures: &[Figure]) -> String {
    let page = Page {
        study,
        settings: &study.settings,
        found: findings,
        figures,
    };
    // Neither writing to a String nor any of our formats fails.
    printable(&page.render().expect("a page of text and numbers"))
}

/// A section with its heading, which names it for a screen reader. `heading` is text, `markup` is markup.
pub fn section(id: &str, heading: &str, markup: &str) -> String {
    format!(
        "<section id=\"{id}\" aria-labelledby=\"{id}-heading\">\n<h2 id=\"{id}-heading\">{}</h2>\n{markup}</section>\n",
        escape(heading)
    )
}

impl Page<'_> {
    /// All figures of a topic, in their order.
    fn figures(&self, topic: Topic) -> impl Iterator<Item = &Figure> {
        self.figures
            .iter()
            .filter(move |figure| figure.topic == topic)
    }

    /// The number of maps whose signal is strong enough for both error rates.
    fn detected(&self) -> usize {
        let maps = self.found.maps.iter();
        maps.filter(|map| map.gamma.both >= self.found.required_gamma)
            .count()
    }

    /// The least and the largest peak of the normal signals, N.
    fn peaks(&self) -> Option<[f64; 2]> {
        let peaks = self
            .found
            .maps
            .iter()
            .map(|map| map.peak_normal.force.abs());
        text::extremes(peaks)
    }

    /// What the subjects' answers to FEM playback do with the force that they used.
    fn felt(&self) -> Option<&'static str> {
        let bridge = self.found.bridge.as_ref()?;
        let weights = &bridge.conditions.get(paper::FEM_PLAYBACK)?.weights;
        if weights.is_empty() {
            return None;
        }
        let is_worst = weights.iter().all(WeightRange::level_fits_worst);
        Some(
            match (is_worst, weights.iter().all(|of| of.left.upper < 1.0)) {
                (true, true) => {
                    "are explained worst by the whole level of the normal force, whose peak the paper's noise estimate rests on, \
                 and reject it, however far the subjects swept"
                }
                (true, false) => {
                    "are explained worst by the whole level of the normal force, whose peak the paper's noise estimate rests on, \
                 however far the subjects swept, but do not reject it over every sweep"
                }
                (false, _) => {
                    "do not tell whether subjects feel the level of the normal force or its change along the sweep: that depends \
                 on how far they swept"
                }
            },
        )
    }

    /// The noise that explains the answers to FEM playback at 6.6 mm by the peak signal: ours beside the paper's.
    fn subjects_noise(&self) -> Option<&Comparison> {
        let paper = Value::ForceN(paper::SUBJECTS_NOISE);
        self.found.comparison.iter().find(|row| row.paper == paper)
    }

    /// Name and certificate of the reference and of every map.
    fn certificates(&self) -> impl Iterator<Item = (&String, Option<&Quality>)> {
        let reference = &self.found.reference;
        let maps = self.found.maps.iter();
        [(&reference.name, reference.quality.as_ref())]
            .into_iter()
            .chain(maps.map(|map| (&map.name, map.quality.as_ref())))
    }
}

/// Which rows of [`paper::NOISE_SOURCES`] add up in an experiment.
struct NoiseChain {
    name: &'static str,
    sources: &'static [usize],
    /// The sum that the paper prints, N.
    printed: Option<f64>,
}

const NOISE_CHAINS: [NoiseChain; 3] = [
    NoiseChain {
        name: "FEM playback",
        sources: &[1, 2, 4],
        printed: Some(paper::PLAYBACK_NOISE),
    },
    NoiseChain {
        name: "Measured playback",
        sources: &[0, 1, 2, 4],
        printed: None,
    },
    NoiseChain {
        name: "Direct contact",
        sources: &[3, 4],
        printed: Some(paper::DIRECT_CONTACT_NOISE),
    },
];

impl NoiseChain {
    fn variance(&self) -> f64 {
        self.sources.iter().map(|&k| variance(k)).sum()
    }

    /// The standard deviation of the sum, N.
    fn total(&self) -> f64 {
        libm::sqrt(self.variance())
    }

    /// The share of a source in the variance, if it belongs to the experiment.
    fn share(&self, source: usize) -> Option<f64> {
        let belongs = self.sources.contains(&source);
        belongs.then(|| variance(source) / self.variance())
    }
}

/// The variance of a row of [`paper::NOISE_SOURCES`], N².
fn variance(source: usize) -> f64 {
    let sd = paper::NOISE_SOURCES[source].1;
    sd * sd
}

//! The head of the page: what was found, contents, and the set-up.

use super::detection::limit;
use super::{CONTENTS, Page};
use crate::psychophysics::bridge::{Bridge, WeightRange};
use crate::report::text::{escape, fixed, millimetres, prose, trimmed};
use crate::report::{Topic, Value, paper};

/// Title and subject.
pub fn header() -> &'static str {
    "<header>\n<h1>Inclusion probing: what a rigid probe feels, and what can be detected from it</h1>\n\
     <p class=\"lead\">A rerun of J. Yan, P. K. Scott and R. S. Fearing, <cite>Inclusion probing: signal detection and \
     haptic playback of 2D FEM and experimental data</cite> (1999).</p>\n</header>\n"
}

/// A number that tells, with what it is.
struct Highlight {
    number: String,
    words: String,
}

/// What was found, in short, and the contents.
///
/// Implements: REP-060.
pub fn opening(page: &Page<'_>) -> String {
    let cards: String = highlights(page)
        .iter()
        .map(|Highlight { number, words }| {
            format!(
                "<li><strong>{}</strong> {}</li>\n",
                prose(number),
                prose(words)
            )
        })
        .collect();
    let entries: String = CONTENTS
        .iter()
        .map(|(id, heading)| format!("<li><a href=\"#{id}\">{}</a></li>\n", escape(heading)))
        .collect();
    format!(
        "<section id=\"short\" aria-labelledby=\"short-heading\">\n<h2 id=\"short-heading\">In short</h2>\n{}\
         <ul class=\"numbers\">\n{cards}</ul>\n{}</section>\n\
         <nav aria-label=\"Contents\">\n<h2>Contents</h2>\n<ol>\n{entries}</ol>\n</nav>\n",
        found(page),
        note(page)
    )
}

/// The findings in words.
fn found(page: &Page<'_>) -> String {
    let findings = page.findings;
    let met = findings
        .maps
        .iter()
        .filter(|map| map.gamma.both >= findings.required_gamma)
        .count();
    let settings = &page.study.settings;
    let ideal = match findings.maps.len() {
        0 => "There is no map beside the reference, so nothing can be detected.".into(),
        all => format!(
            "An ideal detector that reads both forces at all {} positions of the sweep, each in independent noise of {} N, \
             finds the inclusion of {met} of {all} \
             phantoms with at most {} false alarms and {} misses.",
            findings.samples,
            trimmed(settings.noise_sd, 6),
            limit(settings.max_false_alarm),
            limit(settings.max_miss)
        ),
    };
    format!(
        "<p>What the paper did is done again: the force on a probe that sweeps over a gel is computed by 2D finite \
         elements, and what a hard inclusion adds to it is given to the paper's detector. {}{}</p>\n",
        prose(&ideal),
        findings.bridge.as_ref().map_or(String::new(), felt)
    )
}

/// What the subjects' answers to FEM playback say of the force that they used.
fn felt(bridge: &Bridge) -> String {
    let Some(condition) = bridge.conditions.get(paper::FEM_PLAYBACK) else {
        return String::new();
    };
    let weights = &condition.weights;
    if weights.is_empty() {
        return String::new();
    }
    let is_worst = weights.iter().all(WeightRange::level_fits_worst);
    let verdict = match (is_worst, weights.iter().all(|of| of.left.upper < 1.0)) {
        (true, true) => {
            "are explained worst by the whole level of the normal force, whose peak the paper's noise estimate rests on, and \
             reject it, however far the subjects swept"
        }
        (true, false) => {
            "are explained worst by the whole level of the normal force, whose peak the paper's noise estimate rests on, \
             however far the subjects swept, but do not reject it over every sweep"
        }
        (false, _) => {
            "do not tell whether subjects feel the level of the normal force or its change along the sweep: that depends on how \
             far they swept"
        }
    };
    format!(
        " Set against these forces, the answers of the paper's ten subjects to FEM playback {verdict} \
         (<a href=\"#people\">People</a>)."
    )
}

/// The numbers that tell most.
fn highlights(page: &Page<'_>) -> Vec<Highlight> {
    let findings = page.findings;
    let mut all = Vec::new();
    let level = findings.reference.normal_force_at_centre;
    if let Some(level) = level {
        let paper = findings
            .bridge
            .as_ref()
            .map_or("", |_| "; the paper has 1.6 N as nominal");
        all.push(Highlight {
            number: format!("{} N", fixed(level, 2)),
            words: format!(
                "normal force on the probe without an inclusion at depth {} mm{paper}",
                millimetres(findings.probe_depth)
            ),
        });
    }
    let signals = findings.maps.iter().map(|map| map.peak_normal.force.abs());
    let (least, largest) = signals.fold((f64::INFINITY, 0.0_f64), |(least, largest), signal| {
        (least.min(signal), largest.max(signal))
    });
    if !findings.maps.is_empty() {
        all.push(Highlight {
            number: format!("{} to {} N", fixed(least, 2), fixed(largest, 2)),
            words: "peak of what the inclusions add to the normal force".into(),
        });
    }
    all.push(Highlight {
        number: format!("γ ≥ {}", fixed(findings.required_gamma, 2)),
        words: format!(
            "signal-to-noise ratio needed for at most {} false alarms and {} misses",
            limit(page.study.settings.max_false_alarm),
            limit(page.study.settings.max_miss)
        ),
    });
    all.extend(subjects_noise(page));
    all.extend(width_of_intervals(page));
    all
}

/// The noise that explains the answers to FEM playback at 6.6 mm by the peak signal: ours beside the paper's.
fn subjects_noise(page: &Page<'_>) -> Option<Highlight> {
    let paper = Value::ForceN(paper::SUBJECTS_NOISE);
    let row = page
        .findings
        .comparison
        .iter()
        .find(|row| row.paper == paper)?;
    Some(Highlight {
        number: row.here.text(),
        words: format!(
            "noise that explains the subjects' {} at 6.6 mm by the peak signal; the paper has {}",
            limit(paper::ACCURACY_6_6),
            row.paper.text()
        ),
    })
}

/// How much too narrow intervals are that take all answers as alike.
fn width_of_intervals(page: &Page<'_>) -> Option<Highlight> {
    let inclusions = page
        .findings
        .people
        .conditions
        .iter()
        .flat_map(|of| &of.inclusions);
    let ratios: Vec<_> = inclusions
        .filter_map(|inclusion| Some(inclusion.clustered.as_ref()?.width_ratio))
        .collect();
    let largest = ratios.iter().copied().reduce(f64::max)?;
    Some(Highlight {
        number: format!("{} ×", fixed(largest, 1)),
        words: "how much wider, at the most, a 95 % interval for the subjects' rate of right answers is than one of \
                the paper's kind, once the subjects may differ, as they do"
            .into(),
    })
}

/// What the signals were taken at, if that is not what the paper did.
fn note(page: &Page<'_>) -> String {
    let note = page.findings.probe_depth_note.as_ref();
    note.map_or(String::new(), |note| {
        format!("<p class=\"note\">{}</p>\n", prose(note))
    })
}

/// Phantom, probe and problem.
///
/// Implements: REP-035.
pub fn setup(page: &Page<'_>) -> String {
    let range = |axis: &[f64]| match axis {
        [first, .., last] => format!("{} to {} mm", millimetres(*first), millimetres(*last)),
        [only] => format!("{} mm", millimetres(*only)),
        [] => String::new(),
    };
    let settings = &page.study.settings;
    let words = format!(
        "A probe sweeps over a gel at a fixed depth. Maps: one of a gel without inclusion, and {count} other{s}. Depths \
         of the probe: {depths}. Lateral positions: {laterals}, {samples} of them. Assumed by the detector: noise of \
         {noise} N in every sample of both channels, and the prior Pr(H = 1) = {prior}.",
        count = page.study.maps.len(),
        s = if page.study.maps.len() == 1 { "" } else { "s" },
        depths = range(page.study.reference.depths()),
        laterals = range(page.study.reference.laterals()),
        samples = page.findings.samples,
        noise = trimmed(settings.noise_sd, 6),
        prior = trimmed(settings.prior_h1, 6),
    );
    format!("<p>{}</p>\n{}", prose(&words), page.figures(Topic::Setup))
}

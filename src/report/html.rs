//! The page: one file that opens from disk, without scripts and without anything from a network.

use super::comparison::{Comparison, PairwiseFinding};
use super::findings::{Findings, MapFindings, Peak, Quality, Threshold};
use super::text::{escape, fixed, millimetres, percent, prose, scientific, trimmed};
use super::{Figure, Study};

/// What the name of the SVG namespace is called inside HTML: nothing, since HTML knows `<svg>` by itself.
const NAMESPACE: &str = " xmlns=\"http://www.w3.org/2000/svg\"";

/// One self-contained page with findings, comparison, figures and certificates.
///
/// Implements: REP-040, REP-041, REP-042, REP-043.
pub fn html(study: &Study, findings: &Findings, figures: &[Figure]) -> String {
    let body = [
        introduction(study, findings),
        results(study, findings),
        comparison(findings),
        pictures(figures),
        certificates(findings),
        rerun(),
    ];
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Inclusion probing: report of palpate</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
        include_str!("style.css"),
        body.concat()
    )
}

/// A table that scrolls inside its own box, named by the caption above it, which does not scroll. `kind` is `""`, or
/// `stack` for a table whose rows become blocks on a narrow page. Caption, heads and cells are markup; a head has a
/// class; the first cell of a row heads it.
fn table(
    kind: &str,
    id: &str,
    caption: &str,
    head: &[(&str, &str)],
    rows: &[Vec<String>],
) -> String {
    let class = |class: &str| match class {
        "" => String::new(),
        class => format!(" class=\"{class}\""),
    };
    let mut markup = format!(
        "<p class=\"caption\" id=\"{id}\">{caption}</p>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" \
         aria-labelledby=\"{id}\">\n<table{}>\n<thead><tr>",
        class(kind)
    );
    for (name, kind) in head {
        markup += &format!("<th scope=\"col\"{}>{name}</th>", class(kind));
    }
    markup += "</tr></thead>\n<tbody>\n";
    for row in rows {
        markup += "<tr>";
        for (k, (cell, (name, kind))) in row.iter().zip(head).enumerate() {
            let kind = class(kind);
            markup += &match k {
                0 => format!("<th scope=\"row\"{kind}>{cell}</th>"),
                // Only tables that stack show the name, and their heads are plain words.
                _ if !name.contains('<') => {
                    format!("<td{kind} data-name=\"{name}\">{cell}</td>")
                }
                _ => format!("<td{kind}>{cell}</td>"),
            };
        }
        markup += "</tr>\n";
    }
    markup + "</tbody>\n</table>\n</div>\n"
}

fn introduction(study: &Study, findings: &Findings) -> String {
    let settings = &study.settings;
    let range = |axis: &[f64]| match axis {
        [first, .., last] => format!("{} to {} mm", millimetres(*first), millimetres(*last)),
        [only] => format!("{} mm", millimetres(*only)),
        [] => String::new(),
    };
    let note = findings.probe_depth_note.as_ref();
    let note = note.map(|note| format!("<p class=\"note\">{}</p>\n", prose(note)));
    format!(
        "<header>\n<h1>Inclusion probing: what a rigid probe feels, and what can be detected from it</h1>\n\
         <p class=\"lead\">A rerun of J. Yan, P. K. Scott and R. S. Fearing, <cite>Inclusion probing: signal \
         detection and haptic playback of 2D FEM and experimental data</cite>.</p>\n</header>\n\
         <p>A probe sweeps over a gel at a fixed depth. This page holds the force on it, computed by 2D finite \
         elements (or read from a file, where a table says so), for a gel without inclusion and for {count} other \
         {maps}; the signal that an inclusion adds; and how reliably a matched filter detects it in white Gaussian noise. \
         Depths of the probe: {depths}. Lateral positions: {laterals}, {samples} of them.</p>\n\
         <p><strong>What it is not.</strong> The model is two-dimensional, linear, static and without friction, as \
         the paper's is, with moduli that the paper calls “roughly determined”. Nothing here was measured on \
         tissue, and the error rates are those of the model under its own noise, not of a device or of a person.</p>\n\
         <p>Assumed: noise of {noise} N in every sample of both channels, at most {fa} false alarms and {miss} \
         misses, prior Pr(H = 1) = {prior}.</p>\n{note}",
        count = study.maps.len(),
        maps = if study.maps.len() == 1 {
            "phantom"
        } else {
            "phantoms"
        },
        depths = range(study.reference.depths()),
        laterals = range(study.reference.laterals()),
        samples = findings.samples,
        noise = trimmed(settings.noise_sd, 6),
        fa = limit(settings.max_false_alarm),
        miss = limit(settings.max_miss),
        prior = trimmed(settings.prior_h1, 6),
        note = note.unwrap_or_default(),
    )
}

fn results(study: &Study, findings: &Findings) -> String {
    let mut markup = String::from("<section>\n<h2>Findings</h2>\n");
    if findings.maps.is_empty() {
        return markup
            + "<p>The study holds no map beside the reference, so there is no signal.</p>\n</section>\n";
    }
    for map in &findings.maps {
        for warning in &map.warnings {
            markup += &format!(
                "<p class=\"warning\"><strong>Phantom {}.</strong> {}</p>\n",
                escape(&map.name),
                prose(warning)
            );
        }
    }
    markup += &signal_table(findings);
    markup += &format!(
        "<p class=\"soft\">γ takes all {} samples of the sweep in each channel as independent readings, so it \
         grows with their number (as its square root for even finer steps). It is not the γ of the paper's subjects, \
         which rests on one peak; that is below, under “Pairs”.</p>\n",
        findings.samples
    );
    markup += &threshold_table(study, findings);
    markup + "</section>\n"
}

fn peak_cell(peak: Peak) -> String {
    format!(
        "{} at {}",
        fixed(peak.force, 3),
        trimmed(peak.lateral * 1e3, 3)
    )
}

fn signal_table(findings: &Findings) -> String {
    let row = |map: &MapFindings| {
        let depth = map.inclusion_depth.map_or("none".into(), millimetres);
        let enough = if map.gamma.both >= findings.required_gamma {
            "yes"
        } else {
            "no"
        };
        vec![
            escape(&map.name),
            depth,
            peak_cell(map.peak_normal),
            peak_cell(map.peak_lateral),
            fixed(map.gamma.both, 2),
            fixed(map.gamma.normal, 2),
            fixed(map.gamma.lateral, 2),
            enough.into(),
        ]
    };
    let rows: Vec<_> = findings.maps.iter().map(row).collect();
    let caption = format!(
        "Signal F₁ − F₀ at probe depth {} mm, and the signal-to-noise ratio γ of the matched filter over the whole \
         sweep. Needed for both error rates: γ ≥ {}.",
        millimetres(findings.probe_depth),
        fixed(findings.required_gamma, 2)
    );
    let head = [
        ("Phantom", ""),
        ("Inclusion depth (mm)", "number"),
        ("Peak normal (N at mm)", "number"),
        ("Peak lateral (N at mm)", "number"),
        ("γ", "number"),
        ("γ, normal alone", "number"),
        ("γ, lateral alone", "number"),
        ("Rates met", "number"),
    ];
    table("", "table-signals", &caption, &head, &rows)
}

fn threshold_table(study: &Study, findings: &Findings) -> String {
    let cells = |threshold: Option<Threshold>| match threshold {
        Some(t) => [trimmed(t.eta, 2), rate(t.false_alarm), rate(t.miss)],
        None => ["none", "–", "–"].map(String::from),
    };
    let row = |map: &MapFindings| {
        let mut row = vec![escape(&map.name)];
        row.extend(cells(Some(map.map_rule)));
        row.extend(cells(Some(map.bounded_miss)));
        row.extend(cells(map.bounded_false_alarm));
        row.extend([percent(map.auc), percent(map.two_afc)]);
        row
    };
    let rows: Vec<_> = findings.maps.iter().map(row).collect();
    let caption = format!(
        "Thresholds η on Θ, with the false-alarm rate P<sub>fa</sub> and the miss rate P<sub>miss</sub> that follow: maximum a posteriori \
         (MAP), and Neyman–Pearson (NP) with at most {} misses or at most {} false alarms. AUC is the area under the \
         curve of hits against false alarms, and equals the rate of right answers in pairs (2AFC).",
        limit(study.settings.max_miss),
        limit(study.settings.max_false_alarm)
    );
    let number = |name| (name, "number");
    let head = [
        ("Phantom", ""),
        number("MAP: η"),
        number("P<sub>fa</sub>"),
        number("P<sub>miss</sub>"),
        number("NP, misses bounded: η"),
        number("P<sub>fa</sub>"),
        number("P<sub>miss</sub>"),
        number("NP, false alarms bounded: η"),
        number("P<sub>fa</sub>"),
        number("P<sub>miss</sub>"),
        number("AUC"),
        number("2AFC"),
    ];
    table("", "table-thresholds", &caption, &head, &rows)
}

/// A rate that was asked for, in per cent.
fn limit(rate: f64) -> String {
    format!("{} %", trimmed(100.0 * rate, 6))
}

/// An error rate: small ones by their power of ten.
fn rate(probability: f64) -> String {
    if probability > 0.0 && probability < 1e-3 {
        scientific(probability)
    } else {
        percent(probability)
    }
}

fn comparison(findings: &Findings) -> String {
    let row = |row: &Comparison| {
        let tag = if row.is_calibration {
            " <span class=\"tag\">calibration</span>"
        } else {
            ""
        };
        vec![
            format!(
                "{} <span class=\"soft\">({})</span>",
                prose(&row.quantity),
                escape(row.place)
            ),
            prose(&row.paper_text),
            format!("{}{tag}", prose(&row.here.text())),
            prose(&row.why),
        ]
    };
    let rows: Vec<_> = findings.comparison.iter().map(row).collect();
    let head = [
        ("Quantity", "quantity"),
        ("Paper", "number"),
        ("Here", "number"),
        ("Why", "why"),
    ];
    let caption = "Each number that the paper prints and this run covers; rows whose phantom or depth is not in \
                   the run are left out.";
    format!(
        "<section>\n<h2>Paper and here</h2>\n{}{}</section>\n",
        table("stack", "table-paper", caption, &head, &rows),
        pairs(findings)
    )
}

fn pairs(findings: &Findings) -> String {
    let Some(calibration) = findings.calibration else {
        return String::new();
    };
    let row = |pair: &PairwiseFinding| {
        let tag = if pair.is_calibration {
            " <span class=\"tag\">calibration</span>"
        } else {
            ""
        };
        let mut row = vec![
            format!("{} mm", pair.phantom),
            fixed(pair.peak_signal, 3),
            fixed(pair.gamma, 2),
            format!("{}{tag}", percent(pair.predicted)),
        ];
        row.extend(pair.observed.map(|observed| {
            format!(
                "{} ({} of {})",
                percent(observed.share()),
                observed.correct,
                observed.trials
            )
        }));
        row
    };
    let rows: Vec<_> = findings.pairwise.iter().map(row).collect();
    let number = |name| (name, "number");
    let head = [
        ("Inclusion", ""),
        number("Peak signal (N)"),
        number("γ = peak/noise"),
        number("Predicted Φ(γ/√2)"),
        number("Direct contact"),
        number("FEM data"),
        number("Measured data"),
    ];
    let caption = format!(
        "Right answers in pairs: predicted with one noise level, {} N, fitted to the FEM playback at 6.6 mm (that row \
         is a calibration and proves nothing), and counted in the paper's Table 1, ten subjects pooled. The subjects \
         differ more than chance allows, so pooled shares are less certain than 300 trials suggest.",
        fixed(calibration.noise, 3)
    );
    format!(
        "<h3>Pairs</h3>\n{}",
        table("", "table-pairs", &caption, &head, &rows)
    )
}

fn pictures(figures: &[Figure]) -> String {
    let mut markup = String::from("<section>\n<h2>Figures</h2>\n<div class=\"figures\">\n");
    for figure in figures {
        markup += &format!(
            "<figure>\n<div class=\"picture\">{}</div>\n<figcaption><strong>{}</strong>{} <span class=\"soft\">({})</span></figcaption>\n</figure>\n",
            figure.svg.replacen(NAMESPACE, "", 1),
            prose(&figure.title),
            prose(&figure.caption),
            escape(&figure.file_name)
        );
    }
    markup + "</div>\n</section>\n"
}

fn certificates(findings: &Findings) -> String {
    let reference = (
        &findings.reference.name,
        findings.reference.quality.as_ref(),
    );
    let others = findings
        .maps
        .iter()
        .map(|map| (&map.name, map.quality.as_ref()));
    let row = |(name, quality): (&String, Option<&Quality>)| {
        let mut row = vec![escape(name)];
        match quality {
            Some(quality) => row.extend(quality_cells(quality)),
            None => row.push("measured, no certificate".into()),
        }
        row
    };
    let rows: Vec<_> = [reference].into_iter().chain(others).map(row).collect();
    let number = |name| (name, "number");
    let head = [
        ("Map", ""),
        number("Mesh (mm)"),
        number("Nodes"),
        ("Element", ""),
        ("Contact", ""),
        number("Worst residual"),
        number("Worst imbalance (N)"),
        number("Bands of normal, lateral force (N)"),
        number("Penetration (m)"),
        number("Smallest det(I + ∇u)"),
        number("at depth, x (mm)"),
        ("Version", ""),
    ];
    let caption = "Residual: the largest ‖Ku − f‖/‖f‖ of the linear solves. Imbalance: force on the probe against \
                   the reaction of floor and walls. Bands: how far the mesh may leave a force from that of an infinitely fine \
                   one, at the most. Penetration: the largest depth of a surface node inside the probe.";
    format!(
        "<section>\n<h2>Certificates</h2>\n{}</section>\n",
        table("", "table-certificates", caption, &head, &rows)
    )
}

/// Implements: REP-044.
fn quality_cells(quality: &Quality) -> [String; 11] {
    [
        millimetres(quality.mesh_size),
        quality.nodes.to_string(),
        escape(&quality.element),
        escape(&quality.contact),
        scientific(quality.worst_relative_residual),
        scientific(quality.worst_force_balance),
        match (quality.largest_normal_band, quality.largest_lateral_band) {
            (Some(normal), Some(lateral)) => {
                format!("{}, {}", scientific(normal), scientific(lateral))
            }
            _ => "not estimated".into(),
        },
        scientific(quality.largest_penetration),
        fixed(quality.smallest_det, 3),
        format!(
            "{}, {}",
            millimetres(quality.smallest_det_depth),
            trimmed(quality.smallest_det_lateral * 1e3, 3)
        ),
        escape(&quality.program_version),
    ]
}

fn rerun() -> String {
    format!(
        "<section>\n<h2>How to rerun</h2>\n\
         <p>In the folder of the source, with a Rust toolchain and a C compiler:</p>\n\
         <pre><code>cargo run --release -- run</code></pre>\n\
         <p>It writes this page, <code>summary.json</code> with the same numbers for programs, every map and every \
         figure. The same input gives the same bytes. <code>spec/report.md</code> says what each of them must hold.</p>\n\
         </section>\n<footer class=\"soft\">Written by palpate {}.</footer>\n",
        env!("CARGO_PKG_VERSION")
    )
}

//! The section on sources of noise: Table 2.

use super::Page;
use super::table::{Group, Layout, Table};
use crate::psychophysics::{NoiseDecomposition, NoiseLevel, OpenBounds};
use crate::report::paper;
use crate::report::text::{escape, percent, prose, trimmed};

/// Which rows of [`paper::NOISE_SOURCES`] add up in playback of FEM data, in playback of measured data, and in direct
/// contact.
const CHAINS: [(&str, &[usize]); 3] = [
    ("FEM playback", &[1, 2, 4]),
    ("Measured playback", &[0, 1, 2, 4]),
    ("Direct contact", &[3, 4]),
];

/// A force, N, in mN.
fn millinewtons(force: f64) -> String {
    trimmed(1e3 * force, 1)
}

/// Table 2 with the share of each source in the noise of each experiment.
///
/// Implements: REP-063.
pub fn noise(page: &Page<'_>) -> String {
    let variance = |source: usize| paper::NOISE_SOURCES[source].1 * paper::NOISE_SOURCES[source].1;
    let totals = CHAINS.map(|(_, sources)| sources.iter().map(|&k| variance(k)).sum::<f64>());
    let row = |(k, (name, level)): (usize, &(&str, f64))| {
        let mut row = vec![escape(name), millinewtons(*level)];
        row.extend(CHAINS.iter().zip(totals).map(
            |((_, sources), total)| match sources.contains(&k) {
                true => escape(&percent(variance(k) / total)),
                false => "–".into(),
            },
        ));
        row
    };
    let mut groups = Group::plain(paper::NOISE_SOURCES.iter().enumerate().map(row).collect());
    let sums = |name: &str, cells: [String; 3]| {
        let mut row = vec![name.into(), "–".into()];
        row.extend(cells);
        row
    };
    groups.push(Group {
        heading: "Sum of the variances, as a standard deviation".into(),
        rows: vec![
            sums(
                "Here (mN)",
                totals.map(|total| millinewtons(libm::sqrt(total))),
            ),
            sums(
                "Paper, §5 (mN)",
                [
                    millinewtons(paper::PLAYBACK_NOISE),
                    "not printed".into(),
                    millinewtons(paper::DIRECT_CONTACT_NOISE),
                ],
            ),
        ],
    });
    let head = [
        ("Source", "quantity"),
        ("Noise level (mN)", "number"),
        (CHAINS[0].0, "number"),
        (CHAINS[1].0, "number"),
        (CHAINS[2].0, "number"),
    ];
    let caption = "Table 2. Noise estimates: the paper's sources and levels, and here the share of each in the variance of \
                   each experiment. Which sources belong to which experiment is the paper's §5, where it says so; it does \
                   not for the playback of measured data, where the sensor is added to the sources of playback.";
    let table = Table {
        id: "table-2",
        caption,
        layout: Layout::Rows,
        head: &head,
        groups,
    };
    format!(
        "<p>All levels are the paper's; none was measured again. The paper also measured {} mN as the standard deviation \
         of the display's force (§4), which Table 2 leaves out.</p>\n{}{}",
        millinewtons(paper::DISPLAY_ERROR),
        table.markup(),
        levels(&page.findings.noise)
    )
}

/// The noise levels of §5 with intervals.
fn levels(noise: &NoiseDecomposition) -> String {
    let end = |end: Option<f64>| end.map_or("no bound".into(), millinewtons);
    let bounds = |bounds: Option<OpenBounds>| {
        bounds.map_or("–".into(), |OpenBounds { lower, upper }| {
            format!("{} to {}", end(lower), end(upper))
        })
    };
    let row = |level: &NoiseLevel| {
        vec![
            prose(level.name),
            level.printed.map_or("not printed".into(), millinewtons),
            millinewtons(level.noise),
            bounds(level.pooled_bounds),
            bounds(level.clustered_bounds),
            prose(&format!("{}; {}.", level.formula, level.assumption)),
        ]
    };
    let head = [
        ("Noise level", "quantity"),
        ("Paper (mN)", "number"),
        ("Here (mN)", "number"),
        ("95 %, all answers alike (mN)", "number"),
        ("95 %, by subject (mN)", "number"),
        ("How", "why"),
    ];
    let table = Table {
        id: "table-noise",
        caption: "The noise levels of the paper's §5 from its own numbers, with intervals where they rest on counted answers.",
        layout: Layout::Stack,
        head: &head,
        groups: Group::plain(noise.levels.iter().map(row).collect()),
    };
    format!("{}<p>{}</p>\n", table.markup(), prose(&noise.agreement))
}

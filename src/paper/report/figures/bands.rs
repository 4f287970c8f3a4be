//! Bands of a study as lines.

use crate::study::Band;
use palpate::chart::Line;
use palpate::chart::style::VERMILION;

/// The ends of bands along x as two dashed lines, in units of 1/`scale`; none without bands.
pub fn band_ends(of: &str, bands: &[(f64, Band)], scale: f64) -> Vec<Line> {
    let line = |words: &str, end: fn(&Band) -> f64| {
        let points = bands.iter().map(|(x, band)| (*x, scale * end(band)));
        let line = Line::new(VERMILION, points.collect()).dashed(true);
        line.named(format!("{of}{words}"))
    };
    match bands {
        [] => Vec::new(),
        _ => vec![
            line("2.5 %", |band| band.lower.value),
            line("97.5 %", |band| band.upper.value),
        ],
    }
}

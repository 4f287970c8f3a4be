//! What a sweep has told so far of each place of a bank.

use super::panel::{Line, Panel};
use super::style::{GREY, INK, PALETTE};
use super::{chart, round_range};
use crate::bank::{Told, WatchedPlace};
use crate::refusal::Refusal;
use crate::text::extremes;

/// The places of a bank by what the samples so far say of them, as an SVG document: not covered, not excluded or excluded. Of several sizes and
/// moduli at a place the one of which least is known counts.
///
/// # Errors
/// If drawing fails.
///
/// Implements: CLI-233, SEQ-026.
pub fn coverage_figure(places: &[WatchedPlace]) -> Result<String, Refusal> {
    let at = |place: &WatchedPlace| (1e3 * place.position, 1e3 * place.depth);
    let least = |place: &WatchedPlace| {
        let same = places.iter().filter(|other| at(other) == at(place));
        same.map(|other| other.told).min()
    };
    let of = |told: Told| -> Vec<(f64, f64)> {
        let those = places.iter().filter(|place| least(place) == Some(told));
        let mut points: Vec<_> = those.map(at).collect();
        points.dedup();
        points
    };
    let kinds = [
        (Told::Uncovered, GREY, 2, "not covered by the path"),
        (Told::Open, INK, 7, "an inclusion is not excluded"),
        (Told::Excluded, PALETTE[0], 4, "an inclusion is excluded"),
    ];
    let lines = kinds.map(|(told, colour, radius, name)| {
        Line::new(colour, of(told))
            .wide(0.0)
            .dotted(radius)
            .named(name)
    });
    let ends = extremes(places.iter().map(|place| 1e3 * place.position)).unwrap_or_default();
    let words = kinds.map(|(told, .., name)| {
        let count = places.iter().filter(|place| place.told == told).count();
        format!("{name}: {count}")
    });
    let depths = places.iter().map(|place| 1e3 * place.depth);
    let panel = Panel {
        x_name: "Lateral position of the inclusion (mm)".into(),
        ..Panel::new(
            "Depth of the inclusion's highest point (mm)",
            [[ends[0] - 1.0, ends[1] + 1.0], round_range(depths)],
            300,
            lines.into(),
        )
    };
    let title = "What the sweep has told of each place";
    chart(
        &[panel],
        [
            "coverage",
            title,
            &format!("Of {} places, {}.", places.len(), words.join(", ")),
        ],
    )
}

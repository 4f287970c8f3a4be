//! How deep an inclusion may lie to be found.

use super::panel::{Line, Panel};
use super::style::{GREY, INK, PALETTE};
use super::{chart, round_range};
use crate::bank::{Bank, Reached};
use crate::refusal::Refusal;
use crate::text::{extremes, trimmed};

/// How deep an inclusion may lie to be found, against its diameter, as an SVG document: with nothing unknown, and beside what is
/// `unknown` in words.
///
/// # Errors
/// If drawing fails.
///
/// Implements: CLI-163.
pub fn reach_figure(
    bank: &Bank,
    plain: &[Reached],
    beside: &[Reached],
    unknown: &str,
) -> Result<String, Refusal> {
    let [_, depths, diameters, _] = bank.axes();
    let ends = extremes(diameters.iter().map(|diameter| 1e3 * diameter)).unwrap_or_default();
    let room = (0.05 * (ends[1] - ends[0])).max(0.5);
    let x = [ends[0] - room, ends[1] + room];
    let deepest = 1e3 * depths.last().copied().unwrap_or_default();
    let sample = |is_dashed| dotted(Line::new(INK, Vec::new()), is_dashed);
    let lines = lines(bank, [plain, beside], x, deepest);
    let is_found = plain.iter().chain(beside).any(|of| of.depth.is_some());
    let none = "No inclusion of the bank is found, not even at the least depth.";
    let panel = Panel {
        x_name: "Diameter of the inclusion (mm)".into(),
        key: vec![
            sample(false).named("nothing unknown"),
            sample(true).named(format!("unknown: {unknown}")),
        ],
        caption: (!is_found).then(|| none.into()).into_iter().collect(),
        ticks: match diameters.len() {
            1..=8 => diameters.iter().map(|diameter| 1e3 * diameter).collect(),
            _ => Vec::new(),
        },
        ..Panel::new(
            "Largest depth at which it is found (mm)",
            [x, round_range([deepest].into_iter())],
            300,
            lines,
        )
    };
    let alt = reach_in_words(plain, beside, unknown);
    let title = "How deep an inclusion may lie to be found";
    chart(&[panel], ["reach", title, &alt])
}

/// The end of the bank, and two lines for each modulus: with nothing unknown, and beside what is, in dashes.
fn lines(bank: &Bank, reached: [&[Reached]; 2], x: [f64; 2], deepest: f64) -> Vec<Line> {
    let moduli = &bank.axes()[3];
    let limit = Line::new(GREY, vec![(x[0], deepest), (x[1], deepest)]);
    let mut lines = vec![limit.wide(1.2).named("bank's end (found there: or deeper)")];
    for (&modulus, colour) in moduli.iter().zip(PALETTE.into_iter().cycle()) {
        for (reached, is_dashed) in reached.into_iter().zip([false, true]) {
            let of_modulus = reached.iter().filter(|of| of.modulus == modulus);
            let points = of_modulus.filter_map(|of| Some((1e3 * of.diameter, 1e3 * of.depth?)));
            let name = match moduli.len() {
                2.. if !is_dashed => format!("{} kPa", trimmed(1e-3 * modulus, 3)),
                _ => String::new(),
            };
            let line = dotted(Line::new(colour, points.collect()), is_dashed);
            lines.push(line.named(name));
        }
    }
    lines
}

/// A line with dots: in dashes with smaller ones, which tell it apart where there is but one diameter.
fn dotted(line: Line, is_dashed: bool) -> Line {
    let radius = if is_dashed { 2 } else { 4 };
    line.dotted(radius).dashed(is_dashed)
}

/// The figure in words.
fn reach_in_words(plain: &[Reached], beside: &[Reached], unknown: &str) -> String {
    let depth = |of: &Reached| match of.depth {
        None => "not at all".into(),
        Some(depth) if of.is_beyond => format!("beyond {} mm", trimmed(1e3 * depth, 2)),
        Some(depth) => format!("{} mm", trimmed(1e3 * depth, 2)),
    };
    let line = |(plain, beside): (&Reached, &Reached)| {
        format!(
            "{} mm wide, {} kPa: {} with nothing unknown, {} beside {unknown}",
            trimmed(1e3 * plain.diameter, 3),
            trimmed(1e-3 * plain.modulus, 3),
            depth(plain),
            depth(beside)
        )
    };
    let all: Vec<_> = plain.iter().zip(beside).map(line).collect();
    format!(
        "Largest depth at which an inclusion is found. {}.",
        all.join("; ")
    )
}

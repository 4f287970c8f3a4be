//! Where an inclusion lies, by a bank.

use std::collections::HashMap;

use plotters::style::RGBColor;

use super::panel::{Cells, DrawingResult, Line, Panel, PanelKind};
use super::style::{INK, VERMILION};
use super::with_head;
use super::{CHORDS, to_mm};
use super::{chart, round_range};
use crate::bank::{Bank, Parameter, PlacePosterior};
use crate::phantom::{Inclusion, Shape};
use crate::refusal::Refusal;
use crate::text::{extremes, trimmed};

/// The colours of the credible regions with their levels, the later over the earlier.
const REGIONS: [(f64, RGBColor); 2] = [
    (0.95, RGBColor(168, 207, 236)),
    (0.5, RGBColor(46, 143, 200)),
];
/// The level of the intervals.
const LEVEL: f64 = 0.95;
/// Parts nearer than this touch, m or Pa: less than any two points of a bank are apart.
const TOUCHING: f64 = 1e-12;

/// What one axis of a bank shows: words, unit, and how many of the unit are one in SI.
fn words(parameter: Parameter) -> (&'static str, &'static str, f64) {
    match parameter {
        Parameter::Position => ("Position x of the inclusion", "mm", 1e3),
        Parameter::Depth => ("Depth of the inclusion", "mm", 1e3),
        Parameter::Diameter => ("Diameter of the inclusion", "mm", 1e3),
        Parameter::Modulus => ("Young's modulus of the inclusion", "kPa", 1e-3),
    }
}

/// Where the inclusion of a record lies, if it has one, as an SVG document: the posterior of each parameter that the bank varies, and, if
/// position and depth do, the gel with their credible regions.
///
/// # Errors
/// If drawing fails.
///
/// Implements: CLI-163.
pub fn place_figure(bank: &Bank, place: &PlacePosterior) -> Result<String, Refusal> {
    let draw = || -> DrawingResult<String> {
        let mut panels = Vec::new();
        let mut alt = Vec::new();
        let is_free = [0, 1, 2, 3].map(|axis: usize| bank.axes()[axis].len() > 1);
        if is_free[0] && is_free[1] {
            panels.push(gel(bank, place));
        }
        for (axis, parameter) in Parameter::ALL.into_iter().enumerate() {
            if is_free[axis] {
                let (panel, text) = marginal(bank, place, axis, parameter)?;
                panels.push(panel);
                alt.push(text);
            }
        }
        let title = "Where the inclusion lies, if there is one";
        let drawn = chart(&panels, "")?;
        with_head(drawn, "place", title, &format!("{}.", alt.join("; ")))
    };
    draw().map_err(Refusal::because("figure of the place"))
}

/// Probabilities summed over all nodes with the same key, in the order of the second and then the first entry of the keys.
fn summed(place: &PlacePosterior, key: impl Fn([f64; 4]) -> [f64; 2]) -> Vec<([f64; 2], f64)> {
    let mut sums: HashMap<[u64; 2], f64> = HashMap::new();
    for (at, mass) in place.nodes() {
        *sums.entry(key(at).map(f64::to_bits)).or_default() += mass;
    }
    let unpacked = |(key, mass): ([u64; 2], f64)| (key.map(f64::from_bits), mass);
    let mut sums: Vec<_> = sums.into_iter().map(unpacked).collect();
    sums.sort_by(|([a, b], _), ([c, d], _)| b.total_cmp(d).then(a.total_cmp(c)));
    sums
}

/// Both ends of the part of an axis with these `points` that each of its `nodes`, increasing, stands for: those of a cell share it
/// evenly.
fn parts(points: &[f64], nodes: &[f64]) -> Vec<[f64; 2]> {
    let cell = |node: f64| points.partition_point(|&point| point <= node);
    let of_cell = nodes.chunk_by(|&a, &b| cell(a) == cell(b));
    let parts = of_cell.flat_map(|nodes| {
        let next = cell(nodes[0]).clamp(1, points.len() - 1);
        let (from, to) = (points[next - 1], points[next]);
        let end = move |k: usize| from + k as f64 / nodes.len() as f64 * (to - from);
        (0..nodes.len()).map(move |k| [end(k), end(k + 1)])
    });
    parts.collect()
}

/// The posterior of one parameter, and its interval in words.
fn marginal(
    bank: &Bank,
    place: &PlacePosterior,
    axis: usize,
    parameter: Parameter,
) -> DrawingResult<(Panel, String)> {
    let (name, unit, scale) = words(parameter);
    let points = &bank.axes()[axis];
    // A probability per kPa would have too many zeros.
    let (per, of_si) = match parameter {
        Parameter::Modulus => ("MPa", 1e-6),
        _ => (unit, scale),
    };
    let curve = density(points, place, axis, of_si);
    let interval = place.interval(axis, LEVEL)?;
    let (low, high, estimate) = (interval.lower, interval.upper, place.estimate[axis]);
    let range = shown_range(points, [low, high], estimate);
    let is_shown = |x: f64| (range[0]..=range[1]).contains(&x);
    let scaled = |points: Vec<(f64, f64)>| -> Vec<(f64, f64)> {
        points.into_iter().map(|(x, y)| (scale * x, y)).collect()
    };
    let mut inside = vec![(low, 0.0), (low, density_at(&curve, low))];
    inside.extend(curve.iter().filter(|(x, _)| (low..=high).contains(x)));
    inside.extend([(high, density_at(&curve, high)), (high, 0.0)]);
    let [from, to] = range.map(|x| (x, density_at(&curve, x)));
    let between = curve.iter().copied().filter(|point| is_shown(point.0));
    let shown: Vec<_> = [from].into_iter().chain(between).chain([to]).collect();
    let y = round_range(shown.iter().map(|point| point.1));
    let at_estimate = vec![(estimate, 0.0), (estimate, y[1])];
    let area = Line::area(REGIONS[0].1, scaled(inside));
    let estimated = Line::new(VERMILION, scaled(at_estimate)).dashed(true);
    let [estimate, low, high] = [estimate, low, high].map(|x| trimmed(scale * x, 3));
    let x = range.map(|x| scale * x);
    let lines = vec![
        area.named(format!("95 %: {low} to {high}")),
        Line::new(INK, scaled(shown)),
        estimated.named(format!("likeliest: {estimate}")),
    ];
    let heading = format!("Probability density (1/{per})");
    let panel = Panel {
        x_name: format!("{name} ({unit})"),
        ..Panel::new(heading, [x, y], 150, lines)
    };
    let text =
        format!("{name}: {estimate} {unit}, with 95 % probability from {low} to {high} {unit}");
    Ok((panel, text))
}

/// The part of an axis with these `points` that is shown: the interval and the estimate, with some room.
fn shown_range(points: &[f64], [low, high]: [f64; 2], estimate: f64) -> [f64; 2] {
    let (first, last) = (points[0], points[points.len() - 1]);
    let aside = (high - low).max(0.02 * (last - first));
    [
        (low.min(estimate) - aside).max(first),
        (high.max(estimate) + aside).min(last),
    ]
}

/// The posterior density of one parameter over an axis with these `points`, per unit, of which `of_si` are one in SI.
fn density(points: &[f64], place: &PlacePosterior, axis: usize, of_si: f64) -> Vec<(f64, f64)> {
    let sums = summed(place, |at| [at[axis], 0.0]);
    let nodes: Vec<f64> = sums.iter().map(|([node, _], _)| *node).collect();
    let parts = parts(points, &nodes);
    let masses = sums.iter().map(|(_, mass)| mass);
    let densities = masses.zip(&parts);
    let densities = densities.map(|(mass, [from, to])| mass / (of_si * (to - from)));
    let curve: Vec<(f64, f64)> = nodes.iter().copied().zip(densities).collect();
    with_ends(&curve, [points[0], points[points.len() - 1]], &parts)
}

/// A curve with its first and last values up to the ends of an axis, or 0 where its `parts` do not reach them.
fn with_ends(curve: &[(f64, f64)], [first, last]: [f64; 2], parts: &[[f64; 2]]) -> Vec<(f64, f64)> {
    let (Some(begin), Some(end)) = (curve.first(), curve.last()) else {
        return Vec::new();
    };
    let (Some([from, _]), Some([_, to])) = (parts.first(), parts.last()) else {
        return Vec::new();
    };
    let mut whole = Vec::new();
    if from - first > TOUCHING {
        whole.extend([(first, 0.0), (*from, 0.0)])
    } else {
        whole.push((first, begin.1))
    }
    whole.extend(curve);
    if last - to > TOUCHING {
        whole.extend([(*to, 0.0), (last, 0.0)])
    } else {
        whole.push((last, end.1))
    }
    whole
}

/// A curve, straight between its points, at `x`.
fn density_at(curve: &[(f64, f64)], x: f64) -> f64 {
    let next = curve.partition_point(|point| point.0 < x);
    match (next.checked_sub(1).map(|k| &curve[k]), curve.get(next)) {
        (Some(a), Some(b)) if b.0 > a.0 => a.1 + (x - a.0) / (b.0 - a.0) * (b.1 - a.1),
        (_, Some(point)) | (Some(point), None) => point.1,
        (None, None) => 0.0,
    }
}

/// The gel to scale, with the likeliest inclusion and the credible regions of its highest point.
fn gel(bank: &Bank, place: &PlacePosterior) -> Panel {
    let sums = summed(place, |at| [at[0], at[1]]);
    let cells = rectangles(bank, &sums);
    let inclusion = likeliest(bank, place);
    let outline = inclusion.as_ref().map(|inclusion| {
        let corners = inclusion.outline().chords(CHORDS);
        let corners = corners.iter().chain(corners.first());
        to_mm(corners.map(|[x, y]| [*x, -y]))
    });
    let outline = outline.unwrap_or_default();
    let laterals = bank.reference().table().laterals().iter().map(|x| 1e3 * x);
    let across = extremes(laterals.chain(outline.iter().map(|corner| corner.0)));
    let x = across.unwrap_or([-1.0, 1.0]);
    let depths = bank.axes()[1].iter().map(|depth| 1e3 * depth);
    let down = extremes(depths.chain(outline.iter().map(|corner| corner.1)));
    let deepest = 1.05 * down.map_or(1.0, |ends| ends[1]);
    let estimate = (1e3 * place.estimate[0], 1e3 * place.estimate[1]);
    let dot = Line::new(VERMILION, vec![estimate]).wide(0.0).dotted(3);
    let outline = Line::new(VERMILION, outline).dashed(true);
    let regions = REGIONS.map(|(level, fill)| Cells {
        fill,
        edge: fill,
        areas: region(&cells, level),
    });
    let sample = |name: &str, colour| Line::area(colour, Vec::new()).named(name);
    let likeliest = Line::new(VERMILION, Vec::new()).dashed(true).dotted(3);
    Panel {
        x_name: "Position x (mm)".into(),
        kind: PanelKind::ToScale,
        key: vec![
            likeliest.named("likeliest inclusion"),
            sample("its top: 50 %", REGIONS[1].1),
            sample("95 %", REGIONS[0].1),
        ],
        cells: regions.into(),
        ..Panel::new(
            "Depth below the surface (mm)",
            [x, [deepest, 0.0]],
            ((438.0 / (x[1] - x[0]) * deepest) as i32).clamp(120, 600),
            vec![outline, dot],
        )
    }
}

/// The part of the gel that each node of position and depth stands for.
fn rectangles(bank: &Bank, sums: &[([f64; 2], f64)]) -> Vec<Rectangle> {
    let ends = [0, 1].map(|axis: usize| -> HashMap<u64, [f64; 2]> {
        let mut nodes: Vec<f64> = sums.iter().map(|(at, _)| at[axis]).collect();
        nodes.sort_by(f64::total_cmp);
        nodes.dedup();
        let parts = parts(&bank.axes()[axis], &nodes);
        nodes.into_iter().map(f64::to_bits).zip(parts).collect()
    });
    let rectangle = |(at, mass): &([f64; 2], f64)| {
        let [across, down] = [0, 1].map(|axis: usize| ends[axis][&at[axis].to_bits()]);
        let area = (across[1] - across[0]) * (down[1] - down[0]);
        ([across, down], *mass, mass / area)
    };
    sums.iter().map(rectangle).collect()
}

/// The inclusion of the largest likelihood.
fn likeliest(bank: &Bank, place: &PlacePosterior) -> Option<Inclusion> {
    let mut inclusion = bank
        .maps()
        .first()?
        .phantom()?
        .inclusions()
        .first()?
        .clone();
    let [x, depth, width, _] = place.estimate;
    inclusion.centre_x = x;
    inclusion.depth = depth;
    if let Shape::Disc { diameter } = &mut inclusion.shape {
        *diameter = width;
    }
    Some(inclusion)
}

/// A rectangle of positions and depths with its probability and density.
type Rectangle = ([[f64; 2]; 2], f64, f64);

/// The fewest `cells` that hold the probability `level`, neighbours in a row as one, mm.
fn region(cells: &[Rectangle], level: f64) -> Vec<Vec<(f64, f64)>> {
    let mut order: Vec<usize> = (0..cells.len()).collect();
    order.sort_by(|&a, &b| cells[b].2.total_cmp(&cells[a].2));
    let mut sum = 0.0;
    let inside = order.into_iter().take_while(|&cell| {
        let is_inside = sum < level;
        sum += cells[cell].1;
        is_inside
    });
    let mut inside: Vec<usize> = inside.collect();
    inside.sort_unstable();
    let mut rows: Vec<[[f64; 2]; 2]> = Vec::new();
    for cell in inside {
        let [across, down] = cells[cell].0;
        match rows.last_mut() {
            Some([before, row]) if *row == down && across[0] - before[1] <= TOUCHING => {
                before[1] = across[1];
            }
            _ => rows.push([across, down]),
        }
    }
    let corners = |[[left, right], [top, bottom]]: [[f64; 2]; 2]| {
        to_mm([[left, top], [right, top], [right, bottom], [left, bottom]])
    };
    rows.into_iter().map(corners).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: CLI-163.
    #[test]
    fn the_nodes_of_a_cell_share_it_evenly() {
        // Two nodes in the first cell, none in the second, three in the last.
        let found = parts(&[0.0, 4.0, 5.0, 8.0], &[1.0, 3.0, 5.5, 6.5, 7.5]);
        let expected = [[0.0, 2.0], [2.0, 4.0], [5.0, 6.0], [6.0, 7.0], [7.0, 8.0]];
        assert_eq!(found, expected);
    }

    // Verifies: CLI-163.
    #[test]
    fn a_curve_is_0_where_no_cell_counts() {
        let curve = [(2.5, 1.0), (3.5, 3.0)];
        let whole = with_ends(&curve, [0.0, 4.0], &[[2.0, 3.0], [3.0, 4.0]]);
        let expected = [(0.0, 0.0), (2.0, 0.0), (2.5, 1.0), (3.5, 3.0), (4.0, 3.0)];
        assert_eq!(whole, expected);
        for (x, y) in [(-1.0, 0.0), (1.0, 0.0), (2.25, 0.5), (3.0, 2.0), (5.0, 3.0)] {
            assert_eq!(density_at(&whole, x), y);
        }
    }

    // Verifies: CLI-163.
    #[test]
    fn a_region_has_the_densest_cells_and_joins_neighbours() {
        let cell = |x: f64, y: f64, mass: f64, density: f64| {
            (
                [[1e-3 * x, 1e-3 * (x + 1.0)], [1e-3 * y, 1e-3 * (y + 1.0)]],
                mass,
                density,
            )
        };
        // The third is the smallest part, but the densest.
        let cells = [
            cell(0.0, 1.0, 0.3, 3.0),
            cell(1.0, 1.0, 0.3, 4.0),
            cell(0.0, 2.0, 0.1, 5.0),
            cell(1.0, 2.0, 0.3, 1.0),
        ];
        let row =
            |from, to, top: f64| vec![(from, top), (to, top), (to, top + 1.0), (from, top + 1.0)];
        assert_eq!(region(&cells, 0.1), [row(0.0, 1.0, 2.0)]);
        assert_eq!(
            region(&cells, 0.4),
            [row(1.0, 2.0, 1.0), row(0.0, 1.0, 2.0)]
        );
        assert_eq!(
            region(&cells, 0.5),
            [row(0.0, 2.0, 1.0), row(0.0, 1.0, 2.0)]
        );
    }
}

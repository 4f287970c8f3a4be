//! Where an inclusion lies, by a bank.

use plotters::style::RGBColor;

use super::lines::with_room;
use super::panel::{Cells, Line, Panel, PanelKind};
use super::style::{INK, VERMILION};
use super::{CHORDS, chart, round_range, to_mm};
use crate::bank::{Bank, Parameter, PlacePosterior};
use crate::detect::DetectError;
use crate::phantom::{Inclusion, Shape};
use crate::refusal::Refusal;
use crate::robust::PlaceInterval;
use crate::rows::CREDIBLE;
use crate::text::{extremes, trimmed};

/// The colours of the credible regions with their levels, the later over the earlier.
const REGIONS: [(f64, RGBColor); 2] = [
    (0.95, RGBColor(168, 207, 236)),
    (0.5, RGBColor(46, 143, 200)),
];
/// Spans nearer than this touch, in the units of a bank and of its figure: rounding alone is between them.
const TOUCHING: f64 = 1e-12;

/// What one axis of a bank shows: words, unit, and how many of the unit are one in SI.
pub fn words(parameter: Parameter) -> (&'static str, &'static str, f64) {
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
    let is_free = bank.axes().each_ref().map(|points| points.len() > 1);
    let mut panels = Vec::new();
    if is_free[0] && is_free[1] {
        panels.push(gel(bank, place));
    }
    let free = (0..4).filter(|&axis| is_free[axis]);
    let marginals = free.map(|axis| marginal(bank, place, axis));
    let marginals = marginals.collect::<Result<Vec<_>, _>>();
    let (densities, words): (Vec<_>, Vec<_>) = marginals
        .map_err(Refusal::because("figure of the place"))?
        .into_iter()
        .unzip();
    panels.extend(densities);
    let title = "Where the inclusion lies, if there is one";
    chart(&panels, ["place", title, &format!("{}.", words.join("; "))])
}

/// Probabilities summed over all nodes with the same place on two axes, in the order of the second and then the first.
fn summed(place: &PlacePosterior, [first, second]: [usize; 2]) -> Vec<([f64; 2], f64)> {
    let nodes = place.nodes();
    let mut nodes: Vec<_> = nodes
        .map(|(at, mass)| ([at[first], at[second]], mass))
        .collect();
    nodes.sort_by(|([a, b], _), ([c, d], _)| b.total_cmp(d).then(a.total_cmp(c)));
    let equal = nodes.chunk_by(|(a, _), (b, _)| a == b);
    let sum = |of: &[([f64; 2], f64)]| (of[0].0, of.iter().map(|(_, mass)| mass).sum());
    equal.map(sum).collect()
}

/// Both ends of the span of an axis with these `points` that each of its `nodes`, increasing, stands for: those of a cell share it
/// evenly.
fn spans(points: &[f64], nodes: &[f64]) -> Vec<[f64; 2]> {
    let cell = |node: f64| points.partition_point(|&point| point <= node);
    let of_cell = nodes.chunk_by(|&a, &b| cell(a) == cell(b));
    let spans = of_cell.flat_map(|nodes| {
        let next = cell(nodes[0]).clamp(1, points.len() - 1);
        let (from, to) = (points[next - 1], points[next]);
        let end = move |k: usize| from + k as f64 / nodes.len() as f64 * (to - from);
        (0..nodes.len()).map(move |k| [end(k), end(k + 1)])
    });
    spans.collect()
}

/// The posterior of one parameter, and its interval in words.
fn marginal(
    bank: &Bank,
    place: &PlacePosterior,
    axis: usize,
) -> Result<(Panel, String), DetectError> {
    let (name, unit, scale) = words(Parameter::ALL[axis]);
    // A probability per kPa would have too many zeros.
    let (per, of_unit) = match unit {
        "kPa" => ("MPa", 1e-3),
        _ => (unit, 1.0),
    };
    let points: Vec<f64> = bank.axes()[axis].iter().map(|x| scale * x).collect();
    let sums = summed(place, [axis; 2]);
    let nodes: Vec<f64> = sums.iter().map(|([node, _], _)| scale * node).collect();
    let spans = spans(&points, &nodes).into_iter();
    let bars = spans
        .zip(&sums)
        .map(|([from, to], (_, mass))| ([from, to], mass / (of_unit * (to - from))));
    let bars: Vec<_> = bars.collect();
    let interval = place.ends(axis, CREDIBLE)?;
    let range = interval.in_words(|x| trimmed(scale * x, 3));
    let (first, last) = (points[0], points[points.len() - 1]);
    let [low, high] = [interval.lower, interval.upper].map(|end| end.map(|x| scale * x));
    let from = if low.and(high).is_some() { "from " } else { "" };
    let (low, high) = (low.unwrap_or(first), high.unwrap_or(last));
    let estimate = scale * interval.estimate;
    // The interval and the estimate are shown, with some room.
    let aside = (high - low).max(0.02 * (last - first));
    let x = [
        (low.min(estimate) - aside).max(first),
        (high.max(estimate) + aside).min(last),
    ];
    let panel = Panel {
        heading: format!("Probability density (1/{per})"),
        ..posterior(axis, &bars, x, interval, "likeliest")
    };
    let estimate = trimmed(estimate, 3);
    let words = format!("{name}: {estimate} {unit}, with 95 % probability {from}{range} {unit}");
    Ok((panel, words))
}

/// Bars of one parameter, each from end to end with its height, between two places: those of the interval filled, and its estimate, which
/// is what `estimated` calls it.
pub fn posterior(
    axis: usize,
    bars: &[([f64; 2], f64)],
    x: [f64; 2],
    interval: PlaceInterval,
    estimated: &str,
) -> Panel {
    let (name, unit, scale) = words(Parameter::ALL[axis]);
    let [low, high] = [interval.lower, interval.upper].map(|end| end.map(|x| scale * x));
    let (low, high) = (low.unwrap_or(x[0]), high.unwrap_or(x[1]));
    let (estimate, range) = (
        scale * interval.estimate,
        interval.in_words(|x| trimmed(scale * x, 3)),
    );
    let shown = outline(bars, x);
    let y = round_range(shown.iter().map(|point| point.1));
    let area = Line::area(REGIONS[0].1, outline(bars, [low, high]));
    let line = Line::new(VERMILION, vec![(estimate, 0.0), (estimate, y[1])]).dashed(true);
    let lines = vec![
        area.named(format!("95 %: {range}")),
        Line::new(INK, shown),
        line.named(format!("{estimated}: {}", trimmed(estimate, 3))),
    ];
    Panel {
        x_name: format!("{name} ({unit})"),
        ..Panel::new("", [x, y], 150, lines)
    }
}

/// The outline of bars, each from end to end with its height, between two places: 0 where there is none.
fn outline(bars: &[([f64; 2], f64)], [low, high]: [f64; 2]) -> Vec<(f64, f64)> {
    let mut outline = vec![(low, 0.0)];
    let mut end = low;
    for &([from, to], height) in bars {
        let (from, to) = (from.max(low), to.min(high));
        if from < to {
            if from - end > TOUCHING {
                outline.extend([(end, 0.0), (from, 0.0)]);
            }
            outline.extend([(from, height), (to, height)]);
            end = to;
        }
    }
    outline.extend([(end, 0.0), (high, 0.0)]);
    outline
}

/// The gel to scale, with the likeliest inclusion and the credible regions of its highest point.
fn gel(bank: &Bank, place: &PlacePosterior) -> Panel {
    let cells = rectangles(bank, &summed(place, [0, 1]));
    let corners = likeliest(bank, place).map(|of| of.outline().chords(CHORDS));
    let corners = corners.unwrap_or_default();
    let corners = corners.iter().chain(corners.first());
    let outline = to_mm(corners.map(|[x, y]| [*x, -y]));
    let laterals = bank.reference().table().laterals().iter().map(|x| 1e3 * x);
    let across = extremes(laterals.chain(outline.iter().map(|corner| corner.0)));
    let depths = bank.axes()[1].iter().map(|depth| 1e3 * depth);
    let down = extremes(depths.chain(outline.iter().map(|corner| corner.1)));
    let deepest = 1.05 * down.map_or(1.0, |ends| ends[1]);
    let (x, deepest, height) = with_room(across.unwrap_or([-1.0, 1.0]), deepest, 120.0);
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
            height,
            vec![outline, dot],
        )
    }
}

/// The rectangle of the gel that each node of position and depth stands for.
fn rectangles(bank: &Bank, sums: &[([f64; 2], f64)]) -> Vec<Rectangle> {
    let spans = [0, 1].map(|axis: usize| {
        let mut nodes: Vec<f64> = sums.iter().map(|(at, _)| at[axis]).collect();
        nodes.sort_by(f64::total_cmp);
        nodes.dedup();
        let spans = spans(&bank.axes()[axis], &nodes);
        move |at: f64| spans[nodes.partition_point(|&node| node < at)]
    });
    let rectangle = |&([x, depth], mass): &([f64; 2], f64)| {
        let [across, down] = [spans[0](x), spans[1](depth)];
        let area = (across[1] - across[0]) * (down[1] - down[0]);
        ([across, down], mass, mass / area)
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
    use super::super::panel::{LEFT, RIGHT};
    use super::super::style::WIDTH;
    use super::*;
    use crate::bank::{BankDetector, BankPlan};
    use crate::detect::nuisance::NoiseLevel;
    use crate::phantom::{Phantom, PhantomParts};

    // Verifies: CLI-163.
    #[test]
    fn the_nodes_of_a_cell_share_it_evenly() {
        // Two nodes in the first cell, none in the second, three in the last.
        let found = spans(&[0.0, 4.0, 5.0, 8.0], &[1.0, 3.0, 5.5, 6.5, 7.5]);
        let expected = [[0.0, 2.0], [2.0, 4.0], [5.0, 6.0], [6.0, 7.0], [7.0, 8.0]];
        assert_eq!(found, expected);
    }

    // Verifies: CLI-163.
    #[test]
    fn an_outline_is_0_where_no_cell_counts() {
        let bars = [([1.0, 2.0], 0.5), ([2.0, 3.0], 1.0), ([4.0, 6.0], 2.0)];
        let found = outline(&bars, [0.0, 5.0]);
        let x = [
            0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 5.0, 5.0, 5.0,
        ];
        let y = [
            0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 0.0, 0.0, 2.0, 2.0, 0.0, 0.0,
        ];
        assert_eq!(found, std::iter::zip(x, y).collect::<Vec<_>>());
        assert_eq!(outline(&bars, [3.2, 3.8])[1..3], [(3.2, 0.0), (3.8, 0.0)]);
    }

    // Verifies: CLI-163.
    #[test]
    fn a_region_has_the_densest_cells_and_joins_neighbours() {
        let cell = |x: f64, y: f64, mass: f64, density: f64| {
            let square = [x, y].map(|from| [1e-3 * from, 1e-3 * (from + 1.0)]);
            (square, mass, density)
        };
        // The third is the least likely, but the densest.
        let cells = [
            cell(0.0, 1.0, 0.3, 3.0),
            cell(1.0, 1.0, 0.3, 4.0),
            cell(0.0, 2.0, 0.1, 5.0),
            cell(1.0, 2.0, 0.3, 1.0),
        ];
        let row =
            |from, to, top: f64| vec![(from, top), (to, top), (to, top + 1.0), (from, top + 1.0)];
        let third = row(0.0, 1.0, 2.0);
        assert_eq!(region(&cells, 0.1), std::slice::from_ref(&third));
        let joined = [(0.4, row(1.0, 2.0, 1.0)), (0.5, row(0.0, 2.0, 1.0))];
        for (level, first) in joined {
            assert_eq!(region(&cells, level), [first, third.clone()]);
        }
    }

    /// A bank over a sweep from −`side` to `side`, m, with two positions and two depths, m, and where a record finds its inclusion.
    fn placed(phantom: Phantom, side: f64, depths: [f64; 2]) -> (Bank, PlacePosterior) {
        let mut plan = BankPlan::new(phantom, 3e-3, &[-side, side]).unwrap();
        (plan.positions, plan.depths) = (vec![-1e-3, 1e-3], depths.into());
        plan.mesh_size = 4e-3;
        let bank = plan.bank().unwrap();
        // Of four places, each with a sample of its own, the record shows the first.
        let templates = (0..16).map(|k| if k % 5 == 0 { 9.0 } else { 0.0 });
        let detector = BankDetector::new(
            bank.axes(),
            templates.collect(),
            &[0.25; 4],
            Vec::new(),
            &[],
            NoiseLevel::Known,
        );
        let detector = detector.unwrap();
        let found = detector.statistic(&mut [9.0, 0.0, 0.0, 0.0]).unwrap();
        let place = detector.place(&found);
        (bank, place)
    }

    // Verifies: CLI-163.
    #[test]
    fn the_gel_is_to_scale_however_narrow_or_wide_the_bank_is() {
        let small = |parts: &mut PhantomParts| {
            parts.inclusions[0].shape = Shape::Disc { diameter: 1e-3 };
        };
        let disc = Phantom::builtin("4.6").unwrap();
        let small = disc.changed(small).unwrap();
        for (phantom, side, depths) in [
            (&disc, 1e-3, [2.6e-3, 8.6e-3]),
            (&disc, 8e-3, [2.6e-3, 4.6e-3]),
            (&small, 11e-3, [0.7e-3, 1e-3]),
        ] {
            let (bank, place) = placed(phantom.clone(), side, depths);
            let panel = gel(&bank, &place);
            let ([left, right], [deepest, surface]) = (panel.x, panel.y);
            let across = f64::from(WIDTH - LEFT - RIGHT) / (right - left);
            let off = f64::from(panel.height) - across * (deepest - surface);
            assert!(off.abs() < 1.0, "{side}: {off} pixels");
            assert!((120..=601).contains(&panel.height), "{}", panel.height);
            assert!(left <= -1e3 * side && right >= 1e3 * side, "{side}");
            assert!(deepest >= 1e3 * depths[1] && surface == 0.0, "{side}");
        }
    }

    // Verifies: CLI-163.
    #[test]
    fn the_gel_is_drawn_from_its_surface_down_and_its_key_has_the_colours_of_the_regions() {
        let phantom = Phantom::builtin("4.6").unwrap();
        let (bank, place) = placed(phantom, 1e-3, [2.6e-3, 4.6e-3]);
        let panel = gel(&bank, &place);
        assert!(panel.y[0] > 4.6 && panel.y[1] == 0.0, "{:?}", panel.y);
        let colour = |name: &str| {
            let mut lines = panel.key.iter();
            lines.find(|line| line.name == name).unwrap().colour
        };
        let colours = [colour("95 %"), colour("its top: 50 %")];
        assert_eq!(colours, REGIONS.map(|(_, colour)| colour));
        let width = |of: &Cells| {
            let across = of.areas.iter().flatten().map(|corner| corner.0);
            extremes(across).map(|[from, to]| to - from)
        };
        let [wide, narrow] = &panel.cells[..] else {
            panic!()
        };
        assert!(width(wide) >= width(narrow));
        assert_eq!([wide.fill, narrow.fill], colours);
    }
}

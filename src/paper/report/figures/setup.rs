//! Figure 1: the phantom and the probe, to scale.

use core::iter::once;

use askama::Template;
use plotters::style::text_anchor::HPos;
use plotters::style::{RGBColor, WHITE};

use super::{Figures, words};
use crate::report::text::{millimetres, shortened, trimmed};
use crate::report::{Run, Topic, paper, text};
use palpate::chart::style::{GREY, INK, text_width};
use palpate::chart::{CHORDS, chart, to_mm};
use palpate::chart::{Line, Mark, Panel};
use palpate::fem::Pose;
use palpate::fem::mesh::Region;
use palpate::phantom::{Inclusion, Material, Phantom, Shape, Support};
use palpate::refusal::Refusal;

/// Part of the well's width that walls and floor are drawn thick. Their real thickness is not known and plays no part.
const WALL: f64 = 0.07;
/// Most inclusions of other phantoms that are drawn in one phantom.
const MOST_OTHERS: usize = 100;
/// Most layers in a key.
const MOST_LAYERS: usize = 20;
/// Most layers or inclusions in a list.
const MOST: usize = 12;

/// The hard inclusion.
const INCLUSION: RGBColor = RGBColor(230, 159, 0);
/// The rigid probe.
pub const PROBE: RGBColor = RGBColor(208, 212, 218);
/// What holds the layers.
const WALLS: RGBColor = RGBColor(226, 221, 212);
/// The lowest layer.
const GEL: RGBColor = RGBColor(250, 243, 224);
/// The uppermost layer, if there are several.
const SKIN: RGBColor = RGBColor(86, 180, 233);
/// Layers between them.
const BETWEEN: [RGBColor; 3] = [
    RGBColor(211, 234, 212),
    RGBColor(240, 213, 221),
    RGBColor(221, 214, 238),
];

/// What a region is filled with.
pub fn tint(region: Region, phantom: &Phantom) -> RGBColor {
    match region {
        Region::Inclusion(_) => INCLUSION,
        Region::Layer(k) if k + 1 == phantom.layers.len() => GEL,
        Region::Layer(0) => SKIN,
        Region::Layer(k) => BETWEEN[(k - 1) % BETWEEN.len()],
    }
}

/// The probe's half cylinder, mm, from its left edge round its bottom to its right edge.
pub fn probe(phantom: &Phantom, pose: Pose) -> Line {
    let radius = phantom.probe.radius;
    let centre = [pose.lateral, radius - pose.depth];
    // The half circle ends at its centre's height; a probe that is deeper than its radius goes on upwards.
    let top = centre[1].max(1e-3);
    let arc = (0..=90).map(|k| {
        let angle = core::f64::consts::PI * (1.0 + f64::from(k) / 90.0);
        let (sine, cosine) = libm::sincos(angle);
        [centre[0] + radius * cosine, centre[1] + radius * sine]
    });
    let end = |sign: f64| once([centre[0] + sign * radius, top]);
    Line::area(PROBE, to_mm(end(-1.0).chain(arc).chain(end(1.0))))
}

/// Samples of the layers' tints with their names, which `words` may add to.
pub fn layer_key(phantom: &Phantom, words: impl Fn(usize) -> String) -> impl Iterator<Item = Line> {
    let layers = phantom.layers.iter().enumerate().take(MOST_LAYERS);
    layers.map(move |(k, layer)| {
        let name = shortened(&layer.name, 24) + &words(k);
        Line::area(tint(Region::Layer(k), phantom), Vec::new()).named(name)
    })
}

/// A sample of the tint of inclusions.
pub fn inclusion_key(name: impl Into<String>) -> Line {
    Line::area(INCLUSION, Vec::new()).named(name)
}

/// Figure 1 for the phantom of Figure 6, and for each other that differs in more than its inclusions from those before it.
///
/// # Errors
/// If drawing fails.
///
/// Implements: REP-030.
pub fn draw(figures: &mut Figures, run: &Run) -> Result<(), Refusal> {
    let maps = once(&run.reference).chain(&run.maps);
    let all: Vec<&Phantom> = maps.filter_map(|map| map.phantom()).collect();
    let (full, plain): (Vec<_>, Vec<_>) = all.iter().partition(|p| !p.inclusions.is_empty());
    let mut drawn: Vec<&Phantom> = Vec::new();
    for phantom in once(&run.deformed.phantom).chain(full).chain(plain) {
        if drawn.iter().any(|other| alike(other, phantom)) {
            continue;
        }
        let text = Text {
            phantom,
            others: others(phantom, &all),
            is_named: !drawn.is_empty(),
        };
        let name = if text.is_named { &*phantom.name } else { "" };
        let width = millimetres(phantom.well.width);
        let x_name = format!("Lateral position x (mm); the well is {width} mm wide");
        let picture = chart(&[panel(phantom, &text.others)], &x_name);
        figures.add(
            ("figure-1", name),
            Topic::Setup,
            words!(text, as_figure_1_caption, as_figure_1_alt),
            picture,
        )?;
        drawn.push(phantom);
    }
    Ok(())
}

/// Whether two phantoms differ in names and inclusions alone.
fn alike(a: &Phantom, b: &Phantom) -> bool {
    let [a, b] = [a, b].map(|phantom| Phantom {
        inclusions: Vec::new(),
        ..paper::unnamed(phantom)
    });
    a == b
}

/// Inclusions of phantoms that differ from this one in nothing else.
fn others<'a>(phantom: &Phantom, all: &[&'a Phantom]) -> Vec<&'a Inclusion> {
    let mut others: Vec<&Inclusion> = Vec::new();
    let like = all.iter().filter(|other| alike(other, phantom));
    for inclusion in like.flat_map(|other| &other.inclusions) {
        if !phantom.inclusions.contains(inclusion) && !others.contains(&inclusion) {
            others.push(inclusion);
        }
    }
    others.truncate(MOST_OTHERS);
    others
}

/// The phantom and the probe to scale, and in dashes the inclusions of others.
fn panel(phantom: &Phantom, others: &[&Inclusion]) -> Panel {
    let mut lines = well(phantom);
    let outline = |inclusion: &Inclusion| to_mm(inclusion.outline().chords(CHORDS));
    lines.extend(others.iter().map(|other| {
        let mut corners = outline(other);
        corners.extend(corners.first().copied());
        Line::new(INK, corners).wide(1.2).dashed(true)
    }));
    let own = phantom.inclusions.iter();
    let all = own.clone().chain(others.iter().copied());
    lines.extend(depths(phantom, all.collect()));
    lines.extend(own.map(|of| Line::area(INCLUSION, outline(of))));
    let pose = Pose {
        depth: 0.0,
        lateral: 0.0,
    };
    lines.push(probe(phantom, pose));
    let panel = Panel::to_scale(Vec::new(), lines);
    Panel {
        marks: numbers(phantom, panel.x[1] - panel.x[0]),
        key: key(phantom),
        ..panel
    }
}

/// What is fixed is held by a block, what slides stands on rollers, and what is free has nothing at it; then the layers.
fn well(phantom: &Phantom) -> Vec<Line> {
    let well = &phantom.well;
    let (half, floor) = (0.5 * well.width, -phantom.height());
    let block = |half: f64, top: f64, bottom: f64| {
        to_mm([[-half, top], [half, top], [half, bottom], [-half, bottom]])
    };
    let margin = |support| match support {
        Support::Free => 0.0,
        Support::Fixed | Support::Sliding => WALL * well.width,
    };
    let (side, below) = (margin(well.walls), margin(well.floor));
    let mut lines = Vec::new();
    if side + below > 0.0 {
        lines.push(Line::area(WALLS, block(half + side, 0.0, floor - below)));
    }
    // Places of rollers between two ends.
    let places = |from: f64, to: f64| {
        let count = ((to - from) / (0.04 * well.width)).round().clamp(1.0, 40.0);
        (0..count as u32).map(move |k| from + (to - from) * (f64::from(k) + 0.5) / count)
    };
    let mut rollers = Vec::new();
    let off = 0.012 * well.width;
    if well.walls == Support::Sliding {
        rollers.extend(places(floor, 0.0).flat_map(|y| [[-half - off, y], [half + off, y]]));
    }
    if well.floor == Support::Sliding {
        rollers.extend(places(-half, half).map(|x| [x, floor - off]));
    }
    lines.push(Line::new(INK, to_mm(rollers)).wide(0.0).dotted(4));
    let levels = phantom.levels();
    let layers = levels.windows(2).enumerate().rev();
    lines.extend(layers.map(|(k, pair)| {
        let tint = tint(Region::Layer(k), phantom);
        Line::area(tint, block(half, pair[0], pair[1]))
    }));
    lines
}

/// A line from each top to the right edge, named by its depth; each depth once.
fn depths<'a>(phantom: &'a Phantom, mut all: Vec<&'a Inclusion>) -> Vec<Line> {
    let label = |inclusion: &Inclusion| format!("{} mm", millimetres(inclusion.depth));
    all.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    all.dedup_by(|a, b| label(a) == label(b));
    let edge = (0.5 + WALL) * phantom.well.width;
    let line = |inclusion: &Inclusion| {
        let corners = inclusion.outline().chords(CHORDS);
        let top = corners.into_iter().max_by(|a, b| a[1].total_cmp(&b[1]));
        let [x, y] = top.unwrap_or_default();
        let line = Line::new(GREY, to_mm([[x, y], [edge, y]]));
        line.wide(1.2).dashed(true).named(label(inclusion))
    };
    all.into_iter().map(line).collect()
}

/// A number in each of several inclusions that has room for it, in a drawing of some width, mm.
fn numbers(phantom: &Phantom, width: f64) -> Vec<Mark> {
    let all = &phantom.inclusions;
    // The least width of a plot.
    let pixels = 280.0 / width;
    let number = |(k, inclusion): (usize, &Inclusion)| {
        let [left, right, bottom, top] = inclusion.extent().map(|end| 1e3 * end);
        let words = (k + 1).to_string();
        let has_room = pixels * (right - left) > f64::from(text_width(&words)) + 2.0
            && pixels * (top - bottom) > 16.0;
        let at = (0.5 * (left + right), 0.5 * (bottom + top));
        has_room.then(|| Mark::new(at, words, HPos::Center, (0, 0)))
    };
    let several = all.iter().enumerate().filter(|_| all.len() > 1);
    several.filter_map(number).collect()
}

/// Names, sizes and moduli of all parts.
fn key(phantom: &Phantom) -> Vec<Line> {
    let modulus = |of: &Material| format!("E = {} kPa", trimmed(of.youngs_modulus / 1e3, 3));
    let probe = format!(
        "probe: ø {} mm, {} mm long, rigid",
        millimetres(2.0 * phantom.probe.radius),
        millimetres(phantom.probe.length)
    );
    let layer = |k: usize| {
        let layer = &phantom.layers[k];
        let thickness = millimetres(layer.thickness);
        format!(": {thickness} mm, {}", modulus(&layer.material))
    };
    let inclusions = phantom.inclusions.iter().enumerate();
    let inclusions = inclusions.map(|(k, of)| {
        let place = middle(of).map_or(String::new(), |x| format!(", {x}"));
        let name = name(phantom, k);
        format!("{name}: {}{place}, {}", size(of), modulus(&of.material))
    });
    let held = match phantom.well.walls == Support::Free && phantom.well.floor == Support::Free {
        true => WHITE,
        false => WALLS,
    };
    let mut key = vec![Line::area(PROBE, Vec::new()).named(probe)];
    key.extend(layer_key(phantom, layer));
    key.extend(first(inclusions.collect()).into_iter().map(inclusion_key));
    key.push(Line::area(held, Vec::new()).named(supports(phantom)));
    key
}

fn is_paper(phantom: &Phantom) -> bool {
    paper::name_of(phantom).is_some()
}

/// How walls and floor hold the layers.
fn supports(phantom: &Phantom) -> String {
    let name = |support| match support {
        Support::Fixed => "fixed",
        Support::Sliding => "sliding",
        Support::Free => "free",
    };
    match (phantom.well.walls, phantom.well.floor) {
        _ if is_paper(phantom) => "wax block: gel and skin fixed, u = 0".into(),
        (walls, floor) if walls == floor => format!("walls and floor {}", name(walls)),
        (walls, floor) => format!("walls {}, floor {}", name(walls), name(floor)),
    }
}

fn size(inclusion: &Inclusion) -> String {
    let [left, right, bottom, top] = inclusion.extent();
    let by = |a, b| format!("{} × {} mm", millimetres(a), millimetres(b));
    match &inclusion.shape {
        Shape::Disc { diameter } => format!("ø {} mm", millimetres(*diameter)),
        Shape::Ellipse { width, height, .. } => by(*width, *height),
        Shape::Polygon { .. } => by(right - left, top - bottom),
    }
}

/// Where the middle of an inclusion is, unless on the axis.
fn middle(inclusion: &Inclusion) -> Option<String> {
    let [left, right, ..] = inclusion.extent();
    let x = millimetres(0.5 * (left + right));
    (x != "0").then(|| format!("x = {x} mm"))
}

/// What inclusion `k` is called.
fn name(phantom: &Phantom, k: usize) -> String {
    match phantom.inclusions.len() {
        1 => "inclusion".into(),
        _ => format!("inclusion {}", k + 1),
    }
}

/// The first of many items, and how many more there are.
fn first(mut items: Vec<String>) -> Vec<String> {
    let count = items.len();
    items.truncate(MOST);
    if count > MOST {
        items.push(format!("and {} more", count - MOST));
    }
    items
}

#[derive(Template)]
#[template(path = "report/words.txt", block = "figure_1_title", blocks = ["figure_1_caption", "figure_1_alt"])]
struct Text<'a> {
    phantom: &'a Phantom,
    others: Vec<&'a Inclusion>,
    is_named: bool,
}

impl Text<'_> {
    /// Names and thicknesses of the layers.
    fn layers(&self) -> String {
        let layers = self.phantom.layers.iter();
        let layers = layers.map(|of| named(&of.name, &format!("{} mm", millimetres(of.thickness))));
        first(layers.collect()).join(", ")
    }

    /// Names and Poisson's ratios of layers and inclusions.
    fn ratios(&self) -> String {
        let ratio = |name: &str, of: &Material| named(name, &trimmed(of.poisson_ratio, 6));
        let layers = self.phantom.layers.iter();
        let layers = layers.map(|of| ratio(&of.name, &of.material));
        let inclusions = self.phantom.inclusions.iter().enumerate();
        let inclusions = inclusions.map(|(k, of)| ratio(&name(self.phantom, k), &of.material));
        first(layers.chain(inclusions).collect()).join(", ")
    }
}

/// A name and a value, told apart.
fn named(name: &str, value: &str) -> String {
    let colon = if name.ends_with(char::is_numeric) {
        ":"
    } else {
        ""
    };
    format!("{name}{colon} {value}")
}

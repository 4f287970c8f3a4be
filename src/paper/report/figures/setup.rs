//! Figure 1: the phantom and the probe, to scale.

use core::iter::once;

use plotters::style::{RGBColor, WHITE};

use super::plan::{Plan, Words, over};
use crate::report::text::{joined, millimetres, shortened, trimmed};
use crate::report::{Run, Topic, paper, theories};
use palpate::chart::{CHORDS, Line, Panel, to_mm};
use palpate::fem::Pose;
use palpate::fem::mesh::Region;
use palpate::force_map::ForceMap;
use palpate::phantom::{Inclusion, Material, Phantom, PhantomParts, Shape, Support};

/// Part of the well's width that walls and floor are drawn thick. Their real thickness is not known and plays no part.
const WALL: f64 = 0.07;
/// Most layers in a key.
const MOST_LAYERS: usize = 20;
/// Most layers or inclusions in a list.
const MOST: usize = 12;

/// The hard inclusion.
pub const INCLUSION: RGBColor = RGBColor(230, 159, 0);
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
        Region::Layer(k) if k + 1 == phantom.layers().len() => GEL,
        Region::Layer(0) => SKIN,
        Region::Layer(k) => BETWEEN[(k - 1) % BETWEEN.len()],
    }
}

/// The probe's half cylinder, mm, from its left edge round its bottom to its right edge.
pub fn probe(phantom: &Phantom, pose: Pose) -> Line {
    let radius = phantom.probe().radius;
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
    let layers = phantom.layers().iter().enumerate().take(MOST_LAYERS);
    layers.map(move |(k, layer)| {
        let name = shortened(&layer.name, 24) + &words(k);
        Line::area(tint(Region::Layer(k), phantom), Vec::new()).named(name)
    })
}

/// Figure 1 for the phantom of Figure 6, and for each other that differs in more than its inclusions from those before it.
///
/// Implements: REP-030.
pub fn figures(run: &Run) -> Vec<Plan> {
    let all = run.reference_and_maps().filter_map(ForceMap::phantom);
    let (full, plain): (Vec<_>, Vec<_>) = all.partition(|of| !of.inclusions().is_empty());
    let mut drawn: Vec<&Phantom> = Vec::new();
    for phantom in once(&run.deformed.phantom).chain(full).chain(plain) {
        if !drawn.iter().any(|other| empty(other) == empty(phantom)) {
            drawn.push(phantom);
        }
    }
    let figure = |(k, phantom): (usize, &Phantom)| {
        let name = if k == 0 { "" } else { phantom.name() };
        let width = millimetres(phantom.well().width);
        let x_name = format!("Lateral position x (mm); the well is {width} mm wide");
        let panel = panel(phantom);
        let words = words(phantom, name, &panel.key);
        let picture = over(&x_name, [panel]);
        Plan {
            name: name.into(),
            ..Plan::new("figure-1", Topic::Setup, words, picture)
        }
    };
    drawn.into_iter().enumerate().map(figure).collect()
}

/// A phantom without names and inclusions.
fn empty(phantom: &Phantom) -> PhantomParts {
    paper::unnamed(&phantom.without_inclusions())
}

/// The phantom and the probe to scale.
fn panel(phantom: &Phantom) -> Panel {
    let mut areas = well(phantom);
    let inclusions = phantom.inclusions().iter();
    let corners = inclusions.map(|of| to_mm(of.outline().chords(CHORDS)));
    areas.extend(corners.map(|corners| Line::area(INCLUSION, corners)));
    let (depth, lateral) = (0.0, 0.0);
    areas.push(probe(phantom, Pose { depth, lateral }));
    Panel {
        key: key(phantom),
        ..Panel::to_scale(Vec::new(), areas)
    }
}

/// Walls and floor as a block, unless nothing holds the layers there; then the layers.
fn well(phantom: &Phantom) -> Vec<Line> {
    let well = &phantom.well();
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
    let levels = phantom.levels();
    let layers = levels.windows(2).enumerate().rev();
    lines.extend(layers.map(|(k, pair)| {
        let tint = tint(Region::Layer(k), phantom);
        Line::area(tint, block(half, pair[0], pair[1]))
    }));
    lines
}

/// Names and sizes of all parts.
fn key(phantom: &Phantom) -> Vec<Line> {
    let sample = |colour, name: String| Line::area(colour, Vec::new()).named(name);
    let probe = format!(
        "probe: ø {} mm, {} mm long, rigid",
        millimetres(2.0 * phantom.probe().radius),
        millimetres(phantom.probe().length)
    );
    let thickness = |k: usize| format!(": {} mm", millimetres(phantom.layers()[k].thickness));
    let is_free = [phantom.well().walls, phantom.well().floor] == [Support::Free; 2];
    let supports = if is_free { WHITE } else { WALLS };
    let inclusions = phantom.inclusions().iter();
    let inclusions = first(inclusions.map(|of| format!("inclusion: {}", place(of))));
    let mut key = vec![sample(PROBE, probe)];
    key.extend(layer_key(phantom, thickness));
    key.extend(inclusions.into_iter().map(|name| sample(INCLUSION, name)));
    key.push(sample(supports, supported(phantom)));
    key
}

/// How walls and floor hold the layers.
fn supported(phantom: &Phantom) -> String {
    let name = |support| match support {
        Support::Fixed => "fixed",
        Support::Sliding => "sliding",
        Support::Free => "free",
    };
    match (phantom.well().walls, phantom.well().floor) {
        _ if theories::name_of(phantom).is_some() => "wax block: gel and skin fixed, u = 0".into(),
        (walls, floor) if walls == floor => format!("walls and floor {}", name(walls)),
        (walls, floor) => format!("walls {}, floor {}", name(walls), name(floor)),
    }
}

/// Size and place of an inclusion: "ø 6.4 mm, 2.6 mm deep".
fn place(inclusion: &Inclusion) -> String {
    let [left, right, bottom, top] = inclusion.extent();
    let by = |a, b| format!("{} × {} mm", millimetres(a), millimetres(b));
    let size = match &inclusion.shape {
        Shape::Disc { diameter } => format!("ø {} mm", millimetres(diameter)),
        Shape::Ellipse {
            width,
            height,
            angle_deg,
        } if *angle_deg != 0.0 => format!("{}, {}°", by(*width, *height), trimmed(angle_deg, 3)),
        Shape::Ellipse { .. } | Shape::Polygon { .. } => by(right - left, top - bottom),
    };
    let aside = match millimetres(0.5 * (left + right)) {
        x if x == "0" => String::new(),
        x => format!(", x = {x} mm"),
    };
    format!("{size}{aside}, {} mm deep", millimetres(inclusion.depth))
}

/// The first of many items, and how many more there are.
fn first(items: impl ExactSizeIterator<Item = String>) -> Vec<String> {
    let more = items.len().saturating_sub(MOST);
    let more = (more > 0).then(|| format!("and {more} more"));
    items.take(MOST).chain(more).collect()
}

fn words(phantom: &Phantom, name: &str, key: &[Line]) -> Words {
    let material = |name: &str, of: &Material| {
        let [modulus, ratio] = [of.youngs_modulus / 1e3, of.poisson_ratio];
        let [modulus, ratio] = [trimmed(modulus, 3), trimmed(ratio, 6)];
        let mut words = format!("{name}: E = {modulus} kPa, ν = {ratio}");
        if of.fibre_modulus != 0.0 {
            let [more, angle] = [of.fibre_modulus / 1e3, of.fibre_angle_deg].map(|x| trimmed(x, 3));
            words += &format!(", along fibres at {angle}° {more} kPa more");
        }
        if of.yeoh_c20 != 0.0 {
            let second = trimmed(of.yeoh_c20 / 1e3, 3);
            words += &format!(", Yeoh's second coefficient {second} kPa");
        }
        words
    };
    let layers = phantom.layers().iter();
    let layers = first(layers.map(|of| material(&of.name, &of.material)));
    let inclusions = phantom.inclusions().iter();
    let inclusions = first(inclusions.map(|of| material("inclusion", &of.material)));
    let materials = joined(layers.into_iter().chain(inclusions), "; ");
    let of_paper = match theories::name_of(phantom) {
        Some(_) => {
            " it gives the same sizes in words, but not how thick the wax is, which plays no part. The paper's inclusion is a latex \
             tube; it is computed as a solid disc, as the paper's own Figure 6 shows it."
        }
        None => " this phantom is none of them.",
    };
    let title = match name {
        "" => "Figure 1. The phantom and the probe".into(),
        name => format!("Figure 1. The phantom “{name}” and the probe"),
    };
    [
        title,
        format!(
            "Cross-section to scale, drawn from the data that the forces are computed from. The depth of an inclusion is that of its \
             top below the outer surface. The probe stands at x = 0 and depth d = 0, which grows downwards. Where walls or floor are \
             fixed, the layers do not move; where they slide, the layers move along them without friction; where they are free, \
             nothing holds the layers. Materials: {materials}. The paper's Figure 1 is a picture of its gels;{of_paper}"
        ),
        format!(
            "Cross-section of a well {} mm wide. {}.",
            millimetres(phantom.well().width),
            joined(key.iter().map(|part| part.name.clone()), "; ")
        ),
    ]
}

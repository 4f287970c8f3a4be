//! Figure 1: the phantom and the probe, to scale.

use core::f64::consts::PI;

use plotters::style::text_anchor::HPos;

use super::chart::{Area, DrawingResult, draw};
use super::diagram::{
    GEL, INCLUSION, LINE, PROBE, Place, SKIN, WAX, arrow, dashes, dimension, path, say_at, shape,
};
use super::style::{GREY, INK, WIDTH};
use super::{Draft, Words};
use crate::phantom::{Inclusion, Phantom};
use crate::report::text::{millimetres, trimmed};
use crate::report::{Study, Topic};

/// Pixels left of the block of wax, for the gel's height.
const LEFT: f64 = 74.0;
/// Pixels right of the block, for the depths of the inclusions.
const RIGHT: f64 = 84.0;
/// Pixels of wax that are drawn around the gel. Its real thickness is not known and plays no part.
const WALL: f64 = 26.0;
/// Pixels above the probe, for its name.
const TOP: f64 = 34.0;
/// Most inclusions that are drawn in one phantom.
const MOST: usize = 6;

/// The phantoms of `study` that differ from the drawn one in their inclusion alone, with their inclusions by depth.
fn inclusions<'a>(study: &'a Study, drawn: &Phantom) -> Vec<&'a Inclusion> {
    let maps = [&study.reference].into_iter().chain(&study.maps);
    let like = |phantom: &&Phantom| {
        phantom.gel == drawn.gel && phantom.skin == drawn.skin && phantom.probe == drawn.probe
    };
    let phantoms = maps.filter_map(|map| map.phantom()).filter(like);
    let mut all: Vec<_> = phantoms.filter_map(|p| p.inclusion.as_ref()).collect();
    all.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    all.dedup();
    all.truncate(MOST);
    all
}

/// Where things are, pixels.
struct Scale {
    /// Pixels a metre.
    scale: f64,
    /// x = 0.
    middle: f64,
    /// The undeformed surface.
    surface: f64,
}

impl Scale {
    fn of(phantom: &Phantom) -> Scale {
        let wide = f64::from(WIDTH) - LEFT - RIGHT - 2.0 * WALL;
        let high = phantom.total_height() + phantom.probe.radius;
        // The second bound keeps a tall phantom on the page.
        let scale = (wide / phantom.gel.width).min(420.0 / high);
        Scale {
            scale,
            middle: LEFT + WALL + 0.5 * wide,
            surface: TOP + scale * phantom.probe.radius,
        }
    }

    /// The place of the point (x, y), m, y upwards from the surface.
    fn at(&self, x: f64, y: f64) -> Place {
        [self.middle + self.scale * x, self.surface - self.scale * y]
    }

    /// A rectangle between two corners, m, with `margin` pixels around it on all sides but the top.
    fn block(&self, x: f64, top: f64, bottom: f64, margin: f64) -> [Place; 4] {
        let [left, high] = self.at(-x, top);
        let [right, low] = self.at(x, bottom);
        let (left, right, low) = (left - margin, right + margin, low + margin);
        [[left, high], [right, high], [right, low], [left, low]]
    }

    /// Part of a circle, m, from one angle to another.
    fn arc(&self, centre: f64, radius: f64, [from, to]: [f64; 2]) -> Vec<Place> {
        let point = |k: i32| {
            let angle = from + (to - from) * f64::from(k) / 60.0;
            let (sine, cosine) = libm::sincos(angle);
            self.at(radius * cosine, centre + radius * sine)
        };
        (0..=60).map(point).collect()
    }
}

/// Figure 1 for the phantom of Figure 6.
pub fn draft(study: &Study) -> Draft {
    let phantom = &study.deformed.phantom;
    let inclusions = inclusions(study, phantom);
    let scale = Scale::of(phantom);
    let floor = scale.at(0.0, -phantom.total_height())[1];
    let height = (floor + WALL + 84.0).ceil() as i32;
    let svg = draw(height, |area| {
        draw_block(area, &scale, phantom)?;
        draw_inclusions(area, &scale, phantom, &inclusions)?;
        draw_probe(area, &scale, phantom)?;
        draw_sizes(area, &scale, phantom)
    });
    Draft {
        prefix: "figure-1",
        name: String::new(),
        topic: Topic::Setup,
        words: words(phantom, &inclusions),
        drawn: svg.map(|svg| (svg, [WIDTH, height])),
    }
}

fn draw_block(area: &Area<'_>, scale: &Scale, phantom: &Phantom) -> DrawingResult<()> {
    let half = 0.5 * phantom.gel.width;
    let (skin, floor) = (-phantom.skin.thickness, -phantom.total_height());
    shape(area, &scale.block(half, 0.0, floor, WALL), WAX)?;
    shape(area, &scale.block(half, 0.0, floor, 0.0), GEL)?;
    shape(area, &scale.block(half, 0.0, skin, 0.0), SKIN)?;
    let [middle, low] = scale.at(0.0, floor);
    say_at(
        area,
        "wax block: gel and skin fixed, u = 0",
        [middle, low + 0.5 * WALL],
        HPos::Center,
    )
}

fn draw_inclusions(
    area: &Area<'_>,
    scale: &Scale,
    phantom: &Phantom,
    inclusions: &[&Inclusion],
) -> DrawingResult<()> {
    let circle = |inclusion: &Inclusion| {
        scale.arc(inclusion.centre_y(), inclusion.radius(), [0.0, 2.0 * PI])
    };
    let edge = scale.at(0.5 * phantom.gel.width, 0.0)[0] + WALL;
    let mut lowest = f64::NEG_INFINITY;
    for inclusion in inclusions {
        // Every second piece of the outline: dashes.
        for piece in circle(inclusion).chunks(2) {
            path(area, piece, INK, 1.2)?;
        }
        let top = scale.at(0.0, -inclusion.depth);
        dashes(area, [top, [edge + 6.0, top[1]]], GREY)?;
        let height = top[1].max(lowest + LINE - 2.0);
        lowest = height;
        let label = format!("{} mm", millimetres(inclusion.depth));
        path(
            area,
            &[[edge + 6.0, top[1]], [edge + 16.0, height]],
            GREY,
            1.2,
        )?;
        say_at(area, &label, [edge + 20.0, height], HPos::Left)?;
    }
    if let Some(shown) = &phantom.inclusion {
        shape(area, &circle(shown), INCLUSION)?;
        let side = scale.at(-shown.radius(), shown.centre_y());
        let label = format!("ø {} mm", millimetres(shown.diameter));
        let end = [side[0] - 34.0, side[1]];
        for (k, words) in ["inclusion", &label].iter().enumerate() {
            let at = [end[0] - 4.0, end[1] + LINE * (k as f64 - 0.5)];
            say_at(area, words, at, HPos::Right)?;
        }
        arrow(area, &[end, side])?;
    }
    Ok(())
}

fn draw_probe(area: &Area<'_>, scale: &Scale, phantom: &Phantom) -> DrawingResult<()> {
    let radius = phantom.probe.radius;
    shape(area, &scale.arc(radius, radius, [PI, 2.0 * PI]), PROBE)?;
    let [middle, top] = scale.at(0.0, radius);
    let name = format!(
        "probe: ø {} mm, {} mm long, rigid",
        millimetres(2.0 * radius),
        millimetres(phantom.probe.length)
    );
    say_at(area, &name, [middle, top - 14.0], HPos::Center)?;
    // Where the probe goes: x to the side, d into the gel.
    let centre = [middle, top + 0.36 * (scale.surface - top)];
    arrow(area, &[centre, [centre[0] + 34.0, centre[1]]])?;
    say_at(area, "x", [centre[0] + 40.0, centre[1]], HPos::Left)?;
    arrow(area, &[centre, [centre[0], centre[1] + 30.0]])?;
    say_at(area, "d", [centre[0] - 8.0, centre[1] + 18.0], HPos::Right)
}

fn draw_sizes(area: &Area<'_>, scale: &Scale, phantom: &Phantom) -> DrawingResult<()> {
    let half = 0.5 * phantom.gel.width;
    let floor = -phantom.total_height();
    let [left, skin] = scale.at(-half, -phantom.skin.thickness);
    let [right, low] = scale.at(half, floor);
    // Gel height at the left, between thin lines from its edges.
    let line = left - WALL - 14.0;
    for height in [skin, low] {
        path(area, &[[line - 5.0, height], [left, height]], GREY, 1.0)?;
    }
    dimension(area, [[line, skin], [line, low]])?;
    let gel = format!("{} mm", millimetres(phantom.gel.height));
    let middle = 0.5 * (skin + low);
    say_at(area, "gel", [line - 8.0, middle - 0.5 * LINE], HPos::Right)?;
    say_at(area, &gel, [line - 8.0, middle + 0.5 * LINE], HPos::Right)?;
    // Skin: too thin for a dimension of its own.
    let thickness = format!("skin {} mm", millimetres(phantom.skin.thickness));
    let above = [left - WALL + 2.0, scale.surface - 30.0];
    say_at(area, &thickness, [8.0, above[1]], HPos::Left)?;
    let inside = 0.5 * (scale.surface + skin);
    arrow(
        area,
        &[[above[0] - 6.0, above[1] + 10.0], [left + 12.0, inside]],
    )?;
    // Width below.
    let below = low + WALL + 18.0;
    for x in [left, right] {
        path(area, &[[x, low], [x, below + 5.0]], GREY, 1.0)?;
    }
    dimension(area, [[left, below], [right, below]])?;
    let width = format!("{} mm", millimetres(phantom.gel.width));
    let [middle, last] = [0.5 * (left + right), below + 16.0];
    say_at(area, &width, [middle, last], HPos::Center)?;
    say_at(
        area,
        &materials(phantom),
        [0.5 * f64::from(WIDTH), last + 26.0],
        HPos::Center,
    )
}

/// The moduli in one line.
fn materials(phantom: &Phantom) -> String {
    let kilopascals = |modulus: f64| format!("{} kPa", trimmed(modulus / 1e3, 3));
    let inclusion = phantom.inclusion.map_or(String::new(), |inclusion| {
        format!(
            ", inclusion {}",
            kilopascals(inclusion.material.youngs_modulus)
        )
    });
    format!(
        "E: gel {}, skin {}{inclusion}",
        kilopascals(phantom.gel.material.youngs_modulus),
        kilopascals(phantom.skin.material.youngs_modulus)
    )
}

fn words(phantom: &Phantom, inclusions: &[&Inclusion]) -> Words {
    let depths: Vec<_> = inclusions
        .iter()
        .map(|inclusion| millimetres(inclusion.depth))
        .collect();
    let tops = match depths.as_slice() {
        [] => "No phantom of this study holds an inclusion of this gel.".into(),
        depths => format!(
            "Inclusions of the study are outlined; the depth of each, from the outer surface to its top, is at the \
             right: {} mm. Each lies in a phantom of its own; one is filled.",
            depths.join(", ")
        ),
    };
    let inside = match phantom.inclusion {
        Some(inclusion) => format!(
            " In the gel a disc of {} mm diameter, its top {} mm below the surface.",
            millimetres(inclusion.diameter),
            millimetres(inclusion.depth)
        ),
        None => String::new(),
    };
    Words {
        title: "Figure 1. The phantom and the probe".into(),
        caption: format!(
            "Cross-section to scale, drawn from the data that the forces are computed from. {tops} The probe stands at \
             x = 0 and depth d = 0. The paper's Figure 1 is a picture of its gels; it gives the same sizes in words, \
             but not how thick the wax is, which plays no part: the gel is held where it meets the wax. Poisson's ratio \
             is {} in the gel. The paper's inclusion is a latex tube; it is computed as a solid disc, as the paper's own \
             Figure 6 shows it.",
            trimmed(phantom.gel.material.poisson_ratio, 6)
        ),
        alt: format!(
            "A well of gel {} mm wide and {} mm high in a block of wax, under a skin of {} mm. A half disc of {} mm \
             diameter, the probe, touches the skin from above.{inside}",
            millimetres(phantom.gel.width),
            millimetres(phantom.gel.height),
            millimetres(phantom.skin.thickness),
            millimetres(2.0 * phantom.probe.radius)
        ),
    }
}

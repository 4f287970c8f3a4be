//! The words in and around Figure 1.

use super::Words;
use super::style::{WIDTH, text_width};
use crate::phantom::{Inclusion, Material, Phantom, Shape, Support};
use crate::report::paper;
use crate::report::text::{millimetres, shortened, trimmed};

/// Most lines of materials under the drawing.
const MOST_LINES: usize = 12;
/// Most layers or inclusions in a list of a caption.
const MOST: usize = 12;

fn is_paper(phantom: &Phantom) -> bool {
    paper::name_of(phantom).is_some()
}

/// How walls and floor hold the layers.
pub fn supports(phantom: &Phantom) -> String {
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

/// The lines beside the only inclusion.
pub fn beside(inclusion: &Inclusion) -> Vec<String> {
    let lines = ["inclusion".into(), size(inclusion)];
    lines.into_iter().chain(middle(inclusion)).collect()
}

/// A name and a value, told apart.
fn named(name: &str, value: &str) -> String {
    match name.ends_with(|c: char| c.is_numeric()) {
        true => format!("{name}: {value}"),
        false => format!("{name} {value}"),
    }
}

/// What inclusion `k` is called.
fn name(phantom: &Phantom, k: usize) -> String {
    match phantom.inclusions.len() {
        1 => "inclusion".into(),
        _ => format!("inclusion {}", k + 1),
    }
}

/// Moduli, and the sizes of inclusions unless `is_labelled`, in lines that fit the figure.
pub fn materials(phantom: &Phantom, is_labelled: bool) -> Vec<String> {
    let kilopascals =
        |material: &Material| format!("{} kPa", trimmed(material.youngs_modulus / 1e3, 3));
    let layers = phantom.layers.iter().rev().map(|layer| {
        let name = shortened(&layer.name, 24);
        named(&name, &kilopascals(&layer.material))
    });
    let inclusions = phantom.inclusions.iter().enumerate().map(|(k, of)| {
        let sizes = beside(of).split_off(1).join(", ");
        let name = match is_labelled {
            true => name(phantom, k),
            false => format!("{} ({sizes})", name(phantom, k)),
        };
        named(&name, &kilopascals(&of.material))
    });
    let mut items: Vec<String> = layers.chain(inclusions).map(|item| item + ",").collect();
    items.last_mut().and_then(String::pop);
    let mut lines = vec![String::from("E:")];
    for item in items {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line} {item}")) <= WIDTH - 16 => {
                *line += &format!(" {item}");
            }
            _ => lines.push(item),
        }
    }
    if lines.len() > MOST_LINES {
        lines.truncate(MOST_LINES - 1);
        lines.push("…".into());
    }
    lines
}

/// Shape and place of an inclusion.
fn describe(inclusion: &Inclusion) -> String {
    let shape = match &inclusion.shape {
        Shape::Disc { diameter } => format!("a disc of {} mm diameter", millimetres(*diameter)),
        Shape::Ellipse { angle_deg, .. } => {
            let angle = trimmed(*angle_deg, 3);
            format!("an ellipse of {}, turned by {angle}°", size(inclusion))
        }
        Shape::Polygon { points } => {
            format!("a polygon of {} corners, {}", points.len(), size(inclusion))
        }
    };
    let depth = millimetres(inclusion.depth);
    let place = middle(inclusion).map_or(String::new(), |x| format!(", its middle at {x}"));
    format!("{shape}{place}, its top {depth} mm below the surface")
}

/// The first of many items, and how many more there are.
fn listed(mut items: Vec<String>, separator: &str) -> String {
    let count = items.len();
    items.truncate(MOST);
    if count > MOST {
        items.push(format!("and {} more", count - MOST));
    }
    items.join(separator)
}

/// Title, caption and alternative of the drawing of a phantom with the inclusions of `others`.
pub fn words(phantom: &Phantom, others: &[&Inclusion], is_named: bool) -> Words {
    let several = phantom.inclusions.len() > 1;
    let inside = phantom.inclusions.iter().enumerate().map(|(k, inclusion)| {
        let number = if several {
            format!("{}: ", k + 1)
        } else {
            String::new()
        };
        number + &describe(inclusion)
    });
    let inside = listed(inside.collect(), "; ");
    let filled = match phantom.inclusions.len() {
        0 => "The phantom holds no inclusion.".into(),
        1 => format!("Its inclusion is filled: {inside}."),
        _ => format!("Its inclusions are filled and numbered: {inside}."),
    };
    let dashed = match others.len() {
        0 => "",
        _ => {
            " In dashes are the inclusions of the study's other phantoms that differ from this one in nothing else."
        }
    };
    let held = match [phantom.well.walls, phantom.well.floor] {
        [Support::Fixed, Support::Fixed] => {
            "The layers do not move where they meet walls and floor."
        }
        _ => {
            "Where walls or floor are fixed, shown as a block, the layers do not move; where they slide, shown on rollers, \
             the layers move along them without friction; where they are free, nothing holds the layers."
        }
    };
    let ratio = |material: &Material| trimmed(material.poisson_ratio, 6);
    let layers = phantom
        .layers
        .iter()
        .map(|layer| named(&layer.name, &ratio(&layer.material)));
    let inclusions = phantom.inclusions.iter().enumerate();
    let inclusions = inclusions.map(|(k, of)| named(&name(phantom, k), &ratio(&of.material)));
    let ratios = listed(layers.chain(inclusions).collect(), ", ");
    let paper = if is_paper(phantom) {
        " The paper's Figure 1 is a picture of its gels; it gives the same sizes in words, but not how thick the wax is, which \
         plays no part. The paper's inclusion is a latex tube; it is computed as a solid disc, as the paper's own Figure 6 \
         shows it."
    } else {
        " The paper's Figure 1 is a picture of its gels; this phantom is none of them."
    };
    let layers = phantom
        .layers
        .iter()
        .map(|layer| named(&layer.name, &format!("{} mm", millimetres(layer.thickness))));
    let title = match is_named {
        false => "Figure 1. The phantom and the probe".into(),
        true => format!("Figure 1. The phantom “{}” and the probe", phantom.name),
    };
    Words {
        title,
        caption: format!(
            "Cross-section to scale, drawn from the data that the forces are computed from. {filled}{dashed} At the right are \
             the depths of their tops below the outer surface. The probe stands at x = 0 and depth d = 0. {held} Poisson's \
             ratio: {ratios}.{paper}"
        ),
        alt: format!(
            "A well {} mm wide with layers, from the top: {}. A half disc of {} mm diameter, the probe, touches them from \
             above. {filled}",
            millimetres(phantom.well.width),
            listed(layers.collect(), ", "),
            millimetres(2.0 * phantom.probe.radius)
        ),
    }
}

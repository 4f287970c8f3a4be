//! Figure 6: the deformed mesh under the probe.

use std::collections::BTreeMap;

use plotters::style::RGBColor;

use super::plan::{Picture, Plan, Words, over};
use super::setup::{INCLUSION, PROBE, layer_key, probe, tint};
use crate::report::text::{fixed, millimetres};
use crate::report::{DeformedMesh, Topic, paper};
use palpate::chart::{Cells, Line, Panel, to_mm};
use palpate::fem::finite::LEAST_DET;
use palpate::phantom::Strain;

/// The sides of elements.
const EDGE: RGBColor = RGBColor(0x5B, 0x64, 0x70);

/// Figure 6.
pub fn figure_6(mesh: &DeformedMesh) -> Plan {
    let pose = "paper's Figure 6, whose pose is not stated";
    let words = words(mesh, "Figure 6. Deformed mesh", pose);
    Plan::new("figure-6", Topic::Setup, words, picture(mesh))
}

/// The same mesh at finite strain.
///
/// Implements: REP-092.
pub fn figure_at_finite_strain(mesh: &DeformedMesh) -> Plan {
    let words = words(mesh, "Deformed mesh at finite strain", "as in Figure 6");
    Plan::new("deformed-finite", Topic::Theories, words, picture(mesh))
}

/// The mesh to scale, with straight sides between the corners of its elements.
fn picture(mesh: &DeformedMesh) -> Picture {
    let phantom = &mesh.phantom;
    let mut regions: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for (region, corners) in &mesh.elements {
        let corners = to_mm(corners.iter().copied());
        regions.entry(*region).or_default().push(corners);
    }
    // The uppermost layer last, so that a thin one is not covered by the lines of its neighbour.
    let cells = regions.into_iter().rev().map(|(region, areas)| Cells {
        fill: tint(region, phantom),
        edge: EDGE,
        areas,
    });
    let mut panel = Panel::to_scale(cells.collect(), vec![probe(phantom, mesh.pose)]);
    let sample = |colour, name: &str| Line::area(colour, Vec::new()).named(name);
    panel.key = vec![sample(PROBE, "probe")];
    panel.key.extend(layer_key(phantom, |_| String::new()));
    panel.key.extend(match phantom.inclusions().len() {
        0 => None,
        1 => Some(sample(INCLUSION, "inclusion")),
        _ => Some(sample(INCLUSION, "inclusions")),
    });
    over("Lateral position x (mm)", [panel])
}

fn words(mesh: &DeformedMesh, title: &str, what: &str) -> Words {
    let DeformedMesh { phantom, pose, .. } = mesh;
    let rigid = match paper::name_of(phantom) {
        None | Some("none") => "",
        Some(_) => {
            " The inclusion keeps its shape, since it is far stiffer than the gel, as the paper says of its Figure 6."
        }
    };
    let limit = match phantom.strain() {
        Strain::Small => "below 0.2 small strain is at its limit".into(),
        Strain::Finite => format!("a gel with less than {LEAST_DET} is refused"),
    };
    let counted = |count: usize, name: &str| match count {
        1 => format!("one {name}"),
        _ => format!("{count} {name}s"),
    };
    let inclusions = match phantom.inclusions().len() {
        0 => String::new(),
        count => format!(" with {}", counted(count, "inclusion")),
    };
    [
        format!(
            "{title}, phantom “{}”, probe at depth {} mm, x = {} mm",
            phantom.name(),
            millimetres(pose.depth),
            millimetres(pose.lateral)
        ),
        format!(
            "The mesh as the probe deforms it ({what}), to scale and not exaggerated; elements are \
             drawn with straight sides between their corners.{rigid} The smallest det(I + ∇u) is {}: 1 is undeformed, and {limit}.",
            fixed(mesh.min_det, 3)
        ),
        format!(
            "A mesh of {} elements: {}{inclusions}, dented by a round probe from above.",
            mesh.elements.len(),
            counted(phantom.layers().len(), "layer")
        ),
    ]
}

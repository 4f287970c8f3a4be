//! A CalculiX input deck of our mesh with the probe pressed into it.
//!
//! The steps are geometrically linear, as our model is, but CalculiX finds a node's gap and the direction of its
//! force on the deformed mesh in every iteration, as `deformed-normal` does. Contact is node to surface: with
//! surface to surface the forces depend on the size of the increments, the lateral ones by tens of per cent.

use std::fmt::Write;

use palpate::fem::Mesh;
use palpate::fem::mesh::Region;
use palpate::phantom::Phantom;

use super::material;

/// Stiffness of the penalty that keeps gel and probe apart, Pa/m: pressures of some 5 kPa then leave an
/// overlap of 1 µm; a stiffer one makes the iterations fail at times.
const PENALTY: f64 = 5e9;
/// Elements along the probe's arc, which spans 75° to each side of its lowest point: their edges are
/// parabolas with all nodes on the circle, off it by some R (Δθ)⁴/400 < 1 nm.
const PROBE_ELEMENTS: usize = 150;
const PROBE_HALF_ANGLE: f64 = 75.0 / 180.0 * std::f64::consts::PI;

/// The first increment of each step over the step; CalculiX chooses the others.
const INCREMENT: f64 = 0.1;

/// The deck of a probe that goes down at `lateral` (m) with a stop, and a step's end, at each of `depths` (m). Its
/// forces come out as the total reaction of its nodes.
pub fn deck(phantom: &Phantom, mesh: &Mesh, lateral: f64, depths: &[f64]) -> String {
    let mut deck = String::from("*NODE, NSET=ALL\n");
    for (node, [x, y]) in mesh.nodes.iter().enumerate() {
        writeln!(deck, "{}, {x:.12e}, {y:.12e}", node + 1).unwrap();
    }
    let layers = (0..phantom.layers().len()).map(|k| (Region::Layer(k), format!("LAYER{k}")));
    let inclusions = 0..phantom.inclusions().len();
    let inclusions = inclusions.map(|k| (Region::Inclusion(k), format!("INCLUSION{k}")));
    for (region, name) in layers.chain(inclusions) {
        writeln!(deck, "*ELEMENT, TYPE=CPE6, ELSET={name}").unwrap();
        for (element, nodes) in mesh.elements().enumerate() {
            if mesh.regions[element] == region {
                let nodes: Vec<String> = nodes.iter().map(|n| (n + 1).to_string()).collect();
                writeln!(deck, "{}, {}", element + 1, nodes.join(", ")).unwrap();
            }
        }
        let material = material(phantom, region);
        write!(
            deck,
            "*MATERIAL, NAME={name}\n*ELASTIC\n{:e}, {:e}\n\
             *SOLID SECTION, ELSET={name}, MATERIAL={name}\n{:e}\n",
            material.youngs_modulus,
            material.poisson_ratio,
            phantom.probe().length
        )
        .unwrap();
    }
    deck += "*NSET, NSET=FIXED\n";
    let held = mesh.held.iter().enumerate();
    for (node, _) in held.filter(|(_, held)| **held == [true; 2]) {
        writeln!(deck, "{},", node + 1).unwrap();
    }
    deck += "*SURFACE, NAME=OUTER\n";
    for (element, nodes) in mesh.elements().enumerate() {
        for edge in 0..3 {
            let ends = [nodes[edge], nodes[(edge + 1) % 3]];
            if ends.iter().all(|&node| mesh.nodes[node as usize][1] == 0.0) {
                writeln!(deck, "{}, S{}", element + 1, edge + 1).unwrap();
            }
        }
    }
    probe(&mut deck, phantom, mesh, lateral);
    write!(
        deck,
        "*SURFACE INTERACTION, NAME=HARD\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{PENALTY:e}\n\
         *CONTACT PAIR, INTERACTION=HARD, TYPE=NODE TO SURFACE\nOUTER, ARC\n*BOUNDARY\nFIXED, 1, 2\n"
    )
    .unwrap();
    for depth in depths {
        write!(
            deck,
            "*STEP, INC=1000\n*STATIC\n{INCREMENT}, 1., 1e-6, {INCREMENT}\n\
             *BOUNDARY\nPROBE, 1, 1, 0.\nPROBE, 2, 2, {:e}\n\
             *NODE PRINT, NSET=PROBE, TOTALS=ONLY\nRF\n*END STEP\n",
            -depth
        )
        .unwrap();
    }
    deck
}

/// The probe: one row of quadrilaterals with 8 nodes, every one of them moved by hand, so that it is rigid.
/// It starts where it just touches.
fn probe(deck: &mut String, phantom: &Phantom, mesh: &Mesh, lateral: f64) {
    let radius = phantom.probe().radius;
    let first = mesh.nodes.len() + 1;
    let columns = 2 * PROBE_ELEMENTS + 1;
    // Three circles of nodes, the outermost first.
    let node = |column: usize, circle: usize| first + circle * columns + column;
    *deck += "*NODE, NSET=PROBE\n";
    for circle in 0..3 {
        let r = radius * (1.0 - 0.05 * circle as f64);
        for column in 0..columns {
            let angle = PROBE_HALF_ANGLE * (column as f64 / PROBE_ELEMENTS as f64 - 1.0);
            if circle != 1 || column % 2 == 0 {
                writeln!(
                    deck,
                    "{}, {:.12e}, {:.12e}",
                    node(column, circle),
                    lateral + r * angle.sin(),
                    radius - r * angle.cos()
                )
                .unwrap();
            }
        }
    }
    let element = mesh.regions.len() + 1;
    *deck += "*ELEMENT, TYPE=CPE8, ELSET=PROBE\n";
    for k in 0..PROBE_ELEMENTS {
        let at = |column: usize, circle: usize| node(2 * k + column, circle);
        let corners = [at(0, 0), at(2, 0), at(2, 2), at(0, 2)];
        let middles = [at(1, 0), at(2, 1), at(1, 2), at(0, 1)];
        let nodes: Vec<String> = corners
            .iter()
            .chain(&middles)
            .map(usize::to_string)
            .collect();
        writeln!(deck, "{}, {}", element + k, nodes.join(", ")).unwrap();
    }
    // The modulus plays no part where every node is held.
    write!(
        deck,
        "*MATERIAL, NAME=STEEL\n*ELASTIC\n1e6, 0.3\n*SOLID SECTION, ELSET=PROBE, MATERIAL=STEEL\n{:e}\n\
         *SURFACE, NAME=ARC\n",
        phantom.probe().length
    )
    .unwrap();
    for k in 0..PROBE_ELEMENTS {
        writeln!(deck, "{}, S1", element + k).unwrap();
    }
}

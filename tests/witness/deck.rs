//! A CalculiX input deck of our mesh with the probe pressed into it.
//!
//! The steps are geometrically linear, as our model is, but CalculiX finds a node's gap and the direction of its
//! force on the deformed mesh in every iteration, as `deformed-normal` does. Contact is node to surface: with
//! surface to surface the forces depend on the size of the increments, the lateral ones by tens of per cent.
//! At finite strain the steps are geometrically nonlinear, and the law is FIN-001's, made of CalculiX's terms for foam.

use std::fmt::Write;

use palpate::fem::Mesh;
use palpate::fem::mesh::Region;
use palpate::phantom::{Material, Phantom, Strain};

use super::material;

/// Stiffness of the penalty that keeps gel and probe apart, Pa/m: pressures of some 5 kPa then leave an
/// overlap of 1 µm; a stiffer one makes the iterations fail at times.
const PENALTY: f64 = 5e9;
/// Elements along the probe's arc, which spans 75° to each side of its lowest point: their edges are
/// parabolas with all nodes on the circle, off it by some R (Δθ)⁴/400 < 1 nm.
const PROBE_ELEMENTS: usize = 150;
const PROBE_HALF_ANGLE: f64 = 75.0 / 180.0 * std::f64::consts::PI;

/// Iterations until CalculiX looks at how they converge, and at most: by default 4 and 16, after which it gives up over a stiff disc.
const PATIENCE: &str = "20, 40, 9, 60, 20, 4, , 20";

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
        // Of a disc that hardly deforms the terms for foam round away, and CalculiX does not converge: the law of small strains will do.
        let strain = match region {
            Region::Inclusion(_) => Strain::Small,
            Region::Layer(_) => phantom.strain(),
        };
        write!(
            deck,
            "*MATERIAL, NAME={name}\n{}*SOLID SECTION, ELSET={name}, MATERIAL={name}\n{:e}\n",
            law(strain, &material(phantom, region)),
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
    deck += &contact();
    deck += "*BOUNDARY\nFIXED, 1, 2\n";
    deck += &steps(phantom, depths);
    deck
}

/// The surfaces OUTER and ARC keep apart, without friction.
fn contact() -> String {
    format!(
        "*SURFACE INTERACTION, NAME=HARD\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{PENALTY:e}\n\
         *CONTACT PAIR, INTERACTION=HARD, TYPE=NODE TO SURFACE\nOUTER, ARC\n"
    )
}

/// A step to each depth, m.
fn steps(phantom: &Phantom, depths: &[f64]) -> String {
    let nonlinear = match phantom.strain() {
        Strain::Small => "",
        Strain::Finite => ", NLGEOM",
    };
    let step = |depth: &f64| {
        format!(
            "*STEP, INC=1000{nonlinear}\n*CONTROLS, PARAMETERS=TIME INCREMENTATION\n{PATIENCE}\n*STATIC\n{INCREMENT}, 1., 1e-6, {INCREMENT}\n\
             *BOUNDARY\nPROBE, 1, 1, 0.\nPROBE, 2, 2, {:e}\n\
             *NODE PRINT, NSET=PROBE, TOTALS=ONLY\nRF\n*END STEP\n",
            -depth
        )
    };
    depths.iter().map(step).collect()
}

/// Hooke's law at small strain, FIN-001 without its additions at finite strain.
///
/// Storåkers's foam is Σᵢ 2μᵢ/αᵢ² [λ₁^αᵢ + λ₂^αᵢ + λ₃^αᵢ − 3 + (J^(−αᵢβᵢ) − 1)/βᵢ], given by μᵢ, αᵢ and νᵢ = βᵢ/(1 + 2βᵢ). With
/// α₁ = 2 and β₁ = 0 the first term is μ₁/2 (I₁ − 3 − 2 ln J). With α₂ = −α₃ = k/β, μ₂ = μ₃ = λ/(4β) and one large β, the others
/// are λ/2 (2/k sinh(½ k ln J))² and λ/(2β) Σ (ln λⱼ)². The first of these two is λ/2 (ln J)² but for a part (k ln J)²/12, which
/// k = 0.05 keeps below 10⁻⁴ down to J = 0.5; the second is a shear modulus of 5·10⁻⁵ μ at ν = 0.49.
pub fn law(strain: Strain, material: &Material) -> String {
    let (modulus, poisson_ratio) = (material.youngs_modulus, material.poisson_ratio);
    if strain == Strain::Small {
        return format!("*ELASTIC\n{modulus:e}, {poisson_ratio:e}\n");
    }
    let shear = modulus / (2.0 * (1.0 + poisson_ratio));
    let lambda = 2.0 * shear * poisson_ratio / (1.0 - 2.0 * poisson_ratio);
    let nearly_half = 0.4999995;
    let beta = nearly_half / (1.0 - 2.0 * nearly_half);
    let (volumetric, exponent) = (lambda / (4.0 * beta), 0.05 / beta);
    // CalculiX reads 20 characters of a number.
    format!(
        "*HYPERFOAM, N=3\n{shear:.12e}, 2., {volumetric:.12e}, {exponent:.12e}, {volumetric:.12e}, {:.11e}, 0., {nearly_half}\n\
         {nearly_half}\n",
        -exponent
    )
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

//! The stiffness of one triangle with six nodes.

use std::collections::BTreeMap;

use super::{Code, Refused, Rows, arguments, named};
use crate::fem::element::{NODES, StiffnessRule};
use crate::phantom::Material;

arguments! { Element { nodes_m: Rows, youngs_modulus_pa: f64, poissons_ratio: f64 } }

/// The stiffness matrix, Pa, of an element in plane strain, 1 m thick.
pub fn stiffness(arguments: Element) -> Result<BTreeMap<&'static str, Vec<Vec<f64>>>, Refused> {
    let nodes = arguments.nodes_m.concat("nodes_m", NODES, 2)?;
    let (nodes, _) = nodes.as_chunks::<2>();
    let material = Material {
        youngs_modulus: arguments.youngs_modulus_pa,
        poisson_ratio: arguments.poissons_ratio,
    };
    check(&material)?;
    let stiffness = StiffnessRule::default().integrate(nodes, &material);
    let rows = stiffness.map_err(not_positive)?;
    let rows = rows.row_iter().map(|row| row.iter().copied().collect());
    Ok(named("stiffness", rows.collect()))
}

fn check(material: &Material) -> Result<(), Refused> {
    let Material {
        youngs_modulus,
        poisson_ratio,
    } = material;
    if *youngs_modulus <= 0.0 {
        let wrong = format_args!("youngs_modulus_pa is {youngs_modulus}, but must be above 0");
        return Err(Refused::range(wrong));
    }
    if !(*poisson_ratio > -1.0 && *poisson_ratio < 0.5) {
        let right = "must be above -1 and below 0.5";
        let wrong = format_args!("poissons_ratio is {poisson_ratio}, but {right}");
        return Err(Refused::range(wrong));
    }
    Ok(())
}

fn not_positive(jacobian: f64) -> Refused {
    if !jacobian.is_finite() {
        let wrong = "nodes_m has a Jacobian that is not a finite number";
        return Refused::new(Code::Overflow, wrong);
    }
    Refused::range(format_args!(
        "nodes_m has the Jacobian {jacobian:e}, but it must be above 0: give the corners counter-clockwise"
    ))
}

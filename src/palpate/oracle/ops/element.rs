//! The stiffness of one triangle with six nodes.

use serde::Serialize;

use super::{Code, Refused, Rows, answer};
use crate::fem::element::{NODES, StiffnessRule};
use crate::phantom::{Geometry, Material};

/// The stiffness matrix, Pa, of an element in plane strain, 1 m thick.
pub fn stiffness(
    nodes: &Rows,
    youngs_modulus: f64,
    poisson_ratio: f64,
) -> Result<impl Serialize, Refused> {
    let nodes = nodes.concat("nodes_m", NODES, 2)?;
    if youngs_modulus <= 0.0 {
        let wrong = format_args!("youngs_modulus_pa is {youngs_modulus}, but must be above 0");
        return Err(Refused::range(wrong));
    }
    if !(poisson_ratio > -1.0 && poisson_ratio < 0.5) {
        let right = "must be above -1 and below 0.5";
        let wrong = format_args!("poissons_ratio is {poisson_ratio}, but {right}");
        return Err(Refused::range(wrong));
    }
    let material = Material::isotropic(youngs_modulus, poisson_ratio);
    let stiffness =
        StiffnessRule::default().integrate(nodes.as_chunks::<2>().0, &material, Geometry::Plane);
    let stiffness = stiffness.map_err(not_positive)?;
    let rows = stiffness.row_iter();
    let rows: Vec<Vec<f64>> = rows.map(|row| row.iter().copied().collect()).collect();
    Ok(answer! { stiffness: rows })
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

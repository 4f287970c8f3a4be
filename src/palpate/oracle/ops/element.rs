//! The stiffness of one triangle with six nodes.

use super::{Answer, Arguments, Code, Refused};
use crate::fem::element::{NODES, StiffnessRule};
use crate::phantom::Material;

/// The stiffness matrix, Pa, of an element in plane strain, 1 m thick.
pub fn stiffness(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let rows = arguments.rows("nodes_m")?;
    let [youngs_modulus, poisson_ratio] =
        arguments.each(["youngs_modulus_pa", "poissons_ratio"])?;
    let node = |row: &Vec<f64>| <[f64; 2]>::try_from(&row[..]).ok();
    let nodes: Option<Vec<[f64; 2]>> = rows.iter().map(node).collect();
    let Some(nodes) = nodes.filter(|nodes| nodes.len() == NODES) else {
        let wrong = "nodes_m is expected to be six pairs [x, y]";
        return Err(Refused::argument(wrong));
    };
    if youngs_modulus <= 0.0 {
        let wrong = format_args!("youngs_modulus_pa is {youngs_modulus}, expected above 0");
        return Err(Refused::range(wrong));
    }
    if !(poisson_ratio > -1.0 && poisson_ratio < 0.5) {
        let expected = "expected above -1 and below 0.5";
        let wrong = format_args!("poissons_ratio is {poisson_ratio}, {expected}");
        return Err(Refused::range(wrong));
    }
    let material = Material {
        youngs_modulus,
        poisson_ratio,
    };
    let stiffness = StiffnessRule::default()
        .integrate(&nodes, &material)
        .map_err(not_positive)?;
    let row = stiffness.row_iter();
    let rows: Vec<Vec<f64>> = row.map(|row| row.iter().copied().collect()).collect();
    Ok(Answer::of([("stiffness", rows)]))
}

fn not_positive(jacobian: f64) -> Refused {
    if !jacobian.is_finite() {
        let wrong = "nodes_m makes a Jacobian that is no finite number";
        return Refused::new(Code::Overflow, wrong);
    }
    Refused::range(format_args!(
        "nodes_m makes an element with the Jacobian {jacobian:e}, \
         expected corners counter-clockwise and Jacobians above 0"
    ))
}

//! The force on the probe.

use serde::Serialize;

use super::{Refused, answer};
use crate::fem::{Contact, MESH_SIZE, Model, Pose};
use crate::phantom::Phantom;

/// Models that were made, each with the name of its phantom: at most one for each that is built in.
pub type Models = Vec<(String, Model)>;

/// The force at one pose, on the mesh and with the contact that `palpate solve` uses by default.
///
/// Implements: ORA-012.
pub fn force(
    name: String,
    depth: f64,
    lateral: f64,
    models: &mut Models,
) -> Result<impl Serialize + use<>, Refused> {
    let phantom =
        Phantom::builtin(&name).map_err(|error| Refused::range(format_args!("phantom {error}")))?;
    // Before the model is made: a pose that cannot be is cheap to refuse.
    let checked = phantom.check_pose(depth, lateral);
    checked.map_err(|error| Refused::range(format_args!("pose: {error}")))?;
    let pose = Pose { depth, lateral };
    let force = match models.iter().find(|(known, _)| *known == name) {
        Some((_, model)) => model.solve(pose)?.force,
        None => {
            let model = Model::new(&phantom, MESH_SIZE, Contact::DeformedNormal)?;
            let force = model.solve(pose)?.force;
            models.push((name, model));
            force
        }
    };
    Ok(answer! { normal_force_n: force.normal, lateral_force_n: force.lateral })
}

//! The force on the probe.

use serde::Serialize;

use super::{Refused, answer};
use crate::fem::{Contact, MESH_SIZE, Model, Pose};
use crate::phantom::{Phantom, Strain};

/// Models that were made, each with the name of its phantom and its theory: at most two for each that is built in.
pub type Models = Vec<((String, Strain), Model)>;

/// The force at one pose, on the mesh and with the contact that `palpate solve` uses by default.
///
/// Implements: ORA-012.
pub fn force(
    name: String,
    depth: f64,
    lateral: f64,
    strain: Option<String>,
    models: &mut Models,
) -> Result<impl Serialize + use<>, Refused> {
    let strain = match strain.as_deref() {
        None | Some("small") => Strain::Small,
        Some("finite") => Strain::Finite,
        Some(other) => {
            let wrong = format_args!("strain {other:?} is neither \"small\" nor \"finite\"");
            return Err(Refused::range(wrong));
        }
    };
    let phantom =
        Phantom::builtin(&name).map_err(|error| Refused::range(format_args!("phantom {error}")))?;
    // Before the model is made: a pose that cannot be is cheap to refuse.
    let checked = phantom.check_pose(depth, lateral);
    checked.map_err(|error| Refused::range(format_args!("pose: {error}")))?;
    let pose = Pose { depth, lateral };
    let key = (name, strain);
    let force = match models.iter().find(|(known, _)| *known == key) {
        Some((_, model)) => model.solve(pose)?.force,
        None => {
            let phantom = phantom.changed(|parts| parts.strain = strain);
            let phantom =
                phantom.map_err(|error| Refused::range(format_args!("phantom {error}")))?;
            let model = Model::new(&phantom, MESH_SIZE, Contact::DeformedNormal)?;
            let force = model.solve(pose)?.force;
            models.push((key, model));
            force
        }
    };
    Ok(answer! { normal_force_n: force.normal, lateral_force_n: force.lateral })
}

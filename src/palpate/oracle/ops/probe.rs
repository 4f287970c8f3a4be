//! The force on the probe.

use super::{Answer, Arguments, Refused};
use crate::fem::{Contact, MESH_SIZE, Model, Pose};
use crate::phantom::Phantom;

/// The forces at one pose, on the mesh and with the contact that `palpate solve` takes by default.
///
/// Implements: ORA-012.
pub fn force(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let name = arguments.text("phantom")?;
    let [depth, lateral] = arguments.each(["depth_m", "lateral_m"])?;
    let pose = Pose { depth, lateral };
    let phantom =
        Phantom::builtin(&name).map_err(|error| Refused::range(format_args!("phantom {error}")))?;
    // Before the model is made: a pose that cannot be is cheap to refuse.
    let checked = phantom.check_pose(depth, lateral);
    checked.map_err(|error| Refused::range(format_args!("pose: {error}")))?;
    let models = &mut *arguments.models;
    let solution = match models.iter().find(|(known, _)| *known == name) {
        Some((_, model)) => model.solve(pose)?,
        None => {
            let model = Model::new(&phantom, MESH_SIZE, Contact::DeformedNormal)?;
            let solution = model.solve(pose)?;
            models.push((name, model));
            solution
        }
    };
    Ok(Answer::of([
        ("normal_force_n", solution.force.normal),
        ("lateral_force_n", solution.force.lateral),
    ]))
}

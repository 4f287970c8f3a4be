//! Forces and mesh under several theories of the gel.

use super::forces::{panels, points};
use super::mesh::figure_at_finite_strain;
use super::plan::{Plan, Words, over};
use crate::report::text::{joined, millimetres, newtons, or};
use crate::report::{Findings, Run, Topic};
use palpate::chart::Line;
use palpate::chart::style::PALETTE;
use palpate::phantom::Strain;
use palpate::refusal::Refusal;

/// Both forces on the reference under each theory, and the mesh at finite strain, if the run compares theories.
///
/// # Errors
/// The maps have no row of the probe depth.
///
/// Implements: REP-092.
pub fn figures(run: &Run, found: &Findings) -> Result<Vec<Plan>, Refusal> {
    if run.theories.is_empty() {
        return Ok(Vec::new());
    }
    let mut lines = [Vec::new(), Vec::new()];
    for (k, theory) in run.theories.iter().enumerate() {
        let table = theory.reference.table();
        let row = table.row(found.probe_depth_m)?;
        for (lines, forces) in lines.iter_mut().zip([row.normal, row.lateral]) {
            let line = Line::nth(k, &PALETTE, points(table.laterals(), forces));
            lines.push(line.named(theory.name()));
        }
    }
    let headings = ["Normal force (N)", "Lateral force (N)"];
    let panels = panels(run.reference.table().laterals(), headings, lines);
    let picture = over("Lateral position of the probe x (mm)", panels);
    let mut plans = vec![Plan::new(
        "theories",
        Topic::Theories,
        words(found),
        picture,
    )];
    let frictionless = run.theories.iter().rev().find(|theory| {
        let phantom = &theory.deformed.phantom;
        phantom.strain() == Strain::Finite && phantom.probe().friction == 0.0
    });
    plans.extend(frictionless.map(|theory| figure_at_finite_strain(&theory.deformed)));
    Ok(plans)
}

fn words(found: &Findings) -> Words {
    let depth = millimetres(found.probe_depth_m);
    let levels = found.theories.iter().map(|theory| {
        let level = theory.reference.normal_force_at_centre_n;
        format!("{}: {} N", theory.name, or(level, "no force", newtons))
    });
    [
        format!("Forces without inclusion at depth {depth} mm, by the theory of the gel"),
        "Force on the whole probe against its lateral position, one curve for each theory. The paper has no such figure; it names \
         large deformation and friction as what its model leaves out. With friction the probe slides to the right and drags the gel \
         along, so that the lateral force is negative."
            .into(),
        format!(
            "Two line charts of normal and lateral force against lateral position. Normal force at x = 0: {}.",
            joined(levels, "; ")
        ),
    ]
}

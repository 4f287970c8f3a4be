//! The pictures: every figure of the paper that is no photograph, the signals, what is left of γ, and the bridge to Table 1.
//!
//! Each file states its figures as data ([`plan::Plan`]), words beside panels; [`figures`] draws them all.
//!
//! | file | content |
//! |---|---|
//! | `figure-2.svg`, `figure-8.svg` | the detection problem, the experiments: the same for every run |
//! | `plan.rs`, `bands.rs` | a figure as data; bands of a study as lines |
//! | `setup.rs`, `mesh.rs` | Figures 1 and 6: phantom and probe to scale, and as the probe deforms it |
//! | `theory.rs` | Figures 2, 3, 4 and 9: the detector alone |
//! | `theories.rs` | forces and mesh under several theories of the gel |
//! | `forces.rs` | Figures 5 and 7, and the signals |
//! | `gamma.rs` | γ of a sweep beside what may be unknown of it |
//! | `disturbed.rs` | γ of a sweep beside what may disturb it |
//! | `paths.rs` | γ along paths that take equally long |
//! | `inputs.rs` | which input counts, by a study |
//! | `people.rs`, `bridge.rs` | Figures 8 and 10 to 13: Table 1; the forces against it |

mod bands;
mod bridge;
mod disturbed;
mod forces;
mod gamma;
mod inputs;
mod mesh;
mod paths;
mod people;
mod plan;
mod setup;
mod theories;
mod theory;

use super::text::FileNames;
use super::{Figure, Findings, Run};
use palpate::refusal::Refusal;

/// All figures of a run, in the order of the page.
///
/// # Errors
/// A map does not fit the reference, or drawing fails.
///
/// Implements: REP-030, REP-031.
pub fn figures(run: &Run, findings: &Findings) -> Result<Vec<Figure>, Refusal> {
    let mut plans = setup::figures(run);
    plans.push(mesh::figure_6(&run.deformed));
    plans.extend(forces::figures(run, findings)?);
    plans.extend(theory::figures().map_err(Refusal::because("figures"))?);
    plans.extend(gamma::figure(run, findings));
    plans.extend(disturbed::figure(run, findings));
    plans.extend(paths::figure(run, findings));
    plans.extend(theories::figures(run, findings)?);
    plans.extend(inputs::figure(run));
    plans.extend(people::figures(run, findings));
    plans.extend(bridge::figure(findings));
    let mut names = FileNames::default();
    plans
        .into_iter()
        .map(|plan| plan.draw(&mut names))
        .collect()
}

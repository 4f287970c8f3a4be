//! How fast Newton's iterations converge.

use super::super::{FiniteModel, Friction};
use super::{builtin, pose};
use crate::fem::{Mesh, Pose};

/// The force out of balance over the contact's, before each of Newton's iterations of a step from one pose to another.
fn residuals(model: &FiniteModel, from: Pose, to: Pose) -> Vec<f64> {
    let above = model.untouched(from.lateral);
    let from = model.lead(&above, None, from).unwrap();
    let mut trial = model.trial(&from, from.state.clone()).unwrap();
    let mut residuals = Vec::new();
    for _ in 0..12 {
        trial = model.iterate(trial, to).unwrap().unwrap();
        let (out, contact) = model.out_of_balance(&trial.equations, &trial.forces);
        residuals.push(out / contact);
        if out < 1e-12 * contact {
            break;
        }
    }
    residuals
}

// Verifies: FIN-003, FIN-005, FIN-010.
#[test]
fn newtons_iterations_converge_quadratically() {
    let phantom = builtin("6.6");
    let mesh = Mesh::new(&phantom, 2e-3).unwrap();
    for friction in [Friction::None, Friction::Steady(0.3), Friction::Path(0.3)] {
        let model = FiniteModel::new(&phantom, &mesh, friction).unwrap();
        let found = residuals(&model, pose(1.0, -1.0), pose(1.8, -0.2));
        // Three in a row before rounding, which ends them at 1e-14: their order is log(c/b)/log(b/a), and 1 where a derivative is
        // wrong.
        let above: Vec<f64> = found.iter().copied().filter(|r| *r > 1e-12).collect();
        let [.., a, b, c] = above[..] else {
            panic!("{found:?}")
        };
        let order = libm::log(c / b) / libm::log(b / a);
        println!("{friction:?}: {found:?}, {order:.2}");
        assert!(order > 1.8, "{friction:?}: {found:?}");
    }
}

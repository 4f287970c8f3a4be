//! Errors of a convergence study against stored ones.

use super::problem::Errors;
use super::{Measured, largest};

/// How far an error may be from its stored value, over that value. Meshes and arithmetic are the same in each run, so that
/// only rounding moves it, by 1e-9; a tenth of a per cent lets another solver or a finer rule for the norms pass, but
/// nothing that touches the elements.
const SHARE: f64 = 1e-3;

/// The least order of gradient and stress at any ν: quadratic triangles lose one order at most, however near ν is to ½ (I. Babuška
/// and M. Suri, Numerische Mathematik 62, 1992, on straight ones).
pub const STRESS_ORDER_OF_ANY_NU: f64 = 1.0;

/// A row for each study and norm: its figure, the least order that is demanded, and the stored errors.
///
/// Orders: by the theory 3 for displacements and 2 for gradients and stresses, less 0.1; where ν is so near ½ that these meshes are
/// too coarse for that, 2 and 1. Near incompressibility the pressure λ div u is the last to reach its order. Those of the cylinder and
/// the manufactured solutions are scikit-fem's (`reference.py`).
const STORED: &str = "\
cylinder | displacement | displacement | 2.9 | 2.448146e-2 3.838886e-3 3.762619e-4 3.006331e-5 2.212931e-6
cylinder | stress | stress | 1 | 5.755811e-1 1.772008e-1 5.404902e-2 1.540391e-2 4.143761e-3
disc | displacement | displacement | 2.9 | 1.684859e-2 3.272239e-3 4.082207e-4 3.923043e-5
disc | stress | stress | 1 | 5.648983e-1 2.535486e-1 9.362615e-2 2.826855e-2
within the disc | stress in the disc | stress | 1 | 5.113417e-1 1.898850e-1 5.975485e-2 1.515631e-2
kh = 2, ν = 0.49 | kh = 2, ν = 0.49, displacement | displacement | 2.9 | 1.127161e-2 1.286235e-3 1.282166e-4 1.241168e-5
kh = 2, ν = 0.49 | kh = 2, ν = 0.49, stress | stress | 1 | 2.393160e-1 9.083377e-2 2.860989e-2 8.066989e-3
kh = 0.3, ν = 0.49 | kh = 0.3, ν = 0.49, displacement | displacement | 2.9 | 1.583937e-3 2.119906e-4 2.384953e-5 2.520786e-6
kh = 0.3, ν = 0.49 | kh = 0.3, ν = 0.49, stress | stress | 1 | 1.419327e-2 4.239383e-3 1.233276e-3 3.366325e-4
kh = 0.3, ν = 0.4999 | kh = 0.3, ν = 0.4999, displacement | displacement | 2 | 5.665095e-3 9.418422e-4 1.404146e-4 2.078253e-5
kh = 0.3, ν = 0.4999 | kh = 0.3, ν = 0.4999, stress | stress | 1 | 3.628944e-1 1.323208e-1 5.547951e-2 1.910465e-2
manufactured, ν = 0.3 | ν = 0.3, displacement | displacement | 2.9 | 9.364223e-3 1.178679e-3 1.432481e-4 1.753357e-5
manufactured, ν = 0.3 | ν = 0.3, gradient | gradient | 1.9 | 7.456549e-2 2.003823e-2 5.121438e-3 1.288508e-3
manufactured, ν = 0.49 | ν = 0.49, displacement | displacement | 2.9 | 1.676103e-2 2.849298e-3 3.667516e-4 3.711537e-5
manufactured, ν = 0.49 | ν = 0.49, gradient | gradient | 1.9 | 1.114067e-1 3.152678e-2 7.787697e-3 1.717520e-3";

/// Compares the errors of a study, on meshes each twice as fine as the one before, with [`STORED`] ones.
pub fn convergence(study: &str, errors: &[Errors]) -> Measured {
    let mut figures = Vec::new();
    for row in STORED
        .lines()
        .filter(|row| row.split(" | ").next() == Some(study))
    {
        let [_, what, norm, order, stored] = row.split(" | ").collect::<Vec<_>>()[..] else {
            return Err(row.into());
        };
        let error = |errors: &Errors| match norm {
            "displacement" => errors.displacement,
            "gradient" => errors.gradient,
            _ => errors.stress,
        };
        let errors: Vec<f64> = errors.iter().map(error).collect();
        let stored: Vec<f64> = stored
            .split(' ')
            .map(str::parse)
            .collect::<Result<_, _>>()?;
        figures.extend(compared(what, &errors, &stored, order.parse()?)?);
    }
    if figures.is_empty() {
        return Err(format!("no errors of {study} are stored").into());
    }
    Ok(figures)
}

/// Demands that errors be the stored ones, and that the last observed order log₂(e_{k−1}/e_k) be at least `order`. A run better than
/// stored fails as a worse one does.
///
/// Implements: FEM-062.
fn compared(what: &str, errors: &[f64], stored: &[f64], order: f64) -> Measured {
    let [.., before, finest] = errors[..] else {
        return Err("an order needs two meshes".into());
    };
    if errors.len() != stored.len() {
        return Err(format!("{what}: as many errors as are stored are needed").into());
    }
    let pairs = errors.iter().zip(stored);
    let off = pairs.map(|(error, stored)| (error / stored - 1.0).abs());
    Ok(figures! {
        "{what}: relative error on the finest mesh" => told(finest);
        "{what}: largest difference of an error from the stored one, over that" => at_most(largest(off), SHARE);
        "{what}: last observed order" => at_least(libm::log2(before / finest), order);
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Figure;

    // Verifies: FEM-062.
    #[test]
    fn an_error_that_moves_and_an_order_that_is_lost_fail() {
        let stored = [8.0, 1.0, 0.125];
        let passes = |errors: [f64; 3]| {
            let figures = compared("u", &errors, &stored, 2.9).unwrap();
            figures.iter().map(Figure::passes).collect::<Vec<_>>()
        };
        assert_eq!(passes(stored), [true; 3]);
        assert_eq!(passes([8.0, 1.0009, 0.125]), [true; 3]);
        // A run that is better fails as a worse one.
        assert_eq!(passes([8.0, 1.0011, 0.125]), [true, false, true]);
        assert_eq!(passes([7.99, 1.0, 0.125]), [true, false, true]);
        // The order 2.9 is the least: 2^−2.9 is 0.13397.
        assert_eq!(passes([8.0, 1.0, 0.1339]), [true, false, true]);
        assert_eq!(passes([8.0, 1.0, 0.1340]), [true, false, false]);
        assert_eq!(passes([8.0, f64::NAN, 0.125]), [true, false, false]);
    }
}

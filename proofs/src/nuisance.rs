//! The detector beside a nuisance: which templates it refuses.

use bolero::{Driver, TypeGenerator};
use palpate_core::detect::DetectError;
use palpate_core::detect::nuisance::{Nuisances, SubspaceDetector};

/// A nuisance and a template of three samples each, whole numbers from −2 to 2.
#[derive(Debug, Clone)]
struct Signals {
    nuisance: [f64; 3],
    template: [f64; 3],
}

impl TypeGenerator for Signals {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let mut numbers = [0.0; 6];
        for number in &mut numbers {
            *number = driver.gen_variant(5, 0)? as f64 - 2.0;
        }
        let [a, b, c, d, e, f] = numbers;
        // Often no nuisance, and often a template that is a multiple of it.
        let (nuisance, template) = match driver.gen_variant(5, 0)? {
            0 => ([0.0; 3], [d, e, f]),
            1 => ([a, b, c], [d * a, d * b, d * c]),
            _ => ([a, b, c], [d, e, f]),
        };
        Some(Signals { nuisance, template })
    }
}

fn dot(one: [f64; 3], other: [f64; 3]) -> f64 {
    one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
}

// Verifies: NUI-001, NUI-003, NUI-004, NUI-010.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(8))]
fn a_template_is_refused_if_and_only_if_the_nuisance_explains_it() {
    harness!(Signals, |case| {
        let &Signals { nuisance, template } = case;
        let (squares, along) = (dot(nuisance, nuisance), dot(nuisance, template));
        // |u|² |Pδ|², exact in whole numbers: 0 if and only if the two are parallel.
        let left = match squares == 0.0 {
            true => dot(template, template),
            false => squares * dot(template, template) - along * along,
        };
        let (mut basis, mut projected) = (nuisance, template);
        let space = Nuisances::new(&mut basis, 3);
        assert!(space.is_ok());
        if let Ok(space) = space {
            assert!(space.rank() == usize::from(squares > 0.0));
            match SubspaceDetector::new(space, &mut projected) {
                Ok(detector) => {
                    let gamma = detector.gamma();
                    let expected = if squares == 0.0 { left } else { left / squares };
                    // Ten roundings of numbers up to 12.
                    assert!(left > 0.0 && (gamma * gamma - expected).abs() <= 1e-13);
                }
                Err(error) => assert!(left == 0.0 && error == DetectError::NoSignal),
            }
        }
        reached! {
            "a template that the nuisance explains": left == 0.0 && squares > 0.0,
            "no nuisance": squares == 0.0,
            "a template beside the nuisance": left > 0.0 && along != 0.0,
        }
    });
}

//! The detector beside a nuisance: which templates it refuses. No Kani proof, for the inputs are few: the test takes them all.

use palpate_core::detect::DetectError;
use palpate_core::detect::nuisance::{Nuisances, SubspaceDetector};

fn dot(one: [f64; 3], other: [f64; 3]) -> f64 {
    one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
}

/// All signals of three samples, whole numbers from −2 to 2.
fn signals() -> impl Iterator<Item = [f64; 3]> {
    (0..125).map(|number| [1, 5, 25].map(|place| f64::from(number / place % 5 - 2)))
}

// Verifies: NUI-001, NUI-003, NUI-004, NUI-010.
#[test]
fn a_template_is_refused_if_and_only_if_the_nuisance_explains_it() {
    let mut refused = 0;
    for (nuisance, template) in signals().flat_map(|one| signals().map(move |other| (one, other))) {
        let (squares, along) = (dot(nuisance, nuisance), dot(nuisance, template));
        // |u|² |Pδ|², exact in whole numbers: 0 if and only if the two are parallel.
        let left = match squares == 0.0 {
            true => dot(template, template),
            false => squares * dot(template, template) - along * along,
        };
        let (mut basis, mut projected) = (nuisance, template);
        let space = Nuisances::new(&mut basis, 3).unwrap();
        assert_eq!(space.rank().get(), usize::from(squares > 0.0));
        match SubspaceDetector::new(space, &mut projected) {
            Ok(detector) => {
                let gamma = detector.gamma();
                let expected = if squares == 0.0 { left } else { left / squares };
                // Ten roundings of numbers up to 12.
                assert!(left > 0.0 && (gamma * gamma - expected).abs() <= 1e-13);
            }
            Err(error) => {
                assert!(left == 0.0 && error == DetectError::NoSignal);
                refused += 1;
            }
        }
    }
    // Of the lines through 0, 13 hold five of the points and 36 three: the templates on the line of a nuisance; and nothing beside nothing.
    assert_eq!(refused, 13 * 4 * 5 + 36 * 2 * 3 + 1);
}

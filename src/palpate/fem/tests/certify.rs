use crate::fem::certify::{band, certified_map, check_meshes, observed_order};
use crate::fem::{Contact, FemError, MESH_SIZE, Model};
use crate::force_map::ForceMap;

use super::{builtin, coarse, finest, off_centre};

/// f(h) = f₀ + c hᵖ on meshes of size 1, 4/3 and 2.
fn forces(limit: f64, factor: f64, order: f64) -> [f64; 3] {
    [1.0, 4.0 / 3.0, 2.0].map(|h: f64| limit + factor * h.powf(order))
}

// Verifies: FEM-026.
#[test]
fn the_observed_order_is_that_of_the_error() {
    for order in [0.5, 1.0, 1.7, 2.0, 3.0, 4.0] {
        for factor in [-2e-3, 1e-3] {
            let found = observed_order(forces(1.5, factor, order)).unwrap();
            // Differences of 1e-4 carry rounding of 2e-16: relative 1e-12, as much in p.
            assert!((found - order).abs() < 1e-9, "{order}: {found}");
        }
    }
    for none in [[1.0, 1.1, 1.05], [1.0, 1.0, 1.1], [1.0, 1.0, 1.0]] {
        assert_eq!(observed_order(none), None, "{none:?}");
    }
}

// Verifies: FEM-026.
#[test]
fn bands_are_the_error_times_the_safety_factor() {
    // Up to the second order the extrapolated error is exact, and the safety factor 1.25.
    for order in [1.0001, 1.5, 2.0] {
        let relative = band(forces(2.0, 1e-3, order)) / 1e-3 - 1.25;
        assert!(relative.abs() < 1e-8, "{order}: {relative:e}");
    }
    // Above, the second order is counted on: |f₂ − f₁| / ((4/3)² − 1).
    let steep = forces(2.0, 1e-3, 3.0);
    let expected = 1.25 * (steep[1] - steep[0]) / (7.0 / 9.0);
    assert!((band(steep) / expected - 1.0).abs() < 1e-12);
    // No order to trust: three times the largest change.
    assert!((band([1.0, 1.1, 1.05]) - 0.3).abs() < 1e-15);
    assert!((band([1.0, 1.001, 1.2]) - 0.6).abs() < 1e-15);
    assert!((band([1.0, 1.1, 1.11]) - 0.33).abs() < 1e-15);
    assert_eq!(band([0.0; 3]), 0.0);
}

// Verifies: FEM-026, FEM-028, MAP-006.
#[test]
fn a_certified_map_has_the_published_forces_and_bands_that_hold_the_error() {
    let model = Model::new(&builtin("2.6"), MESH_SIZE, Contact::default()).unwrap();
    let (depths, laterals) = ([1e-3, 2.5e-3, 4e-3], [-4e-3, -1e-3, 0.0, 2e-3, 6e-3]);
    let plain = model.map(&depths, &laterals, &|_| true).unwrap();
    let counted = std::cell::Cell::new(0);
    let count = |poses| {
        counted.set(counted.get() + poses);
        true
    };
    let map = certified_map(&model, &depths, &laterals, &count).unwrap();
    assert_eq!(map.table(), plain.table());
    // Three meshes over |x| = 0, 1, 2, 4, 6 mm.
    assert_eq!(counted.get(), 3 * 3 * 5);
    let bands = map.certificate().unwrap().discretization.clone().unwrap();
    assert_eq!(bands.nodes[0], model.mesh().nodes.len());
    assert!(bands.nodes[0] > bands.nodes[1] && bands.nodes[1] > bands.nodes[2]);
    assert_eq!(bands.lateral_force_band.row(1)[2], 0.0);
    // A mesh four times as fine leaves some 1/16 of the error, or 1/4 at the first order.
    let truth = finest().map(&depths, &laterals, &|_| true).unwrap();
    let (mut within, mut widest) = (0, 0.0f64);
    let truth = [truth.table().normal(), truth.table().lateral().unwrap()];
    for (kind, (banded, truth)) in banded(&map).iter().zip(truth).enumerate() {
        assert_eq!(banded.len(), 15);
        for ((force, band), truth) in banded.iter().zip(truth.values()) {
            within += usize::from((force - truth).abs() <= *band);
            widest = if kind == 0 {
                widest.max(band / force)
            } else {
                widest
            };
        }
    }
    // FEM-028 asks for 95 %; of 30 forces that allows one outside.
    let holds = within >= 29;
    assert!(holds, "only {within} of 30 forces lie in their bands");
    // A band that is always wide enough says nothing.
    assert!(widest < 0.2, "a band of {widest} of the force");
}

// Verifies: FEM-086.
#[test]
fn meshes_that_are_too_much_alike_have_no_bands() {
    let model = coarse(&builtin("none"), Contact::default());
    let never = |_: usize| -> bool { panic!("solved") };
    let error = certified_map(&model, &[1e-3], &[0.0], &never).unwrap_err();
    let expected = "the three meshes for the error bands have 1631, 1533 and 1481 nodes, too much alike to tell how far a force is off; give a smaller mesh size";
    assert!(matches!(error, FemError::Refused(_)));
    assert_eq!(error.to_string(), expected);
    // The other pair of meshes: 4405 nodes are 1.82 times 2419, these 1.32 times 1839. Just fine enough: 1.82 and 1.47 times.
    for (size, has_bands) in [(0.7e-3, false), (0.65e-3, true)] {
        let model = Model::new(&builtin("none"), size, Contact::default()).unwrap();
        assert_eq!(check_meshes(&model).is_ok(), has_bands, "{size}");
    }
}

/// The certificate's bands, lateral or normal, with the forces.
fn banded(map: &ForceMap) -> [Vec<(f64, f64)>; 2] {
    let bands = map.certificate().unwrap().discretization.as_ref().unwrap();
    let pairs = [
        (map.table().normal(), &bands.normal_force_band),
        (map.table().lateral().unwrap(), &bands.lateral_force_band),
    ];
    pairs.map(|(forces, bands)| {
        let forces = forces.values().iter().copied();
        forces.zip(bands.values().iter().copied()).collect()
    })
}

// Verifies: FEM-026, FEM-028.
#[test]
fn other_meshes_of_the_same_phantom_agree_within_their_bands() {
    let (depths, laterals) = ([1e-3, 2.5e-3, 4e-3], [-6e-3, -2e-3, 2e-3, 6e-3]);
    let certified = |phantom| {
        let model = Model::new(&phantom, MESH_SIZE, Contact::default()).unwrap();
        let map = certified_map(&model, &depths, &laterals, &|_| true).unwrap();
        (model.mesh().symmetric, banded(&map))
    };
    // A nanometre off the axis, the disc makes the same forces on a mesh that is not mirrored; 3 mm off, those of the disc on
    // the other side reversed.
    let (halved, whole) = (certified(builtin("4.6")), certified(off_centre(4.6, 1e-6)));
    assert!(halved.0 && !whole.0);
    let [right, mut left] = [3.0, -3.0].map(|x| certified(off_centre(4.6, x)).1);
    for (kind, forces) in left.iter_mut().enumerate() {
        forces.chunks_mut(laterals.len()).for_each(<[_]>::reverse);
        let sign = [1.0, -1.0][kind];
        forces.iter_mut().for_each(|(force, _)| *force *= sign);
    }
    let (mut within, mut all) = (0, 0);
    for (one, other) in [(&halved.1, &whole.1), (&right, &left)] {
        for (one, other) in one.iter().flatten().zip(other.iter().flatten()) {
            let ((a, band_a), (b, band_b)) = (one, other);
            all += 1;
            within += usize::from((a - b).abs() <= band_a + band_b);
            // Half a per cent of the largest normal force.
            assert!((a - b).abs() < 0.01, "{a} {b}");
        }
    }
    // 95 % of the forces lie in their bands (FEM-028); that both are out of theirs, and apart, is rarer.
    assert!(within >= all - all / 20, "{within} of {all}");
}

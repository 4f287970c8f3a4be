//! Bands of discretization, and the two maps that are compared.

use super::*;
use crate::phantom::{PhantomParts, Strain};

/// A band for each force of [`table`].
fn discretization() -> Discretization {
    Discretization {
        nodes: [6000, 3400, 1600],
        normal_force_band: matrix(&[[1e-6, 1e-4, 2e-4], [3e-4, 4e-4, 5e-4]]),
        lateral_force_band: matrix(&[[2e-6, 1e-5, 2e-5], [3e-6, 4e-5, 7e-5]]),
    }
}

// Verifies: MAP-006, MAP-002.
#[test]
fn bands_belong_to_the_poses_and_are_finite() {
    let map = computed(|_| ()).unwrap();
    let with = |change: &dyn Fn(&mut Discretization)| {
        let mut bands = discretization();
        change(&mut bands);
        map.clone().with_discretization(bands)
    };
    let good = with(&|_| ()).unwrap();
    let bands = good.certificate().unwrap().discretization.as_ref().unwrap();
    assert_eq!(bands.largest(), [5e-4, 7e-5]);
    for wrong in [-1e-9, f64::NAN, f64::INFINITY] {
        let error = with(&|bands| {
            bands.lateral_force_band = matrix(&[[0.0, 1e-5, 2e-5], [0.0, wrong, 7e-5]]);
        });
        let error = error.unwrap_err().to_string();
        let place = "certificate.discretization.lateral_force_band_n[1][1] = ";
        assert!(error.starts_with(place), "{error}");
    }
    assert_error(
        with(&|bands| bands.normal_force_band = matrix(&[[0.0, 1e-4, 2e-4]])),
        "certificate.discretization.normal_force_band_n has 1 rows and 3 columns; [..]",
    );
}

// Verifies: MAP-052.
#[test]
fn bands_follow_their_forces_and_survive_the_file() {
    let map = computed(|_| ()).unwrap();
    let map = map.with_discretization(discretization()).unwrap();
    let text = map.to_json();
    assert!(text.contains("\"normal_force_band_n\""), "{text}");
    assert_eq!(ForceMap::from_json(&text, "map.json").unwrap(), map);
    let unknown = text.replacen("\"normal_force_band_n\"", "\"band\"", 1);
    assert_error(ForceMap::from_json(&unknown, "map.json"), "[..]band[..]");
    let cut = map.at_laterals(&[0.0, 0.005]).unwrap();
    let bands = cut.certificate().unwrap().discretization.clone().unwrap();
    assert_eq!(bands.normal_force_band.row(1), [3e-4, 5e-4]);
    let mirrored = map.mirrored().unwrap();
    let certificate = mirrored.certificate().unwrap();
    let bands = certificate.discretization.clone().unwrap();
    let right = discretization();
    // At x = 0 the lateral force is 0 by symmetry, but its band is not.
    for (mirrored, right) in [
        (bands.normal_force_band, right.normal_force_band),
        (bands.lateral_force_band, right.lateral_force_band),
    ] {
        for row in 0..2 {
            let &[zero, near, far] = right.row(row) else {
                panic!("three columns")
            };
            assert_eq!(mirrored.row(row), [far, near, zero, near, far]);
        }
    }
    // A map without bands says nothing of them.
    let text = computed(|_| ()).unwrap().to_json();
    assert!(!text.contains("discretization"));
}

// Verifies: MAP-053.
#[test]
fn a_pair_of_maps_is_one_gel_without_and_with_an_inclusion() {
    let map = |change: &dyn Fn(&mut PhantomParts)| {
        let phantom = Phantom::builtin("6.6").unwrap().changed(change);
        measured(Some(phantom.unwrap()), table())
    };
    let with = map(&|_| ());
    let without = map(&|phantom| (phantom.inclusions.clear(), phantom.name = "plain".into()).0);
    assert!(Hypotheses::new(&without, &with).is_ok());
    // What is not known may be anything.
    let unknown = measured(None, table());
    for reference in [&unknown, &without] {
        assert!(Hypotheses::new(reference, &unknown).is_ok());
    }
    assert!(Hypotheses::new(&unknown, &with).is_ok());
    let refused = |reference: &ForceMap, inclusion: &ForceMap| {
        refusal(Hypotheses::new(reference, inclusion).map(|_| ()))
    };
    let (both, none) = (
        "the reference map already contains",
        "the map has no inclusion",
    );
    for (reference, inclusion, expected) in [
        (&with, &without, "the maps are swapped"),
        (&with, &with, both),
        (&without, &without, none),
        (&with, &unknown, both),
        (&unknown, &without, none),
    ] {
        let found = refused(reference, inclusion);
        assert!(found.starts_with(expected), "{found}");
    }
    let differ = |reference: &ForceMap, inclusion: &ForceMap, key: &str| {
        let message = refused(reference, inclusion);
        assert!(message.starts_with(&format!("{key} is ")), "{message}");
        assert!(message.ends_with("only the inclusions may differ"));
    };
    let other_gel = |key: &str, change: fn(&mut PhantomParts)| {
        let other = map(&|phantom| {
            phantom.inclusions.clear();
            change(phantom);
        });
        differ(&other, &with, &format!("phantom.{key}"));
    };
    other_gel("well.width_m", |p| p.well.width *= 2.0);
    let softer = |p: &mut PhantomParts| p.layers[0].material.poisson_ratio = 0.4;
    other_gel("layer[0].material.poisson_ratio", softer);
    other_gel("layer", |p| p.layers.push(p.layers[0].clone()));
    other_gel("probe.radius_m", |p| p.probe.radius *= 0.9);
    // Keys that one of the files leaves out.
    other_gel("strain", |p| p.strain = Strain::Finite);
    let fibrous = |p: &mut PhantomParts| p.layers[1].material.fibre_modulus = 5e4;
    other_gel("layer[1].material.fibre_modulus_pa", fibrous);
    assert_eq!(
        refused(&without, &map(&fibrous)),
        "phantom.layer[1].material.fibre_modulus_pa is 50000.0, but not given in the reference map; only the inclusions may differ"
    );
    let solved = |name: &str, change: fn(&mut Certificate)| {
        let ForceMap { source, .. } = computed(change).unwrap();
        ForceMap::new(source, Phantom::builtin(name).ok(), table()).unwrap()
    };
    let (with, without) = (solved("6.6", |_| ()), solved("none", |_| ()));
    assert!(Hypotheses::new(&without, &with).is_ok());
    let other_mesh = |key, change| differ(&solved("none", change), &with, key);
    other_mesh("mesh_size_m", |c| c.mesh_size = 0.001);
    other_mesh("contact", |c| c.contact = "vertical-gap".into());
    other_mesh("element", |c| c.element = "q4".into());
    let mut older = without;
    older.program_version = "0.0.1".into();
    differ(&older, &with, "program_version");
}

//! What a bank is, and its files.

use super::*;
use palpate_asserts::{assert_cases, assert_error};

// Verifies: BNK-001, BNK-010.
#[test]
fn maps_in_any_order_make_a_grid_that_survives_its_file() {
    let bank = Bank::new(reference(), maps()).unwrap();
    assert_eq!(bank.depth(), 4e-3);
    let [positions, depths, diameters, moduli] = bank.axes();
    assert_eq!(positions[..], [-2e-3, -1e-3, 0.0, 1e-3, 2e-3]);
    assert_eq!((depths[..2].to_vec(), depths.len()), (vec![3e-3, 4e-3], 4));
    assert_eq!((diameters.len(), moduli.len()), (2, 1));
    for (number, of) in bank.maps().iter().enumerate() {
        let inclusion = &of.phantom().unwrap().inclusions()[0];
        let expected = Parameter::ALL.map(|parameter| parameter.of(inclusion));
        assert_eq!(bank.point(number), expected);
    }
    assert_eq!(bank.point(6), [-1e-3, 4e-3, 4e-3, moduli[0]]);
    let text = bank.to_json();
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["schema"], "palpate-bank");
    assert_eq!(document["schema_version"], 1);
    assert_eq!(document["maps"].as_array().unwrap().len(), 40);
    assert_eq!(document["maps"][39]["schema"], "palpate-force-map");
    assert_eq!(Bank::from_json(&text, "bank.json").unwrap(), bank);
}

// Verifies: BNK-001, BNK-003, MAP-084.
#[test]
fn what_is_no_bank_is_refused() {
    type Change<'a> = &'a dyn Fn(&mut Vec<ForceMap>);
    let refused = |change: Change<'_>, expected: &str| {
        let mut maps = maps();
        change(&mut maps);
        let error = Bank::new(reference(), maps).unwrap_err().to_string();
        assert!(error.starts_with(expected), "{error}");
    };
    let none = "the bank has no maps; give one at least";
    refused(&|maps| maps.clear(), none);
    let grid = "39 maps; give one for each of 5 positions × 4 depths × 2 diameters × 1 moduli of their inclusions";
    refused(&|maps| maps.truncate(39), grid);
    let same = "maps[2] and maps[7] have the same inclusion; give each inclusion once";
    refused(&|maps| maps[7] = maps[2].clone(), same);
    let plain = "maps[3]: the map has no inclusion to compare";
    refused(&|maps| maps[3] = map(None, &[4e-3]), plain);
    let of_depths = |depths| map(Some((1.0, 6.0, 8.0)), depths);
    let other = "maps[3]: depths_m[0] = 0.0039, but must be 0.004 as in maps[0]";
    refused(&|maps| maps[3] = of_depths(&[3.9e-3]), other);
    let two = "maps[3]: it has 2 depths of the probe; give 1 as in maps[0]";
    refused(&|maps| maps[3] = of_depths(&[3.9e-3, 4e-3]), two);
    let cut = |map: &ForceMap| map.at_laterals(&[0.0, 5e-4]).unwrap();
    let narrow = "maps[1]: its lateral positions are not those of the reference; give the same";
    refused(&|maps| maps[1] = cut(&maps[1]), narrow);
    let one_channel = |map: &ForceMap| measured(map.phantom().cloned(), map.table().of_normal());
    let one = "maps[1]: the map has no lateral forces, which are needed here";
    refused(&|maps| maps[1] = one_channel(&maps[1]), one);
    assert_error(
        Bank::new(one_channel(&reference()), maps()),
        "reference: the map has no lateral forces, which are needed here[..]",
    );
    let error = Bank::new(map(None, &[3e-3]), maps()).unwrap_err();
    let shallow = "depth 4.0 mm is not in the map; give one of 3.0 mm";
    assert!(error.to_string().starts_with(shallow), "{error}");
}

// Verifies: BNK-010.
#[test]
fn a_damaged_file_is_refused_with_its_place() {
    let text = Bank::new(reference(), maps()).unwrap().to_json();
    let refused = |text: &str| Bank::from_json(text, "bank.json").unwrap_err().to_string();
    let schema = refused(&text.replacen("palpate-bank", "palpate-force-map", 1));
    let expected = "bank.json: schema = \"palpate-force-map\", but must be \"palpate-bank\"";
    assert_eq!(schema, expected);
    let key = refused(&text.replacen("\"laterals_m\"", "\"laterals\"", 1));
    let end = refused(&text[..text.len() / 2]);
    for (error, words) in [(key, "reference.laterals is unknown"), (end, "EOF")] {
        let is_placed = error.starts_with("bank.json:");
        assert!(is_placed && error.contains(words), "{error}");
    }
}

// Verifies: BNK-012.
#[test]
fn a_prior_names_each_inclusion() {
    let bank = Bank::new(reference(), maps()).unwrap();
    let read = |rows: &str| {
        let head = "weight,depth_mm,position_mm,diameter_mm,youngs_modulus_kpa\n";
        let modulus = 1e-3 * bank.axes()[3][0];
        bank.prior(&(head.to_string() + &rows.replace('E', &modulus.to_string())))
    };
    let prior = read("3,3,-2,4,E\n1,3,-1,4,E\n").unwrap();
    assert_eq!(
        (prior[..3].to_vec(), prior.len()),
        (vec![0.75, 0.25, 0.0], 40)
    );
    let refused = |rows: &str| read(rows).unwrap_err().to_string();
    assert_cases("refused/prior.txt", "rows", refused);
}

// Verifies: MAP-009.
#[test]
fn a_mirror_image_has_the_other_sign_across() {
    let of = |x: f64| {
        let phantom = Phantom::builtin("6.6").unwrap();
        let phantom = phantom
            .changed(|parts| parts.inclusions[0].centre_x = x)
            .unwrap();
        let row = |values: [f64; 3]| Matrix::from_fn(1, 3, |_, column| values[column]);
        let (lateral, normal) = ([0.25, 0.0, -0.5], [1.0, 2.0, 3.0]);
        let (laterals, sign) = ([-0.002, 0.0, 0.001], x.signum());
        let turned = |values: [f64; 3], sign: f64| match sign < 0.0 {
            true => [values[2], values[1], values[0]],
            false => values,
        };
        let forces = Force::new(
            row(turned(lateral, sign).map(|f| 0.0 + sign * f)),
            row(turned(normal, sign)),
        );
        let laterals = turned(laterals, sign).map(|x| 0.0 + sign * x).to_vec();
        let table = ForceTable::new(vec![0.004], laterals, forces).unwrap();
        measured(Some(phantom), table)
    };
    assert_eq!(of(0.002).mirror_image().unwrap(), of(-0.002));
    assert_eq!(of(-0.002).mirror_image().unwrap(), of(0.002));
}

/// A plan on a coarse mesh.
fn plan() -> BankPlan {
    let laterals = [-4e-3, -2e-3, 0.0, 2e-3, 4e-3];
    let mut plan = BankPlan::new(Phantom::builtin("6.6").unwrap(), 4e-3, &laterals).unwrap();
    plan.positions = vec![-3e-3, 0.0, 3e-3, 5e-3];
    plan.mesh_size = 2e-3;
    plan
}

// Verifies: BNK-020, FEM-040.
#[test]
fn a_bank_has_the_forces_of_each_gel() {
    use crate::fem::{Contact, Model};
    let usual = BankPlan::new(Phantom::builtin("6.6").unwrap(), 4e-3, &[0.0]);
    assert_eq!(usual.unwrap().mesh_size, MESH_SIZE);
    let plan = plan();
    let solves = plan.solves().unwrap();
    let images: Vec<bool> = solves.iter().map(|solve| solve.image).collect();
    assert_eq!(images, [false, true, false]);
    let bank = plan.bank().unwrap();
    assert_eq!(
        bank.reference().table().depths(),
        [3.7e-3, 4e-3, 4e-3 + 3e-4]
    );
    assert_eq!(bank.axes()[0], plan.positions);
    for (position, map) in plan.positions.iter().zip(bank.maps()) {
        let phantom = Phantom::builtin("6.6").unwrap();
        let phantom = phantom
            .changed(|parts| parts.inclusions[0].centre_x = *position)
            .unwrap();
        assert_eq!(map.phantom(), Some(&phantom));
        let model = Model::new(&phantom, 2e-3, Contact::default()).unwrap();
        let alone = model
            .map(&[4e-3], map.table().laterals(), &|_| true)
            .unwrap();
        let difference = map.table().minus(alone.table()).unwrap();
        // Meshes of mirror images are none of each other but where the gel is symmetric: their forces differ as those of two meshes do.
        let most = if *position < 0.0 { 2e-2 } else { 1e-10 };
        for force in difference.both().unwrap().into_array() {
            let is_small = force.values().iter().all(|f| f.abs() < most);
            assert!(is_small, "{position}: {difference:?}");
        }
    }
}

// Verifies: BNK-020. Above 0.4 mm its half, 0.2 mm, is nearer to it than to 0.45 mm, whose half is nearer to 0.4 mm; so is 0.7 mm to 0.45 mm.
#[test]
fn the_reference_has_the_depths_beside_which_no_other_is_nearer() {
    let mut light = plan();
    light.probe_depths = vec![0.4e-3, 0.45e-3];
    let reference = light.reference().unwrap();
    let micrometres = reference.table().depths().iter().map(|depth| 1e6 * depth);
    let micrometres: Vec<f64> = micrometres.map(f64::round).collect();
    assert_eq!(micrometres, [200.0, 400.0, 450.0, 750.0]);
}

// Verifies: BNK-020, BNK-021.
#[test]
fn inclusions_that_do_not_fit_are_refused_before_anything_is_solved() {
    let mut deep = plan();
    deep.depths = vec![3e-3, 40e-3];
    let error = deep.solves().unwrap_err().to_string();
    let expected = "the inclusion at -3.000 mm, 40.000 mm deep, 6.400 mm wide, of ";
    assert!(error.starts_with(expected), "{error}");
    assert!(error.contains("inclusion[0].depth_mm = 40"), "{error}");
    let shape = Shape::Ellipse {
        width: 8e-3,
        height: 4e-3,
        angle_deg: 0.0,
    };
    let paper = Phantom::builtin("6.6").unwrap();
    let ellipse = paper
        .changed(|parts| parts.inclusions[0].shape = shape)
        .unwrap();
    let mut plan = BankPlan::new(ellipse, 4e-3, &[0.0]).unwrap();
    assert_eq!(plan.diameters, [8e-3]);
    assert_eq!(plan.solves().unwrap().len(), 1);
    plan.diameters = vec![4e-3];
    let error = plan.solves().unwrap_err().to_string();
    assert_eq!(
        error,
        "the inclusion is no disc; give a disc, or one diameter"
    );
    assert_error(
        BankPlan::new(Phantom::builtin("none").unwrap(), 4e-3, &[0.0]),
        "the phantom has 0 inclusions; give one, of which the hypotheses are made",
    );
}

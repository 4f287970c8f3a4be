//! Code verification of the finite elements (`spec/verification.md`), by the checks of `palpate_verify::fem`, which
//! `palpate-verify` runs too. Run with `--nocapture` to see the figures.

use palpate_verify as verify;

/// Runs the check of this name, which prints its figures and fails with those that break their bounds.
fn check(name: &str) {
    let check = verify::find(name).unwrap_or_else(|| panic!("{name} is no check"));
    let figures = check.judge().unwrap_or_else(|broken| panic!("{broken}"));
    figures
        .iter()
        .for_each(|figure| println!("{name}: {figure}"));
}

// Verifies: EVD-043, EVD-045.
#[test]
fn every_check_runs_here() {
    let here = include_str!("main.rs");
    for check in verify::fem::CHECKS {
        let call = format!("check(\"{}\");", check.name);
        assert!(here.contains(&call), "{} is not run", check.name);
    }
}

// Verifies: FEM-050.
#[test]
fn linear_fields_are_exact_on_any_mesh() {
    check("fem.linear_patch");
}

// Verifies: FEM-051.
#[test]
fn quadratic_fields_are_exact_on_straight_triangles() {
    check("fem.quadratic_patch");
}

// Verifies: FEM-052.
#[test]
fn only_rigid_motions_cost_no_energy() {
    check("fem.rigid_modes");
}

// Verifies: FEM-053, FEM-062.
#[test]
fn triangles_converge_with_orders_3_and_2() {
    check("fem.manufactured_t6");
}

// Verifies: FEM-058.
#[test]
fn near_incompressibility_costs_one_order() {
    check("fem.manufactured_locking");
}

// Verifies: FEM-054, FEM-062.
#[test]
fn the_pressed_cylinder_converges_to_lame() {
    check("fem.cylinder");
}

// Verifies: FEM-058.
#[test]
fn triangles_do_not_lock() {
    check("fem.cylinder_locking");
}

// Verifies: FEM-055, FEM-062.
#[test]
fn the_strain_in_a_disc_is_uniform_and_eshelby_s() {
    check("fem.disc");
}

// Verifies: FEM-056, FEM-062.
#[test]
fn a_bonded_layer_bends_as_the_closed_form() {
    check("fem.bonded_layer");
}

// Verifies: FEM-057.
#[test]
fn a_thin_bonded_strip_tends_to_the_lubrication_limit() {
    check("fem.thin_strip");
}

// Verifies: FEM-057.
#[test]
fn load_and_half_width_obey_hertz() {
    check("fem.hertz");
}

// Verifies: FEM-059.
#[test]
fn forces_are_the_slopes_of_the_energy_over_whole_maps() {
    check("fem.energy_slopes");
}

// Verifies: FEM-060, FEM-061.
#[test]
fn condensed_contact_equals_a_solve_of_everything() {
    check("fem.condensed_contact");
}

// Verifies: FEM-060, FEM-061.
#[test]
fn condensed_vertical_contact_equals_a_solve_of_everything() {
    check("fem.condensed_vertical_contact");
}

// Verifies: FEM-061.
#[test]
fn a_whole_map_is_mirror_symmetric_to_the_bit() {
    check("fem.mirror_symmetry");
}

// Verifies: FEM-020, EVD-048.
#[test]
fn the_paper_s_forces_are_those_of_an_independent_program() {
    check("fem.reference_forces");
}

// Verifies: FEM-008, FEM-009, FEM-014, FEM-015, FEM-026, EVD-048.
#[test]
fn the_paper_s_poses_have_certificates_within_their_limits() {
    check("fem.certificates");
}

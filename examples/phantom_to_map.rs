//! A phantom of your own, and the forces on the probe over it: `cargo run -p palpate --example phantom_to_map`.

use std::error::Error;

use palpate::fem::{Contact, Model};
use palpate::phantom::Phantom;

/// Two layers over a hard floor, and an ellipse in the lower one.
const PHANTOM: &str = r#"
name = "two layers"
well = { width_mm = 40, walls = "sliding" }
probe = { radius_mm = 6.5, length_mm = 30 }
layer = [
  { name = "skin", thickness_mm = 1, youngs_modulus_kpa = 100, poisson_ratio = 0.49 },
  { name = "gel", thickness_mm = 15, youngs_modulus_kpa = 8, poisson_ratio = 0.49 },
]
[[inclusion]]
centre_x_mm = 2
depth_mm = 5
width_mm = 8
height_mm = 4
youngs_modulus_kpa = 1200
poisson_ratio = 0.49
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let phantom = Phantom::from_toml(PHANTOM, "two-layers.toml")?;
    // A mesh of 1 mm, and the probe 2 and 3 mm deep at nine lateral positions.
    let model = Model::new(&phantom, 1e-3, Contact::default())?;
    let laterals: Vec<f64> = (-4..=4).map(|step| 2e-3 * f64::from(step)).collect();
    let map = model.map(&[2e-3, 3e-3], &laterals, &|_| true)?;

    println!("normal and lateral force (N), 3 mm deep");
    let row = map.table().row(3e-3)?;
    for ((x, normal), lateral) in laterals.iter().zip(row.normal).zip(row.lateral) {
        println!("x = {:4.1} mm  {normal:.4}  {lateral:+.4}", 1e3 * x);
    }
    // `map.to_json()` is the file that the other examples, and `palpate`, read.
    let certificate = map.certificate().ok_or("a computed map")?;
    println!(
        "det(I + grad u) is at least {:.2}",
        certificate.smallest_det.det
    );
    Ok(())
}

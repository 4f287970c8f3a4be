//! The `palpate` program.
use palpate::fem::*;
use palpate::phantom::*;
use std::time::Instant;
fn main() {
    let depths: Vec<f64> = (0..=8).map(|d| d as f64 * 0.5e-3).collect();
    let laterals: Vec<f64> = (0..=20).map(|d| d as f64 * 0.5e-3).collect();
    let mut all = String::new();
    for name in BUILTIN_NAMES {
        let t = Instant::now();
        let model = Model::new(
            &Phantom::builtin(name).unwrap(),
            &MeshOptions::default(),
            Contact::default(),
        )
        .unwrap();
        let t1 = t.elapsed();
        let map = model.map(&depths, &laterals, &|_| ()).unwrap();
        let c = map.certificate().unwrap();
        println!(
            "{name} {t1:?} {:?} {} its {} residual {:e} balance {:e} pen {:e} {:?}",
            t.elapsed(),
            c.nodes,
            c.newton_iterations,
            c.worst_relative_residual,
            c.worst_force_balance,
            c.largest_penetration,
            c.smallest_det
        );
        for d in 1..9 {
            for x in 0..21 {
                all += &format!(
                    "{} {} {} {} {}\n",
                    if name == "none" { "0" } else { name },
                    d,
                    x,
                    map.normal_force().row(d)[x],
                    map.lateral_force().row(d)[x]
                );
            }
        }
    }
    std::fs::write("/tmp/out.txt", all).unwrap();
}

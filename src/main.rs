//! The `palpate` program.
use palpate::fem::*;
use palpate::phantom::*;
use std::time::Instant;
fn main() {
    let m = |e| Material {
        youngs_modulus: e,
        poisson_ratio: 0.49,
    };
    let size: f64 = std::env::args().nth(1).map_or(0.55, |s| s.parse().unwrap()) * 1e-3;
    let refinement: usize = std::env::args().nth(2).map_or(1, |s| s.parse().unwrap());
    let contact = if std::env::args().nth(3).as_deref() == Some("v") {
        Contact::VerticalGap
    } else {
        Contact::DeformedNormal
    };
    let element = if std::env::args().nth(4).as_deref() == Some("q") {
        Element::Q4Full
    } else {
        Element::T6
    };
    let mut all = String::new();
    for depth in [0.0, 2.6, 4.6, 6.6, 8.6] {
        let p = Phantom {
            name: "x".into(),
            gel: Gel {
                width: 0.034,
                height: 0.015,
                material: m(5e3),
            },
            skin: Skin {
                thickness: 0.0005,
                material: m(180e3),
            },
            inclusion: (depth > 0.0).then_some(Inclusion {
                diameter: 0.0064,
                depth: depth * 1e-3,
                material: m(1.2e6),
            }),
            probe: Probe {
                radius: 0.0065,
                length: 0.03,
            },
        };
        let t = Instant::now();
        let model = Model::new(
            &p,
            &MeshOptions {
                size,
                refinement,
                element,
            },
            contact,
        )
        .unwrap();
        let t1 = t.elapsed();
        let t = Instant::now();
        let mut its = 0;
        let mut n = 0;
        let mut out = String::new();
        for x in 0..=20 {
            let mut state = ContactState::untouched(model.surface.positions.len());
            for d in 1..=8 {
                let pose = Pose {
                    depth: d as f64 * 0.5e-3,
                    lateral: x as f64 * 0.5e-3,
                };
                state = model.surface.solve(pose, &state).unwrap();
                its += state.iterations;
                n += 1;
                {
                    let f = model.surface.probe_force(&state, pose);
                    all += &format!("{} {} {} {} {}\n", depth, d, x, f[1], f[0]);
                }
                if d == 8 && x % 4 == 0 {
                    let f = model.surface.probe_force(&state, pose);
                    out += &format!(" {:.5}/{:.5}", f[1], f[0]);
                }
            }
        }
        println!(
            "{depth} nodes {} L {} build {t1:?} {n} poses {its} its {:?}{out}",
            model.mesh.nodes.len(),
            model.factor.entries(),
            t.elapsed()
        );
    }
    std::fs::write(std::env::var("OUT").unwrap_or("/tmp/out.txt".into()), all).unwrap();
}

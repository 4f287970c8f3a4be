use palpate::fem::*;
use palpate::phantom::*;
use std::time::Instant;
fn main() {
    let p = Phantom::builtin("4.6").unwrap();
    let o = MeshOptions::default();
    let model = Model::new(&p, &o, Contact::default()).unwrap();
    for _ in 0..2 {
        let mut all = vec![];
        let t = Instant::now();
        for x in 0..21 {
            let mut st = ContactState::untouched(model.surface().positions.len());
            for d in 1..9 {
                let pose = Pose {
                    depth: d as f64 * 0.5e-3,
                    lateral: x as f64 * 0.5e-3,
                };
                st = model.surface().solve(pose, &st).unwrap();
                all.push(PoseSolution {
                    pose,
                    normal_force: 0.,
                    lateral_force: 0.,
                    energy: 0.,
                    penetration: 0.,
                    state: st.clone(),
                });
            }
        }
        let a = t.elapsed();
        let its: usize = all.iter().map(|s| s.state.iterations).sum();
        let t = Instant::now();
        let c = model.checks(&all);
        let b = t.elapsed();
        println!(
            "contact {a:?} its {its} active {} checks {b:?} {}",
            all[7].state.active.len(),
            c.len()
        );
    }
}

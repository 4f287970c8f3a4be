use palpate::force_map::ForceMap;
use palpate::psychophysics::*;
fn main() {
    let t = Table::paper().unwrap();
    let m = |n: &str| {
        ForceMap::read(std::path::Path::new(&format!(
            "/tmp/psy/out/maps/map-{n}.json"
        )))
        .unwrap()
    };
    let r = m("none");
    let maps: Vec<(&str, ForceMap)> = ["2.6", "4.6", "6.6", "8.6"].map(|n| (n, m(n))).into();
    let inc: Vec<(&str, &ForceMap)> = maps.iter().map(|(n, m)| (*n, m)).collect();
    let s = std::time::Instant::now();
    let a = analyse(&t).unwrap();
    let e = s.elapsed();
    let b = bridge::bridge(&t, &r, &inc).unwrap();
    let e2 = s.elapsed();
    println!("{}", serde_json::to_string(&a).unwrap());
    println!(
        "{}",
        serde_json::to_string(&paper_noise_levels().unwrap()).unwrap()
    );
    println!("{}", serde_json::to_string(&b).unwrap());
    eprintln!("{e:?} {e2:?}");
}

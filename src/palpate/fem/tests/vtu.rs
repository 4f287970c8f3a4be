//! Files for ParaView of a path.

use super::{Contact, Model, builtin, pose};
use crate::phantom::Strain;

/// The numbers of an array.
pub fn array(text: &str, name: &str) -> Vec<f64> {
    let (_, rest) = text.split_once(&format!("Name=\"{name}\"")).expect(name);
    let body = rest.split_once('>').unwrap().1.split_once('<').unwrap().0;
    body.split_whitespace()
        .map(|word| word.parse().unwrap())
        .collect()
}

/// A probe that goes down 2 mm, then to the right by 0.02, 1, 2 and 3 mm, with friction of 0.3.
// Verifies: FEM-016, FIN-010, FIN-011.
#[test]
fn a_series_tells_pressure_shear_and_slip() {
    let phantom = builtin("none").changed(|parts| {
        parts.strain = Strain::Finite;
        parts.probe.friction = 0.3;
    });
    let model = Model::new(&phantom.unwrap(), 1.5e-3, Contact::default()).unwrap();
    let across = [0.02, 1.0, 2.0, 3.0].map(|x| pose(2e-3, 1e-3 * x));
    let poses = [vec![pose(1e-3, 0.0), pose(2e-3, 0.0)], across.into()].concat();
    let (path, checks) = model.path(&poses).unwrap();
    assert!(checks.iter().all(|check| check.min_det > 0.8));
    let series = model.vtu_series(&path).unwrap();
    assert_eq!(series.len(), 6);
    let of = |at: usize| {
        let [pressure, shear, slip] = ["contact_pressure_pa", "contact_shear_pa", "slip_m"]
            .map(|name| array(&series[at], name));
        assert_eq!(pressure.len(), model.mesh().nodes.len());
        let nodes = pressure.into_iter().zip(shear).zip(slip);
        let touching = nodes.filter(|((pressure, _), _)| *pressure != 0.0);
        touching
            .map(|((pressure, shear), slip)| [pressure, shear, slip])
            .collect::<Vec<_>>()
    };
    // Nothing comes before the first pose.
    assert!(
        of(0)
            .iter()
            .all(|[pressure, _, slip]| *pressure > 0.0 && *slip == 0.0)
    );
    // After the short way the middle sticks, under less than μ p.
    let short = of(2);
    let sticks = short
        .iter()
        .filter(|[pressure, shear, _]| shear.abs() < 0.299 * pressure);
    let sticks: Vec<_> = sticks.collect();
    assert!(sticks.len() > short.len() / 4, "{short:?}");
    assert!(
        sticks.iter().all(|[.., slip]| slip.abs() < 1e-9),
        "{short:?}"
    );
    // At last each node is dragged to the right by μ p, and slips to the left by the way of the probe, 1 mm: less at the flanks, where
    // the probe's face is steep, and where the gel is still going along.
    let last = of(5);
    assert!(last.len() > 8);
    for [pressure, shear, slip] in last {
        assert!(
            (shear / pressure - 0.3).abs() < 1e-6,
            "{shear} of {pressure}"
        );
        assert!((-1.2e-3..-0.5e-3).contains(&slip), "{slip}");
    }
    // One pose alone has no slip; its pressure under the lowest point is between the mean and 1.6 times that (4/π of it by Hertz).
    let alone = model.solve(pose(2e-3, 0.0)).unwrap();
    let text = model.vtu(&alone).unwrap();
    assert!(array(&text, "slip_m").iter().all(|slip| *slip == 0.0));
    let place = array(&text, "position_m");
    let pressures = array(&text, "contact_pressure_pa");
    let touching = place.chunks(3).zip(&pressures).filter(|(_, p)| **p > 0.0);
    let (left, right) = touching.fold((0.0f64, 0.0f64), |(a, b), (at, _)| {
        (a.min(at[0]), b.max(at[0]))
    });
    let mean = alone.force.normal / (0.03 * (right - left));
    let largest = pressures.iter().fold(0.0, |a: f64, &b| a.max(b));
    assert!(
        (1.0..1.6).contains(&(largest / mean)),
        "{largest} over {mean}"
    );
}

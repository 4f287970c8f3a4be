//! The forces of whole maps as slopes of the strain energy.

use palpate::fem::{Contact, Model, Pose, PoseSolution};
use palpate::phantom::Phantom;

use super::{Measured, largest};

/// Step h of the differences, m.
const STEP: f64 = 2e-6;

/// A central difference of `value` over ±h with the estimate of its error, h² f'''/6, from that over ±2h.
fn slope(of: &[PoseSolution; 4], value: impl Fn(&PoseSolution) -> f64) -> (f64, f64) {
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| value(&of[k]));
    let (fine, coarse) = ((c - b) / (2.0 * STEP), (d - a) / (4.0 * STEP));
    (fine, (coarse - fine).abs() / 3.0)
}

/// The largest errors of F_n = ∂U/∂d, F_x = −∂U/∂x and ∂F_n/∂x = −∂F_x/∂d at a pose, each over what differences allow;
/// `None` where a point of the surface meets or leaves the probe within the steps: there the force has a kink, and no difference across
/// it has a limit.
///
/// The differences are off by h² f'''/6, which the difference over twice the step tells up to terms of its own h² relative,
/// and by rounding: Newton's method leaves 1e-13 m, so 1e-13 J in the energy of forces of 1 N at most, over 2h; and
/// 1e-10 N in a force (FEM-060), over 2h.
fn at_pose(model: &Model, depth: f64, lateral: f64) -> Measured<Option<[f64; 3]>> {
    const ENERGY: f64 = 1e-13 / (2.0 * STEP);
    const FORCE: f64 = 1e-10 / (2.0 * STEP);
    let at = |down: f64, aside: f64| {
        let (depth, lateral) = (depth + down * STEP, lateral + aside * STEP);
        model.solve(Pose { depth, lateral })
    };
    let here = at(0.0, 0.0)?;
    let down = [at(-2.0, 0.0)?, at(-1.0, 0.0)?, at(1.0, 0.0)?, at(2.0, 0.0)?];
    let aside = [at(0.0, -2.0)?, at(0.0, -1.0)?, at(0.0, 1.0)?, at(0.0, 2.0)?];
    let same = |s: &PoseSolution| {
        s.contact().expect("small strain").active == here.contact().expect("small strain").active
    };
    if !down.iter().chain(&aside).all(same) {
        return Ok(None);
    }
    let other = slope(&down, |s| s.force.lateral);
    let mixed = slope(&aside, |s| s.force.normal);
    let laws = [
        (slope(&down, |s| s.energy), here.force.normal, ENERGY),
        (slope(&aside, |s| -s.energy), here.force.lateral, ENERGY),
        ((mixed.0, mixed.1 + other.1), -other.0, FORCE),
    ];
    Ok(Some(laws.map(|((slope, error), expected, rounding)| {
        (slope - expected).abs() / (1.1 * error + rounding)
    })))
}

/// The laws at every pose of a map of 8 depths and 11 lateral positions.
fn map(name: &str, contact: Contact) -> Measured {
    let phantom = Phantom::builtin(name)?;
    let model = Model::new(&phantom, 1.5e-3, contact)?;
    let (mut kinks, mut shares) = (0, Vec::new());
    for pose in 0..88 {
        let (depth, lateral) = (
            0.5e-3 * f64::from(pose / 11 + 1),
            1e-3 * f64::from(pose % 11),
        );
        match at_pose(&model, depth, lateral)? {
            Some(laws) => shares.push(laws),
            None => kinks += 1,
        }
    }
    let what = format!("{name}, {}", contact.name());
    let laws = ["F_n = ∂U/∂d", "F_x = −∂U/∂x", "∂F_n/∂x = −∂F_x/∂d"];
    let mut figures = Vec::new();
    for (k, law) in laws.iter().enumerate() {
        let share = largest(shares.iter().map(|share| share[k]));
        figures.extend(
            figures! { "{what}: largest error of {law} over its bound" => at_most(share, 1.0); },
        );
    }
    // The probe moves by 8 µm along each axis, and the contact's two edges with it: as far in x, and in d at most √(R/2d),
    // 2.5 times as far (the circle's own half-width, at 0.5 mm). Among points a mean distance apart, they pass one in a share
    // 2 · 8 · 3.5 µm of it of the poses; three standard deviations more are allowed.
    let distance = phantom.well().width / model.surface().positions.len() as f64;
    let share = 2.0 * 4.0 * STEP * 3.5 / distance;
    let expected = 88.0 * share;
    let most = expected + 3.0 * (expected * (1.0 - share)).sqrt();
    figures
        .extend(figures! { "{what}: poses of 88 at a kink" => at_most(f64::from(kinks), most); });
    Ok(figures)
}

pub fn slopes() -> Measured {
    let mut figures = map("none", Contact::DeformedNormal)?;
    figures.extend(map("2.6", Contact::DeformedNormal)?);
    figures.extend(map("2.6", Contact::VerticalGap)?);
    Ok(figures)
}

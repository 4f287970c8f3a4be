//! What gels, motions and sensors do to a sweep.

use std::f64::consts::TAU;

use palpate::phantom::{PhantomParts, Shape, Support};
use palpate::stats::random::Generator;

/// The depth of the sweeps, m.
pub const DEPTH: f64 = 4e-3;

/// The lateral and the normal force at the position x (m), from those of the gel at a depth and a position, by eight numbers between
/// 0 and 1.
pub type Happens = fn(&dyn Fn(f64, f64) -> [f64; 2], f64, &[f64; 8]) -> [f64; 2];

/// What happens to both channels of the whole record at last.
pub type Ends = fn(&mut [Vec<f64>; 2], &[f64; 8], &Generator, u64);

pub fn plain(f: &dyn Fn(f64, f64) -> [f64; 2], x: f64, _: &[f64; 8]) -> [f64; 2] {
    f(DEPTH, x)
}
pub fn nothing(_: &mut [Vec<f64>; 2], _: &[f64; 8], _: &Generator, _: u64) {}

fn turned([x, n]: [f64; 2], slope: f64) -> [f64; 2] {
    [x - slope * n, n + slope * x]
}

/// A sine of a size and a length (m) at x, and its slope.
fn sine(x: f64, size: f64, length: f64, phase: f64) -> [f64; 2] {
    let (sin, cos) = (TAU * (x / length + phase)).sin_cos();
    [size * sin, size * TAU / length * cos]
}

/// The forces over a surface of the sum of some heights (m) with their slopes.
fn over(f: &dyn Fn(f64, f64) -> [f64; 2], x: f64, heights: &[[f64; 2]]) -> [f64; 2] {
    let [height, slope] = [0, 1].map(|of| heights.iter().map(|height| height[of]).sum::<f64>());
    turned(f(DEPTH + height, x), slope)
}

/// The height and the slope of a surface that is domed or dished, by two numbers between 0 and 1.
fn dome(x: f64, [size, sign]: [f64; 2]) -> [f64; 2] {
    let a = between(0.2e-3, 0.3e-3, size) * if sign < 0.33 { -1.0 } else { 1.0 };
    let v = x / 8e-3;
    [a * (0.5 - v * v), -2.0 * a * v / 8e-3]
}
/// Those of a surface with waves.
fn waves(x: f64, [size, length, phase]: [f64; 3]) -> [f64; 2] {
    let size = between(0.05e-3, 0.2e-3, size);
    sine(x, size, between(7e-3, 13e-3, length), phase)
}
/// The forces on a probe that rubs, after it rested at the start.
fn rubbed([l, n]: [f64; 2], x: f64, [friction, length]: [f64; 2]) -> [f64; 2] {
    let moved = 1.0 - (-(x + 8e-3) / between(0.3e-3, 2e-3, length)).exp();
    [l - between(0.1, 0.3, friction) * n * moved, n]
}
/// The forces of a gel that relaxes.
fn relaxed(forces: [f64; 2], x: f64, [share, length]: [f64; 2]) -> [f64; 2] {
    let relaxed = 1.0 - (-(x + 8e-3) / between(1.5e-3, 10e-3, length)).exp();
    forces.map(|v| v * (1.0 - between(0.1, 0.2, share) * relaxed))
}
/// The forces by a sensor that sways.
fn swaying([l, n]: [f64; 2], x: f64, [size, length, of_l, of_n]: [f64; 4]) -> [f64; 2] {
    let (size, length) = (between(0.05, 0.2, size), between(5e-3, 20e-3, length));
    let [of_l, of_n] = [of_l, of_n].map(|phase| sine(x, size, length, phase)[0]);
    [l + of_l, n + of_n]
}

fn between(low: f64, high: f64, u: f64) -> f64 {
    low + (high - low) * u
}
fn sign(u: f64) -> f64 {
    if u < 0.5 { -1.0 } else { 1.0 }
}

/// Motions and sensors over the gel of the maps.
pub const MOTIONS: &[(&str, Happens, Ends)] = &[
    ("exact", plain, nothing),
    (
        "gain",
        |f, x, u| f(DEPTH, x).map(|v| v * between(0.8, 1.2, u[0])),
        nothing,
    ),
    (
        "depth",
        |f, x, u| f(DEPTH + sign(u[0]) * 0.3e-3, x),
        nothing,
    ),
    (
        "domed",
        |f, x, u| over(f, x, &[dome(x, [u[0], u[1]])]),
        nothing,
    ),
    (
        "stage bows",
        |f, x, u| {
            let a = between(0.2e-3, 0.3e-3, u[0]) * sign(u[1]);
            let v = x / 8e-3;
            f(DEPTH - a * v * v + 0.5 * a, x)
        },
        nothing,
    ),
    (
        "bow 0.10-0.15 N",
        |f, x, u| {
            let [l, n] = f(DEPTH, x);
            let v = x / 8e-3;
            [l, n - between(0.10, 0.15, u[0]) * sign(u[1]) * v * v]
        },
        nothing,
    ),
    (
        "tilt 1-2",
        |f, x, u| {
            let slope = (between(1.0, 2.0, u[0]) * sign(u[1])).to_radians();
            turned(f(DEPTH + slope * x, x), slope)
        },
        nothing,
    ),
    (
        "relaxes 10-20 %",
        |f, x, u| relaxed(f(DEPTH, x), x, [u[0], u[1]]),
        nothing,
    ),
    (
        "friction 0.1-0.3",
        |f, x, u| rubbed(f(DEPTH, x), x, [u[0], u[1]]),
        nothing,
    ),
    (
        "friction varies",
        |f, x, u| {
            let [l, n] = f(DEPTH, x);
            let mu = 0.2 * (1.0 + 0.5 * (x / between(1e-3, 3e-3, u[0]) + TAU * u[1]).sin());
            [l - mu * n, n]
        },
        nothing,
    ),
    ("lag", |f, x, u| f(DEPTH, x - sign(u[0]) * 0.3e-3), nothing),
    (
        "cross-talk 5 %",
        |f, x, _| {
            let [l, n] = f(DEPTH, x);
            [l + 0.05 * n, n + 0.05 * l]
        },
        nothing,
    ),
    (
        "stiffness ramp",
        |f, x, u| f(DEPTH, x).map(|v| v * (1.0 + sign(u[0]) * 0.1 * x / 8e-3)),
        nothing,
    ),
    (
        "stiffness wave",
        |f, x, u| {
            let g = 1.0
                + between(0.02, 0.05, u[0]) * (x / between(1.5e-3, 4e-3, u[2]) + TAU * u[1]).cos();
            f(DEPTH, x).map(|v| v * g)
        },
        nothing,
    ),
    (
        "tremor",
        |f, x, u| {
            let d = DEPTH
                + 0.05e-3 * ((x / 0.6e-3 + TAU * u[0]).sin() + (x / 1.1e-3 + TAU * u[1]).sin());
            f(d, x)
        },
        nothing,
    ),
    (
        "cosine wander",
        |f, x, u| {
            let [l, n] = f(DEPTH, x);
            let w = between(2e-3, 6e-3, u[0]);
            [
                l + 0.05 * (x / w + TAU * u[1]).cos(),
                n + 0.1 * (x / w + TAU * u[2]).cos(),
            ]
        },
        nothing,
    ),
    (
        "hum",
        |f, x, u| {
            let [l, n] = f(DEPTH, x);
            let h = 0.1 * (x / 0.11e-3 + TAU * u[0]).sin();
            [l + h, n + h]
        },
        nothing,
    ),
    (
        "bump",
        |f, x, u| {
            let a = between(0.1e-3, 0.2e-3, u[0]);
            let w = between(2e-3, 3e-3, u[1]);
            let x0 = between(-4e-3, 4e-3, u[2]);
            let v = (x - x0) / w;
            let h = a * (-0.5 * v * v).exp();
            turned(f(DEPTH + h, x), -h * v / w)
        },
        nothing,
    ),
    (
        "position off",
        |f, x, u| f(DEPTH, x + sign(u[0]) * between(0.8e-3, 0.98e-3, u[1])),
        nothing,
    ),
    (
        "warming",
        |f, x, u| {
            let [l, n] = f(DEPTH, x);
            let s = 1.0 - (-(x + 8e-3) / between(4e-3, 10e-3, u[0])).exp();
            [l + 0.05 * s * sign(u[1]), n + 0.15 * s * sign(u[2])]
        },
        nothing,
    ),
    (
        "four at once",
        |f, x, u| {
            let a = 0.15e-3 * sign(u[0]);
            let v = x / 8e-3;
            let s = x + 8e-3;
            let [l, n] = f(DEPTH - a * v * v, x)
                .map(|q| q * (1.0 - 0.1 * (1.0 - (-s / 5e-3).exp())) * (1.0 + 0.05 * v));
            [l - 0.15 * n, n]
        },
        nothing,
    ),
    ("quantised 0.05 N", plain, |channels, _, _, _| {
        channels
            .iter_mut()
            .flatten()
            .for_each(|v| *v = (*v / 0.05).round() * 0.05);
    }),
    (
        "stick-slip",
        |f, x, u| {
            let [l, n] = f(DEPTH, x);
            let p = between(0.5e-3, 1.5e-3, u[0]);
            let saw = ((x + 8e-3) / p).fract() - 0.5;
            [l - 0.2 * n - 0.1 * n * saw, n]
        },
        nothing,
    ),
    ("random walk", plain, |channels, u, generator, trial| {
        for (c, channel) in channels.iter_mut().enumerate() {
            let mut w = vec![0.0; channel.len()];
            generator.normals(trial, 5000 + 1000 * c as u64, &mut w);
            let size = between(0.1, 0.3, u[0]) / (w.len() as f64).sqrt();
            let mut sum = 0.0;
            for (v, w) in channel.iter_mut().zip(w) {
                sum += size * w;
                *v += sum;
            }
        }
    }),
    ("glitches", plain, |channels, u, _, _| {
        let count = 1 + (4.0 * u[0]) as usize;
        for k in 0..count {
            let at = ((u[1 + k] * 161.0) as usize).min(160);
            channels[k % 2][at] += between(5.0, 100.0, u[5]) * sign(u[6]);
        }
    }),
    ("saturated", plain, |channels, u, _, _| {
        let mut sorted = channels[1].clone();
        sorted.sort_by(f64::total_cmp);
        let cap = sorted[((1.0 - if u[0] < 0.5 { 0.4 } else { 0.7 }) * 160.0) as usize];
        channels[1].iter_mut().for_each(|v| *v = v.min(cap));
    }),
    ("mN", plain, |channels, _, _, _| {
        channels.iter_mut().flatten().for_each(|v| *v *= 1e3)
    }),
    ("gf", plain, |channels, _, _, _| {
        channels.iter_mut().flatten().for_each(|v| *v *= 101.97)
    }),
    ("sign", plain, |channels, _, _, _| {
        channels.iter_mut().flatten().for_each(|v| *v = -*v)
    }),
    (
        "air",
        |_, _, u| [0.2 * (u[0] - 0.5), 0.6 * (u[1] - 0.5)],
        nothing,
    ),
];

/// More motions and sensors over the gel of the maps: sines, of one length and of two. They come last, so that the other families keep
/// their seeds.
pub const SINES: &[(&str, Happens, Ends)] = &[
    (
        "surface has waves",
        |f, x, u| over(f, x, &[waves(x, [u[0], u[1], u[2]])]),
        nothing,
    ),
    (
        "surface has two waves",
        |f, x, u| {
            let sizes = [u[0], u[1]].map(|u| between(0.03e-3, 0.1e-3, u));
            let short = sine(x, sizes[0], between(6e-3, 9e-3, u[2]), u[3]);
            let long = sine(x, sizes[1], between(9e-3, 14e-3, u[4]), u[5]);
            over(f, x, &[short, long])
        },
        nothing,
    ),
    (
        "sensor sways",
        |f, x, u| swaying(f(DEPTH, x), x, [u[0], u[1], u[2], u[3]]),
        nothing,
    ),
    (
        "sensor sways twice",
        |f, x, u| {
            let [size, other] = [u[0], u[1]].map(|u| between(0.03, 0.1, u));
            let [l, n] = f(DEPTH, x);
            let both = |a: f64, b: f64| sine(x, size, 8e-3, a)[0] + sine(x, other, 14e-3, b)[0];
            [l + both(u[2], u[3]), n + both(u[4], u[5])]
        },
        nothing,
    ),
];

/// Several of these at once.
pub const SEVERAL: &[(&str, Happens, Ends)] = &[
    (
        "domed, wavy",
        |f, x, u| over(f, x, &[dome(x, [u[0], u[1]]), waves(x, [u[2], u[3], u[4]])]),
        nothing,
    ),
    (
        "domed, rubs",
        |f, x, u| rubbed(over(f, x, &[dome(x, [u[0], u[1]])]), x, [u[2], u[3]]),
        nothing,
    ),
    (
        "domed, sways",
        |f, x, u| {
            let forces = over(f, x, &[dome(x, [u[0], u[1]])]);
            swaying(forces, x, [u[2], u[3], u[4], u[5]])
        },
        nothing,
    ),
    (
        "wavy, rubs",
        |f, x, u| {
            let forces = over(f, x, &[waves(x, [u[0], u[1], u[2]])]);
            rubbed(forces, x, [u[3], u[4]])
        },
        nothing,
    ),
    (
        "wavy, relaxes",
        |f, x, u| {
            let forces = over(f, x, &[waves(x, [u[0], u[1], u[2]])]);
            relaxed(forces, x, [u[3], u[4]])
        },
        nothing,
    ),
    (
        "sways, rubs",
        |f, x, u| {
            swaying(
                rubbed(f(DEPTH, x), x, [u[0], u[1]]),
                x,
                [u[2], u[3], u[4], u[5]],
            )
        },
        nothing,
    ),
    (
        "domed, wavy, rubs, relaxes",
        |f, x, u| {
            let heights = [dome(x, [u[0], u[1]]), waves(x, [u[2], u[3], u[4]])];
            let forces = rubbed(over(f, x, &heights), x, [u[5], u[6]]);
            relaxed(forces, x, [u[7], u[0]])
        },
        nothing,
    ),
];

/// What is different of a gel or a probe.
pub type Change = fn(&mut PhantomParts);

/// Gels and probes under which the record was made.
pub const GELS: &[(&str, Change)] = &[
    ("well 30", |g| g.well.width = 30e-3),
    ("well 32", |g| g.well.width = 32e-3),
    ("well 38", |g| g.well.width = 38e-3),
    ("height 14", |g| g.layers[1].thickness = 13.5e-3),
    ("height 17", |g| g.layers[1].thickness = 16.5e-3),
    ("skin 1.0", |g| g.layers[0].thickness = 1.0e-3),
    ("skin 0.25", |g| g.layers[0].thickness = 0.25e-3),
    ("skin 90 kPa", |g| {
        g.layers[0].material.youngs_modulus = 90e3
    }),
    ("skin 360 kPa", |g| {
        g.layers[0].material.youngs_modulus = 360e3
    }),
    ("nu 0.48", |g| {
        g.layers
            .iter_mut()
            .for_each(|l| l.material.poisson_ratio = 0.48);
    }),
    ("nu 0.495", |g| {
        g.layers
            .iter_mut()
            .for_each(|l| l.material.poisson_ratio = 0.495);
    }),
    ("probe 6", |g| g.probe.radius = 6e-3),
    ("probe 7", |g| g.probe.radius = 7e-3),
    ("floor sliding", |g| g.well.floor = Support::Sliding),
    ("walls sliding", |g| g.well.walls = Support::Sliding),
    ("walls free", |g| g.well.walls = Support::Free),
    ("gel 7 kPa", |g| g.layers[1].material.youngs_modulus = 7e3),
    ("disc 4 mm", |g| {
        for i in &mut g.inclusions {
            i.shape = Shape::Disc { diameter: 4e-3 };
        }
    }),
];

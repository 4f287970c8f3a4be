//! What the world may do to the model: parts of disturbances, and the classes of which one explains a record.

use std::f64::consts::PI;
use std::fmt;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::channels;
use super::modes::Modes;
use crate::force::Force;

/// A part of a disturbance.
///
/// Implements: ROB-021.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// A smooth misfit of the maps in both channels, four times smaller in the variance of the lateral one.
    Smooth,
    /// A smooth misfit over longer distances.
    Broad,
    /// The gel and the probe: compressibility, size of the well, skin, radius, depth.
    Gel,
    /// Walls or floor that hold the gel less.
    Support,
    /// The depth varies along the stage.
    Stage,
    /// The height of the surface varies.
    Surface,
    /// Stage and surface are tilted.
    Tilt,
    /// Friction along the surface, and cross-talk between the channels.
    Friction,
    /// Friction that varies along the surface.
    UnevenFriction,
    /// The forces relax from the beginning of the sweep on.
    Relaxation,
    /// A random walk of the sensor.
    Walk,
    /// Waves of the surface, with wavenumbers in a band of `WAVES`.
    #[serde(skip)]
    Waves(usize),
    /// A bump of the surface after so many tenths of the place, 1 to 9.
    #[serde(skip)]
    Bump(usize),
    /// Sways of the sensor, with wavenumbers in a band of `SWAYS`.
    #[serde(skip)]
    Sway(usize),
}

/// A band of wavenumbers, cycles in a radius of the probe: its middle and its width.
type Band = [f64; 2];

/// The bands of waves of the surface and of sways of the sensor. The last one holds the others: two sines need it. One sine needs a
/// narrow band, for an inclusion explains it better than many sines at once do.
///
/// Implements: ROB-024.
const WAVES: [Band; 5] = [
    [0.55, 0.2],
    [0.75, 0.2],
    [0.95, 0.2],
    [1.15, 0.2],
    [0.85, 0.8],
];
const SWAYS: [Band; 7] = [
    [0.4, 0.12],
    [0.52, 0.12],
    [0.64, 0.12],
    [0.76, 0.12],
    [0.88, 0.12],
    [1.0, 0.12],
    [0.7, 0.72],
];
/// The standard deviation of a bump's height along the surface, over the radius of the probe.
///
/// Implements: ROB-025.
const BUMP: f64 = 0.38;
/// The distance between the wavenumbers of waves, cycles in a radius of the probe.
const BETWEEN_WAVES: f64 = 0.1;

/// Sweeps that have a part in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SharedBy {
    /// Each sweep has its own.
    None,
    /// Those of one place.
    Place,
    /// Those of one gel.
    Gel,
}

/// One kind of world: parts, and how large they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Class {
    /// What a person calls it.
    pub name: &'static str,
    /// Its prior, over that of the others.
    pub weight: f64,
    /// The parts with their sizes; what is known is left out.
    parts: &'static [(Part, f64)],
}

const fn class(name: &'static str, weight: f64, parts: &'static [(Part, f64)]) -> Class {
    Class {
        name,
        weight,
        parts,
    }
}

/// A smooth misfit up to this size is always possible.
const SMALL: f64 = 0.005;
/// What is left where nothing disturbs.
const EXACT: (Part, f64) = (Part::Smooth, 0.002);

/// A part with what gels and probes do in any case: where it alone was possible, it and an inclusion would explain it and another
/// disturbance better than no inclusion does.
///
/// Implements: ROB-022.
const fn amid(part: Part, size: f64) -> [(Part, f64); 7] {
    use Part::{Friction, Gel, Relaxation, Support, Surface};
    [
        (part, size),
        (Support, 1.0),
        (Gel, 0.5),
        (Surface, 0.5),
        (Friction, 0.5),
        (Relaxation, 0.5),
        EXACT,
    ]
}

/// The classes with their prior weights. A size of a smooth part or a walk is a share of the mean normal force.
///
/// Implements: ROB-022.
#[rustfmt::skip]
pub const CLASSES: [Class; 43] = {
    use Part::{Broad, Bump, Friction, Gel, Relaxation, Smooth, Stage, Support, Surface, Sway, Tilt, UnevenFriction, Walk, Waves};
    [
        class("the maps hold", 2.0, &[EXACT]),
        class("the forces are off smoothly by 0.5 %", 1.0, &[(Smooth, 0.005)]),
        class("the forces are off smoothly by 1.5 %", 1.0, &[(Smooth, 0.015)]),
        class("the forces are off smoothly by 4 %", 1.0, &[(Smooth, 0.04)]),
        class("the forces are off smoothly by 10 %", 1.0, &[(Broad, 0.1)]),
        class("the gel is another", 1.0, &[(Gel, 1.0), EXACT]),
        class("the gel is another, and off smoothly", 1.0, &[(Gel, 1.0), (Smooth, 0.015)]),
        class("walls or floor are loose", 0.5, &[(Support, 1.0), (Gel, 1.0), (Smooth, 0.005)]),
        class("the stage is bowed", 0.5, &[(Stage, 1.0), EXACT]),
        class("the surface is domed or dished", 0.5, &[(Surface, 1.0), EXACT]),
        class("the gel is tilted", 0.5, &[(Tilt, 1.0), EXACT]),
        class("the probe rubs", 0.5, &[(Friction, 1.0), EXACT]),
        class("the probe rubs unevenly", 0.5, &[(Friction, 1.0), (UnevenFriction, 0.1), (Smooth, 0.005)]),
        class("the gel relaxes", 0.5, &[(Relaxation, 1.0), EXACT]),
        class("the probe rubs and the gel relaxes", 0.5, &[(Friction, 1.0), (Relaxation, 1.0), (Smooth, 0.04)]),
        class("the sensor wanders a little", 0.5, &[(Walk, 0.05)]),
        class("the sensor wanders", 0.5, &[(Walk, 0.15)]),
        class("the sensor wanders far", 0.5, &[(Walk, 0.5)]),
        class("the surface has waves, 1.8 radii long", 0.08, &amid(Waves(0), 0.015)),
        class("the surface has waves, 1.3 radii long", 0.08, &amid(Waves(1), 0.015)),
        class("the surface has waves, 1.1 radii long", 0.08, &amid(Waves(2), 0.015)),
        class("the surface has waves, 0.9 radii long", 0.08, &amid(Waves(3), 0.015)),
        class("the surface is wavy", 0.2, &amid(Waves(4), 0.015)),
        class("the surface has a bump, 10 % along", 0.1, &[(Bump(1), 0.023), EXACT]),
        class("the surface has a bump, 20 % along", 0.1, &[(Bump(2), 0.023), EXACT]),
        class("the surface has a bump, 30 % along", 0.1, &[(Bump(3), 0.023), EXACT]),
        class("the surface has a bump, 40 % along", 0.1, &[(Bump(4), 0.023), EXACT]),
        class("the surface has a bump, 50 % along", 0.1, &[(Bump(5), 0.023), EXACT]),
        class("the surface has a bump, 60 % along", 0.1, &[(Bump(6), 0.023), EXACT]),
        class("the surface has a bump, 70 % along", 0.1, &[(Bump(7), 0.023), EXACT]),
        class("the surface has a bump, 80 % along", 0.1, &[(Bump(8), 0.023), EXACT]),
        class("the surface has a bump, 90 % along", 0.1, &[(Bump(9), 0.023), EXACT]),
        class("the sensor sways over 2.5 radii", 0.2, &amid(Sway(0), 0.08)),
        class("the sensor sways over 1.9 radii", 0.2, &amid(Sway(1), 0.08)),
        class("the sensor sways over 1.6 radii", 0.2, &amid(Sway(2), 0.08)),
        class("the sensor sways over 1.3 radii", 0.2, &amid(Sway(3), 0.08)),
        class("the sensor sways over 1.1 radii", 0.2, &amid(Sway(4), 0.08)),
        class("the sensor sways over 1 radius", 0.2, &amid(Sway(5), 0.08)),
        class("the sensor sways", 0.5, &amid(Sway(6), 0.05)),
        class("the sensor sways far", 0.5, &amid(Sway(6), 0.1)),
        class("several of these at once", 0.5,
            &[(Gel, 0.5), (Stage, 0.5), (Surface, 0.5), (Friction, 0.5), (Relaxation, 0.5), (Smooth, 0.005)]),
        class("several at once, loose walls or floor", 0.2,
            &[(Support, 1.0), (Gel, 0.5), (Stage, 0.5), (Surface, 0.5), (Friction, 0.5), (Relaxation, 0.5), (Smooth, 0.005)]),
        class("the surface is domed, the probe rubs", 0.2,
            &[(Surface, 1.0), (Friction, 0.5), (Relaxation, 0.5), EXACT]),
    ]
};

/// One more where there is a single signal: it has no rival that a loose floor resembles even more.
pub const SUPPORT_ALONE: Class = class(
    "walls or floor alone are loose",
    4.0,
    &[(Part::Support, 2.0), (Part::Smooth, 0.005)],
);

/// Standard deviations of what is part of every class: offset, and drift to either end, N, and gain.
const OFFSET: f64 = 0.3;
const DRIFT: f64 = 0.15;
const GAIN: f64 = 0.3;
/// The standard deviation of what rounding leaves, as a share of the mean normal force.
const ROUNDING: f64 = 1e-5;
/// The offset of a sensor that was set to zero on the gel, N.
const ZEROED: f64 = 2.0;
/// Lengths of smooth parts, over the radius of the probe.
const SMOOTH: [f64; 2] = [0.38, 0.77];
const BROAD: [f64; 2] = [0.62, 1.23];
const RUBBED: [f64; 3] = [0.15, 0.38, 0.77];
/// The standard deviation of friction's short changes, over the mean normal force.
const RUBS: f64 = 0.02;
/// The variance of the lateral channel over that of the normal one.
const LATERAL: f64 = 0.25;
/// Standard deviations of the curves of stage and surface, over the radius of the probe: 0.2 mm and less.
const CURVES: [f64; 7] = [0.031, 0.031, 0.015, 0.015, 0.0077, 0.0046, 0.0046];
/// Lengths after which friction from rest, and relaxation, have come to an end, over the radius of the probe.
const FROM_REST: [f64; 3] = [0.062, 0.15, 0.46];
const RELAXING: [f64; 3] = [0.23, 0.77, 2.5];

/// What a sweep is like where nothing disturbs it, from which the disturbances are made: samples stacked, lateral first.
#[derive(Debug, Clone)]
pub struct Undisturbed {
    /// The forces without inclusion, N.
    pub forces: Vec<f64>,
    /// ∂F/∂d, N/m.
    pub slope: Vec<f64>,
    /// What one standard deviation of each uncertain quantity of the gel, and of its support, adds, N.
    pub gel: Vec<Vec<f64>>,
    pub support: Vec<Vec<f64>>,
    /// Positions in the order of time, as distances from the beginning, m.
    pub travelled: Vec<f64>,
    /// From −1 to 1 over the place of all passes, and half its width, m.
    pub u: Vec<f64>,
    pub half: f64,
    /// What the depth of each sample adds to the force at the mean depth, N; nothing where the depth is one.
    pub uneven: Vec<f64>,
    /// The normal force of each sample over that at the mean depth.
    pub share: Vec<f64>,
    /// What the zero of measured depths adds, and their independent errors, N; nothing where there is none.
    pub zero_error: Vec<f64>,
    pub depth_noise: Vec<f64>,
    /// The standard deviation of the depth of each sample, and the radius of the probe, m.
    pub depth_sd: Vec<f64>,
    pub radius: f64,
    /// Whether the sensor was set to zero on the gel.
    pub is_zeroed: bool,
}

/// A covariance between the modes of a sweep: Σ of vvᵀ over directions of known size, and a rest.
#[derive(Debug, Clone)]
pub struct Covariance {
    /// The directions; those of the same number in several sweeps are one, where the part is shared.
    pub vectors: Vec<DVector<f64>>,
    /// The rest, which may be 0.
    pub rest: DMatrix<f64>,
}

/// The disturbances of a sweep in its modes.
#[derive(Debug, Clone)]
pub struct Disturbances<'a> {
    modes: &'a Modes,
    sweep: &'a Undisturbed,
    /// The kernel of the part smooth.
    smooth: DMatrix<f64>,
    /// The mean normal force, N.
    level: f64,
}

/// The name on the command line and in JSON of the part that a person calls known.
impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.name().serialize(f)
    }
}

impl Part {
    /// Those that can be known; their variants are known with them.
    ///
    /// Implements: ROB-050.
    pub const KNOWN: [Part; 9] = {
        use Part::{Friction, Gel, Relaxation, Smooth, Stage, Support, Surface, Tilt, Walk};
        [
            Smooth, Gel, Support, Stage, Surface, Tilt, Friction, Relaxation, Walk,
        ]
    };

    /// The part that a person calls known, for a variant of it.
    fn name(self) -> Part {
        match self {
            Part::Broad => Part::Smooth,
            Part::UnevenFriction => Part::Friction,
            Part::Waves(_) | Part::Bump(_) => Part::Surface,
            Part::Sway(_) => Part::Walk,
            part => part,
        }
    }

    /// Which sweeps have it in common.
    ///
    /// Implements: ROB-030, ROB-033.
    pub fn shared_by(self) -> SharedBy {
        match self {
            Part::Gel | Part::Support => SharedBy::Gel,
            Part::Stage | Part::Surface | Part::Tilt | Part::Waves(_) | Part::Bump(_) => {
                SharedBy::Place
            }
            _ => SharedBy::None,
        }
    }
}

impl Class {
    /// What tells an inclusion from it.
    ///
    /// Implements: ROB-047.
    pub fn remedy(&self) -> &'static str {
        match self.parts[0].0 {
            Part::Surface | Part::Tilt | Part::Waves(_) | Part::Bump(_) => {
                "another sweep of the place, at 1 mm to find an inclusion, as deep as before to exclude one"
            }
            Part::Gel | Part::Support => "a reference sweep, or to know the gel better",
            _ => "more sweeps of the place, or less noise",
        }
    }

    /// The class from its first part on that is not `known`, which says what would help.
    ///
    /// Implements: ROB-047.
    pub fn beside(&self, known: &[Part]) -> Class {
        let is_unknown = |(part, _): &(Part, f64)| !known.contains(&part.name());
        let first = self.parts.iter().position(is_unknown).unwrap_or(0);
        Class {
            parts: &self.parts[first..],
            ..*self
        }
    }

    /// Its parts that are not `known`, with their sizes; none where what is left is another class.
    ///
    /// Implements: ROB-050.
    pub fn parts(&self, known: &[Part]) -> Option<Vec<(Part, f64)>> {
        let is_smooth = |(part, _): &(Part, f64)| *part == Part::Smooth;
        let is_left = |(part, size): &(Part, f64)| {
            !known.contains(&part.name()) || *size <= SMALL && *part == Part::Smooth
        };
        let left: Vec<_> = self.parts.iter().copied().filter(is_left).collect();
        let has_own = |parts: &[(Part, f64)]| parts.iter().any(|part| !is_smooth(part));
        let first = self.parts[0].0;
        let is_other = first != first.name() && known.contains(&first.name())
            || left.is_empty()
            || has_own(self.parts) && !has_own(&left);
        (!is_other).then_some(left)
    }
}

impl<'a> Disturbances<'a> {
    /// Those of a sweep.
    pub fn new(modes: &'a Modes, sweep: &'a Undisturbed) -> Disturbances<'a> {
        let normal = channels(&sweep.forces).normal;
        let level = normal.iter().map(|force| force.abs()).sum::<f64>() / normal.len() as f64;
        let smooth = kernel(modes, sweep, &SMOOTH);
        Disturbances {
            modes,
            sweep,
            smooth,
            level,
        }
    }

    /// Σ of what may be in every class: offset, drift and gain; errors of depths that were measured.
    ///
    /// Implements: ROB-082.
    pub fn always(&self) -> Covariance {
        let offset = if self.sweep.is_zeroed { ZEROED } else { OFFSET };
        let both = |size: f64, of: &dyn Fn(usize) -> f64| {
            let scaled = |at: usize| size * of(at);
            [self.channel(true, &scaled), self.channel(false, &scaled)]
        };
        let mut vectors = Vec::from(both(offset, &|_| 1.0));
        vectors.extend(both(DRIFT, &|at| self.modes.u[at]));
        vectors.push(self.stacked(&self.sweep.forces, |_| GAIN));
        // So that a record without noise has a density too.
        let count = self.modes.count();
        let rest = DMatrix::identity(count, count);
        let mut rest = self.rest(&rest, ROUNDING * ROUNDING, ROUNDING * ROUNDING);
        if !self.sweep.zero_error.is_empty() {
            vectors.push(self.stacked(&self.sweep.zero_error, |_| 1.0));
        }
        if !self.sweep.depth_noise.is_empty() {
            rest.rest += self.modes.of_errors(channels(&self.sweep.depth_noise));
        }
        Covariance { vectors, ..rest }
    }

    /// A part of size 1.
    pub fn part(&self, part: Part) -> Covariance {
        let sweep = self.sweep;
        let radius = sweep.radius;
        let normal = channels(&sweep.forces).normal;
        let faded = |at: usize, length: f64| libm::exp(-sweep.travelled[at] / (length * radius));
        // A part without directions, such as the support of a measured gel, is nothing of the right size.
        let modes = 2 * self.modes.count();
        let of = |vectors: Vec<DVector<f64>>| Covariance {
            vectors,
            rest: DMatrix::zeros(modes, modes),
        };
        let all = |series: &[Vec<f64>]| {
            series
                .iter()
                .map(|series| self.stacked(series, |_| 1.0))
                .collect()
        };
        match part {
            Part::Smooth => self.rest(&self.smooth, LATERAL, 1.0),
            Part::Broad => self.rest(&kernel(self.modes, sweep, &BROAD), LATERAL, 1.0),
            Part::Walk => {
                let samples = self.modes.samples();
                let way = |at: usize| sweep.travelled[at];
                let whole = f64::max(way(0), way(samples - 1));
                let walk = self
                    .modes
                    .covariance(|i, j| f64::min(way(i), way(j)) / whole);
                self.rest(&walk, 1.0, 1.0)
            }
            Part::Gel => {
                let mut vectors: Vec<_> = all(&sweep.gel);
                vectors.push(self.stacked(&sweep.slope, |at| sweep.depth_sd[at]));
                of(vectors)
            }
            Part::Support => of(all(&sweep.support)),
            Part::Stage => of((0..CURVES.len())
                .map(|number| self.curve(number, false))
                .collect()),
            Part::Surface => of((0..CURVES.len())
                .map(|number| self.curve(number, true))
                .collect()),
            Part::Tilt => of(vec![self.curve(0, false), self.curve(0, true)]),
            Part::Waves(band) => of(self.waves(WAVES[band])),
            Part::Bump(tenths) => of(vec![self.bump(tenths)]),
            Part::Sway(band) => {
                let sway = self.modes.covariance(|i, j| {
                    let apart = sweep.travelled[i] - sweep.travelled[j];
                    correlation(SWAYS[band], apart / radius)
                });
                self.rest(&sway, 1.0, 1.0)
            }
            Part::Friction => {
                let mut vectors = vec![
                    self.channel(true, &|at| 0.2 * normal[at]),
                    self.channel(false, &|at| 0.05 * sweep.forces[at]),
                ];
                vectors.extend(
                    FROM_REST.map(|length| {
                        self.channel(true, &|at| 0.1 * normal[at] * faded(at, length))
                    }),
                );
                let rubbed = self.rest(&kernel(self.modes, sweep, &RUBBED), RUBS * RUBS, 0.0);
                Covariance { vectors, ..rubbed }
            }
            Part::UnevenFriction => self.rest(&self.smooth, 1.0, 0.0),
            Part::Relaxation => {
                let relaxed = |length| self.stacked(&sweep.forces, |at| 0.1 * faded(at, length));
                of(RELAXING.map(relaxed).into())
            }
        }
    }

    /// Curve `number` of the stage, or of the surface.
    fn curve(&self, number: usize, is_surface: bool) -> DVector<f64> {
        let size = CURVES[number] * self.sweep.radius;
        self.height(|u| {
            let slope = if is_surface { slope(number, u) } else { 0.0 };
            [size * curve(number, u), size * slope]
        })
    }

    /// Waves of the surface with evenly spaced wavenumbers of a band, whose heights have a variance of one radius squared together.
    ///
    /// Implements: ROB-024.
    fn waves(&self, [middle, width]: Band) -> Vec<DVector<f64>> {
        let (radius, half) = (self.sweep.radius, self.sweep.half);
        let spaces = libm::round(width / BETWEEN_WAVES);
        let size = radius / libm::sqrt(spaces + 1.0);
        let wave = |at: usize| {
            let wavenumber = middle + width * (at as f64 / spaces - 0.5);
            let by_u = 2.0 * PI * wavenumber * half / radius;
            [0.0, 0.5 * PI].map(|phase| {
                self.height(|u| {
                    let at = by_u * u + phase;
                    [size * libm::sin(at), size * (by_u * libm::cos(at))]
                })
            })
        };
        (0..=spaces as usize).flat_map(wave).collect()
    }

    /// A bump as high as the radius of the probe.
    ///
    /// Implements: ROB-025.
    fn bump(&self, tenths: usize) -> DVector<f64> {
        let middle = 0.2 * tenths as f64 - 1.0;
        let by_u = self.sweep.half / (BUMP * self.sweep.radius);
        self.height(|u| {
            let off = by_u * (u - middle);
            let height = self.sweep.radius * libm::exp(-0.5 * off * off);
            [height, -height * off * by_u]
        })
    }

    /// What a height, m, and its derivative by u add, whose slope turns the force. A stage has no slope.
    fn height(&self, of: impl Fn(f64) -> [f64; 2]) -> DVector<f64> {
        let (sweep, samples) = (self.sweep, self.modes.samples());
        let Force { lateral, normal } = channels(&sweep.forces);
        let value = |at: usize| {
            let (sample, channel) = (at % samples, at / samples);
            let [height, by_u] = of(sweep.u[sample]);
            let turned = [-normal[sample], lateral[sample]][channel];
            sweep.slope[at] * height + by_u / sweep.half * turned
        };
        let curved: Vec<f64> = (0..2 * samples).map(value).collect();
        self.modes.of(channels(&curved))
    }

    /// A covariance of both channels, over the square of the mean normal force.
    fn rest(&self, of: &DMatrix<f64>, lateral: f64, normal: f64) -> Covariance {
        let count = self.modes.count();
        let mut rest = DMatrix::zeros(2 * count, 2 * count);
        let square = self.level * self.level;
        rest.view_mut((0, 0), (count, count))
            .copy_from(&(of * (lateral * square)));
        rest.view_mut((count, count), (count, count))
            .copy_from(&(of * (normal * square)));
        Covariance {
            vectors: Vec::new(),
            rest,
        }
    }

    /// The shape that the signal may have beside that of the map, for a signal of 1 N.
    pub fn shape(&self) -> DMatrix<f64> {
        self.rest(&self.smooth, LATERAL, 1.0).rest / (self.level * self.level)
    }

    /// A series in one channel alone.
    fn channel(&self, is_lateral: bool, value: &dyn Fn(usize) -> f64) -> DVector<f64> {
        let samples = self.modes.samples();
        let series: Vec<f64> = (0..samples).map(value).collect();
        let none = vec![0.0; samples];
        let both = if is_lateral {
            Force::new(&series, &none)
        } else {
            Force::new(&none, &series)
        };
        self.modes.of(both.map(|channel| &channel[..]))
    }

    /// A series in both channels, each sample times a factor.
    fn stacked(&self, series: &[f64], factor: impl Fn(usize) -> f64) -> DVector<f64> {
        let samples = self.modes.samples();
        let scaled = series
            .iter()
            .enumerate()
            .map(|(at, force)| force * factor(at % samples));
        let scaled: Vec<f64> = scaled.collect();
        self.modes.of(channels(&scaled))
    }
}

/// The mean of Gaussian kernels of these lengths, over the radius of the probe.
fn kernel(modes: &Modes, sweep: &Undisturbed, lengths: &[f64]) -> DMatrix<f64> {
    let square = |length: &f64| (length * sweep.radius) * (length * sweep.radius);
    let squares: Vec<f64> = lengths.iter().map(square).collect();
    modes.covariance(|i, j| {
        let apart = sweep.travelled[i] - sweep.travelled[j];
        let kernel = |square: &f64| libm::exp(-0.5 * apart * apart / square);
        let kernel = squares.iter().map(kernel).sum::<f64>() / squares.len() as f64;
        sweep.share[i] * sweep.share[j] * kernel
    })
}

/// The correlation of sines, whose wavenumbers are anywhere in a band, over a distance in radii of the probe.
///
/// Implements: ROB-024.
fn correlation([middle, width]: Band, apart: f64) -> f64 {
    let within = PI * width * apart;
    let sinc = if within == 0.0 {
        1.0
    } else {
        libm::sin(within) / within
    };
    sinc * libm::cos(2.0 * PI * middle * apart)
}

/// A curve along the sweep, u from −1 to 1.
///
/// Implements: ROB-023.
fn curve(number: usize, u: f64) -> f64 {
    match number {
        0 => u,
        1 => u * u,
        2 => u * u * u,
        3 => libm::cos(PI * u),
        4 => libm::sin(PI * u),
        5 => libm::cos(2.0 * PI * u),
        _ => libm::sin(2.0 * PI * u),
    }
}

/// Its derivative by u.
fn slope(number: usize, u: f64) -> f64 {
    match number {
        0 => 1.0,
        1 => 2.0 * u,
        2 => 3.0 * u * u,
        3 => -PI * libm::sin(PI * u),
        4 => PI * libm::cos(PI * u),
        5 => -2.0 * PI * libm::sin(2.0 * PI * u),
        _ => 2.0 * PI * libm::cos(2.0 * PI * u),
    }
}

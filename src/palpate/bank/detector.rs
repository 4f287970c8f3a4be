//! The likelihood ratio of each point of a bank, beside nuisances.

use std::sync::OnceLock;

use super::axis::signal_at;
use super::cells::Cells;
use crate::detect::DetectError;
use crate::detect::mixture::mixture_theta;
use crate::detect::nuisance::{NoiseLevel, Nuisances, SubspaceStatistic, SubspaceTest, dot};
use crate::stats::error::{check_positive, check_samples, representable};

/// Of a record whose level of noise is unknown at least this share of its squares is taken for noise: less is rounding.
///
/// Implements: BNK-031.
const LEAST_NOISE: f64 = 1e-12;

/// The bank's templates, projected off the nuisances, for records sampled at the same positions. Records and templates are whitened:
/// both channels one after the other, each sample divided by the standard deviation of its noise.
///
/// Implements: BNK-031.
#[derive(Debug, Clone)]
pub struct BankDetector {
    /// An orthonormal basis of what the nuisances add.
    basis: Vec<f64>,
    samples: usize,
    pub(super) level: NoiseLevel,
    degrees: f64,
    /// Pδ of one point after the other.
    templates: Vec<f64>,
    /// |Pδ|, 0 where the nuisances explain all.
    gamma: Vec<f64>,
    bias: Vec<f64>,
    /// What a nuisance within its tolerance adds to a record.
    pub(super) deviations: Vec<Vec<f64>>,
    prior: Vec<f64>,
    axes: [Vec<f64>; 4],
    cells: OnceLock<Cells>,
}

/// The first of `points`, as numbers, whose θ is largest.
pub(crate) fn likeliest(theta: &[f64], points: impl Iterator<Item = usize>) -> Option<usize> {
    points.reduce(|best, next| match theta[next] > theta[best] {
        true => next,
        false => best,
    })
}

/// The probability of each hypothesis if one is true: π_k exp(θ_k), over the sum of all.
pub(crate) fn shares(theta: &[f64], prior: &[f64]) -> Vec<f64> {
    let may_be = (0..theta.len()).filter(|&number| prior[number] > 0.0);
    // As in the mixture: no exponent of a hypothesis that may be true is above 0.
    let largest = likeliest(theta, may_be).map_or(0.0, |number| theta[number]);
    let weight = |(prior, theta): (&f64, &f64)| match *prior {
        0.0 => 0.0,
        prior => prior * libm::exp(theta - largest),
    };
    let weights: Vec<f64> = prior.iter().zip(theta).map(weight).collect();
    let whole: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / whole).collect()
}

/// What a record says of each point.
#[derive(Debug, Clone, PartialEq)]
pub struct BankStatistic {
    /// Pz.
    pub(super) left: Vec<f64>,
    /// (Pδ)ᵀz of each point.
    pub(super) along: Vec<f64>,
    /// |Pz|².
    pub(super) squares: f64,
    /// ln of the likelihood ratio of each point, 0 where the nuisances explain its signal.
    pub theta: Vec<f64>,
}

impl BankDetector {
    /// The detector of `templates`, one for each point of a bank with `axes` in its order, one after the other. `prior` has the
    /// probability of each point given an inclusion; `nuisances` are signals of unknown amplitude, one after the other; `deviations` are what a nuisance within its tolerance adds to a record.
    ///
    /// # Errors
    /// Lengths that do not fit; NaN or infinity; a prior that does not add up to 1; fewer samples than nuisances and two; no point of which
    /// the nuisances leave something.
    ///
    /// Implements: BNK-031, BNK-033.
    pub fn new(
        axes: &[Vec<f64>; 4],
        mut templates: Vec<f64>,
        prior: &[f64],
        mut nuisances: Vec<f64>,
        deviations: &[Vec<f64>],
        level: NoiseLevel,
    ) -> Result<BankDetector, DetectError> {
        let points: usize = axes.iter().map(Vec::len).product();
        let samples = templates.len() / points.max(1);
        check_samples("template", &templates, points * samples)?;
        // Also whether the prior is one.
        mixture_theta(&vec![0.0; points], prior)?;
        let space = Nuisances::new(&mut nuisances, samples)?;
        let rank = space.rank().get();
        let degrees = (samples as f64 - 1.0) - rank as f64;
        check_positive("degrees of freedom", degrees)?;
        let all = templates.chunks_exact_mut(samples);
        let gamma = all.map(|template| space.project(template));
        let gamma = gamma.collect::<Result<Vec<f64>, _>>()?;
        nuisances.truncate(rank * samples);
        let mut points = gamma.iter().zip(prior);
        if !points.any(|(gamma, prior)| *gamma > 0.0 && *prior > 0.0) {
            return Err(DetectError::NoSignal);
        }
        let mut detector = BankDetector {
            basis: nuisances,
            samples,
            level,
            degrees,
            templates,
            bias: vec![0.0; gamma.len()],
            gamma,
            deviations: deviations.to_vec(),
            prior: prior.to_vec(),
            axes: axes.clone(),
            cells: OnceLock::new(),
        };
        for deviation in deviations {
            for point in 0..detector.gamma.len() {
                detector.add_bias(point, deviation)?;
            }
        }
        Ok(detector)
    }

    /// Counts in the bias of a point what a nuisance within its tolerance adds to a record, or to one with the inclusion there.
    ///
    /// # Errors
    /// Another length than the templates'; NaN or infinity; overflow.
    ///
    /// Implements: BNK-066.
    pub fn add_bias(&mut self, point: usize, deviation: &[f64]) -> Result<(), DetectError> {
        check_samples("deviation", deviation, self.samples)?;
        let gamma = self.gamma[point];
        if gamma > 0.0 {
            let along = dot(self.template(point), deviation) / gamma;
            self.bias[point] = f64::max(self.bias[point], representable("bias", along)?.abs());
        }
        Ok(())
    }

    /// What a whitened residual (F_p − F_0)/s says of each point; the residual becomes what the nuisances leave of it.
    ///
    /// # Errors
    /// Another length than the templates'; NaN or infinity; overflow.
    ///
    /// Implements: BNK-031, BNK-033.
    pub fn statistic(&self, residual: &mut [f64]) -> Result<BankStatistic, DetectError> {
        check_samples("residual", residual, self.samples)?;
        let length = Nuisances::of_basis(&self.basis, self.samples).project(residual)?;
        let squares = representable("residual", length * length)?;
        if self.level == NoiseLevel::Unknown {
            check_positive("noise of the residual", squares)?;
        }
        let templates = self.templates.chunks_exact(self.samples);
        let along: Vec<f64> = templates.map(|template| dot(template, residual)).collect();
        let pairs = along.iter().zip(&self.gamma);
        let theta = pairs.map(|(along, gamma)| {
            let theta = self.theta(along - 0.5 * gamma * gamma, squares);
            representable("theta", theta)
        });
        let theta = theta.collect::<Result<_, _>>()?;
        Ok(BankStatistic {
            left: residual.to_vec(),
            along,
            squares,
            theta,
        })
    }

    /// θ of a signal Δ from (Pδ)ᵀz − |Pδ|²/2 and |Pz|².
    ///
    /// Implements: NUI-007.
    pub(super) fn theta(&self, gain: f64, squares: f64) -> f64 {
        match self.level {
            NoiseLevel::Known => gain,
            NoiseLevel::Unknown => {
                let explained = f64::min(2.0 * gain / squares, 1.0 - LEAST_NOISE);
                -0.5 * (self.degrees + 1.0) * libm::log1p(-explained)
            }
        }
    }

    /// T with its law for one point; `None` where the nuisances explain its signal.
    ///
    /// # Errors
    /// A record without noise, of an unknown level.
    pub fn test(
        &self,
        statistic: &BankStatistic,
        point: usize,
    ) -> Option<Result<SubspaceTest, DetectError>> {
        let gamma = self.gamma[point];
        let t = statistic.along[point] / gamma;
        let of_point = SubspaceStatistic {
            t,
            gamma,
            residual: f64::max(statistic.squares - t * t, 0.0),
            degrees: self.degrees,
        };
        (gamma > 0.0).then(|| of_point.test(self.level, self.bias[point]))
    }

    /// T with its law for each of [`BankDetector::points`].
    ///
    /// # Errors
    /// As [`BankDetector::test`].
    pub fn tests(&self, statistic: &BankStatistic) -> Result<Vec<SubspaceTest>, DetectError> {
        let tests = self.points();
        let tests = tests.filter_map(|point| self.test(statistic, point));
        tests.collect()
    }

    /// The points that can be told from no inclusion, and may be there by the prior.
    pub fn points(&self) -> impl Iterator<Item = usize> {
        let counts = |&point: &usize| self.gamma[point] > 0.0 && self.prior[point] > 0.0;
        (0..self.gamma.len()).filter(counts)
    }

    /// The first point of the largest θ.
    pub fn likeliest(&self, statistic: &BankStatistic) -> usize {
        // `new` has seen that there is one.
        likeliest(&statistic.theta, self.points()).unwrap_or(0)
    }

    /// ln of the likelihood ratio of an inclusion at any point, with their prior.
    ///
    /// # Errors
    /// As [`mixture_theta`].
    ///
    /// Implements: BNK-034.
    pub fn mixture(&self, statistic: &BankStatistic) -> Result<f64, DetectError> {
        mixture_theta(&statistic.theta, &self.prior)
    }

    /// γ of each point beside the nuisances.
    pub fn gamma(&self) -> &[f64] {
        &self.gamma
    }

    /// The prior of each point.
    pub fn prior(&self) -> &[f64] {
        &self.prior
    }

    /// Samples of both channels.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// The cells between the points, which take much longer than the detector, and are not always wanted.
    pub(super) fn cells(&self) -> &Cells {
        let new = || Cells::new(&self.axes, &self.templates, self.samples);
        self.cells.get_or_init(new)
    }

    /// Pδ of a point.
    pub(super) fn template(&self, point: usize) -> &[f64] {
        &self.templates[point * self.samples..][..self.samples]
    }

    /// Pδ between the points, at the parameters `at` in the order of [`super::Parameter::ALL`].
    pub fn template_at(&self, at: [f64; 4]) -> Vec<f64> {
        let sample = |point: usize, sample: usize| self.template(point)[sample];
        signal_at(&self.axes, at, self.samples, sample)
    }
}

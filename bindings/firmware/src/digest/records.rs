//! Questions about records of 8 samples a channel: in white noise, at every shift, beside nuisances, in coloured noise and row by row.

use core::fmt::Debug;

use palpate_core::detect::coloured::{ColouredStatistic, coloured_scratch, theta_coloured};
use palpate_core::detect::nuisance::{NoiseLevel, Nuisances, SubspaceDetector};
use palpate_core::detect::scan::{Scan, ScanMaximum};
use palpate_core::detect::sequential::{Sequential, Wald, memory};
use palpate_core::detect::{DetectError, MatchedFilter, Statistic, theta_of_record};
use palpate_core::force::Force;

use super::draw::Draw;

const N: usize = 8;

fn lists<const SAMPLES: usize>(series: &Force<[f64; SAMPLES]>) -> Force<&[f64]> {
    series.as_ref().map(|samples| &samples[..])
}

fn noise(draw: &mut Draw) -> Force<f64> {
    Force::new(draw.number(0.01, 2.0), draw.number(0.01, 2.0))
}

pub fn filtered(draw: &mut Draw) -> Result<impl Debug, DetectError> {
    let (template, residual) = (draw.series::<N>(), draw.series::<N>());
    let filter = MatchedFilter::new(lists(&template), noise(draw))?;
    Ok((
        filter.b(),
        filter.sigma(),
        filter.statistic(lists(&residual)),
    ))
}

pub fn theta(draw: &mut Draw) -> Result<Statistic, DetectError> {
    let [observed, f0, f1] = [(); 3].map(|()| draw.series::<N>());
    theta_of_record(lists(&observed), lists(&f0), lists(&f1), noise(draw))
}

/// Θ of a template of 3 samples at each shift, and the largest.
pub fn scanned(draw: &mut Draw) -> Result<([f64; N + 2], ScanMaximum), DetectError> {
    let (template, residual) = (draw.series::<3>(), draw.series::<N>());
    let scan = Scan::new(N, lists(&template), noise(draw))?;
    let mut theta = [0.0; N + 2];
    scan.theta(lists(&residual), -2, &mut theta)?;
    Ok((theta, scan.maximum(lists(&residual), scan.shifts())?))
}

/// T beside two nuisances, and its test with the level of the noise known and unknown.
pub fn beside_nuisances(draw: &mut Draw) -> Result<impl Debug, DetectError> {
    let Force {
        mut lateral,
        mut normal,
    } = draw.series::<N>();
    let mut signals = draw.series::<N>().into_array();
    let nuisances = Nuisances::new(signals.as_flattened_mut(), N)?;
    let detector = SubspaceDetector::new(nuisances, &mut lateral)?;
    let statistic = detector.statistic(&mut normal)?;
    let (bias, eta, rate) = (draw.between(0.0, 0.5), draw.number(-5.0, 5.0), draw.rate());
    let tested = [NoiseLevel::Known, NoiseLevel::Unknown].map(|level| {
        let test = statistic.test(level, bias)?;
        let rates = test.rates(test.bayes_threshold(eta)?)?;
        let thresholds = [
            test.false_alarm_threshold(rate)?,
            test.miss_threshold(rate)?,
        ];
        Ok::<_, DetectError>((test, test.theta(), rates, thresholds))
    });
    Ok((statistic, tested))
}

/// θ and γ with a covariance AAᵀ and more on the diagonal.
pub fn in_coloured_noise(draw: &mut Draw) -> Result<ColouredStatistic, DetectError> {
    let roots = [(); N].map(|()| draw.series::<N>().lateral);
    let mut covariance =
        roots.map(|one| roots.map(|other| one.iter().zip(other).map(|(a, b)| a * b).sum()));
    for (row, entries) in covariance.iter_mut().enumerate() {
        entries[row] += draw.number(0.1, 1.0);
    }
    let Force { lateral, normal } = draw.series::<N>();
    let scratch = &mut [0.0; coloured_scratch(N)];
    theta_coloured(&lateral, &normal, covariance.as_flattened(), scratch)
}

/// What 8 rows say of three signals beside two nuisances, and Wald's test of it.
pub fn row_by_row(draw: &mut Draw) -> Result<impl Debug, DetectError> {
    let mut found = Sequential::new([0.0; memory(3, 2)], 3, 2)?;
    let pushed = [(); N].map(|()| {
        let [residual, nuisance, a, b, c] = [(); 5].map(|()| draw.number(-3.0, 3.0));
        found.push(residual, &[1.0, nuisance], &[a, b, c])
    });
    let test = Wald::new(draw.rate(), draw.rate());
    let mut evidence = found.evidence();
    let evidence = [(); 3].map(|()| evidence.next());
    let decided = evidence.map(|one| Some(test.ok()?.decide(one?.theta())));
    let counts = (found.rows(), found.missing(), found.rank());
    Ok((pushed, evidence, found.residual(), counts, test, decided))
}

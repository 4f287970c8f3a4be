//! Laws of the detector that hold for every record.

use palpate::detect::coloured::{coloured_scratch, theta_coloured};
use palpate::detect::scan::Scan;
use palpate::detect::{
    Costs, Decision, MatchedFilter, bayes_threshold, decide, error_rates, gamma_from_two_afc,
    map_threshold, neyman_pearson_false_alarm_threshold, neyman_pearson_miss_threshold, posterior,
    required_gamma, roc_miss, theta_of_record, two_afc,
};
use palpate::force::Force;
use palpate::stats::normal::{cdf, quantile, upper_tail};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Forces of a few newtons.
fn force() -> impl Strategy<Value = f64> {
    -5.0..5.0
}

/// `count` series of one length, 1 to 40 samples.
fn series(count: usize) -> impl Strategy<Value = Vec<Vec<f64>>> {
    (1_usize..40).prop_flat_map(move |samples| vec(vec(force(), samples), count))
}

fn noise() -> impl Strategy<Value = Force<f64>> {
    (0.01..3.0, 0.01..3.0).prop_map(|(x, y)| Force::new(x, y))
}

fn channels<'a>(x: &'a [f64], y: &'a [f64]) -> Force<&'a [f64]> {
    Force::new(x, y)
}

/// Σ (|rΔ| + Δ²/2)/s², the size that rounding errors of θ are in proportion to.
fn size(residual: Force<&[f64]>, template: Force<&[f64]>, sd: Force<f64>) -> f64 {
    let part = |r: &[f64], t: &[f64], s: f64| {
        let terms = r.iter().zip(t).map(|(r, t)| (r * t).abs() + 0.5 * t * t);
        terms.sum::<f64>() / (s * s)
    };
    part(residual.lateral, template.lateral, sd.lateral)
        + part(residual.normal, template.normal, sd.normal)
}

const U: f64 = f64::EPSILON / 2.0;

/// The same cases in every run, unless `PROPTEST_RNG_SEED` asks for others.
fn fixed() -> ProptestConfig {
    let mut config = ProptestConfig::default();
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(2026);
    }
    config
}

proptest! {
    #![proptest_config(fixed())]

    // Verifies: DET-013.
    #[test]
    fn gamma_is_free_of_the_weight_and_of_the_unit(s in series(2), sd in noise(), unit in 1e-3..1e3) {
        let filter = MatchedFilter::new(channels(&s[0], &s[1]), sd).unwrap();
        // With any weight w: b² = wΣΔ², σ² = w s². The library has w = 1/N; here it is 1.
        let energy = |t: &[f64], s: f64| t.iter().map(|t| t * t).sum::<f64>() / (s * s);
        let expected = (energy(&s[0], sd.lateral) + energy(&s[1], sd.normal)).sqrt();
        prop_assert!((filter.gamma() - expected).abs() <= 1e-13 * expected);
        let (b, sigma) = (filter.b(), filter.sigma());
        let by_parts = ((b.lateral / sigma.lateral).powi(2) + (b.normal / sigma.normal).powi(2)).sqrt();
        prop_assert!((filter.gamma() - by_parts).abs() <= 1e-14 * expected);
        let scaled: Vec<Vec<f64>> =
            s.iter().map(|s| s.iter().map(|t| t * unit).collect()).collect();
        let scaled = MatchedFilter::new(channels(&scaled[0], &scaled[1]), sd.map(|s| s * unit)).unwrap();
        prop_assert!((filter.gamma() - scaled.gamma()).abs() <= 1e-14 * expected);
    }

    // Verifies: DET-015.
    #[test]
    fn exchanging_the_hypotheses_changes_the_sign_of_theta(s in series(6), sd in noise()) {
        let theta = |a: usize, b: usize| {
            theta_of_record(channels(&s[0], &s[1]), channels(&s[a], &s[a + 1]), channels(&s[b], &s[b + 1]), sd)
                .unwrap()
        };
        let (forth, back) = (theta(2, 4), theta(4, 2));
        let r: Vec<Vec<f64>> = (0..2)
            .map(|c| s[c].iter().zip(&s[c + 2]).map(|(p, f)| p - f).collect())
            .collect();
        let t: Vec<Vec<f64>> = (2..4)
            .map(|c| s[c + 2].iter().zip(&s[c]).map(|(b, a)| b - a).collect())
            .collect();
        let size = size(channels(&r[0], &r[1]), channels(&t[0], &t[1]), sd);
        prop_assert!((forth.theta + back.theta).abs() <= 16.0 * U * size);
        prop_assert!((forth.gamma - back.gamma).abs() <= 8.0 * U * forth.gamma);
        // And the posterior of the one is that of the other's complement.
        let (theta, prior) = (forth.theta.clamp(-30.0, 30.0), 0.3);
        let sum = posterior(theta, prior).unwrap() + posterior(-theta, 1.0 - prior).unwrap();
        prop_assert!((sum - 1.0).abs() <= 64.0 * U);
    }

    // Verifies: DET-014, DET-015.
    #[test]
    fn theta_is_the_log_likelihood_ratio(s in series(6), sd in noise()) {
        // ln p(F_p|1) − ln p(F_p|0) from the two sums of squares, which is how a statistician would
        // write it.
        let sum = |c: usize, h: usize, s_c: f64| {
            s[c].iter().zip(&s[c + 2 * h]).map(|(p, f)| (p - f).powi(2)).sum::<f64>() / (s_c * s_c)
        };
        let (h0, h1) = (sum(0, 1, sd.lateral) + sum(1, 1, sd.normal), sum(0, 2, sd.lateral) + sum(1, 2, sd.normal));
        let found =
            theta_of_record(channels(&s[0], &s[1]), channels(&s[2], &s[3]), channels(&s[4], &s[5]), sd).unwrap();
        prop_assert!((found.theta - 0.5 * (h0 - h1)).abs() <= 100.0 * U * (h0 + h1));
    }

    // Verifies: DET-005, CON-007.
    #[test]
    fn no_bad_sample_goes_unseen(s in series(4), sd in noise(), which in 0_usize..4, at in 0_usize..40, bad in 0_usize..3) {
        let mut s = s;
        let at = at % s[0].len();
        s[which][at] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][bad];
        let found = MatchedFilter::new(channels(&s[0], &s[1]), sd)
            .and_then(|filter| filter.statistic(channels(&s[2], &s[3])));
        prop_assert!(found.is_err());
    }

    // Verifies: DET-027.
    #[test]
    fn operating_characteristic_is_monotone_and_convex(gamma in 0.01..6.0, p in 0.001..0.997, step in 0.0001..0.001) {
        let miss = |p| roc_miss(gamma, p).unwrap();
        let (left, middle, right) = (miss(p), miss(p + step), miss(p + 2.0 * step));
        prop_assert!(left > middle && middle > right);
        prop_assert!(left + right - 2.0 * middle >= -32.0 * U);
        prop_assert!(miss(p) < 1.0 - p, "better than guessing");
        prop_assert!(roc_miss(gamma + 0.01, p).unwrap() < left, "better with a stronger signal");
    }

    // Verifies: DET-022, DET-025, DET-026, DET-027.
    #[test]
    fn thresholds_keep_the_rates_that_they_promise(gamma in 0.05..8.0, rate in 1e-6..0.999) {
        let eta = neyman_pearson_false_alarm_threshold(gamma, rate).unwrap();
        let rates = error_rates(gamma, eta).unwrap();
        // η is rounded by up to 4u (γ² + γ|Φ⁻¹|), in units of γ; Φ changes by less than 5 (1 + |z|)
        // of itself for each unit.
        let doubt = 1e-13 * (1.0 + gamma / 0.05);
        prop_assert!((rates.false_alarm - rate).abs() <= doubt * rate.max(1e-3));
        prop_assert!((rates.miss - roc_miss(gamma, rate).unwrap()).abs() <= doubt);
        let eta = neyman_pearson_miss_threshold(gamma, rate).unwrap();
        prop_assert!((error_rates(gamma, eta).unwrap().miss - rate).abs() <= doubt * rate.max(1e-3));
    }

    // Verifies: DET-027, DET-026.
    #[test]
    fn required_gamma_meets_both_rates_at_one_threshold(alpha in 1e-6..0.49, beta in 1e-6..0.49) {
        let gamma = required_gamma(alpha, beta).unwrap();
        prop_assert!((roc_miss(gamma, alpha).unwrap() - beta).abs() <= 1e-13);
        let one = neyman_pearson_false_alarm_threshold(gamma, alpha).unwrap();
        let other = neyman_pearson_miss_threshold(gamma, beta).unwrap();
        prop_assert!((one - other).abs() <= 64.0 * U * (1.0 + gamma * gamma + gamma * 5.0));
    }

    // Verifies: DET-020, DET-021, DET-022.
    #[test]
    fn map_and_bayes_decide_by_posterior_and_expected_cost(
        theta in -20.0..20.0, prior in 1e-4..0.9999, c10 in 0.1..100.0, c01 in 0.1..100.0,
    ) {
        let posterior = posterior(theta, prior).unwrap();
        let eta = map_threshold(prior).unwrap();
        if (theta - eta).abs() > 1e-9 {
            let says = decide(theta, eta).unwrap() == Decision::Inclusion;
            prop_assert_eq!(says, posterior > 0.5);
        }
        let costs = Costs { c00: 0.0, c01, c10, c11: 0.0 };
        let eta = bayes_threshold(prior, costs).unwrap();
        if (theta - eta).abs() > 1e-9 {
            let says = decide(theta, eta).unwrap() == Decision::Inclusion;
            prop_assert_eq!(says, posterior * c01 > (1.0 - posterior) * c10);
        }
    }

    // Verifies: DET-027.
    #[test]
    fn forced_choice_inverts_and_is_the_area_under_the_curve(gamma in 0.0..6.0) {
        let p = two_afc(gamma).unwrap();
        // An ulp of p is u/φ of γ.
        let doubt = 8.0 * U * (1.0 + (0.25 * gamma * gamma).exp());
        prop_assert!((gamma_from_two_afc(p).unwrap() - gamma).abs() <= 4.0 * doubt);
        // ∫ (1 − P_miss) dP_fa by the midpoint rule: the integrand's slope is unbounded at 0, so
        // the error is about √h.
        let area: f64 = (0..2000)
            .map(|i| 1.0 - roc_miss(gamma, (f64::from(i) + 0.5) / 2000.0).unwrap())
            .sum::<f64>() / 2000.0;
        prop_assert!((two_afc(gamma).unwrap() - area).abs() < 1e-3);
    }

    // Verifies: DET-001.
    #[test]
    fn quantile_inverts_the_distribution(x in -37.0..8.0) {
        let p = cdf(x).unwrap();
        prop_assert_eq!(upper_tail(-x), Ok(p));
        // 4 ULP of p are 4·2u p/φ(x) of x, and 4 ULP of x.
        let density = palpate::stats::normal::density(x).unwrap();
        let doubt = 8.0 * U * (p / density + x.abs());
        prop_assert!((quantile(p).unwrap() - x).abs() <= doubt);
    }

    // Verifies: DET-040, DET-041.
    #[test]
    fn whitening_equals_a_direct_solve(
        root in vec(vec(-1.0..1.0, 6), 6), template in vec(force(), 6), residual in vec(force(), 6),
    ) {
        // K = AAᵀ + ½: symmetric, and its condition number is at most 2·36 + 1.
        let order = 6;
        let mut covariance = vec![0.0; 36];
        for i in 0..order {
            for j in 0..order {
                let sum: f64 = (0..order).map(|k| root[i][k] * root[j][k]).sum();
                covariance[i * order + j] = sum + if i == j { 0.5 } else { 0.0 };
            }
        }
        let found =
            theta_coloured(&residual, &template, &covariance, &mut vec![0.0; coloured_scratch(order)]).unwrap();
        let weights = solve(covariance, template.clone());
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let square = dot(&weights, &template);
        let theta = dot(&weights, &residual) - 0.5 * square;
        // 73 · (6 steps of 6 roundings) · u, in proportion to |w|·(|r| + |Δ|).
        let size: f64 = weights.iter().zip(residual.iter().zip(&template))
            .map(|(w, (r, t))| (w * r).abs() + (w * t).abs()).sum();
        let doubt = 73.0 * 36.0 * 4.0 * U * (size + square);
        prop_assert!((found.theta - theta).abs() <= doubt);
        prop_assert!((found.gamma * found.gamma - square).abs() <= doubt);
    }

    // Verifies: DET-050, DET-053, DET-054.
    #[test]
    fn scan_follows_a_shift_of_the_record(
        template in vec((0.1..1.0_f64, -1.0..1.0_f64), 1..8), noise in vec((force(), force()), 10..30), by in 1_usize..10, sd in noise(),
    ) {
        let (x, y): (Vec<f64>, Vec<f64>) = template.into_iter().unzip();
        let (mut rx, mut ry): (Vec<f64>, Vec<f64>) = noise.into_iter().unzip();
        // Zeros at either end leave every shift's overlap as it was.
        let pad = 20;
        for r in [&mut rx, &mut ry] {
            r.splice(0..0, vec![0.0; pad]);
            r.extend(vec![0.0; pad]);
        }
        let scan = Scan::new(rx.len(), channels(&x, &y), sd).unwrap();
        let here = scan.maximum(channels(&rx, &ry), scan.full_shifts()).unwrap();
        for r in [&mut rx, &mut ry] {
            r.rotate_right(by);
        }
        let there = scan.maximum(channels(&rx, &ry), scan.full_shifts()).unwrap();
        // A best place within the padding may wrap; elsewhere the bits must be the same.
        if here.shift < 10 || here.shift + 20 >= rx.len() as isize - x.len() as isize {
            return Ok(());
        }
        prop_assert_eq!(there.shift, here.shift + by as isize);
        prop_assert_eq!((there.theta, there.gamma), (here.theta, here.gamma));
        prop_assert!((there.refined_shift - here.refined_shift - by as f64).abs() < 1e-12);
    }

    // Verifies: DET-050, DET-052.
    #[test]
    fn a_template_as_long_as_the_record_is_the_plain_detector_at_shift_zero(s in series(4), sd in noise()) {
        let template = channels(&s[0], &s[1]);
        let residual = channels(&s[2], &s[3]);
        let scan = Scan::new(s[0].len(), template, sd).unwrap();
        let filter = MatchedFilter::new(template, sd).unwrap();
        let point = scan.maximum(residual, 0..=0).unwrap();
        prop_assert_eq!(point.gamma, filter.gamma());
        prop_assert_eq!(point.theta, filter.statistic(residual).unwrap().theta);
    }
}

/// The solution of a linear system by Gaussian elimination with pivoting.
fn solve(mut matrix: Vec<f64>, mut right: Vec<f64>) -> Vec<f64> {
    let order = right.len();
    for column in 0..order {
        let size = |row: usize| matrix[row * order + column].abs();
        let pivot = (column..order).max_by(|&a, &b| size(a).total_cmp(&size(b)));
        let pivot = pivot.unwrap();
        for k in 0..order {
            matrix.swap(pivot * order + k, column * order + k);
        }
        right.swap(pivot, column);
        for row in column + 1..order {
            let factor = matrix[row * order + column] / matrix[column * order + column];
            for k in column..order {
                matrix[row * order + k] -= factor * matrix[column * order + k];
            }
            right[row] -= factor * right[column];
        }
    }
    for row in (0..order).rev() {
        let known = (row + 1..order).map(|k| matrix[row * order + k] * right[k]);
        right[row] = (right[row] - known.sum::<f64>()) / matrix[row * order + row];
    }
    right
}

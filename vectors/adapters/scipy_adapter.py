"""The oracle's ops (spec/oracle.md) with the mathematics of SciPy and NumPy: `palpate-conform --profile f64 -- python scipy_adapter.py`.

Implements: ORA-071.
"""

import numpy as np
import scipy
import scipy_tables
from oracle_lines import (answer_lines, call, limited, listed, not_negative, positive, probability, real, refuse_if, rows, same_length,
                          series, text, whole)  # fmt: skip
from scipy import linalg, special, stats

share, size, degrees_of_freedom, centre = limited(0, 1), limited(0, 1e152), limited(0.1, 2e6), limited(0, 1e8)


# The normal law, thresholds and rates


def normal_cdf(x: real):
    return {"p": special.ndtr(x)}


def normal_quantile(p: probability):
    return {"x": special.ndtri(p)}


def two_afc(gamma: not_negative):
    return {"p_correct": special.ndtr(gamma / np.sqrt(2))}


def gamma_from_two_afc(p_correct: probability):
    return {"gamma": np.sqrt(2) * special.ndtri(p_correct)}


def error_rates(gamma: not_negative, eta: real):
    if gamma == 0:
        return {"false_alarm": float(eta <= 0), "miss": float(eta > 0)}
    return {"false_alarm": special.ndtr(-eta / gamma - gamma / 2), "miss": special.ndtr(eta / gamma - gamma / 2)}


def roc(gamma: not_negative, false_alarm: lambda value: listed(value, share)):
    refuse_if(not false_alarm, "bad_argument", "false_alarm holds no rates")
    inner = special.ndtr(-special.ndtri(false_alarm) - gamma)
    return {"miss": [1.0 - p if p in (0, 1) else miss for p, miss in zip(false_alarm, inner)], "auc": two_afc(gamma)["p_correct"]}


def required_gamma(max_false_alarm: probability, max_miss: probability):
    return {"gamma": max(0.0, -special.ndtri(max_false_alarm) - special.ndtri(max_miss))}


def noise_budget(signal_n: positive, max_false_alarm: probability, max_miss: probability, sources_n: lambda v: listed(v, not_negative)):
    gamma = required_gamma(max_false_alarm, max_miss)["gamma"]
    refuse_if(gamma == 0, "overflow", "any noise would do")
    total, used = signal_n / gamma, linalg.norm(sources_n)
    left = max(0.0, total - used) * (total + used)
    return {"gamma": gamma, "total_allowed_n": total, "remaining_n": np.sqrt(left)}


def by_map(prior_h1: probability):
    return {"eta": -special.logit(prior_h1)}


def by_bayes(prior_h1: probability, c00: real, c01: real, c10: real, c11: real):
    refuse_if(c10 <= c00 or c01 <= c11, "out_of_range", "a wrong decision must cost more than a right one")
    return {"eta": np.log((c10 - c00) / (c01 - c11)) - special.logit(prior_h1)}


def by_miss(gamma: not_negative, max_miss: probability):
    return {"eta": gamma * (gamma / 2 + special.ndtri(max_miss))}


def by_false_alarm(gamma: positive, max_false_alarm: probability):
    return {"eta": -gamma * (gamma / 2 + special.ndtri(max_false_alarm))}


CRITERIA = {"map": by_map, "bayes": by_bayes, "neyman_pearson_miss": by_miss, "neyman_pearson_false_alarm": by_false_alarm}


def threshold(criterion=None, **others):
    refuse_if(text(criterion) not in CRITERIA, "out_of_range", "no such criterion")
    return call(CRITERIA[criterion], others)


# Proportions and the laws of quadratic statistics


def proportion_interval(successes: whole, trials: whole, confidence: probability, method: text):
    k, n, tail = successes, trials, (1 - confidence) / 2
    refuse_if(not 0 <= k <= n or n < 1 or method not in ("wilson", "clopper_pearson"), "out_of_range", "no such counts or method")
    if method == "clopper_pearson":
        lower = special.betaincinv(k, n - k + 1, tail) if k > 0 else 0.0
        return {"lower": lower, "upper": special.betainccinv(k + 1, n - k, tail) if k < n else 1.0}
    z2, p = special.ndtri(tail) ** 2, k / n
    half = np.sqrt(z2 * (p * (1 - p) / n + z2 / (4 * n * n)))
    return {"lower": max(0.0, (p + z2 / (2 * n) - half) / (1 + z2 / n)), "upper": (p + z2 / (2 * n) + half) / (1 + z2 / n)}


def count_analysis(correct: rows, trials: whole):
    refuse_if(correct.size == 0 or np.any(correct % 1), "bad_argument", "correct must hold counts")
    refuse_if(trials < 1 or np.any(correct < 0) or np.any(correct > trials), "out_of_range", "correct must be in 0 … trials")
    subjects, pooled = len(correct), correct.sum(axis=0)
    rate = pooled / (subjects * trials)
    refuse_if(np.any((rate == 0) | (rate == 1)), "overflow", "γ of a rate of 0 or 1 is infinite")
    chi2 = ((correct - trials * rate) ** 2).sum(axis=0) / (trials * rate * (1 - rate))
    gamma = np.sqrt(2) * special.ndtri(rate)
    return {"pooled": pooled.astype(int), "rate": rate, "gamma": gamma, "chi2": chi2, "df": subjects - 1}


def chi_square_tail(x: size, degrees: degrees_of_freedom, noncentrality: centre):
    law = stats.ncx2(degrees, noncentrality) if noncentrality else stats.chi2(degrees)
    return {"lower": law.cdf(x), "upper": law.sf(x)}


def f_tail(x: size, numerator: degrees_of_freedom, denominator: degrees_of_freedom, noncentrality: centre):
    law = stats.ncf(numerator, denominator, noncentrality) if noncentrality else stats.f(numerator, denominator)
    return {"lower": law.cdf(x), "upper": law.sf(x)}


def student_tail(x: limited(-1e152, 1e152), degrees: degrees_of_freedom, noncentrality: limited(-1e4, 1e4)):
    law = stats.nct(degrees, noncentrality) if noncentrality else stats.t(degrees)
    return {"lower": law.cdf(x), "upper": law.sf(x)}


# The statistic


def matched_filter(template_x: series, template_y: series, noise_sd_x: positive, noise_sd_y: positive):
    same_length(template_x, template_y)
    root, b = np.sqrt(len(template_x)), [linalg.norm(template_x), linalg.norm(template_y)]
    gamma = np.hypot(b[0] / noise_sd_x, b[1] / noise_sd_y)
    sigma = {"sigma_x": noise_sd_x / root, "sigma_y": noise_sd_y / root}
    return {"b_x": b[0] / root, "b_y": b[1] / root, **sigma, "gamma": gamma}


def theta(observed_x: series, observed_y: series, f0_x: series, f0_y: series, f1_x: series, f1_y: series,
          noise_sd_x: positive, noise_sd_y: positive):  # fmt: skip
    same_length(observed_x, observed_y, f0_x, f0_y, f1_x, f1_y)
    found, y, gammas = 0.0, [], []
    for p, f0, f1, sd in ((observed_x, f0_x, f1_x, noise_sd_x), (observed_y, f0_y, f1_y, noise_sd_y)):
        r, d = (p - f0) / sd, (f1 - f0) / sd
        gammas.append(linalg.norm(d))
        y.append(r @ d / gammas[-1] * sd / np.sqrt(len(d)) if gammas[-1] else 0.0)
        found += (r - d / 2) @ d
    return {"theta": found, "y_x": y[0], "y_y": y[1], "gamma": np.hypot(*gammas)}


def theta_colored(residual: series, template: series, covariance: rows):
    n, k = len(residual), covariance
    refuse_if(n % 2 or k.shape != (n, n) or len(template) != n, "bad_argument", "the samples must be even in number, each with a row")
    variances = k.diagonal()
    refuse_if(np.any(variances <= 0), "out_of_range", "a variance is not above 0")
    sd = np.sqrt(variances)
    refuse_if(np.any(np.abs(k - k.T) > 1e-12 * np.outer(sd, sd)), "out_of_range", "the covariance is not symmetric")
    lower = linalg.cholesky(k, lower=True)
    refuse_if(np.any(lower.diagonal() ** 2 <= 8 * (n + 2) * 2.0**-53 * variances), "out_of_range", "the covariance is singular")
    r, d = linalg.solve_triangular(lower, np.column_stack((residual, template)), lower=True).T
    return {"theta": (r - d / 2) @ d, "gamma": linalg.norm(d)}


def scan(residual_x: series, residual_y: series, template_x: series, template_y: series, noise_sd_x: positive, noise_sd_y: positive):
    same_length(residual_x, residual_y)
    same_length(template_x, template_y)
    refuse_if(len(template_x) > len(residual_x), "bad_argument", "the template is longer than the record")
    channels = ((residual_x / noise_sd_x, template_x / noise_sd_x), (residual_y / noise_sd_y, template_y / noise_sd_y))
    found = sum(np.correlate(r, d, "valid") - d @ d / 2 for r, d in channels)
    return {"theta": found, "max_theta": found.max(), "argmax": found.argmax()}


# Nuisances (spec/nuisance.md)


class Subspace:
    """What the nuisances span (NUI-001)."""

    def __init__(self, signals, samples, least_degrees=1):
        refuse_if(len(signals) > 100 or any(len(s) != samples for s in signals), "bad_argument", "nuisances of another length, or over 100")
        self.basis, kept = np.zeros((samples, 0)), []
        for signal in (s / linalg.norm(s) for s in signals if s.any()):
            q, r = linalg.qr(np.column_stack([*kept, signal]), mode="economic")
            if len(r) > len(kept) and abs(r[-1, -1]) >= 1e-9:
                self.basis, kept = q, [*kept, signal]
        self.degrees = samples - len(kept) - 1
        refuse_if(self.degrees < least_degrees, "out_of_range", "p nuisances need p + 2 samples")

    def beside(self, v):
        for _ in range(2):
            v = v - self.basis @ (self.basis.T @ v)
        return v

    def statistic(self, residual, template, known):
        """T, γ, R, θ and σ̂, or None where the nuisances explain the template."""
        same_length(residual, template)
        z, d = self.beside(residual), self.beside(template)
        gamma, nu = linalg.norm(d), self.degrees
        if gamma <= 1e-9 * linalg.norm(template):
            return None
        t = (d / gamma) @ z
        rest = z - t * (d / gamma)
        left = rest @ rest
        refuse_if(not known and left == 0, "out_of_range", "a record without noise tells nothing of its level")
        scale = 1.0 if known else np.sqrt(left / nu)
        t, gamma = t / scale, gamma / scale
        ratio = gamma * (2 * t - gamma)
        theta = ratio / 2 if known else (nu + 1) / 2 * np.log1p(ratio / (nu + (t - gamma) ** 2))
        return t, gamma, left, theta, scale


def is_known(level):
    refuse_if(text(level) not in ("known", "unknown"), "out_of_range", "level is known or unknown")
    return level == "known"


def least_t(eta, gamma, nu):
    """The threshold of T (NUI-012) where the level is unknown."""
    over = np.expm1(2 * eta / (nu + 1))
    energy = (over + 1) * gamma**2
    square = energy - nu * over**2
    if not square >= 0:
        return np.copysign(np.inf, eta)
    return (energy + nu * over) / ((over + 1) * gamma + np.sqrt(square))


def theta_nuisances(residual: series, template: series, nuisances: rows, level: is_known, bias: not_negative, eta: real):
    space = Subspace(nuisances, len(residual))
    found = space.statistic(residual, template, level)
    refuse_if(found is None, "out_of_range", "the nuisances explain the template")
    t, gamma, left, theta, scale = found
    tau = eta / gamma + gamma / 2 if level else least_t(eta, gamma, space.degrees)
    above = lambda x: special.ndtr(-x) if level else special.stdtr(space.degrees, -x)
    rates = {"false_alarm": above(tau - bias / scale), "miss": above(gamma - bias / scale - tau)}
    return {"t": t, "gamma": gamma, "gamma_nominal": linalg.norm(template), "rank": space.basis.shape[1],
            "residual": left, "degrees": space.degrees, "theta": theta, **rates}  # fmt: skip


def bank_posterior(residual: series, templates: rows, nuisances: rows, level: is_known, prior: series, prior_h1: probability):
    same_length(prior, templates)
    refuse_if(np.any(prior < 0) or abs(prior.sum() - 1) > 1e-9, "out_of_range", "priors do not add up to 1")
    space = Subspace(nuisances, len(residual))
    found = [space.statistic(residual, template, level) for template in templates]
    theta = np.array([statistic[3] if statistic else 0.0 for statistic in found])
    possible = np.where([s is not None and p > 0 for s, p in zip(found, prior)], theta, -np.inf)
    refuse_if(np.all(possible == -np.inf), "out_of_range", "no template that can be")
    mixture = special.logsumexp(theta, b=prior)
    return {"theta": theta, "theta_mixture": mixture, "theta_max": possible.max(), "hypothesis": possible.argmax(),
            "posterior_h1": special.expit(mixture + special.logit(prior_h1)), "posterior": prior * np.exp(theta - mixture)}  # fmt: skip


def sequential_evidence(residual: series, templates: rows, nuisances: rows, max_false_alarm: probability, max_miss: probability):
    refuse_if(len(residual) == 0 or len(templates) == 0, "bad_argument", "no rows, or no templates")
    refuse_if(max_false_alarm + max_miss >= 1, "out_of_range", "the rates add up to 1 or more")
    nuisances, templates = (matrix.reshape(-1, len(residual)) for matrix in (nuisances, templates))
    ends = np.zeros((2, len(templates)), dtype=int)
    for end in range(1, len(residual) + 1):
        basis = Subspace(nuisances[:, :end], end, least_degrees=-1).basis
        beside = lambda values: values - (values @ basis) @ basis.T
        z, left = beside(beside(residual[:end])), beside(beside(templates[:, :end]))
        squares = np.sum(left**2, axis=1)
        is_left = squares > 1e-18 * np.sum(templates[:, :end] ** 2, axis=1)
        theta = np.where(is_left, left @ z - squares / 2, 0.0)
        goes_on = ends.sum(axis=0) == 0
        ends += end * goes_on * np.array([theta >= -np.log(max_false_alarm), theta <= np.log(max_miss)])
    return {"theta": theta, "gamma": np.sqrt(np.where(is_left, squares, 0.0)), "residual": z @ z, "rank": basis.shape[1],
            "inclusion_at": ends[0], "no_inclusion_at": ends[1]}  # fmt: skip


# Classes of disturbance (spec/robust.md)


def symmetric(name, matrix):
    sd = np.sqrt(np.abs(matrix.diagonal()))
    refuse_if(np.any(np.abs(matrix - matrix.T) > 1e-12 * np.outer(sd, sd)), "out_of_range", f"{name} is not symmetric")


def robust_evidence(record: series, noise: series, weights: series, covariances: rows, signals: rows, sizes: series, prior: series,
                    shape: rows):  # fmt: skip
    n, classes = len(record), len(weights)
    fits = len(noise) == n and covariances.shape == (classes * n, n) and signals.shape == (len(sizes), n) and shape.shape == (n, n)
    refuse_if(not fits or len(prior) != len(sizes), "bad_argument", "lengths differ")
    refuse_if(np.any(noise <= 0) or np.any(weights <= 0) or np.any(sizes < 1e-9), "out_of_range", "noise, weights and sizes are above 0")
    refuse_if(np.any(prior < 0) or abs(prior.sum() - 1) > 1e-9, "out_of_range", "priors do not add up to 1")
    symmetric("shape", shape)

    def law(mean, covariance):
        factor = stats.Covariance.from_cholesky(linalg.cholesky(covariance, lower=True))
        density = stats.multivariate_normal.logpdf(record, mean, factor) + n / 2 * np.log(2 * np.pi)
        return density, np.sum(factor.whiten(record - mean) ** 2)

    laws = []
    for covariance in covariances.reshape(classes, n, n):
        symmetric("a class", covariance)
        plain = covariance + np.diag(noise)
        beside = [plain + 0.16 * np.outer(m, m) + (0.15 * size) ** 2 * shape for m, size in zip(signals, sizes)]
        laws.append([law(np.zeros(n), plain), *map(law, signals, beside)])
    density, distance = np.moveaxis(np.array(laws), 2, 0)
    density += np.log(weights / weights.sum())[:, None]
    by_class = special.logsumexp(density[:, 1:], b=prior, axis=1)
    theta = special.logsumexp(by_class) - special.logsumexp(density[:, 0])
    return {"without": density[:, 0], "by_class": by_class, "with": special.logsumexp(density[:, 1:], axis=0), "theta": theta,
            "distance": distance.flat[density.argmax()]}  # fmt: skip


def capabilities():
    return {"version": f"SciPy {scipy.__version__}", "ops": sorted(OPS)}


OPS = {op.__name__: op for op in (
    capabilities, normal_cdf, normal_quantile, two_afc, gamma_from_two_afc, error_rates, roc, required_gamma, noise_budget, threshold,
    proportion_interval, count_analysis, chi_square_tail, f_tail, student_tail, matched_filter, theta, theta_colored, scan,
    theta_nuisances, bank_posterior, sequential_evidence, robust_evidence, *scipy_tables.OPS)}  # fmt: skip

if __name__ == "__main__":
    with np.errstate(all="ignore"):
        answer_lines(OPS)

"""Prints ledger.csv: python3 power.py > ledger.csv (needs numpy and scipy).

The power of every check against its defects, from the law that its statistic has under the defect; nothing is simulated, and
nothing comes from the Rust code. Powers are rounded down to 4 digits."""
import math
import pathlib

import numpy as np
from scipy.integrate import quad
from scipy.special import logsumexp
from scipy.stats import binom, chi2, f, nct, ncf, ncx2, norm, qmc, t

ALPHA = 2.5e-8
DEFECTS = ["variance_off_1_percent", "half_left_out", "template_shifted", "channels_swapped", "sd_for_variance"]


def coarse():
    x = np.array([0.02, 0.09, 0.16, 0.12, -0.12, -0.16, -0.09, -0.02])
    y = np.array([0.03, 0.10, 0.22, 0.33, 0.33, 0.22, 0.10, 0.03])
    return (x, y), (0.25, 0.4)


def single():
    return (np.array([-0.05]), np.array([0.0])), (0.1, 0.1)


def maps():
    """Forces of the finite elements without inclusion, and what it adds: 41 positions, interpolated linearly to 401 samples."""
    folder = pathlib.Path(__file__).parent
    without, inclusion = [np.loadtxt(folder / f"traverse_{name}.csv", delimiter=",", skiprows=1) for name in ("none", "4.6")]
    at, positions = np.arange(401) / 10, np.arange(41)
    return [[np.interp(at, positions, force[:, c]) for c in (3, 2)] for force in (without, inclusion - without)]


def traverse():
    return maps()[1], (0.5, 0.6615)


def laws(setting, inclusion, defect):
    """(mean, sd) of theta as it should be and with the defect."""
    truth, sds = setting
    used = truth[::-1] if defect == "channels_swapped" else truth
    if defect == "template_shifted":
        used = [np.concatenate([[0], t[:-1]]) for t in used]
    mean = variance = square = 0
    for template, true, s in zip(used, truth, sds):
        weight = template / (s if defect == "sd_for_variance" else s * s)
        half = 1 if defect == "half_left_out" else 0.5
        mean += np.sum(weight * ((true if inclusion else 0) - half * template))
        variance += np.sum(weight**2) * s * s * (1.01 if defect == "variance_off_1_percent" else 1)
        square += np.sum(true**2) / s**2
    return (square / 2 * (1 if inclusion else -1), math.sqrt(square)), (mean, math.sqrt(variance))


def mean_power(good, bad, n):
    z, shift, ratio = norm.isf(ALPHA / 2), (bad[0] - good[0]) * math.sqrt(n) / good[1], bad[1] / good[1]
    if ratio == 0:
        return float(abs(shift) > z)
    return norm.sf((z - shift) / ratio) + norm.cdf((-z - shift) / ratio)


def variance_power(good, bad, n):
    t = math.log(2 / ALPHA)
    shift2, v = ((bad[0] - good[0]) / good[1]) ** 2, (bad[1] / good[1]) ** 2
    excess, sd = n * (v + shift2 - 1), math.sqrt(n * (2 * v * v + 4 * v * shift2))
    upper, lower = 2 * math.sqrt(n * t) + 2 * t, -2 * math.sqrt(n * t)
    if sd == 0:
        return float(excess > upper or excess < lower)
    return norm.sf((upper - excess) / sd) + norm.cdf((lower - excess) / sd)


def distance_power(distance, n):
    return norm.cdf((distance * math.sqrt(n) - math.sqrt(math.log(2 / ALPHA) / 2)) / 0.5)


def kolmogorov_power(good, bad, n):
    x = np.linspace(good[0] - 8 * good[1], good[0] + 8 * good[1], 20001)
    return distance_power(np.max(np.abs(norm.cdf(x, *good) - norm.cdf(x, *bad))), n)


def count_power(p, bad, n):
    high, low = binom.isf(ALPHA / 2, n, p) + 1, binom.ppf(ALPHA / 2, n, p) - 1
    return binom.sf(high, n, bad) + binom.cdf(low - 1, n, bad)


def line(name, n, **powers):
    down = lambda p: math.floor(min(p, 1) * 1e4) / 1e4
    print(f"{name},{ALPHA},{n}," + ";".join(f"{defect}={down(power)}" for defect, power in powers.items()))


def gaussian(name, setting, inclusion, n, power, defects=DEFECTS):
    line(name, n, **{d: power(*laws(setting(), inclusion, d), n) for d in defects})


def false_alarm_power(alpha):
    return lambda good, bad, n: count_power(alpha, norm.sf(norm.isf(alpha, *good), *bad), n)


def miss_power(beta):
    return lambda good, bad, n: count_power(beta, norm.cdf(norm.ppf(beta, *good), *bad), n)


print("check,alpha,trials,powers")
gaussian("coarse_mean_h0", coarse, False, 200_000, mean_power)
gaussian("coarse_mean_h1", coarse, True, 200_000, mean_power)
gaussian("coarse_variance_h0", coarse, False, 2_000_000, variance_power)
gaussian("coarse_variance_h1", coarse, True, 200_000, variance_power)
gaussian("coarse_kolmogorov_h0", coarse, False, 200_000, kolmogorov_power)
gaussian("coarse_kolmogorov_h1", coarse, True, 200_000, kolmogorov_power)
gaussian("coarse_false_alarms_at_1_percent", coarse, False, 200_000, false_alarm_power(0.01))
gaussian("coarse_misses_at_5_percent", coarse, True, 200_000, miss_power(0.05))
one_channel = ["variance_off_1_percent", "half_left_out", "sd_for_variance"]
# 16 samples a record.
line("coarse_noise_variance", 200_000, variance_off_1_percent=variance_power((0, 1), (0, math.sqrt(1.01)), 16 * 200_000))
gaussian("single_mean_h1", single, True, 200_000, mean_power, one_channel)
gaussian("single_variance_h0", single, False, 200_000, variance_power, one_channel)
gaussian("traverse_mean_h1", traverse, True, 20_000, mean_power)
gaussian("traverse_variance_h0", traverse, False, 20_000, variance_power)
gaussian("traverse_false_alarms_at_5_percent", traverse, False, 20_000, false_alarm_power(0.05))

# Coloured noise of covariance K, judged as white noise of the same variance.
template = np.array([0.1, 0.3, 0.2, -0.2, -0.3, -0.1, 0.05, 0.15, 0.3, 0.34, 0.2, 0.1])
identity, swap = np.eye(12), np.kron(np.array([[0, 1], [1, 0]]), np.eye(6))
lag = np.abs(np.subtract.outer(np.arange(6), np.arange(6)))
both = lambda toeplitz: np.kron(np.eye(2), toeplitz)
for name, K in [
    ("shared_noise", 0.13 * identity + 0.09 * swap),
    ("feedback_noise", both(0.04 / 0.36 * 0.8**lag)),
    ("moving_average", both(np.where(lag == 0, 0.0656, np.where(lag == 1, 0.032, 0)))),
]:
    gamma2, white = template @ np.linalg.solve(K, template), template / K[0, 0]
    sd = math.sqrt(white @ K @ white)
    for suffix, inclusion, power in [("mean_h1", True, mean_power), ("variance_h0", False, variance_power)]:
        sign = 1 if inclusion else -1
        good, bad = (sign * gamma2 / 2, math.sqrt(gamma2)), (sign * white @ template / 2, sd)
        line(f"{name}_{suffix}", 200_000, whitening_left_out=power(good, bad, 200_000))

line("generator_kolmogorov", 2_000_000, shifted_by_1_percent=kolmogorov_power((0, 1), (0.01, 1), 2_000_000))
line("generator_tails_beyond_4", 2_000_000, tail_left_out=count_power(2 * norm.sf(4), 0, 2_000_000))
for name in ("generator_signs_of_neighbours", "generator_signs_of_trials"):
    line(name, 200_000, same_address=count_power(0.5, 1, 200_000))

# A shift by one sample adds 1 to a mean square of 0.07. Below the threshold effect (gamma = 2.5, 100 candidate shifts, one in three errors
# spread over the record) the mean square is some 200 against a bound of 7.
line("position_error", 3_000, template_shifted=1, signal_below_the_threshold_effect=1)


def cut_position(overlap_forgotten):
    """(mean, sd) of the place where a signal at 6 is found whose template is cut off."""
    u = np.arange(-36, 37) / 20
    whole = np.array([u * np.exp(-u * u / 2), np.exp(-u * u / 2)])
    whole *= 1000 / np.linalg.norm(whole)
    moved = [np.pad(whole[:, 6:67], ((0, 0), (k, 0)))[:, :61] for k in range(15)]
    energy = [np.sum((moved[0 if overlap_forgotten else k]) ** 2) for k in range(15)]
    theta = [np.sum(m * whole[:, :61]) - e / 2 for m, e in zip(moved, energy)]
    k = int(np.argmax(theta))
    rise, bend = theta[k + 1] - theta[k - 1], 2 * theta[k] - theta[k - 1] - theta[k + 1]
    slope = (moved[k + 1] - moved[k - 1]) / (2 * bend) - rise * (2 * moved[k] - moved[k - 1] - moved[k + 1]) / (2 * bend**2)
    return k + rise / (2 * bend), np.linalg.norm(slope)


overlap = variance_power(cut_position(False), cut_position(True), 3_000)
line("position_error_of_a_cut_signal", 3_000, overlap_forgotten=overlap)

# theta + ln 2 instead of theta.
rate = norm.sf(norm.isf(0.05) - math.log(2) / 2)
line("mixture_false_alarms_at_5_percent", 100_000, prior_left_out=count_power(0.05, rate, 100_000))

force, eta, floor, fraction = (1.5, 1.9), 0.25, 0.05, 0.2
v = [floor**2 + (fraction * f) ** 2 for f in force]
observed = np.linspace(-3, 8, 2_200_001)
log_ratio = norm.logpdf(observed, force[1], v[1] ** 0.5) - norm.logpdf(observed, force[0], v[0] ** 0.5)
constant = (force[1] - force[0]) / v[0] * (observed - (force[0] + force[1]) / 2)
for h in (0, 1):
    density = norm.pdf(observed, force[h], v[h] ** 0.5) * (observed[1] - observed[0])
    rate = lambda statistic: float(np.sum(density[statistic >= eta]))
    power = lambda statistic: count_power(rate(log_ratio), rate(statistic), 200_000)
    without_logarithm = log_ratio - 0.5 * math.log(v[0] / v[1])
    line(f"weber_tail_h{h}", 200_000, constant_noise_presumed=power(constant), logarithm_left_out=power(without_logarithm))

# Offsets and drifts of both channels and a gain beside the template, whitened; the inclusion is in every second record.
AMPLITUDE, NUISANCES = 100, ["lateral_offset", "normal_offset", "lateral_drift", "normal_drift", "gain"]


def beside(step, left_out=None):
    """Nominal gamma, gamma, degrees of freedom, and what the amplitude of a nuisance that is left out adds to the variance of T."""
    white = lambda forces: np.concatenate([force[::step] / sd for force, sd in zip(forces, (0.07, 0.09))])
    f0, template = map(white, maps())
    samples = len(f0) // 2
    channel = lambda shape: list(np.kron(np.eye(2), shape))
    columns = dict(zip(NUISANCES, channel(np.ones(samples)) + channel(np.linspace(-1, 1, samples)) + [f0]))
    other = columns.pop(left_out, 0 * f0)
    basis = np.linalg.qr(np.transpose(list(columns.values())))[0]
    rest = template - basis @ (basis.T @ template)
    gamma = np.linalg.norm(rest)
    return np.linalg.norm(template), gamma, 2 * samples - basis.shape[1] - 1, (AMPLITUDE * (rest @ other) / gamma) ** 2


def share_power(presumed, true, x, n):
    """Of Kolmogorov's test of the presumed distribution function at T: those without and with an inclusion, and the true ones."""
    share = np.linspace(0, 1, 20001)[1:-1]
    found = [np.interp(share, presumed(x), true(x)) for presumed, true in zip(presumed, true)]
    return distance_power(np.max(np.abs(np.mean(found, axis=0) - share)), n)


nominal, gamma, _, _ = beside(10)
left_out = lambda nuisance: kolmogorov_power((0, 1), (0, math.sqrt(1 + beside(10, nuisance)[3])), 20_000)
powers = {f"{nuisance}_left_out": left_out(nuisance) for nuisance in ("lateral_drift", "gain")}
presumed = [norm(0, 1).cdf, norm(nominal, 1).cdf]
true = [norm(0, gamma / nominal).cdf, norm(gamma**2 / nominal, gamma / nominal).cdf]
powers["nominal_gamma"] = share_power(presumed, true, np.linspace(-40, 40, 400_001), 20_000)
line("nuisance_t_kolmogorov", 20_000, **powers)

nominal, gamma, nu, _ = beside(100)
squares = np.geomspace(1e-8, 1e8, 4001)
roots = np.concatenate([-np.sqrt(squares[::-1]), np.sqrt(squares)])
presumed, both = [chi2(nu).cdf] * 2, [chi2(nu + 1).cdf, ncx2(nu + 1, gamma**2).cdf]
line(
    "nuisance_residual_kolmogorov", 20_000,
    degrees_off_by_one=share_power([chi2(nu + 1).cdf] * 2, presumed, squares, 20_000),
    template_left_in=share_power(presumed, both, squares, 20_000),
)

# With a degree too many the noise is taken for smaller, too.
scale = math.sqrt((nu + 1) / nu)
student, off = [t(nu), nct(nu, gamma)], [t(nu + 1), nct(nu + 1, gamma)]
true = [law.cdf for law in student]
line(
    "nuisance_student_kolmogorov", 20_000,
    central_law=share_power([t(nu).cdf] * 2, true, roots, 20_000),
    normal_law=share_power([norm(0, 1).cdf, norm(gamma, 1).cdf], true, roots, 20_000),
    degrees_off_by_one=share_power([lambda x, law=law: law.cdf(scale * x) for law in off], true, roots, 20_000),
)
true = [f(1, nu).cdf, ncf(1, nu, gamma**2).cdf]
line(
    "nuisance_f_kolmogorov", 20_000,
    central_law=share_power([f(1, nu).cdf] * 2, true, squares, 20_000),
    chi_square_law=share_power([chi2(1).cdf, ncx2(1, gamma**2).cdf], true, squares, 20_000),
)


def errors_power(without, inclusion, alarm, miss, n):
    """Of a rate of 1 % in all, if these are the laws and thresholds. Two binomials vary less than one with their mean rate."""
    return count_power(0.01, (without.sf(alarm) + inclusion.cdf(miss)) / 2, n)


point, bias = norm.isf(0.01), 0.5
scaled = gamma / nominal
pair = norm(scaled * bias, scaled), norm(scaled * (gamma - bias), scaled)
line(
    "nuisance_errors_of_known_level", 50_000,
    bias_left_out=errors_power(norm(bias, 1), norm(gamma - bias, 1), point, gamma - point, 50_000),
    nominal_gamma=errors_power(*pair, bias + point, nominal - bias - point, 50_000),
)
# A record's own estimate of the noise is in its thresholds, too: T less its centre has a central law.
right, off = t(nu).isf(0.01), t(nu + 1).isf(0.01) / scale
line(
    "nuisance_errors_of_unknown_level", 100_000,
    bias_left_out=errors_power(nct(nu, bias), nct(nu, -bias), right, -right, 100_000),
    normal_law=errors_power(t(nu), t(nu), point, -point, 100_000),
    degrees_off_by_one=errors_power(t(nu), t(nu), off, -off, 100_000),
)


def autocorrelation_rate(q):
    """Pr(n (n + 2) rho_1^2/(n - 1) >= q) for n = 20: rho_1 >= r is a sum of squares >= 0, whose law is Imhof's integral."""
    n = 20
    r = math.sqrt(q * (n - 1) / (n * (n + 2)))
    weights = np.cos(np.arange(1, n + 1) * math.pi / (n + 1)) - r
    angle = lambda u: np.sum(np.arctan(weights * u)) / 2
    integrand = lambda u: math.sin(angle(u)) / u / np.prod((1 + (weights * u) ** 2) ** 0.25)
    return 1 + 2 / math.pi * quad(integrand, 0, math.inf, epsabs=1e-13, limit=500)[0]


q = chi2.isf(0.05, 1)
rate = autocorrelation_rate(q)  # RATE in nuisance.rs
power = lambda limit: count_power(rate, autocorrelation_rate(limit), 50_000)
line("ljung_box_at_5_percent", 50_000, degrees_off_by_one=power(chi2.isf(0.05, 2)), n_for_n_plus_2=power(q * 22 / 20))

# A bank of two points, between which the normal channel is linear in the place, and the posterior a normal law cut to 0 ... 1.
ALPHA, TRIALS = 1e-8, 20_000
middles = (np.arange(2000) + 0.5) / 2000
truth, noise = np.meshgrid(middles, norm.ppf(middles))
distance = math.hypot(4, -4)


def ranks(width, swapped):
    """Of the truth where the posterior is so much wider than it should be, or lies where the other point's neighbour does."""
    middle = truth + noise / distance
    middle, scale = (1 - middle if swapped else middle), distance / width
    low, high = norm.cdf(-scale * middle), norm.cdf(scale * (1 - middle))
    return (norm.cdf(scale * (truth - middle)) - low) / np.maximum(high - low, 1e-300)


def rank_power(found):
    found = np.sort(found.ravel())
    return distance_power(np.max(np.abs(found - (np.arange(found.size) + 0.5) / found.size)), TRIALS)


wide, swapped = ranks(1.5, False), ranks(1, True)
held_power = lambda found: count_power(0.9, np.mean((found >= 0.05) & (found <= 0.95)), TRIALS)
for name, power in [("bank_ranks_kolmogorov", rank_power), ("bank_intervals_at_90_percent", held_power)]:
    line(name, TRIALS, variance_of_one_channel=power(wide), template_of_the_neighbour=power(swapped))

# Two points, each in a channel of its own: the mean of h less its probability.
gammas, shares, prior = (1.5, 2.0), (0.7, 0.3), 0.3
x, y = np.meshgrid(*[np.linspace(-8, 12, 2001)] * 2)
cell = (20 / 2000) ** 2
density = lambda a, b: norm.pdf(x, a) * norm.pdf(y, b) * cell
there = shares[0] * density(gammas[0], 0) + shares[1] * density(0, gammas[1])
whole = (1 - prior) * density(0, 0) + prior * there


def excess_power(presumed, half):
    """Of the test of the mean, if the probability is computed with this prior and these halves of the squares."""
    ratio = sum(share * np.exp(gamma * z - h) for share, gamma, z, h in zip(shares, gammas, (x, y), half))
    probability = ratio * presumed / (ratio * presumed + 1 - presumed)
    mean = prior - np.sum(whole * probability)
    square = np.sum(prior * there * (1 - probability) ** 2 + (1 - prior) * density(0, 0) * probability**2)
    least = math.sqrt(math.log(2 / ALPHA) / 2 / TRIALS)
    return norm.sf((least - abs(mean)) / math.sqrt((square - mean**2) / TRIALS))


halves, unsquared = [gamma**2 / 2 for gamma in gammas], [gamma / 2 for gamma in gammas]
powers = {"prior_left_out": excess_power(0.5, halves), "gamma_for_its_square": excess_power(prior, unsquared)}
line("bank_posterior_of_inclusion", TRIALS, **powers)

# The classes and signals of robust.rs: mean and variance of ln of a bet's gain, by 4,096 of Sobol's points for each class and signal.
TRIALS, noise, prior_h1 = 4_000, 0.25, 0.4
weights, shares, sizes = np.array([8, 2, 1, 1.0]), np.array([0.3, 0.3, 0.2, 0.2]), np.array([4, 4, 2, 2])
means = np.array([[0, 2, 3, -1, 1, 2], [0, 1, 2, -2, 1, 2], [0, 1, 2, 0, -1, 2], [0, 1, 1, -1, 0, 1]])
directions = [[], [[0, 2, 1, 0, 0, 1], [0, 0, 2, 1, 0, -3]], [[2, 0, -2, 2, 0, 3]], [[0, 1, 3, -2, 1, 3]]]
outer = lambda vectors: sum((np.outer(v, v) for v in vectors), np.zeros((6, 6)))
classes = [outer([[2, 0, 0, 0, 0, 0], *own]) for own in directions]
shape = outer([[0, 1, 0, 1, 0, 0], [0, 0, 1, 0, 1, 0], [0, 0, 0, 1, 1, 1]])
points = norm.ppf((qmc.Sobol(6, scramble=False).random(4096) + 0.5 / 4096) % 1)


def law(number, k, amplitude=0.4):
    """Mean and covariance, beside the noise, of a class without a signal (k = -1) and with one."""
    if k < 0:
        return np.zeros(6), classes[number]
    own = amplitude**2 * np.outer(means[k], means[k]) + (0.15 * sizes[k]) ** 2 * shape
    return means[k] * 1.0, classes[number] + own


def densities(records, defect):
    """ln of the weight of each class times the density, without a signal and with each."""
    told = np.ones(4) if defect == "weights_left_out" else weights.copy()
    told[3] *= 1e-12 if defect == "class_forgotten" else 1
    modes = slice(0, 5 if defect == "one_mode_short" else 6)
    level = np.full(len(records), noise)
    if defect == "noise_from_the_misfit":
        level = np.mean(records**2, axis=1)
    if defect == "one_mode_short":
        level = 0.9 * noise + 0.1 * records[:, 5] ** 2
    found = np.empty((4, 5, len(records)))
    for number in range(4):
        for k in range(-1, 4):
            mean, covariance = law(number, k, 0 if defect == "amplitude_fixed" else 0.4)
            values, vectors = np.linalg.eigh(covariance[modes, modes])
            turned, variances = (records - mean)[:, modes] @ vectors, values + level[:, None]
            density = -np.sum(turned**2 / variances + np.log(variances), axis=1) / 2
            found[number, k + 1] = np.log(told[number] / told.sum()) + density
    if defect == "weights_under_one_hypothesis":
        found[:, 0] += np.log(weights.sum())
    return found


def told_cells(kind, records, defect):
    found = densities(records, defect)
    mixed = found[:, 1:] + np.log(shares)[:, None]
    none, any_signal = found[:, 0] + np.log(1 - prior_h1), logsumexp(mixed, axis=1) + np.log(prior_h1)
    if kind == "inclusion":
        return np.array([logsumexp(none, axis=0), logsumexp(any_signal, axis=0)])
    return np.concatenate([none, any_signal]) if kind == "classes" else logsumexp(mixed, axis=0)


def odds_power(kind, defect):
    scores = {"inclusion": [0, 1], "classes": [1, 0, 0, 0] * 2, "signals": [0, 1 / 3, 2 / 3, 1]}[kind]
    moments = np.zeros((4, 2))
    for number in range(4):
        for k in range(0 if kind == "signals" else -1, 4):
            there = 1 if kind == "signals" else prior_h1
            probability = weights[number] / weights.sum() * (1 - prior_h1 if k < 0 else there * shares[k])
            mean, covariance = law(number, k)
            records = mean + points @ np.linalg.cholesky(covariance + noise * np.eye(6)).T
            cells = told_cells(kind, records, defect)
            truth = {"inclusion": int(k >= 0), "classes": number + 4 * (k >= 0), "signals": k}[kind]
            share = lambda logs: (logs - logsumexp(logs, axis=0))[truth]
            for bet, (power, tilt) in enumerate([(0.7, 0), (1.4, 0), (1, -0.5), (1, 0.5)]):
                gain = share(power * cells + tilt * np.array(scores)[:, None]) - share(cells)
                moments[bet] += probability * np.array([np.mean(gain), np.mean(gain**2)])
    mean, sd = moments[:, 0], np.sqrt(moments[:, 1] - moments[:, 0] ** 2)
    return np.max(norm.sf((math.log(4 / ALPHA) - TRIALS * mean) / (math.sqrt(TRIALS) * sd)))


for kind, defects in [
    ("inclusion", ["class_forgotten", "weights_under_one_hypothesis", "noise_from_the_misfit"]),
    ("classes", ["class_forgotten", "weights_left_out"]),
    ("signals", ["noise_from_the_misfit", "amplitude_fixed", "one_mode_short"]),
]:
    line(f"robust_posterior_of_{kind}", TRIALS, **{defect: odds_power(kind, defect) for defect in defects})

# Wald's test row by row: the density of theta while the test goes on, at Gauss' nodes between the bounds, and what leaves them.
signal, force, rate = np.array([0.3, 0.9]), np.array([-1.5, 1.5]), 0.05
nodes, gauss = np.polynomial.legendre.leggauss(600)


def answered(inclusion, rows, defect="", decides_at_end=False):
    """Pr(inclusion answered) and Pr(none answered)."""
    lower, upper, gamma2, rates, at, mass = math.log(rate), -math.log(rate), 0.0, np.zeros(2), np.zeros(1), np.ones(1)
    for row in range(rows):
        used, there = signal[row % 2], signal[row % 2] * inclusion
        if defect == "depth_taken_as_constant":
            used, there = 0.6, there + force[row % 2]
        gamma2 += used * used
        mean = used * there - used * used * (1 if defect == "half_left_out" else 0.5)
        low, high = lower, upper
        if defect == "fixed_test_at_each_row":
            low, high = -60, norm.isf(rate) * math.sqrt(gamma2) - gamma2 / 2
        rates += [np.sum(mass * norm.sf(high, at + mean, used)), np.sum(mass * norm.cdf(low, at + mean, used))]
        low = max(low, np.min(at) + mean - 9 * used)
        next_at = low + (high - low) * (nodes + 1) / 2
        mass = norm.pdf(next_at[:, None], at + mean, used) @ mass * gauss * (high - low) / 2
        at = next_at
    if decides_at_end:
        rates += [np.sum(mass[at >= 0]), np.sum(mass[at < 0])]
    return rates


ALPHA, TRIALS = 1e-8, 20_000
SHORT = dict(rows=8, decides_at_end=True)
laws_of = {
    "sequential_false_alarms": (dict(inclusion=0, rows=40), 0, ["fixed_test_at_each_row", "half_left_out", "depth_taken_as_constant"]),
    "sequential_misses": (dict(inclusion=1, rows=40), 1, ["half_left_out", "depth_taken_as_constant"]),
    "sequential_false_alarms_of_a_short_record": (dict(inclusion=0, **SHORT), 0, ["truncation_forgotten", "half_left_out"]),
}
for name, (law_of, wrong, defects) in laws_of.items():
    right = answered(**law_of)[wrong]  # in sequential.rs
    of = lambda defect: answered(**{**law_of, "decides_at_end": False} if defect == "truncation_forgotten" else law_of, defect=defect)[wrong]
    line(name, TRIALS, **{defect: count_power(right, of(defect), TRIALS) for defect in defects})

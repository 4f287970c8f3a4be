"""Dense sweeps of an oracle against mpmath and exact fractions: `python3 tests/accuracy/sweep.py CMD ARGS…`.

It asks each function of spec/detector.md at 10⁴ arguments or more, and prints the worst error in units of the stated bound
and in ULP of the exact result. The exit code is 1 if a bound is broken. Needs mpmath. Nothing here is taken from the Rust code:
Φ⁻¹ is judged by the residual Φ(x̂) − p, the exact interval by a continued fraction of the incomplete beta function.

Implements: ACC-020.
"""

import contextlib
import io
import json
import math
import multiprocessing
import random
import subprocess
import sys
from decimal import Decimal, getcontext
from fractions import Fraction

from mpmath import erfc, exp, fdot, log, loggamma, matrix, mp, mpf, pi, sqrt

mp.dps = 40
getcontext().prec = 36
U = mpf(2) ** -53
TINY = 2.0**-1022


def ulp(value):
    """Distance from |value|, rounded, to the next larger f64."""
    return mpf(math.ulp(abs(float(value)))) if value else mpf(2) ** -1074


def density(x):
    return exp(-x * x / 2) / sqrt(2 * pi)


def cdf(x):
    return erfc(-mpf(x) / sqrt(mpf(2))) / 2


def quantile_of(p, near):
    """Φ⁻¹(p) from a value near it: two Newton steps, each of which squares the error."""
    x = mpf(near)
    for _ in range(2):
        x -= (cdf(x) - p) / density(x)
    return x


def hazard(x):
    """The relative change of Φ(x) for a change of x."""
    return density(x) / cdf(x)


class Oracle:
    """Asks in one go and reads all answers."""

    def __init__(self, command):
        self.command = command

    def ask(self, op, all_args):
        lines = "".join(json.dumps({"id": i, "op": op, "args": args}) + "\n" for i, args in enumerate(all_args))
        done = subprocess.run(self.command, input=lines.encode(), stdout=subprocess.PIPE, check=True)
        answers = [json.loads(line) for line in done.stdout.splitlines()]
        assert len(answers) == len(all_args), f"{len(answers)} answers to {len(all_args)} questions"
        for i, answer in enumerate(answers):
            assert answer["id"] == i and "ok" in answer, f"{all_args[i]}: {answer}"
        return [answer["ok"] for answer in answers]


class Sweep:
    """The worst error of one function."""

    def __init__(self, name):
        self.name, self.points, self.worst, self.ulps, self.at = name, 0, mpf(-1), mpf(0), None

    def point(self, found, exact, bound, at):
        """`bound` is absolute. Results below 2⁻¹⁰²² count in bounds, not in ULP."""
        error = abs(mpf(found) - exact)
        self.points += 1
        if abs(exact) >= TINY:
            self.ulps = max(self.ulps, error / ulp(exact))
        if error > 0 or bound > 0:
            share = error / bound if bound > 0 else mpf("inf")
            if share > self.worst:
                self.worst, self.at = share, at

    def report(self):
        at = f" at {self.at}" if self.worst > 1 else ""
        print(f"{self.name:34} {self.points:7} points  {float(self.worst):5.2f} of the bound  {float(self.ulps):7.2f} ulp{at}", flush=True)
        assert self.points >= 10_000, "too few points"
        return self.worst <= 1


def normal(oracle, draw):
    lower = Sweep("Phi, -38.4 to 0 (tails)")
    upper = Sweep("Phi, 0 to 8.3")
    below = Sweep("Phi, result below 2^-1022")
    arguments = [-draw.uniform(0, 37.5) for _ in range(15_000)] + [draw.uniform(0, 8.3) for _ in range(10_000)]
    arguments += [-draw.uniform(37.52, 39.99) for _ in range(10_000)]
    for x, ok in zip(arguments, oracle.ask("normal_cdf", [{"x": x} for x in arguments])):
        exact = cdf(x)
        if exact >= TINY:
            (lower if x < 0 else upper).point(ok["p"], exact, 4 * ulp(exact), x)
        else:
            below.point(ok["p"], exact, mpf(2) ** -1073, x)
    quantiles = Sweep("Phi^-1, p >= 1e-306")
    far = Sweep("Phi^-1, p < 1e-306")
    probabilities = [10 ** draw.uniform(-306, -0.31) for _ in range(8_000)] + [draw.random() for _ in range(8_000)]
    probabilities += [1 - 2.0 ** -draw.uniform(1, 53) for _ in range(2_000)]
    probabilities += [10 ** draw.uniform(-323, -306.01) for _ in range(10_000)]
    probabilities = [p for p in probabilities if 0 < p < 1]
    for p, ok in zip(probabilities, oracle.ask("normal_quantile", [{"p": p} for p in probabilities])):
        exact = quantile_of(mpf(p), ok["x"])
        is_far = p < 1e-306
        (far if is_far else quantiles).point(ok["x"], exact, (6 if is_far else 4) * ulp(exact), p)
    return [lower, upper, below, quantiles, far]


def filters(oracle, draw):
    gammas, thetas, normal_outputs = Sweep("gamma"), Sweep("Theta"), Sweep("y(0), both channels")
    records = []
    for _ in range(10_000):
        count = draw.randint(1, 24)
        unit = 2.0 ** draw.randint(-30, 30)
        series = lambda: [draw.gauss(0, 1) * unit for _ in range(count)]
        f0x, f0y, f1x, f1y = series(), series(), series(), series()
        near = draw.random() < 0.5
        half = lambda a, b: [(x + y) / 2 * (1 + draw.uniform(-1e-9, 1e-9)) for x, y in zip(a, b)] if near else series()
        sd = [draw.uniform(0.05, 3) * unit for _ in range(2)]
        keys = ("observed_x", "observed_y", "f0_x", "f0_y", "f1_x", "f1_y", "noise_sd_x", "noise_sd_y")
        records.append(dict(zip(keys, (half(f0x, f1x), half(f0y, f1y), f0x, f0y, f1x, f1y, *sd))))
    for args, ok in zip(records, oracle.ask("theta", records)):
        parts, sizes, energies = [], [], []
        for c in "xy":
            r = [Fraction(a) - Fraction(b) for a, b in zip(args[f"observed_{c}"], args[f"f0_{c}"])]
            d = [Fraction(a) - Fraction(b) for a, b in zip(args[f"f1_{c}"], args[f"f0_{c}"])]
            variance = Fraction(args[f"noise_sd_{c}"]) ** 2
            cross, energy = sum(a * b for a, b in zip(r, d)), sum(b * b for b in d)
            parts.append(real((cross - energy / 2) / variance))
            sizes.append(real(sum(abs(a * b) + b * b / 2 for a, b in zip(r, d)) / variance))
            energies.append(real(energy / variance))
            y = real(cross) / sqrt(real(energy) * len(d))
            scale = real(sum(abs(a * b) for a, b in zip(r, d))) / sqrt(real(energy) * len(d))
            normal_outputs.point(ok[f"y_{c}"], y, 4 * U * abs(y) + mpf(10) ** -19 * scale, c)
        theta = parts[0] + parts[1]
        bound = 5 * U * (abs(parts[0]) + abs(parts[1])) + mpf(10) ** -19 * (sizes[0] + sizes[1])
        thetas.point(ok["theta"], theta, bound, None)
        gamma = sqrt(energies[0] + energies[1])
        gammas.point(ok["gamma"], gamma, 4 * U * gamma, None)
    return [gammas, thetas, normal_outputs]


def real(fraction):
    return mpf(fraction.numerator) / fraction.denominator


def tail_bound(a, error):
    """Of Φ(a) whose argument is off by `error`: 4 ULP and the change of Φ; near the smallest numbers two of them."""
    p = cdf(a)
    return max(4 * ulp(p) + p * hazard(a) * error * (1 + abs(a) * error), mpf(2) ** -1073)


def decisions(oracle, draw):
    rates, curve = Sweep("error rates"), Sweep("ROC")
    pairs = [(draw.uniform(0.01, 12), draw.uniform(-40, 40)) for _ in range(8_000)]
    pairs += [(10 ** draw.uniform(-3, 1.5), draw.gauss(0, 3)) for _ in range(4_000)]
    for (gamma, eta), ok in zip(pairs, oracle.ask("error_rates", [{"gamma": g, "eta": e} for g, e in pairs])):
        criterion, half = mpf(eta) / gamma, mpf(gamma) / 2
        for key, a in (("false_alarm", -(criterion + half)), ("miss", criterion - half)):
            rates.point(ok[key], cdf(a), tail_bound(a, U * (abs(criterion) + abs(a))), (gamma, eta))
    args = []
    for _ in range(150):
        alphas = [10 ** draw.uniform(-12, -0.01) for _ in range(80)]
        args.append({"gamma": draw.uniform(0, 8), "false_alarm": alphas})
    for request, ok in zip(args, oracle.ask("roc", args)):
        for alpha, miss in zip(request["false_alarm"], ok["miss"]):
            q = quantile_of(mpf(alpha), quantile_start(alpha))
            a = -q - request["gamma"]
            curve.point(miss, cdf(a), tail_bound(a, U * (8 * abs(q) + abs(a))), alpha)
    needed = Sweep("required gamma")
    pairs = [(10 ** draw.uniform(-20, -0.31), 10 ** draw.uniform(-20, -0.31)) for _ in range(10_000)]
    for (a, b), ok in zip(pairs, oracle.ask("required_gamma", [{"max_false_alarm": a, "max_miss": b} for a, b in pairs])):
        p, q = (quantile_of(mpf(x), quantile_start(x)) for x in (a, b))
        needed.point(ok["gamma"], -p - q, U * (8 * abs(p) + 8 * abs(q) + abs(p + q)), (a, b))
    choice, inverse = Sweep("forced choice"), Sweep("gamma of a forced choice")
    gammas = [draw.uniform(0, 12) for _ in range(8_000)] + [10 ** draw.uniform(-12, 0) for _ in range(2_000)]
    for gamma, ok in zip(gammas, oracle.ask("two_afc", [{"gamma": g} for g in gammas])):
        exact = erfc(-mpf(gamma) / 2) / 2
        choice.point(ok["p_correct"], exact, 2 * ulp(exact), gamma)
    shares = [draw.random() for _ in range(9_000)] + [10 ** draw.uniform(-323, -1) for _ in range(3_000)]
    for p, ok in zip(shares, oracle.ask("gamma_from_two_afc", [{"p_correct": p} for p in shares])):
        exact = sqrt(mpf(2)) * quantile_of(mpf(p), ok["gamma"] / math.sqrt(2))
        inverse.point(ok["gamma"], exact, (7 if p >= 1e-306 else 10) * ulp(exact), p)
    return [rates, curve, needed, choice, inverse]


def quantile_start(p):
    """Φ⁻¹(p) to 14 digits, by Python's own statistics module and a Newton step for its tails."""
    from statistics import NormalDist

    x = mpf(NormalDist().inv_cdf(p))
    return x - (cdf(x) - p) / density(x)


def thresholds(oracle, draw):
    priors = [draw.random() for _ in range(6_000)] + [10 ** draw.uniform(-320, -0.5) for _ in range(3_000)]
    priors += [1 - 2.0 ** -draw.uniform(1, 52) for _ in range(3_000)]
    priors = [p for p in priors if 0 < p < 1]
    by_prior = Sweep("MAP threshold")
    for p, ok in zip(priors, oracle.ask("threshold", [{"criterion": "map", "prior_h1": p} for p in priors])):
        exact = log((1 - mpf(p)) / p)
        by_prior.point(ok["eta"], exact, 3 * ulp(exact), p)
    by_cost = Sweep("Bayes threshold")
    args = []
    for k, p in enumerate(priors[:10_000]):
        c00, c11 = draw.uniform(-1, 1), draw.uniform(-1, 1)
        false_alarm, size = 10 ** draw.uniform(-2, 3), draw.uniform(-2, 3)
        # In every second case the costs nearly make up for the priors.
        miss = false_alarm * (1 - p) / p * 2 ** (size / 3) if k % 2 and p > 1e-300 else 10**size
        c10, c01 = c00 + false_alarm, c11 + miss
        if not c01 > c11:
            c01 = c11 + 1
        args.append({"criterion": "bayes", "prior_h1": p, "c00": c00, "c01": c01, "c10": c10, "c11": c11})
    for a, ok in zip(args, oracle.ask("threshold", args)):
        p = mpf(a["prior_h1"])
        exact = log((1 - p) * (mpf(a["c10"]) - a["c00"]) / (p * (mpf(a["c01"]) - a["c11"])))
        by_cost.point(ok["eta"], exact, U * (8 + 3 * abs(exact)), a)
    sweeps = [by_prior, by_cost]
    for name, key, sign in (("miss", "max_miss", 1), ("false_alarm", "max_false_alarm", -1)):
        sweep = Sweep(f"Neyman-Pearson threshold, {name}")
        args = [{"criterion": f"neyman_pearson_{name}", "gamma": 10 ** draw.uniform(-3, 2), key: 10 ** draw.uniform(-20, -0.01)} for _ in range(10_000)]
        for a, ok in zip(args, oracle.ask("threshold", args)):
            gamma, q = mpf(a["gamma"]), quantile_of(mpf(a[key]), quantile_start(a[key]))
            exact = sign * gamma * (gamma / 2 + q)
            sweep.point(ok["eta"], exact, U * (8 * abs(gamma * q) + 2 * abs(exact)), a)
        sweeps.append(sweep)
    return sweeps


def beta_fraction(a, b, x):
    """The continued fraction of I_x(a, b) (Abramowitz and Stegun 26.5.8) by Lentz's method, in 36 digits."""
    small = Decimal("1e-60")
    c, d = Decimal(1), 1 - (a + b) * x / (a + 1)
    d = 1 / (d or small)
    h = d
    for m in range(1, 200_000):
        for e in (m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)), -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))):
            d = 1 / ((1 + e * d) or small)
            c = (1 + e / c) or small
            step = c * d
            h *= step
        if abs(step - 1) < Decimal("1e-32"):
            return h
    raise ArithmeticError("no convergence")


def beta_tail(k, n, p):
    """Pr(X ≥ k) = I_p(k, n − k + 1), and its slope in p."""
    a, b = mpf(k), mpf(n - k + 1)
    slope = exp(loggamma(a + b) - loggamma(a) - loggamma(b) + (a - 1) * log(p) + (b - 1) * log(1 - p))
    def fraction(a, b, x):
        exact = Decimal(str(mp.nstr(x, 36)))
        return mpf(str(beta_fraction(Decimal(a), Decimal(b), exact)))
    if p < (a + 1) / (a + b + 2):
        tail = slope * p * (1 - p) / a * fraction(k, n - k + 1, p)
    else:
        tail = 1 - slope * p * (1 - p) / b * fraction(n - k + 1, k, 1 - p)
    return tail, slope


def intervals(oracle, draw):
    exact_ends, score = Sweep("Clopper-Pearson"), Sweep("Wilson")
    args = []
    for _ in range(6_000):
        n = round(10 ** draw.uniform(0, 3.3)) if draw.random() < 0.97 else round(10 ** draw.uniform(3.3, 6))
        k = draw.randint(0, n)
        args.append({"successes": k, "trials": n, "confidence": draw.choice([0.5, 0.8, 0.9, 0.95, 0.99, 0.999, draw.uniform(0.5, 1)])})
    for a, ok in zip(args, oracle.ask("proportion_interval", [{**a, "method": "clopper_pearson"} for a in args])):
        k, n, tail = a["successes"], a["trials"], (1 - mpf(a["confidence"])) / 2
        for key, count, complement in (("lower", k, False), ("upper", k + 1, True)):
            if count in (0, n + 1):
                exact_ends.point(ok[key], mpf(complement), mpf(0) or U * U, a)
                continue
            p = mpf(ok[key])
            upper_tail, slope = beta_tail(count, n, p)
            wanted = 1 - tail if complement else tail
            error = (upper_tail - wanted) / slope
            exact_ends.point(ok[key], p - error, mpf(10) ** -12 * tail / slope + ulp(p), a)
    for a, ok in zip(args, oracle.ask("proportion_interval", [{**a, "method": "wilson"} for a in args])):
        k, n, tail = mpf(a["successes"]), mpf(a["trials"]), (1 - mpf(a["confidence"])) / 2
        z = -quantile_of(tail, quantile_start(float(tail)))
        half = z * sqrt(k * (n - k) / n + z * z / 4)
        total = k + z * z / 2
        ends = {"lower": (total - half) / (n + z * z), "upper": (total + half) / (n + z * z)}
        # The lower end cancels in 40 digits, not in what is compared; it is exactly 0 for no success.
        if a["successes"] == 0:
            ends["lower"] = mpf(0)
        if a["successes"] == a["trials"]:
            ends["upper"] = mpf(1)
        for key, exact in ends.items():
            score.point(ok[key], exact, 16 * ulp(exact) if exact else U * U, a)
    return [exact_ends, score]


def length(v):
    return sqrt(fdot(v, v))


def nuisances(oracle, draw):
    """By elimination in the signals' Gram matrix, whose last corner keeps the squares of Pδ and Pz, and their product."""
    sweeps = {key: Sweep(f"{key} beside nuisances") for key in ("t", "gamma", "residual", "theta")}
    requests = []
    for _ in range(10_000):
        count, signals = draw.randint(5, 16), []
        vector = lambda size: [draw.gauss(0, size) for _ in range(count)]
        for _ in range(draw.randint(0, 3)):
            size = 10 ** draw.uniform(-4, 0)
            signals.append([a + size * b for a, b in zip(signals[0] if signals else [0] * count, vector(1))])
        residual, template = vector(1), vector(10 ** draw.uniform(-2, 1))
        for signal in signals:
            amplitude = 10 ** draw.uniform(0, 6)
            residual = [a + amplitude * b for a, b in zip(residual, signal)]
        args = {"residual": residual, "template": template, "nuisances": signals, "level": "known", "bias": 0, "eta": 0}
        requests.append(args)
    for args, ok in zip(requests, oracle.ask("theta_nuisances", requests)):
        count, signals = len(args["template"]), [[mpf(v) for v in s] for s in args["nuisances"]]
        units = [[v / length(s) for v in s] for s in signals]
        inverse = matrix([[fdot(a, b) for b in units] for a in units]) ** -1 if units else None
        condition = sqrt(sum(inverse[k, k] for k in range(len(units)))) if units else 0
        columns = [*signals, [mpf(v) for v in args["template"]], [mpf(v) for v in args["residual"]]]
        gram = [[fdot(a, b) for b in columns] for a in columns]
        for k in range(len(signals)):
            for i in range(k + 1, len(columns)):
                factor = gram[i][k] / gram[k][k]
                gram[i] = [a - factor * b for a, b in zip(gram[i], gram[k])]
        z, d, gamma = length(columns[-1]), length(columns[-2]), sqrt(gram[-2][-2])
        t = gram[-2][-1] / gamma
        residual, e = gram[-1][-1] - t * t, 2 * (len(signals) + 1) * (count + 4) * (1 + condition) * U
        of_t, of_gamma = e * d * z / gamma, e * d
        of_residual = 2 * e * z * sqrt(residual) + (e * z) ** 2 + (count + 4) * U * residual
        of_theta = gamma * of_t + abs(t - gamma) * of_gamma + of_t * of_gamma + 10 * U * gamma * (abs(t) + gamma)
        exact = (t, gamma, residual, gamma * (t - gamma / 2))
        for (key, sweep), value, bound in zip(sweeps.items(), exact, (of_t, of_gamma, of_residual, of_theta)):
            sweep.point(ok[key], value, bound, args)
    return list(sweeps.values())


def swept(number):
    """The report of one topic with its own oracle and seed, and whether every sweep of it kept its bound."""
    topic = (normal, filters, decisions, thresholds, intervals, nuisances)[number]
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        good = [sweep.report() for sweep in topic(Oracle(sys.argv[1:]), random.Random(number))]
    return text.getvalue(), all(good)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__.splitlines()[0])
    # The topic with the most digits first; the reports in the order of the topics.
    with multiprocessing.Pool(2) as pool:
        order = [4, 5, 0, 1, 2, 3]
        reports = dict(zip(order, pool.map(swept, order, chunksize=1)))
    for number in sorted(reports):
        print(reports[number][0], end="")
    sys.exit(0 if all(good for _, good in reports.values()) else 1)


if __name__ == "__main__":
    main()

"""The expected answers once more, by other ways than the generator's: for check.py. The generator takes from here the
formulas of conditions, and no expected value.

Φ by its series and Mills' continued fraction, inverses by bisection, Θ as a difference of squared residuals, binomial
tails by the continued fraction of the incomplete beta function, tails of quadratic statistics by integrals, f32 by
rounding f64, reports by `struct`.
"""

import struct
from fractions import Fraction

from mpmath import besseli, exp, hyp1f1, isinf, log, loggamma, matrix, mpf, pi, quad, sqrt


def real(value):
    """An mpf of a float or a whole number without loss, of a fraction to all digits."""
    return mpf(value.numerator) / value.denominator if isinstance(value, Fraction) else mpf(value)


def lower(x):
    """Φ(x)."""
    x = real(x)
    if x > 0:
        return 1 - lower(-x)
    if x < -10000:
        return mpf(0)
    density = exp(-x * x / 2) / sqrt(2 * pi)
    if x > -5:
        term, total, n = x, x, 1
        while abs(term) > mpf(10) ** -45:
            n += 2
            term *= x * x / n
            total += term
        return mpf(1) / 2 + density * total
    ratio = mpf(0)
    for n in range(int(4000 / float(-x)) + 60, 0, -1):
        ratio = n / (-x + ratio)
    return density / (-x + ratio)


def bisect(function, low, high):
    """Where an increasing function changes sign."""
    for _ in range(150):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        low, high = (middle, high) if function(middle) < 0 else (low, middle)
    return (low + high) / 2


def inverse(p):
    p = real(p)
    if p > mpf(1) / 2:
        return -inverse(1 - p)
    return (
        bisect(lambda x: lower(x) - p, mpf(-40), mpf(0))
        if p < 0.49
        else bisect(lambda x: lower(x) - p, mpf(-1) / 10, mpf(0))
    )


def normal_cdf(a):
    return {"p": lower(a["x"])}


def normal_quantile(a):
    return {"x": inverse(a["p"])}


def two_afc(a):
    return {"p_correct": lower(real(a["gamma"]) / sqrt(mpf(2)))}


def gamma_from_two_afc(a):
    return {"gamma": inverse(a["p_correct"]) * sqrt(mpf(2))}


def error_rates(a):
    """Of Θ's two normal laws, standardised."""
    g, eta = real(a["gamma"]), real(a["eta"])
    if g == 0:
        return {"false_alarm": mpf(eta <= 0), "miss": mpf(eta > 0)}
    mean = g**2 / 2
    return {"false_alarm": lower((-mean - eta) / g), "miss": lower((eta - mean) / g)}


def roc(a):
    g = real(a["gamma"])
    miss = [mpf(1 - p) if p in (0, 1) else lower(-inverse(p) - g) for p in a["false_alarm"]]
    return {"miss": miss, "auc": lower(g / sqrt(mpf(2)))}


def threshold(a):
    kind = a["criterion"]
    if kind == "map":
        return {"eta": log(1 - real(a["prior_h1"])) - log(real(a["prior_h1"]))}
    if kind == "bayes":
        p, costs = real(a["prior_h1"]), {k: real(v) for k, v in a.items() if k.startswith("c") and k != "criterion"}
        return {"eta": log(1 - p) - log(p) + log(costs["c10"] - costs["c00"]) - log(costs["c01"] - costs["c11"])}
    g = real(a["gamma"])
    if kind == "neyman_pearson_miss":
        return {"eta": (g / 2 + inverse(a["max_miss"])) * g}
    return {"eta": (-g / 2 - inverse(a["max_false_alarm"])) * g}


def required_gamma(a):
    return {"gamma": max(mpf(0), -(inverse(a["max_false_alarm"]) + inverse(a["max_miss"])))}


def noise_budget(a):
    gamma = required_gamma(a)["gamma"]
    total = real(a["signal_n"]) / gamma
    left = (total - norm(a["sources_n"])) * (total + norm(a["sources_n"]))
    return {"gamma": gamma, "total_allowed_n": total, "remaining_n": sqrt(max(left, mpf(0)))}


def norm(values):
    return sqrt(sum(real(v) ** 2 for v in values))


def matched_filter(a):
    count = len(a["template_x"])
    b = {c: norm(a[f"template_{c}"]) / sqrt(mpf(count)) for c in "xy"}
    s = {c: real(a[f"noise_sd_{c}"]) / sqrt(mpf(count)) for c in "xy"}
    return {
        "b_x": b["x"],
        "b_y": b["y"],
        "sigma_x": s["x"],
        "sigma_y": s["y"],
        "gamma": norm([b["x"] / s["x"], b["y"] / s["y"]]),
    }


def likelihood_ratio(residual, template, deviation):
    """½ Σ [r² − (r − Δ)²]/s²."""
    return sum(r**2 - (r - d) ** 2 for r, d in zip(residual, template)) / (2 * real(deviation) ** 2)


def theta(a):
    answer, total, gamma2 = {}, mpf(0), mpf(0)
    for c in "xy":
        p, f0, f1 = ([real(v) for v in a[f"{name}_{c}"]] for name in ("observed", "f0", "f1"))
        r, d, s = [x - y for x, y in zip(p, f0)], [x - y for x, y in zip(f1, f0)], real(a[f"noise_sd_{c}"])
        b = norm(d) / sqrt(mpf(len(d)))
        # The convolution of the record with h(t) = Δ(−t)/‖Δ‖ at t = 0, as (2) and (5) print it.
        h = {-i: v / b for i, v in enumerate(d)} if b else {}
        answer[f"y_{c}"] = sum((r[i] * h[-i] for i in range(len(r))), mpf(0)) / len(r) if b else mpf(0)
        total += likelihood_ratio(r, d, s)
        gamma2 += sum(v * v for v in d) / s**2
    return {"theta": total, **answer, "gamma": sqrt(gamma2)}


def theta_colored(a):
    k = matrix([[real(v) for v in row] for row in a["covariance"]]) ** -1
    r, d = matrix([real(v) for v in a["residual"]]), matrix([real(v) for v in a["template"]])
    square = lambda v: (v.T * k * v)[0]
    return {"theta": (square(r) - square(r - d)) / 2, "gamma": sqrt(square(d))}


def beside(nuisances, others):
    """By elimination in the exact Gram matrix of all signals: that of what the nuisances leave of the others, the squares that each
    other had, and how many nuisances count."""
    columns = [[Fraction(v) for v in column] for column in (*nuisances, *others)]
    gram = [[sum(x * y for x, y in zip(p, q)) for q in columns] for p in columns]
    squares, rank, count = [row[k] for k, row in enumerate(gram)], 0, len(nuisances)
    for k in range(count):
        pivot_row = gram[k]
        if pivot_row[k] == 0 or pivot_row[k] * 10**18 < squares[k]:
            continue
        rank += 1
        for i in range(k + 1, len(gram)):
            factor = gram[i][k] / pivot_row[k]
            gram[i] = [x - factor * y for x, y in zip(gram[i], pivot_row)]
    return [row[count:] for row in gram[count:]], squares[count:], rank


def ratio(value):
    return mpf(value.numerator) / value.denominator


def theta_nuisances(a):
    """θ is the ratio of the two likelihoods; the threshold is where it passes η."""
    gram, squares, rank = beside(a["nuisances"], [a["template"], a["residual"]])
    dd, dz, zz = ratio(gram[0][0]), ratio(gram[0][1]), ratio(gram[1][1])
    residual, nu, eta = ratio(gram[1][1] - gram[0][1] ** 2 / gram[0][0]), len(a["residual"]) - rank - 1, real(a["eta"])
    level = sqrt(residual / nu) if a["level"] == "unknown" else mpf(1)
    g, bias = sqrt(dd) / level, real(a["bias"]) / level
    if a["level"] == "known":
        value, tau = (zz - (zz - 2 * dz + dd)) / 2, (eta + g**2 / 2) / g
        above = lambda x: lower(-x)
    else:
        value = log(zz / (zz - 2 * dz + dd)) * (nu + 1) / 2
        excess = lambda t: log((nu + t * t) / (nu + (t - g) ** 2)) * (nu + 1) / 2 - eta
        reach = sqrt(g**2 / 4 + nu)
        least, most = g / 2 - reach, g / 2 + reach
        if excess(most) < 0 or excess(least) > 0:
            tau = mpf("inf" if excess(most) < 0 else "-inf")
        else:
            tau = bisect(excess, least, most)
        above = lambda x: mpf(x < 0) if isinf(x) else student_tail({"x": x, "degrees": nu, "noncentrality": 0})["upper"]
    return {
        "t": dz / sqrt(dd) / level,
        "gamma": g,
        "gamma_nominal": sqrt(ratio(squares[0])),
        "residual": residual,
        "theta": value,
        "false_alarm": above(tau - bias),
        "miss": above(g - bias - tau),
        "rank": rank,
        "degrees": nu,
    }


def bank_posterior(a):
    """By Bayes' theorem for no inclusion and each hypothesis, with the ratios of likelihoods themselves."""
    gram, squares, rank = beside(a["nuisances"], [*a["templates"], a["residual"]])
    without, theta, distinct = gram[-1][-1], [], []
    for k, prior in enumerate(a["prior"]):
        given = without - 2 * gram[k][-1] + gram[k][k]
        if gram[k][k] * 10**18 <= squares[k]:
            theta.append(mpf(0))
            continue
        if a["level"] == "known":
            theta.append(ratio((without - given) / 2))
        else:
            theta.append(log(ratio(without / given)) * (len(a["residual"]) - rank) / 2)
        if prior > 0:
            distinct.append(k)
    joint = [real(a["prior_h1"]) * real(prior) * exp(value) for prior, value in zip(a["prior"], theta)]
    inclusion, none = sum(joint), 1 - real(a["prior_h1"])
    best = max(distinct, key=lambda k: (theta[k], -k))
    return {
        "theta": theta,
        "theta_mixture": log(inclusion / real(a["prior_h1"])),
        "theta_max": theta[best],
        "hypothesis": best,
        "posterior_h1": inclusion / (inclusion + none),
        "posterior": [part / inclusion for part in joint],
    }


def scan(a):
    values = []
    for shift in range(len(a["residual_x"]) - len(a["template_x"]) + 1):
        part = lambda c: (
            [real(v) for v in a[f"residual_{c}"][shift:]],
            [real(v) for v in a[f"template_{c}"]],
            a[f"noise_sd_{c}"],
        )
        values.append(likelihood_ratio(*part("x")) + likelihood_ratio(*part("y")))
    best = max(range(len(values)), key=lambda i: (round(values[i] * mpf(10) ** 25), -i))
    return {"theta": values, "max_theta": values[best], "argmax": best}


def beta_tail(k, n, p):
    """Pr(at least k of n) = I_p(k, n − k + 1), by its continued fraction (Lentz)."""
    a, b = mpf(k), mpf(n - k + 1)
    if p > (a + 1) / (a + b + 2):
        return 1 - beta_fraction(b, a, 1 - p)
    return beta_fraction(a, b, p)


def beta_fraction(a, b, x):
    front = exp(loggamma(a + b) - loggamma(a) - loggamma(b) + a * log(x) + b * log(1 - x)) / a
    c, d = mpf(1), 1 / (1 - (a + b) * x / (a + 1))
    value = d
    for m in range(1, 100000):
        m = mpf(m)
        for step in (
            m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)),
        ):
            d, c = 1 / (1 + step * d), 1 + step / c
            value *= c * d
        if abs(c * d - 1) < mpf(10) ** -30:
            return front * value
    raise ArithmeticError("no convergence")


def proportion_interval(a):
    k, n = a["successes"], a["trials"]
    tail = (1 - real(a["confidence"])) / 2
    if a["method"] == "wilson":
        z, p = inverse(tail), mpf(k) / n
        off = lambda x: (p - x) ** 2 - z * z * x * (1 - x) / n
        low = mpf(0) if k == 0 else bisect(lambda x: -off(x), mpf(0), p)
        high = mpf(1) if k == n else bisect(off, p, mpf(1))
        return {"lower": low, "upper": high}
    return {"lower": exact_limit(k, n, tail), "upper": 1 - exact_limit(n - k, n, tail)}


def exact_limit(k, n, tail):
    """By secants on the logarithm of the tail, in that of p."""
    if k == 0:
        return mpf(0)
    f = lambda t: log(beta_tail(k, n, exp(t)) / tail)
    p = mpf(k) / (n + 1)
    old, new = log(p), log(p) - mpf(1) / 10 / sqrt(mpf(k))
    f_old, f_new = f(old), f(new)
    for _ in range(60):
        if abs(new - old) < mpf(10) ** -22 or f_new == f_old:
            return exp(new)
        step = f_new * (new - old) / (f_new - f_old)
        step = max(min(step, mpf(1)), mpf(-1))
        old, f_old, new = new, f_new, min(new - step, log(1 - mpf(10) ** -9 / n))
        f_new = f(new)
    raise ArithmeticError("no convergence")


def tail_by_density(density, x, is_upper, width):
    """The integral of a density beyond x, in ln x, over intervals of growing length until nothing is added."""
    total, at = mpf(0), log(x)
    # mpmath's quadrature has an absolute tolerance.
    unit = density(x) * x
    while True:
        to = at + width if is_upper else at - width
        part = abs(quad(lambda u: density(exp(u)) * exp(u) / unit, [at, to], method="gauss-legendre", maxdegree=5))
        total += part
        if part <= total * mpf(10) ** -25:
            return total * unit
        at, width = to, width * mpf("1.3")


def two_tails(density, x, mean, deviation):
    if x == 0:
        return {"lower": mpf(0), "upper": mpf(1)}
    tail = tail_by_density(density, x, x >= mean, min(mpf(1), deviation / mean) / 8)
    return {"lower": 1 - tail, "upper": tail} if x >= mean else {"lower": tail, "upper": 1 - tail}


def chi_square_tail(a):
    x, k, lam = real(a["x"]), real(a["degrees"]), real(a["noncentrality"])
    if lam < mpf(10) ** -60:
        front = loggamma(k / 2)
        density = lambda v: exp((k / 2 - 1) * log(v / 2) - v / 2 - front) / 2
    else:
        bessel = lambda v: (v / lam) ** (k / 4 - mpf(1) / 2) * besseli(k / 2 - 1, sqrt(lam * v))
        density = lambda v: exp(-(v + lam) / 2) * bessel(v) / 2
    return two_tails(density, x, k + lam, sqrt(2 * (k + 2 * lam)))


def f_tail(a):
    x, m, n = (real(a[key]) for key in ("x", "numerator", "denominator"))
    h = real(a["noncentrality"]) / 2
    front = loggamma(m / 2) + loggamma(n / 2) - loggamma((m + n) / 2)

    def density(v):
        share = m * v / (n + m * v)
        power = m / 2 * log(share) + n / 2 * log(n / (n + m * v))
        return exp(power - front - h) / v * hyp1f1((m + n) / 2, m / 2, h * share)

    mean = (m + 2 * h) / m
    return two_tails(density, x, mean, mean * sqrt(2 / n + 2 * (m + 4 * h) / (m + 2 * h) ** 2))


def student_tail(a):
    """The mean of Φ(x √(G/c) − δ) over the gamma law of shape c, by the trapezoidal rule in ln(G/c)."""
    x, c, delta = real(a["x"]), real(a["degrees"]) / 2, real(a["noncentrality"])
    step = min(mpf(1) / 40, 1 / sqrt(c) / 2, 1 / (1 + abs(delta)) / 2)
    front = exp(c * log(c) - c - loggamma(c)) * step
    law = lambda u: exp(c * (u + 1 - exp(u)))
    below = lambda u: law(u) * lower(x * exp(u / 2) - delta)
    above = lambda u: law(u) * lower(delta - x * exp(u / 2))
    # Where x √(G/c) is no large number any more.
    least = int((-2 * log(1 + abs(x)) - 10) / step)
    return {key: front * sum_outwards(part, step, least) for key, part in (("lower", below), ("upper", above))}


def sum_outwards(part, step, least):
    """Σ part(i step) over all whole i, from the largest of a coarse grid that begins at `least`."""
    size = lambda i: part(i * step)
    best = max(range(least, int(10 / step), 64), key=size)
    best = max(range(best - 64, best + 65, 4), key=size)
    total = size(best)
    for way in (1, -1):
        i, term = best, total
        while term > total * mpf(10) ** -25:
            i += way
            term = size(i)
            total += term
    return total


def count_analysis(a):
    """χ² as Pearson's, of right and wrong answers."""
    columns, t = list(zip(*a["correct"])), a["trials"]
    pooled, chi2, n = [sum(c) for c in columns], [], len(a["correct"])
    for c, total in zip(columns, pooled):
        right = mpf(total) / n
        chi2.append(sum((k - right) ** 2 / right + (t - k - (t - right)) ** 2 / (t - right) for k in c))
    rate = [mpf(total) / (n * t) for total in pooled]
    return {
        "pooled": pooled,
        "rate": rate,
        "gamma": [sqrt(mpf(2)) * inverse(p) for p in rate],
        "chi2": chi2,
        "df": n - 1,
    }


def interpolate(a):
    """The polynomial c0 + c1 x + c2 d + c3 x d through the cell's four corners, by divided differences."""
    d, x = Fraction(a["depth_m"]), Fraction(a["lateral_m"])
    place = lambda axis, at: max(0, min(sum(k <= at for k in axis) - 1, len(axis) - 2))
    i, j = place(a["depths_m"], d), place(a["laterals_m"], x)
    (d0, d1), (x0, x1) = (
        tuple(Fraction(v) for v in axis[k : k + 2]) for axis, k in ((a["depths_m"], i), (a["laterals_m"], j))
    )
    (f00, f01), (f10, f11) = ([Fraction(v) for v in row[j : j + 2]] for row in a["table_n"][i : i + 2])
    by_x, by_d = (f01 - f00) / (x1 - x0), (f10 - f00) / (d1 - d0)
    twist = ((f11 - f10) / (x1 - x0) - by_x) / (d1 - d0)
    return {"force_n": f00 + by_x * (x - x0) + by_d * (d - d0) + twist * (x - x0) * (d - d0)}


def f32(value):
    """An f64 result of one operation on f32 numbers, rounded again: the same as rounding once, since 53 ≥ 2·24 + 2."""
    try:
        return struct.unpack("<f", struct.pack("<f", value))[0]
    except OverflowError:
        return float("inf") if value > 0 else float("-inf")


def from_bits(text):
    return struct.unpack(">f", bytes.fromhex(text[2:]))[0]


def to_bits(value):
    return "0x" + struct.pack(">f", value).hex()


def locate(knots, x):
    j = max(0, min(sum(k <= x for k in knots) - 1, len(knots) - 2))
    t = f32(f32(x - knots[j]) * f32(1.0 / f32(knots[j + 1] - knots[j])))
    if x < knots[0]:
        return j, max(-1.0, t)
    return j, min(2.0, max(1.0, t)) if x >= knots[-1] else min(1.0, t)


def servo_axis(a):
    j, t = locate(a["knots"], from_bits(a["coordinate_bits"]))
    return {"cell": j, "fraction_bits": to_bits(t)}


def servo_interpolate(a):
    d, x = from_bits(a["depth_bits"]), from_bits(a["lateral_bits"])
    if d < 0:
        return {"force_bits": to_bits(0.0)}

    def mix(p, q, t):
        value = f32(f32(f32(1.0 - t) * p) + f32(t * q))
        return sorted((p, q, value))[1] if 0 <= t <= 1 else value

    (i, s), (j, t) = locate(a["depth_knots"], d), locate(a["lateral_knots"], x)
    rows = [[from_bits(b) for b in row[j : j + 2]] for row in a["table_bits"][i : i + 2]]
    return {"force_bits": to_bits(mix(mix(*rows[0], t), mix(*rows[1], t), s))}


FORMATS = {1: "<BhhBBHH", 2: "<BhhHB", 3: "<B8H", 4: "<BB"}
FIELDS = {
    1: ["report", "lateral", "normal", "buttons", "status", "sequence", "force_sequence"],
    2: ["report", "lateral", "normal", "sequence", "flags"],
    3: [
        "report",
        "version",
        "position_unit_nm",
        "force_unit_un",
        "largest_force_mn",
        "period_us",
        "watchdog_ms",
        "damping_mn_s_per_m",
        "friction_mn",
    ],
    4: ["report", "control"],
}


def report_decode(a):
    data = bytes.fromhex(a["bytes"])
    return dict(zip(FIELDS[data[0]], struct.unpack(FORMATS[data[0]], data)))


def report_encode(a):
    return {"bytes": struct.pack(FORMATS[a["report"]], *(a[name] for name in FIELDS[a["report"]])).hex()}


# Cowper's points and weights as tables print them: barycentric a, a, 1 − 2a, and the weight for unit area.
COWPER = ((0.445948490915965, 0.223381589678011), (0.091576213509771, 0.109951743655322))


def element_stiffness(a):
    """Σ over the points of λ div div + 2μ ε:ε, of the printed rule (15 digits)."""
    nodes = [[real(v) for v in node] for node in a["nodes_m"]]
    e, nu = real(a["youngs_modulus_pa"]), real(a["poissons_ratio"])
    lam, mu = e * nu / (1 + nu) / (1 - 2 * nu), e / 2 / (1 + nu)
    k = matrix(12, 12)
    for at, weight in COWPER:
        for turn in range(3):
            l = [real(at)] * 3
            l[turn] = 1 - 2 * real(at)
            # ∂N/∂L, as if the three were independent.
            by = [[4 * l[m] - 1 if m == c else mpf(0) for m in range(3)] for c in range(3)]
            by += [
                [4 * l[q] if m == p else 4 * l[p] if m == q else mpf(0) for m in range(3)]
                for p, q in ((0, 1), (1, 2), (2, 0))
            ]
            j = matrix(2, 2)
            for n, g in zip(nodes, by):
                for c in (0, 1):
                    for m in (1, 2):
                        j[c, m - 1] += n[c] * (g[m] - g[0])
            inv, det = j**-1, j[0, 0] * j[1, 1] - j[0, 1] * j[1, 0]
            grad = [[sum((g[m] - g[0]) * inv[m - 1, c] for m in (1, 2)) for c in (0, 1)] for g in by]
            for p in range(12):
                for q in range(12):
                    (na, ca), (nb, cb) = divmod(p, 2), divmod(q, 2)
                    ga, gb = grad[na], grad[nb]
                    strain = ga[cb] * gb[ca] + (ga[0] * gb[0] + ga[1] * gb[1] if ca == cb else 0)
                    k[p, q] += weight * det / 2 * (lam * ga[ca] * gb[cb] + mu * strain)
    return {"stiffness": [[k[p, q] for q in range(12)] for p in range(12)]}

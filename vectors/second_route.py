"""A second route to the expected answers, without the generator: check.py compares the answers, and the conditions of the
cases are derivatives of the formulas. The toy right.py computes the ops that it has, with fractions and decimals. The others
are here: tails of quadratic statistics by integrals, θ as a ratio of likelihoods, f32 by rounding f64, and Cowper's points
with printed digits.
"""

import struct
import sys
from fractions import Fraction
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "conform" / "tests" / "toys"))

import right
from mpmath import besseli, exp, hyp1f1, isinf, log, loggamma, matrix, mpf, quad, sqrt
from special import cdf


def rational(value):
    """The exact value of a float, a whole number, a decimal or an mpf; 0 for an mpf far below every f64."""
    if isinstance(value, mpf):
        sign, mantissa, exponent, _ = value._mpf_
        if exponent < -5000:
            return Fraction(0)
        return (-1) ** sign * Fraction(mantissa) * Fraction(2) ** exponent
    return Fraction(value)


def real(value):
    """An mpf of a float or a whole number without loss, of a fraction to all digits."""
    return mpf(value.numerator) / value.denominator if isinstance(value, Fraction) else mpf(value)


def lower(x):
    """Φ(x)."""
    return real(Fraction(cdf(right.decimal(rational(x)))))


def bisect(function, low, high):
    """Where an increasing function changes sign."""
    for _ in range(150):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        low, high = (middle, high) if function(middle) < 0 else (low, middle)
    return (low + high) / 2


def beside(nuisances, others):
    """Eliminates the nuisances from the exact Gram matrix of all signals. Returns the Gram matrix of what they leave of the
    others, the squares of the others before, and the rank of the nuisances."""
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


def theta_nuisances(a):
    """θ is the ratio of the two likelihoods; the threshold is where it passes η."""
    gram, squares, rank = beside(a["nuisances"], [a["template"], a["residual"]])
    dd, dz, zz = real(gram[0][0]), real(gram[0][1]), real(gram[1][1])
    residual, nu, eta = real(gram[1][1] - gram[0][1] ** 2 / gram[0][0]), len(a["residual"]) - rank - 1, real(a["eta"])
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
        "gamma_nominal": sqrt(real(squares[0])),
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
            theta.append(real((without - given) / 2))
        else:
            theta.append(log(real(without / given)) * (len(a["residual"]) - rank) / 2)
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


def sequential_evidence(a):
    """For every beginning of the record the exact Gram matrix, and the test by the ratio of likelihoods itself."""
    count = len(a["templates"])
    answer = {"inclusion_at": [0] * count, "no_inclusion_at": [0] * count}
    for rows in range(1, len(a["residual"]) + 1):
        first = lambda columns: [column[:rows] for column in columns]
        gram, squares, rank = beside(first(a["nuisances"]), first([*a["templates"], a["residual"]]))
        kept = [gram[k][k] * 10**18 > squares[k] for k in range(count)]
        theta = [real(gram[k][-1] - gram[k][k] / 2) if kept[k] else mpf(0) for k in range(count)]
        for k, ratio in enumerate(map(exp, theta)):
            if answer["inclusion_at"][k] + answer["no_inclusion_at"][k] == 0:
                answer["inclusion_at"][k] = rows * (ratio * real(a["max_false_alarm"]) >= 1)
                answer["no_inclusion_at"][k] = rows * (ratio <= real(a["max_miss"]))
    gamma = [sqrt(real(gram[k][k])) if kept[k] else mpf(0) for k in range(count)]
    return {**answer, "theta": theta, "gamma": gamma, "residual": real(gram[-1][-1]), "rank": rank}


def normal_density(covariance, record):
    """ln of the density without (2π)^(−n/2), and the distance squared, by elimination in the exact matrix with the record as another
    row and column: the pivots are the determinant's factors, and the last entry is −yᵀK⁻¹y."""
    rows = [row + [y] for row, y in zip(covariance, record)] + [record + [Fraction(0)]]
    determinant = Fraction(1)
    for k in range(len(record)):
        if rows[k][k] <= 0:
            raise right.Refused("out_of_range", "not positive definite")
        determinant *= rows[k][k]
        for i in range(k + 1, len(rows)):
            factor = rows[i][k] / rows[k][k]
            rows[i] = [x - factor * y for x, y in zip(rows[i], rows[k])]
    distance = real(-rows[-1][-1])
    return -(distance + log(real(determinant))) / 2, distance


def robust_evidence(a):
    """Each law of its own whole covariance, and the sums of densities as they stand."""
    record, means, shape = ([[Fraction(v) for v in row] for row in rows] for rows in ([a["record"]], a["signals"], a["shape"]))
    n, whole = len(record[0]), sum(map(Fraction, a["weights"]))
    noise = [Fraction(v) for v in a["noise"]]
    sizes, prior = [0, *a["sizes"]], [0, *map(real, a["prior"])]
    laws = []
    for number, weight in enumerate(a["weights"]):
        rows = [[Fraction(v) for v in row] for row in a["covariances"][number * n : number * n + n]]
        for mean, size in zip([[Fraction(0)] * n, *means], sizes):
            share = (Fraction(3, 20) * Fraction(size)) ** 2
            entry = lambda i, j: rows[i][j] + (i == j) * noise[i] + share * shape[i][j] + Fraction(4, 25) * mean[i] * mean[j]
            covariance = [[entry(i, j) for j in range(n)] for i in range(n)]
            density, distance = normal_density(covariance, [y - m for y, m in zip(record[0], mean)])
            laws.append((log(real(Fraction(weight) / whole)) + density, distance))
    count = len(sizes)
    densities = [[exp(density) for density, _ in laws[at : at + count]] for at in range(0, len(laws), count)]
    by_class = [sum(share * density for share, density in zip(prior, row)) for row in densities]
    return {
        "without": [laws[at][0] for at in range(0, len(laws), count)],
        "by_class": [log(value) for value in by_class],
        "with": [log(sum(column)) for column in list(zip(*densities))[1:]],
        "theta": log(sum(by_class) / sum(row[0] for row in densities)),
        "distance": max(laws)[1],
    }


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


ROUTES = {
    route.__name__: route
    for route in (
        chi_square_tail, f_tail, student_tail, theta_nuisances, bank_posterior, sequential_evidence, robust_evidence, servo_axis, servo_interpolate,
        element_stiffness,
    )
}


def route(op):
    """The function from the arguments of an op to its answer; None for an op without a second route."""
    return partial(right.compute, op) if op in right.OPS else ROUTES.get(op)

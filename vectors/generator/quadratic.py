"""The laws of quadratic statistics: chi-square, F and Student's t, with a noncentrality (DET-130 … 135, 138)."""

from fractions import Fraction

from mpmath import ceil, exp, floor, log, loggamma, mp, mpf, sqrt

from .normal import cdf
from .numbers import Draws, nearest, real
from .suite import Group, absolute, refuse_common, relative

SOURCE = "Poisson mixture of central laws, mpmath 1.3.0 at 380 digits"
DIGITS = 380
"""Of the sums: 1 less a lower tail must keep 50 digits of an upper tail of 10⁻³²⁰."""


class Gamma:
    """The gamma law of shape b at y, for each b."""

    def __init__(self, y):
        self.y = y

    def step(self, b):
        """Lower tail of shape b less that of shape b + 1."""
        return exp(b * log(self.y) - self.y - loggamma(b + 1))

    def growth(self, b):
        """The step of shape b + 1, times b + 1, over that of b."""
        return self.y

    def lower(self, b):
        return self.step(b) * series(lambda n: self.y / (b + n))


class Beta:
    """The beta law of shapes b and c at y/(c + y), for each b."""

    def __init__(self, y, c):
        self.c, self.z, self.rest = c, y / (c + y), c / (c + y)

    def front(self, b, c, z, rest):
        return exp(b * log(z) + c * log(rest) + loggamma(b + c) - loggamma(b + 1) - loggamma(c))

    def step(self, b):
        return self.front(b, self.c, self.z, self.rest)

    def growth(self, b):
        return self.z * (b + self.c)

    def lower(self, b):
        shapes = (b, self.c, self.z, self.rest)
        if self.z > 0.5:
            shapes = (self.c, b, self.rest, self.z)
        p, q, z, _ = shapes
        tail = self.front(*shapes) * series(lambda n: z * (p + q + n - 1) / (p + n))
        return 1 - tail if self.z > 0.5 else tail


def series(ratio):
    """1 + ratio(1) + ratio(1) ratio(2) + …"""
    term, total, n = mpf(1), mpf(1), 0
    while term > total * mpf(10) ** -mp.dps:
        n += 1
        term *= ratio(n)
        total += term
    return total


def mixture(law, shape, h, offset=0, sign=1):
    """Σ over j ≥ 0 of sign w(j + offset) lower(j + shape), where w(r) = exp(−h) hʳ/Γ(r + 1)."""
    if h == 0:
        return law.lower(shape) if offset == 0 else mpf(0)
    reach = sqrt(5.1 * mp.dps * h)
    first, j = max(0, int(floor(h - reach))), int(ceil(h + reach)) + 2 * mp.dps
    b, r = shape + j, offset + j
    weight, step, tail = exp(r * log(h) - h - loggamma(r + 1)), law.step(b), law.lower(b)
    total = weight * tail
    while j > first:
        j, b, r = j - 1, b - 1, r - 1
        weight *= (r + 1) / h
        step *= (b + 1) / law.growth(b)
        tail += step
        total += weight * tail
    return sign * total


def chi_square(x, degrees, noncentrality, digits=DIGITS):
    """Pr(X < x) and Pr(X ≥ x)."""
    with mp.workdps(digits):
        if x > 10**12:
            # Nothing is left there, and the series would take as many terms.
            return mpf(1), mpf(0)
        x, degrees, noncentrality = real(x), real(degrees), real(noncentrality)
        return both(mixture(Gamma(x / 2), degrees / 2, noncentrality / 2) if x else mpf(0))


def f_ratio(x, numerator, denominator, noncentrality, digits=DIGITS):
    with mp.workdps(digits):
        x, m, n, noncentrality = real(x), real(numerator), real(denominator), real(noncentrality)
        return both(mixture(Beta(m * x / 2, n / 2), m / 2, noncentrality / 2) if x else mpf(0))


def student(x, degrees, noncentrality, digits=DIGITS):
    """For x ≥ 0: Pr(T < 0) and, in steps of one half, the mixture for 0 ≤ T < x, which alternates for δ < 0."""
    if x < 0:
        lower, upper = student(-x, degrees, -noncentrality, digits)
        return upper, lower
    with mp.workdps(digits):
        x, c, delta = real(x), real(degrees) / 2, real(noncentrality)
        # mpmath's erfc gives up far out.
        lower = cdf(-delta) if abs(delta) < 200 else mpf(delta < 0)
        if x:
            law, h, sign = Beta(x * x / 2, c), delta * delta / 2, 1 if delta >= 0 else -1
            half = mpf(1) / 2
            lower += (mixture(law, half, h) + mixture(law, mpf(1), h, half, sign)) / 2
        return both(lower)


def both(lower):
    """A tail that is nothing may come out as less than nothing."""
    return max(lower, mpf(0)), max(1 - lower, mpf(0))


def tails(pair):
    return {"lower": pair[0], "upper": pair[1]}


LEAST = mpf(10) ** -300
"""Above it tails have all their digits."""


def limits(pair, size):
    """DET-134, for the sum `size` of the degrees of freedom and λ or δ²."""
    bound = Fraction(1, 10**12) * (1 + Fraction(nearest(sqrt(size))) / 100)
    reason = "DET-134: 10⁻¹² (1 + √s/100) of the tail, s the degrees of freedom and λ or δ² together"
    return {
        key: relative(bound, reason)
        if tail >= LEAST
        else absolute(bound * Fraction(nearest(LEAST)), "1", "DET-134: that of a tail of 10⁻³⁰⁰")
        for key, tail in tails(pair).items()
    }


def law_case(group, comment, law, args, size, more):
    """A case of a law; `more` are the wrong answers of this law alone, as pairs of a flag and the arguments of the right law or
    the tails."""
    pair = law(**args)
    central = law(**{**args, "noncentrality": 0})
    wrong = [("tails_exchanged", (pair[1], pair[0])), ("noncentrality_ignored", central)]
    if pair[1] < 1e-17:
        wrong.append(("tail_cancelled", (pair[0], mpf(0))))
    if pair[0] < 1e-17:
        wrong.append(("tail_cancelled", (mpf(0), pair[1])))
    wrong += [(flag, law(**{**args, **found}) if isinstance(found, dict) else found) for flag, found in more]
    wrong = [(flag, tails(found)) for flag, found in wrong]
    group.accept(f"{comment}: {', '.join(map(repr, args.values()))}", args, tails(pair), wrong, tolerance=limits(pair, size))


def off_by_one(key, degrees):
    return [("degrees_off_by_one", {key: value}) for value in (degrees - 1, degrees + 1) if 0.1 <= value <= 2e6]


def law_group(name):
    reason = "DET-134; cases state their own"
    return Group(name, SOURCE, {key: relative(Fraction(1, 10**12), reason) for key in ("lower", "upper")})


def refuse_law(group, args, degrees, noncentralities, arguments):
    """What a law must refuse: `arguments` are values of x outside its range, and so on."""
    refuse_common(group, args, list(args))
    outside = [("x", value) for value in arguments]
    outside += [(key, value) for key in degrees for value in (0, -1, 0.09, 2000001, 1e300)]
    outside += [("noncentrality", value) for value in noncentralities]
    for key, value in outside:
        group.refuse(f"{key} = {value!r}", args, "out_of_range", **{key: value})


def around(draws, mean, deviation, count):
    """Arguments within a few and within many standard deviations of a mean."""
    return [mean + deviation * draws.choice([draws.decimal(-3, 3), draws.decimal(-30, 36)]) for _ in range(count)]


def noncentrality_of(draws):
    return draws.choice([0, draws.decimal(0.01, 9), draws.decimal(10, 90, 1), draws.integer(100, 3000)])


# Verifies: DET-130, DET-134, DET-005.
def chi_square_tail():
    group = law_group("chi_square_tail")
    draws = Draws(60)
    cases = [
        ("exponential law", 3.0, 2, 0),
        ("one degree: 1.96²", 3.8414588206941236, 1, 0),
        ("x = 0", 0, 5, 0),
        ("x = 0", 0, 0.1, 30),
        ("the mean", 40, 40, 0),
        ("the mean", 60, 40, 20),
        ("few degrees", 0.02, 0.1, 0),
        ("few degrees", 1.7, 0.3, 0.2),
        ("far upper tail", 1380.0, 2, 0),
        ("far upper tail", 1500.0, 40, 0),
        ("far upper tail", 4000.0, 300, 700),
        ("upper tail below the smallest number", 1800.0, 10, 0),
        ("beyond everything", 1e152, 10, 4),
        ("fits too well", 1e-4, 60, 0),
        ("fits too well", 250.0, 1000, 0),
        ("fits too well", 8.0, 200, 90),
        ("lower tail below the smallest number", 1e-12, 80, 0),
        ("tiny x", 1e-300, 1, 0),
        ("tiny λ", 5.0, 3, 1e-20),
        ("subnormal λ", 5.0, 3, 5e-324),
        ("many degrees", 2002000.0, 2000000, 0),
        ("many degrees", 19000.0, 20000, 5),
        ("large λ", 21000.0, 5, 20000),
        ("large λ, few degrees", 11000.0, 0.5, 10000.0),
    ]
    while len(cases) < 60:
        k = draws.choice([draws.integer(1, 30), draws.decimal(0.5, 50, 2), draws.integer(50, 3000)])
        lam = noncentrality_of(draws)
        for x in around(draws, k + lam, nearest(sqrt(2 * (real(k) + 2 * lam))), 1):
            if x > 0:
                cases.append(("drawn", round(x, 4), k, lam))
    for comment, x, k, lam in cases:
        more = [("noncentrality_scale", {"noncentrality": 2 * lam})] if 0 < lam <= 5e7 else []
        more += off_by_one("degrees", k)
        if lam > 1490:
            more.append(("weights_underflow", (mpf(0), mpf(1))))
        args = {"x": x, "degrees": k, "noncentrality": lam}
        law_case(group, comment, chi_square, args, real(k) + lam, more)
    args = {"x": 12.5, "degrees": 9, "noncentrality": 4}
    refuse_law(group, args, ["degrees"], [-1, -5e-324, 1.0001e8], [-1, -5e-324, 1.1e152])
    return group


# Verifies: DET-130, DET-134, DET-005.
def f_tail():
    group = law_group("f_tail")
    draws = Draws(61)
    cases = [
        ("table", 3.0, 2, 7, 0),
        ("table", 4.964602743730711, 1, 10, 0),
        ("x = 0", 0, 3, 8, 2),
        ("Cauchy's law squared", 1e6, 1, 1, 0),
        ("the mean", 1.2, 5, 12, 0),
        ("few degrees", 0.3, 0.1, 0.1, 0),
        ("few degrees", 25.0, 0.5, 0.2, 3),
        ("far upper tail", 400.0, 4, 800, 0),
        ("far upper tail", 90.0, 30, 2000, 300),
        ("far upper tail of few degrees", 1e152, 3, 5, 2),
        ("upper tail below the smallest number", 1e150, 3, 6, 2),
        ("far lower tail", 1e-8, 60, 5, 0),
        ("far lower tail", 0.05, 120, 400, 60),
        ("tiny x", 1e-300, 1, 4, 0),
        ("subnormal λ", 5.0, 3, 9, 5e-324),
        ("many degrees", 1.02, 20000, 20000, 0),
        ("many degrees of the denominator", 2.2, 9, 2000000, 7),
        ("many degrees of the numerator", 9.0, 2000000, 3, 0),
        ("large λ", 2900.0, 4, 300, 10000),
        ("large λ, few degrees", 30.0, 9, 2, 2000.0),
    ]
    while len(cases) < 55:
        m, n, lam = draws.integer(1, 40), draws.integer(1, 900), noncentrality_of(draws)
        mean = (m + lam) / m
        deviation = mean * nearest(sqrt(real(2) / n + 2 * (m + 2 * real(lam)) / (m + real(lam)) ** 2))
        for x in around(draws, mean, deviation, 1):
            if x > 0:
                cases.append(("drawn", round(x, 5), m, n, lam))
    for comment, x, m, n, lam in cases:
        more = [("noncentrality_scale", {"noncentrality": 2 * lam})] if lam else []
        more.append(("degrees_exchanged", {"numerator": n, "denominator": m}))
        more += off_by_one("denominator", n)
        if m * x < 1e5:
            more.append(("chi_square_for_f", chi_square(m * x, m, lam)))
        if lam > 1490:
            more.append(("weights_underflow", (mpf(0), mpf(1))))
        args = {"x": x, "numerator": m, "denominator": n, "noncentrality": lam}
        law_case(group, comment, f_ratio, args, real(m) + n + lam, more)
    args = {"x": 2.5, "numerator": 3, "denominator": 9, "noncentrality": 4}
    refuse_law(group, args, ["numerator", "denominator"], [-1, 1.0001e8], [-1, 1.1e152])
    return group


# Verifies: DET-130, DET-134, DET-005.
def student_tail():
    group = law_group("student_tail")
    draws = Draws(62)
    cases = [
        ("table", 2.2621571627409915, 9, 0),
        ("Cauchy's law", -1e6, 1, 0),
        ("Cauchy's law", 1.0, 1, 0),
        ("x = 0", 0, 4, 0),
        ("x = 0", 0, 4, 2.5),
        ("x = 0", 0, 4, -7.5),
        ("next to 0", 1e-150, 4, 1),
        ("few degrees", 3.0, 0.1, 1),
        ("few degrees", 3.0, 0.3, -4),
        ("far tail", 60.0, 250, 0),
        ("far tail", -45.0, 3000, 0.5),
        ("far tail of few degrees", 1e60, 5, 2),
        ("far tail of few degrees", 1e20, 0.5, -3),
        ("below the smallest number", 1e152, 3, -3),
        ("δ of the other sign", 2.0, 9, -3),
        ("δ of the other sign", 2.0, 9, -30),
        ("δ of the other sign", -8.0, 40, 12),
        ("δ of the other sign", 0.001, 1000, -36),
        ("δ of the other sign, below the smallest number", 1.0, 5, -42),
        ("subnormal δ", 1.5, 6, 5e-324),
        ("many degrees", 5.0, 2000000, 0),
        ("many degrees", 2.0, 2000000, -4),
        ("large δ", 300.0, 5, 200),
        ("large δ", 95.0, 2000, 100),
        ("large δ", -95.0, 2000, -130),
    ]
    while len(cases) < 60:
        n = draws.choice([draws.integer(1, 30), draws.decimal(1, 20, 2), draws.integer(30, 4000)])
        delta = draws.choice([0, draws.decimal(-5, 5), draws.decimal(-40, 40, 1)])
        for x in around(draws, delta, nearest(sqrt(1 + real(delta) ** 2 / (2 * n))), 1):
            cases.append(("drawn", round(x, 4), n, delta))
    for comment, x, n, delta in cases:
        more, pair = [], student(x, n, delta)
        if delta:
            more = [("noncentrality_sign", {"noncentrality": -delta})] if delta < 0 else []
            more.append(("noncentrality_scale", {"noncentrality": delta * abs(delta) if abs(delta) < 6 else delta / 2}))
        elif x:
            more = [("two_sided", (1 - 2 * min(pair), 2 * min(pair)))]
        more += off_by_one("degrees", n)
        if abs(x - delta) < 100:
            more.append(("normal_for_student", (cdf(real(x) - real(delta)), cdf(real(delta) - real(x)))))
        args = {"x": x, "degrees": n, "noncentrality": delta}
        law_case(group, comment, student, args, real(n) + real(delta) ** 2, more)
    args = {"x": 2.5, "degrees": 9, "noncentrality": -1.5}
    refuse_law(group, args, ["degrees"], [-10000.1, 10001], [-1.1e152, 1.1e152])
    return group


GROUPS = [chi_square_tail, f_tail, student_tail]

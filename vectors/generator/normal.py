"""The normal law, and the forced choice that follows from it (spec/detector.md, DET-001 … 004, 028, 030)."""

from fractions import Fraction

import mpmath
from mpmath import exp, log, mpf, pi, sqrt

from .numbers import Draws, exact, nearest, real
from .suite import Group, at_limit, in_ulp, refuse_common

SOURCE = "closed form, mpmath 1.3.0 at 50 digits"


def erfc(x):
    """Of mpmath, which gives up on huge arguments; beyond 10⁴ there is nothing within the range of f64."""
    return mpmath.erfc(x) if abs(x) < 10**4 else mpf(0 if x > 0 else 2)


def density(x):
    return exp(-x * x / 2) / sqrt(2 * pi)


def cdf(x):
    """Φ(x), with all digits in the lower tail."""
    return erfc(-real(x) / sqrt(mpf(2))) / 2


def quantile(p):
    """Φ⁻¹(p): Newton's method on ln Φ, which is concave, from the tail's side; p exact."""
    p = real(p)
    if p == mpf(1) / 2:
        return mpf(0)
    if p > mpf(1) / 2:
        return -quantile(1 - p)
    x = -sqrt(-2 * log(p)) if p < 0.3 else mpf(-1)
    for _ in range(200):
        tail = cdf(x)
        step = tail / density(x) * log(tail / p)
        x -= step
        if abs(step) <= abs(x) * mpf(10) ** -48:
            return x
    raise ArithmeticError("no convergence")


def tail_ulps(argument, error):
    """ULPs of Φ(a) for an absolute error of a, in multiples of 2⁻⁵³: Φ's own 4, and φ(a)/Φ(a) times it."""
    hazard = exact(density(argument) / cdf(argument))
    return 4 + -(-hazard * exact(error) // 1)


TAIL = "Φ's 4, and (φ/Φ)·δ for the argument's rounding δ"

CENTRE = [0.0, 0.1, 0.25, 0.5, 1.0, 1.5, 1.959963984540054, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0]
TAILS = [12.0, 15.0, 18.5, 20.0, 25.0, 30.0, 33.3, 35.0, 36.9, 37.0, 37.5, 37.6, 38.0, 38.4]


# Verifies: DET-001, DET-005.
def normal_cdf():
    reason = "DET-001: the argument is exact, so that only erfc's and the scaling's roundings remain"
    group = Group("normal_cdf", SOURCE, {"p": in_ulp(4, reason)})
    draws = Draws(1)
    arguments = [(x, "table") for x in CENTRE] + [(-x, "lower tail") for x in CENTRE[1:] + TAILS]
    arguments += [(x, "upper tail, near 1") for x in (7.0, 8.2, 8.3, 9.0, 38.0)]
    arguments += [(x, "tiny argument") for x in (5e-324, -5e-324, 2.2250738585072014e-308, 1e-20, -1e-17, 1e-8)]
    arguments += [(-38.5, "below the smallest number"), (-39.9, "underflows"), (-1e300, "underflows"), (1e300, "is 1")]
    arguments += [(-40.0, "underflows")]
    arguments += [(draws.between(-4, 4), "drawn, centre") for _ in range(25)]
    arguments += [(-draws.between(4, 37.5), "drawn, lower tail") for _ in range(35)]
    for x, kind in arguments:
        a = real(x)
        wrong = [
            ("upper_tail", {"p": cdf(-a)}),
            ("erf_for_phi", {"p": 1 - erfc(a)}),
            ("root_two_missing", {"p": erfc(-a) / 2}),
            ("density_for_cdf", {"p": density(a)}),
        ]
        if abs(x) < 1e10:
            rounded = erfc(real(nearest(-a / sqrt(mpf(2))))) / 2
            wrong += [("argument_rounded", {"p": rounded}), ("tail_cancelled", {"p": 1.0 - nearest(cdf(-a))})]
        group.accept(f"{kind}: Φ({x!r})", {"x": x}, {"p": cdf(a)}, wrong)
    refuse_common(group, {"x": 1.0}, ["x"])
    group.refuse("a list", {"x": [1.0]}, "wrong_type")
    group.refuse("a truth value", {"x": True}, "wrong_type")
    return group


PROBABILITIES = [
    0.5, 0.25, 0.75, 0.05, 0.95, 0.01, 0.99, 0.001, 0.025, 0.975, 0.84, 0.1, 0.9, 1e-6, 1e-10, 1e-20, 1e-50, 1e-100,
    1e-200, 1e-300,
]


def quantile_tolerance(p):
    """DET-001: 6 ULP below 10⁻³⁰⁶; at the median, the rounding of a number near 1 may be left."""
    if p == 0.5:
        reason = "the exact 0 may come out as a rounding of the half: 2⁻⁵³ times 1/φ(0) is less"
        return {"absolute": 2e-16, "unit": "1", "reason": reason}
    return in_ulp(6, "DET-001, below 10⁻³⁰⁶") if p < 1e-306 else None


def quantile_arguments(draws, count):
    values = [(p, "table") for p in PROBABILITIES]
    values += [(p, "subnormal") for p in (5e-324, 1e-320, 1.5e-310, 2.2250738585072014e-308)]
    values += [(p, "next to 1") for p in (1 - 2.0**-53, 1 - 2.0**-52, 1 - 1e-10, 1 - 1e-6)]
    values += [(p, "next to ½") for p in (0.5 + 2.0**-53, 0.5 - 2.0**-54, 0.5 + 1e-9, 0.5 - 1e-12)]
    values += [(draws.between(0.001, 0.999), "drawn, centre") for _ in range(count)]
    values += [
        (nearest(mpf(10) ** -draws.integer(3, 300) * (1 + real(draws.unit()))), "drawn, tail") for _ in range(count)
    ]
    return values


# Verifies: DET-001, DET-005.
def normal_quantile():
    reason = "DET-001: the argument is exact; a correction by Newton's method leaves its last roundings"
    group = Group("normal_quantile", SOURCE, {"x": in_ulp(4, reason)})
    for p, kind in quantile_arguments(Draws(2), 38):
        x = quantile(p)
        wrong = [
            ("quantile_sign", {"x": -x}),
            ("root_two_missing", {"x": x / sqrt(mpf(2))}),
            ("root_two_twice", {"x": x * sqrt(mpf(2))}),
        ]
        if 1e-17 < p < 0.4 and 1.0 - p < 1.0:
            wrong.append(("complement_rounded", {"x": -quantile(1.0 - p)}))
        own = quantile_tolerance(p)
        group.accept(f"{kind}: Φ⁻¹({p!r})", {"p": p}, {"x": x}, wrong, tolerance={"x": own} if own else None)
    refuse_common(group, {"p": 0.5}, ["p"])
    for p in (0, 1, -0.0, -0.1, 1.0000000000000002, 2, -5e-324):
        group.refuse(f"p = {p!r}", {"p": p}, at_limit(p))
    return group


# Verifies: DET-027.
def two_afc():
    reason = "Φ's 4, and at most 0.3 · 3 · 2⁻⁵³ for the quotient: (φ(a)/Φ(a))·a < 0.3 for a ≥ 0"
    group = Group("two_afc", SOURCE, {"p_correct": in_ulp(8, reason)})
    draws = Draws(3)
    gammas = [
        0.0, 1.0, 1.406, 1.426, 1.45, 2.0, 3.0, 3.29, 5.0, 8.0, 11.0, 12.0, 40.0, 1e5, 1e300, 5e-324, 1e-300, 1e-16,
        1e-8, 1e-3,
    ]
    gammas += [draws.between(0, 6) for _ in range(30)] + [draws.decimal(0, 12, 2) for _ in range(15)]
    for gamma in gammas:
        a = real(gamma) / sqrt(mpf(2))
        wrong = [
            ("root_two_missing", {"p_correct": cdf(real(gamma))}),
            ("root_two_twice", {"p_correct": cdf(a / sqrt(mpf(2)))}),
            ("upper_tail", {"p_correct": cdf(-a)}),
            ("erf_for_phi", {"p_correct": 1 - erfc(a)}),
        ]
        if gamma < 1e6:
            wrong.append(("gamma_squared", {"p_correct": cdf(real(gamma) ** 2 / sqrt(mpf(2)))}))
        group.accept(f"γ = {gamma!r}", {"gamma": gamma}, {"p_correct": cdf(a)}, wrong)
    refuse_common(group, {"gamma": 1.0}, ["gamma"])
    for gamma in (-1, -5e-324, -1e300):
        group.refuse(f"γ = {gamma!r}", {"gamma": gamma}, "out_of_range")
    return group


# Verifies: DET-027.
def gamma_from_two_afc():
    reason = "Φ⁻¹'s 4 (6 below 10⁻³⁰⁶), √2 and the product"
    group = Group("gamma_from_two_afc", SOURCE, {"gamma": in_ulp(8, reason)})
    draws = Draws(4)
    values = [(0.84, "the paper's 84 %: not 1.45"), (nearest(Fraction(253, 300)), "Table 1, FEM data, 6.6 mm")]
    for p, kind in values + quantile_arguments(draws, 17):
        x = quantile(p)
        root = sqrt(mpf(2))
        wrong = [
            ("root_two_missing", {"gamma": x}),
            ("root_two_twice", {"gamma": 2 * x}),
            ("quantile_sign", {"gamma": -root * x}),
            ("gamma_squared", {"gamma": 2 * x * x}),
        ]
        tolerance = {"gamma": quantile_tolerance(p)} if p == 0.5 else None
        group.accept(f"{kind}: p = {p!r}", {"p_correct": p}, {"gamma": root * x}, wrong, tolerance=tolerance)
    refuse_common(group, {"p_correct": 0.84}, ["p_correct"])
    for p in (0, 1, -0.1, 1.5):
        group.refuse(f"p = {p!r}", {"p_correct": p}, at_limit(p))
    return group


GROUPS = [normal_cdf, normal_quantile, two_afc, gamma_from_two_afc]

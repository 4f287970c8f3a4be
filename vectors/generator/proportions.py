"""Intervals of a proportion, and the counts of a forced choice (DET-121 … 123, spec/errata.md ERR-004, ERR-007)."""

from contextlib import suppress
from fractions import Fraction

from mpmath import exp, log, loggamma, mpf, sqrt

from .normal import SOURCE, density, quantile
from .numbers import UNIT, Draws, exact, real
from .suite import Group, absolute, at_limit, case_by_case, in_ulp, is_exact, refuse_common, without


def mass(k, n, p):
    """The binomial probability of k among n."""
    choose = loggamma(n + 1) - loggamma(k + 1) - loggamma(n - k + 1)
    return exp(choose + k * log(p) + (n - k) * log(1 - p))


def upper_tail(k, n, p):
    """Pr(at least k of n), summed from k on: the terms fall by their ratio until they no longer count."""
    if k <= p * n:
        return 1 - lower_tail(k - 1, n, p)
    term = mass(k, n, p)
    total, odds = mpf(0), p / (1 - p)
    while k <= n and term > total * mpf(10) ** -45:
        total += term
        term *= odds * (n - k) / (k + 1)
        k += 1
    return total


def lower_tail(k, n, p):
    """Pr(at most k of n)."""
    if k >= n:
        return mpf(1)
    return upper_tail(n - k, n, 1 - p) if k <= p * n else 1 - upper_tail(k + 1, n, p)


def limit(k, n, tail):
    """p with Pr(at least k of n) = tail, 0 < k ≤ n: Newton's method on the logarithm, from Wilson's limit."""
    low, high = mpf(0), mpf(1)
    p = wilson(k, n, -quantile(tail))[0]
    if not 0 < p < 1:
        p = mpf(k) / (n + 1)
    for _ in range(200):
        value = upper_tail(k, n, p)
        low, high = (low, p) if value > tail else (p, high)
        slope = k * mass(k, n, p) / p
        step = value / slope * log(value / tail)
        new = p - step
        if not low < new < high:
            new = (low + high) / 2
        if abs(new - p) <= abs(p) * mpf(10) ** -40:
            return new
        p = new
    raise ArithmeticError("no convergence")


def clopper_pearson(k, n, tail):
    lower = mpf(0) if k == 0 else limit(k, n, tail)
    upper = mpf(1) if k == n else 1 - limit(n - k, n, tail)
    return lower, upper


def wilson(k, n, z):
    p, n = mpf(k) / n, mpf(n)
    middle, half = p + z * z / (2 * n), z * sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    scale = 1 + z * z / n
    return (middle - half) / scale if k else mpf(0), (middle + half) / scale if k < n else mpf(1)


def wald(k, n, z):
    p = mpf(k) / n
    half = z * sqrt(p * (1 - p) / n)
    return p - half, p + half


def corrected(k, n, z):
    """Newcombe's continuity correction of Wilson's interval."""
    p, z2 = mpf(k) / n, z * z
    root = lambda sign: sqrt(z2 + sign * 2 - mpf(1) / n + 4 * p * (n * (1 - p) - sign))
    end = lambda sign: (2 * n * p + z2 + sign + sign * z * root(sign)) / (2 * (n + z2))
    return end(-1) if k else mpf(0), end(1) if k < n else mpf(1)


def ends(pair):
    return {"lower": pair[0], "upper": pair[1]}


TAIL_ACCURACY = Fraction(1, 10**12)
"""DET-120: how well binomial tails are known."""


def clopper_pearson_bounds(k, n, tail, pair):
    """A relative error of the tail moves the end by tail/|d tail/dp|; 8 roundings of the end and of its complement. With one
    count the tail is a power, so its own roundings count instead."""
    bounds = []
    for end, at in zip(pair, (k, n - k)):
        if at == 0:
            bounds.append(Fraction(0))
            continue
        p = end if at == k and end is pair[0] else 1 - end
        slope = at * mass(at, n, p) / p
        bounds.append(exact(tail / slope) * TAIL_ACCURACY + 8 * UNIT * exact(end))
    return bounds


# Verifies: DET-121, DET-005.
def proportion_interval():
    group = Group("proportion_interval", SOURCE + "; tails summed term by term", case_by_case(["lower", "upper"]))
    draws = Draws(50)
    counts = [
        (253, 300), (288, 300), (0, 30), (30, 30), (1, 30), (29, 30), (15, 30), (0, 1), (1, 1), (1, 2), (0, 1000000),
        (1000000, 1000000), (1, 1000000), (500000, 1000000), (999999, 1000000), (50, 100000),
    ]
    cases = [(k, n, 0.95) for k, n in counts] + [(25, 30, c) for c in (0.5, 0.9, 0.99, 0.999999, 1e-6)]
    cases += [(0, 30, 1e-6), (30, 30, 0.999999), (3, 10, 0.9999999999)]
    while len(cases) < 60:
        n = draws.integer(2, 400)
        cases.append((draws.integer(0, n), n, draws.choice([0.8, 0.9, 0.95, 0.99])))
    for k, n, confidence in cases:
        tail = (1 - real(confidence)) / 2
        z = -quantile(tail)
        exact_pair, score = clopper_pearson(k, n, tail), wilson(k, n, z)
        bounds = clopper_pearson_bounds(k, n, tail, exact_pair)
        comment = f"{k} of {n}, confidence {confidence!r}"
        args = {"successes": k, "trials": n, "confidence": confidence}
        shared = [("wald_interval", ends(wald(k, n, z)))]
        wrong = shared + [
            ("one_sided_interval", ends(clopper_pearson(k, n, 2 * tail))),
            ("wilson_for_clopper_pearson", ends(score)),
        ]
        if 0 < k < n:
            wrong.append(("clopper_pearson_off_by_one", ends((exact_pair[0], 1 - limit(n - k + 1, n, tail)))))
        reason = "10⁻¹² of the tail (DET-120) over its slope in p, and 8 roundings; 0 and 1 are exact"
        limits = ends([absolute(bound, "1", reason) for bound in bounds])
        args["method"] = "clopper_pearson"
        group.accept("Clopper–Pearson: " + comment, args, ends(exact_pair), wrong, tolerance=limits)

        wrong = shared + [
            ("one_sided_interval", ends(wilson(k, n, -quantile(2 * tail)))),
            ("wilson_for_clopper_pearson", ends(exact_pair)),
        ]
        if n <= 1000 and z * z > 3:
            wrong.append(("continuity_corrected", ends(corrected(k, n, z))))
        n_, p, z2 = mpf(n), mpf(k) / n, z * z
        size = (p + z2 / (2 * n_) + z * sqrt(p * (1 - p) / n_ + z2 / (4 * n_ * n_))) / (1 + z2 / n_)
        # Below ½, 1 − confidence is rounded, and z moves by that over its density.
        rounded = exact(tail / density(z)) * UNIT if confidence < 0.5 else 0
        bound = 24 * UNIT * exact(size) + 2 * rounded * exact(sqrt(mpf(k) * (n - k) / n_**3) + z / n_)
        reason = (
            "24 · 2⁻⁵³ of the sum of the terms' magnitudes: z within 4 ULP enters squared, some 8 operations; "
            "for a confidence below ½ also the rounding of 1 − confidence"
        )
        limits = ends([absolute(bound, "1", reason)] * 2)
        group.accept("Wilson: " + comment, {**args, "method": "wilson"}, ends(score), wrong, tolerance=limits)
    refuse_proportions(group)
    return group


def refuse_proportions(group):
    args = {"successes": 25, "trials": 30, "confidence": 0.95, "method": "wilson"}
    refuse_common(group, args, ["successes", "trials", "confidence"])
    for method in ("wilson", "clopper_pearson"):
        args = {**args, "method": method}
        group.refuse(f"{method}: more successes than trials", args, "out_of_range", successes=31)
        group.refuse(f"{method}: no trials", args, "out_of_range", successes=0, trials=0)
        for confidence in (0, 1, -0.95, 95):
            group.refuse(f"{method}: confidence {confidence}", args, at_limit(confidence), confidence=confidence)
        group.refuse(f"{method}: successes below 0", args, "out_of_range", successes=-1)
        group.refuse(f"{method}: half a success", args, "wrong_type", successes=12.5)
    group.refuse("a method that does not exist", args, "out_of_range", method="jeffreys")
    group.refuse("no method", without(args, "method"), "missing_argument")


TABLE_1 = {
    "direct contact": [
        [30, 28, 27, 27], [30, 30, 28, 23], [30, 29, 20, 21], [28, 25, 18, 16], [27, 26, 23, 19], [30, 30, 27, 17],
        [23, 19, 18, 13], [30, 30, 30, 19], [30, 30, 29, 23], [30, 28, 27, 22],
    ],
    "FEM data": [
        [30, 30, 30, 21], [30, 30, 29, 25], [30, 29, 28, 16], [28, 29, 24, 20], [29, 25, 20, 17], [29, 29, 27, 15],
        [27, 23, 18, 15], [30, 30, 27, 20], [29, 24, 21, 16], [30, 28, 29, 24],
    ],
    "measured data": [
        [30, 22, 24, 18], [30, 28, 28, 21], [28, 27, 19, 15], [25, 19, 19, 21], [29, 24, 23, 18], [26, 21, 23, 17],
        [17, 15, 19, 18], [29, 26, 26, 13], [26, 21, 22, 15], [28, 25, 26, 18],
    ],
}


# Verifies: ORA-020, PSY-031.
def count_analysis():
    group = Group(
        "count_analysis",
        "exact fractions; Φ⁻¹ by mpmath 1.3.0 at 50 digits",
        {
            "pooled": is_exact("a sum of whole numbers"),
            "rate": in_ulp(1, "one quotient"),
            **case_by_case(["gamma", "chi2"]),
            "df": is_exact("a whole number"),
        },
    )
    draws = Draws(51)
    for name, counts in TABLE_1.items():
        analysis_case(group, f"Table 1, {name}", counts, 30)
        for c in range(4):
            analysis_case(group, f"Table 1, {name}, one condition", [[row[c]] for row in counts], 30)
    analysis_case(group, "all subjects alike: χ² = 0", [[20, 15], [20, 15], [20, 15]], 30)
    analysis_case(group, "half right: γ = 0", [[10], [20], [15]], 30)
    analysis_case(group, "worse than chance: γ < 0", [[5, 9], [7, 12]], 30)
    for _ in range(18):
        subjects, conditions, trials = draws.integer(2, 6), draws.integer(1, 4), draws.integer(5, 60)
        counts = [[draws.integer(trials // 3, trials - 1) for _ in range(conditions)] for _ in range(subjects)]
        analysis_case(group, "drawn", counts, trials)
    args = {"correct": [[20, 15], [22, 17]], "trials": 30}
    refuse_common(group, args, ["trials"], ["correct"])
    group.refuse("more right answers than trials", args, "out_of_range", correct=[[31, 15], [22, 17]])
    group.refuse("right answers below 0", args, "out_of_range", correct=[[-1, 15], [22, 17]])
    group.refuse("half an answer", args, "wrong_type", correct=[[20.5, 15], [22, 17]])
    group.refuse("no trials", args, "out_of_range", correct=[[0, 0], [0, 0]], trials=0)
    group.refuse("a row is shorter", args, "lengths_differ", correct=[[20, 15], [22]])
    group.refuse("no subjects", args, "empty", correct=[])
    group.refuse("no conditions", args, "empty", correct=[[], []])
    for kind, k in (("right", 30), ("wrong", 0)):
        comment, correct = f"all {kind}: γ would be infinite", [[k, 15], [k, 17]]
        group.refuse(comment, args, "infinite_answer", error="overflow", correct=correct)
    return group


def analysis(counts, trials):
    """Pooled counts, rates, γ and χ² of each condition, and the degrees of freedom."""
    subjects, columns = len(counts), list(zip(*counts))
    pooled = [sum(c) for c in columns]
    rates = [Fraction(k, subjects * trials) for k in pooled]
    chi2 = [sum((k - trials * p) ** 2 for k in c) / (trials * p * (1 - p)) for c, p in zip(columns, rates)]
    gamma = [sqrt(mpf(2)) * quantile(real(p)) for p in rates]
    return {"pooled": pooled, "rate": rates, "gamma": gamma, "chi2": chi2, "df": subjects - 1}


def analysis_case(group, kind, counts, trials):
    subjects, columns = len(counts), list(zip(*counts))
    ok = analysis(counts, trials)
    rates, gamma, chi2 = ok["rate"], ok["gamma"], ok["chi2"]
    gamma_bound = max(
        exact(mpf(2) ** 0.5) * UNIT * (12 * abs(exact(quantile(real(p)))) + exact(2 * real(p) * slope(p)))
        for p in rates
    )
    chi2_bound = max(
        UNIT * (sum(8 * abs(k - trials * p) * trials * p for k in c) / (trials * p * (1 - p)) + (subjects + 12) * x)
        for c, p, x in zip(columns, rates, chi2)
    )
    # Where all are alike, k − tp is a rounding error and its square no more than that.
    chi2_bound += subjects * (4 * UNIT * trials) ** 2
    wrong = [
        ("df_not_reduced", {"df": subjects}),
        ("root_two_missing", {"gamma": [g / sqrt(mpf(2)) for g in gamma]}),
        ("gamma_squared", {"gamma": [g * g for g in gamma]}),
        ("chi2_one_cell", {"chi2": [x * (1 - p) for x, p in zip(chi2, rates)]}),
        ("weight_missing", {"chi2": [x / trials for x in chi2]}),
        ("rates_swapped", {"gamma": [-g for g in gamma]}),
    ]
    with suppress(ZeroDivisionError, ValueError):
        wrong.append(("subjects_for_conditions", analysis(columns, trials)))
    limits = {
        "gamma": absolute(gamma_bound, "1", "√2 (2⁻⁵³ p/φ for the rate's rounding, 12 · 2⁻⁵³ |Φ⁻¹| for the rest)"),
        "chi2": absolute(chi2_bound, "1", "2⁻⁵³ (8 Σ |k − tp| tp/(tp(1−p)) + (n + 12) χ²): the difference cancels"),
    }
    args = {"correct": [list(row) for row in counts], "trials": trials}
    group.accept(kind, args, ok, wrong, tolerance=limits)


def slope(p):
    """dΦ⁻¹/dp."""
    return 1 / density(quantile(real(p)))


GROUPS = [proportion_interval, count_analysis]

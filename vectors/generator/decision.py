"""Rates of error, the SNR they need and the noise budget (DET-026 … 029, 100 … 101)."""

from fractions import Fraction

from mpmath import mpf, sqrt

from .normal import SOURCE, TAIL, cdf, quantile, tail_ulps
from .numbers import UNIT, Draws, exact, nearest, real
from .suite import Group, absolute, at_limit, case_by_case, in_ulp, refuse_common

QUANTILE_ROUNDINGS = 8
"""A quantile within 4 ULP, and p = ½ − tiny not cancelled, in multiples of 2⁻⁵³ of it."""


def rates(gamma, eta):
    """P_fa and P_miss of DET-026; for γ = 0 those of Θ ≡ 0."""
    if gamma == 0:
        return (mpf(1), mpf(0)) if eta <= 0 else (mpf(0), mpf(1))
    g, e = real(gamma), real(eta)
    return cdf(-(e + g * g / 2) / g), cdf((e - g * g / 2) / g)


def rates_tolerance(gamma, eta):
    """3 roundings of η/γ, 3 of γ/2 and that of their sum, through Φ."""
    if gamma == 0:
        return None
    g, e = real(gamma), real(eta)
    limits = {}
    for key, a in (("false_alarm", -(e / g + g / 2)), ("miss", e / g - g / 2)):
        if abs(a) > 50:
            continue
        count = tail_ulps(a, exact(3 * abs(e / g) + 3 * g / 2 + abs(a)))
        if count > 8:
            limits[key] = in_ulp(int(count), TAIL)
    return limits or None


def rates_case(group, gamma, eta, kind):
    pair = lambda false_alarm, miss: {"false_alarm": false_alarm, "miss": miss}
    false_alarm, miss = rates(gamma, eta)
    wrong = [
        ("rates_swapped", pair(miss, false_alarm)),
        ("hits_for_misses", {"miss": 1 - miss}),
        ("tail_cancelled", pair(1.0 - nearest(1 - false_alarm), 1.0 - nearest(1 - miss))),
    ]
    if gamma:
        g, e = real(gamma), real(eta)
        wrong += [
            ("half_left_out", pair(cdf(-(e + g * g) / g), cdf((e - g * g) / g))),
            ("variance_for_sd", pair(cdf(-(e + g * g / 2) / (g * g)), cdf((e - g * g / 2) / (g * g)))),
            ("gamma_squared", pair(*rates(nearest(sqrt(g)), eta))),
        ]
    else:
        wrong.append(("zero_gamma", pair(mpf(1) / 2, mpf(1) / 2)))
    args, comment = {"gamma": gamma, "eta": eta}, f"{kind}: γ = {gamma!r}, η = {eta!r}"
    group.accept(comment, args, pair(false_alarm, miss), wrong, tolerance=rates_tolerance(gamma, eta))


# Verifies: DET-026.
def error_rates():
    reason = "Φ's 4 ULP and 3 roundings of its argument where |argument| < 1; cases farther out state their own"
    group = Group("error_rates", SOURCE, {key: in_ulp(8, reason) for key in ("false_alarm", "miss")})
    draws = Draws(10)
    cases = [
        (2, 0.5, "table"),
        (1.0, 0.0, "table"),
        (3.3, 0.0, "the paper's γ for 5 % and 5 %"),
        (3.29, -0.2, "table"),
        (0, 0, "γ = 0: Θ ≡ 0 ≥ η"),
        (0, 1.0, "γ = 0: Θ ≡ 0 < η"),
        (0, -2.5, "γ = 0: Θ ≡ 0 ≥ η"),
        (0, 5e-324, "γ = 0, the least η above 0"),
        (1e-300, 0.0, "tiny γ"),
        (1e-300, 1.0, "tiny γ, η far out"),
        (1e-8, 1e-8, "tiny γ"),
        (1e-8, -3e-8, "tiny γ"),
        (5e-324, 0.0, "subnormal γ"),
        (100.0, 0.0, "huge γ: both underflow"),
        (1e100, 0.0, "huge γ"),
        (60.0, 1800.0, "η = γ²/2: a miss in two"),
        (60.0, -1800.0, "η = −γ²/2: a false alarm in two"),
        (60.0, 1790.0, "η near γ²/2: the argument cancels"),
        (1000.0, -499000.0, "huge γ, η near −γ²/2"),
        (10.0, 300.0, "tail of 35 σ"),
        (10.0, -300.0, "tail of 35 σ"),
        (1.0, 36.5, "tail of 37 σ"),
        (1.0, -37.0, "tail of 37.5 σ"),
        (70.0, 0.0, "tails of 35 σ"),
        (75.0, 0.0, "tails of 37.5 σ"),
        (3.0, 1e10, "η far out"),
        (3.0, -1e10, "η far out"),
    ]
    cases += [(draws.decimal(0.2, 6), draws.decimal(-4, 4), "drawn") for _ in range(45)]
    cases += [(draws.between(0.01, 12), draws.between(-60, 60), "drawn, tails") for _ in range(30)]
    for gamma, eta, kind in cases:
        rates_case(group, gamma, eta, kind)
    refuse_common(group, {"gamma": 2, "eta": 0.5}, ["gamma", "eta"])
    for gamma in (-1, -1e-300):
        group.refuse(f"γ = {gamma!r}", {"gamma": gamma, "eta": 0}, "out_of_range")
    return group


# Verifies: DET-027.
def roc():
    reason = "Φ's 4 and 3 roundings of an argument below 1; cases farther out state their own"
    group = Group("roc", SOURCE, {"miss": in_ulp(8, reason), "auc": in_ulp(8, "as of two_afc")})
    draws = Draws(11)
    alarms = [0, 0.001, 0.01, 0.05, 0.1, 0.5, 0.9, 1]
    curves = [(gamma, alarms, "a curve with both ends") for gamma in (0.0, 0.5, 1.0, 2.0, 3.3, 5.0)]
    curves += [
        (1.0, [1e-300, 1e-100, 1e-20, 1e-10], "small false alarms"),
        (3.0, [1 - 2.0**-53, 1 - 1e-10, 0.999], "false alarms near 1"),
        (38.0, [1e-10, 0.5], "far apart: misses in the tail"),
        (30.0, [1e-300, 0.5], "far apart"),
        (1e-12, [0.05, 0.5], "tiny γ"),
        (200.0, [0.05], "huge γ: misses underflow"),
        (1e300, [0.05], "huge γ"),
        (5e-324, [0.25], "subnormal γ"),
    ]
    some = lambda: [draws.decimal(0.001, 0.999) for _ in range(draws.integer(1, 5))]
    curves += [(draws.decimal(0, 7), some(), "drawn") for _ in range(34)]
    small = lambda: nearest(mpf(10) ** -draws.integer(2, 250) * real(draws.between(1, 9)))
    curves += [(draws.between(0, 12), [small() for _ in range(3)], "drawn, small false alarms") for _ in range(10)]
    for gamma, alarms, kind in curves:
        g = real(gamma)
        miss, count = [], Fraction(0)
        for p in alarms:
            if p in (0, 1):
                miss.append(mpf(1 - p))
                continue
            q = -quantile(p)
            a = q - g
            miss.append(cdf(a))
            if abs(a) < 50:
                count = max(count, tail_ulps(a, exact(QUANTILE_ROUNDINGS * abs(q) + abs(a) + abs(g) / 2)))
        by = lambda rule: {"miss": [mpf(1 - p) if p in (0, 1) else cdf(rule(p)) for p in alarms]}
        wrong = [
            ("hits_for_misses", {"miss": [1 - m for m in miss]}),
            ("rates_swapped", by(lambda p: -quantile(p) + g)),
            ("quantile_sign", by(lambda p: quantile(p) - g)),
            ("root_two_missing", {"auc": cdf(g)}),
        ]
        if all(1e-17 < p for p in alarms if p):
            wrong.append(("complement_rounded", by(lambda p: quantile(1.0 - p) - g if 1.0 - p < 1.0 else mpf("inf"))))
        tolerance = {"miss": in_ulp(int(count), TAIL)} if count > 8 else None
        args, ok = {"gamma": gamma, "false_alarm": alarms}, {"miss": miss, "auc": cdf(g / sqrt(mpf(2)))}
        group.accept(f"{kind}: γ = {gamma!r}", args, ok, wrong, tolerance=tolerance)
    refuse_common(group, {"gamma": 2, "false_alarm": [0.1, 0.5]}, ["gamma"], ["false_alarm"])
    group.refuse("γ < 0", {"gamma": -1, "false_alarm": [0.1]}, "out_of_range")
    for p in (-0.1, 1.1, 2):
        group.refuse(f"a false alarm of {p!r}", {"gamma": 1, "false_alarm": [0.5, p]}, "out_of_range")
    return group


def needed(alpha, beta):
    """γ of DET-027 and its bound: two quantiles and a sum."""
    a, b = -quantile(alpha), -quantile(beta)
    gamma = max(a + b, mpf(0))
    bound = QUANTILE_ROUNDINGS * (abs(exact(a)) + abs(exact(b))) + exact(gamma)
    # The exact 0 of a rate of ½ may come out as a rounding of the half.
    return gamma, UNIT * (bound + 2 * [alpha, beta].count(0.5))


# Verifies: DET-027.
def required_gamma():
    group = Group("required_gamma", SOURCE, case_by_case(["gamma"], bound=64 * UNIT))
    draws = Draws(13)
    pairs = [
        (0.05, 0.05, "the paper's example: 3.29"),
        (0.01, 0.01, "table"),
        (0.05, 0.01, "table"),
        (0.5, 0.5, "0"),
        (0.25, 0.75, "0"),
        (0.6, 0.7, "would be negative"),
        (0.9, 0.05, "one rate above ½"),
        (0.499999, 0.5, "nearly 0"),
        (0.3, 0.6999999, "cancels"),
        (0.3, 0.7, "cancels up to the rounding of 0.3 + 0.7"),
        (1e-300, 1e-300, "tiny rates"),
        (5e-324, 0.5, "the least rate"),
        (1e-310, 1e-5, "a subnormal rate"),
        (1 - 2.0**-53, 1e-10, "a rate next to 1"),
        (1e-16, 1e-16, "1 − α rounds"),
    ]
    pairs += [(draws.decimal(0.001, 0.5), draws.decimal(0.001, 0.5), "drawn") for _ in range(30)]
    pairs += [
        (nearest(mpf(10) ** -draws.integer(3, 200)), draws.decimal(0.001, 0.9), "drawn, small α") for _ in range(15)
    ]
    for alpha, beta, kind in pairs:
        gamma, bound = needed(alpha, beta)
        a, b = -quantile(alpha), -quantile(beta)
        wrong = [
            ("quantile_sign", {"gamma": -a - b}),
            ("rates_swapped", {"gamma": a - b}),
            ("root_two_missing", {"gamma": (a + b) * sqrt(mpf(2))}),
            ("gamma_squared", {"gamma": (a + b) ** 2}),
            ("one_sided_interval", {"gamma": -quantile(alpha / 2) + b if alpha / 2 else gamma}),
        ]
        if alpha > 1e-17 and 1.0 - alpha < 1.0:
            wrong.append(("complement_rounded", {"gamma": max(mpf(0), quantile(1.0 - alpha) + b)}))
        if a + b < 0:
            wrong.append(("out_of_range", {"gamma": a + b}))
        reason = "2⁻⁵³ (8 |Φ⁻¹(1−α)| + 8 |Φ⁻¹(1−β)| + γ): two quantiles within 4 ULP and a sum"
        args, comment = {"max_false_alarm": alpha, "max_miss": beta}, f"{kind}: α = {alpha!r}, β = {beta!r}"
        group.accept(comment, args, {"gamma": gamma}, wrong, tolerance={"gamma": absolute(bound, "1", reason)})
    args = {"max_false_alarm": 0.05, "max_miss": 0.05}
    refuse_common(group, args, list(args))
    for key in args:
        for rate in (0, 1, -0.05, 1.05):
            group.refuse(f"{key} = {rate!r}", args, at_limit(rate), **{key: rate})
    return group


# Verifies: DET-100.
def noise_budget():
    forces = case_by_case(["total_allowed_n", "remaining_n"], "N", 64 * UNIT)
    group = Group("noise_budget", SOURCE, {**case_by_case(["gamma"], bound=64 * UNIT), **forces})
    draws, rate = Draws(14), lambda: draws.decimal(0.01, 0.3)
    budgets = [
        (0.5, 0.05, 0.05, [0.1], "the paper's example: 0.1145, not 0.11"),
        (0.34, 0.05, 0.05, [0.02, 0.0005, 0.14, 0.093], "Table 2, playback: exhausted"),
        (0.34, 0.2, 0.2, [0.02, 0.0005, 0.14, 0.093], "Table 2, playback"),
        (0.34, 0.2, 0.2, [0.2, 0.093], "Table 2, direct contact"),
        (0.5, 0.05, 0.05, [0.151], "nearly exhausted"),
        (0.5, 0.05, 0.05, [1.0], "exhausted"),
        (1e-6, 0.01, 0.01, [1e-7], "micronewtons"),
        (1e6, 0.01, 0.01, [1e5, 1e4], "meganewtons"),
        (0.5, 1e-100, 1e-100, [0.01], "tiny rates"),
        (0.5, 0.49, 0.5, [0.1, 0.2], "γ nearly 0"),
        (0.5, 0.05, 0.05, [1e-20], "a source lost in rounding"),
        (0.5, 0.05, 0.05, [0.02] * 20, "20 equal sources"),
    ]
    sources = lambda: [draws.decimal(0.001, 0.2) for _ in range(draws.integer(1, 4))]
    budgets += [(draws.decimal(0.1, 1), rate(), rate(), sources(), "drawn") for _ in range(46)]
    for signal, alpha, beta, sources, kind in budgets:
        gamma, gamma_bound = needed(alpha, beta)
        s = [real(x) for x in sources]
        total, used = real(signal) / gamma, sum(x * x for x in s)
        left = total**2 - used
        remaining, remaining_bound = sqrt(left) if left > 0 else mpf(0), 0
        relative = gamma_bound / exact(gamma) + UNIT
        if left > 0:
            squares = exact(total**2) * (2 * relative + 2 * UNIT) + exact(used) * (len(s) + 2) * UNIT
            remaining_bound = squares / (2 * exact(remaining)) + 2 * UNIT * exact(remaining)
        wrong = [
            ("noise_added_linearly", {"remaining_n": max(total - sum(s), mpf(0))}),
            ("total_for_remaining", {"remaining_n": total}),
            ("gamma_squared", {"total_allowed_n": real(signal) / gamma**2}),
            ("variance_for_sd", {"remaining_n": max(left, mpf(0))}),
            ("root_two_missing", {"total_allowed_n": real(signal) / gamma / sqrt(mpf(2))}),
        ]
        if left < 0:
            wrong.append(("out_of_range", {"remaining_n": -sqrt(-left)}))
        reason = "(δ(total²) + (n + 2) 2⁻⁵³ Σs²)/(2 remaining) + 2 roundings; 0 where the sources exhaust it"
        tolerance = {
            "gamma": absolute(gamma_bound, "1", "as of required_gamma"),
            "total_allowed_n": absolute(exact(total) * relative, "N", "the relative one of γ and a quotient"),
            "remaining_n": absolute(remaining_bound, "N", reason),
        }
        args = {"signal_n": signal, "max_false_alarm": alpha, "max_miss": beta, "sources_n": sources}
        ok = {"gamma": gamma, "total_allowed_n": total, "remaining_n": remaining}
        group.accept(kind, args, ok, wrong, tolerance=tolerance)
    refuse_budgets(group)
    return group


def refuse_budgets(group):
    args = {"signal_n": 0.5, "max_false_alarm": 0.05, "max_miss": 0.05, "sources_n": [0.1, 0.02]}
    refuse_common(group, args, ["signal_n", "max_false_alarm", "max_miss"], ["sources_n"])
    for key in ("max_false_alarm", "max_miss"):
        for rate in (0, 1):
            group.refuse(f"{key} = {rate}", args, "infinite_answer", **{key: rate})
    group.refuse("γ = 0: any noise would do", args, "zero_gamma", error="overflow", max_false_alarm=0.5, max_miss=0.5)
    group.refuse("γ floored at 0", args, "zero_gamma", error="overflow", max_false_alarm=0.8, max_miss=0.7)
    group.refuse("a source below 0", args, "out_of_range", sources_n=[0.1, -0.02])


GROUPS = [error_rates, roc, required_gamma, noise_budget]

"""Thresholds by the four criteria (DET-022 … 025)."""

from mpmath import log, log10, mpf, sqrt

from .decision import QUANTILE_ROUNDINGS
from .normal import SOURCE, quantile
from .numbers import UNIT, Draws, exact, real
from .suite import Group, absolute, at_limit, case_by_case, refuse_common


def map_case(group, prior, kind):
    p = real(prior)
    eta = log((1 - p) / p)
    wrong = [
        ("prior_inverted", {"eta": -eta}),
        ("log10", {"eta": log10((1 - p) / p)}),
        ("ratio_for_logarithm", {"eta": (1 - p) / p}),
    ]
    bound = UNIT * (3 + 3 * abs(exact(eta)))
    limits = {"eta": absolute(bound, "1", "(3 + 3|η|) 2⁻⁵³: 1 − p, the ratio and the logarithm")}
    args = {"criterion": "map", "prior_h1": prior}
    group.accept(f"MAP, {kind}: P1 = {prior!r}", args, {"eta": eta}, wrong, tolerance=limits)


def bayes_case(group, prior, c00, c01, c10, c11, kind):
    p = real(prior)
    gain0, gain1 = real(c10) - real(c00), real(c01) - real(c11)
    eta = log((1 - p) * gain0 / (p * gain1))
    wrong = [
        ("prior_inverted", {"eta": log(p * gain0 / ((1 - p) * gain1))}),
        ("log10", {"eta": log10((1 - p) * gain0 / (p * gain1))}),
        ("sign_exchanged", {"eta": -eta}),
    ]
    if c01 > c00 and c10 > c11:
        exchanged = log((1 - p) * (real(c01) - real(c00)) / (p * (real(c10) - real(c11))))
        wrong.insert(0, ("costs_exchanged", {"eta": exchanged}))
    if c10 > 0 and c01 > 0:
        wrong.append(("right_costs_ignored", {"eta": log((1 - p) * real(c10) / (p * real(c01)))}))
    bound = UNIT * (8 + 3 * abs(exact(eta)))
    reason = "(8 + 3|η|) 2⁻⁵³: 3 differences, 2 products, the ratio and the logarithm"
    args = {"criterion": "bayes", "prior_h1": prior, "c00": c00, "c01": c01, "c10": c10, "c11": c11}
    group.accept(f"Bayes, {kind}", args, {"eta": eta}, wrong, tolerance={"eta": absolute(bound, "1", reason)})


def neyman_pearson(group, which, gamma, rate, kind):
    """η is γ²/2 + γ Φ⁻¹(β) for a rate β of misses, and −γ²/2 − γ Φ⁻¹(α) for a rate α of false alarms."""
    g, q, sign, key = real(gamma), quantile(rate), 1 if which == "miss" else -1, f"max_{which}"
    eta = sign * (g * g / 2 + g * q)
    wrong = [
        ("rates_swapped", {"eta": -eta}),
        ("half_left_out", {"eta": sign * (g * g + g * q)}),
        ("quantile_sign", {"eta": sign * (g * g / 2 - g * q)}),
        ("gamma_squared", {"eta": sign * (g / 2 + sqrt(g) * q)}),
        ("variance_for_sd", {"eta": sign * (g * g / 2 + g * g * q)}),
    ]
    if which == "false_alarm" and 1e-17 < rate and 1.0 - rate < 1.0:
        wrong.append(("complement_rounded", {"eta": -g * g / 2 + g * quantile(1.0 - rate)}))
    bound = UNIT * (exact(g * g / 2) + (QUANTILE_ROUNDINGS + 2) * abs(exact(g * q)) + abs(exact(eta)))
    reason = "2⁻⁵³ (γ²/2 + 10 |γ Φ⁻¹| + |η|): square, quantile within 4 ULP, product, sum"
    comment = f"Neyman–Pearson, {kind}: γ = {gamma!r}, rate {rate!r}"
    args = {"criterion": f"neyman_pearson_{which}", "gamma": gamma, key: rate}
    group.accept(comment, args, {"eta": eta}, wrong, tolerance={"eta": absolute(bound, "1", reason)})


# Verifies: DET-022, DET-025.
def threshold():
    group = Group("threshold", SOURCE, case_by_case(["eta"], bound=16 * UNIT))
    draws = Draws(12)

    for prior in (
        0.5, 0.25, 0.75, 0.1, 0.9, 0.01, 0.99, 1e-6, 1e-100, 1e-300, 5e-324, 2.2250738585072014e-308,
        1 - 2.0**-53, 1 - 1e-12, 0.5 + 2.0**-52, 0.5 - 2.0**-54, 1 / 3,
    ):
        map_case(group, prior, "table")
    for _ in range(18):
        map_case(group, draws.decimal(0.001, 0.999), "drawn")
    bayes_cases(group, draws)
    neyman_pearson_cases(group, draws)
    refuse_thresholds(group)
    return group


def bayes_cases(group, draws):
    bayes_case(group, 0.5, 0, 1, 1, 0, "equal costs: η = 0")
    bayes_case(group, 0.1, 0, 1, 1, 0, "equal costs: the MAP rule")
    bayes_case(group, 0.01, 0, 100, 1, 0, "a miss costs 100 false alarms")
    bayes_case(group, 0.3, 0, 1, 100, 0, "a false alarm costs 100 misses")
    bayes_case(group, 0.5, 1, 2, 1 + 2.0**-52, 0, "costs nearly equal: c10 − c00 = 2⁻⁵²")
    bayes_case(group, 0.5, 0.1, 1.0, 0.10000000000000002, 0.9999999999999999, "both differences nearly cancel")
    bayes_case(group, 0.25, 3, 5, 4, 5 - 2.0**-40, "c01 − c11 = 2⁻⁴⁰")
    bayes_case(group, 0.2, -1, 0, 2, -3, "negative costs: gains")
    bayes_case(group, 1e-200, 0, 1, 1, 0, "prior near 0")
    bayes_case(group, 1 - 2.0**-53, 0, 1, 1, 0, "prior near 1")
    bayes_case(group, 0.5, 0, 1e-300, 1e-300, 0, "tiny costs")
    bayes_case(group, 0.5, 0, 1e300, 1e-5, 0, "costs of very different size")
    bayes_case(group, 0.5, 1e6, 1e6 + 1, 1e6 + 1, 1e6, "a large common part")
    for _ in range(26):
        c00, c11 = draws.decimal(0, 2, 2), draws.decimal(0, 2, 2)
        miss, alarm = c11 + draws.decimal(0.1, 9, 2), c00 + draws.decimal(0.1, 9, 2)
        bayes_case(group, draws.decimal(0.01, 0.99), c00, miss, alarm, c11, "drawn")


def neyman_pearson_cases(group, draws):
    for which in ("miss", "false_alarm"):
        for gamma, rate, kind in (
            (3.3, 0.05, "the paper's example"),
            (2.0, 0.01, "table"),
            (1e-10, 0.05, "tiny γ"),
            (1000.0, 0.05, "huge γ"),
            (2.0, 1e-300, "tiny rate"),
            (2.0, 1 - 2.0**-53, "rate next to 1"),
            (5.0, 0.5, "a rate of ½"),
            (3.2897072539029435, 0.05, "η cancels: γ = 2·1.645"),
            (1e-200, 0.05, "γ² underflows"),
            (1e100, 0.05, "huge γ"),
        ):
            neyman_pearson(group, which, gamma, rate, kind)
        for _ in range(14):
            neyman_pearson(group, which, draws.decimal(0.1, 8), draws.decimal(0.001, 0.6), "drawn")
    args = {"criterion": "neyman_pearson_miss", "gamma": 0, "max_miss": 0.05}
    zero = {"eta": absolute(0, "1", "both terms are 0")}
    group.accept("Neyman–Pearson, miss: γ = 0", args, {"eta": mpf(0)}, flags=["zero_gamma"], tolerance=zero)


def refuse_thresholds(group):
    bayes = {"criterion": "bayes", "prior_h1": 0.5, "c00": 0, "c01": 1, "c10": 1, "c11": 0}
    refuse_common(group, {"criterion": "map", "prior_h1": 0.5}, ["prior_h1"])
    refuse_common(group, bayes, ["prior_h1", "c00", "c01", "c10", "c11"])
    for criterion, key in (("neyman_pearson_miss", "max_miss"), ("neyman_pearson_false_alarm", "max_false_alarm")):
        refuse_common(group, {"criterion": criterion, "gamma": 2.0, key: 0.05}, ["gamma", key])
        group.refuse("γ < 0", {"criterion": criterion, "gamma": -1, key: 0.05}, "out_of_range")
        for rate in (0, 1, -0.5, 1.5):
            group.refuse(f"a rate of {rate!r}", {"criterion": criterion, "gamma": 2.0, key: rate}, at_limit(rate))
    group.refuse(
        "Neyman–Pearson, false alarm: γ = 0",
        {"criterion": "neyman_pearson_false_alarm", "gamma": 0, "max_false_alarm": 0.05},
        "zero_gamma",
    )
    for prior in (0, 1, -0.1, 1.1):
        group.refuse(f"MAP, prior {prior!r}", {"criterion": "map"}, at_limit(prior), prior_h1=prior)
        group.refuse(f"Bayes, prior {prior!r}", bayes, at_limit(prior), prior_h1=prior)
    for comment, costs in (
        ("c10 = c00", {"c10": 0}),
        ("c10 < c00", {"c00": 2}),
        ("c01 = c11", {"c11": 1}),
        ("c01 < c11", {"c01": -1}),
    ):
        group.refuse(f"Bayes, {comment}", bayes, "infinite_answer", **costs)
    group.refuse("no criterion", {"prior_h1": 0.5}, "missing_argument")
    group.refuse("a criterion that does not exist", {"criterion": "minimax", "prior_h1": 0.5}, "out_of_range")
    group.refuse("a criterion that is a number", {"criterion": 1, "prior_h1": 0.5}, "wrong_type")


GROUPS = [threshold]

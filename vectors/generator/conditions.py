"""How far rounding may move each answer, and the coarsest precision in which there is one.

The formulas are those of the second route, or of the generator where those are faster.

Implements: VEC-016, VEC-018.
"""

from fractions import Fraction
from math import frexp

import second_route
from mpmath import mpf, sqrt, workdps

from . import bank, normal, nuisances, proportions, quadratic, robust, sequential
from .numbers import UNIT, Draws, exact, nearest, real, round_up
from .suite import UNKNOWN, allowed, leaves, settle

STEP = Fraction(1, 2**66)
"""A relative change of an argument: a power of two, so that fractions stay short."""
ALONE = 8
"""Up to so many numbers are changed one at a time, more of them all at once with random signs."""
DRAWS = 16
COUNTS = {"successes", "trials", "correct", "degrees", "numerator", "denominator"}
COARSEST = 2.0**-11
"""Unit roundoff of half precision: what only coarser ones cannot answer needs no `roundoff`."""
DEPENDENT = 2.0**-36
"""The share of 10⁻⁹ of NUI-001 and NUI-004 over some 64 roundings: a coarser precision leaves more of a dependent signal."""


# Formulas: arguments to answer


def law(function):
    """With fewer digits where no tail is lost by it."""

    def answer(args):
        pair = function(**args, digits=80)
        return quadratic.tails(pair if min(pair) > mpf(10) ** -30 else function(**args))

    return answer


def interval(args):
    k, n, tail = args["successes"], args["trials"], (1 - real(args["confidence"])) / 2
    if args["method"] == "wilson":
        return proportions.ends(proportions.wilson(k, n, -normal.quantile(tail)))
    return proportions.ends(proportions.clopper_pearson(k, n, tail))


def space(args):
    return nuisances.Space(args["nuisances"], len(args["residual"]))


def posterior(args):
    with workdps(bank.DIGITS):
        return bank.hypotheses(args, space(args)).answer()


FORMULAS = {
    "chi_square_tail": law(quadratic.chi_square),
    "f_tail": law(quadratic.f_ratio),
    "student_tail": law(quadratic.student),
    "proportion_interval": interval,
    "theta_nuisances": lambda args: nuisances.Statistic.of(args, space(args)).answer(args),
    "bank_posterior": posterior,
}


def formula(op):
    return FORMULAS.get(op) or second_route.route(op)


# κ: what changes of the arguments do to the answer


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def names_of(args):
    """Of the numbers that rounding changes: a number by itself its key, numbers of lists their size, since equal ones are
    rounded alike. 0, whole counts, and false alarms of 1 stay as they are."""
    for key, value in args.items():
        numbers = [leaf for leaf in leaves(value) if is_number(leaf) and leaf != 0]
        if key in COUNTS and all(leaf == round(leaf) for leaf in numbers):
            continue
        if isinstance(value, list):
            yield from (abs(leaf) for leaf in numbers if (key, leaf) != ("false_alarm", 1))
        elif numbers:
            yield key


def changed(key, value, steps):
    if isinstance(value, list):
        return [changed(None, item, steps) for item in value]
    step = steps.get(key or abs(value), 0) if is_number(value) else 0
    return Fraction(value) * (1 + step * STEP) if step else value


def sensitivity(op, args):
    """κ of each number of the answer, key by key: Σ |x ∂f/∂x|, or three root mean squares of Σ ± x ∂f/∂x."""

    def evaluate(steps):
        answer = formula(op)({key: changed(key, value, steps) for key, value in args.items()})
        return {key: [real(leaf) for leaf in leaves(value)] for key, value in answer.items()}

    names, draws = list(dict.fromkeys(names_of(args))), Draws(90)
    tried, total = [{name: 1} for name in names], lambda moved: sum(map(abs, moved), mpf(0))
    if len(names) > ALONE:
        tried = [{name: draws.choice([-1, 1]) for name in names} for _ in range(DRAWS)]
        total = lambda moved: 3 * sqrt(sum(v * v for v in moved) / DRAWS)
    right, found = evaluate({}), [evaluate(steps) for steps in tried]
    return {
        key: [total([(other[key][i] - value) / real(STEP) for other in found]) for i, value in enumerate(values)]
        for key, values in right.items()
    }


# The coarsest precision


def largest(value):
    return max(abs(leaf) for leaf in leaves(value))


def mean_and_deviation(args, ok):
    """Θ is −γ²/2 or γ²/2 on average, with the deviation γ."""
    return ok["gamma"] ** 2 / 2 + ok["gamma"] if ok["gamma"] < 1e150 else ok["gamma"]


RATES = ["normal_quantile.x", "gamma_from_two_afc.gamma", "required_gamma.gamma", "noise_budget.gamma", "count_analysis.gamma"]
SIZES = {
    **dict.fromkeys([*RATES, "threshold.eta", "theta_nuisances.t"], lambda a, ok: 1),
    **dict.fromkeys(["theta.theta", "theta_colored.theta", "theta_nuisances.theta"], mean_and_deviation),
    **dict.fromkeys(["scan.theta", "scan.max_theta"], lambda a, ok: largest(ok["theta"])),
    **{f"bank_posterior.theta{part}": lambda a, ok: max(1, largest(ok["theta"])) for part in ("", "_mixture", "_max")},
    **{f"sequential_evidence.{key}": lambda a, ok, key=key: max(1, largest([ok[key]])) for key in ("theta", "gamma")},
    "sequential_evidence.residual": lambda a, ok: len(a["residual"]),
    **{f"robust_evidence.{key}": lambda a, ok, key=key: max(1, largest([ok[key]])) for key in ("without", "by_class", "with", "theta")},
    "robust_evidence.distance": lambda a, ok: len(a["record"]),
    **{f"theta.y_{c}": lambda a, ok, c=c: a[f"noise_sd_{c}"] / len(a["f0_x"]) ** 0.5 for c in "xy"},
    "theta_nuisances.residual": lambda a, ok: ok["degrees"],
    "count_analysis.chi2": lambda a, ok: ok["df"],
    "proportion_interval.lower": lambda a, ok: ok["upper"],
    "interpolate.force_n": lambda a, ok: largest(a["table_n"]),
    "element_stiffness.stiffness": lambda a, ok: largest(ok["stiffness"]),
}
"""What an error of an answer is small or large against, where that is not the answer's own size."""


def of_decision(theta, condition, may_be):
    """The u at which the largest and another θ are as near as rounding may move both; equal ones are equal in any."""
    best = max(may_be, key=lambda k: (theta[k], -k))
    for k in may_be:
        if theta[k] != theta[best]:
            yield (theta[best] - theta[k]) / (2 * (condition[best] + condition[k]))


def of_squares(op, args, ok):
    """Where a sum of squares is next to nothing, the square of what rounding leaves counts."""
    if op == "count_analysis" and 0 in ok["chi2"]:
        yield float(UNIT)
    if op == "theta_nuisances":
        left = space(args).error / nuisances.U * nuisances.length(nuisances.reals(args["residual"]))
        yield max(float(UNIT), 16 * sqrt(real(ok["residual"])) / left if left else 1)


def next_to_one(args):
    """Numbers that would be rounded to 1."""
    for value in args.values():
        if is_number(value) and value != 1:
            yield abs(1 - value) / (1 if value < 1 else 2)


def of_answer(op, args, ok, condition):
    """The u from which on a decision may fall otherwise."""
    if op == "scan":
        yield from of_decision(ok["theta"], condition["theta"], range(len(ok["theta"])))
    if "nuisances" in args and len(space(args).basis) < sum(map(any, args["nuisances"])):
        yield DEPENDENT
    if op == "bank_posterior":
        if any(theta == 0 and any(template) for theta, template in zip(ok["theta"], args["templates"])):
            yield DEPENDENT
        may_be = [k for k, theta in enumerate(ok["theta"]) if theta != 0 and args["prior"][k] > 0]
        yield from of_decision(ok["theta"], condition["theta"], may_be)
    if op == "sequential_evidence":
        if 0 in ok["gamma"]:
            yield DEPENDENT
        yield sequential.nearest_bound(args) / (16 * max(condition["theta"]))
    if op == "robust_evidence":
        yield robust.lead(args) / (4 * max(map(max, map(condition.get, ("without", "with")))))
    yield from of_squares(op, args, ok)


def of_refusal(args, flags):
    """The u at which what must be refused looks as if it were right."""
    if "template_explained" in flags:
        yield DEPENDENT
    if "prior_unchecked" in flags and sum(args["prior"]) != 1:
        yield abs(1 - sum(args["prior"])) / 4


# Cases


def bound(value):
    """Two digits, not below the value: the same on every machine, as values a billionth above two digits are these. What no
    number of f64 needs is 0."""
    return round_up(exact(value) * (1 - Fraction(1, 10**9))) if value > mpf(10) ** -307 else 0.0


def shaped(value, items):
    return [shaped(part, items) for part in value] if isinstance(value, list) else next(items)


def of_case(op, case, tolerance):
    """`condition`, `roundoff` and `lenient` of a case, as far as it has them."""
    args, ok, limits, lenient = case.get("args"), case.get("ok", {}), [2.0], {}
    numbers = {key: list(leaves(value)) for key, value in ok.items()}
    numbers = {key: values for key, values in numbers.items() if isinstance(values[0], float)}
    condition = {}
    if "ok" in case and (not numbers or op == "probe_force"):
        return {}
    if "ok" in case:
        kappas = sensitivity(op, args)
        for key, values in numbers.items():
            # Units in the last place of 0 are next to nothing.
            allow = lambda v: 2 * real(allowed(tolerance[key], v) / UNIT) if v or "ulp" not in tolerance[key] else 0
            condition[key] = [bound(4 * k + 16 * abs(real(v)) + allow(v)) for v, k in zip(values, kappas[key])]
            size = SIZES.get(f"{op}.{key}", lambda a, ok: 0)(args, ok)
            limits += [max(abs(v), size) / (4 * c) for v, c in zip(values, condition[key]) if c and (v or size)]
        limits += of_answer(op, args, ok, condition)
    else:
        limits += of_refusal(args or {}, case["flags"])
        if UNKNOWN in (args or {}) and op != "probe_force":
            meant = {key: value for key, value in args.items() if key != UNKNOWN}
            lenient = {"lenient": settle(formula(op)(meant))}
    limits += next_to_one(args or {})
    found = {key: shaped(ok[key], iter(values)) for key, values in condition.items() if any(values)}
    if op == "element_stiffness" and found:
        found = {"stiffness": max(condition["stiffness"])}
    least = min(limits)
    return {
        **lenient,
        **({"condition": found} if found else {}),
        **({"roundoff": 2.0 ** (frexp(nearest(least))[1] - 1)} if least < COARSEST else {}),
    }


def add(case, found):
    """Puts them before the flags."""
    for key in ("flags", "wrong"):
        if key in case:
            found = {**found, key: case.pop(key)}
    case.update(found)

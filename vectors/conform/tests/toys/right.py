"""A second implementation of the ops, from the specification alone: Python's standard library, fractions and decimals.

Reads requests as JSON lines on stdin and answers them on stdout: `palpate-conform -- python3 vectors/conform/tests/toys/right.py`.
Slow and plain: sums are exact fractions, and what is no fraction has 50 digits. vectors/check.py compares the expected answers
with these, unrounded.
"""

import json
import math
import struct
import sys
from decimal import Decimal
from fractions import Fraction
from inspect import isfunction

from special import cdf, quantile, tail_inverse

ROOT_2 = Decimal(2).sqrt()


class Refused(Exception):
    """An error with its code."""

    def __init__(self, code, message):
        super().__init__(message)
        self.code = code


# Arguments


def number(value, name):
    if isinstance(value, bool) or not isinstance(value, (int, float, Fraction)):
        raise Refused("bad_argument", f"{name} is no number")
    try:
        value = value if isinstance(value, Fraction) else float(value)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise Refused("bad_argument", f"{name} is not finite")
    return Fraction(value)


def limited(is_within, fault):
    def read(value, name):
        value = number(value, name)
        if not is_within(value):
            raise Refused("out_of_range", f"{name} is {fault}")
        return value

    return read


positive = limited(lambda value: value > 0, "not above 0")
not_negative = limited(lambda value: value >= 0, "below 0")
probability = limited(lambda value: 0 < value < 1, "not between 0 and 1")


def whole(value, name):
    if isinstance(value, bool) or not isinstance(value, int):
        raise Refused("bad_argument", f"{name} is no whole number")
    return value


def series(value, name, read=number):
    if not isinstance(value, list) or not value:
        raise Refused("bad_argument", f"{name} is no list, or an empty one")
    return [read(item, f"{name}[{i}]") for i, item in enumerate(value)]


def rows(value, name, read=number):
    table = series(value, name, lambda row, name: series(row, name, read))
    if len({len(row) for row in table}) != 1:
        raise Refused("bad_argument", f"the rows of {name} differ in length")
    return table


def count_rows(value, name):
    return rows(value, name, whole)


def text(value, name):
    if not isinstance(value, str):
        raise Refused("bad_argument", f"{name} is no text")
    return value


def same_length(*lists):
    if len({len(item) for item in lists}) != 1:
        raise Refused("bad_argument", "lengths differ")


def axis(value, name):
    knots = series(value, name)
    if len(knots) < 2:
        raise Refused("bad_argument", f"{name} has a single knot")
    if any(a >= b for a, b in zip(knots, knots[1:])):
        raise Refused("out_of_range", f"{name} does not increase")
    return knots


# Numbers


def decimal(value):
    return Decimal(value.numerator) / Decimal(value.denominator)


def root(value):
    return decimal(value).sqrt()


def finite(value):
    """The nearest f64 of each number of an answer."""
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [finite(item) for item in value]
    if isinstance(value, (Fraction, Decimal)):
        try:
            value = float(value)
        except OverflowError:
            value = math.inf
        if not math.isfinite(value):
            raise Refused("overflow", "the answer is no finite number")
    return value


def dot(a, b):
    return sum((x * y for x, y in zip(a, b)), Fraction(0))


# Ops


def capabilities():
    return {"version": "toy 1", "ops": sorted(OPS)}


def normal_cdf(x: number):
    return {"p": cdf(decimal(x))}


def normal_quantile(p: probability):
    return {"x": quantile(decimal(p))}


def two_afc(gamma: not_negative):
    return {"p_correct": cdf(decimal(gamma) / ROOT_2)}


def gamma_from_two_afc(p_correct: probability):
    return {"gamma": ROOT_2 * quantile(decimal(p_correct))}


def matched_filter(template_x: series, template_y: series, noise_sd_x: positive, noise_sd_y: positive):
    same_length(template_x, template_y)
    weight = Fraction(1, len(template_x))
    energy = [dot(d, d) for d in (template_x, template_y)]
    gamma2 = energy[0] / noise_sd_x**2 + energy[1] / noise_sd_y**2
    return {
        "b_x": root(weight * energy[0]),
        "b_y": root(weight * energy[1]),
        "sigma_x": root(weight * noise_sd_x**2),
        "sigma_y": root(weight * noise_sd_y**2),
        "gamma": root(gamma2),
    }


def correlation(residual, template):
    """Σ r Δ: the record against the template, sample by sample."""
    return dot(residual, template)


def theta_of(residual, template, deviation):
    """½ Σ [r² − (r − Δ)²]/s²: the difference of the squares without and with the inclusion."""
    rest = [r - d for r, d in zip(residual, template)]
    return (dot(residual, residual) - dot(rest, rest)) / (2 * deviation**2)


def theta(
    observed_x: series, observed_y: series, f0_x: series, f0_y: series, f1_x: series, f1_y: series,
    noise_sd_x: positive, noise_sd_y: positive,
):
    same_length(observed_x, observed_y, f0_x, f0_y, f1_x, f1_y)
    answer, total, gamma2 = {}, Fraction(0), Fraction(0)
    for name, p, f0, f1, s in (
        ("y_x", observed_x, f0_x, f1_x, noise_sd_x),
        ("y_y", observed_y, f0_y, f1_y, noise_sd_y),
    ):
        r, d = [a - b for a, b in zip(p, f0)], [a - b for a, b in zip(f1, f0)]
        weight, energy = Fraction(1, len(d)), dot(d, d)
        answer[name] = decimal(weight * correlation(r, d)) / root(weight * energy) if energy else Fraction(0)
        total += theta_of(r, d, s)
        gamma2 += energy / s**2
    return {"theta": total, **answer, "gamma": root(gamma2)}


def solve(matrix, right):
    """K⁻¹ b by elimination; a K that is not positive definite has a pivot that is not above 0."""
    table = [row + [b] for row, b in zip(matrix, right)]
    n = len(table)
    for k in range(n):
        if table[k][k] <= 0:
            raise Refused("out_of_range", f"covariance is not positive definite, pivot {k}")
        for i in range(k + 1, n):
            factor = table[i][k] / table[k][k]
            if factor:
                table[i] = [a - factor * b for a, b in zip(table[i], table[k])]
    x = [Fraction(0)] * n
    for k in reversed(range(n)):
        x[k] = (table[k][n] - dot(table[k][k + 1 : n], x[k + 1 :])) / table[k][k]
    return x


def theta_colored(residual: series, template: series, covariance: rows):
    same_length(residual, template, covariance, covariance[0])
    n = len(residual)
    if n % 2:
        raise Refused("bad_argument", "two channels have an even number of samples")
    for i in range(n):
        for j in range(i):
            if (covariance[i][j] - covariance[j][i]) ** 2 > abs(covariance[i][i] * covariance[j][j]) / 10**24:
                raise Refused("out_of_range", f"covariance is not symmetric at {i}, {j}")
    square = lambda v: dot(v, solve(covariance, v))
    rest = [r - d for r, d in zip(residual, template)]
    return {"theta": (square(residual) - square(rest)) / 2, "gamma": root(square(template))}


def scan(
    residual_x: series, residual_y: series, template_x: series, template_y: series, noise_sd_x: positive,
    noise_sd_y: positive,
):
    same_length(residual_x, residual_y)
    same_length(template_x, template_y)
    m = len(template_x)
    if m > len(residual_x):
        raise Refused("bad_argument", "the template is longer than the record")
    thetas = [
        theta_of(residual_x[k : k + m], template_x, noise_sd_x)
        + theta_of(residual_y[k : k + m], template_y, noise_sd_y)
        for k in range(len(residual_x) - m + 1)
    ]
    return {"theta": thetas, "max_theta": max(thetas), "argmax": thetas.index(max(thetas))}


def odds(prior_h1):
    """P0/P1."""
    return (1 - prior_h1) / prior_h1


def logarithm(ratio):
    return decimal(ratio).ln()


def threshold_map(prior_h1: probability):
    return {"eta": logarithm(odds(prior_h1))}


def threshold_bayes(prior_h1: probability, c00: number, c01: number, c10: number, c11: number):
    if c10 <= c00 or c01 <= c11:
        raise Refused("out_of_range", "a wrong decision must cost more than a right one")
    return {"eta": logarithm(odds(prior_h1) * (c10 - c00) / (c01 - c11))}


def threshold_neyman_pearson_miss(gamma: not_negative, max_miss: probability):
    g = decimal(gamma)
    return {"eta": g * g / 2 + g * quantile(decimal(max_miss))}


def threshold_neyman_pearson_false_alarm(gamma: not_negative, max_false_alarm: probability):
    if gamma == 0:
        raise Refused("out_of_range", "γ = 0 keeps no promise about false alarms")
    g = decimal(gamma)
    return {"eta": -g * g / 2 - g * quantile(decimal(max_false_alarm))}


def error_rates(gamma: not_negative, eta: number):
    if gamma == 0:
        return {"false_alarm": Fraction(eta <= 0), "miss": Fraction(eta > 0)}
    g, e = decimal(gamma), decimal(eta)
    return {"false_alarm": cdf(-(e + g * g / 2) / g), "miss": cdf((e - g * g / 2) / g)}


def roc(gamma: not_negative, false_alarm: series):
    if not all(0 <= p <= 1 for p in false_alarm):
        raise Refused("out_of_range", "false_alarm is not between 0 and 1")
    g = decimal(gamma)
    miss = [1 - p if p in (0, 1) else cdf(-quantile(decimal(p)) - g) for p in false_alarm]
    return {"miss": miss, "auc": cdf(g / ROOT_2)}


def needed(max_false_alarm, max_miss):
    return max(Decimal(0), -quantile(decimal(max_false_alarm)) - quantile(decimal(max_miss)))


def required_gamma(max_false_alarm: probability, max_miss: probability):
    return {"gamma": needed(max_false_alarm, max_miss)}


def noise_budget(signal_n: number, max_false_alarm: probability, max_miss: probability, sources_n: series):
    gamma = needed(max_false_alarm, max_miss)
    if gamma == 0:
        raise Refused("out_of_range", "γ = 0 allows any noise")
    if min(sources_n) < 0:
        raise Refused("out_of_range", "a source is below 0")
    total = decimal(signal_n) / gamma
    left = total * total - decimal(dot(sources_n, sources_n))
    return {"gamma": gamma, "total_allowed_n": total, "remaining_n": max(Decimal(0), left).sqrt()}


def tail_of(confidence):
    """The probability beyond each end of an interval."""
    return (1 - decimal(confidence)) / 2


def wilson(k, n, z):
    p, n_ = Decimal(k) / n, Decimal(n)
    middle, half = p + z * z / (2 * n_), z * (p * (1 - p) / n_ + z * z / (4 * n_ * n_)).sqrt()
    return (middle - half) / (1 + z * z / n_), (middle + half) / (1 + z * z / n_)


def clopper_pearson(k, n, tail):
    lower = Decimal(0) if k == 0 else tail_inverse(k, n, tail)
    return lower, Decimal(1) if k == n else 1 - tail_inverse(n - k, n, tail)


def proportion_interval(successes: whole, trials: whole, confidence: probability, method: text):
    if trials < 1 or not 0 <= successes <= trials:
        raise Refused("out_of_range", "0 ≤ successes ≤ trials, and at least one trial")
    if method == "wilson":
        lower, upper = wilson(successes, trials, -quantile(tail_of(confidence)))
    elif method == "clopper_pearson":
        lower, upper = clopper_pearson(successes, trials, tail_of(confidence))
    else:
        raise Refused("bad_argument", "method is wilson or clopper_pearson")
    return {"lower": lower, "upper": upper}


def cell(knots, position):
    return max(0, min(sum(k <= position for k in knots) - 1, len(knots) - 2))


def weight(knots, k, position):
    return (position - knots[k]) / (knots[k + 1] - knots[k])


def interpolate(depths_m: axis, laterals_m: axis, table_n: rows, depth_m: number, lateral_m: number):
    if len(table_n) != len(depths_m) or len(table_n[0]) != len(laterals_m):
        raise Refused("bad_argument", "the table has not a row for each depth and a column for each position")
    i, j = cell(depths_m, depth_m), cell(laterals_m, lateral_m)
    s, t = weight(depths_m, i, depth_m), weight(laterals_m, j, lateral_m)
    above, below = ((1 - t) * row[j] + t * row[j + 1] for row in table_n[i : i + 2])
    return {"force_n": (1 - s) * above + s * below}


def degrees_of_freedom(subjects):
    return subjects - 1


def count_analysis(correct: count_rows, trials: whole):
    if trials < 1 or not all(0 <= k <= trials for row in correct for k in row):
        raise Refused("out_of_range", "0 ≤ correct ≤ trials, and at least one trial")
    subjects, columns = len(correct), list(zip(*correct))
    pooled = [sum(c) for c in columns]
    rate = [Fraction(k, subjects * trials) for k in pooled]
    if any(p in (0, 1) for p in rate):
        raise Refused("overflow", "γ of a rate of 0 or 1 is infinite")
    # Pearson's, of right and wrong answers.
    cells = lambda k, p: (k - trials * p) ** 2 / (trials * p) + (k - trials * p) ** 2 / (trials * (1 - p))
    return {
        "pooled": pooled,
        "rate": rate,
        "gamma": [gamma_from_two_afc(p)["gamma"] for p in rate],
        "chi2": [sum(cells(k, p) for k in c) for c, p in zip(columns, rate)],
        "df": degrees_of_freedom(subjects),
    }


FORMATS = {1: "<Bhh2B2H", 2: "<BhhHB", 3: "<B8H", 4: "<BB"}
FIELDS = {
    1: "lateral normal buttons status sequence force_sequence",
    2: "lateral normal sequence flags",
    3: "version position_unit_nm force_unit_un largest_force_mn period_us watchdog_ms damping_mn_s_per_m friction_mn",
    4: "control",
}
FIELDS = {report: names.split() for report, names in FIELDS.items()}


def report_decode(bytes: text):
    if not all(c in "0123456789abcdef" for c in bytes) or len(bytes) % 2 or not bytes:
        raise Refused("bad_argument", "no bytes in hexadecimal")
    data = bytearray.fromhex(bytes)
    if data[0] not in FORMATS or struct.calcsize(FORMATS[data[0]]) != len(data):
        raise Refused("bad_argument", "no report of this number and length")
    fields = dict(zip(("report", *FIELDS[data[0]]), struct.unpack(FORMATS[data[0]], data)))
    if fields.get("control", 0) > 2:
        raise Refused("bad_argument", "control is 0, 1 or 2")
    return fields


def report_encode(report, **fields):
    if report not in FORMATS:
        raise Refused("out_of_range", "report is 1 to 4")
    if set(fields) != set(FIELDS[report]):
        raise Refused("bad_argument", f"report {report} has the fields {FIELDS[report]}")
    values = [whole(fields[name], name) for name in FIELDS[report]]
    if fields.get("control", 0) > 2:
        raise Refused("out_of_range", "control is 0, 1 or 2")
    try:
        return {"bytes": struct.pack(FORMATS[report], report, *values).hex()}
    except struct.error as error:
        raise Refused("out_of_range", str(error))


# An op is a function. Each of its arguments is annotated with the function that reads it.
ARGUMENTS = {name: op.__annotations__ for name, op in dict(globals()).items() if isfunction(op) and op.__annotations__}
ARGUMENTS["capabilities"] = {}
THRESHOLDS = {op for op in ARGUMENTS if op.startswith("threshold_")}
OPS = sorted(set(ARGUMENTS) - THRESHOLDS | {"threshold", "report_encode"})


def compute(op, args):
    """The answer of an op to its arguments, not yet rounded: fractions, and decimals with 50 digits."""
    if not isinstance(op, str) or op not in OPS:
        raise Refused("unknown_op" if isinstance(op, str) else "bad_request", "no such op")
    if op == "capabilities" and args is None:
        args = {}
    if not isinstance(args, dict):
        raise Refused("bad_argument", "args is no object")
    if op == "report_encode":
        return report_encode(whole(args.get("report"), "report"), **{k: v for k, v in args.items() if k != "report"})
    if op == "threshold":
        op = f"threshold_{args.get('criterion')}"
        if op not in THRESHOLDS:
            raise Refused("bad_argument", "no such criterion")
        args = {key: value for key, value in args.items() if key != "criterion"}
    readers = ARGUMENTS[op]
    if set(args) != set(readers):
        raise Refused("bad_argument", f"missing or unknown: {sorted(set(args) ^ set(readers))}")
    return globals()[op](**{name: readers[name](args[name], name) for name in readers})


def refuse_constant(name):
    raise ValueError(f"{name} is no number of JSON")


def without_twins(pairs):
    """An object, in which no key may stand twice."""
    if len(dict(pairs)) != len(pairs):
        raise Refused("bad_request", "a key stands twice")
    return dict(pairs)


def reply(line):
    """The answer to a line: an object, always."""
    name = None
    try:
        try:
            request = json.loads(line.decode("utf-8"), parse_constant=refuse_constant, object_pairs_hook=without_twins)
        except (ValueError, RecursionError) as error:
            raise Refused("bad_json", str(error))
        if not isinstance(request, dict) or "op" not in request or not set(request) <= {"id", "op", "args"}:
            raise Refused("bad_request", "a request is an object with id, op and args")
        if isinstance(request.get("id"), bool) or not isinstance(request.get("id"), (str, int, float)):
            raise Refused("bad_request", "id is a text or a number")
        if isinstance(request["id"], float) and not math.isfinite(request["id"]):
            raise Refused("bad_json", "the id is beyond the range of numbers")
        name = request["id"]
        return {"id": name, "ok": finite(compute(request["op"], request.get("args")))}
    except Refused as refused:
        return {"id": name, "error": {"code": refused.code, "message": str(refused)}}
    except ArithmeticError as error:
        return {"id": name, "error": {"code": "overflow", "message": repr(error)}}


def main():
    for line in sys.stdin.buffer:
        print(json.dumps(reply(line)), flush=True)


if __name__ == "__main__":
    main()

"""right.py with a bug that no flag of the vectors stands for: `unforeseen.py erf_in_the_tail`; without a name, they are listed.
Each docstring ends with the ops, and where not all of the answer is wrong the keys, that show it."""

import math
import struct
from decimal import Decimal
from fractions import Fraction

import right
from wrong import bugs_of, changed, main


def f0_left_in_y():
    """ERR-001 in one channel: F_0 is not subtracted from the normal force. theta: theta, y_y."""
    correct = right.theta
    right.theta = lambda **a: correct(**{**a, "observed_y": [p + f for p, f in zip(a["observed_y"], a["f0_y"])]})


def half_added():
    """Θ with + b/2 for − b/2. theta: theta; scan."""
    right.theta_of = lambda r, d, s: (right.correlation(r, d) + right.dot(d, d) / 2) / s**2


def f32_accumulator():
    """Sums of products are kept in f32. theta, matched_filter, scan, theta_colored, noise_budget: remaining_n."""

    def dot(a, b):
        total = Fraction(0)
        for x, y in zip(a, b):
            total = Fraction(struct.unpack("<f", struct.pack("<f", float(total + x * y)))[0])
        return total

    right.dot = dot


def erf_in_the_tail():
    """Φ(x) as (1 + erf(x/√2))/2. normal_cdf, error_rates, roc: miss, in the tails alone."""
    right.cdf = lambda x: Decimal((1 + math.erf(x / right.ROOT_2)) / 2)


def last_shift_left_out():
    """A loop over N − M shifts, not N − M + 1. scan."""

    def shorter(ok, _):
        theta = ok["theta"][:-1] or ok["theta"]
        return {"theta": theta, "max_theta": max(theta), "argmax": theta.index(max(theta))}

    changed("scan", shorter)


def samples_less_one():
    """1/(N − 1) for the weight 1/N. matched_filter: b_x, b_y."""

    def scaled(ok, a):
        n = len(a["template_x"])
        factor = (Decimal(n) / max(n - 1, 1)).sqrt()
        return {**ok, "b_x": factor * ok["b_x"], "b_y": factor * ok["b_y"]}

    changed("matched_filter", scaled)


def root_missing_in_one_output():
    """b² for b in the normal channel. matched_filter: b_y."""
    changed("matched_filter", lambda ok, _: {**ok, "b_y": ok["b_y"] ** 2})


def six_digits():
    """Numbers are written with six digits, as C's %g does. All ops."""
    correct = right.finite

    def short(value):
        if isinstance(value, dict):
            return {key: short(item) for key, item in value.items()}
        if isinstance(value, list):
            return [short(item) for item in value]
        return float(f"{value:g}") if isinstance(value, float) else value

    right.finite = lambda value: short(correct(value))


def gamma_of_the_question_before():
    """A buffer is filled after it was read. theta: gamma."""
    before = [Decimal(0)]

    def late(ok, _):
        before.append(ok["gamma"])
        return {**ok, "gamma": before[-2]}

    changed("theta", late)


def axes_taken_for_uniform():
    """All cells have the width of the first. interpolate, where the axes are not uniform."""
    right.weight = lambda knots, k, position: (position - knots[k]) / (knots[1] - knots[0])


if __name__ == "__main__":
    main("unforeseen.py", bugs_of(globals()))

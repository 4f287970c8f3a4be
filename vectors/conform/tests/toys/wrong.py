"""right.py with a bug: `wrong.py rates_swapped`. The names are the flags of the vectors, by which `palpate-conform`
tells what is wrong; without a name, they are listed."""

import sys
from decimal import Decimal
from fractions import Fraction
from inspect import isfunction

import right


def changed(op, change):
    """Lets `change` rewrite the answer of an op; it is given the arguments too."""
    correct = getattr(right, op)
    setattr(right, op, lambda **args: change(correct(**args), args))


def rates_swapped():
    changed("error_rates", lambda ok, _: {"false_alarm": ok["miss"], "miss": ok["false_alarm"]})


def hits_for_misses():
    changed("error_rates", lambda ok, _: {**ok, "miss": 1 - ok["miss"]})
    changed("roc", lambda ok, _: {**ok, "miss": [1 - m for m in ok["miss"]]})


def variance_for_sd():
    def theta_of(r, d, s):
        return (right.dot(r, d) - right.dot(d, d) / 2) / s

    right.theta_of = theta_of


def half_left_out():
    right.theta_of = lambda r, d, s: (right.dot(r, d) - right.dot(d, d)) / s**2


def time_not_reversed():
    correct = right.theta_of
    right.correlation = lambda r, d: right.dot(r, d[::-1])
    right.theta_of = lambda r, d, s: correct(r, d[::-1], s)


def weight_missing():
    changed("theta", lambda ok, a: {**ok, "y_x": ok["y_x"] * len(a["f0_x"]), "y_y": ok["y_y"] * len(a["f0_x"])})


def gamma_squared():
    changed("matched_filter", lambda ok, _: {**ok, "gamma": ok["gamma"] ** 2})


def channels_exchanged():
    correct = right.scan
    right.scan = lambda **a: correct(**{**a, "noise_sd_x": a["noise_sd_y"], "noise_sd_y": a["noise_sd_x"]})


def argmax_off_by_one():
    changed("scan", lambda ok, _: {**ok, "argmax": ok["argmax"] + 1})


def last_of_equals():
    changed("scan", lambda ok, _: {**ok, "argmax": max(i for i, v in enumerate(ok["theta"]) if v == ok["max_theta"])})


def correlation_ignored():
    correct = right.solve
    right.solve = lambda k, b: [x / k[i][i] for i, x in enumerate(b)] if correct(k, b) else None


def prior_inverted():
    right.odds = lambda p: p / (1 - p)


def log10():
    right.logarithm = lambda ratio: right.decimal(ratio).log10()


def costs_exchanged():
    correct = right.threshold_bayes

    def bayes(prior_h1, c00, c01, c10, c11):
        correct(prior_h1, c00, c01, c10, c11)
        return correct(prior_h1, c00, c10, c01, c11)

    right.threshold_bayes = bayes


def root_two_missing():
    right.ROOT_2 = Decimal(1)


def one_sided_interval():
    right.tail_of = lambda confidence: 1 - right.decimal(confidence)


def wald_interval():
    def wald(k, n, z):
        p = Decimal(k) / n
        half = z * (p * (1 - p) / n).sqrt()
        return p - half, p + half

    right.wilson = wald


def wilson_for_clopper_pearson():
    right.clopper_pearson = lambda k, n, tail: right.wilson(k, n, -right.quantile(tail))


def noise_added_linearly():
    changed(
        "noise_budget",
        lambda ok, a: {
            **ok,
            "remaining_n": max(Decimal(0), ok["total_allowed_n"] - right.decimal(sum(a["sources_n"]))),
        },
    )


def clamped_outside():
    correct = right.weight
    right.weight = lambda knots, k, position: min(max(correct(knots, k, position), Fraction(0)), Fraction(1))


def transposed():
    correct = right.interpolate

    def interpolate(**a):
        correct(**a)
        rows, flat = len(a["depths_m"]), [f for row in a["table_n"] for f in row]
        return correct(
            **{**a, "table_n": [[flat[j * rows + i] for j in range(len(a["laterals_m"]))] for i in range(rows)]}
        )

    right.interpolate = interpolate


def df_not_reduced():
    right.degrees_of_freedom = lambda subjects: subjects


def big_endian():
    right.FORMATS = {report: layout.replace("<", ">") for report, layout in right.FORMATS.items()}


def sign_ignored():
    signed = ("lateral", "normal")
    changed(
        "report_decode", lambda ok, _: {name: value % 65536 if name in signed else value for name, value in ok.items()}
    )


def axes_not_increasing():
    right.ARGUMENTS["interpolate"] = {
        **right.ARGUMENTS["interpolate"],
        "depths_m": right.series,
        "laterals_m": right.series,
    }


def not_symmetric():
    correct = right.theta_colored

    def lower_triangle(residual, template, covariance):
        n = len(covariance)
        if all(len(row) == n for row in covariance):
            covariance = [[covariance[max(i, j)][min(i, j)] for j in range(n)] for i in range(n)]
        return correct(residual, template, covariance)

    right.theta_colored = lower_triangle


def sign_exchanged():
    for op in ("theta", "theta_colored"):
        changed(op, lambda ok, _: {**ok, "theta": -ok["theta"]})


def total_for_remaining():
    changed("noise_budget", lambda ok, _: {**ok, "remaining_n": ok["total_allowed_n"]})


def shift_reversed():
    changed("scan", lambda ok, _: {**ok, "theta": ok["theta"][::-1], "argmax": ok["theta"][::-1].index(ok["max_theta"])})


def chi2_one_cell():
    changed("count_analysis", lambda ok, _: {**ok, "chi2": [x * (1 - p) for x, p in zip(ok["chi2"], ok["rate"])]})


def record_cut():
    """Buffers of fixed size."""

    def cut(value, size):
        return [cut(item, size) for item in value[:size]] if isinstance(value, list) else value

    def buffered(op, size):
        correct = getattr(right, op)
        setattr(right, op, lambda **args: correct(**{name: cut(value, size) for name, value in args.items()}))

    buffered("matched_filter", 256)
    buffered("theta", 128)
    buffered("theta_colored", 32)


def bugs_of(names):
    """The bugs among the names of a module: its functions without parameters."""
    return {name: bug for name, bug in names.items() if isfunction(bug) and not bug.__code__.co_argcount}


def main(name, bugs):
    if len(sys.argv) != 2 or sys.argv[1] not in bugs:
        sys.exit(f"{name} BUG, one of: " + " ".join(bugs))
    bugs[sys.argv[1]]()
    right.main()


if __name__ == "__main__":
    main("wrong.py", bugs_of(globals()))

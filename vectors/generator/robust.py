"""The evidence of a record in modes, by classes of disturbance and signals (ROB-031, ROB-032): normal laws with their whole
covariance, by Cholesky factors at 50 digits.

Implements: VEC-011.
"""

from dataclasses import dataclass, replace

from mpmath import exp, fsum, log, mpf, pi, sqrt

from .coloured import cholesky
from .nuisances import U, reals
from .numbers import Draws, real
from .series import added, whole
from .suite import Group, absolute, case_by_case, cut_answers, refuse_common

SOURCE = "Cholesky factors of the whole covariances, mpmath 1.3.0 at 50 digits"
AMPLITUDE, SHAPE = mpf(2) / 5, mpf(3) / 20


def forward(lower, vector):
    """L⁻¹v."""
    white = []
    for i, value in enumerate(vector):
        white.append((value - fsum(lower[i][j] * white[j] for j in range(i))) / lower[i][i])
    return white


def length(v):
    return sqrt(fsum(x * x for x in v))


@dataclass(frozen=True)
class Problem:
    """The arguments, and what a bug makes of the laws."""

    args: dict
    weights: tuple
    prior: tuple
    sizes: tuple
    amplitude: mpf = AMPLITUDE
    shape: mpf = SHAPE
    power: int = 1
    diagonal: bool = False
    determinant: mpf = mpf(1) / 2
    constant: mpf = mpf(0)

    @staticmethod
    def of(args):
        weights = reals(args["weights"])
        shares = tuple(weight / fsum(weights) for weight in weights)
        return Problem(args, shares, tuple(reals(args["prior"])), tuple(reals(args["sizes"])))

    def covariance(self, number, k):
        """Of a class with a signal, or none."""
        a = self.args
        n = len(a["record"])
        rows = [reals(row) for row in a["covariances"][n * number : n * (number + 1)]]
        share = (self.shape * self.sizes[k]) ** 2 if k is not None else 0
        mean = reals(a["signals"][k]) if k is not None else [mpf(0)] * n
        for i in range(n):
            rows[i][i] += real(a["noise"][i]) ** self.power
            for j in range(n):
                rows[i][j] += share * real(a["shape"][i][j]) + self.amplitude**2 * mean[i] * mean[j]
                if self.diagonal and i != j:
                    rows[i][j] = mpf(0)
        return rows

    def law(self, number, k):
        """ln of the weight of a class times the density, and the distance squared."""
        lower, record = cholesky(self.covariance(number, k)), reals(self.args["record"])
        mean = reals(self.args["signals"][k]) if k is not None else [mpf(0)] * len(record)
        distance = length(forward(lower, [y - m for y, m in zip(record, mean)])) ** 2
        roots = 2 * fsum(log(lower[i][i]) for i in range(len(record)))
        density = -distance / 2 - self.determinant * roots - self.constant
        return log(self.weights[number]) + density, distance

    def laws(self):
        signals = [None, *range(len(self.sizes))]
        return [[self.law(number, k) for k in signals] for number in range(len(self.weights))]

    def answer(self, total=lambda logs: log(fsum(map(exp, logs)))):
        laws = self.laws()
        without = [laws_of_class[0][0] for laws_of_class in laws]
        by_class = [
            total([log(prior) + law[0] for prior, law in zip(self.prior, laws_of_class[1:]) if prior]) for laws_of_class in laws
        ]
        return {
            "without": without,
            "by_class": by_class,
            "with": [total([laws_of_class[1 + k][0] for laws_of_class in laws]) for k in range(len(self.sizes))],
            "theta": total(by_class) - total(without),
            "distance": max(law for laws_of_class in laws for law in laws_of_class)[1],
        }


def lead(args):
    """By how much the largest density is above any of another law."""
    laws = sorted((law for laws_of_class in Problem.of(args).laws() for law in laws_of_class), reverse=True)
    return min((laws[0][0] - law[0] for law in laws if law[1] != laws[0][1]), default=mpf("inf"))


REASON = "n + 10 roundings of each entry of the covariance and its factor, as they move the distance and the determinant"
REASONS = {
    "without": REASON,
    "by_class": f"{REASON}, and ten of the sum",
    "with": f"{REASON}, and ten of the sum",
    "theta": "as both sums",
    "distance": REASON,
}


class Rounding:
    """What roundings of a covariance K = LLᵀ in units of |L||Lᵀ| and of its terms (Higham, Accuracy and Stability, 10.1) change."""

    def __init__(self, covariance, terms):
        n = len(covariance)
        lower = cholesky(covariance)
        columns = [forward(lower, [mpf(i == j) for i in range(n)]) for j in range(n)]
        self.inverse = [[fsum(a * b for a, b in zip(p, q)) for q in columns] for p in columns]
        product = lambda i, j: fsum(abs(a * b) for a, b in zip(lower[i], lower[j]))
        self.unit = [[product(i, j) + terms[i][j] for j in range(n)] for i in range(n)]
        self.logs = fsum(abs(log(lower[i][i])) for i in range(n))

    def form(self, a, b):
        """Of aᵀK⁻¹b."""
        reach = lambda v: [abs(fsum(x * y for x, y in zip(row, v))) for row in self.inverse]
        return fsum(x * fsum(u * y for u, y in zip(row, reach(b))) for x, row in zip(reach(a), self.unit))

    def determinant(self):
        """Of ln det K."""
        return self.logs + fsum(abs(x) * u for row, units in zip(self.inverse, self.unit) for x, u in zip(row, units))


def bound(problem, number, k):
    """How far a law may be off, whether the whole covariance is factorised or, as Sherman and Morrison do, all but the amplitude's part."""
    record = reals(problem.args["record"])
    mean = reals(problem.args["signals"][k]) if k is not None else [mpf(0)] * len(record)
    size = lambda value: list(map(size, value)) if isinstance(value, list) else abs(value)
    sizes = replace(problem, args={key: size(value) for key, value in problem.args.items()})
    fixed = lambda of: replace(of, amplitude=mpf(0)).covariance(number, k)
    whole = Rounding(problem.covariance(number, k), sizes.covariance(number, k))
    left = [y - m for y, m in zip(record, mean)]
    rest, variance = Rounding(fixed(problem), fixed(sizes)), AMPLITUDE**2
    white, along = (forward(cholesky(fixed(problem)), v) for v in (left, mean))
    turned = 1 + variance * abs(fsum(a * b for a, b in zip(along, white))) / (1 + variance * length(along) ** 2)
    square = rest.form(mean, mean)
    apart = rest.form(record, record) + 2 * turned * rest.form(record, mean) + (turned**2 + variance) * square
    at_once = whole.form(left, left) + whole.determinant()
    return (len(record) + 10) * U * max(at_once, apart + rest.determinant())


def tolerances(problem, ok):
    signals = [None, *range(len(problem.sizes))]
    off = max(bound(problem, number, k) for number in range(len(problem.weights)) for k in signals)
    rounding = lambda key: 10 * U * (1 + max(map(abs, ok[key])))
    limits = {
        "without": off + rounding("without"),
        "by_class": off + rounding("by_class"),
        "with": off + rounding("with"),
        "theta": 2 * off + rounding("without") + rounding("by_class"),
        "distance": off,
    }
    return {key: absolute(limit, "1", REASONS[key]) for key, limit in limits.items()}


def wrong_answers(args, right, ok):
    other = lambda **changes: replace(right, **changes).answer()
    weights, count, n = reals(args["weights"]), len(right.weights), len(args["record"])
    equal = tuple([mpf(1) / count] * count)
    unweighted = [value - log(weight) for value, weight in zip(ok["by_class"], right.weights)]
    total = lambda logs: log(fsum(map(exp, logs)))
    largest = right.answer(max)
    wrong = [
        ("weights_not_normalised", other(weights=tuple(weights))),
        ("weights_ignored", other(weights=equal)),
        ("weights_under_one_hypothesis", {"by_class": unweighted, "theta": total(unweighted) - total(ok["without"])}),
        ("prior_ignored", other(prior=tuple([mpf(1) / len(right.prior)] * len(right.prior)))),
        ("largest_for_mixture", {key: largest[key] for key in ("by_class", "with", "theta")}),
        ("amplitude_fixed", other(amplitude=mpf(0))),
        ("shape_ignored", other(shape=mpf(0))),
        ("size_ignored", other(sizes=tuple([mpf(1)] * len(right.sizes)))),
        ("size_of_another", other(sizes=right.sizes[::-1])),
        ("variance_for_sd", other(power=2)),
        ("correlation_ignored", other(diagonal=True)),
        ("determinant_ignored", other(determinant=mpf(0))),
        ("root_of_determinant_missing", other(determinant=mpf(1))),
        ("factor_of_density", other(constant=log(2 * pi) * n / 2)),
        ("sign_exchanged", {"theta": -ok["theta"]}),
    ]
    if count > 1:
        few = replace(right, weights=right.weights[:-1]).answer()
        wrong.append(("class_forgotten", {"with": few["with"], "theta": few["theta"], "distance": few["distance"]}))
    return wrong


def add(group, comment, args, cuts=None):
    """With `cuts`, the wrong answers are those of the cut record alone."""
    right = Problem.of(args)
    ok = right.answer()
    assert lead(args) > 1e-6, f"{comment}: which law is nearest must not depend on rounding"
    of_first = lambda first: Problem.of(first).answer()
    wrong = wrong_answers(args, right, ok) if cuts is None else cut_answers(args, cuts, of_first)
    group.accept(comment, args, ok, wrong, tolerance=tolerances(right, ok))


def covariances(draws, modes, number, size=1.0):
    """Of classes of one to three directions each, a rest of all modes in every other one."""
    rows = []
    for count in range(number):
        directions = [[draws.decimal(-1, 1, 2) for _ in range(modes)] for _ in range(1 + count % 3)]
        for i in range(modes):
            rest = [draws.decimal(0.01, 0.5, 2) if i == j and count % 2 else 0 for j in range(modes)]
            entry = lambda j: sum(v[i] * v[j] for v in directions) + rest[j]
            rows.append([round(size * entry(j), 6) for j in range(modes)])
    return rows


def kernel(modes):
    """Smooth, and less of each higher mode."""
    return [[round(0.5 ** abs(i - j) / (1 + i + j), 6) for j in range(modes)] for i in range(modes)]


def drawn_args(draws, modes, classes, signals, noise=0.05):
    """A problem whose sizes are those of the grid of eight: so many powers of two, the largest and the least among them."""
    exponents = [0, -7, *(draws.integer(-7, 0) for _ in range(6))]
    order = draws.integer(0, signals - 1)
    exponents = exponents[order:signals] + exponents[:order]
    means = [[round(2.0**power * draws.decimal(-2, 2, 2), 6) for _ in range(modes)] for power in exponents]
    weights = [draws.integer(1, 9) for _ in range(signals)]
    shares = [100 * weight // sum(weights) for weight in weights]
    shares[0] += 100 - sum(shares)
    return {
        "record": [draws.decimal(-2, 2, 2) for _ in range(modes)],
        "noise": [round(noise * draws.decimal(0.2, 2, 2), 6) for _ in range(modes)],
        "weights": [draws.choice([0.5, 1.0, 2.0, 4.0]) for _ in range(classes)],
        "covariances": covariances(draws, modes, classes),
        "signals": means,
        "sizes": [2.0**power for power in exponents],
        "prior": [share / 100 for share in shares],
        "shape": kernel(modes),
    }


# Verifies: ORA-020, ROB-031, ROB-032.
def robust_evidence():
    group = Group("robust_evidence", SOURCE, case_by_case(REASONS, bound=0))
    by_hand(group)
    drawn(group)
    special(group)
    refuse(group)
    large(group)
    return group


def large(group):
    draws = Draws(108)
    neighbours = lambda most: [[max(0, most - 2 * abs(i - j)) for j in range(40)] for i in range(40)]
    signal = whole(40, draws, 2)
    add(group, "forty modes", {
        "record": added(signal, whole(40, draws, 3)), "noise": [draws.integer(1, 4) for _ in range(40)], "weights": [1], "covariances": neighbours(4),
        "signals": [signal], "sizes": [2], "prior": [1], "shape": neighbours(3),
    }, (16, 32))  # fmt: skip
    args = drawn_args(draws, 2, 20, 8)
    more = [whole(2, draws, 3) for _ in range(16)]
    add(group, "twenty classes and twenty-four signals", {
        **args, "signals": args["signals"] + more, "sizes": args["sizes"] * 3, "prior": [0.04] * 23 + [0.08],
    }, ())  # fmt: skip


def by_hand(group):
    one = {
        "record": [1.5], "noise": [0.5], "weights": [2.0], "covariances": [[0.5]], "signals": [[2.0]], "sizes": [1.0],
        "prior": [1.0], "shape": [[1.0]],
    }
    two = {
        "record": [2.0, 0.5], "noise": [0.25, 1.0], "weights": [3.0, 1.0], "covariances": [[1.0, 0.5], [0.5, 1.0], [4.0, 0.0], [0.0, 0.0]],
        "signals": [[2.0, 1.0], [0.0, -1.0]], "sizes": [2.0, 0.5], "prior": [0.75, 0.25], "shape": [[1.0, 0.25], [0.25, 0.5]],
    }
    for name, args in [("one mode", one), ("two modes, classes and signals", two)]:
        n = len(args["record"])
        zero = [[0.0] * n for _ in range(n)]
        for comment, changes in [
            ("by hand", {}),
            ("nothing disturbs", {"covariances": zero * len(args["weights"]), "noise": [1.0] * n}),
            ("the shape holds", {"shape": zero}),
            ("the record is nothing", {"record": [0.0] * n}),
            ("the record is a signal", {"record": args["signals"][0]}),
            ("the record is a signal turned round", {"record": [-v for v in args["signals"][0]]}),
            ("the signal is nothing", {"signals": [[0.0] * n for _ in args["sizes"]]}),
            ("the signal is far above the noise", {"signals": [[64 * v for v in m] for m in args["signals"]]}),
            ("and so is the record", {"signals": [[64 * v for v in m] for m in args["signals"]], "record": [90.0] * n}),
        ]:
            add(group, f"{name}: {comment}", {**args, **changes})


def drawn(group):
    draws = Draws(95)
    for number in range(24):
        modes, classes, signals = draws.integer(2, 5), 1 + number % 4, 1 + number // 4 % 4
        args = drawn_args(draws, modes, classes, signals)
        if number % 2:
            strength = draws.decimal(0.5, 1.5, 1)
            args["record"] = [round(strength * m + 0.1 * y, 5) for m, y in zip(draws.choice(args["signals"]), args["record"])]
        add(group, f"drawn, {modes} modes, {classes} classes, {signals} signals{', inclusion' * (number % 2)}", args)


def special(group):
    draws = Draws(96)
    args = drawn_args(draws, 4, 3, 8)
    sizes = [2.0**-k for k in (3, 0, 6, 7, 1, 5, 2, 4)]
    add(group, "eight signals of eight sizes", {**args, "sizes": sizes})
    args = drawn_args(draws, 4, 3, 3)
    for comment, changes in [
        ("weights of 10⁻¹² and 10¹²", {"weights": [1e-12, 1e12, 1.0]}),
        ("the same weights in another unit", {"weights": [7.0 * weight for weight in args["weights"]]}),
        ("a class twice", {"covariances": args["covariances"][:4] * 2 + args["covariances"][8:]}),
        ("a prior of 10⁻²⁰⁰", {"prior": [1e-200, 0.25, 0.75]}),
        ("a prior of 0", {"prior": [0.0, 0.25, 0.75]}),
        ("one alone can be", {"prior": [0.0, 0.0, 1.0]}),
        ("sizes that are equal", {"sizes": [0.3] * 3}),
        ("sizes that are nothing", {"sizes": [1e-9] * 3}),
        ("a record far from every class", {"record": [300.0, -200.0, 100.0, 400.0]}),
        ("a record beyond all that may be", {"record": [1e6, 1e6, -1e6, 1e6]}),
        ("a noise of 10⁻⁴ of the disturbances", {"noise": [1e-4, 2e-4, 1e-4, 3e-4]}),
        ("a noise of 10⁻⁵ of the disturbances", {"noise": [1e-5, 2e-5, 1e-5, 3e-5]}),
        ("a noise above the disturbances", {"noise": [100.0, 200.0, 100.0, 300.0]}),
        ("noises that differ by 10⁶", {"noise": [1e-6, 1.0, 1e-3, 1e-2]}),
    ]:
        add(group, comment, {**args, **changes})
    for power in (-20, 20, 300):
        scaled = lambda numbers, times: [v * 2.0 ** (times * power) for v in numbers]
        add(group, f"forces in units of 2^{-power} N", {
            **args,
            **{key: scaled(args[key], 1) for key in ("record", "sizes")},
            "noise": scaled(args["noise"], 2),
            "signals": [scaled(row, 1) for row in args["signals"]],
            "covariances": [scaled(row, 2) for row in args["covariances"]],
        })  # fmt: skip
    nearly = [[1.0, 0.999999], [0.999999, 1.0]]
    add(group, "nearly singular, condition 10⁶", {
        "record": [0.5, 0.4], "noise": [1e-9, 1e-9], "weights": [1.0, 3.0], "covariances": nearly + [[1.0, 0.0], [0.0, 1.0]],
        "signals": [[0.3, 0.1]], "sizes": [0.1], "prior": [1.0], "shape": nearly,
    })  # fmt: skip
    add(group, "many modes", drawn_args(draws, 12, 2, 2))
    add(group, "many classes", drawn_args(draws, 2, 12, 2))


def refuse(group):
    unit, tilted = [[1.0, 0.0], [0.0, 1.0]], [[2.0, 1.0], [1.0, 2.0]]
    args = {
        "record": [1.0, 2.0], "noise": [1.0, 0.5], "weights": [1.0, 2.0], "covariances": unit + tilted, "signals": [[1.0, 0.0], [0.5, 2.0]],
        "sizes": [1.0, 1.0], "prior": [0.25, 0.75], "shape": unit,
    }
    refuse_common(group, args, [], list(args))
    for comment, changes, flag in [
        ("the record is shorter", {"record": [1.0]}, "lengths_differ"),
        ("the noise is longer", {"noise": [1.0, 0.5, 1.0]}, "lengths_differ"),
        ("a class without a weight", {"weights": [1.0]}, "lengths_differ"),
        ("a weight without a class", {"weights": [1.0, 2.0, 3.0]}, "lengths_differ"),
        ("a row of a class is missing", {"covariances": (unit + tilted)[:3]}, "lengths_differ"),
        ("a row of a class is shorter", {"covariances": [*unit, [2.0, 1.0], [1.0]]}, "lengths_differ"),
        ("a signal is shorter", {"signals": [[1.0, 0.0], [0.5]]}, "lengths_differ"),
        ("a signal without a size", {"sizes": [1.0]}, "lengths_differ"),
        ("a signal without a prior", {"prior": [1.0]}, "lengths_differ"),
        ("a row of the shape is missing", {"shape": unit[:1]}, "lengths_differ"),
        ("no modes", {"record": [], "noise": [], "covariances": [[], []], "signals": [[], []], "shape": []}, "empty"),
        ("no classes", {"weights": [], "covariances": []}, "empty"),
        ("no signals", {"signals": [], "sizes": [], "prior": []}, "empty"),
        ("a noise of 0", {"noise": [1.0, 0.0]}, "out_of_range"),
        ("a noise below 0", {"noise": [1.0, -0.5]}, "out_of_range"),
        ("a weight of 0", {"weights": [1.0, 0.0]}, "out_of_range"),
        ("a weight below 0", {"weights": [3.0, -1.0]}, "out_of_range"),
        ("a size of 0", {"sizes": [1.0, 0.0]}, "out_of_range"),
        ("a size below 0", {"sizes": [-1.0, 1.0]}, "out_of_range"),
        ("a prior below 0", {"prior": [-0.25, 1.25]}, "prior_unchecked"),
        ("priors that add up to 0.9", {"prior": [0.25, 0.65]}, "prior_unchecked"),
        ("a class that is not symmetric", {"covariances": [*unit, [2.0, 1.0], [0.5, 2.0]]}, "not_symmetric"),
        ("a shape that is not symmetric", {"shape": [[1.0, 0.5], [0.0, 1.0]]}, "not_symmetric"),
        ("a class that is not positive definite", {"covariances": [*unit, [1.0, 3.0], [3.0, 1.0]]}, "not_positive_definite"),
        ("a variance below 0", {"covariances": [*unit, [-2.0, 0.0], [0.0, 1.0]]}, "not_positive_definite"),
        ("a shape that is not positive definite", {"shape": [[-200.0, 0.0], [0.0, 1.0]]}, "not_positive_definite"),
    ]:
        group.refuse(comment, args, flag, **changes)
    group.refuse("an answer beyond the largest f64", args, "infinite_answer", "overflow", record=[1e200, 2.0])
    text = '{"record":[1],"noise":[1],"weights":[1],"covariances":[[NaN]],"signals":[[1]],"sizes":[1],"prior":[1],"shape":[[1]]}'
    for token in ("NaN", "1e999"):
        group.refuse_line(f"a class holds {token}", text.replace("NaN", token))


GROUPS = [robust_evidence]

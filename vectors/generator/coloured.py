"""Θ in coloured noise (DET-040 … 043): linear systems by elimination in exact fractions."""

from fractions import Fraction

from mpmath import exp, mpf, sqrt

from .filters import root
from .numbers import UNIT, Draws, exact, nearest, real
from .series import added, dot, exacts, noise, signal, whole
from .suite import Group, absolute, case_by_case, cut_answers, refuse_common


def solve(matrix, right):
    """K⁻¹ b by Gauss' elimination without pivots, which a positive definite K does not need."""
    n = len(matrix)
    rows = [list(row) + [b] for row, b in zip(matrix, right)]
    for k in range(n):
        assert rows[k][k] > 0, "not positive definite"
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            if factor:
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k])]
    x = [Fraction(0)] * n
    for k in reversed(range(n)):
        x[k] = (rows[k][n] - sum((rows[k][j] * x[j] for j in range(k + 1, n)), Fraction(0))) / rows[k][k]
    return x


def cholesky(matrix):
    n = len(matrix)
    lower = [[mpf(0)] * n for _ in range(n)]
    for i in range(n):
        for j in range(i + 1):
            rest = real(matrix[i][j]) - sum((lower[i][k] * lower[j][k] for k in range(j)), mpf(0))
            lower[i][j] = sqrt(rest) if i == j else rest / lower[j][j]
    return lower


def sensitivity(matrix, a, b):
    """|K⁻¹a|ᵀ |L| |Lᵀ| |K⁻¹b|: how much a change of |L||Lᵀ| by a relative 1 can change aᵀK⁻¹b."""
    lower = cholesky(matrix)
    n = len(matrix)

    def reach(vector):
        sizes = [abs(real(v)) for v in solve(matrix, vector)]
        return [sum(abs(lower[i][k]) * sizes[i] for i in range(k, n)) for k in range(n)]

    return exact(sum(x * y for x, y in zip(reach(a), reach(b))))


def covariance(draws, count, kind):
    """2N × 2N as floats, symmetric to the bit: a decaying correlation in each channel, and one between the channels."""
    n = 2 * count
    sx, sy = draws.decimal(0.03, 0.3), draws.decimal(0.03, 0.3)
    reach, cross = draws.decimal(0.5, 4), draws.decimal(-0.8, 0.8)
    if kind == "white":
        reach, cross = 0.02, 0.0
    if kind == "channels alike":
        cross = 0.999
    if kind == "slow":
        reach = 60.0
    if kind == "independent channels":
        cross = 0.0
    matrix = [[0.0] * n for _ in range(n)]
    for i in range(n):
        for j in range(i + 1):
            lag = abs(i % count - j % count)
            correlation = 0.0 if kind == "white" and lag else nearest(exp(-mpf(lag) / mpf(reach)))
            deviations = (sx if i < count else sy) * (sx if j < count else sy)
            same = (i < count) == (j < count)
            matrix[i][j] = matrix[j][i] = deviations * correlation * (1 if same else cross)
    return matrix


# Verifies: DET-040, DET-041, DET-043.
def theta_colored():
    source = "exact fractions; roots by mpmath 1.3.0 at 50 digits"
    group = Group("theta_colored", source, case_by_case(["theta", "gamma"]))
    draws = Draws(40)
    kinds = ["white", "independent channels", "channels alike", "slow", *["correlated channels"] * 3]
    for number in range(64):
        count = 1 if number < 3 else 10 if number in (3, 4) else draws.integer(2, 4)
        kind = kinds[number % len(kinds)]
        matrix = covariance(draws, count, kind)
        dx, dy = signal(count, draws, draws.decimal(0.05, 0.5))
        if number % 9 == 5:
            dx, kind = [0.0] * count, kind + ", lateral channel without signal"
        template = dx + dy
        residual = noise(2 * count, draws, 0.15)
        if number % 2:
            residual, kind = [round(a + b, 5) for a, b in zip(residual, template)], kind + ", inclusion"
        if number in (20, 21):
            residual, kind = list(template), kind + ", the residual is the template: Θ = γ²/2"
        if number in (22, 23):
            residual, kind = [v / 2 for v in template], kind + ", half of the template: Θ = 0"
        if number in (24, 25, 26, 27):
            scale = 2.0 ** (300, -300, 20, -20)[number - 24]
            residual, template = [v * scale for v in residual], [v * scale for v in template]
            matrix = [[v * scale * scale for v in row] for row in matrix]
            kind += f", forces in units of 2^{(-300, 300, -20, 20)[number - 24]} N"
        if number == 28:
            template, kind = [0.0] * (2 * count), "no signal: Θ = γ = 0"
        coloured_case(group, kind, residual, template, matrix)
    coloured_case(group, "a small one by hand: γ² = 2", [1.0, 0.0], [1.0, 2.0], [[1.0, 0.0], [0.0, 4.0]])
    coloured_case(group, "variances of 1 and 1e-12", [0.1, 1e-7], [0.2, 1e-6], [[1.0, 0.0], [0.0, 1e-12]])
    coloured_case(group, "nearly singular, condition 10⁶", [0.1, 0.2], [0.3, 0.1], [[1.0, 0.999999], [0.999999, 1.0]])
    refuse_covariances(group)
    count, draws = 40, Draws(104)
    template = whole(2 * count, draws, 2)
    residual = added(template, whole(2 * count, draws, 5))
    coloured_case(group, "a long record", residual, template, banded(draws, count), (24, 32, 64))
    return group


def banded(draws, count):
    """Neighbours are correlated, and the last four samples of both channels: elimination leaves most zeros as they are."""
    matrix = [[0] * (2 * count) for _ in range(2 * count)]
    pairs = [(i, i + 1) for i in range(2 * count - 1)] + [(count - k, 2 * count - k) for k in range(1, 5)]
    for i, row in enumerate(matrix):
        row[i] = draws.integer(4, 6)
    for i, j in pairs:
        matrix[i][j] = matrix[j][i] = draws.choice([-1, 1])
    return matrix


def coloured_case(group, kind, residual, template, matrix, cuts=()):
    k, r, d = [exacts(row) for row in matrix], exacts(residual), exacts(template)
    n, count = len(k), len(k) // 2
    x = solve(k, d)
    centred = [a - b / 2 for a, b in zip(r, d)]
    theta, gamma2 = dot(x, centred), dot(x, d)
    ok = {"theta": theta, "gamma": root(gamma2)}

    def by(matrix, d=d, centred=centred):
        y = solve(matrix, d)
        return {"theta": dot(y, centred), "gamma": root(dot(y, d))}

    diagonal = [[k[i][j] if i == j else Fraction(0) for j in range(n)] for i in range(n)]
    blocks = [[k[i][j] if (i < count) == (j < count) else Fraction(0) for j in range(n)] for i in range(n)]
    product = [dot(row, d) for row in k]
    wrong = [
        ("half_left_out", {"theta": dot(x, [a - b for a, b in zip(r, d)])}),
        ("half_left_out", {"theta": dot(x, r)}),
        ("correlation_ignored", by(diagonal)),
        ("cross_channel_ignored", by(blocks)),
        ("covariance_not_inverted", {"theta": dot(product, centred), "gamma": root(dot(product, d))}),
        ("gamma_squared", {"gamma": real(gamma2)}),
        ("sign_exchanged", {"theta": -theta}),
    ]
    lower = cholesky(k)
    backward = [[lower[j][i] if j >= i else mpf(0) for j in range(n)] for i in range(n)]

    def whitened(vector):
        """By the upper factor from the end, as if L were Lᵀ."""
        y = [mpf(0)] * n
        for i in reversed(range(n)):
            y[i] = (real(vector[i]) - sum((backward[i][j] * y[j] for j in range(i + 1, n)), mpf(0))) / backward[i][i]
        return y

    wd, wc = whitened(d), whitened(centred)
    transposed = {"theta": sum(a * b for a, b in zip(wd, wc)), "gamma": sqrt(sum(a * a for a in wd))}
    wrong.append(("cholesky_transposed", transposed))
    swapped = [[k[(i + count) % n][(j + count) % n] for j in range(n)] for i in range(n)]
    wrong.append(("channels_exchanged", by(swapped)))
    args = {"residual": residual, "template": template, "covariance": matrix}
    wrong += cut_answers({"matrix": k, "d": d, "centred": centred}, cuts, lambda first: by(**first))
    steps = (4 * n + 12) * UNIT
    reason = (
        "(4·2N + 12) 2⁻⁵³ |K⁻¹a|ᵀ|L||Lᵀ||K⁻¹b|: backward errors of Cholesky's factor, of two solves and of the product"
    )
    bound = steps * sensitivity(k, d, centred)
    gamma_bound = steps * sensitivity(k, d, d) / (2 * exact(root(gamma2))) if gamma2 else Fraction(0)
    limits = {"theta": absolute(bound, "1", reason), "gamma": absolute(gamma_bound, "1", reason + ", over 2γ")}
    group.accept(kind, args, ok, wrong, tolerance=limits)


def refuse_covariances(group):
    args = {"residual": [0.1, 0.2], "template": [0.3, 0.1], "covariance": [[1.0, 0.25], [0.25, 1.0]]}
    refuse_common(group, args, [], ["residual", "template", "covariance"])
    bad = {
        "not symmetric": [[1.0, 0.25], [0.5, 1.0]],
        "only the upper triangle": [[1.0, 0.25], [0.0, 1.0]],
        "only the lower triangle": [[1.0, 0.0], [0.25, 1.0]],
    }
    for kind, matrix in bad.items():
        group.refuse(kind, args, "not_symmetric", covariance=matrix)
    bad = {
        "singular": [[1.0, 1.0], [1.0, 1.0]],
        "singular, anticorrelated": [[4.0, -2.0], [-2.0, 1.0]],
        "indefinite": [[1.0, 2.0], [2.0, 1.0]],
        "negative definite": [[-1.0, 0.0], [0.0, -1.0]],
        "a variance of 0": [[1.0, 0.0], [0.0, 0.0]],
        "a variance below 0": [[1.0, 0.0], [0.0, -1e-9]],
        "zero": [[0.0, 0.0], [0.0, 0.0]],
    }
    for kind, matrix in bad.items():
        group.refuse(kind, args, "not_positive_definite", covariance=matrix)
    four = {"residual": [0.1] * 4, "template": [0.2] * 4}
    singular = [[1.0, 0.5, 0.0, 0.5], [0.5, 1.0, 0.5, 0.0], [0.0, 0.5, 1.0, 0.5], [0.5, 0.0, 0.5, 1.0]]
    group.refuse("singular of order 4: rows 1 + 3 = rows 2 + 4", four, "not_positive_definite", covariance=singular)
    group.refuse(
        "two equal samples of order 4",
        four,
        "not_positive_definite",
        covariance=[[1.0, 1.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
    )
    group.refuse("a row is shorter", args, "lengths_differ", covariance=[[1.0, 0.25], [0.25]])
    group.refuse("the covariance is of another order", args, "lengths_differ", covariance=[[1.0]])
    group.refuse("the template is longer", args, "lengths_differ", template=[0.3, 0.1, 0.2, 0.4])
    group.refuse(
        "an odd number: no two channels",
        {"residual": [0.1], "template": [0.1], "covariance": [[1.0]]},
        "lengths_differ",
    )
    group.refuse("empty", {"residual": [], "template": [], "covariance": []}, "empty")
    for token in ("NaN", "1e999"):
        text = '{"residual":[0.1,0.2],"template":[0.3,0.1],"covariance":[[1,%s],[0.25,1]]}' % token
        group.refuse_line(f"a covariance of {token}", text)


GROUPS = [theta_colored]

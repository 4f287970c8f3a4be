"""Matched filter and Θ in white noise (DET-013 … 016).

Sums of products are exact fractions; only square roots are taken in 50 digits.
"""

from fractions import Fraction

from mpmath import mpf, sqrt

from .numbers import UNIT, Draws, exact, real
from .series import added, dot, exacts, magnitude, noise, signal, whole
from .suite import Group, absolute, case_by_case, in_ulp, refuse_common

SOURCE = "exact fractions; square roots by mpmath 1.3.0 at 50 digits"
SWEEP = 401
"""Samples of each channel of a usual record (VEC-019)."""


def root(ratio):
    return sqrt(real(ratio))


def filtered(template, deviation):
    """b, σ and γ² of one channel."""
    d, s = exacts(template), exact(deviation)
    energy = dot(d, d)
    return root(energy / len(d)), root(s * s / len(d)), energy / (s * s)


def sum_ulps(count):
    """A recursive sum of squares has an error of (N + 2)·2⁻⁵³ at most, which the root halves; 8 for the rest."""
    return 8 + (count + 3) // 2


SUM = "(N + 2)·2⁻⁵³ for a plain sum of squares, halved by the root, and 8 for differences, scaling, quotient and root"


def templates(draws):
    """Templates and noise of both channels, and what they are."""
    cases = []
    for count in (1, 2, 3, 5, 9, 21, 41):
        x, y = signal(count, draws)
        cases.append((x, y, 0.1, 0.15, f"{count} samples"))
    x, y = signal(9, draws)
    cases += [
        ([0.0] * 9, y, 0.1, 0.15, "lateral channel zero"),
        (x, [0] * 9, 0.1, 0.15, "normal channel zero"),
        ([0.0] * 4, [0.0] * 4, 0.1, 0.1, "no signal: γ = 0"),
    ]
    for power, kind in (
        (-700, "squares underflow"),
        (700, "squares overflow"),
        (-1000, "near the least normal number"),
        (1000, "near the largest number"),
    ):
        u = 2.0**power
        cases.append(([v * u for v in x], [v * u for v in y], 0.1 * u, 0.15 * u, f"unit of 2^{-power} N: {kind}"))
    cases += [
        (x, y, 1e-100, 2e-100, "tiny noise: γ of 10⁹⁹"),
        (x, y, 1e100, 1e100, "huge noise: tiny γ"),
        (x, y, 0.1, 1e6, "only the lateral channel says anything"),
        ([1e-3, 3e-160], [2.0, 0.1], 0.5, 0.25, "a sample lost in rounding"),
        ([3, 4], [0, 0], 1, 1, "3, 4, 5"),
    ]
    x, y = signal(200, draws)
    cases.append((x, y, 0.235, 0.2, "a long record: 200 samples"))
    for _ in range(42):
        count = draws.integer(2, 12)
        x, y = signal(count, draws, draws.decimal(0.05, 1))
        cases.append((x, y, draws.decimal(0.01, 0.5), draws.decimal(0.01, 0.5), "drawn"))
    return cases


# Verifies: DET-013.
def matched_filter():
    sigma = {"sigma_x": in_ulp(4, "√N and a quotient, or the root of the weight"), "sigma_y": in_ulp(4, "as sigma_x")}
    sums = {key: in_ulp(16, SUM) for key in ("b_x", "b_y", "gamma")}
    group = Group("matched_filter", SOURCE, {key: {**sums, **sigma}[key] for key in ("b_x", "b_y", *sigma, "gamma")})
    for case in templates(Draws(20)):
        filter_case(group, *case)
    refuse_filters(group)
    draws = Draws(101)
    x, y = whole(SWEEP, draws, 9), whole(SWEEP, draws, 9)
    filter_case(group, x, y, 30, 40, "a sweep's record", (128, 256))
    return group


def filter_answer(x, y, sx, sy):
    (bx, nx, gx), (by, ny, gy) = filtered(x, sx), filtered(y, sy)
    return {"b_x": bx, "b_y": by, "sigma_x": nx, "sigma_y": ny, "gamma": root(gx + gy)}


def filter_case(group, x, y, sx, sy, kind, cuts=()):
    (bx, nx, gx), (by, ny, gy) = filtered(x, sx), filtered(y, sy)
    count = len(x)
    n, ratio = mpf(count), exact(sx) ** 2 / exact(sy) ** 2
    wrong = [
        ("weight_missing", {"b_x": bx * sqrt(n), "b_y": by * sqrt(n), "sigma_x": mpf(sx), "sigma_y": mpf(sy)}),
        ("weight_missing", {"gamma": root((gx + gy) / count)}),
        ("weight_missing", {"sigma_x": mpf(sx), "sigma_y": mpf(sy), "gamma": root((gx + gy) / count)}),
        ("gamma_squared", {"gamma": real(gx + gy)}),
        ("variance_for_sd", {"sigma_x": nx * nx, "sigma_y": ny * ny}),
        ("variance_for_sd", {"gamma": root(gx * exact(sx) + gy * exact(sy))}),
        ("channels_exchanged", {"gamma": root(gx * ratio + gy / ratio)}),
        ("channel_missing", {"gamma": root(gy)}),
    ]
    if abs(x[0]) > 1e150 or 0 < abs(x[0]) < 1e-150:
        wrong.append(("squares_underflow", {"b_x": mpf(0), "b_y": mpf(0), "gamma": mpf(0)}))
    wrong += [("record_cut", filter_answer(x[:size], y[:size], sx, sy)) for size in cuts]
    limits = None
    if sum_ulps(count) > 16:
        limits = {key: in_ulp(sum_ulps(count), SUM) for key in ("b_x", "b_y", "gamma")}
    args = {"template_x": x, "template_y": y, "noise_sd_x": sx, "noise_sd_y": sy}
    group.accept(kind, args, filter_answer(x, y, sx, sy), wrong, tolerance=limits)


def refuse_filters(group):
    args = {"template_x": [0.1, 0.2], "template_y": [0.3, 0.4], "noise_sd_x": 0.1, "noise_sd_y": 0.2}
    refuse_common(group, args, ["noise_sd_x", "noise_sd_y"], ["template_x", "template_y"])
    refuse_deviations(group, args)
    group.refuse("lengths differ", args, "lengths_differ", template_x=[0.1])
    group.refuse("empty", args, "empty", template_x=[], template_y=[])
    huge = {"template_x": [1e300, 1e300], "noise_sd_x": 1e-300}
    group.refuse("γ would be infinite", args, "infinite_answer", error="overflow", **huge)
    text = '{"template_x":[1e999,0.2],"template_y":[0.3,0.4],"noise_sd_x":0.1,"noise_sd_y":0.2}'
    group.refuse_line("a sample is 1e999", text)


def refuse_deviations(group, args):
    for key in ("noise_sd_x", "noise_sd_y"):
        for value in (0, -0.1):
            group.refuse(f"{key} = {value!r}", args, "out_of_range", **{key: value})


def correlate(residual, template, deviation):
    """Σ rΔ/s², ½ ΣΔ²/s² and the sum of their terms' magnitudes, of one channel."""
    s2 = exact(deviation) ** 2
    return (
        dot(residual, template) / s2,
        dot(template, template) / (2 * s2),
        (magnitude(residual, template) + dot(template, template) / 2) / s2,
    )


# Verifies: DET-015, DET-013, DET-014.
def theta():
    tolerance = {**case_by_case(["theta"]), **case_by_case(["y_x", "y_y"], "N"), "gamma": in_ulp(16, SUM)}
    group = Group("theta", SOURCE, tolerance)
    draws = Draws(21)
    for number in range(84):
        count = [1, 2, 3, 5, 9, 15, 21][number] if number < 7 else 120 if number in (7, 8) else draws.integer(2, 8)
        dx, dy = signal(count, draws, draws.decimal(0.05, 0.6))
        f0x, f0y = ([draws.decimal(*ends, 4) for _ in range(count)] for ends in ((-0.3, 0.3), (0.8, 1.6)))
        sx, sy = draws.decimal(0.02, 0.4), draws.decimal(0.02, 0.4)
        kind, present, scale = ("inclusion", 1, 1.0) if number % 2 else ("no inclusion", 0, 1.0)
        if number in (10, 11):
            dx, kind = [0.0] * count, kind + ", lateral channel without signal"
        if number in (12, 13):
            dy, kind = [0.0] * count, kind + ", normal channel without signal"
        if number in (14, 15):
            dx, dy, kind = [0.0] * count, [0.0] * count, kind + ", no signal at all"
        f1x, f1y = [round(a + b, 6) for a, b in zip(f0x, dx)], [round(a + b, 6) for a, b in zip(f0y, dy)]
        mean_x, mean_y = (f1x, f1y) if present else (f0x, f0y)
        px = [round(a + b, 6) for a, b in zip(mean_x, noise(count, draws, sx))]
        py = [round(a + b, 6) for a, b in zip(mean_y, noise(count, draws, sy))]
        if number in (16, 17):
            px, py, kind = list(f0x), list(f0y), "the record is F_0: Θ = −γ²/2"
        if number in (18, 19):
            px, py, kind = list(f1x), list(f1y), "the record is F_1: Θ = γ²/2"
        if number in (20, 21, 22):
            px, py = ([(a + b) / 2 for a, b in zip(*ends)] for ends in ((f0x, f1x), (f0y, f1y)))
            kind = "half way: Θ cancels to rounding errors of the record"
        if number in (23, 24, 25, 26):
            scale = 2.0 ** (-660, 660, -900, 900)[number - 23]
            kind += f", forces in units of 2^{(660, -660, 900, -900)[number - 23]} N"
        if number in (27, 28):
            sx, sy, kind = sx * 1e-6, sy * 1e-6, kind + ", tiny noise: huge γ"
        if number in (29, 30):
            sx, sy, kind = sx * 1e8, sy * 1e8, kind + ", huge noise: tiny γ"
        if number in (31, 32):
            f0y, f1y, py = ([v + 1e6 for v in f] for f in (f0y, f1y, py))
            kind += ", on top of 1 MN: the differences cancel"
        series = [[v * scale for v in f] for f in (px, py, f0x, f0y, f1x, f1y)]
        theta_case(group, kind, series, sx * scale, sy * scale)
    refuse_records(group)
    draws = Draws(102)
    f0 = whole(SWEEP, draws, 9), whole(SWEEP, draws, 9)
    f1 = [added(f, whole(SWEEP, draws, 2)) for f in f0]
    theta_case(group, "a sweep's record", [*(added(f, whole(SWEEP, draws, 9)) for f in f1), *f0, *f1], 6, 8, (128, 256))
    return group


def refuse_records(group):
    args = {
        "observed_x": [0.1, 0.2],
        "observed_y": [1.0, 1.1],
        "f0_x": [0.0, 0.1],
        "f0_y": [1.0, 1.0],
        "f1_x": [0.2, 0.3],
        "f1_y": [1.2, 1.3],
        "noise_sd_x": 0.1,
        "noise_sd_y": 0.2,
    }
    lists = [key for key in args if not key.startswith("noise")]
    refuse_common(group, args, ["noise_sd_x", "noise_sd_y"], lists)
    refuse_deviations(group, args)
    for key in lists:
        group.refuse(f"{key} is shorter", args, "lengths_differ", **{key: args[key][:1]})
    group.refuse("empty", args, "empty", **{key: [] for key in lists})
    text = '"observed_x":[-1e999],"observed_y":[1],"f0_x":[0],"f0_y":[1],"f1_x":[0.2],"f1_y":[1.2]'
    group.refuse_line("a sample is -1e999", "{" + text + ',"noise_sd_x":0.1,"noise_sd_y":0.2}')


def outputs(channels):
    """y(0) of each channel."""
    found = {}
    for key, (r, d, _) in zip(("y_x", "y_y"), channels):
        energy = dot(d, d)
        found[key] = real(dot(r, d) / len(d)) / root(energy / len(d)) if energy else mpf(0)
    return found


def total(channels):
    """Θ of both channels."""
    return sum((rd - half for rd, half, _ in (correlate(*channel) for channel in channels)), Fraction(0))


def theta_case(group, kind, series, sx, sy, cuts=()):
    px, py, f0x, f0y, f1x, f1y = (exacts(f) for f in series)
    count, channels = len(px), []
    for p, f0, f1, s in ((px, f0x, f1x, sx), (py, f0y, f1y, sy)):
        channels.append(([a - b for a, b in zip(p, f0)], [a - b for a, b in zip(f1, f0)], s))
    raw = [(p, d, s) for p, (_, d, s) in zip((px, py), channels)]
    turned = [(r, d[::-1], s) for r, d, s in channels]
    sums, y, y_bounds = [correlate(*channel) for channel in channels], outputs(channels), []
    for r, d, _ in channels:
        energy = dot(d, d)
        size = exact(real(magnitude(r, d) / count) / root(energy / count)) if energy else Fraction(0)
        y_bounds.append((count * 3 // 2 + 10) * UNIT * size)
    value = sum(rd - half for rd, half, _ in sums)
    gamma2 = 2 * sum(half for _, half, _ in sums)
    bound = (count + 8) * UNIT * sum(size for _, _, size in sums)
    ratio = exact(sx) ** 2 / exact(sy) ** 2

    def weighted(weights):
        """θ and γ² where the squares of each channel have another weight."""
        pairs = list(zip(sums, weights))
        return sum((rd - half) * w for (rd, half, _), w in pairs), 2 * sum(half * w for (_, half, _), w in pairs)

    by_sd, by_sd2 = weighted((exact(sx), exact(sy)))
    exchanged, exchanged2 = weighted((ratio, 1 / ratio))
    wrong = [
        ("half_left_out", {"theta": sum(rd - 2 * half for rd, half, _ in sums)}),
        ("half_left_out", {"theta": sum(rd for rd, _, _ in sums)}),
        ("sign_exchanged", {"theta": -value}),
        ("gamma_squared", {"gamma": real(gamma2)}),
        ("time_not_reversed", {"theta": total(turned), **outputs(turned)}),
        ("time_not_reversed", {"theta": total(turned)}),
        ("variance_for_sd", {"theta": by_sd, "gamma": root(by_sd2)}),
        ("variance_for_sd", {"theta": by_sd}),
        ("weight_missing", {"theta": value / count, "gamma": root(gamma2 / count)}),
        ("weight_missing", {key: output * count for key, output in y.items()}),
        ("f0_not_subtracted", {"theta": total(raw), **outputs(raw)}),
        ("channels_exchanged", {"theta": exchanged, "gamma": root(exchanged2)}),
    ]
    for size in cuts:
        first = [(r[:size], d[:size], s) for r, d, s in channels]
        energy = sum(half for _, half, _ in (correlate(*channel) for channel in first))
        wrong.append(("record_cut", {"theta": total(first), **outputs(first), "gamma": root(2 * energy)}))
    limits = {
        "theta": absolute(bound, "1", "(N + 8) 2⁻⁵³ Σ (|rΔ| + Δ²/2)/s²: plain sums of rounded differences"),
        "y_x": absolute(y_bounds[0], "N", "(3N/2 + 10) 2⁻⁵³ w Σ|rΔ|/b"),
        "y_y": absolute(y_bounds[1], "N", "as y_x"),
    }
    if sum_ulps(count) > 16:
        limits["gamma"] = in_ulp(sum_ulps(count), SUM)
    names = ("observed_x", "observed_y", "f0_x", "f0_y", "f1_x", "f1_y")
    args = {**dict(zip(names, series)), "noise_sd_x": sx, "noise_sd_y": sy}
    group.accept(kind, args, {"theta": value, **y, "gamma": root(gamma2)}, wrong, tolerance=limits)


GROUPS = [matched_filter, theta]

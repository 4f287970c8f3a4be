"""Matched filter and Θ in white noise (DET-013 … 016).

Sums of products are exact fractions; only square roots are taken in 50 digits.
"""

from fractions import Fraction

from mpmath import mpf, sqrt

from .numbers import UNIT, Draws, exact, real
from .series import dot, exacts, magnitude, noise, signal
from .suite import Group, absolute, in_ulp, refuse_common

SOURCE = "exact fractions; square roots by mpmath 1.3.0 at 50 digits"


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


# Verifies: DET-013.
def matched_filter():
    group = Group(
        "matched_filter",
        "matched_filter",
        SOURCE,
        {
            "b_x": in_ulp(16, SUM),
            "b_y": in_ulp(16, SUM),
            "sigma_x": in_ulp(4, "√N and a quotient, or the root of the weight"),
            "sigma_y": in_ulp(4, "as sigma_x"),
            "gamma": in_ulp(16, SUM),
        },
    )
    draws = Draws(20)
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
        scale = 2.0**power
        cases.append(
            ([v * scale for v in x], [v * scale for v in y], 0.1 * scale, 0.15 * scale, f"unit of 2^{-power} N: {kind}")
        )
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
    for x, y, sx, sy, kind in cases:
        (bx, nx, gx), (by, ny, gy) = filtered(x, sx), filtered(y, sy)
        count = len(x)
        ok = {"b_x": bx, "b_y": by, "sigma_x": nx, "sigma_y": ny, "gamma": root(gx + gy)}
        n = mpf(count)
        wrong = [
            ("weight_missing", {"b_x": bx * sqrt(n), "b_y": by * sqrt(n), "sigma_x": mpf(sx), "sigma_y": mpf(sy)}),
            ("weight_missing", {"gamma": root((gx + gy) / count)}),
            ("weight_missing", {"sigma_x": mpf(sx), "sigma_y": mpf(sy), "gamma": root((gx + gy) / count)}),
            ("gamma_squared", {"gamma": real(gx + gy)}),
            ("variance_for_sd", {"sigma_x": nx * nx, "sigma_y": ny * ny}),
            ("variance_for_sd", {"gamma": root(gx * exact(sx) + gy * exact(sy))}),
            (
                "channels_exchanged",
                {"gamma": root(gx * exact(sx) ** 2 / exact(sy) ** 2 + gy * exact(sy) ** 2 / exact(sx) ** 2)},
            ),
            ("channel_missing", {"gamma": root(gy)}),
        ]
        if abs(x[0]) > 1e150 or 0 < abs(x[0]) < 1e-150:
            wrong.append(("squares_underflow", {"b_x": mpf(0), "b_y": mpf(0), "gamma": mpf(0)}))
        limits = None
        if sum_ulps(count) > 16:
            limits = {key: in_ulp(sum_ulps(count), SUM) for key in ("b_x", "b_y", "gamma")}
        group.accept(
            kind, {"template_x": x, "template_y": y, "noise_sd_x": sx, "noise_sd_y": sy}, ok, wrong, tolerance=limits
        )
    args = {"template_x": [0.1, 0.2], "template_y": [0.3, 0.4], "noise_sd_x": 0.1, "noise_sd_y": 0.2}
    refuse_common(group, args, ["noise_sd_x", "noise_sd_y"], ["template_x", "template_y"])
    refuse_deviations(group, args)
    group.refuse("lengths differ", {**args, "template_x": [0.1]}, "bad_argument", ["lengths_differ"])
    group.refuse("empty", {**args, "template_x": [], "template_y": []}, "bad_argument", ["empty"])
    group.refuse(
        "γ would be infinite",
        {**args, "template_x": [1e300, 1e300], "noise_sd_x": 1e-300},
        "overflow",
        ["infinite_answer"],
    )
    group.refuse_line(
        "a sample is 1e999",
        '{"template_x":[1e999,0.2],"template_y":[0.3,0.4],"noise_sd_x":0.1,"noise_sd_y":0.2}',
        ["not_finite"],
    )
    return group


def refuse_deviations(group, args):
    for key in ("noise_sd_x", "noise_sd_y"):
        for value in (0, -0.1):
            group.refuse(f"{key} = {value!r}", {**args, key: value}, "out_of_range", ["out_of_range"])


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
    group = Group(
        "theta",
        "theta",
        SOURCE,
        {
            "theta": absolute(UNIT, "1", "cases state their own"),
            "y_x": absolute(UNIT, "N", "cases state their own"),
            "y_y": absolute(UNIT, "N", "cases state their own"),
            "gamma": in_ulp(16, SUM),
        },
    )
    draws = Draws(21)
    for number in range(84):
        count = [1, 2, 3, 5, 9, 15, 21][number] if number < 7 else 120 if number in (7, 8) else draws.integer(2, 8)
        dx, dy = signal(count, draws, draws.decimal(0.05, 0.6))
        f0x, f0y = [draws.decimal(-0.3, 0.3, 4) for _ in range(count)], [
            draws.decimal(0.8, 1.6, 4) for _ in range(count)
        ]
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
            px, py, kind = [a for a in f0x], [a for a in f0y], "the record is F_0: Θ = −γ²/2"
        if number in (18, 19):
            px, py, kind = [a for a in f1x], [a for a in f1y], "the record is F_1: Θ = γ²/2"
        if number in (20, 21, 22):
            px, py, kind = (
                [(a + b) / 2 for a, b in zip(f0x, f1x)],
                [(a + b) / 2 for a, b in zip(f0y, f1y)],
                "half way: Θ cancels to rounding errors of the record",
            )
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
        group.refuse(f"{key} is shorter", {**args, key: args[key][:1]}, "bad_argument", ["lengths_differ"])
    group.refuse("empty", {**args, **{key: [] for key in lists}}, "bad_argument", ["empty"])
    group.refuse_line(
        "a sample is -1e999",
        '{"observed_x":[-1e999],"observed_y":[1],"f0_x":[0],"f0_y":[1],"f1_x":[0.2],"f1_y":[1.2],"noise_sd_x":0.1,"noise_sd_y":0.2}',
        ["not_finite"],
    )
    return group


def theta_case(group, kind, series, sx, sy):
    px, py, f0x, f0y, f1x, f1y = (exacts(f) for f in series)
    count = len(px)
    channels, sums = [], []
    for p, f0, f1, s in ((px, f0x, f1x, sx), (py, f0y, f1y, sy)):
        r, d = [a - b for a, b in zip(p, f0)], [a - b for a, b in zip(f1, f0)]
        channels.append((r, d, s))
        sums.append(correlate(r, d, s))
    y, y_bounds = [], []
    for r, d, s in channels:
        energy = dot(d, d)
        b = root(energy / count)
        y.append(real(dot(r, d) / count) / b if energy else mpf(0))
        y_bounds.append(
            (count * 3 // 2 + 10) * UNIT * exact(real(magnitude(r, d) / count) / b) if energy else Fraction(0)
        )
    value = sum(rd - half for rd, half, _ in sums)
    gamma2 = 2 * sum(half for _, half, _ in sums)
    bound = (count + 8) * UNIT * sum(size for _, _, size in sums)
    ok = {"theta": value, "y_x": y[0], "y_y": y[1], "gamma": root(gamma2)}

    def other(change):
        """Θ by a changed rule for each channel."""
        return sum((rd - half for rd, half, _ in (change(*channel) for channel in channels)), Fraction(0))

    wrong = [
        ("half_left_out", {"theta": sum(rd - 2 * half for rd, half, _ in sums)}),
        ("half_left_out", {"theta": sum(rd for rd, _, _ in sums)}),
        ("sign_exchanged", {"theta": -value}),
        ("gamma_squared", {"gamma": real(gamma2)}),
    ]
    wrong.append(
        (
            "time_not_reversed",
            {
                "theta": other(lambda r, d, s: correlate(r, d[::-1], s)),
                "y_x": turned(channels[0]),
                "y_y": turned(channels[1]),
            },
        )
    )
    wrong.append(("time_not_reversed", {"theta": other(lambda r, d, s: correlate(r, d[::-1], s))}))
    wrong.append(
        (
            "variance_for_sd",
            {
                "theta": sum((rd - half) * exact(s) for (rd, half, _), (_, _, s) in zip(sums, channels)),
                "gamma": root(2 * sum(half * exact(s) for (_, half, _), (_, _, s) in zip(sums, channels))),
            },
        )
    )
    wrong.append(
        ("variance_for_sd", {"theta": sum((rd - half) * exact(s) for (rd, half, _), (_, _, s) in zip(sums, channels))})
    )
    wrong.append(("weight_missing", {"theta": value / count, "gamma": root(gamma2 / count)}))
    wrong.append(("weight_missing", {"y_x": y[0] * count, "y_y": y[1] * count}))
    wrong.append(
        (
            "f0_not_subtracted",
            {
                "theta": other_observed(channels, (f0x, f0y)),
                "y_x": unsubtracted(channels[0], f0x),
                "y_y": unsubtracted(channels[1], f0y),
            },
        )
    )
    ratio = exact(sx) ** 2 / exact(sy) ** 2
    wrong.append(
        (
            "channels_exchanged",
            {
                "theta": (sums[0][0] - sums[0][1]) * ratio + (sums[1][0] - sums[1][1]) / ratio,
                "gamma": root(2 * (sums[0][1] * ratio + sums[1][1] / ratio)),
            },
        )
    )
    limits = {
        "theta": absolute(bound, "1", "(N + 8) 2⁻⁵³ Σ (|rΔ| + Δ²/2)/s²: plain sums of rounded differences"),
        "y_x": absolute(y_bounds[0], "N", "(3N/2 + 10) 2⁻⁵³ w Σ|rΔ|/b"),
        "y_y": absolute(y_bounds[1], "N", "as y_x"),
    }
    if sum_ulps(count) > 16:
        limits["gamma"] = in_ulp(sum_ulps(count), SUM)
    names = ("observed_x", "observed_y", "f0_x", "f0_y", "f1_x", "f1_y")
    group.accept(kind, {**dict(zip(names, series)), "noise_sd_x": sx, "noise_sd_y": sy}, ok, wrong, tolerance=limits)


def turned(channel):
    r, d, _ = channel
    energy = dot(d, d)
    return real(dot(r, d[::-1]) / len(d)) / root(energy / len(d)) if energy else mpf(0)


def unsubtracted(channel, f0):
    r, d, _ = channel
    energy = dot(d, d)
    return real(dot([a + b for a, b in zip(r, f0)], d) / len(d)) / root(energy / len(d)) if energy else mpf(0)


def other_observed(channels, references):
    total = Fraction(0)
    for (r, d, s), f0 in zip(channels, references):
        rd, half, _ = correlate([a + b for a, b in zip(r, f0)], d, s)
        total += rd - half
    return total


GROUPS = [matched_filter, theta]

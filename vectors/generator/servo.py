"""The servo kernel's cell, fraction and force, to the bit (SRV-002 … 014, VEC-011).

Implements: VEC-011.
"""

from contextlib import suppress
from fractions import Fraction

from .numbers import Draws
from .single import bits, of_bits, rounded, single
from .suite import Group, is_exact, refuse_common, without

SOURCE = "exact fractions, rounded to f32 after each operation"
INFINITY = float("inf")
BITS = is_exact("bits of f32 operations in the order of VEC-011")


def cell(knots, x):
    below = [i for i in range(len(knots) - 1) if knots[i] <= x]
    return below[-1] if below else 0


def fraction(knots, x, rule="kernel"):
    """The cell and its fraction; `rule` names a plausible other way."""
    j = cell(knots, x)
    low, high = Fraction(0), Fraction(1)
    if x < knots[0]:
        low, high = Fraction(-1), Fraction(0)
    elif x >= knots[-1]:
        low, high = Fraction(1), Fraction(2)
    if x in (INFINITY, -INFINITY):
        return j, low if x < 0 else high
    start, end = Fraction(knots[j]), Fraction(knots[j + 1])
    if rule == "f64":
        t = rounded((Fraction(x) - start) / (end - start))
    elif rule == "division":
        t = rounded(rounded(Fraction(x) - start) / rounded(end - start))
    else:
        reciprocal = rounded(1 / rounded(end - start))
        try:
            t = rounded(rounded(Fraction(x) - start) * reciprocal)
        except OverflowError:
            t = high if x > 0 else low
    if rule == "unbounded":
        return j, t
    if rule == "clamped":
        low, high = Fraction(0), Fraction(1)
    return j, min(max(t, low), high)


def blend(a, b, t, rule="kernel"):
    """(1 − t) a + t b, put back into the hull within the cell."""
    if rule == "difference":
        value = rounded(a + rounded(t * rounded(b - a)))
    elif rule == "fused":
        value = rounded(t * b + rounded(rounded(1 - t) * a))
    elif rule == "f64":
        value = (1 - t) * a + t * b
    else:
        value = rounded(rounded(rounded(1 - t) * a) + rounded(t * b))
    if rule != "unbound" and 0 <= t <= 1:
        value = min(max(value, min(a, b)), max(a, b))
    return value


def force(depths, laterals, table, d, x, rule="kernel", of_fraction="kernel"):
    i, s = fraction(depths, d, of_fraction)
    j, t = fraction(laterals, x, of_fraction)
    f = [[Fraction(table[i + a][j + b]) for b in (0, 1)] for a in (0, 1)]
    return rounded(blend(blend(f[0][0], f[0][1], t, rule), blend(f[1][0], f[1][1], t, rule), s, rule))


def axis(draws, count, uniform):
    start, knots = draws.decimal(-0.01, 0.0, 4), []
    for _ in range(count):
        knots.append(single(start))
        start += 0.001 if uniform else draws.decimal(0.0002, 0.003, 5)
    return knots


def neighbour(x, steps):
    """The f32 some steps after a positive one."""
    pattern = int(bits(x), 16)
    return of_bits(pattern + steps)


# Verifies: SRV-002, SRV-004.
def servo_axis():
    group = Group("servo_axis", SOURCE, {"cell": is_exact("an index"), "fraction_bits": BITS})
    draws = Draws(60)
    for number, count in enumerate((2, 3, 4, 5, 9, 17, 41)):
        knots = axis(draws, count, number % 2 == 0)
        width = knots[-1] - knots[0]
        coordinates = [
            (knots[0], "first knot"),
            (knots[-1], "last knot"),
            (knots[count // 2], "a knot"),
            (single(knots[0] - 0.4 * (knots[1] - knots[0])), "before the axis"),
            (single(knots[-1] + 0.6 * (knots[-1] - knots[-2])), "after the axis"),
            (single(knots[0] - 3 * width), "far before: one cell at most"),
            (single(knots[-1] + 3 * width), "far after: one cell at most"),
        ]
        coordinates += [(single(draws.between(knots[0], knots[-1])), "inside") for _ in range(5)]
        for x, kind in coordinates:
            axis_case(group, f"{count} knots, {kind}", knots, x)
    knots = [single(v) for v in (0.0005, 0.0013, 0.0029)]
    for x, kind in (
        (INFINITY, "+∞"),
        (-INFINITY, "−∞"),
        (3.4028234663852886e38, "the largest f32"),
        (-3.4028234663852886e38, "the largest f32, negative"),
        (of_bits(1), "the least subnormal"),
        (neighbour(knots[1], -1), "the last before a knot"),
        (neighbour(knots[1], 1), "the first after a knot"),
        (neighbour(knots[2], -1), "the last before the end"),
        (neighbour(knots[2], 1), "the first after the end"),
        (neighbour(knots[0], -1), "the last before the axis"),
    ):
        axis_case(group, kind, knots, x)
    knots = [0.0, 2.0**-19, 1.0]
    for x in (2.0**-20, 2.0**-19, 0.5, of_bits(1), -of_bits(1), -(2.0**-20), 1.75):
        axis_case(group, "widths of 2 µm and 1 m", knots, x)
    refuse_axes(group)
    return group


def axis_case(group, kind, knots, x):
    if x == 0:
        x = 0.0
    j, t = fraction(knots, x)
    wrong = []
    for flag, rule in (
        ("clamped_outside", "clamped"),
        ("overshoot", "unbounded"),
        ("division", "division"),
        ("f64_arithmetic", "f64"),
    ):
        with suppress(OverflowError):
            wrong.append((flag, {"fraction_bits": bits(fraction(knots, x, rule)[1])}))
    other = j + 1 if j + 2 < len(knots) else j - 1
    if 0 <= other and x not in (INFINITY, -INFINITY):
        wrong.append(("cell_off_by_one", {"cell": other}))
    wrong.append(("weights_exchanged", {"fraction_bits": bits(rounded(1 - t))}))
    group.accept(kind, {"knots": knots, "coordinate_bits": bits(x)}, {"cell": j, "fraction_bits": bits(t)}, wrong)


def refuse_axes(group):
    args = {"knots": [0.0, 0.5], "coordinate_bits": bits(0.25)}
    refuse_common(group, args, [], ["knots"])
    bad = (
        ([0.5], "a single knot"),
        ([], "no knots"),
        ([0.0, 0.5, 0.25], "knots out of order"),
        ([0.25, 0.25], "two equal knots"),
        ([0.5, 0.25], "a decreasing axis"),
        ([0.0, 2.0**-21], "less than 1 µm apart"),
        ([0.0, 1.5], "beyond 1 m"),
        ([-1.25, 0.0], "before −1 m"),
        ([k / 2048 for k in range(1025)], "1025 knots"),
    )
    for knots, kind in bad:
        flag = "axes_not_increasing" if len(knots) < 9 and len(knots) > 1 else "out_of_range"
        group.refuse(kind, args, flag, knots=knots)
    for text, kind in (
        ("0x3e8", "three digits"),
        ("0x3e8000000", "nine digits"),
        ("0x3e80000g", "no hexadecimal digit"),
        (0.25, "a number"),
        ("", "no text"),
        (None, "null"),
    ):
        group.refuse(f"coordinate_bits: {kind}", args, "wrong_type", coordinate_bits=text)
    group.refuse("coordinate_bits is missing", {"knots": [0.0, 0.5]}, "missing_argument")


# Verifies: SRV-010, SRV-011, SRV-012, SRV-014.
def servo_interpolate():
    group = Group("servo_interpolate", SOURCE, {"force_bits": BITS})
    draws = Draws(61)
    for rows, columns in ((2, 2), (3, 4), (4, 3), (5, 5), (2, 7), (9, 5)):
        depths = [0.0] + [single(0.0005 * (k + 1) + draws.decimal(0, 0.0002, 5)) for k in range(rows - 1)]
        laterals = axis(draws, columns, False)
        table = [
            [single(draws.decimal(-2, 2, 3) if i else draws.decimal(-0.01, 0.01, 4)) for _ in range(columns)]
            for i in range(rows)
        ]
        deep, left, right = depths[-1], laterals[0], laterals[-1]
        inside = lambda: (single(draws.between(0, deep)), single(draws.between(left, right)))
        places = [(*inside(), "inside") for _ in range(5)]
        places += [
            (depths[1], laterals[0], "node"),
            (deep, right, "last node"),
            (depths[0], laterals[-1], "corner node"),
            (depths[1], inside()[1], "on a line of depth"),
            (inside()[0], laterals[1], "on a line of position"),
            (inside()[0], single(left - 0.0001), "before the least position"),
            (inside()[0], single(right + 0.0001), "after the largest position"),
            (single(deep + 0.0002), inside()[1], "below the largest depth"),
            (single(deep + 0.0002), single(right + 0.0001), "corner outside"),
            (single(deep * 40), single(left - 2.0), "far outside: one cell at most"),
            (-0.0001, inside()[1], "above the surface: no force"),
        ]
        for d, x, kind in places:
            force_case(group, f"{rows} × {columns}, {kind}", depths, laterals, table, single(d), x)
    depths, laterals = [0.0, single(0.001), single(0.003)], [single(-0.002), 0.0, single(0.005)]
    table = [[0.0, 0.0, 0.0], [single(0.3), single(0.1), single(-0.7)], [100.0, -100.0, single(99.9)]]
    for d, x, kind in (
        (0.003, -0.002, "the largest force at its node"),
        (0.0029, 0.0049, "forces that cancel"),
        (0.009, 0.02, "the largest continuation"),
        (0.003, 1e30, "far beyond the range of positions"),
        (1e30, -1e30, "beyond all ranges"),
        (2.0**-140, 0.001, "subnormal depth"),
    ):
        force_case(group, kind, depths, laterals, table, single(d), single(x))
    for _ in range(14):
        d, x = single(draws.between(0.0005, 0.004)), single(draws.between(-0.004, 0.008))
        force_case(group, "drawn, three cells", depths, laterals, table, d, x)
    refuse_tables(group)
    return group


def force_case(group, kind, depths, laterals, table, d, x):
    above = d < 0
    value = Fraction(0) if above else force(depths, laterals, table, d, x)
    outside = not (laterals[0] <= x <= laterals[-1] and depths[0] <= d <= depths[-1])
    # What SRV-010 and SRV-011 do not fix: the hull where one coordinate alone is within, and the sign of a zero.
    if not above and (value == 0 or (outside and value != force(depths, laterals, table, d, x, "unbound"))):
        return
    wrong = [("plane_above_surface", {"force_bits": bits(force(depths, laterals, table, d, x))})] if above else []
    if not above:
        for flag, rule, of_fraction in (
            ("clamped_outside", "kernel", "clamped"),
            ("overshoot", "kernel", "unbounded"),
            ("lerp_by_difference", "difference", "kernel"),
            ("fused", "fused", "kernel"),
            ("f64_arithmetic", "f64", "f64"),
            ("division", "kernel", "division"),
            ("hull_left_out", "unbound", "kernel"),
        ):
            with suppress(OverflowError):
                wrong.append((flag, {"force_bits": bits(force(depths, laterals, table, d, x, rule, of_fraction))}))
        rows, columns = len(depths), len(laterals)
        flat = [f for row in table for f in row]
        turned = [[flat[b * rows + a] for b in range(columns)] for a in range(rows)]
        wrong.append(("transposed", {"force_bits": bits(force(depths, laterals, turned, d, x))}))
    args = {
        "depth_knots": depths,
        "lateral_knots": laterals,
        "table_bits": [[bits(f) for f in row] for row in table],
        "depth_bits": bits(d),
        "lateral_bits": bits(x),
    }
    group.accept(kind, args, {"force_bits": bits(value)}, wrong)


def refuse_tables(group):
    one = bits(1.0)
    args = {
        "depth_knots": [0.0, 0.5],
        "lateral_knots": [-0.5, 0.5],
        "table_bits": [[one, one], [one, one]],
        "depth_bits": bits(0.25),
        "lateral_bits": bits(0.0),
    }
    refuse_common(group, args, [], ["depth_knots", "lateral_knots"])
    for key in ("depth_knots", "lateral_knots"):
        group.refuse(f"{key} decreases", args, "axes_not_increasing", **{key: [0.5, 0.0]})
        group.refuse(f"{key} has one knot", args, "out_of_range", **{key: [0.5]})
        group.refuse(f"{key} has more knots than the table", args, "lengths_differ", **{key: [0.0, 0.25, 0.5]})
    for pattern, kind, flag in (
        ("0x7fc00000", "NaN", "not_finite"),
        ("0x7f800000", "+∞", "not_finite"),
        (bits(100.00001), "beyond 100 N", "out_of_range"),
        (bits(-1e30), "beyond −100 N", "out_of_range"),
    ):
        group.refuse(f"a force is {kind}", args, flag, table_bits=[[one, one], [pattern, one]])
    group.refuse("a force is a number", args, "wrong_type", table_bits=[[one, one], [1.0, one]])
    group.refuse("a row is shorter", args, "lengths_differ", table_bits=[[one, one], [one]])
    group.refuse("a row too few", args, "lengths_differ", table_bits=[[one, one]])
    for key in ("table_bits", "depth_bits", "lateral_bits"):
        group.refuse(f"{key} is missing", without(args, key), "missing_argument")


GROUPS = [servo_axis, servo_interpolate]

"""Bilinear interpolation of a force table (MAP-060 … 062): exact fractions."""

from fractions import Fraction

from .numbers import UNIT, Draws, exact
from .suite import Group, absolute, case_by_case, is_exact, refuse_common


def cell(axis, position):
    """The last knot at or below the position, but one that has a cell after it."""
    below = [i for i in range(len(axis) - 1) if axis[i] <= position]
    return below[-1] if below else 0


def bilinear(depths, laterals, table, depth, lateral, clamp=False, exchange=False):
    """F of spec/force-map.md and the four corners' largest magnitude times the weights' sum."""
    d, x = exact(depth), exact(lateral)
    i, j = cell(depths, depth), cell(laterals, lateral)
    s = (d - exact(depths[i])) / (exact(depths[i + 1]) - exact(depths[i]))
    t = (x - exact(laterals[j])) / (exact(laterals[j + 1]) - exact(laterals[j]))
    if clamp:
        s, t = min(max(s, Fraction(0)), Fraction(1)), min(max(t, Fraction(0)), Fraction(1))
    if exchange:
        s, t = 1 - s, 1 - t
    corners = [exact(table[i + a][j + b]) for a in (0, 1) for b in (0, 1)]
    value = (1 - s) * ((1 - t) * corners[0] + t * corners[1]) + s * ((1 - t) * corners[2] + t * corners[3])
    size = (abs(s) + abs(1 - s)) * (abs(t) + abs(1 - t)) * max(abs(c) for c in corners)
    return value, size, (s, t, i, j)


def table_of(draws, rows, columns):
    force = lambda i, j: 0.4 * (i + draws.decimal(0.2, 0.9)) * (1 + draws.decimal(-0.3, 0.3)) - 0.1 * j
    return [[round(force(i, j), 4) for j in range(columns)] for i in range(rows)]


def poses(depths, laterals, draws):
    """Inside, at nodes, on borders, and outside on all sides and corners."""
    d0, d1, x0, x1 = depths[0], depths[-1], laterals[0], laterals[-1]
    wide, high = x1 - x0, d1 - d0
    inside_d, inside_x = draws.between(d0, d1), draws.between(x0, x1)
    yield "inside", inside_d, inside_x
    yield "inside", draws.between(d0, d1), draws.between(x0, x1)
    yield "node", draws.choice(depths), draws.choice(laterals)
    yield "last node", d1, x1
    yield "first node", d0, x0
    yield "on a line of depth", depths[1], inside_x
    yield "on a line of position", inside_d, laterals[-2]
    yield "beyond the least position", inside_d, x0 - 0.3 * wide
    yield "beyond the largest position", inside_d, x1 + 0.2 * wide
    yield "above the least depth", d0 - 0.4 * high, inside_x
    yield "below the largest depth", d1 + 0.3 * high, inside_x
    yield "corner: shallow, left", d0 - 0.1 * high, x0 - 0.1 * wide
    yield "corner: shallow, right", d0 - 0.1 * high, x1 + 0.2 * wide
    yield "corner: deep, left", d1 + 0.3 * high, x0 - 0.2 * wide
    yield "corner: deep, right", d1 + 0.1 * high, x1 + 0.1 * wide
    yield "far outside", d1 + 50 * high, x0 - 80 * wide


# Verifies: MAP-060, MAP-061.
def interpolate():
    group = Group("interpolate", "exact fractions", case_by_case(["force_n"], "N"))
    draws = Draws(30)
    for rows, columns in ((2, 2), (3, 4), (4, 3), (3, 3), (5, 2), (2, 6), (4, 4), (8, 9)):
        kind = f"{rows} × {columns}" + (", axes not uniform" if rows == columns == 4 else "")
        depths = [round(0.0005 * (i + 1), 4) for i in range(rows)]
        laterals = [round(0.001 * (j - columns // 2), 4) for j in range(columns)]
        if "uniform" in kind:
            depths, laterals = [0.0, 0.0001, 0.0015, 0.004], [-0.01, -0.0099, 0.003, 0.01]
        table = table_of(draws, rows, columns)
        for place, depth, lateral in poses(depths, laterals, draws):
            pose_case(group, f"{kind}, {place}", depths, laterals, table, depth, lateral)
    depths, laterals, table = [0.001, 0.002], [-0.001, 0.001], [[1e-300, -1e-300], [2e-300, 5e-324]]
    pose_case(group, "tiny forces", depths, laterals, table, 0.0015, 0.0003, subnormal=True)
    pose_case(group, "huge forces", depths, laterals, [[1e300, -1e300], [2e300, 1e290]], 0.0015, 0.0003)
    pose_case(group, "forces that cancel", depths, laterals, [[1.0, -1.0], [-1.0, 1.0]], 0.0015, 1e-19)
    depths, table = [0.001, 0.001 + 2.0**-62], [[1.0, 2.0], [3.0, 4.0]]
    pose_case(group, "a cell of one step of the last place", depths, laterals, table, 0.001, 0.0005)
    depths, table = [0.001, 0.002, 0.003], [[1.0, 2.0], [3.0, 5.0], [-4.0, 7.0]]
    pose_case(group, "just below a knot", depths, laterals, table, 0.002 - 2.0**-61, 0.0005)
    refuse_tables(group)
    return group


def refuse_tables(group):
    args = {
        "depths_m": [0.001, 0.002],
        "laterals_m": [0.0, 0.001],
        "table_n": [[1.0, 2.0], [3.0, 5.0]],
        "depth_m": 0.0015,
        "lateral_m": 0.0005,
    }
    refuse_common(group, args, ["depth_m", "lateral_m"], ["depths_m", "laterals_m", "table_n"])
    for key in ("depths_m", "laterals_m"):
        group.refuse(f"{key} decreases", args, "axes_not_increasing", **{key: [0.002, 0.001]})
        group.refuse(f"{key} with two equal", args, "axes_not_increasing", **{key: [0.001, 0.001]})
        group.refuse(f"{key} is longer than the table", args, "lengths_differ", **{key: [0.001, 0.002, 0.003]})
        group.refuse(f"{key} is empty", args, "empty", **{key: []})
    group.refuse(
        "the last knots are out of order",
        args,
        "axes_not_increasing",
        depths_m=[0.001, 0.003, 0.002],
        table_n=[[1, 2], [3, 5], [4, 4]],
    )
    for comment, changes in [
        ("depth", {"depths_m": [0.001], "table_n": [[1.0, 2.0]]}),
        ("position", {"laterals_m": [0.0], "table_n": [[1.0], [2.0]]}),
    ]:
        group.refuse(f"a single {comment}", args, "out_of_range", error="bad_argument", **changes)
    group.refuse("a row is shorter", args, "lengths_differ", table_n=[[1.0, 2.0], [3.0]])
    group.refuse("a row is missing", args, "lengths_differ", table_n=[[1.0, 2.0]])
    group.refuse("the table is flat", args, "wrong_type", table_n=[1.0, 2.0, 3.0, 4.0])
    group.refuse("a force is null", args, "wrong_type", table_n=[[1.0, None], [3.0, 5.0]])
    for token in ("NaN", "1e999"):
        text = f'"depths_m":[0.001,0.002],"laterals_m":[0,0.001],"table_n":[[1,2],[3,{token}]],"depth_m":0.0015,"lateral_m":0.0005'
        group.refuse_line(f"a force is {token}", "{" + text + "}")
    far = {"table_n": [[1e10, 2e10], [3e10, 5e10]], "depth_m": 1e200, "lateral_m": 1e200}
    group.refuse("so far outside that the force is no f64", args, "infinite_answer", error="overflow", **far)


def pose_case(group, kind, depths, laterals, table, depth, lateral, subnormal=False):
    value, size, (s, t, i, j) = bilinear(depths, laterals, table, depth, lateral)
    near_d = min(range(len(depths)), key=lambda k: abs(exact(depths[k]) - exact(depth)))
    near_x = min(range(len(laterals)), key=lambda k: abs(exact(laterals[k]) - exact(lateral)))
    wrong = [
        ("clamped_outside", {"force_n": bilinear(depths, laterals, table, depth, lateral, clamp=True)[0]}),
        ("nearest_node", {"force_n": Fraction(table[near_d][near_x])}),
        ("weights_exchanged", {"force_n": bilinear(depths, laterals, table, depth, lateral, exchange=True)[0]}),
    ]
    flat = [force for row in table for force in row]
    rows, columns = len(depths), len(laterals)
    # The same numbers, read column by column.
    turned = [[flat[b * rows + a] for b in range(columns)] for a in range(rows)]
    wrong.append(("transposed", {"force_n": bilinear(depths, laterals, turned, depth, lateral)[0]}))
    if s in (0, 1) and t in (0, 1):
        limit = is_exact("MAP-060: a node's force to the bit")
    else:
        floor = Fraction(12, 2**1074) if subnormal else 0
        limit = absolute(
            12 * UNIT * size + floor,
            "N",
            "12 · 2⁻⁵³ (|s|+|1−s|)(|t|+|1−t|) max|F|: 4 roundings of each weight, 2 products, 2 sums",
        )
    args = {"depths_m": depths, "laterals_m": laterals, "table_n": table, "depth_m": depth, "lateral_m": lateral}
    group.accept(kind, args, {"force_n": value}, wrong, tolerance={"force_n": limit})


GROUPS = [interpolate]

"""The ops of force tables, the element, the servo kernel and the device's reports with SciPy and NumPy."""

import struct
from itertools import permutations

import numpy as np
from scipy import linalg
from scipy.interpolate import RegularGridInterpolator

from oracle_lines import bits, knots, limited, listed, positive, real, refuse_if, rows, series, single, text, whole


def interpolate(depths_m: series, laterals_m: series, table_n: rows, depth_m: real, lateral_m: real):
    fits = table_n.shape == (len(depths_m), len(laterals_m)) and min(table_n.shape) >= 2
    refuse_if(not fits, "bad_argument", "the table does not fit its axes")
    for axis in (depths_m, laterals_m):
        refuse_if(np.any(np.diff(axis) <= 0), "out_of_range", "the axis does not increase")
    law = RegularGridInterpolator((depths_m, laterals_m), table_n, bounds_error=False, fill_value=None)
    return {"force_n": law((depth_m, lateral_m))[()]}


def nodes(value):
    refuse_if(rows(value).shape != (6, 2), "bad_argument", "must be six nodes")
    return rows(value)


def cowper():
    """L1, L2, L3 and weight of six points, exact to degree 4."""
    for sign in (1, -1):
        a = (8 - np.sqrt(10) + sign * np.sqrt(38 - 44 * np.sqrt(0.4))) / 18
        weight = (620 + sign * np.sqrt(213125 - 53320 * np.sqrt(10))) / 7440
        for point in set(permutations((a, a, 1 - 2 * a))):
            yield (*point, weight)


def element_stiffness(nodes_m: nodes, youngs_modulus_pa: positive, poissons_ratio: limited(-1, 0.5, open_ends=True)):
    e, nu = youngs_modulus_pa, poissons_ratio
    elasticity = e / (1 + nu) * np.diag([1, 1, 0.5])
    elasticity[:2, :2] += e * nu / ((1 + nu) * (1 - 2 * nu))
    stiffness = np.zeros((12, 12))
    for l1, l2, l3, weight in cowper():
        by_xi = [1 - 4 * l1, 4 * l2 - 1, 0, 4 * (l1 - l2), 4 * l3, -4 * l3]
        by_eta = [1 - 4 * l1, 0, 4 * l3 - 1, -4 * l2, 4 * l2, 4 * (l1 - l3)]
        gradients = np.array([by_xi, by_eta])
        jacobian = gradients @ (nodes_m - nodes_m[0])
        determinant = linalg.det(jacobian)
        refuse_if(determinant <= 0, "out_of_range", "the element is turned over")
        by_x, by_y = linalg.solve(jacobian, gradients)
        strain = np.zeros((3, 12))
        strain[0, ::2] = strain[2, 1::2] = by_x
        strain[1, 1::2] = strain[2, ::2] = by_y
        stiffness += weight * determinant * strain.T @ elasticity @ strain
    return {"stiffness": stiffness}


def locate(knots, x):
    """The cell and the fraction of the servo kernel (VEC-011), in f32."""
    cell = int(np.clip(np.searchsorted(knots, x, "right") - 1, 0, len(knots) - 2))
    low, high = (-1, 0) if x < knots[0] else (1, 2) if x >= knots[-1] else (0, 1)
    t = (x - knots[cell]) * (np.float32(1) / (knots[cell + 1] - knots[cell]))
    return cell, np.clip(t, np.float32(low), np.float32(high))


def blend(a, b, t):
    value = (np.float32(1) - t) * a + t * b
    return np.clip(value, min(a, b), max(a, b)) if 0 <= t <= 1 else value


def servo_axis(knots: knots, coordinate_bits: single):
    cell, fraction = locate(knots, coordinate_bits)
    return {"cell": cell, "fraction_bits": bits(fraction)}


def servo_interpolate(depth_knots: knots, lateral_knots: knots, table_bits: lambda value: listed(value, lambda row: listed(row, single)),
                      depth_bits: single, lateral_bits: single):  # fmt: skip
    fits = len(table_bits) == len(depth_knots) and all(len(row) == len(lateral_knots) for row in table_bits)
    refuse_if(not fits, "bad_argument", "the table does not fit its axes")
    refuse_if(not np.all(np.abs(table_bits) <= 100), "out_of_range", "a force is beyond 100 N")
    (i, s), (j, t) = locate(depth_knots, depth_bits), locate(lateral_knots, lateral_bits)
    force = blend(*(blend(row[j], row[j + 1], t) for row in table_bits[i : i + 2]), s)
    return {"force_bits": bits(0 if depth_bits < 0 else force)}


CAPABILITIES = ("version", "position_unit_nm", "force_unit_un", "largest_force_mn", "period_us", "watchdog_ms",
                "damping_mn_s_per_m", "friction_mn")  # fmt: skip
REPORTS = {
    1: ("<BhhBBHH", ("lateral", "normal", "buttons", "status", "sequence", "force_sequence")),
    2: ("<BhhHB", ("lateral", "normal", "sequence", "flags")),
    3: ("<B8H", CAPABILITIES),
    4: ("<BB", ("control",)),
}


def report_decode(bytes: text):
    refuse_if(len(bytes) % 2 or not bytes.isalnum(), "bad_argument", "must be pairs of hexadecimal digits")
    data = bytearray.fromhex(bytes)
    layout, names = REPORTS.get(data[0], ("", ()))
    refuse_if(struct.calcsize(layout) != len(data) or data[0] == 4 and data[1] > 2, "out_of_range", "no such report")
    return dict(zip(("report", *names), struct.unpack(layout, data)))


def report_encode(report=None, **fields):
    refuse_if(whole(report) not in REPORTS, "out_of_range", "report must be 1 to 4")
    layout, names = REPORTS[whole(report)]
    refuse_if(set(fields) != set(names), "bad_argument", f"the fields must be {names}")
    values = [whole(fields[name]) for name in names]
    refuse_if(fields.get("control", 0) > 2, "out_of_range", "control is 0, 1 or 2")
    return {"bytes": struct.pack(layout, whole(report), *values).hex()}


OPS = (interpolate, element_stiffness, servo_axis, servo_interpolate, report_decode, report_encode)

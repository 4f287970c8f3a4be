"""Forces on the probe (VEC-011): from probe_force/forces.json, which probe_force.py there computes with scikit-fem; at finite
strain from tests/tables/finite_strain.txt.

Implements: VEC-011.
"""

import json
from fractions import Fraction
from pathlib import Path

from .suite import Group, absolute, case_by_case, refuse_common, without

DATA = Path(__file__).parent.parent / "probe_force" / "forces.json"
TABLE = Path(__file__).parent.parent.parent / "tests" / "tables" / "finite_strain.txt"
LENGTH = Fraction(30, 1000)
CHOSEN = [
    (0.5, 0.0), (0.5, 4.0), (1.0, 2.5), (1.0, 6.0), (2.0, 0.0), (2.0, 1.0), (2.0, 4.0), (3.0, 2.5), (3.0, 10.0),
    (4.0, 0.0), (4.0, 2.5), (4.0, 6.0), (4.0, 10.0),
]
MIRRORED = [(2.0, 4.0), (4.0, 2.5), (3.0, 10.0)]
# Without friction, 4 mm deep.
FINITE = [("none", 4.0), ("4.6", 2.5), ("6.6", 0.0), ("6.6", -2.5)]


def milli(value):
    """A number of the data, in newtons: its decimal, exactly."""
    return Fraction(str(value)) / 1000


# Verifies: FEM-012, PHA-011, FEM-021.
def probe_force():
    data = json.loads(DATA.read_text())
    keys = ("normal_force_n", "lateral_force_n")
    group = Group(
        "probe_force",
        data["program"] + ", three meshes of its own",
        case_by_case(keys, "N", Fraction(1, 1000)),
    )
    poses = {(p["phantom"], p["depth_mm"], p["lateral_mm"]): p for p in data["poses"]}
    for name in ("none", "2.6", "4.6", "6.6", "8.6"):
        for depth, lateral in CHOSEN:
            pose_case(group, poses, name, depth, lateral, 1)
        for depth, lateral in MIRRORED:
            pose_case(group, poses, name, depth, lateral, -1)
    args = {"phantom": "2.6", "depth_m": 0.002, "lateral_m": 0.001}
    refuse_common(group, args, ["depth_m", "lateral_m"])
    for phantom in ("5.0", "", "None", "2,6"):
        group.refuse(f"phantom {phantom!r}", args, "out_of_range", phantom=phantom)
    group.refuse("a phantom by number", args, "wrong_type", phantom=2.6)
    group.refuse("no phantom", without(args, "phantom"), "missing_argument")
    for depth, lateral, kind in (
        (-0.001, 0.0, "above the surface"),
        (0.0155, 0.0, "on the floor"),
        (2.0, 0.0, "in mm"),
        (0.004, 0.012, "through the right wall"),
        (0.001, -0.0169, "through the left wall"),
        (0.004, 2.5, "lateral in mm"),
    ):
        group.refuse(kind, args, "out_of_range", depth_m=depth, lateral_m=lateral)
    group.refuse("another theory", args, "out_of_range", strain="large")
    forces = finite_forces()
    for name, lateral in FINITE:
        finite_case(group, forces, poses, name, lateral)
    return group


def pose_case(group, poses, name, depth, lateral, sign):
    pose, reference = poses[name, depth, lateral], poses["none", depth, lateral]
    normal, side = milli(pose["normal_force_mn"]), sign * milli(pose["lateral_force_mn"])
    ok = {"normal_force_n": normal, "lateral_force_n": side}
    wrong = [
        ("per_length", {"normal_force_n": normal / LENGTH, "lateral_force_n": side / LENGTH}),
        ("half_force", {"normal_force_n": normal / 2, "lateral_force_n": side / 2}),
        ("forces_exchanged", {"normal_force_n": side, "lateral_force_n": normal}),
        (
            "inclusion_ignored",
            {
                "normal_force_n": milli(reference["normal_force_mn"]),
                "lateral_force_n": sign * milli(reference["lateral_force_mn"]),
            },
        ),
    ]
    wrong.append(("mirror_ignored" if sign < 0 else "lateral_sign", {"lateral_force_n": -side}))
    reason = "band of the expected value, and {} of the default mesh (FEM-021)"
    normal_bound = milli(pose["normal_band_mn"]) + normal * Fraction(3, 1000)
    lateral_bound = milli(pose["lateral_band_mn"]) + Fraction(15, 10000)
    limits = {
        "normal_force_n": absolute(normal_bound, "N", reason.format("0.3 %")),
        "lateral_force_n": absolute(lateral_bound, "N", reason.format("1.5 mN")),
    }
    args = {"phantom": name, "depth_m": depth / 1000, "lateral_m": sign * lateral / 1000}
    group.accept(f"phantom {name}, depth {depth} mm, lateral {sign * lateral} mm", args, ok, wrong, tolerance=limits)


def finite_forces():
    """Lateral and normal force, N, of the table's rows without friction at ν = 0.49, by disc and position."""
    rows = [line.split() for line in TABLE.read_text().splitlines()]
    rows = [row for row in rows if row[0] == "hyperelastic"]
    return {(disc, float(x)): (Fraction(side), Fraction(normal)) for _, disc, x, side, normal in rows}


def finite_case(group, forces, poses, name, lateral):
    side, normal = forces[name, lateral]
    ok = {"normal_force_n": normal, "lateral_force_n": side}
    small = poses[name, 4.0, abs(lateral)]
    sign = -1 if lateral < 0 else 1
    of_small = {"normal_force_n": milli(small["normal_force_mn"]), "lateral_force_n": sign * milli(small["lateral_force_mn"])}
    ignored = forces["none", lateral]
    wrong = [
        ("small_strain", of_small),
        ("inclusion_ignored", {"normal_force_n": ignored[1], "lateral_force_n": ignored[0]}),
        ("lateral_sign", {"lateral_force_n": -side}),
    ]
    reason = "both programs' meshes (finite-strain.md, Verification)"
    limits = {
        "normal_force_n": absolute(normal * Fraction(5, 1000), "N", "0.5 %: " + reason),
        "lateral_force_n": absolute(Fraction(3, 1000), "N", "3 mN: " + reason),
    }
    args = {"phantom": name, "depth_m": 0.004, "lateral_m": lateral / 1000, "strain": "finite"}
    group.accept(f"phantom {name} at finite strain, depth 4 mm, lateral {lateral} mm", args, ok, wrong, tolerance=limits)


GROUPS = [probe_force]

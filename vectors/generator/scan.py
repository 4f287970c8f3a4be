"""Θ at each shift of the template, and the largest (DET-050 … 053, full overlap only): exact fractions."""

from fractions import Fraction

from .filters import SOURCE, SWEEP, correlate, refuse_deviations
from .numbers import UNIT, Draws, exact
from .series import exacts, noise, signal, whole
from .suite import Group, absolute, case_by_case, is_exact, refuse_common


# Verifies: DET-050, DET-053.
def scan():
    reason = "the runner-up is farther off than both errors, or equal to the bit with short binary fractions"
    group = Group("scan", SOURCE, {**case_by_case(["theta", "max_theta"]), "argmax": is_exact(reason)})
    draws = Draws(22)
    for number in range(66):
        count = draws.integer(4, 14)
        length = draws.integer(2, count)
        kind = "drawn"
        if number < 4:
            length, kind = count, "M = N: one shift"
        elif number < 8:
            length, kind = 1, "M = 1"
        elif number == 8:
            count, length, kind = 1, 1, "one sample"
        elif number in (9, 10):
            count, length, kind = 60, 9, "a longer record"
        tx, ty = signal(length, draws, draws.decimal(0.1, 0.6))
        sx, sy = draws.decimal(0.02, 0.2), draws.decimal(0.02, 0.2)
        place = draws.integer(0, count - length)
        if number in (11, 12):
            place, kind = 0, "inclusion at the first shift"
        if number in (13, 14):
            place, kind = count - length, "inclusion at the last shift"
        if number in (15, 16):
            tx, kind = [0.0] * length, "lateral channel without signal"
        rx, ry = noise(count, draws, sx), noise(count, draws, sy)
        if number % 5:
            for i in range(length):
                rx[place + i] = round(rx[place + i] + tx[i], 5)
                ry[place + i] = round(ry[place + i] + ty[i], 5)
        elif kind == "drawn":
            kind = "drawn, no inclusion"
        scan_case(group, kind, rx, ry, tx, ty, sx, sy)
    ramp, flat = [0.5, 1.0, -0.25], [0.25, 0.5, 0.75]
    for kind, rx, ry in (
        ("period of the template: equal maxima, the first counts", ramp * 3, flat * 3),
        ("two equal maxima, the first counts", (ramp + [0.0]) * 3, (flat + [0.0]) * 3),
        ("record of zeros: all equal, the first counts", [0.0] * 6, [0.0] * 6),
    ):
        scan_case(group, kind, rx, ry, ramp, flat, 0.5, 0.25, tie=True)
    refuse_scans(group)
    draws = Draws(103)
    tx, ty = whole(101, draws, 2), whole(101, draws, 2)
    rx, ry = whole(SWEEP, draws, 9), whole(SWEEP, draws, 9)
    for i in range(101):
        rx[290 + i], ry[290 + i] = rx[290 + i] + tx[i], ry[290 + i] + ty[i]
    scan_case(group, "a sweep's record", rx, ry, tx, ty, 4, 8, bugs=False)
    return group


def refuse_scans(group):
    args = {
        "residual_x": [0.1, 0.2, 0.3],
        "residual_y": [0.3, 0.2, 0.1],
        "template_x": [0.1, 0.2],
        "template_y": [0.2, 0.1],
        "noise_sd_x": 0.1,
        "noise_sd_y": 0.2,
    }
    lists = [key for key in args if not key.startswith("noise")]
    refuse_common(group, args, ["noise_sd_x", "noise_sd_y"], lists)
    refuse_deviations(group, args)
    for key in lists:
        group.refuse(f"{key} is shorter", args, "lengths_differ", **{key: args[key][:-1]})
    group.refuse("template longer than the record", args, "lengths_differ", template_x=[0.1] * 4, template_y=[0.1] * 4)
    group.refuse("no template", args, "empty", template_x=[], template_y=[])
    group.refuse("nothing", args, "empty", **{key: [] for key in lists})


def scan_case(group, kind, rx, ry, tx, ty, sx, sy, tie=False, bugs=True):
    def run(rx, ry, tx, ty, sx, sy, half=Fraction(1)):
        rx, ry, tx, ty = (exacts(f) for f in (rx, ry, tx, ty))
        values, bound = [], Fraction(0)
        for shift in range(len(rx) - len(tx) + 1):
            part = slice(shift, shift + len(tx))
            (a, b, m), (c, d, n) = correlate(rx[part], tx, sx), correlate(ry[part], ty, sy)
            values.append(a + c - half * (b + d))
            bound = max(bound, (len(tx) + 8) * UNIT * (m + n))
        return values, bound

    def answer(values):
        return {"theta": values, "max_theta": max(values), "argmax": values.index(max(values))}

    values, bound = run(rx, ry, tx, ty, sx, sy)
    best = max(values)
    if not tie:
        runner_up = max([v for i, v in enumerate(values) if i != values.index(best)], default=None)
        assert runner_up is None or best - runner_up > 4 * bound, kind
    ok = answer(values)
    last = len(values) - 1 - values[::-1].index(best)
    wrong = [
        ("half_left_out", answer(run(rx, ry, tx, ty, sx, sy, Fraction(2))[0])),
        ("energy_of_whole_record", answer(run(rx, ry, tx, ty, sx, sy, Fraction(0))[0])),
        ("time_not_reversed", answer(run(rx, ry, tx[::-1], ty[::-1], sx, sy)[0])),
        ("variance_for_sd", answer(weighted(run, rx, ry, tx, ty, sx, sy))),
        ("channels_exchanged", answer(run(rx, ry, tx, ty, sy, sx)[0])),
        ("channel_missing", answer(run(rx, ry, [0.0] * len(tx), ty, sx, sy)[0])),
        ("argmax_off_by_one", {"argmax": ok["argmax"] + 1}),
        ("shift_reversed", answer(values[::-1])),
        ("weight_missing", answer([v / len(tx) for v in values])),
    ] if bugs else []
    if tie:
        wrong.append(("last_of_equals", {"argmax": last}))
    limit = absolute(bound, "1", "(M + 8) 2⁻⁵³ Σ (|rΔ| + Δ²/2)/s², the largest of the shifts")
    args = {"residual_x": rx, "residual_y": ry, "template_x": tx, "template_y": ty, "noise_sd_x": sx, "noise_sd_y": sy}
    group.accept(kind, args, ok, wrong, tolerance={"theta": limit, "max_theta": limit})


def weighted(run, rx, ry, tx, ty, sx, sy):
    """1/s for 1/s²."""
    lateral = run(rx, [0.0] * len(ry), tx, [0.0] * len(ty), sx, sy)[0]
    normal = run([0.0] * len(rx), ry, [0.0] * len(tx), ty, sx, sy)[0]
    return [a * exact(sx) + b * exact(sy) for a, b in zip(lateral, normal)]


GROUPS = [scan]

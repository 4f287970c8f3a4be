"""Evidence row by row, and the rows at which Wald's test ends (SEQ-001 … 010): least squares of each beginning of the record.

Implements: VEC-011.
"""

from mpmath import fdot, log, mpf, sqrt

from .bank import is_explained, squares_left
from .numbers import Draws, real
from .nuisances import Space, length, reals, record, shapes
from .series import added, signal, whole
from .suite import Group, absolute, case_by_case, cut_answers, is_exact, refuse_common, without

SOURCE = "Gram–Schmidt and least squares by normal equations for each beginning of the record, mpmath 1.3.0 at 50 digits"
REASONS = {
    "theta": "SEQ-001: 3e|δ|(|z| + |δ|)",
    "gamma": "SEQ-001: 3e|δ|²/γ",
    "residual": "SEQ-001: 3e|z|²",
}
EXACT = is_exact("a whole number")


def after(args, rows):
    """θ and γ of each template, and the space of the nuisances, for so many rows."""
    space = Space([nuisance[:rows] for nuisance in args["nuisances"]], rows)
    z, found = reals(args["residual"][:rows]), []
    for template in args["templates"]:
        delta = template[:rows]
        if is_explained(delta, space):
            found.append((mpf(0), mpf(0)))
            continue
        given = squares_left(space.kept, [a - b for a, b in zip(z, reals(delta))])
        found.append(((squares_left(space.kept, z) - given) / 2, length(space.beside(reals(delta)))))
    return found, space


def bounds(args):
    return -log(real(args["max_false_alarm"])), log(real(args["max_miss"]))


def ends(path, upper, lower):
    """The rows of the first θ beyond either bound, 0 for none and for what comes second."""
    for row, theta in enumerate(path, 1):
        if theta >= upper:
            return row, 0
        if theta <= lower:
            return 0, row
    return 0, 0


def paths(args):
    """θ of each template after each row."""
    return list(zip(*([theta for theta, _ in after(args, rows)[0]] for rows in range(1, len(args["residual"]) + 1))))


def nearest_bound(args):
    return min(abs(theta - bound) for path in paths(args) for theta in path for bound in bounds(args))


def answer(args, upper_lower=None, beside=None):
    found, space = after(args if beside is None else {**args, "nuisances": beside}, len(args["residual"]))
    stops = [ends(path, *(upper_lower or bounds(args))) for path in paths(args if beside is None else {**args, "nuisances": beside})]
    return {
        "theta": [theta for theta, _ in found],
        "gamma": [gamma for _, gamma in found],
        "residual": squares_left(space.kept, reals(args["residual"])),
        "rank": len(space.basis),
        "inclusion_at": [inclusion for inclusion, _ in stops],
        "no_inclusion_at": [none for _, none in stops],
    }


def add(group, comment, residual, templates, nuisances, max_false_alarm=0.01, max_miss=0.01, cuts=None):
    """With `cuts`, the wrong answers are those of the cut record alone."""
    args = {
        "residual": residual, "templates": templates, "nuisances": nuisances, "max_false_alarm": max_false_alarm, "max_miss": max_miss
    }
    assert nearest_bound(args) > 1e-6, "no θ is next to a bound"
    ok, (_, space) = answer(args), after(args, len(residual))
    e, z, sizes = 3 * space.error, length(reals(residual)), [length(reals(template)) for template in templates]
    tolerance = {
        "theta": max(e * size * (z + size) for size in sizes),
        "gamma": max([e * size**2 / gamma for size, gamma in zip(sizes, ok["gamma"]) if gamma], default=mpf(0)),
        "residual": e * z**2,
    }
    upper, lower = bounds(args)
    # With one row's θ alone: what the test would be of rows that do not add up.
    alone = [ends([(fdot([d], [v]) - d * d / 2) for d, v in zip(reals(t), reals(residual))], upper, lower) for t in templates]
    last = [ends([theta], upper, lower) for theta in ok["theta"]]
    stops = lambda pairs: {"inclusion_at": [p[0] for p in pairs], "no_inclusion_at": [p[1] for p in pairs]}
    wrong = [
        ("nuisances_ignored", answer(args, beside=[])),
        ("half_left_out", {"theta": [theta - gamma**2 / 2 for theta, gamma in zip(ok["theta"], ok["gamma"])]}),
        ("sign_exchanged", stops([(none, inclusion) for inclusion, none in zip(ok["inclusion_at"], ok["no_inclusion_at"])])),
        ("rates_swapped", answer(args, (-lower, -upper))),
        ("walds_bounds", answer(args, (log((1 - real(max_miss)) / real(max_false_alarm)), log(real(max_miss) / (1 - real(max_false_alarm)))))),
        ("rows_alone", stops(alone)),
        ("last_row_alone", stops([tuple(len(residual) * end for end in pair) for pair in last])),
        ("nominal_for_gamma", {"gamma": sizes}),
    ] if cuts is None else cut_answers(args, cuts, answer)
    group.accept(comment, args, ok, wrong, tolerance={key: absolute(bound, "1", REASONS[key]) for key, bound in tolerance.items()})


# Verifies: ORA-020, SEQ-001, SEQ-003, SEQ-004, SEQ-010.
def sequential_evidence():
    tolerance = {**case_by_case(REASONS, bound=0), **dict.fromkeys(("rank", "inclusion_at", "no_inclusion_at"), EXACT)}
    group, draws = Group("sequential_evidence", SOURCE, tolerance), Draws(74)
    by_hand(group)
    drawn(group, draws)
    special(group, draws)
    refuse(group)
    large(group)
    return group


def large(group):
    draws = Draws(248)
    templates, offset = [[draws.decimal(-0.4, 0.4, 1) for _ in range(140)] for _ in range(2)], [1] * 140
    add(group, "a long record", whole(140, draws, 2), templates, [offset], 0.05, 0.05, (64, 128))
    templates, offset = [whole(8, draws, 2) for _ in range(20)], [1] * 8
    add(group, "twenty templates", added(whole(8, draws, 6), templates[17]), templates, [offset], cuts=())


def by_hand(group):
    one = [1.0] * 4
    add(group, "by hand, no nuisances", [7.0, 1.0, 4.0], [[2.0, 3.0, 4.0], [0.0, -4.0, -3.0]], [])
    add(group, "by hand, the nuisance takes the first row", [7.0, 1.0, 4.0], [[2.0, 3.0, 4.0], [5.0, 0.0, 0.0]], [[1.0, 0.0, 0.0]])
    add(group, "by hand, an offset: θ begins with the second row", [104.0, 102.0, 103.0, 99.0], [[4.0, 0.0, 3.0, 0.0]], [one])
    for comment, residual in [("above", [2.0, 0.5, 1.5]), ("below", [-1.0, 0.5, -0.5])]:
        add(group, f"θ = ±1.5 and ±2.5 with rates of 0.2: first within, then {comment}", residual, [[1.0] * 3], [], 0.2, 0.2)
    add(group, "a record of nothing: θ = −γ²/2", [0.0] * 4, [[3.0, -2.0, 3.0, 1.0]], [one])


def drawn_templates(draws, count, number, size):
    return [sum(signal(count, draws, size), []) for _ in range(number)]


def drawn(group, draws):
    for number in range(24):
        count = draws.integer(4, 7)
        all_shapes = shapes(count, draws)
        name = list(all_shapes)[number % 4]
        nuisances, templates = all_shapes[name], drawn_templates(draws, count, draws.integer(1, 3), draws.decimal(1, 5))
        residual = record(draws, templates[0], nuisances, draws.integer(1, 40), number // 4 % 2)
        rates = [draws.choice([0.001, 0.01, 0.05, 0.2]) for _ in range(2)]
        add(group, f"drawn, {name}, {len(templates)} templates", residual, templates, nuisances, *rates)


def special(group, draws):
    nuisances, templates = shapes(6, draws)["offset, drift and gain"], drawn_templates(draws, 6, 2, 4)
    residual = record(draws, templates[1], nuisances, 20, 1)
    by_turns = lambda values: [values[i // 2 + (i % 2) * 6] for i in range(12)]
    for comment, args in [
        ("nuisances in reverse order", (residual, templates, nuisances[::-1])),
        ("nuisances each twice", (residual, templates, [*nuisances, *nuisances])),
        ("nuisances in other units", (residual, templates, [[v * 2.0**k for v in n] for n, k in zip(nuisances, (-90, 30, 0, 90, -7))])),
        ("a template that is a nuisance", (residual, [templates[0], nuisances[0]], nuisances)),
        ("a template twice", (residual, [templates[1], templates[1]], nuisances)),
        ("the channels by turns", (by_turns(residual), [*map(by_turns, templates)], [*map(by_turns, nuisances)])),
        ("nuisances of 10⁶ times the noise", (record(draws, templates[0], nuisances, 1e6, 1), templates, nuisances)),
    ]:
        add(group, comment, *args)
    add(group, "rates of 10⁻⁹ and 0.4", residual, templates, nuisances, 1e-9, 0.4)
    add(group, "rates of 0.3 and 10⁻¹²", residual, templates, nuisances, 0.3, 1e-12)


def refuse(group):
    args = {
        "residual": [1.0, 2.0, 0.5], "templates": [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]], "nuisances": [[1.0, 1.0, 1.0]],
        "max_false_alarm": 0.01, "max_miss": 0.05,
    }
    refuse_common(group, args, ["max_false_alarm", "max_miss"], ["residual", "templates", "nuisances"])
    for comment, changes, flag in [
        ("the residual is shorter", {"residual": [1.0, 2.0]}, "lengths_differ"),
        ("a template is longer", {"templates": [[0.0, 1.0, 0.0, 0.0]]}, "lengths_differ"),
        ("a nuisance is shorter", {"nuisances": [[1.0, 1.0]]}, "lengths_differ"),
        ("no rows", {"residual": [], "templates": [[]], "nuisances": []}, "empty"),
        ("no templates", {"templates": []}, "empty"),
        ("a rate of 0", {"max_false_alarm": 0}, "infinite_answer"),
        ("a rate of 1", {"max_miss": 1}, "infinite_answer"),
        ("a rate below 0", {"max_miss": -0.1}, "out_of_range"),
        ("rates that add up to 1", {"max_false_alarm": 0.5, "max_miss": 0.5}, "out_of_range"),
    ]:
        group.refuse(comment, args, flag, **changes)
    group.refuse("rates that are no test", args, "out_of_range", max_false_alarm=0.9, max_miss=0.6)


GROUPS = [sequential_evidence]

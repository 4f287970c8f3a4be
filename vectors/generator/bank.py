"""θ of each hypothesis of a bank, and their posterior (NUI-007, DET-021, DET-070): squares that least squares leave with
and without each template, at 250 digits.

Implements: VEC-011.
"""

from dataclasses import dataclass, replace

from mpmath import exp, expm1, fdot, fsum, log, lu_solve, matrix, mpf, workdps

from .numbers import Draws, real
from .nuisances import CUTS, U, Space, Statistic, errors, length, reals, record, shapes, sweep
from .series import added, noise, signal, whole
from .suite import Group, absolute, case_by_case, cut_answers, is_exact, refuse_common, relative, without

SOURCE = "least squares by normal equations, mpmath 1.3.0 at 250 digits"
DIGITS = 250
"""A γ of 10⁻¹⁵⁰ changes the squares in the 150th."""


def squares_left(columns, values):
    """The squares that least squares leave of a record."""
    if not columns:
        return fdot(values, values)
    gram = matrix([[fdot(a, b) for b in columns] for a in columns])
    amplitudes = lu_solve(gram, matrix([fdot(a, values) for a in columns]))
    left = [v - fdot(amplitudes, row) for v, row in zip(values, zip(*columns))]
    return fdot(left, left)


def theta_of(args, template, space):
    """ln of the ratio of the largest likelihoods with and without the template, or of their means over all levels of the noise."""
    z = reals(args["residual"])
    without = squares_left(space.kept, z)
    given = squares_left(space.kept, [a - b for a, b in zip(z, reals(template))])
    if args["level"] == "known":
        return (without - given) / 2
    return (len(z) - len(space.kept)) * log(without / given) / 2


def is_explained(template, space):
    size = length(reals(template))
    share = length(space.beside(reals(template))) / size if size else mpf(0)
    assert not 1e-13 < share < 1e-6, "no case is near to the limit of NUI-004"
    return share < 1e-9


@dataclass(frozen=True)
class Hypotheses:
    """θ of each, none where the nuisances explain it, and what is known before the record."""

    found: list
    prior: list
    prior_h1: mpf

    def theta(self):
        return [mpf(0) if theta is None else theta for theta in self.found]

    def may_be(self):
        return [k for k, theta in enumerate(self.found) if theta is not None and self.prior[k] > 0]

    def weights(self):
        return [prior * exp(theta) for prior, theta in zip(self.prior, self.theta())]

    def largest(self):
        return max(self.may_be(), key=lambda k: (self.found[k], -k))

    def posterior_h1(self, mixture):
        odds = self.prior_h1 / (1 - self.prior_h1) * exp(mixture)
        return odds / (1 + odds)

    def posterior(self):
        weights = self.weights()
        return [weight / fsum(weights) for weight in weights]

    def answer(self):
        mixture, largest = log(fsum(self.weights())), self.largest()
        return {
            "theta": self.theta(),
            "theta_mixture": mixture,
            "theta_max": self.found[largest],
            "hypothesis": largest,
            "posterior_h1": self.posterior_h1(mixture),
            "posterior": self.posterior(),
        }


def hypotheses(args, space):
    found = [None if is_explained(t, space) else theta_of(args, t, space) for t in args["templates"]]
    return Hypotheses(found, reals(args["prior"]), real(args["prior_h1"]))


REASONS = {
    "theta": "what T and γ of ACC-014 change, and ten roundings; the largest of the hypotheses",
    "theta_mixture": "as θ, and ten roundings",
    "theta_max": "as θ, of that hypothesis",
    "posterior_h1": "what the mixture and the prior's logarithm change",
    "posterior": "what two θ that are off as stated change, and a rounding for each of the sum and each unit of θ",
}


def small(value):
    """Whether the digits of a probability fade out near the least f64."""
    return mpf(10) ** -330 < value < mpf(10) ** -290


def tolerances(bounds, hypotheses, ok):
    """From a bound on the error of each θ."""
    theta, prior, largest = ok["theta"], hypotheses.prior, ok["hypothesis"]
    off = max(bound for bound, p in zip(bounds, prior) if p > 0)
    of_mixture = off + 10 * U * (1 + abs(ok["theta_mixture"]) + abs(max(t for t, p in zip(theta, prior) if p > 0)))
    # e^x/(1 + e^x) grows by (1 − p)(e^b − 1) of itself at most where x grows by b.
    log_odds = of_mixture + 10 * U * (1 + abs(log(hypotheses.prior_h1 / (1 - hypotheses.prior_h1))))
    of_h1 = (1 - ok["posterior_h1"]) * expm1(log_odds) + 4 * U
    seen = [k for k, share in enumerate(ok["posterior"]) if share > mpf(10) ** -330]
    depth = max(theta[k] for k in seen) - min(theta[k] for k in seen)
    of_share = expm1(2 * off) + (10 + len(theta) + depth) * U
    assert not any(map(small, [ok["posterior_h1"], *ok["posterior"]])), "digits would be lost near 0"
    return {
        "theta": absolute(max(bounds), "1", REASONS["theta"]),
        "theta_mixture": absolute(of_mixture, "1", REASONS["theta_mixture"]),
        "theta_max": absolute(bounds[largest], "1", REASONS["theta_max"]),
        "posterior_h1": relative(of_h1, REASONS["posterior_h1"]),
        "posterior": relative(of_share, REASONS["posterior"]),
    }


def of_projection(args, space):
    """T, γ and R of each template beside the nuisances, none of one that they explain."""
    one = [{**args, "template": template, "bias": 0, "eta": 0} for template in args["templates"]]
    return [None if is_explained(a["template"], space) else (a, Statistic.of(a, space)) for a in one]


def check(args, space, found):
    """A bound on each θ. By projection it is the same as by least squares, and no two are so near that rounding may tell which is
    larger, but of templates that are equal."""
    bounds, pairs = [], of_projection(args, space)
    for theta, pair in zip(found, pairs):
        if pair is None:
            bounds.append(mpf(0))
            continue
        test = pair[1].test(pair[0])
        assert abs(test.theta() - theta) < mpf(10) ** -20 * (abs(theta) + test.gamma), "two routes differ"
        off, _ = errors(pair[0], space, pair[1])
        bounds.append(test.theta_bound(off["t"], off["gamma"]))
    for k, one in enumerate(found):
        for m in range(k):
            alike = args["templates"][m] == args["templates"][k] or None in (one, found[m])
            assert alike or abs(one - found[m]) > 4 * (bounds[k] + bounds[m]), "too near"
    return bounds, pairs


def wrong_answers(args, pairs, right, ok):
    other = lambda **changes: replace(right, **changes).answer()
    with_mixture = lambda mixture: {"theta_mixture": mixture, "posterior_h1": right.posterior_h1(mixture)}
    by = lambda change: other(found=[None if pair is None else change(*pair) for pair in pairs])
    count, plain = len(pairs), Space([], len(args["residual"]))
    all_counted = lambda: max(range(count), key=lambda k: (ok["theta"][k], -k))
    wrong = [
        ("prior_ignored", {**other(prior=[mpf(1) / count] * count), **{k: ok[k] for k in ("theta_max", "hypothesis")}}),
        ("largest_for_mixture", with_mixture(ok["theta_max"])),
        ("logarithms_averaged", with_mixture(fdot(right.prior, ok["theta"]))),
        ("given_record_alone", {"posterior": [share * ok["posterior_h1"] for share in ok["posterior"]]}),
        ("prior_inverted", other(prior_h1=1 - right.prior_h1)),
        ("argmax_off_by_one", {"hypothesis": ok["hypothesis"] + 1}),
        ("posterior_for_theta", {"hypothesis": max(range(count), key=lambda k: (ok["posterior"][k], -k))}),
        ("impossible_counts", {"theta_max": max(ok["theta"]), "hypothesis": all_counted()}),
        ("last_of_equals", {"hypothesis": max(right.may_be(), key=lambda k: (right.found[k], k))}),
        ("nuisances_ignored", by(lambda a, _: theta_of(args, a["template"], plain))),
        ("nominal_for_gamma", by(lambda a, found: replace(found, gamma=found.gamma_nominal).test(a).theta())),
    ]
    if None in right.found:
        kept = [mpf(0) if theta is None else p for theta, p in zip(right.found, right.prior)]
        kept = other(prior=[p / fsum(kept) for p in kept])
        wrong.append(("explained_left_out", kept))
    if args["level"] == "known":
        wrong.append(("half_left_out", by(lambda _, found: found.gamma * (found.t - found.gamma))))
    else:
        wrong += [
            ("level_ignored", by(lambda a, found: found.test({**a, "level": "known"}).theta())),
            ("degrees_off_by_one", by(lambda a, found: replace(found, degrees=found.degrees + 1).test(a).theta())),
        ]
    return wrong


def add(group, comment, residual, templates, nuisances, prior, level="known", prior_h1=0.5, cuts=None):
    """With `cuts`, the wrong answers are those of the cut record alone."""
    args = {
        "residual": residual, "templates": templates, "nuisances": nuisances, "level": level, "prior": prior,
        "prior_h1": prior_h1,
    }
    space = Space(nuisances, len(residual))
    right = hypotheses(args, space)
    bounds, pairs = check(args, space, right.found)
    ok = right.answer()
    of_first = lambda first: hypotheses(first, Space(first["nuisances"], len(first["residual"]))).answer()
    wrong = wrong_answers(args, pairs, right, ok) if cuts is None else cut_answers(args, cuts, of_first)
    group.accept(comment, args, ok, wrong, tolerance=tolerances(bounds, right, ok))


def drawn_prior(draws, count, zeros=0):
    """Hundredths that add up to 1, some of them 0."""
    weights = [draws.integer(1, 9) for _ in range(count)]
    for k in range(zeros):
        weights[(3 * k + 1) % count] = 0
    shares = [100 * weight // sum(weights) for weight in weights]
    shares[weights.index(max(weights))] += 100 - sum(shares)
    return [share / 100 for share in shares]


def drawn_templates(draws, count, number, size):
    return [sum(signal(count, draws, round(size * (1 + k / 4), 6)), []) for k in range(number)]


# Verifies: ORA-020, NUI-007, DET-021, DET-070.
def bank_posterior():
    keys = [*REASONS, "hypothesis"]
    tolerance = case_by_case(keys, bound=0)
    group = Group("bank_posterior", SOURCE, {**tolerance, "hypothesis": is_exact("a whole number")})
    with workdps(DIGITS):
        by_hand(group)
        drawn(group)
        special(group)
    refuse(group)
    with workdps(DIGITS):
        large(group)
    return group


def large(group):
    draws = Draws(106)
    add(group, "a sweep's record, unknown level", *sweep(draws, 3), [0.2, 0.3, 0.5], "unknown", 0.25, CUTS)
    templates, nuisances = [whole(42, draws, 1) for _ in range(50)], [[1] * 42]
    residual = [round(v, 5) for v in added(noise(42, draws, 1), templates[40], [5] * 42)]
    add(group, "fifty hypotheses", residual, templates, nuisances, [0.02] * 50, "known", 0.25, ())


def by_hand(group):
    given, one, two = [4.0, 2.0, 3.0, 3.5], [1.0, -1.0, 1.0, -1.0], [1.0, 1.0, -1.0, -1.0]
    offset, half = [1.0] * 4, [0.5, 0.5]
    for level in ("known", "unknown"):
        add(group, f"by hand, {level} level, one hypothesis", given, [one], [], [1.0], level)
        add(group, f"by hand, {level} level, two, no nuisances", given, [one, two], [], half, level)
        add(group, f"by hand, {level} level, two, an offset", given, [one, two], [offset], [0.25, 0.75], level, 0.25)
        add(group, f"by hand, {level} level, one degree of freedom", given, [one, two], [offset, [0.0, 1.0, 2.0, 3.0]], half, level)
        add(group, f"{level} level, equal templates: the first counts", given, [two, one, one], [offset], [0.2, 0.3, 0.5], level)
        add(group, f"{level} level, eight equal templates", given, [one] * 8, [], [0.125] * 8, level, 0.1)
        add(group, f"{level} level, the template of the largest θ cannot be", given, [two, one], [], [1.0, 0.0], level)
        add(group, f"{level} level, one that the nuisances explain", given, [one, offset, two], [offset], [0.5, 0.3, 0.2], level)
        add(group, f"{level} level, one that is nothing", given, [[0.0] * 4, two], [offset], [0.6, 0.4], level, 0.01)
        add(group, f"{level} level, θ = 0 of what is explained is above all others", given, [two, offset], [offset], half, level)
        add(group, f"{level} level, one that is explained cannot be", given, [offset, one, two], [offset], [0.0, 0.5, 0.5], level)
        add(group, f"{level} level, a prior that is 7·10⁻¹⁰ short counts as it stands", given, [one, two], [], [0.5, 0.4999999993], level)
    add(group, "a record of nothing: θ = −γ²/2", [0.0] * 4, [one, [2 * v for v in two]], [offset], half)
    add(group, "the record is a template on an offset", [1e3 + v for v in one], [one, two], [offset], half)
    add(group, "the record is a template turned round", [-v for v in one], [one, two], [], half, "known", 0.9)


def drawn(group):
    draws = Draws(80)
    for number in range(30):
        count, level = draws.integer(5, 9), ("known", "unknown")[number % 2]
        all_shapes = shapes(count, draws)
        name, hypotheses = draws.choice(list(all_shapes)), draws.integer(1, 8)
        nuisances, present = all_shapes[name], number // 2 % 2
        templates = drawn_templates(draws, count, hypotheses, draws.decimal(0.4, 3))
        residual = record(draws, draws.choice(templates), nuisances, draws.integer(1, 50), present)
        prior = drawn_prior(draws, hypotheses, number % 3 if hypotheses > 3 else 0)
        prior_h1 = draws.decimal(0.05, 0.95, 2)
        add(group, f"drawn, {level} level, {name}, {hypotheses} hypotheses", residual, templates, nuisances, prior, level, prior_h1)


def special(group):
    draws = Draws(81)
    for size, kind in [(1e4, "γ of 10⁴"), (1e-6, "γ of 10⁻⁶"), (1e-150, "γ of 10⁻¹⁵⁰"), (60.0, "γ of some 100")]:
        # Where the level is unknown, ten roundings are more than so small a θ.
        for level in ("known", "unknown") if size > 1e-100 else ("known",):
            nuisances = shapes(7, draws)["offset and drift"]
            templates = [[v * size for v in t] for t in drawn_templates(draws, 7, 4, 1)]
            residual = record(draws, templates[2], nuisances, 20, 1)
            add(group, f"{level} level, {kind}", residual, templates, nuisances, [0.1, 0.2, 0.3, 0.4], level, 0.3)
    templates = drawn_templates(draws, 7, 3, 2)
    nuisances = shapes(7, draws)["offset, drift and gain"]
    residual = record(draws, templates[0], nuisances, 30, 1)
    third = [0.2, 0.3, 0.5]
    for prior, prior_h1, kind in [
        ([1e-200, 0.0, 1.0], 0.5, "a prior of 10⁻²⁰⁰"),
        ([1e-12, 0.999999999999, 0.0], 0.5, "a prior of 10⁻¹²"),
        ([0.0, 1.0, 0.0], 0.5, "one alone can be"),
        (third, 1e-12, "an inclusion that is improbable"),
        (third, 1e-200, "an inclusion that is all but impossible"),
        (third, 0.999999999999, "an inclusion that is all but certain"),
    ]:
        for level in ("known", "unknown"):
            add(group, f"{level} level, {kind}", residual, templates, nuisances, prior, level, prior_h1)
    first, second, line, *_ = nuisances
    sums = [0.1 * a + 0.7 * b - 1.3 * c for a, b, c in zip(first, second, line)]
    for kind, signals in [
        ("in reverse order", nuisances[::-1]),
        ("in other units", [[v * scale for v in s] for s, scale in zip(nuisances, (2.0**-900, 1e-9, 1e12, 2.0**900, 3e5))]),
        ("each twice", [*nuisances, *nuisances]),
        ("with a sum of three, to rounding", [first, second, line, sums]),
        ("more than samples", [[a + k * b for a, b in zip(first, line)] for k in range(20)]),
        ("nearly dependent: 10⁻⁵ is left", [first, [round(a + 1e-5 * b, 9) for a, b in zip(first, line)]]),
        ("one that is nearly a template", [first, [round(a + 0.02 * b, 6) for a, b in zip(templates[1], line)]]),
        ("one that is a template", [first, templates[1]]),
    ]:
        for level in ("known", "unknown"):
            add(group, f"nuisances {kind}, {level} level", residual, templates, signals, third, level, 0.4)
    for count, name, amplitude, kind in [
        (60, "offset, drift and gain", 20, "a long record"),
        (7, "offset", 1e6, "nuisances of 10⁶ times the noise"),
        (7, "offset, drift and gain", 1e6, "several nuisances of 10⁶ times the noise"),
    ]:
        for level in ("known", "unknown"):
            nuisances, templates = shapes(count, draws)[name], drawn_templates(draws, count, 5, 1)
            residual = record(draws, templates[3], nuisances, amplitude, 1)
            add(group, f"{level} level, {kind}", residual, templates, nuisances, [0.2] * 5, level, 0.5)


def refuse(group):
    offset, up, line = [1.0, 1.0, 1.0], [0.0, 1.0, 0.0], [0.0, 1.0, 2.0]
    args = {
        "residual": [1.0, 2.0, 0.5], "templates": [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]], "nuisances": [offset],
        "level": "known", "prior": [0.25, 0.75], "prior_h1": 0.5,
    }
    refuse_common(group, args, ["prior_h1"], ["residual", "templates", "nuisances", "prior"])
    group.refuse("level is missing", without(args, "level"), "missing_argument")
    for comment, changes, flag in [
        ("the residual is shorter", {"residual": [1.0, 2.0]}, "lengths_differ"),
        ("the residual is longer", {"residual": [1.0, 2.0, 0.5, 0.0]}, "lengths_differ"),
        ("a template is shorter", {"templates": [up, [1.0, 0.0]]}, "lengths_differ"),
        ("a template is longer", {"templates": [up, [1.0, 0.0, 0.0, 0.0]]}, "lengths_differ"),
        ("a template is empty", {"templates": [up, []]}, "lengths_differ"),
        ("a template that is no list", {"templates": [up, 1.0]}, "wrong_type"),
        ("a template without a prior", {"templates": [up, line, offset]}, "lengths_differ"),
        ("a prior without a template", {"templates": [up]}, "lengths_differ"),
        ("a nuisance is shorter", {"nuisances": [[1.0, 1.0]]}, "lengths_differ"),
        ("a nuisance is longer", {"nuisances": [[1.0, 1.0, 1.0, 1.0]]}, "lengths_differ"),
        ("no hypotheses", {"templates": [], "prior": []}, "empty"),
        ("no samples", {"residual": [], "templates": [[], []], "nuisances": []}, "empty"),
        ("level is a truth value", {"level": True}, "wrong_type"),
        ("level is another word", {"level": "estimated"}, "out_of_range"),
        ("a prior below 0", {"prior": [-0.25, 1.25]}, "prior_unchecked"),
        ("priors add up to more than 1", {"prior": [0.5, 0.75]}, "prior_unchecked"),
        ("priors add up to 1 − 10⁻⁸", {"prior": [0.5, 0.49999999]}, "prior_unchecked"),
        ("no hypothesis can be", {"prior": [0.0, 0.0]}, "prior_unchecked"),
        ("prior_h1 is 0", {"prior_h1": 0.0}, "out_of_range"),
        ("prior_h1 is 1", {"prior_h1": 1.0}, "out_of_range"),
        ("prior_h1 is below 0", {"prior_h1": -0.5}, "out_of_range"),
        ("no signal", {"templates": [[0.0] * 3, [0.0] * 3]}, "zero_gamma"),
        ("no signal and no nuisances", {"templates": [[0.0] * 3, [0.0] * 3], "nuisances": []}, "zero_gamma"),
        ("every template is explained", {"templates": [[2.0] * 3, [-3.0] * 3]}, "template_explained"),
        ("the same, to rounding", {"templates": [[0.1, 0.1, 0.3 - 0.2], offset]}, "template_explained"),
        ("every template that can be is explained", {"templates": [offset, up], "prior": [1.0, 0.0]}, "template_explained"),
        ("no sample for the noise", {"nuisances": [offset, line]}, "no_degrees"),
        ("the same, unknown level", {"nuisances": [offset, line], "level": "unknown"}, "no_degrees"),
        ("one sample alone", {"residual": [1.0], "templates": [[1.0], [2.0]], "nuisances": []}, "no_degrees"),
        ("a record of nothing, unknown level", {"residual": [0.0] * 3, "level": "unknown"}, "no_noise"),
    ]:
        group.refuse(comment, args, flag, **changes)
    huge = {"residual": [0.0, 1e160, 0.0], "templates": [[0.0, 1e150, 0.0], up]}
    for comment, changes in [("γ", {"templates": [up, [1e200, 0.0, 0.0]]}), ("θ", huge)]:
        group.refuse(f"{comment} beyond the largest number", args, "infinite_answer", error="overflow", **changes)
    for token in ("NaN", "1e999"):
        text = (
            f'{{"residual":[1,2,0.5],"templates":[[0,1,0],[1,{token},0]],"nuisances":[],"level":"known","prior":[0.5,0.5],'
            '"prior_h1":0.5}'
        )
        group.refuse_line(f"a template holds {token}", text)


GROUPS = [bank_posterior]

"""T, θ and rates beside nuisances (NUI-001 … 014): Gram–Schmidt at 50 digits."""

from dataclasses import dataclass, replace

from mpmath import exp, fdot, isinf, log, matrix, mpf, sqrt

from .filters import SWEEP
from .normal import cdf
from .numbers import UNIT, Draws, real
from .quadratic import limits, student
from .series import added, bump, noise, signal, whole
from .suite import Group, absolute, case_by_case, cut_answers, is_exact, refuse_common, without

SOURCE = "Gram–Schmidt, mpmath 1.3.0 at 50 digits; tails of t as in student_tail"
U = real(UNIT)
DIGITS = 80
"""Of the tails, of which none here is below 10⁻³⁰."""


def reals(values):
    return [real(value) for value in values]


def length(v):
    return sqrt(fdot(v, v))


class Space:
    """What signals span: an orthonormal basis, and e of ACC-014, a relative bound on the error of a projection."""

    def __init__(self, signals, samples):
        self.basis, self.kept = [], []
        for whole in map(reals, signals):
            size = length(whole)
            rest = self.beside(whole)
            share = length(rest) / size if size else mpf(0)
            assert not 1e-13 < share < 1e-6, "no case is near to the limit of NUI-001"
            if share >= 1e-9:
                self.basis.append([value / (share * size) for value in rest])
                self.kept.append([value / size for value in whole])
        kept, rank = self.kept, len(self.kept)
        inverse = matrix([[fdot(a, b) for b in kept] for a in kept]) ** -1 if kept else None
        condition = sqrt(sum(inverse[k, k] for k in range(rank))) if kept else 0
        self.error = 2 * (rank + 1) * (samples + 4) * (1 + condition) * U

    def beside(self, v):
        for direction in self.basis:
            along = fdot(direction, v)
            v = [value - along * part for value, part in zip(v, direction)]
        return v


@dataclass(frozen=True)
class Statistic:
    """Of a record, in the unit of its known noise."""

    t: mpf
    gamma: mpf
    gamma_nominal: mpf
    residual: mpf
    rank: int
    degrees: int

    @staticmethod
    def of(args, space):
        z, template = space.beside(reals(args["residual"])), space.beside(reals(args["template"]))
        gamma = length(template)
        t = fdot(template, z) / gamma
        left = [a - t * b / gamma for a, b in zip(z, template)]
        rank = len(space.basis)
        return Statistic(t, gamma, length(reals(args["template"])), fdot(left, left), rank, len(z) - rank - 1)

    def test(self, args):
        bias = real(args["bias"])
        if args["level"] == "known":
            return Test(self.t, self.gamma, bias, None)
        scale = sqrt(self.residual / self.degrees)
        return Test(self.t / scale, self.gamma / scale, bias / scale, self.degrees)

    def answer(self, args):
        own = {key: getattr(self, key) for key in ("gamma_nominal", "residual", "rank", "degrees")}
        return {**self.test(args).answer(args["eta"]), **own}


@dataclass(frozen=True)
class Test:
    """T with its law: Student's with ν degrees of freedom, or the normal one if ν is None."""

    t: mpf
    gamma: mpf
    bias: mpf
    nu: int | None

    def theta(self):
        t, g, nu = self.t, self.gamma, self.nu
        return g * (t - g / 2) if nu is None else (nu + 1) * log((nu + t * t) / (nu + (t - g) ** 2)) / 2

    def threshold(self, eta):
        """The root of ν + T² = c (ν + (T − γ)²) that is nearest to γ/2; without one ∞ if θ is below η for every T, else −∞."""
        g, nu = self.gamma, self.nu
        if nu is None:
            return real(eta) / g + g / 2
        c = exp(2 * real(eta) / (nu + 1))
        square = c * g * g - nu * (c - 1) ** 2
        if square < 0:
            return mpf("inf" if eta > 0 else "-inf")
        roots = [(c * g + sign * sqrt(square)) / (c - 1) for sign in (1, -1)] if eta else [g / 2]
        return min(roots, key=lambda root: abs(root - g / 2))

    def above(self, x):
        """Pr(T − hγ ≥ x) and Pr(T − hγ < x)."""
        return (cdf(-x), cdf(x)) if self.nu is None else student(x, self.nu, 0, DIGITS)[::-1]

    def rates(self, eta):
        tau = self.threshold(eta)
        if isinf(tau):
            return {"false_alarm": mpf(tau < 0), "miss": mpf(tau > 0)}
        return {"false_alarm": self.above(tau - self.bias)[0], "miss": self.above(self.gamma - self.bias - tau)[0]}

    def noncentral_rates(self, eta):
        """Where T is not taken for less its centre."""
        tau = self.threshold(eta)
        if isinf(tau):
            return self.rates(eta)
        law = lambda centre: student(tau, self.nu, centre, DIGITS)
        return {"false_alarm": law(self.bias)[1], "miss": law(self.gamma - self.bias)[0]}

    def answer(self, eta):
        return {"t": self.t, "gamma": self.gamma, "theta": self.theta(), **self.rates(eta)}

    def slopes(self, t):
        """∂θ/∂T and ∂θ/∂γ."""
        g, nu = self.gamma, self.nu
        if nu is None:
            return g, t - g
        by_gamma = (nu + 1) * (t - g) / (nu + (t - g) ** 2)
        return (nu + 1) * t / (nu + t * t) - by_gamma, by_gamma

    def theta_bound(self, t_bound, gamma_bound):
        """For T and γ that are off by so much, and ten roundings."""
        (by_t, by_gamma), t, g, nu = self.slopes(self.t), abs(self.t), self.gamma, self.nu
        rounded = g * (t + g) if nu is None else (nu + 1) * (1 + g * (2 * t + g) / (nu + t * t))
        return abs(by_t) * t_bound + abs(by_gamma) * gamma_bound + 10 * U * (rounded + abs(self.theta()))

    def rate_bounds(self, eta, gamma_bound, bias_bound):
        """For γ and the bias that are off by so much, ten roundings in the threshold, and tails as the laws are."""
        tau = self.threshold(eta)
        if isinf(tau):
            return {"false_alarm": 0, "miss": 0}
        by_t, by_gamma = self.slopes(tau)
        rounded = abs(eta) + self.gamma**2 if self.nu is None else self.nu + 1
        tau_bound = (abs(by_gamma) * gamma_bound + 10 * U * rounded) / by_t + 10 * U * (abs(tau) + self.gamma)

        def bound(x, x_bound):
            right = self.above(x)
            law = 8 * U * right[0]
            if self.nu is not None:
                law = limits(right[::-1], self.nu)["upper"]
                law = real(law["relative"]) * right[0] if "relative" in law else real(law["absolute"])
            return max(abs(self.above(x + way * x_bound)[0] - right[0]) for way in (1, -1)) + law

        return {
            "false_alarm": bound(tau - self.bias, tau_bound + bias_bound),
            "miss": bound(self.gamma - self.bias - tau, tau_bound + bias_bound + gamma_bound),
        }


EXACT = is_exact("a whole number")
REASONS = {
    "t": "ACC-014, and where the level is unknown that of σ̂",
    "gamma": "ACC-014, and where the level is unknown that of σ̂",
    "gamma_nominal": "(n + 4) 2⁻⁵³ |δ|: a plain sum of squares",
    "residual": "ACC-014",
    "theta": "what T and γ change, and ten roundings",
    "false_alarm": "what the threshold, the bias and γ change, and DET-134, or 8·2⁻⁵³ of the normal law",
    "miss": "as false_alarm",
}


def errors(args, space, found):
    """ACC-014: of T, γ and the bias, in the unit of the test, and of R."""
    test, count, z, nominal = found.test(args), len(args["residual"]), length(reals(args["residual"])), found.gamma_nominal
    e = space.error
    residual = 2 * e * z * sqrt(found.residual) + (e * z) ** 2 + (count + 4) * U * found.residual
    off = {"t": e * nominal * z / found.gamma, "gamma": e * nominal, "bias": 0}
    if test.nu is not None:
        # σ̂ is off by half of the share of R; all of it is more than the second order adds.
        scale, share = found.gamma / test.gamma, residual / found.residual + 4 * U
        assert share < 0.1
        off = {key: bound / scale + share * abs(getattr(test, key)) for key, bound in off.items()}
    return off, residual


def tolerances(args, space, found):
    """ACC-014, and what follows from it."""
    test, count, nominal = found.test(args), len(args["residual"]), found.gamma_nominal
    off, residual = errors(args, space, found)
    bounds = {
        "t": off["t"],
        "gamma": off["gamma"],
        "gamma_nominal": (count + 4) * U * nominal,
        "residual": residual,
        "theta": test.theta_bound(off["t"], off["gamma"]),
        **test.rate_bounds(args["eta"], off["gamma"], off["bias"]),
    }
    return {key: absolute(bound, "1", REASONS[key]) for key, bound in bounds.items()}


def add(group, comment, residual, template, nuisances, level="known", bias=0, eta=0, cuts=()):
    args = {
        "residual": residual, "template": template, "nuisances": nuisances, "level": level, "bias": bias, "eta": eta
    }
    space = Space(nuisances, len(residual))
    found, plain = Statistic.of(args, space), Statistic.of(args, Space([], len(residual)))
    test, ok = found.test(args), found.answer(args)
    but = lambda **changed: replace(found, **changed).answer(args)
    wrong = [
        ("nominal_for_gamma", but(gamma=found.gamma_nominal)),
        ("nuisances_ignored", plain.answer(args)),
        ("residual_of_record", but(residual=plain.residual + plain.t**2 - found.t**2)),
        ("template_in_residual", but(residual=found.residual + found.t**2)),
        ("degrees_off_by_one", but(degrees=found.degrees + 1)),
        ("bias_ignored", replace(test, bias=mpf(0)).rates(eta)),
        ("rates_swapped", {"false_alarm": ok["miss"], "miss": ok["false_alarm"]}),
    ]
    unused = len(nuisances) - found.rank
    if 0 < unused < found.degrees:
        wrong.append(("number_for_rank", but(rank=len(nuisances), degrees=found.degrees - unused)))
    if level == "known":
        wrong.append(("half_left_out", {"theta": found.gamma * (found.t - found.gamma)}))
    else:
        wrong += [
            ("level_ignored", found.answer({**args, "level": "known"})),
            ("normal_for_student", replace(test, nu=None).answer(eta)),
            ("noncentral_for_central", test.noncentral_rates(eta)),
        ]
    of_first = lambda first: Statistic.of(first, Space(first["nuisances"], len(first["residual"]))).answer(first)
    wrong += cut_answers(args, cuts, of_first)
    group.accept(comment, args, ok, wrong, tolerance=tolerances(args, space, found))


def sweep(draws, number):
    """Templates and nuisances of a usual record (VEC-019), an offset of each channel and a gain, and a record with the last
    template, in noise of some 5."""
    count = 2 * SWEEP
    none, one = [0] * SWEEP, [1] * SWEEP
    nuisances = [one + none, none + one, whole(count, draws, 9)]
    templates = [whole(count, draws, 1) for _ in range(number)]
    return added(whole(count, draws, 9), nuisances[2], templates[-1]), templates, nuisances


CUTS = (128, 256, 401, 512)


def shapes(count, draws):
    """Offset and drift of each channel, and the gain of the forces: what a sweep may have."""
    none, one = [0.0] * count, [1.0] * count
    line = [round(i / max(count - 1, 1) - 0.5, 4) for i in range(count)]
    lateral = [round(draws.decimal(-0.4, 0.4) + 0.8 * v, 4) for v in line]
    normal = [round(14 - 3 * bump(4 * v) + draws.decimal(-0.1, 0.1), 4) for v in line]
    offset, drift = [one + none, none + one], [line + none, none + line]
    return {"none": [], "offset": offset, "offset and drift": offset + drift, "offset, drift and gain": offset + drift + [
        lateral + normal
    ]}


def record(draws, template, nuisances, amplitude, present):
    z = noise(len(template), draws, 1)
    for nuisance in nuisances:
        size = draws.choice([-1, 1]) * amplitude / max(map(abs, nuisance))
        z = [a + size * b for a, b in zip(z, nuisance)]
    return [round(a + present * b, 5) for a, b in zip(z, template)]


# Verifies: ORA-020, NUI-001, NUI-003, NUI-007, NUI-008, NUI-014, NUI-012.
def theta_nuisances():
    tolerance = {**case_by_case(REASONS, bound=0), "rank": EXACT, "degrees": EXACT}
    group, draws = Group("theta_nuisances", SOURCE, tolerance), Draws(70)
    by_hand(group)
    of_sizes(group, draws)
    of_several(group, draws)
    drawn(group, draws)
    refuse(group)
    residual, [template], nuisances = sweep(Draws(105), 1)
    add(group, "a sweep's record, unknown level", residual, template, nuisances, "unknown", 1, 0.5, CUTS)
    return group


def by_hand(group):
    one, line = [1.0] * 4, [0.0, 1.0, 2.0, 3.0]
    four = ([4.0, 2.0, 3.0, 3.5], [1.0, -1.0, 1.0, -1.0])
    for level in ("known", "unknown"):
        add(group, f"by hand, {level} level, no nuisances", *four, [], level)
        add(group, f"by hand, {level} level, an offset", *four, [one], level)
        add(group, f"by hand, {level} level, one degree of freedom left", *four, [one, line], level)
    add(group, "a record of nothing: θ = −γ²/2", [0.0] * 4, four[1], [one])
    add(group, "the record is the template on an offset: θ = γ²/2", [1e3 + v for v in four[1]], four[1], [one])


def of_sizes(group, draws):
    for count, name, amplitude, kind in [
        (7, "none", 0, ""),
        (7, "offset", 20, ""),
        (7, "offset and drift", 20, ""),
        (7, "offset, drift and gain", 20, ""),
        (60, "offset, drift and gain", 20, ", a long record"),
        (7, "offset", 1e6, ", 10⁶ times the noise"),
        (7, "offset, drift and gain", 1e3, ", 10³ times the noise"),
        (7, "offset, drift and gain", 1e6, ", 10⁶ times the noise"),
    ]:
        for level in ("known", "unknown"):
            nuisances, template = shapes(count, draws)[name], sum(signal(count, draws, draws.decimal(1, 4)), [])
            present = draws.integer(0, 1)
            residual = record(draws, template, nuisances, amplitude, present)
            add(group, f"2 × {count} samples, {level} level, {name}{kind}", residual, template, nuisances, level)


def of_several(group, draws):
    several = shapes(7, draws)["offset, drift and gain"]
    template = sum(signal(7, draws, 3), [])
    residual = record(draws, template, several, 30, 1)
    first, second, third, *_ = several
    sums = [0.1 * a + 0.7 * b - 1.3 * c for a, b, c in zip(first, second, third)]
    for kind, nuisances in [
        ("in reverse order", several[::-1]),
        ("in other units", [[v * scale for v in s] for s, scale in zip(several, (2.0**-900, 1e-9, 1e12, 2.0**900, 3e5))]),
        ("each twice", [*several, *several]),
        ("with one that is nothing", [several[0], [0.0] * 14, *several[1:]]),
        ("with a sum of three, to rounding", [*several[:3], sums, *several[3:]]),
        ("more than samples", [[a + k * b for a, b in zip(first, third)] for k in range(20)]),
        ("nearly dependent: 10⁻³ is left", [first, [round(a + 1e-3 * b, 9) for a, b in zip(first, third)]]),
        ("nearly dependent: 10⁻⁵ is left", [first, [round(a + 1e-5 * b, 9) for a, b in zip(first, third)]]),
        ("one that is nearly the template", [first, [round(a + 0.02 * b, 6) for a, b in zip(template, third)]]),
    ]:
        for level in ("known", "unknown"):
            add(group, f"nuisances {kind}, {level} level", residual, template, nuisances, level)
    pairs = {
        "known": [(0.4, 0), (9, 1), (0, 12.5), (0.1, -30)],
        "unknown": [(0.4, 0), (9, 1), (0, 3.5), (0.1, -3.5), (0.1, 40), (0.1, -40)],
    }
    for level, bias, eta in [(level, *pair) for level in pairs for pair in pairs[level]]:
        kind = {40: ": no T is enough", -40: ": any T is enough"}.get(eta, "")
        add(group, f"{level} level, bias {bias}, η = {eta}{kind}", residual, template, several, level, bias, eta)


def drawn(group, draws):
    for number in range(36):
        count, level = draws.integer(4, 9), ("known", "unknown")[number % 2]
        all_shapes = shapes(count, draws)
        name = draws.choice(list(all_shapes)) if count > 4 else "offset"
        nuisances = all_shapes[name]
        template = sum(signal(count, draws, draws.decimal(0.4, 4)), [])
        residual = record(draws, template, nuisances, draws.integer(1, 50), number // 2 % 2)
        bias = draws.choice([0, 0, draws.decimal(0.01, 0.9, 2)])
        eta = draws.decimal(-1 if level == "known" else -0.2, 1, 2)
        add(group, f"drawn, {level} level, {name}", residual, template, nuisances, level, bias, eta)


def refuse(group):
    args = {
        "residual": [1.0, 2.0, 0.5], "template": [0.0, 1.0, 0.0], "nuisances": [[1.0, 1.0, 1.0]], "level": "known",
        "bias": 0.1, "eta": 0.5,
    }
    refuse_common(group, args, ["bias", "eta"], ["residual", "template", "nuisances"])
    group.refuse("level is missing", without(args, "level"), "missing_argument")
    for comment, changes, flag in [
        ("the residual is shorter", {"residual": [1.0, 2.0]}, "lengths_differ"),
        ("the template is longer", {"template": [0.0, 1.0, 0.0, 0.0]}, "lengths_differ"),
        ("a nuisance is shorter", {"nuisances": [[1.0, 1.0]]}, "lengths_differ"),
        ("a nuisance is longer", {"nuisances": [[1.0, 1.0, 1.0, 1.0]]}, "lengths_differ"),
        ("one of two is empty", {"nuisances": [[1.0, 1.0, 1.0], []]}, "lengths_differ"),
        ("a nuisance that is no list", {"nuisances": [1.0, 1.0, 1.0]}, "wrong_type"),
        ("no samples", {"residual": [], "template": [], "nuisances": []}, "empty"),
        ("level is a truth value", {"level": True}, "wrong_type"),
        ("level is another word", {"level": "estimated"}, "out_of_range"),
        ("bias below 0", {"bias": -0.1}, "out_of_range"),
        ("no signal", {"template": [0.0, 0.0, 0.0]}, "zero_gamma"),
        ("no signal and no nuisances", {"template": [0.0, 0.0, 0.0], "nuisances": []}, "zero_gamma"),
        ("the template is a nuisance", {"template": [2.0, 2.0, 2.0]}, "template_explained"),
        ("the same, to rounding", {"template": [0.1, 0.1, 0.3 - 0.2]}, "template_explained"),
        ("one sample alone", {"residual": [1.0], "template": [1.0], "nuisances": []}, "no_degrees"),
        ("no sample for the noise", {"nuisances": [[1.0, 1.0, 1.0], [0.0, 1.0, 2.0]]}, "no_degrees"),
        ("the same, unknown level", {"nuisances": [[1.0, 1.0, 1.0], [0.0, 1.0, 2.0]], "level": "unknown"}, "no_degrees"),
        ("a record of nothing, unknown level", {"residual": [0.0, 0.0, 0.0], "level": "unknown"}, "no_noise"),
    ]:
        group.refuse(comment, args, flag, **changes)
    for token in ("NaN", "1e999"):
        text = f'{{"residual":[1,2,0.5],"template":[0,1,0],"nuisances":[[1,1,{token}]],"level":"known","bias":0,"eta":0}}'
        group.refuse_line(f"a nuisance holds {token}", text)


GROUPS = [theta_nuisances]

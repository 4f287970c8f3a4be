"""A group of cases and how it is written."""

import json
from decimal import Decimal
from fractions import Fraction

from mpmath import mpf

from .flags import BUGS
from .numbers import UNIT, bits, exact, nearest, round_up, ulp

VERSION = "1.0.0"


def in_ulp(count, reason):
    return {"ulp": count, "reason": reason}


def absolute(bound, unit, reason):
    return {"absolute": round_up(bound), "unit": unit, "reason": reason}


def relative(bound, reason):
    return {"relative": round_up(bound), "reason": reason}


def is_exact(reason):
    return {"exact": True, "reason": reason}


def settle(value):
    """An expected value as it is written: text, truth and whole numbers stay, real numbers become the nearest f64."""
    if isinstance(value, dict):
        return {key: settle(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [settle(item) for item in value]
    if isinstance(value, (mpf, Fraction, Decimal)):
        # A zero has no sign in an exact number.
        return nearest(value)
    return value


def bits_of(value):
    """The bits of each real number in a value, in the same shape; None if it has none."""
    if isinstance(value, list):
        return [bits_of(item) for item in value]
    return bits(value) if isinstance(value, float) else None


def leaves(value):
    if isinstance(value, list):
        for item in value:
            yield from leaves(item)
    else:
        yield value


def allowed(tolerance, expected):
    """The largest |answer − expected| that passes, as a fraction."""
    if "ulp" in tolerance:
        return Fraction(tolerance["ulp"]) * ulp(expected)
    if "absolute" in tolerance:
        return exact(tolerance["absolute"])
    if "relative" in tolerance:
        return exact(tolerance["relative"]) * abs(exact(expected))
    return Fraction(0)


def differs(answer, expected, tolerance):
    """Whether some number of an answer is farther from the expected one than ten times its tolerance."""
    for key, right in expected.items():
        got, wanted = list(leaves(answer[key])), list(leaves(right))
        if len(got) != len(wanted):
            return True
        for g, w in zip(got, wanted):
            if isinstance(w, float):
                if abs(exact(g) - exact(w)) > 10 * allowed(tolerance[key], w):
                    return True
            elif g != w:
                return True
    return False


class Group:
    """The cases of one op. `tolerance` maps each key of the answer to how far it may be off, and why."""

    def __init__(self, name, source, tolerance, op=None):
        self.name, self.source, self.tolerance, self.cases = name, source, tolerance, []
        self.op = name if op is None else op

    def next_id(self):
        return f"{self.name}-{len(self.cases) + 1:03}"

    def _add(self, case):
        self.cases.append({"id": self.next_id(), **case})

    def accept(self, comment, args, ok, wrong=(), flags=(), tolerance=None):
        """A case with an answer. `wrong` are pairs of a flag and the answer of that bug; those that the bug leaves right,
        or not finite, are left out: on this case the bug does not show."""
        ok = settle(ok)
        case = {"comment": comment, "args": args, "ok": ok}
        reals = {key: bits_of(value) for key, value in ok.items()}
        reals = {key: b for key, b in reals.items() if any(leaf is not None for leaf in leaves(b))}
        if reals:
            case["bits"] = reals
        if tolerance:
            case["tolerance"] = tolerance
        limits = {**self.tolerance, **(tolerance or {})}
        shown = []
        for flag, answer in wrong:
            try:
                answer = settle(answer)
            except OverflowError:
                continue
            if differs({**ok, **answer}, ok, limits):
                shown.append({"flag": flag, "ok": {**ok, **answer}})
        case["flags"] = list(dict.fromkeys([*flags, *(item["flag"] for item in shown)]))
        if shown:
            case["wrong"] = shown
        self._add(case)

    def refuse(self, comment, args, flag, error=None, **changes):
        """A case that must be refused: `args` with `changes`. Without `error`, the code is that of the flag."""
        error = error or ("bad_argument" if flag in BAD_ARGUMENT else "out_of_range")
        self._add({"comment": comment, "args": {**args, **changes}, "error": error, "flags": [flag]})

    def refuse_line(self, comment, args_text):
        """A case that must be refused, whose arguments Python's JSON cannot write: NaN, which is no JSON, or 1e999, which is
        a number of JSON but none of f64."""
        error = "bad_json" if "NaN" in args_text or "Infinity" in args_text else "bad_argument"
        line = f'{{"id":"ID","op":"{self.op}","args":{args_text}}}'
        self.raw(comment, line, error, "not_finite")

    def raw(self, comment, line, error, flag, lenient=None):
        """A whole line that must be refused; `ID` in it stands for the case's id. `lenient` is the answer to what it means."""
        line, meant = line.replace("ID", self.next_id()), {"lenient": settle(lenient)} if lenient else {}
        self._add({"comment": comment, "line": line, "error": error, **meant, "flags": [flag]})

    def text(self):
        """The file: a case a line, so that a change of one case is a change of one line."""
        used = sorted({flag for case in self.cases for flag in case["flags"]})
        head = {
            "schema": "palpate-vectors",
            "schema_version": 1,
            "group": self.name,
            "op": self.op,
            "source": self.source,
            "generator_version": VERSION,
            "tolerance": self.tolerance,
            "flags": {flag: {"bug": BUGS[flag][0], "notes": BUGS[flag][1]} for flag in used},
        }
        lines = json.dumps(head, indent=1, ensure_ascii=False)[:-2]
        cases = ",\n".join("  " + dumps(case) for case in self.cases)
        return f'{lines},\n "cases": [\n{cases}\n ]\n}}\n'


def dumps(value):
    return json.dumps(value, ensure_ascii=True, allow_nan=False, separators=(", ", ": "))


UNKNOWN = "gama"
"""A name that no op has for an argument."""

BAD_ARGUMENT = {"wrong_type", "missing_argument", "unknown_argument", "lengths_differ", "empty", "length_not_checked"}
"""The flags of cases to be refused as `bad_argument`; others are `out_of_range`, if the case does not say otherwise."""


def cut(value, count):
    """Where no list holds more numbers than a buffer."""
    if isinstance(value, dict):
        return {key: cut(item, count) for key, item in value.items()}
    return [cut(item, count) for item in value[:count]] if isinstance(value, list) else value


def cut_answers(args, cuts, answer):
    return [("record_cut", answer(cut(args, count))) for count in cuts]


def without(args, name):
    return {key: value for key, value in args.items() if key != name}


def at_limit(probability):
    """The flag of what is no probability, or has an infinite quantile."""
    return "infinite_answer" if probability in (0, 1) else "out_of_range"


def case_by_case(keys, unit="1", bound=UNIT):
    """The tolerances of keys for which every case states its own."""
    return {key: absolute(bound, unit, "cases state their own") for key in keys}


def refuse_common(group, args, numbers, lists=()):
    """What every op must refuse, tried on each argument: `args` is a request that would pass, `numbers` and `lists` its
    arguments that are numbers or lists of numbers."""
    for key in numbers:
        for token in ("NaN", "Infinity", "-1e999"):
            group.refuse_line(f"{key} is {token}", dumps({**args, key: "@"}).replace('"@"', token))
            if len(numbers) > 3:
                break
        group.refuse(f"{key} is null", args, "wrong_type", **{key: None})
        group.refuse(f"{key} is text", args, "wrong_type", **{key: "1"})
        group.refuse(f"{key} is missing", without(args, key), "missing_argument")
    for key in lists:
        if not isinstance(args[key][0], list):
            text = dumps({**args, key: ["@", *args[key][1:]]}).replace('"@"', "NaN")
            group.refuse_line(f"the first of {key} is NaN", text)
        group.refuse(f"the last of {key} is null", args, "wrong_type", **{key: [*args[key][:-1], None]})
        group.refuse(f"{key} is a number", args, "wrong_type", **{key: 1})
        group.refuse(f"{key} is missing", without(args, key), "missing_argument")
    group.refuse("an argument that the op does not have", args, "unknown_argument", **{UNKNOWN: 1})

"""Checks the suite itself (VEC-014) without the generator: form, ids, flags, bits, wrong answers, manifest, counts,
conditions, and each seventh expected answer by a second route, also with its arguments rounded to f32.

    python3 vectors/check.py [--all]

With --all, it computes every expected answer again. It needs mpmath, and uses jsonschema where that is installed.

Implements: VEC-014.
"""

import hashlib
import json
import math
import re
import struct
import sys
from fractions import Fraction
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import second_route
from mpmath import mp
from second_route import rational

mp.dps = 40
HERE = Path(__file__).parent
ERRORS = {"bad_json", "bad_request", "unknown_op", "bad_argument", "out_of_range", "overflow"}
HEAD = {"schema", "schema_version", "group", "op", "source", "generator_version", "tolerance", "flags", "cases"}
CASE = {"id", "comment", "args", "line", "ok", "bits", "error", "lenient", "tolerance", "condition", "roundoff", "flags", "wrong"}
NOT_CASES = {"schema.json", "manifest.json"}
F32, LEAST, SMALLEST, LARGEST = 2.0**-24, 2.0**-149, 2.0**-126, (2 - 2.0**-23) * 2.0**127
LEAST_CASES, LEAST_REFUSED, EACH = 1500, 250, 7

problems = []


def complain(where, what):
    problems.append(f"{where}: {what}")


def leaves(value):
    """The numbers and texts of a value, lists taken apart."""
    if isinstance(value, list):
        for item in value:
            yield from leaves(item)
    else:
        yield value


def ulp(value):
    return rational(math.ulp(value))


def bound(tolerance, expected):
    if "ulp" in tolerance:
        return tolerance["ulp"] * ulp(expected)
    return rational(tolerance.get("absolute", 0)) + rational(tolerance.get("relative", 0)) * abs(rational(expected))


def check_form(name, data):
    """The keys and types that schema.json asks for."""
    if set(data) != HEAD or data["schema"] != "palpate-vectors" or data["schema_version"] != 1:
        complain(name, "keys of the file")
    if f"{data['group']}.json" != name:
        complain(name, "is not named as its group")
    for case in data["cases"]:
        where = case.get("id", name)
        if not set(case) <= CASE or not {"id", "comment", "flags"} <= set(case):
            complain(where, "keys of the case")
        if ("args" in case) == ("line" in case) or ("ok" in case) == ("error" in case):
            complain(where, "either args or line, and either ok or error")
        if not re.fullmatch(data["group"] + r"-\d{3,}", where):
            complain(where, "id")
        if "error" in case and (case["error"] not in ERRORS or {"bits", "wrong", "condition"} & set(case)):
            complain(where, "error")
        if "lenient" in case and "error" not in case:
            complain(where, "lenient is of what must be refused")
        if "\n" in case.get("line", ""):
            complain(where, "a line holds one line")


def check_flags(name, data):
    used = {flag for case in data["cases"] for flag in case["flags"]}
    if used != set(data["flags"]):
        complain(name, f"flags used and explained differ: {sorted(used ^ set(data['flags']))}")
    for case in data["cases"]:
        shown = {item["flag"] for item in case.get("wrong", [])}
        if not shown <= set(case["flags"]):
            complain(case["id"], "a flag of `wrong` is not among the case's")
        if "error" in case and not case["flags"]:
            complain(case["id"], "a refusal names no bug")


def check_numbers(data):
    """Bits agree with decimals, and wrong answers are far enough away."""
    for case in data["cases"]:
        if "ok" not in case:
            continue
        limits = {**data["tolerance"], **case.get("tolerance", {})}
        for key, value in case["ok"].items():
            if key not in limits:
                complain(case["id"], f"no tolerance for {key}")
            decimals = list(leaves(value))
            if any(isinstance(v, float) for v in decimals):
                patterns = list(leaves(case.get("bits", {}).get(key, [])))
                if patterns != ["0x" + struct.pack(">d", v).hex() for v in decimals]:
                    complain(case["id"], f"bits of {key}")
        for item in case.get("wrong", []):
            if set(item["ok"]) != set(case["ok"]):
                complain(case["id"], f"keys of the wrong answer {item['flag']}")
            elif not far(item["ok"], case["ok"], limits):
                complain(case["id"], f"the wrong answer {item['flag']} is within ten tolerances")


def check_conditions(data):
    """Each has the shape of its value, or is one number, and is not below what size and tolerance alone ask for."""
    for case in data["cases"]:
        if not 0 < case.get("roundoff", 2.0**-12) < 2.0**-11:
            complain(case["id"], "roundoff")
        given = case.get("condition", {})
        if not set(given) <= set(case.get("ok", {})) or given and data["op"] == "probe_force":
            complain(case["id"], "keys of the condition")
        for key, value in case.get("ok", {}).items() if data["op"] != "probe_force" else ():
            expected, limit = list(leaves(value)), {**data["tolerance"], **case.get("tolerance", {})}[key]
            if not any(isinstance(e, float) and e for e in expected):
                continue
            condition = conditions(given.get(key, []), value)
            if len(condition) != len(expected):
                complain(case["id"], f"shape of the condition of {key}")
            for c, e in zip(condition, expected):
                least = 16 * abs(rational(e)) + (bound(limit, e) * 2**54 if e else 0)
                # What is far below the smallest normal number may be left out.
                if not 0 <= c < math.inf or rational(c) * (1 + Fraction(1, 10**8)) < least > 2.0**-1000:
                    complain(case["id"], f"the condition of {key} is {c!r}")


def conditions(condition, value):
    """Of each number of a value; a single one is that of all. None where they differ in shape."""
    if not isinstance(value, list):
        return [condition] if isinstance(condition, float) else []
    if isinstance(condition, float):
        return [condition] * len(list(leaves(value)))
    if len(condition) != len(value):
        return []
    return [c for part, item in zip(condition, value) for c in conditions(part, item)]


def far(wrong, right, limits):
    for key, expected in right.items():
        pairs = list(zip(leaves(wrong[key]), leaves(expected)))
        if len(list(leaves(wrong[key]))) != len(pairs) or len(list(leaves(expected))) != len(pairs):
            return True
        for w, e in pairs:
            if isinstance(e, float):
                if abs(rational(w) - rational(e)) > 10 * bound(limits[key], e):
                    return True
            elif w != e:
                return True
    return False


def check_answer(case, answer, limits, printed):
    """The second route's answer is the expected one to half a unit in the last place and a hundredth of the tolerance.
    `printed` is the relative accuracy of a rule that is known to 15 digits only."""
    if set(answer) != set(case["ok"]):
        complain(case["id"], "keys of the second route")
        return
    for key, expected in case["ok"].items():
        got, wanted = list(leaves(answer[key])), list(leaves(expected))
        largest = max([abs(rational(v)) for v in wanted if isinstance(v, float)], default=0)
        for g, w in zip(got, wanted):
            is_off = g != w
            if isinstance(w, float):
                slack = ulp(w) / 2 + bound(limits[key], w) / 100 + rational(printed) * largest
                is_off = abs(rational(g) - rational(w)) > slack
            if is_off:
                complain(case["id"], f"{key} by the second route is {g}, not {w!r}")
        if len(got) != len(wanted):
            complain(case["id"], f"length of {key}")


def numbers(value):
    if isinstance(value, dict):
        value = list(value.values())
    return [v for v in leaves(value) if isinstance(v, (int, float)) and not isinstance(v, bool) and v]


def is_extreme(case):
    """Whether f32 cannot be asked: by its unit roundoff, or by its range."""
    args, ok = map(numbers, (list(case["args"].values()), list(case["ok"].values())))
    outside = not all(SMALLEST <= v * v <= LARGEST for v in args) or not all(SMALLEST <= abs(v) <= LARGEST for v in ok)
    return outside or case.get("roundoff", 1) < F32


def rounded(value):
    """The f32 of each number."""
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    if isinstance(value, list):
        return [rounded(item) for item in value]
    return second_route.f32(value) if isinstance(value, float) else value


def check_rounded(case, route, answer):
    """Arguments rounded to f32 move the answer by no more than 2⁻²⁴ of its condition, and decide nothing otherwise."""
    try:
        moved = route(rounded(case["args"]))
    except (ArithmeticError, ValueError, second_route.right.Refused) as error:
        complain(case["id"], f"with f32 arguments: {error!r}")
        return
    for key, value in case["ok"].items():
        condition = conditions(case["condition"].get(key, 0.0), value)
        if max(condition) * F32 > max([1, *map(abs, numbers(value))]):
            complain(case["id"], f"f32 says nothing of {key}, and there is no roundoff")
        for a, b, e, c in zip(leaves(answer[key]), leaves(moved[key]), leaves(value), condition):
            if a != b if not isinstance(e, float) else abs(rational(a) - rational(b)) > rational(c * F32 + LEAST):
                complain(case["id"], f"{key} with f32 arguments is {b}, not {a}")


def check_second_route(data, every, count):
    route = second_route.route(data["op"])
    if route is None:
        return count
    for case in data["cases"]:
        if "ok" not in case:
            continue
        count += 1
        if count % every == 0:
            limits = {**data["tolerance"], **case.get("tolerance", {})}
            printed = 2e-14 if data["op"] == "element_stiffness" else 0
            answer = route(case["args"])
            check_answer(case, answer, limits, printed)
            if "condition" in case and not is_extreme(case):
                check_rounded(case, route, answer)
    return count


def check_probe(data):
    """Forces: those of the data file, odd and even in x, and with each inclusion above those without."""
    poses = {
        (p["phantom"], p["depth_mm"], p["lateral_mm"]): p
        for p in json.loads((HERE / "probe_force" / "forces.json").read_text())["poses"]
    }
    table = (HERE.parent / "tests" / "tables" / "finite_strain.txt").read_text().splitlines()
    finite = {(d, float(x)): (float(f), float(n)) for gel, d, x, f, n in map(str.split, table[2:]) if gel == "hyperelastic"}
    for case in data["cases"]:
        if "ok" not in case:
            continue
        a = case["args"]
        at = a["phantom"], round(a["depth_m"] * 1e3, 6), round(abs(a["lateral_m"]) * 1e3, 6)
        sign = -1 if a["lateral_m"] < 0 else 1
        lateral, normal = sign * poses[at]["lateral_force_mn"] / 1e3, poses[at]["normal_force_mn"] / 1e3
        if a.get("strain") == "finite":
            lateral, normal = finite[a["phantom"], round(a["lateral_m"] * 1e3, 6)]
            if normal <= 1.3 * case["wrong"][0]["ok"]["normal_force_n"]:
                complain(case["id"], "finite strain is hardly stiffer than small strain")
        for key, value in (("normal_force_n", normal), ("lateral_force_n", lateral)):
            if abs(case["ok"][key] - value) > 1e-12:
                complain(case["id"], f"{key} is not that of the data")


def check_refusals(data):
    """A line is to be refused as bad_json exactly if Python's reader refuses it."""
    for case in data["cases"]:
        if "line" not in case:
            continue
        try:
            json.loads(case["line"], parse_constant=refuse_constant)
            is_json = True
        except RecursionError:
            is_json = case["line"].count("[") == case["line"].count("]")
        except ValueError:
            is_json = False
        if is_json == (case["error"] == "bad_json"):
            complain(case["id"], "bad_json, or not")


def refuse_constant(name):
    raise ValueError(name)


def check_manifest(names):
    manifest = json.loads((HERE / "manifest.json").read_text())
    listed = {item["name"]: item["sha256"] for item in manifest["files"]}
    if set(listed) != set(names) | {"schema.json"}:
        complain("manifest.json", f"files: {sorted(set(listed) ^ set(names))}")
    lines = ""
    for name in sorted(listed):
        digest = hashlib.sha256((HERE / name).read_bytes()).hexdigest()
        lines += f"{digest}  {name}\n"
        if digest != listed[name]:
            complain("manifest.json", f"hash of {name}")
    if hashlib.sha256(lines.encode()).hexdigest() != manifest["suite_sha256"]:
        complain("manifest.json", "hash of the suite")
    return manifest


def main():
    every = 1 if "--all" in sys.argv[1:] else EACH
    names = sorted(path.name for path in HERE.glob("*.json") if path.name not in NOT_CASES)
    files = {name: json.loads((HERE / name).read_text()) for name in names}
    try:
        import jsonschema
    except ImportError:
        print("jsonschema is not installed: schema.json itself is not applied")
    else:
        validator = jsonschema.Draft202012Validator(json.loads((HERE / "schema.json").read_text()))
        for name, data in files.items():
            for error in validator.iter_errors(data):
                complain(name, f"{error.json_path}: {error.message[:200]}")
    manifest = check_manifest(names)
    seen, cases, refused, again = set(), 0, 0, 0
    for name, data in files.items():
        check_form(name, data)
        check_flags(name, data)
        check_numbers(data)
        check_conditions(data)
        check_refusals(data)
        if data["op"] == "probe_force":
            check_probe(data)
        again = check_second_route(data, every, again)
        for case in data["cases"]:
            if case["id"] in seen:
                complain(case["id"], "id is not unique")
            seen.add(case["id"])
        errors = sum("error" in case for case in data["cases"])
        cases, refused = cases + len(data["cases"]), refused + errors
        shown = sum("wrong" in case for case in data["cases"])
        print(f"{name:28} {len(data['cases']):5} cases {errors:4} refused {shown:5} with wrong answers")
        if data["op"] and 3 * shown < len(data["cases"]) - errors:
            complain(name, "fewer than a third of the answers have a wrong one")
    if (cases, refused) != (manifest["cases"], manifest["refused"]):
        complain("manifest.json", "counts")
    if cases < LEAST_CASES or refused < LEAST_REFUSED:
        complain("suite", f"{cases} cases, {refused} refused: VEC-008")
    for problem in problems:
        print(problem, file=sys.stderr)
    print(f"{cases} cases, {refused} refused, {again // every} answers by a second route, {len(problems)} problems")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()

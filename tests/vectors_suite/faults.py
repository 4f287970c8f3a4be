"""Plants a fault at a time in files of the suite, whose folder is the argument: `check.py` must find it, and nothing in the sound file."""
import copy
import json
import math
import struct
import sys

sys.path.insert(0, sys.argv[1])
import check


def at(*path):
    """Sets the number at the end of a path."""

    def plant(data):
        for key in path[:-2]:
            data = data[key]
        data[path[-2]] = path[-1]

    return plant


def answered(value):
    def plant(data):
        case = data["cases"][1]
        case["ok"]["p"], case["bits"]["p"] = value, "0x" + struct.pack(">d", value).hex()

    return plant


def form(data):
    check.check_form("normal_cdf.json", data)


def flags(data):
    check.check_flags("normal_cdf.json", data)


def route(data):
    check.check_second_route(data, 1, 0)


# A group, its fault, the check that must find it, and how that begins.
FAULTS = [
    ("normal_cdf", at("cases", 0, "other", 1), form, "normal_cdf-001: keys of the case"),
    ("normal_cdf", at("cases", 0, "id", "other-001"), form, "other-001: id"),
    ("normal_cdf", at("cases", 0, "error", "failed"), form, "normal_cdf-001: either args or line, and either ok or error"),
    ("normal_cdf", at("cases", 0, "flags", ["unexplained"]), flags, "normal_cdf.json: flags used and explained differ"),
    ("normal_cdf", at("cases", 0, "bits", "p", "0x3FE0000000000000"), check.check_numbers, "normal_cdf-001: bits of p"),
    ("normal_cdf", at("cases", 0, "wrong", 0, "ok", "p", math.nextafter(0.5, 1)), check.check_numbers,
     "normal_cdf-001: the wrong answer erf_for_phi is within ten tolerances"),
    ("normal_cdf", at("cases", 0, "condition", "p", 7.9), check.check_conditions, "normal_cdf-001: the condition of p is 7.9"),
    ("normal_cdf", answered(0.6), route, "normal_cdf-002: p by the second route is"),
    ("normal_cdf", at("cases", 1, "condition", "p", 1e-9), route, "normal_cdf-002: p with f32 arguments is"),
    ("requests", at("cases", 0, "error", "bad_request"), check.check_refusals, "requests-001: bad_json, or not"),
    ("probe_force", at("cases", 0, "ok", "normal_force_n", 1.0), check.check_probe,
     "probe_force-001: normal_force_n is not that of the data"),
]


def found(look, data):
    check.problems.clear()
    look(data)
    return check.problems[:1]


for name, plant, look, expected in FAULTS:
    sound = json.loads((check.HERE / f"{name}.json").read_text())
    faulty = copy.deepcopy(sound)
    plant(faulty)
    assert not found(look, sound), (name, found(look, sound))
    problems = found(look, faulty)
    assert problems and str(problems[0]).startswith(expected), f"{problems}, expected {expected!r}"
problems = found(check.check_manifest, [])
assert problems and str(problems[0]).startswith("manifest.json: files: "), problems
print(f"{len(FAULTS) + 1} faults found")

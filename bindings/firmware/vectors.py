"""The vectors as a table that a program without JSON reads, and how many there are.

    vectors.py TABLE COUNTS ORACLE…

writes both files. What the servo kernel and the device's reports must answer comes from vectors/*.json. What the detector must
answer, to the bit, is what the command ORACLE answers on this machine: the files have a tolerance there.

Little-endian words of 32 bits: the magic number, the number of cases, then for each case the op, its number in the group, the
number of lists, each list as its length and its words, and the answer as one more list; empty if the case must be refused.

Implements: FIR-001, FIR-004.
"""

import ctypes
import json
import pathlib
import re
import struct
import subprocess
import sys

VECTORS = pathlib.Path(__file__).parents[2] / "vectors"
MAGIC = 0x50414C50

REPORTS = {
    1: {"lateral": "h", "normal": "h", "buttons": "B", "status": "B", "sequence": "H", "force_sequence": "H"},
    2: {"lateral": "h", "normal": "h", "sequence": "H", "flags": "B"},
    3: dict.fromkeys(
        "version position_unit_nm force_unit_un largest_force_mn period_us watchdog_ms damping_mn_s_per_m friction_mn".split(),
        "H",
    ),
    4: {"control": "B"},
}
# What the detector's groups ask for, and answer.
NUMBERS = {
    "normal_cdf": (["x"], ["p"]),
    "normal_quantile": (["p"], ["x"]),
    "error_rates": (["gamma", "eta"], ["false_alarm", "miss"]),
    "required_gamma": (["max_false_alarm", "max_miss"], ["gamma"]),
    "two_afc": (["gamma"], ["p_correct"]),
    "gamma_from_two_afc": (["p_correct"], ["gamma"]),
    "chi_square_tail": (["x", "degrees", "noncentrality"], ["lower", "upper"]),
    "f_tail": (["x", "numerator", "denominator", "noncentrality"], ["lower", "upper"]),
    "student_tail": (["x", "degrees", "noncentrality"], ["lower", "upper"]),
    "theta": (
        ["observed_x", "observed_y", "f0_x", "f0_y", "f1_x", "f1_y", "noise_sd_x", "noise_sd_y"],
        ["theta", "y_x", "y_y", "gamma"],
    ),
}
CRITERIA = {
    "map": ["prior_h1"],
    "bayes": ["prior_h1", "c00", "c01", "c10", "c11"],
    "neyman_pearson_miss": ["gamma", "max_miss"],
    "neyman_pearson_false_alarm": ["gamma", "max_false_alarm"],
}
KERNEL = ["servo_axis", "servo_interpolate", "report_decode", "report_encode"]
# The op's number in the table is its place here.
OPS = [*KERNEL, *NUMBERS, *(f"threshold {criterion}" for criterion in CRITERIA)]


class OfTheProtocol(Exception):
    """A question that cannot be asked without JSON, and why."""


def asked(args, names):
    """The arguments of these names, which must be all."""
    if set(args) != set(names):
        raise OfTheProtocol("an argument is missing or unknown")
    return [args[name] for name in names]


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def bits(text):
    """The bits of an f32, from text."""
    if not isinstance(text, str) or not re.fullmatch("0x[0-9a-fA-F]{8}", text):
        raise OfTheProtocol("no bits of an f32")
    return int(text, 16)


def singles(values):
    """The bits of the f32 nearest to each number."""
    if not isinstance(values, list) or not all(map(is_number, values)):
        raise OfTheProtocol("no list of numbers")
    return [struct.unpack("<I", ctypes.c_float(value))[0] for value in values]


def doubles(value):
    """The bits of a number, or of a list of them, two words each."""
    values = value if isinstance(value, list) else [value]
    if not all(map(is_number, values)):
        raise OfTheProtocol("no number")
    return [word for value in values for word in struct.unpack("<2I", struct.pack("<d", value))]


def digits(text):
    """The bytes of a report, from text."""
    if not isinstance(text, str) or not re.fullmatch("([0-9a-fA-F]{2})*", text):
        raise OfTheProtocol("no bytes")
    return list(bytes.fromhex(text))


def axis(args):
    knots, coordinate = asked(args, ["knots", "coordinate_bits"])
    return [singles(knots), [bits(coordinate)]]


def interpolate(args):
    names = ["depth_knots", "lateral_knots", "table_bits", "depth_bits", "lateral_bits"]
    depths, laterals, rows, depth, lateral = asked(args, names)
    table = [bits(entry) for row in rows for entry in row]
    return [singles(depths), singles(laterals), table, [bits(depth)], [bits(lateral)]]


def fields(args):
    """The number of a report, and its fields as words in two's complement."""
    number = args.get("report")
    if number not in REPORTS:
        raise OfTheProtocol("a report that the codec has no type for")
    values = asked(args, ["report", *REPORTS[number]])
    for value, kind in zip(values[1:], REPORTS[number].values()):
        least, most = {"h": (-32768, 32767), "H": (0, 65535), "B": (0, 255)}[kind]
        if number == 4:
            most = 2
        if not isinstance(value, int) or not least <= value <= most:
            raise OfTheProtocol("a value that the field's type does not hold")
    return [value & 0xFFFFFFFF for value in values]


def numbers(group, args):
    """The op and the lists of a question to the detector."""
    if group == "threshold":
        criterion = args.get("criterion")
        if criterion not in CRITERIA:
            raise OfTheProtocol("a criterion that is no function")
        values = asked(args, ["criterion", *CRITERIA[criterion]])
        return f"threshold {criterion}", [sum(map(doubles, values[1:]), [])]
    names, _ = NUMBERS[group]
    values = asked(args, names)
    lists = [isinstance(value, list) for value in values]
    if group == "theta":
        if lists != 6 * [True] + 2 * [False]:
            raise OfTheProtocol("no list, or one where a number belongs")
        return group, list(map(doubles, values))
    if any(lists):
        raise OfTheProtocol("a list where a number belongs")
    return group, [sum(map(doubles, values), [])]


def question(group, case):
    """The op of a case and its lists."""
    args = case["args"] if "args" in case else json.loads(case["line"]).get("args", {})
    if group == "servo_axis":
        return group, axis(args)
    if group == "servo_interpolate":
        return group, interpolate(args)
    if group == "report_decode":
        return group, [digits(*asked(args, ["bytes"]))]
    if group == "report_encode":
        return group, [fields(args)]
    return numbers(group, args)


def answer(group, ok):
    """The words of an answer."""
    if group == "servo_axis":
        return [ok["cell"], bits(ok["fraction_bits"])]
    if group == "servo_interpolate":
        return [bits(ok["force_bits"])]
    if group == "report_decode":
        return fields(ok)
    if group == "report_encode":
        return digits(ok["bytes"])
    keys = ["eta"] if group == "threshold" else NUMBERS[group][1]
    return sum((doubles(ok[key]) for key in keys), [])


def from_oracle(oracle, cases):
    """What the oracle answers to cases of the detector, by their id; None for a refusal."""
    lines = [
        case.get("line") or json.dumps({"id": case["id"], "op": op, "args": case["args"]}) for op, case in cases
    ]
    told = subprocess.run(oracle, input="\n".join(lines) + "\n", capture_output=True, text=True, check=True).stdout
    answers = [json.loads(line) for line in told.splitlines()]
    assert len(answers) == len(cases), f"{len(answers)} answers to {len(cases)} questions"
    return {case["id"]: told.get("ok") for (_, case), told in zip(cases, answers)}


def main(table, counts, *oracle):
    groups = [*KERNEL, *NUMBERS, "threshold"]
    files = {group: json.loads((VECTORS / f"{group}.json").read_text())["cases"] for group in groups}
    detector = [(group, case) for group in groups if group not in KERNEL for case in files[group]]
    oracles = from_oracle(oracle, detector)
    words, lines, total = [], [], 0
    for group, cases in files.items():
        found = dict(answered=0, refused=0)
        protocol = {}
        for number, case in enumerate(cases):
            ok = case.get("ok") if group in KERNEL else oracles[case["id"]]
            assert (ok is None) == ("error" in case), f"{case['id']}: the oracle does not answer as the vectors say"
            try:
                op, lists = question(group, case)
            except OfTheProtocol as why:
                assert ok is None, f"{case['id']} has an answer, but cannot be asked: {why}"
                protocol[str(why)] = protocol.get(str(why), 0) + 1
                continue
            found["refused" if ok is None else "answered"] += 1
            words += [OPS.index(op), number + 1, len(lists)]
            for entries in [*lists, [] if ok is None else answer(group, ok)]:
                words += [len(entries), *entries]
        left_out = sum(protocol.values())
        assert sum(found.values()) + left_out == len(cases)
        total += len(cases) - left_out
        lines.append(f"{group}: {found['answered']} answered, {found['refused']} refused")
        reasons = "".join(f"; {count} {why}" for why, count in sorted(protocol.items()))
        print(f"{group}: {len(cases)} cases, {left_out} of JSON alone{reasons}")
    pathlib.Path(table).write_bytes(struct.pack(f"<{len(words) + 2}I", MAGIC, total, *words))
    pathlib.Path(counts).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])

"""The oracle's lines (spec/oracle.md) for an implementation in Python: reads and checks arguments, writes answers.

An op is a function. Each of its arguments is annotated with the function of this file that reads it.
"""

import json
import struct
import sys
from inspect import get_annotations

import numpy as np


class Refused(Exception):
    """A request without an answer: a code and a message."""


def refuse_if(condition, code, message):
    if condition:
        raise Refused(code, message)


# Arguments


def real(value):
    refuse_if(isinstance(value, bool) or not isinstance(value, (int, float)), "bad_argument", "must be a number")
    try:
        value = float(value)
    except OverflowError:
        value = np.inf
    refuse_if(not np.isfinite(value), "bad_argument", "must be finite")
    return value


def limited(low, high, open_ends=False):
    def read(value):
        value = real(value)
        inside = low < value < high if open_ends else low <= value <= high
        refuse_if(not inside, "out_of_range", f"must be in {low} … {high}")
        return value

    return read


positive, not_negative = limited(0, np.inf, open_ends=True), limited(0, np.inf)
probability = limited(0, 1, open_ends=True)


def whole(value):
    value = real(value)
    refuse_if(value % 1 != 0, "bad_argument", "must be a whole number")
    return int(value)


def text(value):
    refuse_if(not isinstance(value, str), "bad_argument", "must be a text")
    return value


def listed(value, read):
    refuse_if(not isinstance(value, list), "bad_argument", "must be a list")
    return [read(item) for item in value]


def series(value):
    numbers = np.array(listed(value, real))
    refuse_if(len(numbers) == 0, "bad_argument", "must hold numbers")
    return numbers


def rows(value):
    """A matrix; of no rows, too."""
    table = listed(value, series)
    same_length(*table)
    return np.array(table)


def same_length(*lists):
    refuse_if(len({len(item) for item in lists}) > 1, "bad_argument", "lengths differ")


def single(value):
    """An f32 by its bits."""
    refuse_if(len(text(value)) != 10 or value[:2] != "0x" or not value[2:].isalnum(), "bad_argument", "must be 0x and 8 digits")
    return np.float32(struct.unpack(">f", bytes.fromhex(value[2:]))[0])


def knots(value):
    numbers = series(value).astype(np.float32) if value else []
    fits = 2 <= len(numbers) <= 1024 and np.all(np.abs(numbers) <= 1) and np.all(np.diff(numbers) >= np.float32(1e-6))
    refuse_if(not fits, "out_of_range", "must be 2 to 1024 increasing knots")
    return numbers


def bits(number):
    return "0x" + struct.pack(">f", number).hex()


# Requests and answers


def call(op, args):
    """The answer of `op` to the arguments as they were sent."""
    readers = get_annotations(op)
    if readers or not args:
        refuse_if(set(args) != set(readers), "bad_argument", f"missing or unknown: {sorted(set(args) ^ set(readers))}")
        args = {name: read(args[name]) for name, read in readers.items()}
    return op(**args)


def plain(value):
    """As JSON has it, and finite."""
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if isinstance(value, list):
        return [plain(item) for item in value]
    refuse_if(isinstance(value, float) and not np.isfinite(value), "overflow", "the answer is no finite number")
    return value


def without_twins(pairs):
    refuse_if(len(dict(pairs)) != len(pairs), "bad_request", "a key stands twice")
    return dict(pairs)


def no_json(name):
    raise ValueError(f"{name} is no number of JSON")


def answer(line, ops):
    name = None
    try:
        request = json.loads(line.decode(), parse_constant=no_json, object_pairs_hook=without_twins)
        fits = isinstance(request, dict) and {"id", "op"} <= set(request) <= {"id", "op", "args"}
        refuse_if(not fits or type(request["id"]) not in (str, int, float), "bad_request", "must be an object with id, op and args")
        name, args = request["id"], request.get("args", {})
        refuse_if(not isinstance(request["op"], str) or request["op"] not in ops, "unknown_op", "no such op")
        refuse_if(not isinstance(args, dict), "bad_argument", "args is no object")
        return {"id": name, "ok": {key: plain(value) for key, value in call(ops[request["op"]], args).items()}}
    except Refused as refused:
        code, message = refused.args
    except (ValueError, RecursionError, struct.error) as error:
        code, message = "bad_json" if name is None else "out_of_range", str(error)
    except Exception as error:
        code, message = "failed", repr(error)
    return {"id": name, "error": {"code": code, "message": message}}


def answer_lines(ops):
    for line in sys.stdin.buffer:
        print(json.dumps(answer(line, ops)), flush=True)

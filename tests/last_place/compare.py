"""How far the answers move: each key of each op, in units of the last place and as a share of what its vector allows (ACC-031)."""

import json
import math
import pathlib
import sys


def numbers(value):
    """The numbers of an answer's key, in order."""
    if isinstance(value, list):
        return [number for part in value for number in numbers(part)]
    return [value] if isinstance(value, (int, float)) and not isinstance(value, bool) else []


def allowed(entry, expected):
    if "ulp" in entry:
        return entry["ulp"] * math.ulp(expected)
    if "absolute" in entry:
        return entry["absolute"]
    return entry.get("relative", 0) * abs(expected)


def main(paths):
    answers = []
    for path in paths:
        with open(path) as lines:
            answers.append({answer["id"]: answer for answer in map(json.loads, lines) if "id" in answer})
    moved = {}
    for path in sorted(pathlib.Path("vectors").glob("*.json")):
        group = json.loads(path.read_text())
        if group.get("schema") != "palpate-vectors":
            continue
        for case in group["cases"]:
            still, *others = (answer[case["id"]] for answer in answers if case["id"] in answer)
            assert len(others) >= 3, case["id"]
            for key, expected in case.get("ok", {}).items():
                entry = case.get("tolerance", {}).get(key) or group["tolerance"].get(key, {})
                row = moved.setdefault((group["op"], key), [0, 0.0, 0.0])
                row[0] += 1
                for other in others:
                    assert ("ok" in still) == ("ok" in other), case["id"]
                    if numbers(expected) == []:
                        assert still["ok"][key] == other["ok"][key], (case["id"], key)
                    for true, a, b in zip(*(numbers(value) for value in (expected, still["ok"][key], other["ok"][key])), strict=True):
                        if a != b:
                            room = allowed(entry, true)
                            assert room > 0, f"{case['id']}: {key} is exact, and moves from {a!r} to {b!r}"
                            row[1] = max(row[1], abs(a - b) / math.ulp(true))
                            row[2] = max(row[2], abs(a - b) / room)
    assert moved, "no vectors"
    print(f"{'op':22} {'key':20} {'cases':>5} {'ulp':>9} {'of the tolerance':>16}")
    for (op, key), (cases, ulp, share) in sorted(moved.items()):
        print(f"{op:22} {key:20} {cases:5} {ulp:9.4g} {share:16.3f}" if ulp else f"{op:22} {key:20} {cases:5} {'never':>9}")
    beyond = {name: row for name, row in moved.items() if row[2] > 1}
    assert not beyond, f"moved by more than the tolerance: {beyond}"


main(sys.argv[1:])

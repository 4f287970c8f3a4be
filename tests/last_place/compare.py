"""How far the answers move: each key of each op, in units of the last place and as a share of what its vector allows (ACC-031).

`python3 tests/last_place/compare.py STILL MOVED…`: files of answers, of which those of STILL are the program's own. Needs mpmath.
"""

import json
import math
import pathlib
import sys

VECTORS = pathlib.Path(__file__).parents[2] / "vectors"
sys.path.insert(0, str(VECTORS))
from generator.suite import allowed, leaves


def answers(path):
    with open(path) as lines:
        return {answer["id"]: answer for answer in map(json.loads, lines)}


def main(paths):
    still, *others = map(answers, paths)
    rows = {}
    for path in sorted(VECTORS.glob("*.json")):
        group = json.loads(path.read_text())
        if group.get("schema") != "palpate-vectors":
            continue
        for case in (case for case in group["cases"] if "ok" in case):
            own, moved = still[case["id"]], [other[case["id"]] for other in others if case["id"] in other]
            assert len(moved) >= 3 and all("ok" in answer for answer in [own, *moved]), case["id"]
            tolerance = group["tolerance"] | case.get("tolerance", {})
            for key in case["ok"]:
                row = rows.setdefault((group["op"], key), [0, 0.0, 0.0])
                row[0] += 1
                for answer in moved:
                    for true, a, b in zip(*(leaves(of[key]) for of in (case["ok"], own["ok"], answer["ok"])), strict=True):
                        if a != b:
                            room = allowed(tolerance.get(key, {}), true)
                            assert abs(a - b) <= room, f"{case['id']}: {key} moves from {a!r} to {b!r}, more than {float(room)}"
                            row[1] = max(row[1], abs(a - b) / math.ulp(true))
                            row[2] = max(row[2], abs(a - b) / float(room))
    assert rows, "no vectors"
    print(f"{'op':22} {'key':20} {'cases':>5} {'ulp':>9} {'of the tolerance':>16}")
    for (op, key), (cases, ulp, share) in sorted(rows.items()):
        print(f"{op:22} {key:20} {cases:5} " + (f"{ulp:9.4g} {share:16.3f}" if ulp else f"{'never':>9}"))


main(sys.argv[1:])

"""Pickles, pictures and tables, as users of notebooks expect them. Checks PYT-043, PYT-044, PYT-045, PYT-046."""

import copy
import pickle
import subprocess
import sys
import types
import typing
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import palpate
import pytest

matplotlib.use("agg")
X = np.linspace(-8, 8, 81)


@pytest.fixture(scope="module")
def bank():
    return palpate.Bank.build(palpate.Phantom("6.6"), 4, [-8, -4, 0, 4, 8], offsets_mm=[-2, 0, 2], depths_mm=[5.6, 6.6], mesh_mm=2)


@pytest.fixture(scope="module")
def located(bank):
    noise = 0.1 * np.random.default_rng(1).standard_normal((2, 81))
    return bank.locate(X, bank.maps[4].sweep(4, X) + noise)


# PYT-043.
def test_objects_are_pickled_and_copied(bank):
    force_map = palpate.ForceMap([1, 2], [0.1, 0.3], [[0.1, 0.2], [0.3, 0.4]], [[1, 2], [3, 4]], note="mine")
    matched = palpate.MatchedFilter([[1, 2], [3, 4]], (0.1, 0.3))
    phantom = palpate.Phantom("4.6", inclusion_depth_mm=5.3)
    objects = [
        phantom,
        force_map,
        bank,
        palpate.ServoTable(force_map),
        matched,
        matched.statistic([[1, 2], [3, 4]]),
        palpate.Limits(3, 0.05, 0.25, 5),
        palpate.Sample(7, 1.1, -2.3, True, device_fault=True),
        palpate.ProbeForce(0.1, 0.2),
    ]
    for one in objects:
        for other in (pickle.loads(pickle.dumps(one)), copy.copy(one), copy.deepcopy(one)):
            assert type(other) is type(one) and repr(other) == repr(one)
    again = pickle.loads(pickle.dumps([phantom, force_map, bank.maps, bank.reference]))
    assert again == [phantom, force_map, bank.maps, bank.reference] and again[1].note == "mine"
    # What cannot be made again says so.
    with pytest.raises(TypeError, match="pickle"):
        pickle.dumps(palpate.ServoState())


# PYT-044.
def test_reprs_show_what_differs(bank):
    phantom = palpate.Phantom("6.6", layer_1_youngs_modulus_kpa=10)
    assert eval(repr(phantom), vars(palpate)) == phantom != palpate.Phantom("6.6")
    assert repr(palpate.Limits(3, 0.25, 0.5, 5)) == "Limits(force_n=3.0, slew_n=0.25, release_n=0.5, watchdog=5)"
    assert "position_mm -2 to 2 (3), depth_mm 5.6 to 6.6 (2)" in repr(bank)
    force_map = palpate.ForceMap([1, 2], [0, 3], None, [[1, 2], [3, 4.25]])
    assert "2 from 1 to 2 mm" in repr(force_map) and "1.000 to 4.250 N" in repr(force_map)
    lateral, normal = palpate.ProbeForce(0.1, 0.2)
    assert (lateral, normal) == (0.1, 0.2)
    for one, cell in ((phantom, "youngs_modulus_kpa 10.0"), (bank, "5.6, 6.6"), (force_map, "<td>4.250</td>")):
        html = one._repr_html_()
        assert html.startswith("<table>") and html.endswith("</table>") and cell in html
    tag = palpate.Phantom("6.6", name="<script>")
    assert "<script>" not in tag._repr_html_()


# PYT-045.
def test_maps_and_answers_go_to_other_packages(bank, located):
    force_map = bank.maps[4]
    frame = force_map.to_pandas()
    assert list(frame) == ["depth_mm", "lateral_mm", "lateral_n", "normal_n"] and len(frame) == force_map.normal_n.size
    pose = frame[(frame.depth_mm == 4) & (frame.lateral_mm == -4)]
    assert (pose.lateral_n.item(), pose.normal_n.item()) == force_map.force(4, -4)
    data = force_map.to_xarray()
    assert np.array_equal(data.normal_n, force_map.normal_n) and data.lateral_n.sel(depth_mm=4, lateral_mm=-4) == pose.lateral_n.item()
    assert np.array_equal(np.asarray(force_map), [force_map.lateral_n, force_map.normal_n])
    figure, (upper, lower) = plt.subplots(2)
    signal = bank.reference.normal_n - 1
    assert bank.reference.plot(upper, of=signal) is upper and upper.yaxis_inverted()
    assert np.array_equal(upper.collections[0].get_array(), signal)
    assert palpate.Bank.plot(located, "depth_mm", lower) is lower and lower.get_xlabel() == "depth, mm"
    area = sum(bar.get_width() * bar.get_height() for bar in lower.patches)
    assert abs(area - 1) < 1e-9 and min(bar.get_x() for bar in lower.patches) >= 5.6
    with pytest.raises(palpate.Refused, match="parameter"):
        palpate.Bank.plot(located, "colour", lower)


# PYT-046.
def test_a_type_checker_knows_the_keys_of_answers(bank, located, tmp_path):
    stub = Path(palpate.__file__).with_name("__init__.pyi").read_text()
    known = {"Phantom": palpate.Phantom}
    exec(compile("\n".join(["from typing import *", "from numpy.typing import *", "import numpy as np", *typed(stub)]), "stub", "exec"), known)
    one_subject = tmp_path / "one.csv"
    one_subject.write_text("subject,condition,trials,6.6\na,mine,10,10\n")
    judged = bank.judge(X, bank.maps[4].sweep(4, X), noise_sd_n=0.1)
    for name, answer in (
        ("_Located", located),
        ("_Judged", judged),
        ("_Watched", palpate.Watcher(bank, 0.1).push(0, 1.5, 0)),
        ("_Parameters", located["mean"]),
        ("_Intervals", located["interval_95"]),
        ("_Axes", bank.axes),
        ("_Scan", palpate.scan([[1, 2], [3, 4]], [[1], [1]], 0.1)),
        ("_Nuisances", palpate.theta_nuisances([1, 2, 4], [1, 0, 0], [[0, 1, 0]])),
        ("_BankPosterior", palpate.bank_posterior([1, 2], [[1, 0]], [], [1])),
        ("_Counts", palpate.count_analysis([[29, 26], [27, 21]], 30)),
        ("_Analysis", palpate.analyse_answers()),
        ("_Analysis", palpate.analyse_answers(one_subject)),
        ("_Imported", palpate.import_map(2 + 0 * X, X, X, grid_mm=0.2, smooth_mm=1)[1]),
        ("_Imported", palpate.import_map(2 + 0 * X, X, X, grid_mm=0.2)[1]),
        ("_Reach", palpate.reach(bank, 0.1)),
        ("_Reach", palpate.reach(bank, 0.1, positions_mm=X, classes=True)),
        *(("_Calibrated", of) for of in calibrations()),
    ):
        assert not list(wrong(answer, known[name], known)), name
    program = tmp_path / "program.py"
    program.write_text("import palpate\nanswer = palpate.Bank.read('b').locate([0], [0])\nanswer['estimate']['depth_mm'] + 1.0\nanswer['estmate']\npalpate.Phantom('6.6').solve(4).normal_n + palpate.Phantom('6.6').solve([4])[1]\npalpate.calibrate([0], [0])['contct']\n")
    found = subprocess.run([sys.executable, "-m", "mypy", "--strict", program], capture_output=True, text=True, cwd=tmp_path).stdout
    assert 'program.py:4: error: TypedDict "_Located" has no key "estmate"' in found, found
    assert 'program.py:6: error: TypedDict "_Calibrated" has no key "contct"' in found and "Found 2 errors" in found, found


def calibrations():
    """Of a curve that rises, without a phantom, with one and over time; and of one that does not."""
    depths = np.linspace(0, 4, 161)
    forces = 0.3 * np.maximum(depths - 1, 0) ** 1.5 + 2e-3 * np.random.default_rng(3).standard_normal(161)
    yield palpate.calibrate(depths, forces)
    yield palpate.calibrate(depths, forces, phantom=palpate.Phantom("none"), mesh_mm=2)
    # Held for 20 s, it relaxes.
    times = np.arange(361) * 0.1
    held = np.hstack([depths, np.full(200, 4.0)]), np.hstack([forces, forces[-1] * (0.7 + 0.3 * np.exp(-times[:200] / 4))])
    yield palpate.calibrate(*held, times)
    yield palpate.calibrate(depths, np.sin(np.arange(161) ** 2))


def wrong(value, hint, known):
    """Each part of a value that is not of the type that the stub states."""
    parts = typing.get_args(hint)
    if typing.is_typeddict(hint) and isinstance(value, dict):
        hints = typing.get_type_hints(hint, known)
        if not set(hints) >= set(value) >= hint.__required_keys__:
            yield hint, sorted(value)
        for key in set(hints) & set(value):
            yield from wrong(value[key], hints[key], known)
    elif isinstance(hint, types.UnionType):
        each = [list(wrong(value, part, known)) for part in parts]
        yield from min(each, key=len)
    elif typing.get_origin(hint) is list and isinstance(value, list):
        for part in value:
            yield from wrong(part, parts[0], known)
    else:
        plain = dict if typing.is_typeddict(hint) else (int, float) if hint is float else typing.get_origin(hint) or hint
        if hint is not typing.Any and not isinstance(value, plain):
            yield hint, value


def typed(stub):
    """The lines of a stub that define dictionaries."""
    keep = False
    for line in stub.splitlines():
        if line.startswith("class "):
            keep = line.startswith("class _")
        elif line and not line[0].isspace():
            keep = False
        if keep:
            yield line

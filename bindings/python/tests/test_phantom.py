"""Phantoms, maps and long calls. Checks PYT-004, PYT-005, PYT-007, PYT-002, PYT-010, PYT-040, PYT-042, PYT-050, PYT-055, PYT-056."""

import _thread
import json
import math
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import palpate
import pytest

ROOT = Path(__file__).parents[3]
COARSE = {"mesh_mm": 2}


@pytest.fixture(scope="module")
def phantom():
    return palpate.Phantom("6.6")


@pytest.fixture(scope="module")
def force_map(phantom):
    return phantom.map([1, 2, 4], [-6, -3, 0, 3, 6], **COARSE)


def test_the_force_of_a_pose_is_that_of_the_oracle(phantom):
    force = phantom.solve(depth_mm=4, lateral_mm=3)
    answer = palpate.ask("probe_force", phantom="6.6", depth_m=0.004, lateral_m=0.003)
    assert (force.normal_n, force.lateral_n) == (answer["normal_force_n"], answer["lateral_force_n"])
    # Away from the disc, and out of the gel.
    assert force.lateral_n > 0.01 and force.normal_n > 1


# PYT-050.
def test_forces_at_arrays_of_poses_are_those_of_each_alone(phantom):
    depths, laterals = [[1], [4.0]], (-3, 0, 2.5)
    found = phantom.solve(depths, laterals, **COARSE)
    assert found.shape == (2, 2, 3)
    for row, [depth] in enumerate(depths):
        for column, lateral in enumerate(laterals):
            assert tuple(found[:, row, column]) == tuple(phantom.solve(depth, lateral, **COARSE))
    assert np.array_equal(phantom.solve(np.array([1, 4]), **COARSE), found[:, :, 1])
    assert phantom.solve([], **COARSE).shape == (2, 0)
    with pytest.raises(palpate.Refused, match="^element 1: depth_mm = -1.0, but must be at least"):
        phantom.solve([1, -1], **COARSE)
    with pytest.raises(palpate.Refused, match="broadcast"):
        phantom.solve([1, 2], [0, 1, 2], **COARSE)


def test_lengths_are_read_as_the_decimals_that_they_are(tmp_path):
    # 1.1 mm times 0.001 is 0.0011000000000000001.
    depths = [k / 10 for k in range(1, 100)]
    forces = np.zeros((99, 1))
    force_map = palpate.ForceMap(depths, [0.3], forces, forces)
    force_map.write(tmp_path / "map.json")
    written = json.loads((tmp_path / "map.json").read_text())["depths_m"]
    assert written == [float(f"{k}e-4") for k in range(1, 100)] != [0.001 * depth for depth in depths]
    assert force_map.depths_mm.tolist() == depths
    assert palpate.Phantom("6.6", inclusion_depth_mm=5.3).inclusion_depth_mm == 5.3


def test_phantoms_come_from_names_texts_files_and_dictionaries(phantom, tmp_path):
    text = phantom.to_toml()
    path = tmp_path / "a.toml"
    path.write_text(text)
    tables = phantom.to_dict()
    for other in (
        palpate.Phantom.from_toml(text),
        palpate.Phantom.from_toml(path),
        palpate.Phantom.from_toml(str(path)),
        palpate.Phantom.from_dict(tables),
    ):
        assert other == phantom
    assert tables["probe"] == {"radius_mm": 6.5, "length_mm": 30.0}
    tables["inclusion"][0]["centre_x_mm"] = np.float64(2.5)
    assert palpate.Phantom.from_dict(tables) == phantom.edited(inclusion_centre_x_mm=2.5) != phantom
    layers = palpate.Phantom.from_toml(ROOT / "docs/phantoms/layers.toml")
    assert palpate.Phantom.from_dict(layers.to_dict()) == layers


def test_keywords_change_numbers(phantom):
    other = palpate.Phantom("6.6", layer_1_youngs_modulus_kpa=8, probe_radius_mm=5, name="mine", inclusion_0_diameter_mm=4)
    tables = other.to_dict()
    assert (tables["layer"][1]["youngs_modulus_kpa"], tables["probe"]["radius_mm"]) == (8, 5)
    assert (other.name, tables["inclusion"][0]["diameter_mm"]) == ("mine", 4)
    for edits, message in [
        ({"layer_thickness_mm": 3}, "layer_thickness_mm: the phantom has 2 of these; say which, from 0, as in layer_0_thickness_mm"),
        ({"layer_2_thickness_mm": 3}, "has 2 of these"),
        ({"layer_gel_youngs_modulus_kpa": 3}, "say which, from 0, as in layer_0_youngs_modulus_kpa"),
        ({"probe_radius_m": 3}, "probe.radius_m"),
        ({"colour": "red"}, "colour"),
        ({"probe_radius_mm": "5"}, "probe.radius_mm"),
        ({"probe_radius_mm": -5}, "probe.radius_mm = -5"),
        ({"probe_radius_mm": math.nan}, "probe_radius_mm = NaN, but must be a finite number"),
        ({"inclusion_depth_mm": None}, ""),
        ({"inclusion_depth_mm": 30}, "inclusion[0].depth_mm = 30"),
    ]:
        with pytest.raises(palpate.Refused) as error:
            phantom.edited(**edits)
        assert message in str(error.value) and "\n" not in str(error.value)


def test_refusals_have_the_words_of_the_program(phantom, tmp_path):
    with pytest.raises(palpate.Refused, match='^no phantom named "7" is built in; built in are none, 2.6, 4.6, 6.6, 8.6$'):
        palpate.Phantom("7")
    with pytest.raises(palpate.Refused, match='^depth 3.0 mm is not in the map; give one of 1.0, 2.0 mm$'):
        phantom.map([1, 2], [0], **COARSE).row(3)
    with pytest.raises(palpate.Refused, match=r"^depths_mm\[1\] = 1, but must be more than 2, the one before it$"):
        phantom.map([2, 1], [0], **COARSE)
    with pytest.raises(TypeError, match='^name is 6.6, but must be a text, such as "6.6"$'):
        palpate.Phantom(6.6)
    for call in (
        lambda: phantom.solve(depth_mm=-1),
        lambda: phantom.solve(depth_mm=math.nan),
        lambda: phantom.solve(depth_mm=math.inf),
        lambda: phantom.solve(depth_mm=1e308),
        lambda: phantom.solve(depth_mm=4, lateral_mm=15),
        lambda: phantom.solve(depth_mm=4, mesh_mm=0),
        lambda: phantom.solve(depth_mm=4, mesh_mm=math.nan),
        lambda: phantom.solve(depth_mm=4, mesh_mm=1e-6),
        lambda: phantom.solve(depth_mm=4, contact="glued"),
        lambda: phantom.map([], [0], **COARSE),
        lambda: phantom.map([1], [], **COARSE),
        lambda: phantom.map([2, 1], [0], **COARSE),
        lambda: phantom.map([1], [0, math.nan], **COARSE),
        lambda: palpate.Phantom.from_toml("a = \n"),
        lambda: palpate.Phantom.from_toml(tmp_path / "nowhere.toml"),
        lambda: palpate.Phantom.from_dict({}),
        lambda: palpate.Phantom.from_dict({"name": float("inf")}),
        lambda: palpate.ForceMap.read(tmp_path / "nowhere.json"),
        lambda: palpate.ForceMap([1], [0], [[math.nan]], [[1]]),
        lambda: palpate.ForceMap([1], [0], [[1, 2]], [[1]]),
        lambda: palpate.ForceMap([1], [0], [1], [1]),
        lambda: palpate.ask("no such op"),
        lambda: palpate.ask("two_afc", gamma=math.nan),
    ):
        with pytest.raises(palpate.Refused) as error:
            call()
        assert isinstance(error.value, ValueError)
        text = str(error.value)
        assert text and "\n" not in text


def test_maps_are_written_and_read(force_map, phantom, tmp_path):
    for name in ("map.json", "map.csv"):
        force_map.write(tmp_path / name)
        again = palpate.ForceMap.read(tmp_path / name)
        assert (again == force_map) == (name == "map.json")
        for of in ("depths_mm", "laterals_mm", "lateral_n", "normal_n"):
            assert np.array_equal(getattr(again, of), getattr(force_map, of))
    written = json.loads((tmp_path / "map.json").read_text())
    assert written["normal_force_n"] == force_map.normal_n.tolist()
    assert written["certificate"] == force_map.certificate
    assert force_map.certificate["mesh_size_m"] == 0.002
    assert force_map.phantom == phantom
    measured = palpate.ForceMap(force_map.depths_mm, force_map.laterals_mm, force_map.lateral_n, force_map.normal_n)
    assert measured.certificate is None and measured.phantom is None
    assert np.array_equal(measured.normal_n, force_map.normal_n) and np.array_equal(measured.lateral_n, force_map.lateral_n)


def test_a_map_may_lack_the_lateral_force(force_map, tmp_path):
    one = palpate.ForceMap(force_map.depths_mm, force_map.laterals_mm, None, force_map.normal_n)
    one.write(tmp_path / "one.csv")
    for of in (one, palpate.ForceMap.read(tmp_path / "one.csv")):
        assert of.lateral_n is None and np.array_equal(of.normal_n, force_map.normal_n)
        assert np.array_equal(of.sweep(2, of.laterals_mm), force_map.row(2)[1])
        for needs_both in (lambda: of.row(2), lambda: of.force(2, 0)):
            with pytest.raises(palpate.Refused, match="no lateral forces, which are needed here; give a map with both"):
                needs_both()


def test_forces_between_and_beyond_the_poses(force_map):
    assert force_map.lateral_n.shape == (3, 5)
    assert np.array_equal(force_map.row(2), [force_map.lateral_n[1], force_map.normal_n[1]])
    assert np.array_equal(force_map.sweep(2, force_map.laterals_mm), force_map.row(2))
    assert force_map.sweep(2, []).shape == (2, 0)
    assert np.allclose(force_map.sweep(3, [1.5])[:, 0], np.mean([force_map.row(d)[:, c] for d in (2, 4) for c in (2, 3)], axis=0))
    table = dict(depths_m=[0.001, 0.002, 0.004], laterals_m=[-0.006, -0.003, 0.0, 0.003, 0.006])
    depth, lateral = np.array([[1.0], [1.7], [4.0]]), np.array([-6.0, -2.5, 1.25, 6.0])
    found = force_map.force(depth, lateral)
    for of, forces in zip(found, (force_map.lateral_n, force_map.normal_n)):
        assert of.shape == (3, 4)
        for row, d in enumerate(depth[:, 0]):
            for column, x in enumerate(lateral):
                asked = palpate.ask("interpolate", table_n=forces, depth_m=d / 1000, lateral_m=x / 1000, **table)
                assert math.isclose(of[row, column], asked["force_n"], rel_tol=1e-12, abs_tol=1e-14)
    assert isinstance(force_map.force(1, 0)[1], float)
    for call in (
        lambda: force_map.row(3),
        lambda: force_map.sweep(5, [0]),
        lambda: force_map.sweep(2, [0, 6.1]),
        lambda: force_map.force(math.nan, 0),
        lambda: force_map.force(4.1, 0),
        lambda: force_map.force(0.5, 6.1),
        lambda: palpate.ServoTable(force_map).force(4.1, 0),
        lambda: palpate.ServoTable(force_map).force(2, -6.1),
        lambda: force_map.force(1, [0, math.inf]),
    ):
        with pytest.raises(palpate.Refused):
            call()


# PYT-040.
def test_there_is_no_force_in_air_and_a_line_to_the_first_depth(force_map):
    table = palpate.ServoTable(force_map)
    for depth, share in ((-1, 0), (0, 0), (0.5, 0.5), (1, 1)):
        for lateral in (-6, 3):
            expected = share * force_map.row(1)[:, force_map.laterals_mm.tolist().index(lateral)]
            assert np.allclose(force_map.force(depth, lateral), expected, rtol=1e-12, atol=0)
            # Single precision.
            assert np.allclose(table.force(depth, lateral), expected, rtol=1e-6, atol=0)
    assert force_map.force(-3, 99) == (0, 0)
    # A measured map may begin at the surface, with a force there: 0.015 N.
    measured = palpate.ForceMap([0, 1], [-1, 1], np.zeros((2, 2)), [[0.015, 0.015], [0.3, 0.3]])
    for of_pose in (measured.force, palpate.ServoTable(measured).force):
        assert np.allclose(of_pose(0, 0), [0, 0.015], rtol=1e-6, atol=0)


# PYT-056.
def test_a_map_is_certified(phantom):
    told = []
    plain = phantom.map([3], [0, 3])
    found = phantom.map([3], [0, 3], certify=True, progress=lambda *numbers: told.append(numbers))
    assert np.array_equal(found.normal_n, plain.normal_n) and told == [(n, 6) for n in range(1, 7)]
    bands = found.certificate["discretization"]
    assert np.shape(bands["normal_force_band_n"]) == np.shape(bands["lateral_force_band_n"]) == (1, 2)
    assert bands["nodes"][0] == plain.certificate["nodes"] > bands["nodes"][1] > bands["nodes"][2]
    # The band holds the difference from a mesh of a third of the size.
    fine = phantom.solve(3, [0, 3], mesh_mm=0.17)[1]
    assert np.all(np.abs(fine - found.normal_n[0]) < bands["normal_force_band_n"][0]) and "discretization" not in plain.certificate
    with pytest.raises(palpate.Refused, match="too much alike"):
        phantom.map([3], [0, 3], certify=True, **COARSE)


# PYT-055.
def test_the_deformed_mesh_is_written(phantom, tmp_path):
    path = tmp_path / "pressed.vtu"
    phantom.write_vtu(path, depth_mm=4, lateral_mm=1, **COARSE)
    arrays = {of.get("Name"): np.array(of.text.split(), float).reshape(-1, int(of.get("NumberOfComponents", 1))) for of in ElementTree.parse(path).iter("DataArray")}
    points, moved = arrays["position_m"], arrays["displacement_m"]
    assert points.shape == moved.shape and len(points) > 100
    # Nothing is in the probe, a circle of 6.5 mm, and the gel touches it but for a micrometre; the floor stays.
    distance = np.hypot(*(points[:, :2] - (1e-3, (6.5 - 4) * 1e-3)).T)
    assert abs(distance.min() - 6.5e-3) < 1e-6 and points[:, 1].min() == -1e-3 * phantom.height_mm
    assert (abs(distance - 6.5e-3) < 1e-6).sum() > 5 and not moved[:, 2].any()
    for call in (lambda: phantom.write_vtu(path, 40), lambda: phantom.write_vtu(path, 4, contact="glued")):
        with pytest.raises(palpate.Refused):
            call()


# PYT-042.
def test_metres_are_doubted(phantom, tmp_path):
    one = [[1.0, 1.0], [1.0, 1.0]]
    for call, name in (
        (lambda: phantom.solve(0.004, **COARSE), "depth_mm is at most 0.004 mm"),
        (lambda: phantom.write_vtu(tmp_path / "deformed.vtu", 0.004, **COARSE), "depth_mm is at most 0.004 mm"),
        (lambda: palpate.ForceMap([0, 2], [-8, 8], one, one).force([0.001, 0.002], 0), "depth_mm is at most 0.002 mm"),
        (lambda: palpate.ForceMap([0, 2], [-8, 8], one, one).sweep(0.002, [0, 1]), "depth_mm is at most 0.002 mm"),
        (lambda: palpate.ServoTable(palpate.ForceMap([1, 2], [-8, 8], one, one)).force(0.002, 0), "depth_mm"),
        (lambda: palpate.ForceMap([0.001, 0.002], [-8, 8], one, one), "depths_mm"),
        (lambda: palpate.ForceMap([1, 2], [-0.008, 0.008], one, one), "laterals_mm"),
        (lambda: phantom.map([0.001, 0.004], [0, 1], **COARSE), "depths_mm"),
        (lambda: palpate.Bank.build(phantom, 4, [-0.004, 0, 0.004], offsets_mm=[0], **COARSE), "laterals_mm"),
        (lambda: palpate.Bank.build(phantom, 4, [-4, 0, 4], offsets_mm=[-0.002, 0, 0.002], **COARSE), "offsets_mm"),
        (lambda: palpate.calibrate(np.linspace(0, 0.004, 30), np.linspace(0, 1, 30) ** 2, mesh_mm=2), "depths_mm"),
    ):
        with pytest.warns(UserWarning, match=name):
            call()


# PYT-010.
@pytest.mark.parametrize(
    "call",
    [
        "palpate.Phantom('6.6').solve(4, 1, mesh_mm=0.13)",
        "palpate.Phantom('6.6').solve(np.linspace(3, 4, 3000), 1, mesh_mm=1)",
        "palpate.simulate_theta(z, z + 0.01, 0.1, True, 20_000_000)",
        "palpate.theta_coloured(np.ones((2, 900)), np.ones((2, 900)), np.eye(1800))",
    ],
)
def test_control_c_ends_every_long_call(call):
    program = (
        "import _thread, signal, threading, time, numpy as np, palpate; z = np.zeros((2, 161)); t = [0.0]\n"
        # In the background of a shell Python ignores it.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "def stop(): t[0] = time.monotonic(); _thread.interrupt_main()\n"
        f"threading.Timer(0.3, stop).start()\ntry: {call}\nexcept KeyboardInterrupt: print(time.monotonic() - t[0])"
    )
    waited = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    # Each takes 3 s and more to its end; a call looks every 50 ms, or for 2^23 samples.
    assert waited and float(waited) < 1.5, (call, waited)


def test_progress_counts_the_poses(phantom):
    told = []
    phantom.map([1, 2], [-3, 0, 3, 6], progress=lambda *numbers: told.append(numbers), **COARSE)
    # The map at -3 mm is the mirror image of that at 3 mm.
    assert told == [(2, 6), (4, 6), (6, 6)]


@pytest.mark.parametrize("raised", [ZeroDivisionError, KeyboardInterrupt, SystemExit])
def test_what_the_callback_raises_stops_the_solve(phantom, raised):
    told = []

    def progress(done, all):
        told.append(done)
        if done >= 4:
            raise raised("enough")

    with pytest.raises(raised, match="enough"):
        phantom.map([1, 2], [0, 1, 2, 3, 4], progress=progress, **COARSE)
    assert told == [2, 4]
    told.clear()
    with pytest.raises(raised, match="enough"):
        palpate.Bank.build(phantom, 4, [-4, 0, 4], offsets_mm=np.arange(20) / 4, progress=progress, **COARSE)
    assert told[-1] < 20


def test_control_c_stops_a_solve_without_a_callback(phantom):
    # In the background of a shell Python ignores it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    depths = np.linspace(0.1, 4, 100)
    start = time.monotonic()
    phantom.map(depths, np.linspace(0, 9, 20), **COARSE)
    of_20 = time.monotonic() - start
    timer = threading.Timer(of_20, _thread.interrupt_main)
    timer.start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        phantom.map(depths, np.linspace(0, 9, 300), **COARSE)
    # All of them would take fifteen times as long.
    assert time.monotonic() - start < 7 * of_20


def test_other_threads_run_during_a_solve(phantom):
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.wait(0.001):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    phantom.solve(depth_mm=4, mesh_mm=0.3)
    end = time.monotonic()
    stop.set()
    thread.join()
    during = [t for t in ticks if start < t < end]
    gaps = np.diff([start, *during, end])
    # A call that keeps the interpreter's lock lets no other thread run for all of its time.
    assert end - start > 0.05 and gaps.max() < 0.5 * (end - start), (end - start, gaps.max())


def test_two_threads_solve_at_the_same_time(phantom):
    found = {}

    def solve(lateral):
        found[lateral] = phantom.solve(depth_mm=3, lateral_mm=lateral, **COARSE).normal_n

    threads = [threading.Thread(target=solve, args=(lateral,)) for lateral in (-2, 0, 2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found[-2] == found[2] < found[0]

"""Measured forces at any poses. Checks PYT-053."""

import json

import numpy as np
import palpate
import pytest

RNG = np.random.default_rng(7)
# 0.2 mm and 0.4 mm about a grid of 1 and 2 mm, each pose ten times.
GRID = np.array([(depth, lateral) for depth in (1.0, 2.0, 3.0) for lateral in np.arange(-8, 9, 2.0)] * 10)
SAMPLES = GRID + RNG.uniform(-1, 1, GRID.shape) * (0.2, 0.4)


def forces(poses):
    """A plane, which planes fit wherever the samples are: lateral and normal."""
    depth, lateral = poses.T
    return np.array([0.05 * lateral, 0.4 * depth + 0.02 * lateral])


def test_a_plane_is_found_on_the_grid():
    found, told = palpate.import_map(*SAMPLES.T, forces(SAMPLES), grid_mm=(1, 2), note="mine", phantom=palpate.Phantom("6.6"))
    assert found.depths_mm.tolist() == [1, 2, 3] and found.laterals_mm.tolist() == np.arange(-8, 9, 2).tolist()
    expected = forces(GRID[:27]).reshape(2, 3, 9)
    # Sums of some thirty terms of 1 N.
    assert np.allclose([found.lateral_n, found.normal_n], expected, rtol=0, atol=1e-12)
    assert (found.note, found.phantom, found.certificate) == ("mine", palpate.Phantom("6.6"), None)
    assert np.allclose(told["largest_shift_mm"], abs(SAMPLES - GRID).max(axis=0), rtol=1e-9)
    assert np.allclose(told["residual_n"], 0, atol=1e-12)
    assert told["noise_sd_n"] is told["degrees_of_freedom"] is None
    source = json.loads(found.to_json())["source"]
    assert source["grid_m"] == [0.001, 0.002] and "smoothed_half_width_m" not in source
    one, told = palpate.import_map(*SAMPLES.T, forces(SAMPLES)[1], grid_mm=(1, 2))
    assert one.lateral_n is None and np.array_equal(one.normal_n, found.normal_n) and told["residual_n"][0] is None
    square, _ = palpate.import_map([2, 4, 2, 4], [0, 0, 2, 2], [1, 2, 3, 4], grid_mm=2)
    assert square.normal_n.tolist() == [[1, 3], [2, 4]]


def test_smoothing_tells_the_noise():
    lateral = np.linspace(-8, 8, 201)
    bow = 1 - 0.01 * lateral**2
    noise = RNG.normal(0, 0.05, lateral.shape)
    found, told = palpate.import_map(0 * lateral + 2, lateral, bow + noise, grid_mm=(1, 0.08), smooth_mm=2)
    _, sd = told["noise_sd_n"]
    # 4 standard deviations of an estimate of that many degrees of freedom.
    assert abs(sd / 0.05 - 1) < 4 / np.sqrt(2 * told["degrees_of_freedom"]) and 150 < told["degrees_of_freedom"] < 201
    assert np.std(found.normal_n[0] - bow) < 0.6 * 0.05
    assert json.loads(found.to_json())["source"]["smoothed_half_width_m"] == 0.002


def test_samples_that_make_no_map_are_refused():
    depths, laterals = SAMPLES.T
    normal = forces(SAMPLES)[1]
    nan = np.where(np.arange(normal.size) == 5, np.nan, normal)
    for message, arguments, options in (
        (r"^forces_n\[5\] is NaN", (depths, laterals, nan), {}),
        (r"^depths_mm, laterals_mm and forces_n have \[270, 269, 270\] samples; give", (depths, laterals[1:], normal), {}),
        ("^grid_mm = 0, but must be finite and greater than 0", (depths, laterals, normal), {"grid_mm": (1, 0)}),
        ("choose a coarser grid", (depths, laterals, normal), {"grid_mm": 0.01}),
        ("^smooth_mm = -1, but must be", (depths, laterals, normal), {"smooth_mm": -1}),
        ("^3 lateral positions are within 2.0 mm of -8.0 mm; choose a half-width", (depths, laterals, normal), {"smooth_mm": 2}),
        ("lateral", (depths, laterals, normal), {"phantom": palpate.Phantom("6.6", well_width_mm=16)}),
    ):
        with pytest.raises(palpate.Refused, match=message):
            palpate.import_map(*arguments, **{"grid_mm": (1, 2), **options})
    with pytest.warns(UserWarning, match="laterals_mm is at most 0.008 mm"):
        palpate.import_map(GRID.T[0], GRID.T[1] / 1000, normal, grid_mm=(1, 0.002))

"""A force-depth curve as arrays. Checks PYT-031, PYT-049."""

import numpy as np
import palpate
import pytest


def curve(stiffer, mesh_mm):
    """A gel `stiffer` than the paper's, touched at 1 mm by a sensor with an offset; 2 mN of noise."""
    gel = palpate.Phantom("none", layer_1_youngs_modulus_kpa=5.0 * stiffer)
    depths = np.linspace(0, 4, 161)
    below = depths[depths > 1.0001] - 1
    forces = np.zeros(depths.shape)
    forces[depths > 1.0001] = gel.map(below, [0.0], mesh_mm=mesh_mm).normal_n[:, 0]
    return depths, forces + 0.2 + 2e-3 * np.random.default_rng(3).standard_normal(depths.shape)


def test_the_modulus_of_a_layer_is_found():
    depths, forces = curve(1.4, 0.8)
    found = palpate.calibrate(depths, forces, phantom=palpate.Phantom("none"), layers=[1], mesh_mm=1)
    assert found["cause"] is None
    low, high = found["contact"]["interval"]
    assert low < 1e-3 < high and high - low < 1e-4
    [modulus] = found["youngs_modulus"]
    assert abs(modulus["estimate"] / 7000 - 1) < 0.03 and modulus["unit"] == "Pa"
    assert found["phantom"] == palpate.Phantom("none", layer_1_youngs_modulus_kpa=modulus["estimate"] / 1e3)


def test_a_curve_of_air_has_no_estimate():
    depths = np.linspace(0, 4, 100)
    found = palpate.calibrate(depths, np.sin(np.arange(100) ** 2), depths, phantom=palpate.Phantom("none"))
    assert (found["cause"], found["contact"], found["phantom"]) == ("no_contact", None, None)


def test_a_curve_that_begins_in_the_gel_says_what_to_do():
    depths = np.linspace(1, 4, 150)
    found = palpate.calibrate(depths, 0.1 * depths**2 + 2e-3 * np.random.default_rng(4).standard_normal(150))
    assert found["cause"] == "no_air" and found["remedy"].endswith("begin it higher, or say where the probe touches")


def test_what_is_no_curve_is_refused():
    with pytest.raises(palpate.Refused, match="^curve: the probe does not move into the gel; give a curve into the gel, on which the depth grows$"):
        palpate.calibrate(np.zeros(30), np.zeros(30))
    for options in ({"layers": [0]}, {"lateral_mm": 3}):
        with pytest.raises(palpate.Refused, match="^layers and lateral_mm need a phantom$"):
            palpate.calibrate(*curve(1, 1.5), **options)
    with pytest.raises(palpate.Refused, match="layer = 9, but must be below 2"):
        palpate.calibrate(*curve(1, 1.5), phantom=palpate.Phantom("none"), layers=[9], mesh_mm=2)

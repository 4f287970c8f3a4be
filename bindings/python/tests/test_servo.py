"""The servo kernel. Checks PYT-002, PYT-005."""

import math

import numpy as np
import palpate
import pytest

DEPTHS, LATERALS = np.array([1.0, 2.0, 4.0]), np.array([-3.0, 0.0, 3.0])
NORMAL = np.outer(DEPTHS, [0.3, 0.5, 0.3])
LATERAL = np.outer(DEPTHS, [-0.1, 0.0, 0.1])


@pytest.fixture
def table():
    return palpate.ServoTable(palpate.ForceMap(DEPTHS, LATERALS, LATERAL, NORMAL))


def test_the_force_is_that_of_the_map_in_single_precision(table):
    for row, depth in enumerate(DEPTHS):
        for column, lateral in enumerate(LATERALS):
            expected = np.float32(LATERAL[row, column]), np.float32(NORMAL[row, column])
            assert table.force(depth, lateral) == expected
    # Half way to the surface, which the map does not hold; nothing above it.
    lateral, normal = table.force(0.5, 3.0)
    assert math.isclose(normal, 0.15, rel_tol=1e-6) and math.isclose(lateral, 0.05, rel_tol=1e-6)
    assert table.force(-1.0, 0.0) == (0.0, 0.0)
    # Steepest at x = 0, a cell below the table, 6 mm: forces d (0.5 - x/15) and d x/30, and their slopes in N/m.
    slopes = [[1000 * 6 / 30, 0], [1000 * 6 / 15, 1000 * 0.5]]
    assert math.isclose(table.stiffness_n_per_m, np.linalg.norm(slopes, 2), rel_tol=1e-6)
    for wrong in (math.nan, math.inf, 1e300):
        with pytest.raises(palpate.Refused):
            table.force(wrong, 0.0)
    with pytest.raises(palpate.Refused, match="normal_force_n"):
        palpate.ServoTable(palpate.ForceMap(DEPTHS, LATERALS, LATERAL, 1000 * NORMAL))


def test_a_controller_is_armed_plays_and_stops(table):
    limits = palpate.Limits(2.0, 0.05, 0.25, 10)
    sample = lambda sequence, deadman: palpate.Sample(sequence, 2.0, 0.0, deadman)
    state, force, playing = palpate.step(table, limits, palpate.ServoState(), sample(1, False))
    assert (state.mode, force, playing) == ("disarmed", [0.0, 0.0], False)
    state, *_ = palpate.step(table, limits, state, sample(2, False), "arm")
    assert state.mode == "armed" and state.fault is None
    for cycle in range(3, 40):
        state, force, playing = palpate.step(table, limits, state, sample(cycle, True))
        # 1 N at 2 mm, and 0.05 N of it in each cycle.
        assert playing and force[1] == pytest.approx(min(1.0, 0.05 * (cycle - 2)), rel=1e-6)
    assert state.force_n == [0.0, 1.0]
    state, *_ = palpate.step(table, limits, state)
    assert state.missed == 1 and state.mode == "armed"
    state, *_ = palpate.step(table, limits, state, palpate.Sample(41, math.nan, 0.0, True))
    assert state.mode == "faulted" and "finite" in state.fault
    with pytest.raises(palpate.Refused, match="request"):
        palpate.step(table, limits, state, request="go")
    with pytest.raises(palpate.Refused, match="force limit"):
        palpate.Limits(math.nan, 0.05, 0.25, 10)
    with pytest.raises((palpate.Refused, OverflowError)):
        palpate.Sample(70000, 2.0, 0.0, True)

"""How deep and how small an inclusion may be. Checks PYT-054."""

from statistics import NormalDist

import numpy as np
import palpate
import pytest

X = np.arange(-8, 9.0)
DEPTHS, DIAMETERS = [2.6, 3.6, 4.6], [4.0, 6.0]


@pytest.fixture(scope="module")
def bank():
    return palpate.Bank.build(palpate.Phantom("6.6"), [2, 3], X, offsets_mm=[1, 4], depths_mm=DEPTHS, diameters_mm=DIAMETERS, mesh_mm=2)


def gamma(bank, diameter, depth, sd, nuisances, sweep):
    """By least squares: the length of what the nuisances leave of the template."""
    # At the position nearest to 0, the first of two.
    signal = (sweep(bank.maps[(diameter * len(DEPTHS) + depth) * 2]) - sweep(bank.reference)).ravel() / sd
    columns = np.array(nuisances).reshape(-1, signal.size).T / sd
    return np.linalg.norm(signal - columns @ np.linalg.lstsq(columns, signal, rcond=None)[0])


def test_gamma_and_limits_are_those_of_least_squares(bank):
    def sweep(of):
        return of.sweep(3, X)

    f0, zero, line = sweep(bank.reference), np.zeros(17), np.linspace(-1, 1, 17)
    offsets_drifts_gain = [[zero + 1, zero], [zero, zero + 1], [line, zero], [zero, line], f0]
    needed = NormalDist().inv_cdf(1 - 0.01 / 12) + NormalDist().inv_cdf(0.95)
    answers = []
    for unknown, nuisances in (((), []), (("offset", "drift", "gain"), offsets_drifts_gain)):
        answer = palpate.reach(bank, noise_sd_n=0.05, unknown=unknown)
        # Quantiles of six digits and more.
        assert np.isclose(answer["gamma_needed"], needed, rtol=1e-9)
        for number, row in enumerate(answer["largest_depths"]):
            expected = [gamma(bank, number, depth, 0.05, nuisances, sweep) for depth in range(3)]
            assert np.allclose(row["gamma"], expected, rtol=1e-9) and row["diameter_mm"] == DIAMETERS[number]
            answers.append((expected, row["largest_depth_mm"], row["is_beyond_bank"]))
        for number, row in enumerate(answer["smallest_diameters"]):
            gammas = [of["gamma"][number] for of in answer["largest_depths"]]
            assert row["depth_mm"] == DEPTHS[number] and row["youngs_modulus_kpa"] == 1200
            expected = 4.0 if gammas[0] >= needed else np.interp(np.log(needed), np.log(gammas), DIAMETERS) if gammas[1] >= needed else None
            assert row["is_beyond_bank"] == (gammas[0] >= needed)
            assert row["smallest_diameter_mm"] == (expected and pytest.approx(expected, rel=1e-9))
    kinds = set()
    for gammas, depth, beyond in answers:
        enough = sum(of >= needed for of in gammas)
        expected = None if enough == 0 else 4.6 if enough == 3 else np.interp(-np.log(needed), -np.log(gammas), DEPTHS)
        assert depth == (expected and pytest.approx(expected, rel=1e-9)) and beyond == (enough == 3)
        kinds.add(enough)
    assert kinds == {0, 1, 3}, kinds


def test_along_a_path_and_beside_classes(bank):
    x, depths = np.hstack([X, X[::-1]]), np.repeat([2.0, 3.0], 17)

    def sweep(of):
        return np.hstack([of.sweep(2, X), of.sweep(3, X[::-1])])

    answer = palpate.reach(bank, (0.1, 0.1), unknown=[], positions_mm=x, depths_mm=depths, classes=True)
    for number, row in enumerate(answer["largest_depths"]):
        assert np.allclose(row["gamma"], [gamma(bank, number, depth, 0.1, [], sweep) for depth in range(3)], rtol=1e-9)
        # Beside what may be there, less of the signal counts.
        assert len(row["classes"]) > 3
        for of_class in row["classes"].values():
            assert 0 < of_class[0] <= row["gamma"][0]
    assert min(of[0] for of in palpate.reach(bank, 0.1, classes=True)["largest_depths"][0]["classes"].values()) > 0


def test_questions_that_make_no_sense_are_refused(bank):
    for message, options in (
        (r"positions_mm\[0\] = -9", {"positions_mm": X - 1}),
        ("give both", {"depths_mm": [3.0]}),
        ("^unknown = colour, but must be one of offset", {"unknown": "colour"}),
        ("^unknown = variance", {"unknown": ["gain", "variance"]}),
        ("noise_sd_n", {"noise_sd_n": 0}),
        ("^max_miss = 0, but must be above 0 and below 1$", {"max_miss": 0}),
        ("^path:1: position -8.0 mm at a depth of 3.5 mm .* leave it out$", {"positions_mm": X, "depths_mm": 0 * X + 3.5}),
        ("depths", {"positions_mm": X, "depths_mm": [3.0]}),
    ):
        with pytest.raises(palpate.Refused, match=message):
            palpate.reach(bank, **{"noise_sd_n": 0.1, **options})

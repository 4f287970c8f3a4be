"""Banks and counts of answers. Checks PYT-002, PYT-005, PYT-010, PYT-032, PYT-041, PYT-049."""

import json
import math

import numpy as np
import palpate
import pandas as pd
import pytest


@pytest.fixture(scope="module")
def bank():
    return palpate.Bank.build(
        palpate.Phantom("6.6"), 4, np.arange(-8, 9.0), offsets_mm=[-4, -2, 0, 2, 4], depths_mm=[4.6, 5.6, 6.6], mesh_mm=1
    )


def noisy(forces, sd=0.05):
    return forces + sd * np.random.default_rng(1).standard_normal(forces.shape)


def test_a_bank_is_built_written_and_read(bank, tmp_path):
    assert (bank.probe_depth_mm, len(bank.maps)) == (4, 15)
    assert bank.axes == {
        "position_mm": [-4, -2, 0, 2, 4],
        "depth_mm": [4.6, 5.6, 6.6],
        "diameter_mm": [6.4],
        "youngs_modulus_kpa": [1200],
    }
    bank.write(tmp_path / "bank.json")
    again = palpate.Bank.read(tmp_path / "bank.json")
    assert again.maps == bank.maps and again.reference == bank.reference
    assert palpate.Bank(bank.reference, bank.maps[::-1]).maps == bank.maps
    with pytest.raises(palpate.Refused, match="maps"):
        palpate.Bank(bank.reference, bank.maps[:-1])
    with pytest.raises(palpate.Refused):
        palpate.Bank.read(tmp_path / "nowhere.json")


def test_an_inclusion_is_found_where_it_is(bank):
    x = np.linspace(-8, 8, 161)
    truth = palpate.Phantom("6.6", inclusion_centre_x_mm=1, inclusion_depth_mm=5.2)
    forces = truth.map([4], np.arange(-8, 9.0), mesh_mm=1).sweep(4, x)
    found = bank.locate(x, noisy(forces), noise_sd_n=0.05, unknown=["offset"], white=True)
    assert found["inclusion"] is True and found["posterior_h1"] > 0.999 and not found["causes"]
    for name, value in (("position_mm", 1), ("depth_mm", 5.2)):
        low, high = found["interval_95"][name]
        # A known seed; the interval holds the truth, and is narrower than the bank.
        assert low < value < high and high - low < 1.5, (name, low, high)
        assert low < found["mean"][name] < high
    places, probabilities = found["places"], found["probabilities"]
    assert places.shape == (len(probabilities), 4) and math.isclose(probabilities.sum(), 1, rel_tol=1e-9)
    assert math.isclose(places[:, 0] @ probabilities, found["mean"]["position_mm"], rel_tol=1e-9)
    nothing = bank.locate(x, noisy(bank.reference.sweep(4, x)), noise_sd_n=0.05, unknown=[], white=True)
    assert nothing["inclusion"] is False and nothing["posterior_h1"] < 0.01


# PYT-041.
def test_places_have_the_columns_of_the_axes(bank):
    x = np.linspace(-8, 8, 161)
    # A bank of three depths: at this noise the likeliest place is often at the end of an axis.
    ends = 0
    for seed in range(20):
        noise = 0.5 * np.random.default_rng(seed).standard_normal((2, 161))
        found = bank.locate(x, bank.maps[7].sweep(4, x) + noise, noise_sd_n=0.5, unknown="offset", white=True)
        mean = pd.DataFrame(found["places"], columns=list(bank.axes)).mul(found["probabilities"], axis=0).sum()
        for name in bank.axes:
            assert list(found["estimate"]) == list(found["interval_95"]) == list(bank.axes)
            assert math.isclose(mean[name], found["mean"][name], rel_tol=1e-9, abs_tol=1e-9), name
            low, high = found["interval_95"][name]
            estimate = found["estimate"][name]
            ends += (low is None) + (high is None)
            assert (low is None or low <= estimate) and (high is None or estimate <= high), (seed, name)
            # An end is missing only where the inclusion may well be on that side.
            nearer = found["places"][:, list(bank.axes).index(name)] <= np.mean(bank.axes[name])
            assert low is not None or found["probabilities"][nearer].sum() > 0.02, (seed, name)
    assert ends > 3


def test_another_unit_sign_or_width_has_no_answer_but_a_cause(bank):
    x = np.linspace(-8, 8, 161)
    gel = noisy(bank.reference.sweep(4, x))
    for positions, forces, cause, cure in (
        (x, 1000 * gel, "force_unit", "give N and mm"),
        (x, 102 * gel, "force_unit", "give N and mm"),
        (x, -gel, "sign", "reverse it"),
        (x / 1000, gel, "narrow", "check the unit of the positions"),
    ):
        for found in (bank.locate(positions, forces), bank.judge(positions, forces)):
            assert found["inclusion"] is None and found["posterior_h1"] is None and cause in found["causes"], (cause, found)
            assert len(found["reasons"]) == len(found["causes"]) and cure in found["reasons"][found["causes"].index(cause)]
    watcher = palpate.Watcher(bank, noise_sd_n=0.05)
    found = [watcher.push(*sample) for sample in zip(x, 0 * x)][-1]
    assert found["causes"][0] == "no_contact" and "check that the probe touches" in found["reasons"][0]
    assert bank.judge(x, gel)["reasons"] == []


def test_an_inclusion_is_judged_whatever_the_gel_does(bank):
    x = np.linspace(-8, 8, 161)
    gel = bank.reference.sweep(4, x)
    bowed = gel - [[0], [1]] * (0.25 * (x / 8) ** 2)
    # To the exact model the bow is an inclusion; the robust one does not fall for it.
    assert bank.locate(x, noisy(bowed), noise_sd_n=0.05, white=True)["inclusion"] is True
    assert bank.judge(x, noisy(bowed), noise_sd_n=0.05)["inclusion"] is not True
    disc = bank.maps[7].sweep(4, x)
    found = bank.judge(x, noisy(disc, 0.02), noise_sd_n=0.02, known=["gel", "support", "smooth"])
    assert found["inclusion"] is True and found["model"] == "robust", found
    assert found["position"]["interval"][0] < 0 < found["position"]["interval"][1]
    assert bank.judge(x, noisy(disc, 0.02), noise_sd_n=0.02, known="all")["inclusion"] is True
    assert bank.judge(x, noisy(disc), known="none") == bank.judge(x, noisy(disc))
    # More noise than was stated.
    assert bank.judge(x, noisy(disc), noise_sd_n=0.02)["causes"] == ["misfit"]
    # A sensor of one force.
    one = bank.judge(x, noisy(disc, 0.02)[1], noise_sd_n=0.02, known=["gel", "support", "smooth"])
    assert one["inclusion"] is True and one["noise_sd_lateral_n"] is None, one
    one = bank.locate(x, noisy(disc)[1], noise_sd_n=0.02, white=True)
    assert one["inclusion"] is True and one["noise_sd_lateral_n"] is None, one
    assert one["gamma"] < bank.locate(x, noisy(disc), noise_sd_n=0.02, white=True)["gamma"]
    assert bank.judge(x, noisy(gel), zeroed=True)["inclusion"] is None
    # In air a sensor that was set to zero on the gel would record the same.
    exact = bank.locate(x, noisy(0 * gel), noise_sd_n=0.05, white=True, zeroed=True)
    assert exact["inclusion"] is None and exact["causes"] == ["zeroed"] and exact["posterior_h1"] < 0.5
    watcher = palpate.Watcher(bank, noise_sd_n=0.05, zeroed=True)
    found = [watcher.push(*sample) for sample in zip(x, noisy(0 * gel)[1])][-1]
    assert found["decision"] is None and found["excluded"] == 0, found
    assert bank.judge(x, 1000 * gel)["causes"] == ["force_unit"]
    with pytest.raises(palpate.Refused, match="known"):
        bank.judge(x, gel, known=["moon"])
    with pytest.raises(palpate.Refused):
        bank.judge(x, gel, prior_h1=1.5)


def test_questions_that_make_no_sense_are_refused(bank):
    x = bank.reference.laterals_mm
    forces = bank.reference.row(4)
    nan = forces.copy()
    nan[1, 3] = math.nan
    for arguments, options in (
        ((x, nan), {}),
        ((x[:-1], forces), {}),
        ((x + 1, forces), {}),
        ((x, forces), {"noise_sd_n": (math.inf, 0.1)}),
        ((x, forces), {"unknown": ["colour"]}),
        ((x, forces), {"max_miss": 0.1, "max_false_alarm": 0.1}),
        ((x, forces), {"max_miss": math.nan}),
        ((x, forces), {"prior": [1.0]}),
        ((x, forces), {"prior": [math.nan] * 15}),
        ((x, forces), {"prior_h1": 1.5}),
        ((x, forces), {"noise_sd_n": -1}),
        ((x, forces), {"noise_sd_n": math.nan}),
        ((x, forces), {"depth_tolerance_mm": -0.3}),
    ):
        with pytest.raises(palpate.Refused):
            bank.locate(*arguments, **options)
    phantom = palpate.Phantom("6.6")
    for options in ({"offsets_mm": [math.nan]}, {"depths_mm": [-1]}, {"diameters_mm": []}, {"mesh_mm": 0}):
        with pytest.raises(palpate.Refused):
            palpate.Bank.build(phantom, 4, [-4, 0, 4], **options)
    with pytest.raises(palpate.Refused, match="depths_mm is empty"):
        palpate.reach(bank, 0.1, positions_mm=x, depths_mm=[])
    with pytest.raises(palpate.Refused, match="0 inclusions"):
        palpate.Bank.build(palpate.Phantom("none"), 4, [0])


def test_refusals_name_the_arguments(bank):
    x, forces = bank.reference.laterals_mm, bank.reference.row(4)
    nan = forces.copy()
    nan[1, 3] = math.nan
    for message, call in (
        (r"^forces_n\[1, 3\] is NaN or infinite", lambda: bank.locate(x, nan)),
        (r"^positions_mm\[0\] = -9.6, but must be between -8 and 8, as in the bank", lambda: bank.judge(1.2 * x, forces)),
        ("^noise_sd_n = inf, but must be finite", lambda: bank.locate(x, forces, noise_sd_n=(math.inf, 0.1))),
        (r"has the shape \[2, 2, 17\]; give \[2, n\], the lateral and the normal samples of one", lambda: bank.locate(x, [forces, forces])),
    ):
        with pytest.raises(palpate.Refused, match=message):
            call()


def test_table_1(tmp_path):
    analysis = palpate.analyse_answers()
    playback = analysis["conditions"][1]
    # The paper: 84 % of the answers to the 6.6 mm inclusion are right.
    pooled = playback["inclusions"][2]["pooled"]
    assert (pooled["correct"], pooled["trials"]) == (253, 300)
    assert pooled["gamma"]["gamma"] == palpate.gamma_from_two_afc(253 / 300)
    correct = [[rate["correct"] for rate in subject["rates"]] for subject in playback["subjects"]]
    counts = palpate.count_analysis(np.array(correct), 30)
    assert counts["pooled"][2] == 253 and counts["df"] == 9
    assert analysis["noise_levels"]["levels"]
    path = tmp_path / "own.csv"
    path.write_text("subject,condition,trials,6.6\na,mine,10,9\nb,mine,10,5\n")
    own = palpate.analyse_answers(path)
    assert "noise_levels" not in own and own["conditions"][0]["inclusions"][0]["pooled"]["rate"] == 0.7
    assert palpate.analyse_answers(pd.read_csv(path)) == own
    assert palpate.count_analysis(pd.DataFrame(correct), 30) == counts
    path.write_text("subject,condition,trials,6.6\na,mine,10,11\n")
    with pytest.raises(palpate.Refused, match="own.csv:2: 6.6"):
        palpate.analyse_answers(path)
    for wrong in ([[31]], [[1.5]], [[math.nan]], []):
        with pytest.raises(palpate.Refused):
            palpate.count_analysis(wrong, 30)
    json.dumps(analysis)


def test_a_sweep_is_watched_sample_by_sample(bank):
    x = np.linspace(-8, 8, 161)
    truth = palpate.Phantom("6.6", inclusion_centre_x_mm=2, inclusion_depth_mm=5.6)
    record = noisy(truth.map([4], np.arange(-8, 9.0), mesh_mm=1).sweep(4, x))
    watcher = palpate.Watcher(bank, noise_sd_n=0.05, unknown=["offset", "gain"])
    answers = [watcher.push(*sample) for sample in zip(x, record[1], record[0])]
    last = answers[-1]
    whole = bank.locate(x, record, noise_sd_n=0.05, unknown=["offset", "gain"], white=True)
    assert math.isclose(last["theta"], whole["theta_mixture"], abs_tol=1e-9)
    assert math.isclose(last["posterior_h1"], whole["posterior_h1"], abs_tol=1e-9)
    assert last["decision"] == "inclusion" and last["likeliest"]["position_m"] == 0.002
    first = next(answer for answer in answers if answer["decision"])
    assert last["decided_at_sample"] == first["samples"] < 161 and first["uncovered_positions_m"]
    assert watcher.push(math.nan, 1.5, 0)["missing"] == 1 and watcher.push(0, math.nan, 0)["missing"] == 2
    assert watcher.push(9, 1.5, 0)["outside"] == 1
    alone = palpate.Watcher(bank, noise_sd_n=(0.05, 0.05), max_miss=0.1)
    assert alone.push(0, 1.5)["posterior_h1"] == 0.5
    for wrong in ({"unknown": ["variance"]}, {"unknown": ["x"]}, {"max_miss": 0}, {"prior": [1]}, {"prior_h1": 1}):
        with pytest.raises(palpate.Refused):
            palpate.Watcher(bank, noise_sd_n=0.05, **wrong)
    with pytest.raises(palpate.Refused):
        watcher.push(0, math.inf)
    with pytest.raises(palpate.Refused):
        watcher.push(math.inf, 1)


def test_each_sample_may_have_its_depth():
    bank = palpate.Bank.build(palpate.Phantom("6.6"), [2, 4], np.arange(-8, 9.0), offsets_mm=[-2, 0, 2], mesh_mm=1)
    x, truth = np.linspace(-8, 8, 161), bank.maps[2]
    record = noisy(np.hstack([truth.sweep(2, x), truth.sweep(4, x[::-1])]))
    path = {"positions_mm": np.hstack([x, x[::-1]]), "depths_mm": np.repeat([2.0, 4.0], 161)}
    whole = bank.locate(forces_n=record, noise_sd_n=0.05, unknown=["offset", "gain"], white=True, **path)
    assert whole["inclusion"] and whole["likeliest"]["position_mm"] == 2
    judged = bank.judge(forces_n=record, noise_sd_n=0.05, **path)
    assert judged["inclusion"] and judged["samples_left_out"] == 0
    # A third pass of a millimetre is too short, and said to be left out.
    longer = {"positions_mm": np.append(path["positions_mm"], x[1:11]), "depths_mm": np.append(path["depths_mm"], np.full(10, 2.0))}
    last = noisy(truth.sweep(2, x[1:11]))
    assert bank.judge(forces_n=np.hstack([record, last]), noise_sd_n=0.05, **longer)["samples_left_out"] == 10
    watcher = palpate.Watcher(bank, noise_sd_n=0.05, unknown=["offset", "gain"])
    for sample in zip(path["positions_mm"], record[1], record[0], path["depths_mm"]):
        last = watcher.push(*sample)
    assert math.isclose(last["theta"], whole["theta_mixture"], abs_tol=1e-9)
    for call in (bank.locate, bank.judge):
        with pytest.raises(palpate.Refused, match="the bank has 2 depths of the probe; give depths_mm"):
            call(x, truth.sweep(2, x), noise_sd_n=0.05)
        with pytest.raises(palpate.Refused):
            call(x, truth.sweep(4, x), noise_sd_n=0.05, depths_mm=[4.0])
        with pytest.raises(palpate.Refused, match="at a depth of 5.0 mm is outside the maps, .* leave it out$"):
            call(x, truth.sweep(4, x), noise_sd_n=0.05, depths_mm=0 * x + 5)
    with pytest.raises(palpate.Refused):
        watcher.push(0, 1.5, 0)

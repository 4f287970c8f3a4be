"""Records: shapes, bits, batches, noise. Checks PYT-003, PYT-005, PYT-020."""

import math
import os
import subprocess
import sys
from fractions import Fraction

import numpy as np
import palpate
import pytest

rng = np.random.default_rng(1999)


def forces(samples):
    """F_0 and F_1 of a sweep over an inclusion, which have 53 bits each."""
    x = np.linspace(-10, 10, samples)
    f0 = np.array([0.01 * x, 1.5 + 0.003 * x**2])
    bump = np.exp(-0.5 * (x / 3) ** 2)
    return f0, f0 + np.array([0.1 * x * bump, 0.31 * bump])


def records(count, samples, sd=0.1):
    f0, f1 = forces(samples)
    noise = sd * rng.standard_normal((count, 2, samples))
    noise[::2] += f1
    noise[1::2] += f0
    return noise, f0, f1


def exact_theta(record, f0, f1, sd):
    """Equation (7) in fractions."""
    total = Fraction(0)
    for channel in (0, 1):
        p, a, b = ([Fraction(v) for v in series[channel].tolist()] for series in (record, f0, f1))
        terms = ((q - g - (h - g) / 2) * (h - g) for q, g, h in zip(p, a, b))
        total += sum(terms) / Fraction(sd[channel]) ** 2
    return total


# Lengths that fill blocks and parts, and such that do not; batches that fill registers and threads, and such that do not.
@pytest.mark.parametrize("samples", [1, 2, 3, 4, 5, 41, 64, 65, 401])
@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 1023, 1025])
def test_a_batch_has_the_bits_of_single_records(samples, count):
    observed, f0, f1 = records(count, samples)
    batch = palpate.theta(observed, f0, f1, (0.1, 0.07))
    single = [palpate.theta(record, f0, f1, (0.1, 0.07)) for record in observed]
    assert batch.shape == (count,) and batch.tolist() == single


@pytest.mark.parametrize("scale", [1e-290, 1e-150, 1e-3, 1.0, 1e5, 1e145, 1e290])
def test_a_batch_has_the_bits_of_single_records_at_every_scale(scale):
    observed, f0, f1 = (scale * array for array in records(9, 7))
    batch = palpate.theta(observed, f0, f1, 0.1 * scale)
    assert batch.tolist() == [palpate.theta(record, f0, f1, 0.1 * scale) for record in observed]


def test_a_batch_refuses_what_single_records_refuse():
    f0, f1 = np.array([[-1.7e308], [0.0]]), np.array([[-1.6e308], [0.0]])
    # y(0) would be 3.4e308 N, though theta is finite.
    for observed in (-f0, [-f0]):
        with pytest.raises(palpate.Refused, match="y_x is too large"):
            palpate.theta(observed, f0, f1, 1e307)
    for observed in (f0, [f0]):
        with pytest.raises(palpate.Refused, match="^noise_sd_n = 0, but must be"):
            palpate.theta(observed, f0, f1, (1.0, 0.0))


def test_theta_is_within_4_ulp_of_the_exact_value():
    observed, f0, f1 = records(200, 41)
    sd = (0.1, 0.07)
    for record, theta in zip(observed, palpate.theta(observed, f0, f1, sd).tolist()):
        exact = exact_theta(record, f0, f1, sd)
        assert abs(Fraction(theta) - exact) <= 4 * Fraction(math.ulp(theta)), theta


def test_channels_are_not_exchanged():
    observed, f0, f1 = records(3, 5)
    swapped = [array[..., ::-1, :] for array in (observed, f0, f1)]
    same = palpate.theta(*swapped, (0.07, 0.1))
    assert np.allclose(same, palpate.theta(observed, f0, f1, (0.1, 0.07)), rtol=1e-14, atol=0)
    assert not np.allclose(palpate.theta(*swapped, (0.1, 0.07)), same)
    # A lateral signal in the noise of the lateral channel: gamma**2 = (1 / 0.5)**2.
    assert palpate.statistic([[1.0], [0.0]], [[0.0], [0.0]], [[1.0], [0.0]], (0.5, 9.0)).gamma == 2.0


def test_any_array_will_do():
    observed, f0, f1 = records(6, 41)
    expected = palpate.theta(observed, f0, f1, 0.1).tolist()
    fortran = np.asfortranarray(observed)
    strided = np.repeat(observed, 2, axis=0)[::2]
    swapped = observed.astype(">f8")
    for other in (fortran, strided, swapped, observed.tolist()):
        assert palpate.theta(other, f0, f1, 0.1).tolist() == expected
    single = observed.astype("f4")
    assert palpate.theta(single, f0, f1, 0.1).tolist() == palpate.theta(single.astype("f8"), f0, f1, 0.1).tolist()
    assert isinstance(palpate.theta(observed[0], f0, f1, 0.1), float)
    assert palpate.theta(observed[:0], f0, f1, 0.1).shape == (0,)


def test_a_list_within_itself_and_one_too_deep_are_no_numbers():
    within, deep = [], 1.0
    within.append(within)
    for _ in range(100_000):
        deep = [deep]
    for wrong in (within, deep):
        with pytest.raises(TypeError, match="must be real numbers"):
            palpate.two_afc(wrong)


def test_the_oracle_takes_the_numbers_of_numpy():
    expected = palpate.ask("two_afc", gamma=1.0)
    for kind in (np.longdouble, np.float32, np.int64):
        assert palpate.ask("two_afc", gamma=kind(1)) == expected


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf])
def test_no_number_that_is_not_finite_passes(wrong):
    observed, f0, f1 = records(5000, 41)
    observed[4321, 1, 7] = wrong
    with pytest.raises(palpate.Refused, match=r"^record 4321: observed\[1, 7\] is NaN or infinite"):
        palpate.theta(observed, f0, f1, 0.1)
    template = f1 - f0
    with pytest.raises(palpate.Refused, match="record 4321"):
        palpate.MatchedFilter(template, 0.1).theta(observed - f0)
    with pytest.raises(palpate.Refused, match="record 4321"):
        palpate.scan(observed - f0, template[:, :9], 0.1)
    for arguments in ((observed[0], np.full_like(f0, wrong), f1, 0.1), (observed[0], f0, f1, wrong), (observed, f0, f1, (0.1, wrong))):
        with pytest.raises(palpate.Refused):
            palpate.theta(*arguments)
    for function in (palpate.two_afc, palpate.auc, palpate.map_threshold, palpate.gamma_from_two_afc):
        with pytest.raises(palpate.Refused):
            function(wrong)
        with pytest.raises(palpate.Refused, match="element 1"):
            function([0.5, wrong])
    for function in (palpate.decide, palpate.posterior, palpate.error_rates, palpate.roc_miss, palpate.required_gamma):
        with pytest.raises(palpate.Refused):
            function(0.4, wrong)
        with pytest.raises(palpate.Refused):
            function([wrong, 0.4], 0.4)
    with pytest.raises(palpate.Refused):
        palpate.noise_budget(0.3, 0.05, 0.05, [wrong])
    with pytest.raises(palpate.Refused):
        palpate.simulate_theta(f0, f1, wrong, True, 10)


    for call in (lambda: palpate.Statistic(wrong, [0, 0], 1), lambda: palpate.Statistic(0, [0, wrong], 1), lambda: palpate.ProbeForce(0, wrong)):
        with pytest.raises(palpate.Refused, match="finite"):
            call()


def test_shapes_that_do_not_fit_are_refused():
    observed, f0, f1 = records(3, 41)
    for arguments in (
        (observed[:, :1], f0, f1, 0.1),
        (observed[..., :40], f0, f1, 0.1),
        (observed, f0[:, :40], f1, 0.1),
        (observed, observed, f1, 0.1),
        (observed, f0, f1, (0.1, 0.1, 0.1)),
        (observed[0, 0], f0, f1, 0.1),
        (observed[..., :0], f0[:, :0], f1[:, :0], 0.1),
        (observed, f0, f1, 0.0),
    ):
        with pytest.raises(palpate.Refused):
            palpate.theta(*arguments)
    for wrong in ("abc", None, [[1, 2], [3]], observed + 1j, np.ma.masked_array(observed), [["1"], ["2"]]):
        with pytest.raises(TypeError, match="observed is a"):
            palpate.theta(wrong, f0, f1, 0.1)
    # NumPy makes a number of what is masked, also in a list and in a question to the oracle.
    with pytest.raises(TypeError, match="observed is a list"):
        palpate.theta([np.ma.masked_array(channel) for channel in observed], f0, f1, 0.1)
    for wrong in (np.ma.masked, np.ma.masked_array([1.0, 2.0], [0, 1]), 1j, np.array([1j]), object()):
        with pytest.raises(TypeError, match="is no argument; give numbers"):
            palpate.ask("two_afc", gamma=wrong)


def test_the_matched_filter_of_a_batch():
    observed, f0, f1 = records(7, 41)
    matched, residual = palpate.MatchedFilter(f1 - f0, 0.1), observed - f0
    single = [matched.statistic(one) for one in residual]
    assert matched.theta(residual).tolist() == [found.theta for found in single]
    assert single[0].gamma == matched.gamma
    # Of the template itself y is its root mean square, and theta is gamma**2/2.
    found = matched.statistic(f1 - f0)
    assert np.allclose(found.y_n, matched.b_n, rtol=1e-14) and math.isclose(found.theta, matched.gamma**2 / 2, rel_tol=1e-14)


def test_functions_broadcast():
    gamma, eta = np.array([[1.0], [2.0]]), np.array([-0.5, 0.0, 0.5])
    false_alarm, miss = palpate.error_rates(gamma, eta)
    assert false_alarm.shape == miss.shape == (2, 3)
    assert (false_alarm[1, 2], miss[1, 2]) == palpate.error_rates(2.0, 0.5)
    decided = palpate.decide([-1.0, 0.0, 1.0], 0.0)
    assert decided.tolist() == [False, True, True] and decided.dtype == bool
    assert palpate.decide(-1.0, 0.0) is False
    assert isinstance(palpate.two_afc(1), float)
    with pytest.raises(palpate.Refused):
        palpate.error_rates([1.0, 2.0], [0.0, 0.0, 0.0])


def test_simulated_rates_are_those_of_the_law():
    _, f0, f1 = records(1, 41)
    gamma = palpate.statistic(f1, f0, f1, 0.6).gamma
    trials = 200_000
    false_alarm, miss = palpate.error_rates(gamma, 0.3)
    for inclusion, rate in ((False, false_alarm), (True, 1 - miss)):
        theta = palpate.simulate_theta(f0, f1, 0.6, inclusion, trials, seed=7)
        # Five standard deviations of a binomial share.
        found = palpate.decide(theta, 0.3).mean()
        assert abs(found - rate) < 5 * math.sqrt(rate * (1 - rate) / trials)


def test_records_with_and_without_inclusion_have_noise_of_their_own():
    _, f0, f1 = records(1, 41)
    without, with_inclusion = (palpate.simulate_theta(f0, f1, 0.6, of, 20_000, seed=7) for of in (False, True))
    # Five standard deviations of the correlation of independent numbers; the same noise in both makes it 1.
    assert abs(np.corrcoef(without, with_inclusion)[0, 1]) < 5 / math.sqrt(20_000)
    again = palpate.simulate_theta(f0, f1, 0.6, False, 20_000, seed=7)
    assert (again == without).all() and not np.isin(without, with_inclusion).any()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows does not fork")
def test_a_forked_process_has_threads_of_its_own():
    program = """
import multiprocessing, numpy, palpate
f0 = numpy.ones((2, 41))
records = numpy.tile(f0, (5000, 1, 1))
def ask(_):
    return palpate.theta(records, f0, f0 + 0.01, 0.3).tobytes()
own = ask(0)
assert multiprocessing.get_context("fork").Pool(2).map(ask, range(4)) == [own] * 4
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)


def test_the_number_of_threads_changes_nothing():
    program = (
        "import numpy as np, palpate, sys; f0 = np.ones((2, 41)); f1 = f0 + 0.01 * np.arange(82.0).reshape(2, 41);"
        "r = np.random.default_rng(3).standard_normal((5000, 2, 41));"
        "s = palpate.scan(r[:50], f1[:, :5], 0.2); b = palpate.Bank.build(palpate.Phantom('6.6'), 4, [-4, 0, 4],"
        "offsets_mm=[-2, 0, 2], mesh_mm=2); sys.stdout.buffer.write(palpate.theta(r, f0, f1, 0.3).tobytes()"
        "+ s['theta'].tobytes() + palpate.simulate_theta(f0, f1, 0.3, True, 3000).tobytes() + b.maps[0].normal_n.tobytes())"
    )
    def run(threads):
        environment = os.environ | {"RAYON_NUM_THREADS": threads, "OPENBLAS_NUM_THREADS": "1"}
        return subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, check=True).stdout
    assert run("1") == run("2") == run("5") != b""

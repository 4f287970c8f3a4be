"""The cases of vectors/ through the Python API. Checks PYT-002, PYT-003, PYT-005, PYT-020."""

import json
import math
from pathlib import Path

import numpy as np
import palpate
import pytest

VECTORS = Path(__file__).parents[3] / "vectors"


def threshold(criterion, **arguments):
    functions = {
        "map": palpate.map_threshold,
        "bayes": palpate.bayes_threshold,
        "neyman_pearson_miss": palpate.neyman_pearson_miss_threshold,
        "neyman_pearson_false_alarm": palpate.neyman_pearson_false_alarm_threshold,
    }
    if criterion not in functions:
        raise palpate.Refused(criterion)
    return {"eta": functions[criterion](**arguments)}


def matched_filter(template_x, template_y, noise_sd_x, noise_sd_y):
    found = palpate.MatchedFilter([template_x, template_y], [noise_sd_x, noise_sd_y])
    (b_x, b_y), (sigma_x, sigma_y) = found.b_n, found.sigma_n
    return {"b_x": b_x, "b_y": b_y, "sigma_x": sigma_x, "sigma_y": sigma_y, "gamma": found.gamma}


def theta(observed_x, observed_y, f0_x, f0_y, f1_x, f1_y, noise_sd_x, noise_sd_y):
    forces = [observed_x, observed_y], [f0_x, f0_y], [f1_x, f1_y], [noise_sd_x, noise_sd_y]
    found = palpate.statistic(*forces)
    # One record, and a batch of three.
    assert palpate.theta(*forces) == found.theta
    assert palpate.theta([forces[0]] * 3, *forces[1:]).tolist() == [found.theta] * 3
    return {"theta": found.theta, "y_x": found.y_n[0], "y_y": found.y_n[1], "gamma": found.gamma}


def theta_colored(residual, template, covariance):
    # Of an odd number of samples no two channels can be made.
    shaped = [np.reshape(both, (2, -1)) if np.size(both) % 2 == 0 else both for both in (residual, template)]
    return dict(zip(("theta", "gamma"), palpate.theta_coloured(*shaped, covariance)))


def scan(residual_x, residual_y, template_x, template_y, noise_sd_x, noise_sd_y):
    forces = [residual_x, residual_y], [template_x, template_y], [noise_sd_x, noise_sd_y]
    found = palpate.scan(*forces)
    many = palpate.scan([forces[0]] * 2, *forces[1:])
    for name, value in found.items():
        assert np.array_equal(many[name], [value] * 2), name
    return {"theta": found["theta"].tolist(), "max_theta": found["max_theta"], "argmax": found["shift"]}


def error_rates(gamma, eta):
    return dict(zip(("false_alarm", "miss"), palpate.error_rates(gamma, eta)))


def roc(gamma, false_alarm):
    if np.ndim(false_alarm) != 1 or len(false_alarm) == 0:
        raise palpate.Refused("no rates")
    return {"miss": palpate.roc_miss(gamma, false_alarm).tolist(), "auc": palpate.auc(gamma)}


def noise_budget(signal_n, max_false_alarm, max_miss, sources_n):
    found = palpate.noise_budget(signal_n, max_false_alarm, max_miss, sources_n)
    return dict(zip(("gamma", "total_allowed_n", "remaining_n"), found))


def probe_force(phantom, depth_m, lateral_m, strain="small"):
    found = palpate.Phantom(phantom, strain=strain).solve(depth_mm=1000 * depth_m, lateral_mm=1000 * lateral_m)
    return {"normal_force_n": found.normal_n, "lateral_force_n": found.lateral_n}


def named(name, function):
    return lambda **arguments: {name: function(**arguments)}


TYPED = {
    "threshold": threshold,
    "matched_filter": matched_filter,
    "theta": theta,
    "theta_colored": theta_colored,
    "theta_nuisances": palpate.theta_nuisances,
    "bank_posterior": palpate.bank_posterior,
    "scan": scan,
    "error_rates": error_rates,
    "roc": roc,
    "two_afc": named("p_correct", palpate.two_afc),
    "gamma_from_two_afc": named("gamma", palpate.gamma_from_two_afc),
    "required_gamma": named("gamma", palpate.required_gamma),
    "noise_budget": noise_budget,
    "probe_force": probe_force,
    "count_analysis": palpate.count_analysis,
}
# What only the oracle has is asked by its name; "requests" are about its lines.
FILES = sorted(path for path in VECTORS.glob("*.json") if path.stem not in ("manifest", "schema", "requests"))
# A keyword that has a default in Python, so that a question without it has an answer.
DEFAULTS = {"theta_nuisances": {"level", "bias", "eta"}, "bank_posterior": {"level", "prior_h1"}}


def near(expected, found, tolerance):
    if isinstance(expected, list):
        return len(expected) == len(found) and all(map(lambda e, f: near(e, f, tolerance), expected, found))
    if isinstance(expected, str) or "exact" in tolerance:
        return found == expected
    ulp = math.nextafter(abs(expected), math.inf) - abs(expected)
    bound = tolerance.get("ulp", 0) * ulp + tolerance.get("absolute", 0)
    return abs(found - expected) <= bound + tolerance.get("relative", 0) * abs(expected)


def arguments_of(case):
    """The arguments of a case, None where its line is no question that Python could ask."""
    if "args" in case:
        return case["args"]
    try:
        request = json.loads(case["line"])
    except ValueError:
        return None
    arguments = request.get("args", {}) if isinstance(request, dict) else None
    return arguments if isinstance(arguments, dict) else None


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_vectors(path):
    data = json.loads(path.read_text())
    op = data["op"]
    function = TYPED.get(op) or (lambda **arguments: palpate.ask(op, **arguments))
    right = refused = 0
    for case in data["cases"]:
        arguments = arguments_of(case)
        if arguments is None:
            continue
        if "error" in case:
            try:
                answer = function(**arguments)
            except (palpate.Refused, TypeError):
                refused += 1
                continue
            missing = DEFAULTS.get(op, set()) - set(arguments)
            assert missing, (case["id"], case["comment"], answer)
            continue
        answer = function(**arguments)
        for key, expected in case["ok"].items():
            tolerance = case.get("tolerance", {}).get(key) or data["tolerance"][key]
            assert near(expected, answer[key], tolerance), (case["id"], key, expected, answer[key])
        right += 1
    print(f"{op}: {right} right, {refused} refused")
    assert right >= 10 and refused >= 5


def test_the_oracle_answers_what_the_functions_answer():
    data = json.loads((VECTORS / "theta.json").read_text())
    for case in data["cases"]:
        if "ok" in case:
            assert palpate.ask("theta", **case["args"]) == theta(**case["args"])

"""Runs the steps of action.yml as a runner does, for right and for wrong inputs."""

import os
import pathlib
import subprocess
import sys

import yaml

FOLDER = pathlib.Path(__file__).resolve().parent
OUT = pathlib.Path(sys.argv[1])
ACTION = yaml.safe_load((FOLDER / "action.yml").read_text())


def run(**given):
    """The exit code of the first step that fails, or 0."""
    unknown = given.keys() - {name.replace("-", "_") for name in ACTION["inputs"]}
    assert not unknown, unknown
    inputs = {name: str(given.get(name.replace("-", "_"), told["default"])) for name, told in ACTION["inputs"].items()}
    path = OUT / "path"
    path.write_text("")
    for step in ACTION["runs"]["steps"]:
        condition = step.get("if", "true")
        if condition != "true":
            name = condition.removeprefix("inputs.").removesuffix(" != ''")
            if not inputs[name]:
                continue
        environment = dict(os.environ, GITHUB_ACTION_PATH=str(FOLDER), RUNNER_TEMP=str(OUT), GITHUB_PATH=str(path))
        environment["PATH"] = ":".join([*path.read_text().split(), environment["PATH"]])
        for name, value in step.get("env", {}).items():
            environment[name] = inputs[value.removeprefix("${{ inputs.").removesuffix(" }}")]
        script = OUT / "step.sh"
        script.write_text(step["run"])
        # As GitHub starts a step of bash.
        code = subprocess.run(["bash", "--noprofile", "--norc", "-eo", "pipefail", script], env=environment, cwd=OUT).returncode
        if code != 0:
            return code
    return 0


def expect(code, **inputs):
    """Runs the action, which must end with this exit code."""
    found = run(**inputs)
    assert found == code, f"{inputs}: the exit code is {found}, not {code}"
    print(f"exit code {code} as expected: {inputs}", flush=True)


HALF = r"""
import json, sys
for line in sys.stdin:
    asked = json.loads(line)
    ok = {"version": "0", "ops": ["two_afc"]} if asked["op"] == "capabilities" else {"p_correct": 0.5}
    print(json.dumps({"id": asked["id"], "ok": ok}), flush=True)
"""
(OUT / "half.py").write_text(HALF)
right = {"command": "palpate oracle", "groups": "two_afc roc"}
expect(2)
expect(0, **right, timing_budget_us=1_000_000)
assert "<testsuites" in (OUT / "palpate-conform.xml").read_text()
expect(1, command="python3 half.py", groups="two_afc", junit="half.xml")
assert "<failure" in (OUT / "half.xml").read_text()
expect(1, command="python3 half.py", groups="two_afc roc", options="--require mathematics")
expect(2, command="palpate oracle", groups="no-such-group")
expect(0, **right, options="--profile f32 --require mathematics")
expect(2, **right, options="--profile f16")
expect(0, timing_budget_us=1_000_000, timing_cycles=3000)

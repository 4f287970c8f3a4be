"""`plant.py CONFORM FOLDER`: plants bugs in the C adapter, in float, and asks it the vectors in profile f32: with each it must fail.

Implements: ORA-071.
"""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).parent
SOURCES = ("adapter.c", "oracle_lines.h")
GCC = "gcc -std=c11 -O1 -ffp-contract=off -DREAL=float adapter.c -ljansson -lm -o adapter".split()
BUGS = {
    "Φ without √2": ("return erfc(-x / ROOT_2) / 2;", "return erfc(-x) / 2;"),
    "erf for Φ": ("return erfc(-x / ROOT_2) / 2;", "return erf(x / ROOT_2);"),
    "the tail lost in 1 − …": ("return erfc(-x / ROOT_2) / 2;", "return (1 + erf(x / ROOT_2)) / 2;"),
    "no Halley step": ("step < 2", "step < 0"),
    "forced choice without √2": ('phi(not_negative("gamma") / ROOT_2)', 'phi(not_negative("gamma"))'),
    "γ/2 left out of the misses": ("phi(eta / gamma - gamma / 2)", "phi(eta / gamma)"),
    "the prior inverted": ("(1 - prior) / prior", "prior / (1 - prior)"),
    "logarithm to base 10": ("log(odds)", "log10(odds)"),
    "sources added without squares": ("hypot(used, sources.at[i])", "used + sources.at[i]"),
    "the weight 1/N left out": ("give(b, norm / root)", "give(b, norm)"),
    "variance for standard deviation": ("give(sigma, sd / root)", "give(sigma, sd * sd / root)"),
    "Δ whole in place of half": ("(record.at[i] - delta[i] / 2)", "(record.at[i] - delta[i])"),
    "the sign of Θ": ("return theta / sd / sd;", "return -theta / sd / sd;"),
    "F0 not subtracted in the normal channel": ("record.at[i] -= f0.at[i];", 'record.at[i] -= y[2] == \'y\' ? 0 : f0.at[i];'),
    "noise of the channels exchanged": ('channel(x, f0x, f1x, positive("noise_sd_x")', 'channel(x, f0x, f1x, positive("noise_sd_y")'),
    "an index of Cholesky's factor": ("dot(l + i * n, l + j * n, j)", "dot(l + i * n, l + j * n, i)"),
    "the factor's transpose": ("dot(l + i * n, r.at, i)", "dot(l + i, r.at, i)"),
    "one shift too few": ("shifts = x.n - dx.n + 1", "shifts = x.n - dx.n"),
    "the last of equal shifts": ("theta.at[shift] > theta.at[first]", "theta.at[shift] >= theta.at[first]"),
    "rows and columns": ("row * laterals.n + column", "column * depths.n + row"),
    "clamped outside of the table": (
        "/ (knots.at[cell + 1] - knots.at[cell]);", "/ (knots.at[cell + 1] - knots.at[cell]), *fraction = fmin(fmax(*fraction, 0), 1);"),
    "the servo kernel's division": ("(x - start) * (1 / (end - start))", "(x - start) / (end - start)"),
    "a negative deviation taken": ("if (value <= 0) refuse", "if (value == 0) refuse"),
    "lengths not checked": ("if (n == 0 || samples.n != n)", "if (n == 0)"),
    "an infinite answer given": ("if (!isfinite(value)) refuse", "if (value != value) refuse"),
    "null taken for 0": ("if (!json_is_number(value)) refuse", "if (!json_is_number(value) && !json_is_null(value)) refuse"),
    "unknown arguments passed over": ("if (call.asked != json_object_size(call.args))", "if (call.asked > json_object_size(call.args))"),
    "an unknown op answered as a known one": ('if (i == count) refuse("unknown_op", "no such op");', "if (i == count) i = 2;"),
}  # fmt: skip


def failures(conform, folder, name, old="", new=""):
    """What the program says of the adapter with the bug; nothing, if it passes."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = {source: (HERE / source).read_text() for source in SOURCES}
    assert not old or sum(text.count(old) for text in texts.values()) == 1, f"{name}: {old} is not there once"
    for source, text in texts.items():
        (folder / source).write_text(text.replace(old, new) if old else text)
    subprocess.run(GCC, cwd=folder, check=True)
    asked = subprocess.run([conform, "--profile", "f32", "--", folder / "adapter"], capture_output=True, text=True)
    assert asked.returncode in (0, 1), asked.stderr
    return asked.stderr.strip().splitlines()[-1] if asked.returncode else ""


def main(conform, folder):
    plants = [("the sound adapter", "", ""), *((name, *bug) for name, bug in BUGS.items())]
    work = lambda k: failures(conform, Path(folder) / "plant" / str(k), *plants[k])
    with ThreadPoolExecutor(2) as pool:
        found = list(pool.map(work, range(len(plants))))
    missed = [name for (name, *_), text in zip(plants[1:], found[1:]) if not text]
    print(f"plant: {len(BUGS) - len(missed)} of {len(BUGS)} planted bugs found in f32")
    for text in [*(f"the sound adapter: {text}" for text in found[:1] if text), *(f"not found: {name}" for name in missed)]:
        print("  " + text)
    return int(bool(found[0] or missed))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))

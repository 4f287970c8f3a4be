"""The NumPy twin of detect.rs: the same job, vectorised, on one core (OMP_NUM_THREADS=1 python3 detect_numpy.py)."""
import os

os.environ["OMP_NUM_THREADS"] = "1"
import time

import numpy as np

SAMPLES, RECORDS = 401, 100_000
position = (np.arange(SAMPLES) - 200) / 60
bump = 0.34 * np.exp(-0.5 * position**2)
f0 = np.concatenate([np.zeros(SAMPLES), np.full(SAMPLES, 1.5)])
template = np.concatenate([position * bump, bump])
f1 = f0 + template
noise_sd = 3.0
rng = np.random.default_rng(2026)


def rate(items, run):
    """The best of five runs, in items a second."""
    best = 0.0
    for _ in range(5):
        start = time.perf_counter()
        run()
        best = max(best, items / (time.perf_counter() - start))
    return best


def records(batch):
    """Batches as large as the cache likes: buffers are reused, nothing is allocated in the loop."""
    noise = np.empty((batch, 2 * SAMPLES))
    for _ in range(RECORDS // batch):
        rng.standard_normal(out=noise)
        noise *= noise_sd
        noise += f1
        noise -= f0
        theta = (noise @ template - 0.5 * template @ template) / noise_sd**2
    return theta


best = max((rate(RECORDS, lambda: records(batch)), batch) for batch in (20, 100, 500))
print(f"full records (2 x {SAMPLES} samples): {best[0]:.4e} trials/s (batches of {best[1]})")

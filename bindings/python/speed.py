"""Theta of 100,000 records of 2 x 41 samples by palpate and by NumPy, in turn; exit code 1 where palpate is slower than stated."""

import statistics
import sys
import time

import numpy as np
import palpate

RECORDS, SAMPLES, TURNS = 100_000, 41, 15
# How much more processor time the paper's equation takes in NumPy, at least, in the quickest turn of each: what else runs on the machine
# can only add to it.
LEAST = 2.0

rng = np.random.default_rng(1999)
x = np.linspace(-10, 10, SAMPLES)
bump = np.exp(-0.5 * (x / 3) ** 2)
f0 = np.array([0.01 * x, 1.5 + 0.003 * x**2])
f1 = f0 + np.array([0.1 * x * bump, 0.31 * bump])
sd = np.array([[0.1], [0.1]])
records = f1 + sd * rng.standard_normal((RECORDS, 2, SAMPLES))


def ours():
    return palpate.theta(records, f0, f1, 0.1)


def equation():
    """Equations (5) to (7) as they stand."""
    template = f1 - f0
    return (template * (records - f0 - template / 2) / sd**2).sum(axis=(1, 2))


def weighted():
    """What does not depend on the record taken out of the sum."""
    template = f1 - f0
    weights = template / sd**2
    return ((records - f0) * weights).sum(axis=(1, 2)) - 0.5 * (weights * template).sum()


def matmul():
    """The same sum as a product of matrices."""
    template = f1 - f0
    weights = template / sd**2
    return (records - f0).reshape(RECORDS, -1) @ weights.ravel() - 0.5 * (weights * template).sum()


def matmul_of_records():
    """The forces without inclusion taken out too: no array is made, and digits are lost."""
    template = f1 - f0
    weights = template / sd**2
    return records.reshape(RECORDS, -1) @ weights.ravel() - (weights * (f0 + template / 2)).sum()


ways = [ours, equation, weighted, matmul, matmul_of_records]
times = {way: [] for way in ways}
# One way after the other, the products of matrices last: the threads of NumPy's linear algebra are busy for a while after each.
for way in ways:
    for _ in range(TURNS):
        start = time.perf_counter(), time.process_time()
        way()
        times[way].append((time.perf_counter() - start[0], time.process_time() - start[1]))
theta = ours()
print(f"{RECORDS} records of 2 x {SAMPLES} samples, {TURNS} turns; 'times' is against palpate.theta:")
medians = {way: 1e3 * statistics.median(wall for wall, _ in times[way]) for way in ways}
processor = {way: 1e3 * min(processor for _, processor in times[way]) for way in ways}
for way in ways:
    off = np.max(np.abs(way() - theta) / np.spacing(np.abs(theta)))
    print(
        f"  {way.__name__:18} median {medians[way]:6.1f} ms ({medians[way] / medians[ours]:5.2f} times), processor, least "
        f"{processor[way]:5.1f} ms ({processor[way] / processor[ours]:5.2f} times), off by {off:.0f} ULP at most"
    )
if not np.all(theta == [palpate.theta(record, f0, f1, 0.1) for record in records]):
    sys.exit("a batch has other bits than its records one by one")
if processor[equation] < LEAST * processor[ours]:
    sys.exit(f"the equation in NumPy takes less than {LEAST} times the processor time")

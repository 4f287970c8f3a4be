"""Prints ziggurat.rs: python3 ziggurat.py > ziggurat.rs (needs mpmath).

512 layers of equal area V under exp(-x²/2), x > 0 (Marsaglia and Tsang, J. Stat. Software 5, 2000)."""
from mpmath import mp, mpf, exp, log, sqrt, erfc, pi

mp.dps = 50
LAYERS = 512


def edges(r):
    """The right edges of the layers from the base up for a tail from r, and the area of each."""
    area = r * exp(-r * r / 2) + sqrt(pi / 2) * erfc(r / sqrt(mpf(2)))
    xs = [area * exp(r * r / 2), r]
    for _ in range(LAYERS - 2):
        xs.append(sqrt(-2 * log(area / xs[-1] + exp(-xs[-1] ** 2 / 2))))
    return xs, area


def top_defect(r):
    """By how much the room that is left for the top layer exceeds its area."""
    xs, area = edges(r)
    return xs[-1] * (1 - exp(-xs[-1] ** 2 / 2)) - area


# A tail that begins too early leaves too little room for the top layer (or, far too early, none).
low, high = mpf(3), mpf(5)
for _ in range(160):
    r = (low + high) / 2
    try:
        too_early = top_defect(r) < 0
    except (ValueError, TypeError):
        too_early = True
    low, high = (r, high) if too_early else (low, r)
xs, area = edges(r)
xs.append(mpf(0))

print("//! Table of the ziggurat for the normal law; written by `ziggurat.py`, checked by `random/tests.rs`.\n")
print("/// Where the tail begins.\npub(super) const TAIL: f64 = %r;" % float(r))
print("/// Right edges xᵢ of the layers, from the base (whose area includes the tail) to the top.")
print(f"#[rustfmt::skip]\npub(super) const EDGES: [f64; {len(xs)}] = [")
for start in range(0, len(xs), 6):
    print("    " + ", ".join(repr(float(x)) for x in xs[start : start + 6]) + ",")
print("];")

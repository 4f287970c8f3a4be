"""Records and templates that look like a probe's pass over a gel: short decimals in newtons."""

from fractions import Fraction

from .numbers import exact


def bump(position):
    """1/(1 + z²)², smooth and even."""
    return 1 / (1 + position * position) ** 2


def signal(count, draws, height=0.3):
    """Lateral and normal difference of forces of an inclusion: odd and even, no two samples alike."""
    middle, width = draws.decimal(0.35, 0.65) * count, max(1.0, draws.decimal(0.1, 0.3) * count)
    lateral, normal = [], []
    for i in range(count):
        z = (i - middle) / width
        lateral.append(round(-height * z * bump(z) + draws.decimal(-0.004, 0.004), 5))
        normal.append(round(height * bump(z) + draws.decimal(-0.004, 0.004), 5))
    return lateral, normal


def noise(count, draws, deviation):
    """A sum of 12 uniform numbers, as decimals: the cases need no better law."""
    return [round(deviation * (sum(draws.unit() for _ in range(12)) - 6), 5) for _ in range(count)]


def whole(count, draws, most):
    """Whole numbers but 0: long records of few bytes, in which every sample counts."""
    return [draws.choice([-1, 1]) * draws.integer(1, most) for _ in range(count)]


def added(*terms):
    return [sum(values) for values in zip(*terms)]


def exacts(values):
    return [exact(value) for value in values]


def dot(a, b):
    return sum((x * y for x, y in zip(a, b)), Fraction(0))


def magnitude(a, b):
    return sum((abs(x * y) for x, y in zip(a, b)), Fraction(0))

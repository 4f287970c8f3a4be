"""Exact numbers to floats and back, and a generator of numbers that is the same on every machine."""

import math
import struct
from decimal import Decimal
from fractions import Fraction

from mpmath import mp, mpf

mp.dps = 50

UNIT = Fraction(1, 2**53)
"""Unit roundoff u of f64."""


def exact(value):
    """The rational number that a float, an integer, a fraction or an mpf is; of an mpf below 2⁻³⁰⁰⁰, 0."""
    if isinstance(value, mpf):
        sign, mantissa, exponent, length = value._mpf_
        if (not mantissa and exponent) or exponent + length > 3000:
            raise OverflowError("no finite f64")
        if exponent + length < -3000:
            return Fraction(0)
        return Fraction(-mantissa if sign else mantissa) * Fraction(2) ** exponent
    return Fraction(value)


def nearest(value):
    """The f64 nearest to a number; Python's division of integers rounds correctly, subnormal results included."""
    ratio = exact(value)
    return ratio.numerator / ratio.denominator


def bits(value):
    """The bits of an f64 as in the files."""
    return "0x" + struct.pack(">d", value).hex()


def real(value):
    """The mpf of a float, an integer, a fraction or a decimal, correct to 50 digits."""
    if isinstance(value, Decimal):
        value = Fraction(value)
    if isinstance(value, Fraction):
        return mpf(value.numerator) / value.denominator
    return mpf(value)


def ulp(value):
    """Distance from |value| to the next larger f64, as a fraction."""
    return exact(math.ulp(nearest(value)))


def round_up(value):
    """A bound with two digits, not below the value: what a file states as an absolute tolerance."""
    value = exact(value)
    if value == 0:
        return 0.0
    text = f"{nearest(value):.1e}"
    mantissa, exponent = text.split("e")
    while exact(float(f"{mantissa}e{exponent}")) < value:
        mantissa = str(round(float(mantissa) + 0.1, 1))
    return float(f"{mantissa}e{exponent}")


class Draws:
    """Numbers drawn by SplitMix64: draw i of a seed depends on both alone."""

    def __init__(self, seed):
        self.seed, self.count = seed, 0

    def word(self):
        self.count += 1
        z = (self.seed * 0xD1342543DE82EF95 + self.count * 0x9E3779B97F4A7C15) % 2**64
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9 % 2**64
        z = (z ^ (z >> 27)) * 0x94D049BB133111EB % 2**64
        return z ^ (z >> 31)

    def integer(self, low, high):
        """From low to high, both included."""
        return low + self.word() % (high - low + 1)

    def decimal(self, low, high, digits=3):
        """A short decimal between two short decimals: easy to read in the file."""
        scale = 10**digits
        return self.integer(round(low * scale), round(high * scale)) / scale

    def unit(self):
        """In [0, 1), with all 53 bits."""
        return (self.word() >> 11) / 2**53

    def between(self, low, high):
        return low + (high - low) * self.unit()

    def choice(self, items):
        return items[self.word() % len(items)]

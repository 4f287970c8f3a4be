"""f32 in exact fractions: one operation is exact, then rounded to the nearest, ties to even.

Implements: VEC-010.
"""

import struct
from fractions import Fraction


def rounded(value):
    """The f32 nearest to a fraction, as a fraction."""
    if value == 0:
        return Fraction(0)
    size = abs(value)
    exponent = size.numerator.bit_length() - size.denominator.bit_length()
    if Fraction(2) ** exponent > size:
        exponent -= 1
    step = Fraction(2) ** (max(exponent, -126) - 23)
    # Python rounds a fraction to the nearest integer, ties to even.
    result = round(value / step) * step
    if abs(result) >= Fraction(2) ** 128:
        raise OverflowError("no finite f32")
    return result


def of_bits(pattern):
    return struct.unpack(">f", struct.pack(">I", pattern))[0]


def bits(value):
    """The bits of an f32 (a float, an infinity, or a fraction that is one) as in the files."""
    return "0x" + struct.pack(">f", float(value)).hex()


def single(decimal):
    """The f32 nearest to a decimal, as the float that a file holds."""
    return float(rounded(Fraction(decimal)))

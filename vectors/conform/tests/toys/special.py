"""The normal law and the binomial tail in 50 decimal digits, from Python's standard library alone."""

from decimal import Decimal, getcontext

getcontext().prec = 50
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")
ROOT_2_PI = (2 * PI).sqrt()
HALF = Decimal("0.5")


def density(x):
    return (-x * x / 2).exp() / ROOT_2_PI


def cdf(x):
    """Φ(x): near 0 by its series, in the tail by the continued fraction of Mills' ratio."""
    if x > 0:
        return 1 - cdf(-x)
    if x < -45:
        return Decimal(0)
    if x > -5:
        term, total, n = x, x, 1
        while abs(term) > Decimal("1e-45"):
            n += 2
            term = term * x * x / n
            total += term
        return HALF + density(x) * total
    rest = Decimal(0)
    for n in range(int(Decimal(4000) / -x) + 60, 0, -1):
        rest = n / (rest - x)
    return density(x) / (rest - x)


def quantile(p):
    """Φ⁻¹(p) for 0 < p < 1: Newton's method on ln Φ."""
    if p == HALF:
        return Decimal(0)
    if p > HALF:
        return -quantile(1 - p)
    x = -(-2 * p.ln()).sqrt() if p < Decimal("0.3") else Decimal(-1)
    for _ in range(100):
        tail = cdf(x)
        step = tail / density(x) * (tail / p).ln()
        x -= step
        if abs(step) < abs(x) * Decimal("1e-25"):
            break
    return x


STIRLING = [Decimal(1) / d for d in (12, -360, 1260, -1680, 1188)] + [
    Decimal(-691) / 360360,
    Decimal(1) / 156,
    Decimal(-3617) / 122400,
    Decimal(43867) / 244188,
]


def log_gamma(z):
    z, shift = Decimal(z), Decimal(0)
    while z < 60:
        shift += z.ln()
        z += 1
    series = sum(c / z ** (2 * k + 1) for k, c in enumerate(STIRLING))
    return (z - HALF) * z.ln() - z + ROOT_2_PI.ln() + series - shift


def log_mass(k, n, p):
    """ln of the binomial probability of k among n."""
    return log_gamma(n + 1) - log_gamma(k + 1) - log_gamma(n - k + 1) + k * p.ln() + (n - k) * (1 - p).ln()


def tail(k, n, p):
    """Pr(at least k of n), k ≥ 1, as the incomplete beta function's continued fraction (Lentz)."""
    a, b = Decimal(k), Decimal(n - k + 1)
    if p > (a + 1) / (a + b + 2):
        return 1 - fraction(b, a, 1 - p)
    return fraction(a, b, p)


def fraction(a, b, x):
    front = (log_gamma(a + b) - log_gamma(a) - log_gamma(b) + a * x.ln() + b * (1 - x).ln()).exp() / a
    c, d = Decimal(1), 1 / (1 - (a + b) * x / (a + 1))
    value, m = d, 0
    while True:
        m += 1
        for step in (
            m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)),
        ):
            d, c = 1 / (1 + step * d), 1 + step / c
            value *= c * d
        if abs(c * d - 1) < Decimal("1e-28"):
            return front * value


def tail_inverse(k, n, wanted):
    """p with Pr(at least k of n) = wanted, k ≥ 1: Newton's method on ln of the tail, within its bracket."""
    low, high, p = Decimal(0), Decimal(1), Decimal(k) / (n + 1)
    for _ in range(200):
        value = tail(k, n, p)
        low, high = (low, p) if value > wanted else (p, high)
        slope = k * log_mass(k, n, p).exp() / p
        new = p - value / slope * (value / wanted).ln()
        if not low < new < high:
            new = (low + high) / 2
        if abs(new - p) < p * Decimal("1e-22"):
            return new
        p = new
    return p

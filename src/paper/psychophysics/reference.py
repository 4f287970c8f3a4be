"""Expected values of the tests of the psychophysics analysis, by mpmath and scipy. Run by hand: python3 reference.py

Nothing here shares code or method with the library: likelihoods go through gamma functions and scipy's own laws,
maxima through Nelder and Mead, ends of intervals through Brent's method, moments of a deviance through simulation.
"""

import csv
import itertools
import pathlib

import mpmath as mp
import numpy as np
from scipy import optimize, stats
from scipy.special import betaln, erf, xlogy

mp.mp.dps = 40
ROWS = [r for r in csv.reader(open(pathlib.Path(__file__).parent / "table1.csv")) if not r[0].startswith("#")][1:]
TABLE = {}
for row in ROWS:
    TABLE.setdefault(row[1], []).append([int(x) for x in row[3:]])
TABLE = {name: np.array(rows) for name, rows in TABLE.items()}
DEPTHS = np.array([2.6, 4.6, 6.6, 8.6])
N = 30
CHI1 = stats.chi2.ppf(0.95, 1)
TIGHT = dict(xatol=1e-13, fatol=1e-13, maxiter=20000, maxfev=20000)


def tails():
    print("tails: shape or degrees, x, value")
    for a, x in [(0.5, 0.3), (0.5, 20), (4.5, 2), (4.5, 22), (18, 60), (1000, 1010), (1e6, 1.001e6)]:
        print("gamma", a, x, mp.nstr(mp.gammainc(a, x, mp.inf, regularized=True), 17))
    for x, a, b in [(0.7, 3, 7), (12.5, 3, 36), (1e-6, 1, 9), (2.2, 9, 2), (1.05, 1000, 1000)]:
        share = mp.mpf(b) / (b + mp.mpf(a) * mp.mpf(x))
        print("f", x, a, b, mp.nstr(mp.betainc(mp.mpf(b) / 2, mp.mpf(a) / 2, 0, share, regularized=True), 17))
    for c, v in [(0.95, 1), (0.95, 9), (0.95, 36), (0.999999, 3), (0.5, 1e6)]:
        def outside(t):
            return mp.betainc(mp.mpf(v) / 2, mp.mpf(1) / 2, 0, v / (v + t * t), regularized=True) - (1 - mp.mpf(c))
        print("t", c, v, mp.nstr(mp.findroot(outside, stats.t.ppf(0.5 + c / 2, v)), 17))


def clusters():
    print("clustered interval and dispersion")
    for name, counts in TABLE.items():
        for column in range(4):
            k = counts[:, column]
            p = k.sum() / 300
            half = stats.t.ppf(0.975, 9) * np.std(k / N, ddof=1) / np.sqrt(10)
            chi = stats.chi2_contingency(np.array([k, N - k]), correction=False)
            print(name, DEPTHS[column], repr(p - half), repr(p + half), repr(chi.statistic), repr(chi.pvalue))
    print("unequal trials (27/30, 50/60, 5/10, 9/20): linearised ratio")
    k, n = np.array([27, 50, 5, 9]), np.array([30, 60, 10, 20])
    p = k.sum() / n.sum()
    se = np.sqrt(4 / 3 * np.sum((k - p * n) ** 2)) / n.sum()
    chi = stats.chi2_contingency(np.array([k, n - k]), correction=False)
    print(repr(se), repr(chi.statistic), repr(chi.pvalue))


def beta_binomial_log(k, n, p, rho):
    if rho <= 0:
        return np.sum(stats.binom.logpmf(k, n, p) - stats.binom.logpmf(k, n, k / n) * 0)
    a, b = p * (1 - rho) / rho, (1 - p) * (1 - rho) / rho
    from scipy.special import gammaln
    return np.sum(gammaln(n + 1) - gammaln(k + 1) - gammaln(n - k + 1) + betaln(k + a, n - k + b) - betaln(a, b))


def beta_binomial():
    print("beta-binomial: p, its ends, rho, its ends, twice the gain")
    for name, column in [("direct contact", 0), ("FEM data", 0), ("FEM data", 2), ("direct contact", 3)]:
        k = TABLE[name][:, column]
        logistic = lambda x: 1 / (1 + np.exp(-x))
        f = lambda q: -beta_binomial_log(k, N, logistic(q[0]), logistic(q[1]))
        best = min((optimize.minimize(f, [np.log(k.sum() / (300 - k.sum())), r], method="Nelder-Mead", options=TIGHT)
                    for r in (-5, -3, -1)), key=lambda r: r.fun)
        p, rho, top = logistic(best.x[0]), logistic(best.x[1]), -best.fun
        flat = beta_binomial_log(k, N, k.sum() / 300, 0)
        over_p = lambda rho: -optimize.minimize_scalar(lambda p: -beta_binomial_log(k, N, p, rho),
                                                       bounds=(1e-6, 1 - 1e-6), method="bounded",
                                                       options=dict(xatol=1e-12)).fun
        over_rho = lambda p: max(beta_binomial_log(k, N, p, 0), -optimize.minimize_scalar(
            lambda x: -beta_binomial_log(k, N, p, logistic(x)), bounds=(-12, 6), method="bounded",
            options=dict(xatol=1e-10)).fun)
        g = lambda rho: over_p(rho) - top + CHI1 / 2
        h = lambda p: over_rho(p) - top + CHI1 / 2
        ends = [optimize.brentq(h, 0.3, p, xtol=1e-13), optimize.brentq(h, p, 1 - 1e-5, xtol=1e-13)]
        lower = 0.0 if flat >= top - CHI1 / 2 else optimize.brentq(g, 1e-6, rho, xtol=1e-14)
        upper = optimize.brentq(g, rho, 0.99, xtol=1e-14)
        print(name, DEPTHS[column], p, ends, rho, lower, upper, 2 * (top - flat))


def saturated(k, n):
    return np.sum(xlogy(k, k / n) + xlogy(n - k, (n - k) / n))


def log_binomial(k, n, p):
    return np.sum(xlogy(k, p) + xlogy(n - k, 1 - p))


def psychometric():
    print("psychometric: midpoint, spread (mm), lapse, deviance; ends of their intervals, binomial and dispersed")
    for name in TABLE:
        k = TABLE[name].sum(0)
        n = 300

        def loss(m, s, lapse):
            if s <= 0 or lapse < 0 or lapse > 0.5:
                return 1e9
            return -log_binomial(k, n, 0.5 + (0.5 - lapse) * stats.norm.cdf((m - DEPTHS) / s))

        def fit(fixed, value):
            free = [i for i in range(3) if i != fixed]
            best = None
            for start in itertools.product((5, 7, 8.5), (1, 2.5, 5), (0.0, 0.03, 0.1)):
                def f(q):
                    full = [0, 0, 0]
                    for i, x in zip(free, q):
                        full[i] = x
                    if fixed is not None:
                        full[fixed] = value
                    return loss(*full)
                r = optimize.minimize(f, [start[i] for i in free], method="Nelder-Mead", options=TIGHT)
                # The lapse at its limit 0 is a fit of its own.
                if 2 in free:
                    at = free.index(2)
                    q0 = [x for i, x in enumerate(r.x) if i != at]
                    r0 = optimize.minimize(lambda q: f(list(q[:at]) + [0.0] + list(q[at:])), q0,
                                           method="Nelder-Mead", options=TIGHT)
                    if r0.fun < r.fun:
                        r = r0
                        r.x = np.array(list(r0.x[:at]) + [0.0] + list(r0.x[at:]))
                if best is None or r.fun < best.fun:
                    best = r
            return best

        best = fit(None, None)
        print(name, best.x, 2 * (saturated(k, n) + best.fun))
        counts = TABLE[name]
        phi = sum(stats.chi2_contingency(np.array([c, N - c]), correction=False).statistic for c in counts.T) / 36
        for label, drop in [("binomial", CHI1 / 2), ("dispersed", phi * stats.t.ppf(0.975, 36) ** 2 / 2)]:
            for i, ends in [(0, (3.5, 12)), (1, (0.5, 9)), (2, (0, 0.3))]:
                g = lambda x: -fit(i, x).fun + best.fun + drop
                lower = optimize.brentq(g, ends[0], best.x[i], xtol=1e-9) if g(ends[0]) < 0 else None
                print("  ", label, i, lower, optimize.brentq(g, best.x[i], ends[1], xtol=1e-9))


SIGNALS = {"falling": np.array([0.26, 0.17, 0.09, 0.05]), "level": np.array([0.61, 0.44, 0.31, 0.28])}


def bridge():
    rng = np.random.default_rng(1999)
    for name in ("FEM data", "measured data"):
        X = TABLE[name]
        K = X.sum(0)
        for label, s in SIGNALS.items():
            rate = lambda sd, lapse=0: 0.5 + (0.5 - lapse) * erf(s / sd / 2)
            f = lambda a: -log_binomial(K, 300, rate(np.exp(a)))
            r = optimize.minimize_scalar(f, bracket=(-3, -1), method="brent", tol=1e-12)
            sd, deviance = np.exp(r.x), 2 * (saturated(K, 300) + r.fun)
            g = lambda q: 1e9 if q[1] < 0 else -log_binomial(K, 300, rate(np.exp(q[0]), q[1]))
            b = min((optimize.minimize(g, [r.x + d, 0.02], method="Nelder-Mead", options=TIGHT) for d in (0, -0.3)),
                    key=lambda r: r.fun)
            print(name, label, "common", sd, deviance, "lapse", np.exp(b.x[0]), b.x[1], 2 * (saturated(K, 300) + b.fun))
            P, S = X.mean(0) / N, np.cov((X / N).T)
            t = min((optimize.minimize_scalar(lambda a: 10 * (P - rate(np.exp(a))) @ np.linalg.solve(S, P - rate(np.exp(a))),
                                              bounds=(x, x + 1), method="bounded", options=dict(xatol=1e-12))
                     for x in np.arange(-5, 1)), key=lambda r: r.fun).fun
            print("   Hotelling", stats.f.sf(7 / (3 * 9) * t, 3, 7))
            # Scores by differences of the log-likelihood of each subject.
            h = 1e-5
            score = np.array([(log_binomial(x, N, rate(np.exp(r.x + h))) - log_binomial(x, N, rate(np.exp(r.x - h)))) / (2 * h) for x in X])
            p = rate(sd)
            dp = (rate(np.exp(r.x + h)) - rate(np.exp(r.x - h))) / (2 * h)
            info = np.sum(300 * dp ** 2 / (p * (1 - p)))
            reach = stats.t.ppf(0.975, 9) * np.sqrt(10 / 9 * np.sum(score ** 2)) / info
            print("   noise", sd * np.exp(-reach), sd * np.exp(reach))
            alone = [optimize.minimize_scalar(lambda a: -log_binomial(x, N, rate(np.exp(a))), bounds=(-6, 3),
                                              method="bounded", options=dict(xatol=1e-12)) for x in X]
            own = np.exp([a.x for a in alone])
            total = sum(2 * (saturated(x, N) + a.fun) for x, a in zip(X, alone))
            print("   by subject", total, list(own[:3]))
            # The law of that deviance, if it is true: new answers, new fits on a fine grid.
            grid = np.exp(np.linspace(-7, 3, 2001))
            table = np.clip(0.5 + 0.5 * erf(s[None, :] / grid[:, None] / 2), 1e-300, 1 - 1e-15)
            def deviances(X):
                l = X @ np.log(table).T + (N - X) @ np.log1p(-table).T
                sat = (xlogy(X, X / N) + xlogy(N - X, (N - X) / N)).sum(1)
                return 2 * (sat - l.max(1)).sum()
            P1 = np.array([0.5 + 0.5 * erf(s / o / 2) for o in own])
            draws = np.array([deviances(rng.binomial(N, P1)) for _ in range(10000)])
            print("   simulated mean, sd, p", draws.mean(), draws.std(), (draws >= total).mean())


def sweeps():
    """Weights of the level over sweeps: fits by Brent's method, the expected deviance and p by new answers and new fits."""
    rng = np.random.default_rng(1999)
    with open(pathlib.Path(__file__).parent / "bridge" / "signals.csv") as file:
        rows = np.array([[float(x) for x in r] for r in list(csv.reader(file))[2:]])
    x = np.concatenate([-rows[:0:-1, 0], rows[:, 0]])
    channels = [np.concatenate([sign * rows[:0:-1, k:k + 4], rows[:, k:k + 4]]) for k, sign in ((1, 1), (5, -1))]

    def strengths(half, peak, channel, w):
        f = channels[channel][np.abs(x) <= half + 1e-9]
        f = f - (1 - w) * f.mean(0)
        return np.abs(f).max(0) if peak else np.sqrt((f ** 2).mean(0))

    def fits(X, s):
        """Each subject's ln of the noise and deviance."""
        def loss(a, k):
            return -log_binomial(k, N, 0.5 + 0.5 * erf(s / np.exp(a) / 2))
        grid = np.linspace(np.log(s.max()) - 3, np.log(s.max()) + 5, 161)
        table = np.clip(0.5 + 0.5 * erf(s[None, :] / np.exp(grid)[:, None] / 2), 1e-300, 1 - 1e-16)
        found = []
        for k in X:
            at = grid[(np.log(table) @ k + np.log1p(-table) @ (N - k)).argmax()]
            found.append(optimize.minimize_scalar(loss, args=(k,), bounds=(at - 0.1, at + 0.1), method="bounded",
                                                  options=dict(xatol=1e-10)))
        return np.array([r.x for r in found]), sum(2 * (saturated(k, N) + r.fun) for k, r in zip(X, found))

    def simulated(X, s, draws=10000):
        """The deviances of new answers to the fit, each fitted anew on a fine grid."""
        own = np.exp(fits(X, s)[0])
        grid = np.exp(np.linspace(np.log(s.min()) - 4, np.log(s.max()) + 5, 1501))
        table = np.clip(0.5 + 0.5 * erf(s[None, :] / grid[:, None] / 2), 1e-300, 1 - 1e-15)
        total = np.zeros(draws)
        for noise in own:
            K = rng.binomial(N, 0.5 + 0.5 * erf(s / noise / 2), (draws, 4))
            top = (K @ np.log(table).T + (N - K) @ np.log1p(-table).T).max(1)
            total += 2 * ((xlogy(K, K / N) + xlogy(N - K, (N - K) / N)).sum(1) - top)
        return total

    print("weights: deviance at 1, at 0, lateral; best weight, phi, p of 1, range left of 48; p around its end; p of 0 alone")
    for name, half, peak in [("direct contact", 3, 1), ("direct contact", 6, 1), ("direct contact", 10, 0),
                             ("FEM data", 3, 1), ("FEM data", 6, 1), ("FEM data", 7, 1), ("FEM data", 10, 1),
                             ("FEM data", 10, 0), ("measured data", 3, 1), ("measured data", 7, 1), ("measured data", 10, 0)]:
        X = TABLE[name]
        W = np.arange(21) / 20
        D = np.array([fits(X, strengths(half, peak, 0, w))[1] for w in W])
        best = D.argmin()
        null = simulated(X, strengths(half, peak, 0, W[best]))
        phi = max(1, D[best] / null.mean())
        p = stats.f.sf((D - D[best]) / phi, 1, 29)
        left = np.where(p >= 0.05 / 48)[0]
        alone = (simulated(X, strengths(half, peak, 0, 0.0)) >= D[0]).mean()
        print(name, half, "peak" if peak else "all", D[-1], D[0], fits(X, strengths(half, peak, 1, 1.0))[1], W[best],
              phi, p[-1], W[left[0]], W[left[-1]], p[left[-1]], p[min(left[-1] + 1, 20)], alone)


if __name__ == "__main__":
    tails()
    clusters()
    beta_binomial()
    psychometric()
    bridge()
    sweeps()

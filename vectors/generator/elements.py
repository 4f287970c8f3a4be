"""Stiffness of 6-node triangles in plane strain (FEM-005, VEC-011).

Straight sides: the integrand is quadratic, the rule of the sides' middles is exact, and all is in exact fractions.
Curved sides: the integrand is rational, and the answer is that of Cowper's six points, in 50 digits.

Implements: VEC-011.
"""

from fractions import Fraction

from mpmath import cos, mpf, pi, sin, sqrt

from .numbers import UNIT, Draws, exact, nearest, real
from .suite import Group, absolute, case_by_case, refuse_common


def three_points(number):
    """Middles of the sides: exact to degree 2."""
    half, zero, weight = number(Fraction(1, 2)), number(Fraction(0)), number(Fraction(1, 6))
    return [((half, half, zero), weight), ((zero, half, half), weight), ((half, zero, half), weight)]


def cowper():
    """Six points, exact to degree 4 (Cowper 1973), in closed form; the weights add up to ½."""
    root10, points = sqrt(mpf(10)), []
    for sign in (1, -1):
        a = (8 - root10 + sign * sqrt(38 - 44 * sqrt(mpf(2) / 5))) / 18
        weight = (620 + sign * sqrt(213125 - 53320 * root10)) / 3720 / 2
        b = 1 - 2 * a
        points += [((b, a, a), weight), ((a, b, a), weight), ((a, a, b), weight)]
    return points


def gradients(area_coordinates):
    """∂N/∂ξ and ∂N/∂η, with ξ = L2, η = L3, L1 = 1 − ξ − η."""
    l1, l2, l3 = area_coordinates
    by_xi = [1 - 4 * l1, 4 * l2 - 1, 0 * l1, 4 * (l1 - l2), 4 * l3, -4 * l3]
    by_eta = [1 - 4 * l1, 0 * l1, 4 * l3 - 1, -4 * l2, 4 * l2, 4 * (l1 - l3)]
    return by_xi, by_eta


def elasticity(modulus, ratio, plane_stress=False):
    """D for (ε_x, ε_y, γ_xy): its first, second and last number."""
    mu = modulus / (2 * (1 + ratio))
    lam = 2 * mu * ratio / (1 - ratio) if plane_stress else modulus * ratio / ((1 + ratio) * (1 - 2 * ratio))
    return lam + 2 * mu, lam, mu


def stiffness(nodes, points, law, shear=1):
    """Σ w det J Bᵀ D B, u₁ v₁ u₂ v₂ …; `shear` scales γ_xy."""
    first, second, mu = law
    k = [[0] * 12 for _ in range(12)]
    for where, weight in points:
        by_xi, by_eta = gradients(where)
        x_xi, y_xi, x_eta, y_eta = (sum(g * n[c] for g, n in zip(by, nodes)) for by in (by_xi, by_eta) for c in (0, 1))
        jacobian = x_xi * y_eta - y_xi * x_eta
        assert jacobian > 0
        by_x = [(y_eta * a - y_xi * b) / jacobian for a, b in zip(by_xi, by_eta)]
        by_y = [(x_xi * b - x_eta * a) / jacobian for a, b in zip(by_xi, by_eta)]
        volume = weight * jacobian
        g = mu * shear * shear
        for a in range(6):
            for b in range(6):
                k[2 * a][2 * b] += volume * (first * by_x[a] * by_x[b] + g * by_y[a] * by_y[b])
                k[2 * a][2 * b + 1] += volume * (second * by_x[a] * by_y[b] + g * by_y[a] * by_x[b])
                k[2 * a + 1][2 * b] += volume * (second * by_y[a] * by_x[b] + g * by_x[a] * by_y[b])
                k[2 * a + 1][2 * b + 1] += volume * (first * by_y[a] * by_y[b] + g * by_x[a] * by_x[b])
    return k


def middles(corners):
    """The six nodes of a straight triangle; corners on a coarse binary grid, so that the middles are floats."""
    (x1, y1), (x2, y2), (x3, y3) = corners
    return [*corners, [(x1 + x2) / 2, (y1 + y2) / 2], [(x2 + x3) / 2, (y2 + y3) / 2], [(x3 + x1) / 2, (y3 + y1) / 2]]


def is_straight(nodes):
    e = [[exact(v) for v in node] for node in nodes]
    sides = ((0, 1, 3), (1, 2, 4), (2, 0, 5))
    return all(e[a][c] + e[b][c] == 2 * e[m][c] for a, b, m in sides for c in (0, 1))


def spread(nodes):
    """Largest coordinate over the smallest height of the corners' triangle: how far their differences cancel."""
    p = [[exact(v) for v in node] for node in nodes[:3]]
    area = abs((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]))
    longest = max((p[a][0] - p[b][0]) ** 2 + (p[a][1] - p[b][1]) ** 2 for a, b in ((0, 1), (1, 2), (2, 0)))
    return max(abs(v) for node in p for v in node) * exact(sqrt(real(longest))) / area


UNIT_TRIANGLE = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]


# Verifies: FEM-005.
def element_stiffness():
    group = Group(
        "element_stiffness",
        "straight sides: exact fractions; curved sides: Cowper's rule, mpmath 1.3.0 at 50 digits",
        case_by_case(["stiffness"], "N/m²"),
    )
    draws = Draws(80)
    grid = 2.0**-14
    for kind, corners, modulus, ratio in (
        ("unit triangle", UNIT_TRIANGLE, 1.0, 0.25),
        ("unit triangle, ν = 0", UNIT_TRIANGLE, 1.0, 0.0),
        ("unit triangle, ν < 0", UNIT_TRIANGLE, 1.0, -0.5),
        ("the gel", [[0.0, 0.0], [8 * grid, 0.0], [0.0, 8 * grid]], 5000.0, 0.49),
        ("the skin", [[0.0, -4 * grid], [8 * grid, -4 * grid], [8 * grid, 0.0]], 180000.0, 0.49),
        ("the disc", [[2 * grid, 2 * grid], [9 * grid, 4 * grid], [3 * grid, 11 * grid]], 1.2e6, 0.49),
        ("a sliver", [[0.0, 0.0], [64 * grid, 0.0], [32 * grid, 2 * grid]], 5000.0, 0.49),
        ("far from the origin", [[1.0, 1.0], [1.0 + 8 * grid, 1.0], [1.0, 1.0 + 8 * grid]], 5000.0, 0.3),
        ("nearly incompressible", [[0.0, 0.0], [16 * grid, 4 * grid], [2 * grid, 16 * grid]], 5000.0, 0.4995),
    ):
        element_case(group, kind, middles(corners), modulus, ratio)
    for number in range(12):
        corners = [[draws.integer(-40, 40) * 2 * grid, draws.integer(-100, 0) * 2 * grid] for _ in range(3)]
        (x1, y1), (x2, y2), (x3, y3) = corners
        area = (x2 - x1) * (y3 - y1) - (y2 - y1) * (x3 - x1)
        if abs(area) < 400 * grid * grid:
            corners = [[0.0, 0.0], [10 * grid, 2 * grid * number], [-4 * grid, 30 * grid]]
        elif area < 0:
            corners = [corners[0], corners[2], corners[1]]
        modulus, ratio = draws.choice([5000.0, 180000.0, 1.2e6]), draws.choice([0.3, 0.45, 0.49])
        element_case(group, "drawn, straight", middles(corners), modulus, ratio)
    for number in range(12):
        angle, radius = draws.integer(0, 11), 0.0032
        arc = rim(radius, angle)
        outer = [arc[2][0] * 1.25, arc[2][1] * 1.25]
        nodes = middles([arc[0], [arc[0][0] * 1.2, arc[0][1] * 1.2], arc[1]])
        nodes[5] = arc[2]
        if number % 2:
            nodes[4] = [nodes[4][k] + 0.01 * (outer[k] - arc[2][k]) for k in (0, 1)]
        element_case(group, "a side on the disc's rim", nodes, 5000.0 if number % 3 else 1.2e6, 0.49)
    refuse_elements(group)
    return group


def refuse_elements(group):
    nodes = middles(UNIT_TRIANGLE)
    args = {"nodes_m": nodes, "youngs_modulus_pa": 5000.0, "poissons_ratio": 0.3}
    refuse_common(group, args, ["youngs_modulus_pa", "poissons_ratio"], ["nodes_m"])
    group.refuse("corners clockwise", args, "inverted_element", nodes_m=[nodes[k] for k in (0, 2, 1, 5, 4, 3)])
    group.refuse("no area", args, "inverted_element", nodes_m=middles([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]))
    pulled = [*nodes[:3], [1.5, 0.9], *nodes[4:]]
    group.refuse("a middle pulled beyond a corner", args, "inverted_element", nodes_m=pulled)
    group.refuse("all nodes at one place", args, "inverted_element", nodes_m=[[0.5, 0.5]] * 6)
    group.refuse("five nodes", args, "lengths_differ", nodes_m=nodes[:5])
    group.refuse("seven nodes", args, "lengths_differ", nodes_m=[*nodes, [0.0, 0.0]])
    group.refuse("a node in space", args, "lengths_differ", nodes_m=[*nodes[:5], [0.0, 0.5, 0.0]])
    for modulus in (0, -5000.0):
        group.refuse(f"modulus {modulus!r}", args, "out_of_range", youngs_modulus_pa=modulus)
    for ratio in (0.5, -1, 0.75, -2):
        group.refuse(
            f"Poisson's ratio {ratio!r}",
            args,
            "infinite_answer" if ratio in (0.5, -1) else "out_of_range",
            poissons_ratio=ratio,
        )


def rim(radius, k):
    """Points of a circle at 30 k°, 15° on, and half way between them, as floats."""
    angles = [pi * (60 * k + part) / 360 for part in (0, 30, 15)]
    return [[nearest(radius * cos(a)), nearest(radius * sin(a))] for a in angles]


def element_case(group, kind, nodes, modulus, ratio):
    straight = is_straight(nodes)
    number = exact if straight else lambda value: real(exact(value))
    points = three_points(number) if straight else cowper()
    p = [[number(v) for v in node] for node in nodes]
    e, nu = number(modulus), number(ratio)
    law = elasticity(e, nu)
    k = stiffness(p, points, law)
    order = [2 * (i % 6) + i // 6 for i in range(12)]
    wrong = [("plane_stress", stiffness(p, points, elasticity(e, nu, plane_stress=True)))]
    if straight:
        wrong.append(("blocked_unknowns", [[k[i][j] for j in order] for i in order]))
        wrong.append(("area_twice", [[2 * v for v in row] for row in k]))
        wrong.append(("shear_strain_halved", stiffness(p, points, law, shear=number(Fraction(1, 2)))))
    else:
        corners = middles([list(map(exact, node)) for node in nodes[:3]])
        wrong.append(("straightened", stiffness([[number(v) for v in node] for node in corners], points, law)))
        wrong.append(("rule_of_degree_2", stiffness(p, three_points(number), law)))
    order = (0, 1, 2, 3, 4, 5, 8, 9, 10, 11, 6, 7)
    wrong.append(("midside_order", [[k[i][j] for j in order] for i in order]))
    # Two of the bugs for each case, in turn: a matrix is long.
    turn = len(group.cases)
    wrong = [wrong[(turn + i) % len(wrong)] for i in range(2)]
    largest = max(abs(exact(v)) for row in k for v in row)
    reason = (
        "2⁻⁵³ max|K| (64 for the sums and the rule's points, 64 (largest coordinate)/(height) for the Jacobian, "
        "whose differences cancel)"
    )
    limits = {"stiffness": absolute((64 + 64 * spread(nodes)) * UNIT * largest, "N/m²", reason)}
    args = {"nodes_m": nodes, "youngs_modulus_pa": modulus, "poissons_ratio": ratio}
    # Entries that are exactly 0 stay real numbers.
    answer = lambda matrix: {"stiffness": [[exact(v) for v in row] for row in matrix]}
    group.accept(kind, args, answer(k), [(flag, answer(other)) for flag, other in wrong], tolerance=limits)


GROUPS = [element_stiffness]

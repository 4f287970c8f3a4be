"""The stored errors of the manufactured solutions and of Lame's cylinder, by scikit-fem.

Same meshes and exact solutions as manufactured.rs and cylinder.rs; elements, assembly, boundary integrals and norms are
scikit-fem's, with another quadrature (degree 10). Stiffness is integrated by a rule of degree 4, since on bent elements
that is part of the method. Run by hand: python3 reference.py
"""

import numpy as np
from skfem import (
    Basis, BilinearForm, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshTri1, MeshTri2, condense, solve,
)
from skfem.helpers import ddot, eye, sym_grad, trace

PI = np.pi


def lame(e, nu):
    return e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))


def lattice(columns, rows, bend, rising):
    """The mesh of Problem::lattice, and the lattice's coordinates of each of its nodes."""
    corner = np.array([[i / columns, j / rows] for i in range(columns + 1) for j in range(rows + 1)])
    at = lambda i, j: i * (rows + 1) + j
    cells = [(i, j) for i in range(columns) for j in range(rows)]
    triangles = []
    for i, j in cells:
        a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
        up = rising((i + 0.5) / columns, (j + 0.5) / rows)
        triangles += [[a, b, c], [a, c, d]] if up else [[a, b, d], [b, c, d]]
    flat = MeshTri1(corner.T.copy(), np.array(triangles).T.copy())
    places = np.concatenate([corner, flat.p[:, flat.facets].mean(axis=1).T])
    return MeshTri2(np.array([bend(*c) for c in places]).T.copy(), flat.t), places


def setup(mesh, lam, mu):
    element = ElementVector(ElementTriP2())

    @BilinearForm
    def elasticity(u, v, w):
        strain = sym_grad(u)
        return ddot(lam * eye(trace(strain), 2) + 2 * mu * strain, sym_grad(v))

    matrix = elasticity.assemble(Basis(mesh, element, intorder=4))
    return matrix, Basis(mesh, element, intorder=10), element


def unknowns(basis):
    """Displacement i of each node, in the order of the lattice's places."""
    return np.concatenate([basis.nodal_dofs, basis.facet_dofs], axis=1)


def norms(basis, u, displacement, gradient, lam, mu):
    field, x = basis.interpolate(u), basis.global_coordinates().value
    stress = lambda g: lam * eye(g[0, 0] + g[1, 1], 2) + mu * (g + np.swapaxes(g, 0, 1))
    def ratio(found, exact):
        norm = lambda v: np.sum(v * v * basis.dx) ** 0.5
        return norm(found - exact) / norm(exact)
    g, exact = np.array(field.grad), gradient(*x)
    # Stress as the vector (xx, yy, zz, xy).
    four = lambda g: np.array([*(stress(g)[i, j] for i, j in [(0, 0), (1, 1)]), lam * (g[0, 0] + g[1, 1]), stress(g)[0, 1]])
    return ratio(np.array(field), displacement(*x)), ratio(g, exact), ratio(four(g), four(exact))


def manufactured(n, nu):
    lam, mu = lame(1.0, nu)
    a, b, p, q = 1.0, -0.5, 2.0, 3.0
    bend = lambda x, y: (x + 0.06 * np.sin(2 * PI * y) + 0.04 * np.sin(2 * PI * x), y + 0.08 * np.sin(2 * PI * x))
    displacement = lambda x, y: np.array([a * np.sin(p * x) * np.sin(q * y), b * np.cos(p * x) * np.cos(q * y)])
    gradient = lambda x, y: np.array([
        [a * p * np.cos(p * x) * np.sin(q * y), a * q * np.sin(p * x) * np.cos(q * y)],
        [-b * p * np.sin(p * x) * np.cos(q * y), -b * q * np.cos(p * x) * np.sin(q * y)],
    ])
    mesh, places = lattice(n, n, bend, lambda x, y: (x > 0.5) == (y > 0.5))
    matrix, basis, _ = setup(mesh, lam, mu)

    @LinearForm
    def body(v, w):
        x, y = w.x
        share, u = (lam + mu) * (a * p - b * q), displacement(x, y)
        f = [
            share * p * np.sin(p * x) * np.sin(q * y) + mu * (p * p + q * q) * u[0],
            -share * q * np.cos(p * x) * np.cos(q * y) + mu * (p * p + q * q) * u[1],
        ]
        return f[0] * v[0] + f[1] * v[1]

    border = ((places == 0) | (places == 1)).any(axis=1)
    numbers = unknowns(basis)
    u = np.zeros(basis.N)
    positions = np.array([bend(*c) for c in places]).T
    u[numbers[:, border]] = displacement(*positions)[:, border]
    u = solve(*condense(matrix, body.assemble(basis), x=u, D=numbers[:, border].ravel()))
    return norms(basis, u, displacement, gradient, lam, mu)


def cylinder(cells, radii, e, nu):
    (inner, outer), (lam, mu) = radii, lame(e, nu)
    share = (1 + nu) * inner**2 / (e * (outer**2 - inner**2))
    linear, inverse = share * (1 - 2 * nu), share * outer**2
    displacement = lambda x, y: np.array([x, y]) * (linear + inverse / (x * x + y * y))
    def gradient(x, y):
        square = (x * x + y * y) ** 2
        even, odd = inverse * (y * y - x * x) / square, -2 * inverse * x * y / square
        return np.array([[linear + even, odd], [odd, linear - even]])
    def bend(s, t):
        r, angle = inner + (outer - inner) * s, PI / 2 * t
        return r * np.cos(angle), r * np.sin(angle)
    mesh, places = lattice(*cells, bend, lambda x, y: True)
    matrix, basis, element = setup(mesh, lam, mu)
    near = lambda x: np.hypot(*x) < inner * (1 + 1e-2)
    pressed = FacetBasis(mesh, element, facets=mesh.facets_satisfying(near, boundaries_only=True), intorder=10)
    load = LinearForm(lambda v, w: -(w.n[0] * v[0] + w.n[1] * v[1])).assemble(pressed)
    numbers = unknowns(basis)
    held = np.concatenate([numbers[1, places[:, 1] == 0], numbers[0, places[:, 1] == 1]])
    u = solve(*condense(matrix, load, D=held))
    return norms(basis, u, displacement, gradient, lam, mu)


def show(what, values):
    print(what, ", ".join(f"{value:.6e}" for value in values))


for nu in [0.3, 0.49]:
    errors = np.array([manufactured(n, nu) for n in [4, 8, 16, 32]]).T
    show(f"manufactured, nu = {nu}, L2", errors[0])
    show(f"manufactured, nu = {nu}, H1", errors[1])
errors = np.array([cylinder((n, 2 * n), (1.0, 2.0), 1000.0, 0.49) for n in [2, 4, 8, 16, 32]]).T
show("cylinder, displacement", errors[0])
show("cylinder, stress", errors[2])

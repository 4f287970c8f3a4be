"""Stiffness of a mesh of 6-node triangles by scikit-fem, for tests/witness/scikit_fem.rs.

Reads from stdin: a line `nodes elements`; the nodes' x y; each element's six nodes (corners, then the middles of edges
01, 12, 20), then its Young's modulus and Poisson's ratio. Writes the upper triangle's entries `row column value`, in
which displacement i of node a is number 2a + i, per metre of thickness.
"""

import sys

import numpy as np
from skfem import Basis, BilinearForm, ElementTriP0, ElementTriP2, ElementVector, MeshTri1, MeshTri2
from skfem.helpers import ddot, eye, sym_grad, trace


@BilinearForm
def elasticity(u, v, w):
    strain = sym_grad(u)
    stress = w.lam * eye(trace(strain), 2) + 2.0 * w.mu * strain
    return ddot(stress, sym_grad(v))


def rows(table):
    """The transpose, in the order of memory that scikit-fem wants."""
    return np.ascontiguousarray(table.T)


def main():
    numbers = np.array(sys.stdin.read().split(), dtype=float)
    nodes, elements = numbers[:2].astype(int)
    rest = numbers[2:]
    position = rest[: 2 * nodes].reshape(nodes, 2)
    table = rest[2 * nodes:].reshape(elements, 8)
    nodes_of = table[:, :6].astype(int)

    # scikit-fem numbers the corners first, then the middles of its own list of edges.
    corners = np.unique(nodes_of[:, :3])
    number = np.full(nodes, -1)
    number[corners] = np.arange(len(corners))
    straight = MeshTri1(rows(position[corners]), rows(number[nodes_of[:, :3]]), sort_t=False)
    middle = {}
    for k, (a, b) in enumerate([(0, 1), (1, 2), (2, 0)]):
        for first, second, node in zip(nodes_of[:, a], nodes_of[:, b], nodes_of[:, 3 + k]):
            middle[frozenset((number[first], number[second]))] = node
    middles = np.array([middle[frozenset(edge)] for edge in straight.facets.T])
    ours = np.concatenate([corners, middles])
    mesh = MeshTri2(rows(position[ours]), straight.t, sort_t=False)

    modulus, ratio = table[:, 6], table[:, 7]
    lam = modulus * ratio / ((1 + ratio) * (1 - 2 * ratio))
    mu = modulus / (2 * (1 + ratio))
    # The rule of degree 4: six points.
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    assert basis.X.shape == (2, 6), basis.X
    constant = Basis(mesh, ElementTriP0(), intorder=4)
    matrix = elasticity.assemble(basis, lam=constant.interpolate(lam), mu=constant.interpolate(mu)).tocoo()

    # Our number of each of scikit-fem's unknowns.
    unknown = np.empty(basis.N, dtype=int)
    for i in range(2):
        unknown[basis.nodal_dofs[i]] = 2 * corners + i
        unknown[basis.facet_dofs[i]] = 2 * middles + i
    for row, column, value in zip(unknown[matrix.row], unknown[matrix.col], matrix.data):
        if row <= column:
            print(row, column, repr(float(value)))


main()

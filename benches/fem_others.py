#!/usr/bin/env python3
"""palpate against scikit-fem with a sparse solver and against CalculiX, on the same mesh, in one run.

    python3 benches/fem_others.py

Needs NumPy, SciPy with its SuperLU and scikit-fem; takes CHOLMOD (scikit-sparse), PARDISO (pypardiso) and CalculiX
(`ccx`) where they are installed. Each program assembles the default mesh of the 2.6 mm phantom by itself. The times begin
with the mesh and cover:

* palpate: stiffness matrix, factor, compliance of the surface;
* scikit-fem: assembly, factor, and the solves that make the same compliance (one for each surface unknown);
* CalculiX: one linear step under one load, from the input file to the result.

Every program has one thread. The displacements of the surface under the load must agree: with scikit-fem, which integrates
with the same rule, to 1e-8 of the largest; with CalculiX, whose CPE6 takes 3 points where palpate takes 6, to 1e-2. The
exit code is 1 where they do not.
"""
import os

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[threads] = "1"

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg

ROOT = pathlib.Path(__file__).resolve().parent.parent


def palpate(folder):
    """palpate's mesh, load, result and times."""
    path = folder / "palpate.json"
    command = ["cargo", "bench", "--quiet", "-p", "palpate-benches", "--bench", "fem_others", "--", str(path)]
    subprocess.run(command, cwd=ROOT, check=True)
    return {name: np.array(values) for name, values in json.loads(path.read_text()).items()}


def solvers():
    """The sparse direct solvers at hand: each name and a function from a matrix to a function that solves."""
    try:
        from sksparse.cholmod import cholesky

        yield "CHOLMOD", cholesky
    except ImportError:
        pass
    try:
        import pypardiso

        def pardiso(matrix):
            handle, rows = pypardiso.PyPardisoSolver(), matrix.tocsr()
            handle.factorize(rows)
            return lambda right: handle.solve(rows, right)

        yield "PARDISO", pardiso
    except ImportError:
        pass
    options = {"SymmetricMode": True}

    def superlu(matrix):
        lu = scipy.sparse.linalg.splu(matrix, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
        return lu.solve

    yield "SuperLU", superlu


def scikit_fem(data, factorise):
    """Surface displacements under the load, and the times after assembly, factor and compliance."""
    import skfem

    start = time.perf_counter()
    points = data["nodes_m"].T
    cells = data["connectivity"].reshape(-1, 6).T
    mesh = skfem.MeshTri2(points, cells, sort_t=False)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTriP2()), intorder=4)
    youngs, nu = data["youngs_modulus_pa"], data["poisson_ratio"]
    shape = (len(youngs), basis.X.shape[-1])
    lame = (youngs * nu / ((1 + nu) * (1 - 2 * nu)), youngs / (2 * (1 + nu)))
    lam, mu = (np.broadcast_to(value[:, None], shape) for value in lame)
    from skfem.helpers import ddot, div, sym_grad

    @skfem.BilinearForm
    def stiffness(u, v, w):
        return w.lam * div(u) * div(v) + 2 * w.mu * ddot(sym_grad(u), sym_grad(v))

    matrix = data["length_m"] * stiffness.assemble(basis, lam=lam, mu=mu)
    # Its unknowns, found by their places: two at each of our nodes.
    def key(at):
        return tuple(np.round(at * 1e10).astype(int))

    place = {key(at): node for node, at in enumerate(points.T)}
    of_node = np.zeros((points.shape[1], 2), dtype=int)
    for dofs in (basis.nodal_dofs, basis.facet_dofs):
        for direction in range(2):
            for dof in dofs[direction]:
                of_node[place[key(basis.doflocs[:, dof])], direction] = dof
    free = of_node[~data["held"]].ravel()
    rank = np.full(basis.N, -1)
    rank[free] = np.arange(len(free))
    matrix = sparse.csc_matrix(matrix[free][:, free])
    assembled = time.perf_counter() - start
    solve = factorise(matrix)
    factorised = time.perf_counter() - start
    surface = rank[of_node[data["surface"]].ravel()]
    rights = np.zeros((len(free), len(surface)))
    rights[surface, np.arange(len(surface))] = 1.0
    compliance = solve(rights)[surface]
    done = time.perf_counter() - start
    return compliance @ data["load_n"], [assembled, factorised, done]


def calculix(data, folder):
    """Surface displacements under the load, and the time of the run; `None` without CalculiX."""
    program = shutil.which("ccx")
    if program is None:
        return None
    # A field of its input holds 20 characters.
    number = "{:.12e}".format
    deck = ["*NODE, NSET=ALL"]
    deck += [f"{k + 1}, {number(x)}, {number(y)}, 0." for k, (x, y) in enumerate(data["nodes_m"].tolist())]
    cells = data["connectivity"].reshape(-1, 6) + 1
    materials = sorted(set(zip(data["youngs_modulus_pa"].tolist(), data["poisson_ratio"].tolist())))
    for index, (youngs, nu) in enumerate(materials):
        deck.append(f"*ELEMENT, TYPE=CPE6, ELSET=E{index}")
        chosen = (data["youngs_modulus_pa"] == youngs) & (data["poisson_ratio"] == nu)
        deck += [f"{k + 1}, " + ", ".join(map(str, cells[k])) for k in np.flatnonzero(chosen)]
        deck += [f"*MATERIAL, NAME=M{index}", "*ELASTIC", f"{number(youngs)}, {number(nu)}"]
        deck += [f"*SOLID SECTION, ELSET=E{index}, MATERIAL=M{index}", number(data["length_m"])]
    deck.append("*BOUNDARY")
    deck += [f"{k + 1}, 1, 2" for k in np.flatnonzero(data["held"])]
    surface = data["surface"]
    deck += ["*NSET, NSET=SURFACE"] + [f"{node + 1}," for node in surface]
    deck += ["*STEP", "*STATIC", "*CLOAD"]
    loads = data["load_n"].reshape(-1, 2).tolist()
    deck += [f"{n + 1}, {d + 1}, {number(f[d])}" for n, f in zip(surface, loads) for d in range(2)]
    deck += ["*NODE PRINT, NSET=SURFACE", "U", "*END STEP", ""]
    (folder / "deck.inp").write_text("\n".join(deck))
    start = time.perf_counter()
    subprocess.run([program, "deck"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    took = time.perf_counter() - start
    rows = {}
    for line in (folder / "deck.dat").read_text().splitlines():
        words = line.split()
        if len(words) == 4 and words[0].isdigit():
            rows[int(words[0]) - 1] = [float(word) for word in words[1:3]]
    return np.array([rows[node] for node in surface]).ravel(), took


def main():
    agree = True
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        data = palpate(folder)
        ours, times = data["displacement_m"], data["times_s"]
        print(f"{len(data['held'])} nodes, {len(ours)} surface unknowns")
        print(f"palpate: assembled {times[0]:.4f} s, factorised {times[1]:.4f} s, compliance {times[2]:.4f} s")

        def compare(other, tolerance):
            nonlocal agree
            error = np.abs(other - ours).max() / np.abs(ours).max()
            agree &= bool(error <= tolerance)
            return f"surface displacements differ by {error:.1e} of the largest (limit {tolerance:g})"

        for solver, factorise in solvers():
            theirs, their_times = scikit_fem(data, factorise)
            steps = ", ".join(
                f"{step} {seconds:.3f} s ({seconds / mine:.0f} times palpate's)"
                for step, seconds, mine in zip(("assembled", "factorised", "compliance"), their_times, times)
            )
            print(f"scikit-fem, {solver}: {steps}; {compare(theirs, 1e-8)}")
        result = calculix(data, folder)
        if result is None:
            print("CalculiX: ccx is not installed, left out")
        else:
            theirs, took = result
            print(f"CalculiX, one load: {took:.3f} s ({took / times[2]:.0f} times palpate's); {compare(theirs, 1e-2)}")
    sys.exit(0 if agree else 1)


if __name__ == "__main__":
    main()

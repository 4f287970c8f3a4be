"""Forces on the probe by a second program: writes forces.json beside it.

    pip install -r vectors/requirements.txt
    python vectors/probe_force/probe_force.py

The model is that of spec/phantom.md and spec/fem.md: plane strain, small strain, ν = 0.49, a rigid frictionless circle
whose normal is taken at the deformed node. Assembly is scikit-fem's, the factorisation SuperLU's; mesh and contact are this
file's and mesh.py's. Each force is computed on three meshes and extrapolated; the band says how far that may be off.

Implements: VEC-011.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np
from mesh import DISC_REGION, GEL, GEL_REGION, SKIN, SKIN_REGION, WIDTH, build
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementTriP0, ElementTriP2, ElementVector
from skfem.helpers import ddot, eye, sym_grad, trace

MODULI = {GEL_REGION: 5e3, SKIN_REGION: 180e3}
DISC, RATIO = 1.2e6, 0.49
PROBE, LENGTH = 0.0065, 0.030
SIZES_MM = (1 / 3, 1 / 4, 1 / 6)
PHANTOMS = {"none": None, "2.6": 0.0026, "4.6": 0.0046, "6.6": 0.0066, "8.6": 0.0086}
DEPTHS_MM = (0.5, 1.0, 2.0, 3.0, 4.0)
LATERALS_MM = (0.0, 1.0, 2.5, 4.0, 6.0, 10.0)


@BilinearForm
def elasticity(u, v, w):
    strain = sym_grad(u)
    return ddot(w.lam * eye(trace(strain), 2) + 2.0 * w.mu * strain, sym_grad(v))


class Surface:
    """Compliance of the outer surface: displacements (x, y) of its nodes by forces (x, y) on them, per metre of length."""

    def __init__(self, name, size):
        depth = PHANTOMS[name]
        mesh, regions = build(depth or 0.0046, size)
        modulus = np.array([DISC if r == DISC_REGION and depth else MODULI.get(r, MODULI[GEL_REGION]) for r in regions])
        lam, mu = modulus * RATIO / ((1 + RATIO) * (1 - 2 * RATIO)), modulus / (2 * (1 + RATIO))
        basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
        constant = Basis(mesh, ElementTriP0(), intorder=4)
        matrix = elasticity.assemble(basis, lam=constant.interpolate(lam), mu=constant.interpolate(mu)).tocsc()
        place = basis.doflocs
        held = (np.abs(np.abs(place[0]) - WIDTH / 2) < 1e-9) | (np.abs(place[1] + GEL + SKIN) < 1e-9)
        free = np.flatnonzero(~held)
        inner = matrix[free][:, free]
        factor = splu(inner, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        self.unknowns = len(free)
        position = {}
        for k, dof in enumerate(free):
            if abs(place[1, dof]) < 1e-9:
                position.setdefault(round(place[0, dof] * 1e9), []).append(k)
        places = sorted(x for x in position if -0.0075e9 <= x)
        self.x = np.array(places) * 1e-9
        # At each place first the lateral unknown, then the normal one: scikit-fem numbers them so.
        unknown = np.array([k for x in places for k in sorted(position[x])])
        assert len(unknown) == 2 * len(places)
        self.compliance = np.empty((len(unknown), len(unknown)))
        for start in range(0, len(unknown), 64):
            chosen = unknown[start : start + 64]
            load = np.zeros((len(free), len(chosen)))
            load[chosen, np.arange(len(chosen))] = 1.0
            self.compliance[:, start : start + 64] = factor.solve(load)[unknown]
        asymmetry = np.abs(self.compliance - self.compliance.T).max() / np.abs(self.compliance).max()
        assert asymmetry < 1e-9, asymmetry

    def press(self, depths, lateral):
        """Normal and lateral force (N) at each of the increasing depths: contact with the circle, by Newton's method on
        displacements and pressures of the nodes in contact, until no node pulls and none lies within the circle."""
        count = len(self.x)
        rest = np.column_stack([self.x, np.zeros(count)])
        force, active, results = np.zeros(count), np.zeros(count, bool), {}
        reached = 0.0
        u = np.zeros((count, 2))
        for target in depths:
            for depth in np.linspace(reached, target, max(2, int(np.ceil((target - reached) / 2.5e-4)) + 1))[1:]:
                centre = np.array([lateral, PROBE - depth])
                for _ in range(60):
                    gap = np.linalg.norm(rest + u - centre, axis=1) - PROBE
                    changed = (active & (force >= 0)) | (~active & (gap < -1e-13))
                    if (changed == active).all() and active.any() and np.abs(gap[active]).max() < 1e-13:
                        break
                    active = changed
                    u, force = self.newton(rest, centre, active, u, force)
                else:
                    raise ArithmeticError(f"no set of contact at {depth}, {lateral}")
            reached = target
            arms = rest + u - centre
            pressing = (force[:, None] * arms / np.linalg.norm(arms, axis=1)[:, None])[active].sum(axis=0)
            results[target] = (-LENGTH * pressing[1], -LENGTH * pressing[0])
        return results

    def newton(self, rest, centre, active, u, force):
        at = np.flatnonzero(active)
        rows = np.column_stack([2 * at, 2 * at + 1]).ravel()
        local = self.compliance[np.ix_(rows, rows)]
        m = len(at)
        w, lam = u[at].ravel().copy(), force[at].copy()
        for _ in range(50):
            arm = (rest[at] + w.reshape(m, 2)) - centre
            radius = np.linalg.norm(arm, axis=1)
            n = arm / radius[:, None]
            residual = np.concatenate([w - local @ (lam[:, None] * n).ravel(), radius - PROBE])
            # d(λ n)/du = λ (I − n nᵀ)/r in each node's 2 × 2 block.
            turning = np.zeros((2 * m, 2 * m))
            normals = np.zeros((2 * m, m))
            for k in range(m):
                turning[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = lam[k] / radius[k] * (np.eye(2) - np.outer(n[k], n[k]))
                normals[2 * k : 2 * k + 2, k] = n[k]
            jacobian = np.block([[np.eye(2 * m) - local @ turning, -local @ normals], [normals.T, np.zeros((m, m))]])
            scale = np.concatenate([np.ones(2 * m), np.full(m, 1e3)])
            step = np.linalg.solve(jacobian * scale, -residual) * scale
            w, lam = w + step[: 2 * m], lam + step[2 * m :]
            if np.abs(step[: 2 * m]).max() < 1e-14:
                break
        else:
            raise ArithmeticError("Newton's method does not converge")
        force = np.zeros(len(rest))
        force[at] = lam
        arm = (rest[at] + w.reshape(m, 2)) - centre
        loads = np.zeros(2 * len(rest))
        loads[rows] = (lam[:, None] * arm / np.linalg.norm(arm, axis=1)[:, None]).ravel()
        return (self.compliance @ loads).reshape(-1, 2), force


def extrapolated(coarse, middle, fine):
    """Value and half band of a force from cells of 4, 3 and 2 parts. Contact's edge moves from node to node, so that no order
    is observed reliably: half of the second order's correction is applied, and the band covers the correction twice over
    and the scatter of the three."""
    correction = (fine - middle) / ((SIZES_MM[1] / SIZES_MM[2]) ** 2 - 1)
    spread = max(abs(fine - middle), abs(fine - coarse) / 2)
    return fine + correction / 2, max(abs(correction), spread)


def main():
    sizes = [float(s) for s in sys.argv[1:]] or list(SIZES_MM)
    forces = {}
    for name in PHANTOMS:
        for size in sizes:
            start = time.time()
            surface = Surface(name, size * 1e-3)
            for lateral in LATERALS_MM:
                for depth, pair in surface.press([d * 1e-3 for d in DEPTHS_MM], lateral * 1e-3).items():
                    forces.setdefault((name, round(depth * 1e3, 6), lateral), []).append(pair)
            at = forces[(name, 4.0, 0.0)][-1], forces[(name, 4.0, 4.0)][-1]
            print(
                f"{name} {size:.4f} mm: {surface.unknowns} unknowns, {time.time() - start:.0f} s, {at}", file=sys.stderr
            )
    if len(sizes) != 3:
        return
    poses = []
    for (name, depth, lateral), triple in forces.items():
        entry = {"phantom": name, "depth_mm": depth, "lateral_mm": lateral}
        for k, key in enumerate(("normal", "lateral")):
            value, band = extrapolated(*(pair[k] for pair in triple))
            # Tenths of a millinewton; rounding is part of the band.
            entry[f"{key}_force_mn"] = round(value * 1e3, 1) + 0.0
            entry[f"{key}_band_mn"] = round(band * 1e3 + 0.1, 1)
        poses.append(entry)
    data = {"program": "vectors/probe_force/probe_force.py, scikit-fem 12.0.2, SciPy 1.17.1", "cells_per_mm": [3, 4, 6]}
    lines = ",\n".join("  " + json.dumps(pose) for pose in poses)
    text = json.dumps(data, indent=1)[:-2] + f',\n "poses": [\n{lines}\n ]\n}}\n'
    (Path(__file__).parent / "forces.json").write_text(text)


main()

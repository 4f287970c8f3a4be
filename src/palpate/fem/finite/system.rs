//! The equations of a gel at finite strain: its unknowns, the forces of its elements, and the symmetric indefinite tangent
//! condensed to the surface under the probe.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use faer::dyn_stack::MemStack;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymbolicCholeskyRaw};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};
use faer::{Conj, Mat, MatMut, Par, Side};
use nalgebra::SVector;

use super::law::{Law, Point, UNKNOWNS, points};
use crate::fem::FemError;
use crate::fem::assembly::HELD;
use crate::fem::cholesky::{corner, eliminated, scratch};
use crate::fem::element::{CORNERS, NODES};
use crate::fem::mesh::{Mesh, Region};
use crate::fem::ordering::dissection;
use crate::phantom::Phantom;
use crate::refusal::Refusal;

/// The gel's elements and unknowns: displacements and pressures below the surface in the order of elimination, each pressure
/// behind the displacements of its node; then the pressures at the surface; then the displacements at the surface from left to
/// right. A corner that two materials share has a pressure for each.
///
/// Implements: FIN-002.
#[derive(Debug, Clone)]
pub(super) struct System {
    pub elements: Vec<(Law, Vec<Point>, [u32; UNKNOWNS])>,
    symbolic: SymbolicSparseColMat<u32>,
    argsort: Argsort<u32>,
    elimination: Arc<SymbolicCholesky<u32>>,
    /// The unknown of each displacement of each node, or [`HELD`].
    displacements: Vec<[u32; 2]>,
    /// How many unknowns are pressures.
    pressures: usize,
}

/// The state of all elements.
#[derive(Clone)]
pub(super) struct Equations {
    /// Stored energy, J.
    pub energy: f64,
    /// The force that each unknown takes, N; of a pressure what is left of p = λ ln J, m³.
    pub forces: Vec<f64>,
    /// The force on floor and walls along x and y, N.
    pub reaction: [f64; 2],
    /// The smallest J.
    pub least_det: f64,
    values: Vec<f64>,
}

/// The tangent of one state, factorised, and condensed to the nodes under the probe.
pub(super) struct Condensed<'a> {
    system: &'a System,
    factor: Vec<f64>,
    /// Added to the tangent at the nodes under the probe, N/m: without the probe a gel that is pressed hard would buckle.
    support: f64,
    /// The unknowns of the nodes under the probe.
    under: Range<usize>,
    /// Their stiffness, N/m, everything else condensed out.
    pub stiffness: Mat<f64>,
    /// The forces, N, that hold them where they are.
    pub forces: Vec<f64>,
}

impl System {
    pub fn new(mesh: &Mesh, phantom: &Phantom) -> Result<System, FemError> {
        let numbering = Numbering::new(mesh);
        let mut elements = Vec::with_capacity(mesh.regions.len());
        for (nodes, &region) in mesh.elements().zip(&mesh.regions) {
            let points = points(&mesh.positions(nodes), phantom);
            let points = points.map_err(|_| {
                let found = "an element is turned inside out: the mesh cannot follow this phantom; try a finer mesh";
                Refusal::state(found, "")
            })?;
            let law = Law::from(region.material(phantom));
            elements.push((law, points, numbering.of_element(nodes, region)));
        }
        let size = numbering.count as usize;
        let pairs = elements.iter().flat_map(|(_, _, unknowns)| {
            entries(unknowns).map(|(a, b)| Pair::new(unknowns[a], unknowns[b]))
        });
        let pairs: Vec<_> = pairs.collect();
        let (symbolic, argsort) = SymbolicSparseColMat::try_new_from_indices(size, size, &pairs)
            .map_err(|_| FemError::OutOfMemory)?;
        Ok(System {
            elements,
            argsort,
            elimination: Arc::new(eliminated(symbolic.as_ref())?),
            symbolic,
            pressures: numbering.pressures.len(),
            displacements: numbering.displacements,
        })
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.symbolic.ncols()
    }

    /// The unknown of a displacement component of a node; `None` where it is held.
    pub fn unknown(&self, node: usize, direction: usize) -> Option<usize> {
        let unknown = self.displacements[node][direction];
        (unknown != HELD).then_some(unknown as usize)
    }

    /// Displacement of a node, m.
    pub fn displacement(&self, state: &[f64], node: usize) -> [f64; 2] {
        [0, 1].map(|k| self.unknown(node, k).map_or(0.0, |unknown| state[unknown]))
    }

    /// Cauchy stress (σ_xx, σ_yy, σ_zz, σ_xy), Pa, at a point of an element, given in parent coordinates, under the displacement
    /// gradient there.
    pub fn stress(
        &self,
        state: &[f64],
        element: usize,
        [r, s]: [f64; 2],
        gradient: [[f64; 2]; 2],
    ) -> [f64; 4] {
        let (law, _, unknowns) = &self.elements[element];
        let corners = unknowns[2 * NODES..].iter().zip([1.0 - r - s, r, s]);
        let pressure = corners.map(|(&unknown, shape)| shape * state[unknown as usize]);
        law.stress(gradient, pressure.sum())
    }

    /// Forces and stiffness at `state`; `None` where an element is turned inside out.
    pub fn equations(&self, state: &[f64]) -> Option<Equations> {
        let mut equations = Equations {
            energy: 0.0,
            forces: vec![0.0; self.unknowns()],
            reaction: [0.0; 2],
            least_det: f64::INFINITY,
            values: Vec::with_capacity(self.elements.len() * 120),
        };
        for (law, points, unknowns) in &self.elements {
            let value = |k: usize, _| match unknowns[k] {
                HELD => 0.0,
                unknown => state[unknown as usize],
            };
            let element = law.element(points, &SVector::from_fn(value))?;
            equations.energy += element.energy;
            equations.least_det = equations.least_det.min(element.least_det);
            for (k, &unknown) in unknowns.iter().enumerate() {
                match unknown {
                    HELD => equations.reaction[k % 2] += element.force[k],
                    unknown => equations.forces[unknown as usize] += element.force[k],
                }
            }
            let values = entries(unknowns).map(|pair| element.tangent[pair]);
            equations.values.extend(values);
        }
        Some(equations)
    }

    /// Factorises the tangent and condenses it to the surface nodes whose unknowns are `under`.
    ///
    /// # Errors
    /// [`FemError::OutOfMemory`]. `Ok(None)` where the tangent has not exactly as many negative pivots as pressures: the gel is not
    /// stable there.
    ///
    /// Implements: FIN-004.
    pub fn condense(
        &self,
        equations: &Equations,
        under: Range<usize>,
    ) -> Result<Option<Condensed<'_>>, FemError> {
        let mut tangent =
            SparseColMat::new_from_argsort(self.symbolic.clone(), &self.argsort, &equations.values)
                .map_err(|_| FemError::OutOfMemory)?;
        // The diagonal is the last entry of a column of the upper triangle.
        let diagonal = |unknown: usize| self.symbolic.col_ptr()[unknown + 1] as usize - 1;
        let stiffest = under
            .clone()
            .map(|unknown| tangent.val()[diagonal(unknown)]);
        let stiffest = stiffest.fold(0.0, f64::max);
        for unknown in under.clone() {
            tangent.val_mut()[diagonal(unknown)] += stiffest;
        }
        let mut factor = vec![0.0; self.elimination.len_val()];
        let request = self
            .elimination
            .factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default());
        let factorised = self.elimination.factorize_numeric_ldlt(
            &mut factor,
            tangent.as_ref(),
            Side::Upper,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut scratch(request)?),
            Default::default(),
        );
        let factorised = factorised.is_ok();
        let mut condensed = Condensed {
            system: self,
            factor,
            support: stiffest,
            under,
            stiffness: Mat::new(),
            forces: Vec::new(),
        };
        if !factorised || condensed.negative_pivots() != self.pressures {
            return Ok(None);
        }
        let Some(supported) = condensed.supported() else {
            return Ok(None);
        };
        let rest: Vec<f64> = equations.forces.iter().map(|force| -force).collect();
        let free = condensed.solve(rest)?;
        let free = &free[condensed.under.clone()];
        let row = |i: usize| -> f64 { (0..free.len()).map(|j| supported[(i, j)] * free[j]).sum() };
        condensed.forces = (0..free.len()).map(|i| -row(i)).collect();
        condensed.stiffness = supported;
        for i in 0..free.len() {
            condensed.stiffness[(i, i)] -= stiffest;
        }
        Ok(Some(condensed))
    }
}

/// The entries of an element that stand in the upper triangle of the tangent.
fn entries(unknowns: &[u32; UNKNOWNS]) -> impl Iterator<Item = (usize, usize)> {
    let all = (0..UNKNOWNS).flat_map(|a| (0..UNKNOWNS).map(move |b| (a, b)));
    all.filter(|&(a, b)| unknowns[b] != HELD && unknowns[a] <= unknowns[b])
}

impl Condensed<'_> {
    fn ldlt(&self) -> SupernodalLdltRef<'_, u32, f64> {
        match self.system.elimination.raw() {
            SymbolicCholeskyRaw::Supernodal(raw) => SupernodalLdltRef::new(raw, &self.factor),
            SymbolicCholeskyRaw::Simplicial(_) => unreachable!("supernodes were asked for"),
        }
    }

    fn negative_pivots(&self) -> usize {
        let factor = self.ldlt();
        let supernodes = (0..factor.symbolic().n_supernodes()).map(|s| factor.supernode(s).val());
        let negative = |block: faer::MatRef<'_, f64>| {
            (0..block.ncols()).filter(|&k| block[(k, k)] < 0.0).count()
        };
        supernodes.map(negative).sum()
    }

    /// The stiffness of the nodes under the probe with their support, the inverse of the corner of K⁻¹ = L⁻ᵀ D⁻¹ L⁻¹ over them;
    /// `None` where it is not positive definite.
    fn supported(&self) -> Option<Mat<f64>> {
        let factor = self.ldlt();
        // L with D in place of the ones on its diagonal.
        let corner = corner(factor.symbolic(), |s| factor.supernode(s), self.under.start);
        let size = self.under.len();
        let one = |i, j| if i == j { 1.0 } else { 0.0 };
        let mut columns = Mat::from_fn(corner.nrows(), size, one);
        solve_unit_lower_triangular_in_place(corner.as_ref(), columns.as_mut(), Par::Seq);
        let scaled = Mat::from_fn(corner.nrows(), size, |i, j| {
            columns[(i, j)] / corner[(i, i)]
        });
        let compliance = columns.transpose() * scaled;
        let inverse = compliance.llt(Side::Lower).ok()?;
        let inverse = faer::linalg::solvers::DenseSolveCore::inverse(&inverse);
        Some(Mat::from_fn(size, size, |i, j| {
            0.5 * (inverse[(i, j)] + inverse[(j, i)])
        }))
    }

    /// The changes of all unknowns under `forces`, N, with the nodes under the probe supported.
    fn solve(&self, mut forces: Vec<f64>) -> Result<Vec<f64>, FemError> {
        let factor = self.ldlt();
        let request = factor.symbolic().solve_in_place_scratch::<f64>(1, Par::Seq);
        let n = forces.len();
        factor.solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut forces, n, 1),
            Par::Seq,
            MemStack::new(&mut scratch(request)?),
        );
        Ok(forces)
    }

    /// The changes of all unknowns where the nodes under the probe move by `moved`, m, under `pushed`, N.
    pub fn changes(
        &self,
        equations: &Equations,
        moved: &[f64],
        pushed: &[f64],
    ) -> Result<Vec<f64>, FemError> {
        let mut forces: Vec<f64> = equations.forces.iter().map(|force| -force).collect();
        let held = moved.iter().zip(pushed).map(|(u, f)| f + self.support * u);
        for (force, held) in forces[self.under.clone()].iter_mut().zip(held) {
            *force += held;
        }
        self.solve(forces)
    }
}

/// The unknowns as they are numbered.
struct Numbering {
    displacements: Vec<[u32; 2]>,
    pressures: BTreeMap<(u32, Region), u32>,
    count: u32,
}

impl Numbering {
    fn new(mesh: &Mesh) -> Numbering {
        let mut regions: BTreeMap<u32, Vec<Region>> = BTreeMap::new();
        for (nodes, &region) in mesh.elements().zip(&mesh.regions) {
            for &corner in &nodes[..CORNERS] {
                let there = regions.entry(corner).or_default();
                if !there.contains(&region) {
                    there.push(region);
                }
            }
        }
        let mut numbering = Numbering {
            displacements: vec![[HELD; 2]; mesh.nodes.len()],
            pressures: BTreeMap::new(),
            count: 0,
        };
        let regions = |node: usize| regions.get(&(node as u32)).into_iter().flatten();
        for node in dissection(mesh) {
            numbering.displace(node, mesh);
            regions(node).for_each(|&region| numbering.press(node, region));
        }
        for &node in &mesh.surface {
            regions(node).for_each(|&region| numbering.press(node, region));
        }
        mesh.surface
            .iter()
            .for_each(|&node| numbering.displace(node, mesh));
        numbering
    }

    fn displace(&mut self, node: usize, mesh: &Mesh) {
        for direction in 0..2 {
            if !mesh.held[node][direction] {
                self.displacements[node][direction] = self.count;
                self.count += 1;
            }
        }
    }

    fn press(&mut self, node: usize, region: Region) {
        self.pressures.insert((node as u32, region), self.count);
        self.count += 1;
    }

    fn of_element(&self, nodes: &[u32], region: Region) -> [u32; UNKNOWNS] {
        std::array::from_fn(|k| match k.checked_sub(2 * NODES) {
            None => self.displacements[nodes[k / 2] as usize][k % 2],
            Some(corner) => self.pressures[&(nodes[corner], region)],
        })
    }
}

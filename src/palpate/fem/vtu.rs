//! One pose as a VTK unstructured grid in ASCII (`.vtu`), for ParaView.

use nalgebra::Vector2;

use super::element::{NODES, SAMPLES, stress};
use super::field::{Field, determinant};
use super::finite::Place;
use super::mesh::Region;
use super::{FemError, Model, Pose, PoseSolution, State};
use crate::phantom::Geometry;
use crate::refusal::Refusal;

/// VTK's type of cell.
const QUADRATIC_TRIANGLE: u8 = 22;

impl Model {
    /// A path of solved poses as [`Model::vtu`] writes each, with what slipped since the pose before.
    ///
    /// # Errors
    /// As [`Model::vtu`].
    pub fn vtu_series(&self, path: &[PoseSolution]) -> Result<Vec<String>, FemError> {
        let mut before = None;
        let next = |solution: &PoseSolution| {
            let field = self.field(solution)?;
            let text = self.written(solution, &field, before.as_ref());
            before = Some((field, solution.pose));
            text
        };
        path.iter().map(next).collect()
    }

    /// The deformed mesh of a solved pose: points at their deformed positions, m; at each point the displacement, m, pressure and
    /// shear stress of the probe, Pa, and the slip along it, m, which is 0; in each element its region (layers from the top, then
    /// inclusions), the mean over its sampling points of stress and pressure, Pa, the von Mises stress of that mean, Pa, and the
    /// smallest det(I + ∇u).
    ///
    /// Implements: FEM-016.
    ///
    /// # Errors
    /// [`FemError::Residual`].
    pub fn vtu(&self, solution: &PoseSolution) -> Result<String, FemError> {
        self.written(solution, &self.field(solution)?, None)
    }

    fn written(
        &self,
        solution: &PoseSolution,
        field: &Field,
        before: Option<&(Field, Pose)>,
    ) -> Result<String, FemError> {
        let found = "the stresses of an axisymmetric phantom cannot be written yet";
        let is_revolved = self.phantom().geometry() == Geometry::Axisymmetric;
        Refusal::state(found, "leave out the file for ParaView").when(is_revolved)?;
        let touches = self.touches(solution, field, before);
        let mesh = self.mesh();
        let (nodes, elements) = (mesh.nodes.len(), mesh.regions.len());
        let displacements = &field.displacements;
        let deformed = mesh.nodes.iter().zip(displacements);
        let deformed = deformed.map(|(x, u)| [x[0] + u[0], x[1] + u[1], 0.0]);
        let number = |region: &Region| match *region {
            Region::Layer(k) => [k],
            Region::Inclusion(k) => [self.phantom().layers().len() + k],
        };
        let per_element_of = field.gradients.iter().zip(&mesh.regions);
        let stresses = per_element_of
            .enumerate()
            .map(|(element, (points, region))| {
                let material = region.material(self.phantom());
                let stresses = points.iter().zip(SAMPLES).map(|(&gradient, at)| {
                    match (&self.finite, &solution.state) {
                        (Some(finite), State::Finite(rest)) => {
                            finite.stress(rest, element, at, gradient)
                        }
                        _ => stress(material, gradient),
                    }
                });
                let sum = stresses.fold([0.0; 4], |a, b| [0, 1, 2, 3].map(|k| a[k] + b[k]));
                sum.map(|component| component / points.len() as f64)
            });
        let stresses: Vec<[f64; 4]> = stresses.collect();
        let dets = field.gradients.iter().map(|points| {
            let dets = points.iter().map(|&g| determinant(g));
            [dets.fold(f64::INFINITY, f64::min)]
        });
        Ok([
            format!(
                "<?xml version=\"1.0\"?>\n\
                 <VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n\
                 <Piece NumberOfPoints=\"{nodes}\" NumberOfCells=\"{elements}\">\n<Points>\n"
            ),
            array("Float64", "position_m", deformed),
            "</Points>\n<PointData Vectors=\"displacement_m\">\n".into(),
            array("Float64", "displacement_m", displacements.iter().map(|u| [u[0], u[1], 0.0])),
            array("Float64", "contact_pressure_pa", touches.iter().map(|of| [of.pressure])),
            array("Float64", "contact_shear_pa", touches.iter().map(|of| [of.shear])),
            array("Float64", "slip_m", touches.iter().map(|of| [of.slip])),
            "</PointData>\n<CellData Scalars=\"von_mises_pa\">\n".into(),
            array("UInt8", "region", mesh.regions.iter().map(number)),
            array("Float64", "stress_xx_yy_zz_xy_pa", stresses.iter().copied()),
            array("Float64", "pressure_pa", stresses.iter().map(|s| [-(s[0] + s[1] + s[2]) / 3.0])),
            array("Float64", "von_mises_pa", stresses.iter().map(|&s| [von_mises(s)])),
            array("Float64", "min_det", dets),
            "</CellData>\n<Cells>\n".into(),
            array("UInt32", "connectivity", mesh.connectivity.iter().map(|&node| [node])),
            array("UInt64", "offsets", (1..=elements).map(|k| [k * NODES])),
            array("UInt8", "types", (0..elements).map(|_| [QUADRATIC_TRIANGLE])),
            "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n".into(),
        ]
        .concat())
    }
}

/// What the probe does to a node.
#[derive(Clone, Copy, Default)]
struct OnNode {
    /// Pa, on the deformed surface.
    pressure: f64,
    /// Pa, to the right along the probe.
    shear: f64,
    /// To the right along the probe since the pose before, m.
    slip: f64,
}

impl Model {
    /// What the probe does to each node.
    fn touches(
        &self,
        solution: &PoseSolution,
        field: &Field,
        before: Option<&(Field, Pose)>,
    ) -> Vec<OnNode> {
        let (mesh, probe) = (self.mesh(), self.phantom().probe());
        let at = |field: &Field, node: usize| {
            Vector2::from(mesh.nodes[node]) + Vector2::from(field.displacements[node])
        };
        let place = |field: &Field, pose, node| Place::new(at(field, node), pose, probe.radius);
        // Simpson's rule over each edge, whose middle node stands between its ends.
        let mut lengths = vec![0.0; mesh.surface.len()];
        for first in (0..mesh.surface.len().saturating_sub(2)).step_by(2) {
            let way = at(field, mesh.surface[first + 2]) - at(field, mesh.surface[first]);
            let length = libm::sqrt(way.dot(&way));
            for (k, weight) in [1.0, 4.0, 1.0].into_iter().enumerate() {
                lengths[first + k] += weight / 6.0 * length;
            }
        }
        let mut touches = vec![OnNode::default(); mesh.nodes.len()];
        let forces = self.forces_on_surface(solution);
        for ((&node, force), length) in mesh.surface.iter().zip(forces).zip(lengths) {
            if force == [0.0; 2] {
                continue;
            }
            let now = place(field, solution.pose, node);
            let stress = Vector2::from(force) / (length * probe.length);
            touches[node] = OnNode {
                pressure: stress.dot(&now.normal),
                shear: stress.dot(&now.tangent()),
                slip: before.map_or(0.0, |(field, pose)| now.arc - place(field, *pose, node).arc),
            };
        }
        touches
    }

    /// The force on the gel at each node at the surface, N.
    fn forces_on_surface(&self, solution: &PoseSolution) -> Vec<[f64; 2]> {
        match &solution.state {
            State::Small(state) => self.surface().at_nodes(state, solution.pose).1,
            State::Finite(rest) => rest.forces.clone(),
        }
    }
}

/// Von Mises' equivalent of the stress (σ_xx, σ_yy, σ_zz, σ_xy), Pa.
pub(super) fn von_mises([xx, yy, zz, xy]: [f64; 4]) -> f64 {
    let squares = (xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx);
    libm::sqrt(0.5 * squares + 3.0 * xy * xy)
}

/// One `DataArray`, a row of `N` components on each line.
fn array<const N: usize, T: std::fmt::Display>(
    kind: &str,
    name: &str,
    rows: impl Iterator<Item = [T; N]>,
) -> String {
    let rows = rows.map(|row| row.map(|value| value.to_string()).join(" ") + "\n");
    let head = format!("type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{N}\"");
    let rows: String = rows.collect();
    format!("<DataArray {head} format=\"ascii\">\n{rows}</DataArray>\n")
}

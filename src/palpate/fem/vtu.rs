//! One pose as a VTK unstructured grid in ASCII (`.vtu`), for ParaView.

use super::element::{NODES, SAMPLES, stress};
use super::field::determinant;
use super::mesh::Region;
use super::{FemError, Model, PoseSolution, State};
use crate::phantom::Geometry;
use crate::refusal::Refusal;

/// VTK's type of cell.
const QUADRATIC_TRIANGLE: u8 = 22;

impl Model {
    /// The deformed mesh of a solved pose: points at their deformed positions, m; the displacement at
    /// each point, m; in each element its region (layers from the top, then inclusions), the mean over its
    /// sampling points of stress and pressure, Pa, the von Mises stress of that mean, Pa, and the
    /// smallest det(I + ∇u).
    ///
    /// Implements: FEM-016.
    ///
    /// # Errors
    /// [`FemError::Residual`].
    pub fn vtu(&self, solution: &PoseSolution) -> Result<String, FemError> {
        let found = "the stresses of an axisymmetric phantom cannot be written yet";
        let is_revolved = self.phantom().geometry() == Geometry::Axisymmetric;
        Refusal::state(found, "leave out the file for ParaView").when(is_revolved)?;
        let field = self.field(solution)?;
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

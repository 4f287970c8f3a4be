//! One pose as a VTK unstructured grid in ASCII (`.vtu`), for ParaView.

use std::fmt::Write;

use super::assembly::material_of;
use super::element::stress;
use super::field::determinant;
use super::mesh::Region;
use super::{Element, FemError, Model, PoseSolution};

/// Cell types of VTK: quadratic triangle and quadrilateral.
const VTK_QUADRATIC_TRIANGLE: u8 = 22;
const VTK_QUAD: u8 = 9;

impl Model {
    /// The deformed mesh of a solved pose: points at their deformed positions, m; the displacement at
    /// each point, m; in each element its region (0 gel, 1 skin, 2 inclusion), the mean over its
    /// sampling points of stress and pressure, Pa, the von Mises stress of that mean, Pa, and the
    /// smallest det(I + ∇u).
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// let file = model.vtu(&model.solve(pose)?)?;
    /// assert!(file.starts_with("<?xml") && file.contains("Name=\"von_mises_pa\""));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Implements: FEM-016.
    ///
    /// # Errors
    /// [`FemError::Residual`].
    pub fn vtu(&self, solution: &PoseSolution) -> Result<String, FemError> {
        let field = self.field(solution)?;
        let mesh = self.mesh();
        let (nodes, elements) = (mesh.nodes.len(), mesh.regions.len());
        let mut text = String::new();
        // Writing to a String cannot fail: the results are dropped here and below.
        let _ = write!(
            text,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n\
             <UnstructuredGrid>\n<Piece NumberOfPoints=\"{nodes}\" NumberOfCells=\"{elements}\">\n"
        );
        let deformed = mesh
            .nodes
            .iter()
            .zip(&field.displacements)
            .map(|(x, u)| [x[0] + u[0], x[1] + u[1], 0.0]);
        text += "<Points>\n";
        array(&mut text, "Float64", "position_m", 3, deformed);
        text += "</Points>\n<PointData Vectors=\"displacement_m\">\n";
        array(
            &mut text,
            "Float64",
            "displacement_m",
            3,
            field.displacements.iter().map(|u| [u[0], u[1], 0.0]),
        );
        text += "</PointData>\n<CellData Scalars=\"von_mises_pa\">\n";
        self.cell_data(&mut text, &field.gradients);
        text += "</CellData>\n<Cells>\n";
        let per_element = mesh.element.nodes();
        array(
            &mut text,
            "UInt32",
            "connectivity",
            1,
            mesh.connectivity.iter().map(|&node| [node]),
        );
        array(
            &mut text,
            "UInt64",
            "offsets",
            1,
            (1..=elements).map(|k| [k * per_element]),
        );
        let kind = match mesh.element {
            Element::T6 => VTK_QUADRATIC_TRIANGLE,
            Element::Q4Full => VTK_QUAD,
        };
        array(
            &mut text,
            "UInt8",
            "types",
            1,
            (0..elements).map(|_| [kind]),
        );
        text += "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
        Ok(text)
    }

    fn cell_data(&self, text: &mut String, gradients: &[Vec<[[f64; 2]; 2]>]) {
        let regions = &self.mesh().regions;
        let has_inclusion = self.phantom().inclusion.is_some();
        let number = |region: &Region| match region {
            Region::Skin => [1],
            Region::Disc if has_inclusion => [2],
            Region::Disc | Region::Gel => [0],
        };
        array(text, "UInt8", "region", 1, regions.iter().map(number));
        let mean_stress = |(points, &region): (&Vec<[[f64; 2]; 2]>, &Region)| {
            let material = material_of(self.phantom(), region);
            let mut mean = [0.0; 4];
            for &gradient in points {
                for (mean, component) in mean.iter_mut().zip(stress(&material, gradient)) {
                    *mean += component / points.len() as f64;
                }
            }
            mean
        };
        let stresses: Vec<[f64; 4]> = gradients.iter().zip(regions).map(mean_stress).collect();
        array(
            text,
            "Float64",
            "stress_xx_yy_zz_xy_pa",
            4,
            stresses.iter().copied(),
        );
        array(
            text,
            "Float64",
            "pressure_pa",
            1,
            stresses.iter().map(|s| [-(s[0] + s[1] + s[2]) / 3.0]),
        );
        array(
            text,
            "Float64",
            "von_mises_pa",
            1,
            stresses.iter().map(|&s| [von_mises(s)]),
        );
        let least = |points: &Vec<[[f64; 2]; 2]>| {
            [points
                .iter()
                .map(|&g| determinant(g))
                .fold(f64::INFINITY, f64::min)]
        };
        array(text, "Float64", "min_det", 1, gradients.iter().map(least));
    }
}

/// Von Mises' equivalent of the stress (σ_xx, σ_yy, σ_zz, σ_xy), Pa.
pub(super) fn von_mises([xx, yy, zz, xy]: [f64; 4]) -> f64 {
    let squares = (xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx);
    libm::sqrt(0.5 * squares + 3.0 * xy * xy)
}

/// One `DataArray`, a row of `N` components on each line.
fn array<const N: usize, T: std::fmt::Display>(
    text: &mut String,
    kind: &str,
    name: &str,
    components: usize,
    rows: impl Iterator<Item = [T; N]>,
) {
    let _ = writeln!(
        text,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">"
    );
    for row in rows {
        let _ = writeln!(text, "{}", row.map(|value| value.to_string()).join(" "));
    }
    *text += "</DataArray>\n";
}

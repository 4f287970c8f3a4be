//! How large an element may be at each point of a phantom: small where the error of a force comes from (`spec/fem.md`).

use core::f64::consts::FRAC_PI_2;

use super::triangle::Point;
use crate::phantom::{Outline, Phantom, Strain, Support, edges, point_to_segment};

/// The mesh size, m, at which the sizes below hold as they stand; a smaller one scales them all, a larger one those that
/// need not resolve a thin layer, a narrow gap or a bend.
pub const MESH_SIZE: f64 = 0.5e-3;
/// Size at the surface, m, and its growth with depth.
const SURFACE: [f64; 2] = [0.20e-3, 0.16];
/// The largest size, m.
const LARGEST: f64 = 1.5e-3;
/// Size at an inclusion's edge, m, and its growth with distance.
const INCLUSION: [f64; 2] = [0.20e-3, 0.40];
/// Size where a layer's top meets a bonded wall, m, and its growth with distance.
const WALL_CORNER: [f64; 2] = [0.015e-3, 0.22];
/// Size at the corner of a polygon, m, and its growth with distance.
const POLYGON_CORNER: [f64; 2] = [0.05e-3, 0.30];
/// Size at the surface near a wall, m, and its growth with distance.
const STRIP: [f64; 2] = [0.10e-3, 0.16];
/// How far from a wall that is, m.
const STRIP_WIDTH: f64 = 4e-3;
/// Rows of elements in a layer at the nominal size, at least, and the growth of their size with distance from it.
const ROWS: [f64; 2] = [2.0, 0.16];
/// Growth rates follow the mesh size up to this multiple of the nominal one.
const STEEPEST: f64 = 2.0;
/// Strain is not judged nearer to a sharp corner than 1 mm in a gel of this width and height, m, which are the paper's, and
/// in another in proportion to the smaller of its own.
const SINGULAR: f64 = 1e-3;
const SINGULAR_IN: [f64; 2] = [34e-3, 15.5e-3];
/// The cosine of the turn from one edge of a polygon to the next above which the corner is sharp: 30°.
const SHARP: f64 = 0.866_025_403_784_438_6;
/// Size over the width of the gap between two edges.
const GAP: f64 = 0.5;
/// Nodes of real meshes over those of equilateral triangles of the wanted size, as found on the paper's phantoms.
const CROWDED: f64 = 1.15;
/// Size over the radius of curvature of an ellipse.
const BEND: f64 = 0.5;

/// The size function of a phantom.
///
/// Implements: FEM-031.
#[derive(Debug, Clone)]
pub struct SizeField {
    scale: f64,
    half_width: f64,
    levels: Vec<f64>,
    /// Points with the size at them and its growth.
    corners: Vec<(Point, [f64; 2])>,
    outlines: Vec<Outline>,
    /// Corners with a singular strain, and how near to them it is not judged, m.
    sharp: Vec<Point>,
    singular: f64,
}

impl SizeField {
    /// The size function for a mesh of `size` (m).
    pub fn new(phantom: &Phantom, size: f64) -> SizeField {
        let levels = phantom.levels();
        let half_width = 0.5 * phantom.well().width;
        let outlines: Vec<Outline> = phantom.inclusions().iter().map(|i| i.outline()).collect();
        // A coarse mesh must follow a bend too.
        let bend = BEND * (MESH_SIZE / size).min(1.0);
        let (mut corners, mut sharp) = (Vec::new(), Vec::new());
        // Where the gel may turn inside out, so fine a mesh of the singular strain in a corner would.
        if phantom.well().walls == Support::Fixed && phantom.strain() == Strain::Small {
            for &y in &levels[..levels.len() - 1] {
                let ends = [-half_width, half_width].map(|x| Point::new(x, y));
                corners.extend(ends.map(|end| (end, WALL_CORNER)));
                sharp.extend(ends);
            }
        }
        for outline in &outlines {
            match outline {
                Outline::Polygon(points) => {
                    corners.extend(points.iter().map(|&p| (p.into(), POLYGON_CORNER)));
                    sharp.extend(sharp_corners(points));
                }
                Outline::Ellipse(ellipse) => corners.extend((0..4).map(|k| {
                    let [along, across] = [k, k + 1].map(|k| ellipse.radii[k % 2]);
                    let end = ellipse.at(k as f64 * FRAC_PI_2);
                    (end.into(), [bend * across * across / along, INCLUSION[1]])
                })),
            }
        }
        let of_gel = [phantom.well().width, phantom.height()];
        let [wide, high] = [0, 1].map(|k| of_gel[k] / SINGULAR_IN[k]);
        SizeField {
            scale: size / MESH_SIZE,
            half_width,
            levels,
            corners,
            outlines,
            sharp,
            singular: SINGULAR * wide.min(high),
        }
    }

    /// Distance between the corners of an element at `point`, m.
    pub fn at(&self, point: Point) -> f64 {
        // Neighbouring elements of a coarse mesh must not differ too much.
        let steepness = self.scale.min(STEEPEST);
        let grown =
            |[at, growth]: [f64; 2], distance: f64| self.scale * at + steepness * growth * distance;
        let (x, y) = (point.x.abs(), point.y);
        let from_strip = Point::new((self.half_width - STRIP_WIDTH - x).max(0.0), y).norm();
        let mut size = (self.scale * LARGEST)
            .min(grown(SURFACE, y.abs()))
            .min(grown(STRIP, from_strip));
        for (corner, law) in &self.corners {
            size = size.min(grown(*law, (point - corner).norm()));
        }
        // Thin layers and narrow gaps, which a coarse mesh must resolve too.
        let row = (1.0 / ROWS[0]).min(1.0 / self.scale);
        for pair in self.levels.windows(2) {
            let outside = (y - pair[0]).max(pair[1] - y).max(0.0);
            size = size.min(grown([row * (pair[0] - pair[1]), ROWS[1]], outside));
        }
        let gap = GAP * self.scale.min(1.0);
        let from_edges = || self.outlines.iter().map(|outline| distance(outline, point));
        for (k, from_edge) in from_edges().enumerate() {
            let from_lines = self.levels.iter().map(|level| (y - level).abs());
            let others = from_lines
                .chain([self.half_width - x])
                .chain(from_edges().take(k));
            let nearest = others.fold(f64::INFINITY, f64::min);
            size = size
                .min(grown(INCLUSION, from_edge))
                .min(gap * (from_edge + nearest));
        }
        size
    }

    /// Whether a point is so near to the corner of a wall or a sharp one of a polygon that the strain there is that of a singularity, which
    /// grows without end on finer meshes.
    ///
    /// Implements: FEM-013.
    pub(super) fn singular(&self, point: Point) -> bool {
        let mut distances = self.sharp.iter().map(|corner| (point - corner).norm());
        distances.any(|distance| distance < self.singular)
    }

    /// About how many nodes a mesh of triangles with six nodes will have.
    ///
    /// An equilateral triangle of side h covers √3/4 h², and there are two nodes a triangle.
    ///
    /// Implements: FEM-036.
    pub fn expected_nodes(&self) -> f64 {
        let floor = self.levels[self.levels.len() - 1];
        let [low, high] = [[-self.half_width, floor], [self.half_width, 0.0]].map(Point::from);
        CROWDED * self.integral(low, high, 14) * 8.0 / libm::sqrt(3.0)
    }

    /// ∫ h⁻² over a rectangle, which is cut in four, twice at least and at most `cuts` times, until h hardly varies in it.
    fn integral(&self, low: Point, high: Point, cuts: usize) -> f64 {
        let middle = (low + high) / 2.0;
        let corners = [
            low,
            high,
            Point::new(low.x, high.y),
            Point::new(high.x, low.y),
        ];
        let mut sizes = corners.map(|corner| self.at((corner + middle) / 2.0));
        sizes.sort_by(f64::total_cmp);
        if cuts == 0 || cuts < 11 && sizes[3] <= 1.5 * sizes[0] {
            let area = (high.x - low.x) * (high.y - low.y);
            return area * sizes.iter().map(|h| 0.25 / (h * h)).sum::<f64>();
        }
        let part =
            |corner: Point| self.integral(corner.inf(&middle), corner.sup(&middle), cuts - 1);
        corners.map(part).iter().sum()
    }
}

/// The corners of a polygon where its edge turns by more than 30°, to either side.
///
/// Implements: FEM-013.
fn sharp_corners(points: &[[f64; 2]]) -> Vec<Point> {
    let edges = edges(points);
    let next = edges.iter().cycle().skip(1);
    let turns = edges.iter().zip(next).filter(|([a, b], [_, c])| {
        let [a, b, c] = [*a, *b, *c].map(Point::from);
        let (before, after) = (b - a, c - b);
        before.dot(&after) < SHARP * before.norm() * after.norm()
    });
    turns.map(|([_, corner], _)| (*corner).into()).collect()
}

/// Distance of a point from an outline, m: of an ellipse to first order, which is exact for a circle and near the edge.
fn distance(outline: &Outline, point: Point) -> f64 {
    match outline {
        Outline::Ellipse(ellipse) => {
            let p = Point::from(ellipse.on_unit_circle(point.into()));
            let radii = ellipse.radii;
            let slope = Point::new(p.x / radii[0], p.y / radii[1]).norm();
            if slope == 0.0 {
                radii[0].min(radii[1])
            } else {
                ((p.norm() - 1.0) * p.norm() / slope).abs()
            }
        }
        Outline::Polygon(points) => {
            let to_edge = |[a, b]: [[f64; 2]; 2]| point_to_segment(point.into(), a, b);
            let distances = edges(points).into_iter().map(to_edge);
            distances.fold(f64::INFINITY, f64::min)
        }
    }
}

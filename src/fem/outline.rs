//! Where the mesh's corners lie: the phantom's outline, how many cells go where, and the map from
//! lattice coordinates to the cross-section.
//!
//! The lattice has a coarse part from the floor to just under the skin and a fine part, the skin, with
//! one row between them in which each coarse cell meets two fine ones. Only the right half, x ≥ 0, is
//! made; the left half is its mirror image.

use core::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4};

use super::{Element, MeshOptions};
use crate::phantom::Phantom;

/// The phantom's outline as the lattice sees it, m.
#[derive(Debug, Clone, Copy)]
struct Shape {
    half_width: f64,
    /// Gel and skin together.
    height: f64,
    skin: f64,
    radius: f64,
    /// y of the disc's centre, negative.
    centre: f64,
    /// Half the side of the square whose corners lie on the disc: radius/√2.
    corner: f64,
}

impl Shape {
    fn new(phantom: &Phantom) -> Shape {
        let (radius, centre) = match &phantom.inclusion {
            Some(inclusion) => (inclusion.radius(), inclusion.centre_y()),
            // A disc of gel in the middle of the gel.
            None => (
                (0.2 * phantom.gel.height).min(0.25 * phantom.gel.width),
                -(phantom.skin.thickness + 0.5 * phantom.gel.height),
            ),
        };
        Shape {
            half_width: phantom.gel.width / 2.0,
            height: phantom.total_height(),
            skin: phantom.skin.thickness,
            radius,
            centre,
            corner: radius * FRAC_1_SQRT_2,
        }
    }
}

/// Number of coarse cells in each block of the lattice, and of fine rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cells {
    /// Columns from the axis to the disc's corner, and rows from its centre to its corner.
    pub disc: usize,
    /// Columns from the disc's corner to the strip along the wall.
    pub middle: usize,
    /// Columns in the strip along the wall, where they shrink.
    pub wall: usize,
    /// Rows from the floor to the disc.
    pub below: usize,
    /// Rows from the disc to the fine part, the row between the parts left out.
    pub above: usize,
    /// Fine rows: those through the skin.
    pub skin: usize,
    /// Fine columns for each coarse one.
    pub split: usize,
}

/// Heights of the coarse rows, and width of the disc's columns, over the target width: found by varying each in
/// turn. Columns count most, since the contact's edge lies between two nodes, rows least.
const HEIGHT_BELOW: f64 = 1.4;
const HEIGHT_ABOVE: f64 = 0.35;
const DISC: f64 = 1.05;
/// Thickness of the row of gel under the skin over the target width.
const BETWEEN: f64 = 0.6;
/// Width of the strip along the wall over the target width, its cells, and how much they shrink: the
/// skin is torn off the wall there, so that stress grows without bound towards the corner.
const WALL_STRIP: f64 = 2.0;
const WALL_CELLS: usize = 8;
const WALL_GRADING: f64 = 0.15;
/// How far an arc may rise over its chord, over the mean height of the cells on it.
const MOST_RISE: f64 = 0.15;
/// How much the rows above the disc shrink towards the skin.
const SKIN_GRADING: f64 = 0.5;

/// Cells of a mesh come in multiples of this, so that meshes with 3 and 2 quarters of them along every line
/// show how far its forces are from converged.
///
/// Implements: FEM-024.
pub const QUARTERS: usize = 4;

impl Cells {
    /// The cells of the unrefined mesh, all counts multiples of [`QUARTERS`].
    fn unrefined(shape: &Shape, options: &MeshOptions) -> Cells {
        let cover = Cover::new(shape, options, QUARTERS);
        let size = options.size;
        // Below 2000 by the caller's check, so that the cast is exact.
        let count = |length: f64, size: f64| {
            QUARTERS * libm::round(length / (QUARTERS as f64 * size)).max(1.0) as usize
        };
        let split = match options.element {
            Element::T6 => 2,
            Element::Q4Full => 1,
        };
        // The thicker the gel over the disc, the smoother the field in it.
        let gel_above = cover.bottom - shape.centre - shape.corner;
        let height_above = HEIGHT_ABOVE * size * (1.0 + 1.6 * gel_above / shape.height);
        let gel_below = shape.centre - shape.corner + shape.height;
        let mut cells = Cells {
            disc: 0,
            middle: count(cover.wall_strip - shape.corner, size),
            wall: WALL_CELLS,
            below: count(gel_below, HEIGHT_BELOW * size),
            above: count(gel_above, height_above),
            skin: count(shape.skin, size),
            split,
        };
        let longest = cells.longest_edge_cell(shape, &cover);
        let by_edge = QUARTERS * libm::ceil(shape.corner / (QUARTERS as f64 * longest)) as usize;
        cells.disc = count(shape.corner, DISC * size).max(by_edge);
        cells
    }

    /// `times` as many cells along every line, in quarters.
    fn refined(self, times: usize) -> Cells {
        let refined = |count: usize| count / QUARTERS * times;
        Cells {
            disc: refined(self.disc),
            middle: refined(self.middle),
            wall: refined(self.wall),
            below: refined(self.below),
            above: refined(self.above),
            skin: refined(self.skin),
            split: self.split,
        }
    }

    /// How long a cell along the disc's edge may be, m: its arc rises c²/8r over its chord, and where the
    /// gel around the disc is thin that must stay a small part of the first cell's height.
    fn longest_edge_cell(&self, shape: &Shape, cover: &Cover) -> f64 {
        let above = (cover.bottom - shape.centre - shape.radius) / self.above as f64;
        let below = (shape.centre - shape.radius + shape.height) / self.below as f64;
        let beside = (shape.half_width - shape.radius) / (self.middle + self.wall) as f64;
        libm::sqrt(8.0 * shape.radius * MOST_RISE * above.min(below).min(beside))
    }

    /// Coarse columns from the axis to the wall.
    pub fn half_columns(&self) -> usize {
        self.disc + self.middle + self.wall
    }

    /// Coarse rows from the floor to the row between the parts.
    pub fn coarse_rows(&self) -> usize {
        self.below + 2 * self.disc + self.above
    }

    /// Nodes of the whole mesh.
    pub fn nodes(&self) -> usize {
        let columns = 2 * self.half_columns();
        let coarse = (2 * columns + 1) * (2 * self.coarse_rows() + 1);
        let between = (self.split + 1) * columns + 1;
        coarse + between + (2 * self.split * columns + 1) * (2 * self.skin + 1)
    }

    /// Coarse rows of the disc.
    pub fn disc_rows(&self) -> core::ops::Range<usize> {
        self.below..self.below + 2 * self.disc
    }
}

/// Borders between the parts of the lattice, m.
#[derive(Debug, Clone, Copy)]
struct Cover {
    /// y of the top of the coarse part.
    bottom: f64,
    /// x at which the strip along the wall begins.
    wall_strip: f64,
}

impl Cover {
    /// For `times`/4 as many cells along each line as in the unrefined mesh.
    fn new(shape: &Shape, options: &MeshOptions, times: usize) -> Cover {
        // Close above a disc the row is thinner, so that the coarse rows keep half the gel there even with two
        // quarters of the cells.
        let gel_above = -shape.skin - (shape.centre + shape.radius);
        let size = options.size.min(0.25 * gel_above / BETWEEN);
        let strip = WALL_STRIP * options.size.min(0.1 * shape.half_width);
        Cover {
            bottom: -shape.skin - BETWEEN * size * QUARTERS as f64 / times as f64,
            wall_strip: shape.half_width - strip.min(0.5 * (shape.half_width - shape.corner)),
        }
    }
}

/// ξ ∈ [0, 1] → [0, 1], monotone, with the slope at 1 `ratio` times the slope at 0.
fn graded(xi: f64, ratio: f64) -> f64 {
    (libm::pow(ratio, xi) - 1.0) / (ratio - 1.0)
}

fn mix(a: f64, b: f64, fraction: f64) -> f64 {
    a + fraction * (b - a)
}

/// The right half of the lattice.
///
/// Implements: FEM-001, FEM-002.
#[derive(Debug, Clone, Copy)]
pub struct Outline {
    /// How many cells go where.
    pub cells: Cells,
    shape: Shape,
    cover: Cover,
}

impl Outline {
    /// Lays the lattice over a phantom, with `quarters`/4 of the cells that the options ask for along each line.
    pub fn new(phantom: &Phantom, options: &MeshOptions, quarters: usize) -> Outline {
        let shape = Shape::new(phantom);
        let times = quarters * options.refinement;
        Outline {
            cells: Cells::unrefined(&shape, options).refined(times),
            cover: Cover::new(&shape, options, times),
            shape,
        }
    }

    /// Position of the coarse corner in column line `i` (0 on the axis) and row line `j` (0 on the floor).
    pub fn coarse(&self, i: usize, j: usize) -> [f64; 2] {
        let Cells {
            disc, below, above, ..
        } = self.cells;
        let shape = &self.shape;
        let (first, last) = (below, below + 2 * disc);
        let line = self.line_x(i as f64);
        if j > last {
            let fraction = graded((j - last) as f64 / above as f64, SKIN_GRADING);
            let rim = self.rim(i, 1.0);
            return [
                mix(rim[0], line, fraction),
                mix(rim[1], self.cover.bottom, fraction),
            ];
        }
        if j < first {
            let fraction = (first - j) as f64 / below as f64;
            let rim = self.rim(i, -1.0);
            return [
                mix(rim[0], line, fraction),
                mix(rim[1], -shape.height, fraction),
            ];
        }
        let t = (j as f64 - (first + disc) as f64) / disc as f64;
        if i <= disc {
            return self.inside(i as f64 / disc as f64, t);
        }
        let fraction = (line - shape.corner) / (shape.half_width - shape.corner);
        let foot = self.inside(1.0, t);
        [
            mix(foot[0], shape.half_width, fraction),
            mix(foot[1], shape.centre + t * shape.corner, fraction),
        ]
    }

    /// Position of the fine corner in fine column line `i` and fine row line `j` (0 at the bottom of
    /// the fine part).
    pub fn fine(&self, i: usize, j: usize) -> [f64; 2] {
        let Cells { skin, split, .. } = self.cells;
        let y = mix(-self.shape.skin, 0.0, j as f64 / skin as f64);
        [self.line_x(i as f64 / split as f64), y]
    }

    /// The border of the middle rows, above (`t` = 1) or below (`t` = −1), where the outer rows begin.
    fn rim(&self, i: usize, t: f64) -> [f64; 2] {
        if i <= self.cells.disc {
            self.inside(i as f64 / self.cells.disc as f64, t)
        } else {
            [
                self.line_x(i as f64),
                self.shape.centre + t * self.shape.corner,
            ]
        }
    }

    /// x of column line `i`, whole or between two lines, where it is straight: on the floor and from
    /// the top of the coarse part upwards.
    fn line_x(&self, i: f64) -> f64 {
        let Cells {
            disc, middle, wall, ..
        } = self.cells;
        let (disc, middle, wall) = (disc as f64, middle as f64, wall as f64);
        let Shape {
            corner, half_width, ..
        } = self.shape;
        if i <= disc {
            corner * i / disc
        } else if i <= disc + middle {
            mix(corner, self.cover.wall_strip, (i - disc) / middle)
        } else {
            mix(
                self.cover.wall_strip,
                half_width,
                graded((i - disc - middle) / wall, WALL_GRADING),
            )
        }
    }

    /// The square [−1, 1]² bent into the disc: the Coons patch between its four quarter arcs.
    fn inside(&self, s: f64, t: f64) -> [f64; 2] {
        let Shape {
            radius,
            corner,
            centre,
            ..
        } = self.shape;
        let coordinate = |a: f64, b: f64| {
            a * radius * libm::cos(b * FRAC_PI_4) + radius * libm::sin(a * FRAC_PI_4) - a * corner
        };
        [coordinate(s, t), centre + coordinate(t, s)]
    }

    /// The middle of the edge from coarse corner `a` to `b`: on the circle where the edge is a piece
    /// of the disc's, half-way otherwise.
    pub fn coarse_middle(&self, a: [usize; 2], b: [usize; 2]) -> [f64; 2] {
        let mid = half_way(self.coarse(a[0], a[1]), self.coarse(b[0], b[1]));
        if !self.on_disc_edge(a, b) {
            return mid;
        }
        // Both ends lie on the circle, so that the chord's middle points to the arc's middle.
        let (x, y) = (mid[0], mid[1] - self.shape.centre);
        let scale = self.shape.radius / libm::sqrt(x * x + y * y);
        [x * scale, self.shape.centre + y * scale]
    }

    /// Whether the edge between two neighbouring corners is a piece of the disc's edge.
    fn on_disc_edge(&self, a: [usize; 2], b: [usize; 2]) -> bool {
        let disc = self.cells.disc;
        let rows = self.cells.disc_rows();
        let on_side = a[0] == disc && b[0] == disc && rows.contains(&a[1].min(b[1]));
        let on_lid =
            a[1] == b[1] && (a[1] == rows.start || a[1] == rows.end) && a[0].min(b[0]) < disc;
        on_side || on_lid
    }
}

/// The middle between two points; the same bits whichever comes first.
pub fn half_way(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
}

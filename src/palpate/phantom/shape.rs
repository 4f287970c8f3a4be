//! The outlines of inclusions.

use serde::{Deserialize, Serialize};

use super::Inclusion;

/// The shape of an inclusion's cross-section.
///
/// Implements: PHA-017.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields, expecting = "a table")]
pub enum Shape {
    /// A circle.
    Disc {
        /// Diameter, m.
        #[serde(rename = "diameter_m")]
        diameter: f64,
    },
    /// An ellipse.
    Ellipse {
        /// First principal diameter, along x where the angle is 0, m.
        #[serde(rename = "width_m")]
        width: f64,
        /// Second principal diameter, m.
        #[serde(rename = "height_m")]
        height: f64,
        /// Angle from +x to the first principal diameter, counter-clockwise, degrees: a decimal of radians is no right
        /// angle.
        #[serde(default)]
        angle_deg: f64,
    },
    /// A closed polygon.
    Polygon {
        /// Its corners (x, y) in turn, m. x counts from the inclusion's centre; y counts from anywhere, since the depth says
        /// where the highest corner lies.
        #[serde(rename = "points_m")]
        points: Vec<[f64; 2]>,
    },
}

/// An inclusion's outline in the phantom, m.
///
/// Implements: PHA-008, PHA-017.
#[derive(Debug, Clone, PartialEq)]
pub enum Outline {
    /// An ellipse or a circle.
    Ellipse(Ellipse),
    /// Corners, counter-clockwise.
    Polygon(Vec<[f64; 2]>),
}

/// An ellipse in the phantom, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipse {
    /// The centre.
    pub centre: [f64; 2],
    /// Half diameters.
    pub radii: [f64; 2],
    /// Cosine and sine of the angle from +x to the first of them.
    pub turn: [f64; 2],
}

impl Ellipse {
    /// The point at the angle `t` from the first diameter.
    pub fn at(&self, t: f64) -> [f64; 2] {
        let ([x, y], [cos, sin]) = (self.centre, self.turn);
        let (a, b) = (self.radii[0] * libm::cos(t), self.radii[1] * libm::sin(t));
        [x + a * cos - b * sin, y + a * sin + b * cos]
    }

    /// Where a point stands if the ellipse becomes the unit circle.
    pub fn on_unit_circle(&self, point: Point) -> Point {
        let arm = minus(point, self.centre);
        [
            dot(arm, self.turn) / self.radii[0],
            cross(self.turn, arm) / self.radii[1],
        ]
    }

    /// Half the width and half the height.
    fn half_extent(&self) -> [f64; 2] {
        let ([a, b], [cos, sin]) = (self.radii, self.turn);
        [libm::hypot(a * cos, b * sin), libm::hypot(a * sin, b * cos)]
    }
}

impl Inclusion {
    /// The outline, in the phantom's coordinates.
    pub fn outline(&self) -> Outline {
        let (radii, turn) = match &self.shape {
            Shape::Disc { diameter } => ([0.5 * diameter; 2], [1.0, 0.0]),
            Shape::Ellipse {
                width,
                height,
                angle_deg,
            } => ([0.5 * width, 0.5 * height], direction(*angle_deg)),
            Shape::Polygon { points } => {
                let [_, _, _, top] = extent(points);
                let place = |&[x, y]: &Point| [self.centre_x + x, (y - top) - self.depth];
                let mut placed: Vec<_> = points.iter().map(place).collect();
                let doubled_area: f64 = edges(&placed).iter().map(|&[a, b]| cross(a, b)).sum();
                if doubled_area < 0.0 {
                    placed.reverse();
                }
                return Outline::Polygon(placed);
            }
        };
        let mut ellipse = Ellipse {
            centre: [self.centre_x, 0.0],
            radii,
            turn,
        };
        ellipse.centre[1] = -(self.depth + ellipse.half_extent()[1]);
        Outline::Ellipse(ellipse)
    }

    /// Left, right, lower and upper end of the outline, m.
    pub fn extent(&self) -> [f64; 4] {
        match self.outline() {
            Outline::Ellipse(ellipse) => {
                let ([x, y], [width, height]) = (ellipse.centre, ellipse.half_extent());
                [x - width, x + width, y - height, y + height]
            }
            Outline::Polygon(points) => extent(&points),
        }
    }
}

impl Outline {
    /// The mirror image in x.
    pub(super) fn mirrored(mut self) -> Outline {
        match &mut self {
            Outline::Ellipse(Ellipse { centre, turn, .. }) => {
                centre[0] = -centre[0];
                // An ellipse along x is its own image, though the other way round.
                turn[0] *= if turn[1] == 0.0 { 1.0 } else { -1.0 };
            }
            Outline::Polygon(points) => {
                points.reverse();
                points.iter_mut().for_each(|point| point[0] = -point[0]);
            }
        }
        self
    }

    /// Whether two outlines are the same to the bit, wherever a polygon begins.
    pub(super) fn is_same(&self, other: &Outline) -> bool {
        let (Outline::Polygon(a), Outline::Polygon(b)) = (self, other) else {
            return self == other;
        };
        let twice = [&b[..], b].concat();
        a.len() == b.len() && twice.windows(a.len().max(1)).any(|points| points == a)
    }

    /// Whether a point lies within.
    pub fn encloses(&self, p: Point) -> bool {
        match self {
            Outline::Ellipse(ellipse) => {
                let [x, y] = ellipse.on_unit_circle(p);
                x * x + y * y < 1.0
            }
            Outline::Polygon(points) => contains(&edges(points), p),
        }
    }

    /// Corners of a polygon along the outline, counter-clockwise: the outline itself, or `pieces` chords of an ellipse.
    pub fn chords(&self, pieces: usize) -> Vec<[f64; 2]> {
        match self {
            Outline::Polygon(points) => points.clone(),
            Outline::Ellipse(ellipse) => {
                let angle = |piece| std::f64::consts::TAU * piece as f64 / pieces as f64;
                (0..pieces).map(|piece| ellipse.at(angle(piece))).collect()
            }
        }
    }
}

/// Cosine and sine of an angle in degrees, but for a half turn, which changes no ellipse: to the bit the mirror image of those
/// of the opposite angle, and exact at a right angle.
fn direction(angle_deg: f64) -> [f64; 2] {
    let angle = angle_deg % 180.0;
    // The angle to the nearer half of the x axis.
    let acute = angle.abs().min(180.0 - angle.abs());
    let [sin, cos] = [libm::sin, libm::cos].map(|function| function(acute.to_radians()));
    let cos = if acute == 90.0 { 0.0 } else { cos };
    let is_left = (angle.abs() > 90.0) != (angle < 0.0);
    [if is_left { -cos } else { cos }, sin]
}

/// A point, m, or the way from one to another.
pub(super) type Point = [f64; 2];

/// Left, right, lower and upper end of some points.
pub(super) fn extent(points: &[Point]) -> [f64; 4] {
    let (least, most) = (f64::NEG_INFINITY, f64::INFINITY);
    let around = |[left, right, bottom, top]: [f64; 4], &[x, y]: &Point| {
        [left.min(x), right.max(x), bottom.min(y), top.max(y)]
    };
    points.iter().fold([most, least, most, least], around)
}

/// The edges of a closed polygon: from each corner to the next.
pub fn edges(points: &[Point]) -> Vec<[Point; 2]> {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(&a, &b)| [a, b]).collect()
}

/// Whether `p` lies within a polygon: a ray from it to +x crosses an odd number of edges.
pub(super) fn contains(edges: &[[Point; 2]], p: Point) -> bool {
    let crossed = |[a, b]: &[Point; 2]| {
        (a[1] > p[1]) != (b[1] > p[1])
            && (cross(minus(*b, *a), minus(p, *a)) > 0.0) == (b[1] > a[1])
    };
    edges.iter().filter(|edge| crossed(edge)).count() % 2 == 1
}

/// The distance of `p` from the segment between `a` and `b`, m.
pub fn point_to_segment(p: Point, a: Point, b: Point) -> f64 {
    let (along, to) = (minus(b, a), minus(p, a));
    // A segment without a length, whose products are all 0, is the point `a`.
    let square = dot(along, along).max(f64::MIN_POSITIVE);
    let t = (dot(to, along) / square).clamp(0.0, 1.0);
    let off = [to[0] - t * along[0], to[1] - t * along[1]];
    libm::sqrt(dot(off, off))
}

pub(super) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(super) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

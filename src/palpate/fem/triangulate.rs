//! Triangles of a wanted size over a phantom: points along all its lines, then a constrained Delaunay triangulation that
//! is refined by circumcentres where its triangles are too large or too flat, and smoothed.

use core::f64::consts::PI;
use std::collections::HashMap;

use spade::handles::FixedVertexHandle;
use spade::{
    ConstrainedDelaunayTriangulation, Point2, PositionInTriangulation, Triangulation as _,
};

use super::FemError;
use super::size::SizeField;
use super::triangle::{
    Point, circumcircle, degrees, doubled_area, mean, shortest_edge, smallest_angle, smallest_sine,
};
use crate::phantom::{Ellipse, Outline, Phantom};
use crate::refusal::Refusal;

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// A triangle is refined if an equilateral one with the same circumcircle would be larger than the wanted size by this
/// factor, or if it is flat and larger than a part of it.
const TOO_LARGE: f64 = 1.35;
/// Circumradius over shortest edge above which a triangle is flat: an angle of 22.6°.
const TOO_FLAT: f64 = 1.3;
const FLAT_FROM: f64 = 0.75;
/// Least distance of a new point from others over the wanted size.
const APART: f64 = 0.6;
/// Radius of the circle about a line's piece in which no new point may lie, over half the piece.
const CLEAR: f64 = 1.05;
const REFINEMENTS: usize = 60;
const SMOOTHINGS: usize = 5;
/// Rounds in which triangles that are still flat are cut up.
const REPAIRS: usize = 12;
/// Smoothing that would leave a smaller angle, degrees, gives way to a search for the best place, in so many steps.
const GOOD_ANGLE: f64 = 30.0;
const SEARCH_STEPS: usize = 12;
/// Steps of the quadrature along a line, for each expected piece and at least.
const STEPS: [usize; 2] = [16, 256];

/// The smallest angle that a triangle's corners may make, degrees.
///
/// Implements: FEM-017.
pub const SMALLEST_ANGLE: f64 = 25.0;

/// A piece of a line: the numbers of its ends, the line, and where on it they stand.
struct Segment {
    ends: [usize; 2],
    line: usize,
    at: [f64; 2],
}

/// A line of a phantom, by its point at 0 to 1.
type Line = Box<dyn Fn(f64) -> Point>;

/// Corners and triangles over a phantom, or over the right half of a symmetric one.
pub struct Triangulation<'a> {
    size: &'a SizeField,
    half: bool,
    /// The lower left corner, and the right wall.
    low: Point,
    right: f64,
    /// Positions, m.
    pub corners: Vec<Point>,
    /// Whether each corner stands on a line.
    on_line: Vec<bool>,
    /// Corners of each triangle, counter-clockwise.
    pub triangles: Vec<[usize; 3]>,
    lines: Vec<Line>,
    segments: Vec<Segment>,
    /// The number of each corner on a line, by the bits of its position.
    known: HashMap<[u64; 2], usize>,
}

impl Triangulation<'_> {
    /// Triangulates a valid phantom.
    ///
    /// Implements: FEM-002, FEM-017.
    pub fn new<'a>(
        phantom: &Phantom,
        size: &'a SizeField,
        half: bool,
    ) -> Result<Triangulation<'a>, FemError> {
        let right = 0.5 * phantom.well().width;
        let left = if half { 0.0 } else { -right };
        let mut new = Triangulation {
            size,
            half,
            low: Point::new(left, phantom.levels()[phantom.layers().len()]),
            right,
            corners: Vec::new(),
            on_line: Vec::new(),
            triangles: Vec::new(),
            lines: Vec::new(),
            segments: Vec::new(),
            known: HashMap::new(),
        };
        new.draw_lines(phantom);
        new.refine()?;
        for round in 0..SMOOTHINGS + REPAIRS {
            new.move_corners();
            new.connect()?;
            if round < SMOOTHINGS {
                continue;
            }
            if new.flattest().0 >= SMALLEST_ANGLE {
                return Ok(new);
            }
            new.repair()?;
        }
        let (angle, at) = new.flattest();
        Err(flat(at, angle))
    }

    /// The middle of each piece of a line, on the line where that is bent, by the numbers of its ends, smaller first.
    pub fn middles(&self) -> HashMap<[usize; 2], Point> {
        let middle = |s: &Segment| {
            let [a, b] = s.ends;
            let middle = 0.5 * (s.at[0] + s.at[1]);
            ([a.min(b), a.max(b)], self.lines[s.line](middle))
        };
        self.segments.iter().map(middle).collect()
    }

    fn at(&self, triangle: &[usize; 3]) -> [Point; 3] {
        triangle.map(|corner| self.corners[corner])
    }

    /// The smallest angle of all, degrees, and its place.
    fn flattest(&self) -> (f64, Point) {
        let sines = self
            .triangles
            .iter()
            .map(|t| (smallest_sine(self.at(t)), t));
        let flattest = sines.min_by(|(a, _), (b, _)| a.total_cmp(b));
        let angle = |(sine, t): (f64, &[usize; 3])| (degrees(sine), self.corners[t[0]]);
        flattest.map_or((180.0, Point::zeros()), angle)
    }

    fn draw_lines(&mut self, phantom: &Phantom) {
        let (left, right) = (self.low.x, self.right);
        let levels = phantom.levels();
        for &y in &levels {
            self.straight([left, y], [right, y]);
        }
        for inclusion in phantom.inclusions() {
            if self.half && inclusion.extent()[1] <= 0.0 {
                continue;
            }
            match inclusion.outline() {
                Outline::Polygon(points) => self.polygon(&points),
                Outline::Ellipse(ellipse) => self.ellipse(ellipse),
            }
        }
        let mut left_line = levels.clone();
        if self.half {
            left_line.extend(self.corners.iter().filter(|p| p.x == 0.0).map(|p| p.y));
            left_line.sort_by(|a, b| b.total_cmp(a));
            left_line.dedup_by(|a, b| a == b);
        }
        for (x, ys) in [(right, levels), (left, left_line)] {
            for pair in ys.windows(2) {
                self.straight([x, pair[0]], [x, pair[1]]);
            }
        }
    }

    fn straight(&mut self, a: [f64; 2], b: [f64; 2]) {
        // Both ends, and a shared coordinate, to the bit.
        let mix = |t: f64, a: f64, b: f64| if a == b { a } else { a * (1.0 - t) + b * t };
        self.line(Box::new(move |t| {
            Point::new(mix(t, a[0], b[0]), mix(t, a[1], b[1]))
        }));
    }

    /// The outline of an ellipse; in a half, the right part of one on the axis.
    fn ellipse(&mut self, ellipse: Ellipse) {
        let at = move |angle| Point::from(ellipse.at(angle));
        if self.half && ellipse.centre[0] == 0.0 {
            // The cosine of π/2 is not 0 in binary.
            let on_axis = |t: f64| t == 0.0 || t == 1.0;
            // Where it is furthest to the right: one of its diameters is level.
            let [cos, sin] = ellipse.turn;
            let right = -libm::atan2(sin, cos);
            self.line(Box::new(move |t| {
                let point = at(right + (t - 0.5) * PI);
                Point::new(if on_axis(t) { 0.0 } else { point.x }, point.y)
            }));
        } else {
            let angle = |t: f64| if t == 1.0 { 0.0 } else { 2.0 * PI * t };
            self.line(Box::new(move |t| at(angle(t))));
        }
    }

    /// The outline of a polygon; in a half, its part right of the axis, which an edge of a symmetric polygon crosses level.
    fn polygon(&mut self, points: &[[f64; 2]]) {
        let half = self.half;
        let cut = |p: &[f64; 2]| if half { [p[0].max(0.0), p[1]] } else { *p };
        let next = points.iter().cycle().skip(1).map(cut);
        for (a, b) in points.iter().map(cut).zip(next) {
            if !half || a[0] > 0.0 || b[0] > 0.0 {
                self.straight(a, b);
            }
        }
    }

    /// Cuts a line into pieces of the wanted size.
    fn line(&mut self, line: Line) {
        let cuts = cuts(&line, self.size);
        let mut ends = Vec::with_capacity(cuts.len());
        for &t in &cuts {
            let point = line(t);
            let key = [point.x, point.y].map(|x| (x + 0.0).to_bits());
            ends.push(match self.known.get(&key) {
                Some(&corner) => corner,
                None => self.push(point, true),
            });
            self.known.insert(key, ends[ends.len() - 1]);
        }
        for (at, ends) in cuts.windows(2).zip(ends.windows(2)) {
            self.segments.push(Segment {
                ends: [ends[0], ends[1]],
                line: self.lines.len(),
                at: [at[0], at[1]],
            });
        }
        self.lines.push(line);
    }

    fn push(&mut self, point: Point, on_line: bool) -> usize {
        self.corners.push(point);
        self.on_line.push(on_line);
        self.corners.len() - 1
    }

    /// Corner by corner, since spade's bulk loading depends on a random order. The search for a corner's place begins at one of its
    /// neighbours in the last triangulation.
    fn delaunay(&self) -> Result<Delaunay, FemError> {
        let mut delaunay = Delaunay::new();
        let crossing = |corner: usize| flat(self.corners[corner], 0.0);
        let mut neighbours = vec![None; self.corners.len()];
        for triangle in &self.triangles {
            let least = triangle.iter().min();
            for &corner in triangle.iter().filter(|corner| Some(*corner) != least) {
                neighbours[corner] = least;
            }
        }
        let mut handles: Vec<FixedVertexHandle> = Vec::with_capacity(self.corners.len());
        for (corner, p) in self.corners.iter().enumerate() {
            let p = Point2::new(p.x, p.y);
            let inserted = match neighbours[corner] {
                Some(&near) => delaunay.insert_with_hint(p, handles[near]),
                None => delaunay.insert(p),
            };
            match inserted {
                Ok(handle) if handle.index() == corner => handles.push(handle),
                _ => return Err(crossing(corner)),
            }
        }
        for segment in &self.segments {
            let [a, b] = segment.ends.map(|end| handles[end]);
            if delaunay.try_add_constraint(a, b).is_empty() {
                return Err(crossing(segment.ends[0]));
            }
        }
        Ok(delaunay)
    }

    fn connect(&mut self) -> Result<(), FemError> {
        self.triangles = triangles(&self.delaunay()?);
        Ok(())
    }

    /// The circle about a piece of a line in which no other corner may lie: centre and square of the radius.
    fn circle(&self, segment: &Segment) -> (Point, f64) {
        let [a, b] = segment.ends.map(|end| self.corners[end]);
        let radius = 0.5 * CLEAR * (a - b).norm();
        ((a + b) / 2.0, radius * radius)
    }

    /// Whether a point lies within the rectangle of all lines.
    fn within(&self, point: Point) -> bool {
        self.low < point && point < Point::new(self.right, 0.0)
    }

    /// Adds circumcentres until every triangle is small and stout enough.
    fn refine(&mut self) -> Result<(), FemError> {
        let mut delaunay = self.delaunay()?;
        let circles: Vec<_> = self.segments.iter().map(|s| self.circle(s)).collect();
        for _ in 0..REFINEMENTS {
            let refined = |(near, corners): (FixedVertexHandle, [Point; 3])| {
                let (centre, radius) = circumcircle(corners);
                let large = radius * libm::sqrt(3.0) / self.size.at(mean(corners));
                let flat = radius / shortest_edge(corners);
                let refine = large > TOO_LARGE || flat > TOO_FLAT && large > FLAT_FROM;
                refine.then_some((large.max(0.5 * flat), centre, near))
            };
            let faces = delaunay.inner_faces();
            let triangles = faces.map(|face| {
                let [near, ..] = face.vertices();
                (near.fix(), face.positions().map(|p| Point::new(p.x, p.y)))
            });
            let mut wanted: Vec<_> = triangles.filter_map(refined).collect();
            let place = |p: &Point| (p.x.to_bits(), p.y.to_bits());
            wanted.sort_by(|(a, p, _), (b, q, _)| b.total_cmp(a).then(place(p).cmp(&place(q))));
            let before = self.corners.len();
            for (_, point, near) in wanted {
                if !self.within(point) || circles.iter().any(|of| encloses(of, point)) {
                    continue;
                }
                let apart = APART * self.size.at(point);
                let close = |p: &Point2<f64>| (Point::new(p.x, p.y) - point).norm() < apart;
                let vertex = Point2::new(point.x, point.y);
                let crowded = match delaunay.locate_with_hint(vertex, near) {
                    PositionInTriangulation::OnFace(face) => {
                        delaunay.face(face).positions().iter().any(close)
                    }
                    PositionInTriangulation::OnEdge(edge) => {
                        let ends = delaunay.directed_edge(edge).positions();
                        ends.iter().any(close)
                    }
                    _ => true,
                };
                if !crowded && delaunay.insert_with_hint(vertex, near).is_ok() {
                    self.push(point, false);
                }
            }
            if self.corners.len() == before {
                break;
            }
        }
        self.triangles = triangles(&delaunay);
        Ok(())
    }

    /// Adds the circumcentre of each triangle that is still flat, or cuts the pieces of lines in whose circles it lies.
    fn repair(&mut self) -> Result<(), FemError> {
        let corners = self.triangles.iter().map(|triangle| self.at(triangle));
        let flat = corners.filter(|corners| smallest_angle(*corners) < SMALLEST_ANGLE);
        let centres: Vec<Point> = flat.map(|corners| circumcircle(corners).0).collect();
        for point in centres {
            let encloses = |&k: &usize| encloses(&self.circle(&self.segments[k]), point);
            let hit: Vec<usize> = (0..self.segments.len()).filter(encloses).collect();
            let taken = |corner: &Point| (corner - point).norm() < 0.1 * self.size.at(point);
            if hit.is_empty() && self.within(point) && !self.corners.iter().any(taken) {
                self.push(point, false);
            }
            for k in hit {
                let cut = &self.segments[k];
                let ([a, b], line, [from, to]) = (cut.ends, cut.line, cut.at);
                let middle = 0.5 * (from + to);
                let new = self.push(self.lines[line](middle), true);
                let piece = |ends, at| Segment { ends, line, at };
                self.segments[k] = piece([a, new], [from, middle]);
                self.segments.push(piece([new, b], [middle, to]));
            }
        }
        self.connect()
    }

    /// Moves each corner that is on no line towards the centres of the triangles around it, means of centroid and
    /// circumcentre, weighed so that sizes follow the size function. Where that leaves a flat triangle, to where the smallest angle
    /// is largest.
    fn move_corners(&mut self) {
        let mut around = vec![Vec::new(); self.corners.len()];
        for triangle in &self.triangles {
            for &corner in triangle {
                around[corner].push(*triangle);
            }
        }
        for corner in (0..self.corners.len()).filter(|&corner| !self.on_line[corner]) {
            let (mut sum, mut weights) = (Point::zeros(), 0.0);
            for triangle in &around[corner] {
                let corners = self.at(triangle);
                let centroid = mean(corners);
                let wanted = self.size.at(centroid);
                let (centre, radius) = circumcircle(corners);
                let stout = radius < 1.2 * wanted;
                let target = if stout {
                    (centre + centroid) / 2.0
                } else {
                    centroid
                };
                let weight = doubled_area(corners) / wanted.powi(4);
                sum += weight * target;
                weights += weight;
            }
            let towards = sum / weights;
            let smooth = self.smallest_around(corner, towards, &around[corner]) >= GOOD_ANGLE;
            self.corners[corner] = if smooth {
                towards
            } else {
                self.best_place(corner, &around[corner])
            };
        }
    }

    /// The smallest angle, degrees, of the triangles around a corner if it stood at `at`.
    fn smallest_around(&self, corner: usize, at: Point, around: &[[usize; 3]]) -> f64 {
        let moved = |k: usize| if k == corner { at } else { self.corners[k] };
        let sine = |triangle: &[usize; 3]| smallest_sine(triangle.map(moved));
        degrees(around.iter().map(sine).fold(1.0, f64::min))
    }

    /// Pattern search: steps in eight directions, halved where none helps.
    fn best_place(&self, corner: usize, around: &[[usize; 3]]) -> Point {
        let mut at = self.corners[corner];
        let mut best = self.smallest_around(corner, at, around);
        let edge = |triangle| shortest_edge(self.at(triangle));
        let mut step = 0.25 * around.iter().map(edge).fold(f64::INFINITY, f64::min);
        for _ in 0..SEARCH_STEPS {
            let from = at;
            for direction in 0..8 {
                let (sin, cos) = libm::sincos(f64::from(direction) * 0.25 * PI);
                let to = from + step * Point::new(cos, sin);
                let angle = self.smallest_around(corner, to, around);
                if angle > best {
                    (best, at) = (angle, to);
                }
            }
            if at == from {
                step *= 0.5;
            }
        }
        at
    }
}

/// The corners of each triangle.
fn triangles(delaunay: &Delaunay) -> Vec<[usize; 3]> {
    let faces = delaunay.inner_faces();
    faces
        .map(|face| face.vertices().map(|v| v.index()))
        .collect()
}

/// Whether a point lies within a circle of [`Triangulation::circle`].
fn encloses((centre, squared): &(Point, f64), point: Point) -> bool {
    (centre - point).norm_squared() < *squared
}

/// Where to cut a line, from 0 to 1, so that its pieces are about as long as wanted: equal shares of ∫ ds/h.
fn cuts(at: &Line, size: &SizeField) -> Vec<f64> {
    let integral = |steps: usize| {
        let mut sums = vec![0.0];
        for k in 0..steps {
            let [from, middle, to] =
                [0.0, 0.5, 1.0].map(|part| at((k as f64 + part) / steps as f64));
            sums.push(sums[k] + (to - from).norm() / size.at(middle));
        }
        sums
    };
    let rough = integral(STEPS[1])[STEPS[1]];
    let steps = STEPS[1].max(STEPS[0] * rough as usize);
    let sums = integral(steps);
    let count = libm::round(sums[steps]).max(1.0) as usize;
    let cut = |k: usize| {
        let share = sums[steps] * k as f64 / count as f64;
        let step = sums.partition_point(|&sum| sum < share) - 1;
        (step as f64 + (share - sums[step]) / (sums[step + 1] - sums[step])) / steps as f64
    };
    let cuts = (1..count).map(cut);
    [0.0].into_iter().chain(cuts).chain([1.0]).collect()
}

/// The refusal of a triangle at `at` (m) that is too flat, or of lines that cross there (0°).
fn flat(at: Point, angle: f64) -> FemError {
    let (x, y) = (at.x * 1e3, at.y * 1e3);
    let found = format!("a triangle near x = {x:.3} mm, y = {y:.3} mm has an angle of {angle:.1}°");
    let found = format!("{found}, under {SMALLEST_ANGLE}°: the mesh cannot follow this phantom");
    Refusal::state(found, "try another mesh size").into()
}

//! Triangles by the positions of their corners, m.

use nalgebra::Vector2;

/// A position, m.
pub type Point = Vector2<f64>;

/// The centroid.
pub fn mean([a, b, c]: [Point; 3]) -> Point {
    (a + b + c) / 3.0
}

/// Twice the area, m²: positive if the corners run counter-clockwise.
pub fn doubled_area([a, b, c]: [Point; 3]) -> f64 {
    (b - a).perp(&(c - a))
}

/// The length of the shortest edge, m.
pub fn shortest_edge([a, b, c]: [Point; 3]) -> f64 {
    (b - a).norm().min((c - b).norm()).min((a - c).norm())
}

/// Centre and radius of the circumcircle, m.
pub fn circumcircle([a, b, c]: [Point; 3]) -> (Point, f64) {
    let (p, q) = (b - a, c - a);
    let turned =
        p.norm_squared() * Point::new(q.y, -q.x) - q.norm_squared() * Point::new(p.y, -p.x);
    let arm = turned / (2.0 * p.perp(&q));
    (a + arm, arm.norm())
}

/// The sine of a triangle's smallest angle: the shortest edge, opposite of it, over the circumcircle's diameter. 0 for a triangle
/// that is turned over.
pub fn smallest_sine(corners: [Point; 3]) -> f64 {
    if doubled_area(corners) > 0.0 {
        let (_, radius) = circumcircle(corners);
        shortest_edge(corners) / (2.0 * radius)
    } else {
        0.0
    }
}

/// The smallest angle of a triangle, degrees; 0 for one that is turned over.
pub fn smallest_angle(corners: [Point; 3]) -> f64 {
    degrees(smallest_sine(corners))
}

/// The angle, degrees, of this sine.
pub fn degrees(sine: f64) -> f64 {
    libm::asin(sine).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: FEM-017.
    #[test]
    fn the_smallest_angle_is_that_of_school_and_0_for_a_triangle_turned_over() {
        let root = libm::sqrt(3.0);
        for (corners, angle) in [
            ([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], 45.0),
            ([[2.0, 1.0], [2.0 + root, 1.0], [2.0, 2.0]], 30.0),
            ([[0.0, 0.0], [1.0, 0.0], [0.5, 0.5 * root]], 60.0),
        ] {
            let [a, b, c] = corners.map(Point::from);
            // A few roundings.
            assert!((smallest_angle([a, b, c]) - angle).abs() < 1e-12);
            assert_eq!(smallest_angle([a, c, b]), 0.0);
            assert_eq!(smallest_angle([a, b, a + 2.0 * (b - a)]), 0.0);
        }
    }
}

//! Which phantoms are physical, and can be meshed.

use std::ops::Bound::{Excluded, Included, Unbounded};
use std::ops::{RangeBounds, RangeInclusive};

use super::shape::{Point, contains, cross, dot, edges, extent, minus, point_to_segment};
use super::{Geometry, Inclusion, Material, Outline, Phantom, Shape, Strain, Support};
use crate::decimal::{Scaled, kpa, mm, plain};
use crate::refusal::Refusal;

/// The least distance, m, between the outline of an inclusion and its layer's top and bottom, the walls, other outlines, and
/// parts of the same outline: no mesh of sound elements fits in less.
///
/// Implements: PHA-006.
pub const CLEARANCE: f64 = 1e-4;

/// Allowed lengths, m. The upper end catches a length in the wrong unit, the lower one a layer that no mesh resolves.
const LENGTHS: RangeInclusive<f64> = 1e-6..=1.0;

/// Above this Poisson's ratio displacement elements lock, and the stiffness matrix is nearly singular.
const LARGEST_POISSON_RATIO: f64 = 0.4995;
/// With pressures λ ln J as unknowns of their own, no element locks, and λ must be above 0.
const LARGEST_WITH_PRESSURES: f64 = 0.4999;

/// The largest modulus that need not be there, Pa: no solid is stiffer.
const LARGEST_MODULUS: f64 = 1e12;

/// The largest coefficient of friction: rubber on dry glass.
const LARGEST_FRICTION: f64 = 2.0;

/// The larger diameter of an ellipse over the smaller, at most.
const LARGEST_ASPECT_RATIO: f64 = 20.0;

/// The least angle between two edges of a polygon, degrees.
const SHARPEST_CORNER: f64 = 30.0;

/// Chords that stand for an ellipse in distances. They lie within it by at most 1 − cos(π/256) < 0.00008 of its half larger
/// diameter, so that a distance comes out too long by at most 0.4 µm for 10 mm.
const CHORDS: usize = 256;

/// Why a place must be 0.
pub(super) const AXIS: &str = " (the axis of an axisymmetric phantom)";

type Check = Result<(), Refusal>;

impl Phantom {
    /// Whether this phantom can exist and be meshed.
    ///
    /// # Errors
    /// The first offending key of the phantom file, its value and what is allowed, both in the unit of the file.
    ///
    /// Implements: PHA-004, PHA-006, PHA-009, PHA-015, PHA-030, CON-007.
    pub(super) fn check(&self) -> Check {
        check_name("name", &self.0.name)?;
        // Wider than the smallest probe.
        let widths = (Excluded(2.0 * LENGTHS.start()), Included(*LENGTHS.end()));
        within("well.width_mm", mm(self.0.well.width), widths, "")?;
        self.check_supports()?;
        check_count("layer", self.0.layers.len(), 1..=100)?;
        for (at, layer) in self.0.layers.iter().enumerate() {
            let key = format!("layer[{at}]");
            check_name(&format!("{key}.name"), &layer.name)?;
            let thickness = mm(layer.thickness);
            within(&format!("{key}.thickness_mm"), thickness, LENGTHS, "")?;
            check_material(&key, &layer.material, self.0.strain)?;
        }
        within("probe.length_mm", mm(self.0.probe.length), LENGTHS, "")?;
        let radii = *LENGTHS.start()..to_picometre(self.0.well.width / 2.0);
        let why = " (the probe must be narrower than the well)";
        within("probe.radius_mm", mm(self.0.probe.radius), radii, why)?;
        let friction = plain(self.0.probe.friction);
        at_finite_strain("probe.friction", friction, self.0.strain, LARGEST_FRICTION)?;
        self.check_revolution()?;
        check_count("inclusion", self.0.inclusions.len(), 0..=100)?;
        for (at, inclusion) in self.0.inclusions.iter().enumerate() {
            let key = format!("inclusion[{at}]");
            check_shape(&key, inclusion)?;
            check_material(&key, &inclusion.material, self.0.strain)?;
            self.check_place(&key, inclusion)?;
        }
        check_distances(&self.0.inclusions)
    }

    /// Whether the cross-section can be turned about its axis.
    ///
    /// Implements: PHA-033.
    fn check_revolution(&self) -> Check {
        if self.0.geometry == Geometry::Plane {
            return Ok(());
        }
        let (length, diameter) = (self.0.probe.length, to_picometre(2.0 * self.0.probe.radius));
        let why = " (the diameter of the sphere that the probe of an axisymmetric phantom is)";
        within("probe.length_mm", mm(length), diameter..=diameter, why)?;
        for (at, inclusion) in self.0.inclusions.iter().enumerate() {
            let key = format!("inclusion[{at}].centre_x_mm");
            within(&key, mm(inclusion.centre_x), 0.0..=0.0, AXIS)?;
        }
        let found = "\"axisymmetric\"";
        let expected = "\"plane\" where the phantom is not its own mirror image: give inclusions that are, fibres along x or y, and no friction";
        Refusal::value("geometry", found, expected).when(!self.is_symmetric())
    }

    fn check_supports(&self) -> Check {
        let (walls, floor) = (self.0.well.walls, self.0.well.floor);
        let (enough, how) = match (walls, floor) {
            (Support::Sliding, Support::Free) => ("\"fixed\" or \"sliding\"", "up"),
            (Support::Free, Support::Free) => ("\"fixed\"", "up"),
            (Support::Free, Support::Sliding) => ("\"fixed\"", "from sliding sideways"),
            _ => return Ok(()),
        };
        let expected =
            format!("{enough} where walls = \"{walls}\": nothing holds the layers {how}");
        refuse("well.floor", format!("\"{floor}\""), expected)
    }

    /// Within one layer and the walls.
    fn check_place(&self, key: &str, inclusion: &Inclusion) -> Check {
        let [left, right, bottom, top] = inclusion.extent();
        let (levels, middle) = (self.levels(), 0.5 * (bottom + top));
        let under = levels[1..].iter().position(|&level| middle > level);
        let layer = under.unwrap_or(self.0.layers.len() - 1);
        let lowest = bottom - top - CLEARANCE - levels[layer + 1];
        let depths = to_picometre(CLEARANCE - levels[layer])..=to_picometre(lowest);
        let [high, wide] = [top - bottom, right - left].map(in_mm);
        if depths.is_empty() {
            let most = in_mm(self.0.layers[layer].thickness - 2.0 * CLEARANCE);
            let expected = format!("at most {most}: 0.1 mm of layer[{layer}] above and below");
            return refuse(key, format!("{high} high"), expected);
        }
        let why = format!(
            " (0.1 mm of layer[{layer}] must lie above and below the inclusion, {high} high)"
        );
        let depth_key = format!("{key}.depth_mm");
        within(&depth_key, mm(inclusion.depth), depths, &why)?;
        let (x, most) = (inclusion.centre_x, self.0.well.width / 2.0 - CLEARANCE);
        let places = to_picometre(x - left - most)..=to_picometre(most - (right - x));
        if places.is_empty() {
            let expected = format!("at most {}: 0.1 mm beside each wall", in_mm(2.0 * most));
            return refuse(key, format!("{wide} wide"), expected);
        }
        let why = format!(" (0.1 mm must lie between the inclusion, {wide} wide, and each wall)");
        within(&format!("{key}.centre_x_mm"), mm(x), places, &why)
    }
}

/// `length` (m) on a grid of 1 pm. A bound that is a sum of decimals then equals the decimal that a person writes for it, and
/// that exact value passes: 0.0005 + 0.0001 alone is not 0.0006 in binary.
///
/// Implements: PHA-015.
fn to_picometre(length: f64) -> f64 {
    (length * 1e12).round() / 1e12 + 0.0 // −0 becomes 0
}

/// A computed length (m) for a message.
pub(super) fn in_mm(length: f64) -> String {
    format!("{} mm", mm(to_picometre(length)))
}

fn refuse(key: &str, found: String, expected: impl Into<String>) -> Check {
    Err(Refusal::value(key, found, expected))
}

/// Refuses a number of `key` that is not finite or not in `range`, SI, which is there because of `why`.
pub(super) fn within<const POWER: i32>(
    key: &str,
    value: Scaled<POWER>,
    range: impl RangeBounds<f64>,
    why: &str,
) -> Check {
    if value.0.is_finite() && range.contains(&value.0) {
        return Ok(());
    }
    let end = |bound, closed: &str, open: &str| {
        let of = |end| Scaled::<POWER>(to_picometre(end));
        match bound {
            Included(&end) => format!("{closed} {}", of(end)),
            Excluded(&end) => format!("{open} {}", of(end)),
            Unbounded => String::new(),
        }
    };
    if let (Included(one), Included(other)) = (range.start_bound(), range.end_bound())
        && one == other
    {
        let only = Scaled::<POWER>(to_picometre(*one));
        return refuse(key, value.to_string(), format!("{only}{why}"));
    }
    let low = end(range.start_bound(), "at least", "above");
    let high = end(range.end_bound(), " and at most", " and below");
    refuse(key, value.to_string(), low + &high + why)
}

fn check_count(key: &str, count: usize, allowed: RangeInclusive<usize>) -> Check {
    if allowed.contains(&count) {
        return Ok(());
    }
    let expected = format!("{} to {}", allowed.start(), allowed.end());
    refuse(key, format!("{count} of them"), expected)
}

fn check_name(key: &str, name: &str) -> Check {
    if (1..=80).contains(&name.chars().count()) && !name.chars().any(char::is_control) {
        return Ok(());
    }
    let expected = "1 to 80 characters, none of them a control character";
    refuse(key, format!("{name:?}"), expected)
}

fn check_material(table: &str, material: &Material, strain: Strain) -> Check {
    let key = |end: &str| format!("{table}.{end}");
    let modulus = kpa(material.youngs_modulus);
    let moduli = (Excluded(0.0), Unbounded);
    within(&key("youngs_modulus_kpa"), modulus, moduli, "")?;
    let (least, largest) = match strain {
        Strain::Small => (-1.0, LARGEST_POISSON_RATIO),
        Strain::Finite => (0.0, LARGEST_WITH_PRESSURES),
    };
    let ratios = (Excluded(least), Included(largest));
    let ratio = plain(material.poisson_ratio);
    within(&key("poisson_ratio"), ratio, ratios, "")?;
    let c20 = kpa(material.yeoh_c20);
    at_finite_strain(&key("yeoh_c20_kpa"), c20, strain, LARGEST_MODULUS)?;
    let (fibres, angle) = (kpa(material.fibre_modulus), plain(material.fibre_angle_deg));
    within(&key("fibre_modulus_kpa"), fibres, 0.0..=LARGEST_MODULUS, "")?;
    within(&key("fibre_angle_deg"), angle, -360.0..=360.0, "")
}

/// Refuses a number that is not between 0 and `largest`, or not 0 at small strain, where it would change nothing.
///
/// Implements: PHA-032.
fn at_finite_strain<const POWER: i32>(
    key: &str,
    number: Scaled<POWER>,
    strain: Strain,
    largest: f64,
) -> Check {
    if strain == Strain::Small && number.0 != 0.0 {
        let expected = "0, or the phantom at strain = \"finite\"";
        return refuse(key, number.to_string(), expected);
    }
    within(key, number, 0.0..=largest, "")
}

/// All that needs no other part of the phantom.
fn check_shape(table: &str, inclusion: &Inclusion) -> Check {
    let key = |end: &str| format!("{table}.{end}");
    within(&key("centre_x_mm"), mm(inclusion.centre_x), -1.0..=1.0, "")?;
    within(&key("depth_mm"), mm(inclusion.depth), LENGTHS, "")?;
    match &inclusion.shape {
        Shape::Disc { diameter } => within(&key("diameter_mm"), mm(*diameter), LENGTHS, "")?,
        Shape::Ellipse {
            width,
            height,
            angle_deg,
        } => {
            within(&key("width_mm"), mm(*width), CLEARANCE..=1.0, "")?;
            let shortest = to_picometre(width / LARGEST_ASPECT_RATIO).max(CLEARANCE);
            let longest = to_picometre(width * LARGEST_ASPECT_RATIO).min(1.0);
            let why = " (an ellipse is at most 20 times as long as wide)";
            within(&key("height_mm"), mm(*height), shortest..=longest, why)?;
            within(&key("angle_deg"), plain(*angle_deg), -360.0..=360.0, "")?;
        }
        Shape::Polygon { points } => check_polygon(&key("points_mm"), points)?,
    }
    Ok(())
}

fn check_polygon(key: &str, points: &[Point]) -> Check {
    check_count(key, points.len(), 3..=1000)?;
    for (at, &coordinate) in points.as_flattened().iter().enumerate() {
        let key = format!("{key}[{}][{}]", at / 2, at % 2);
        within(&key, mm(coordinate), -1.0..=1.0, "")?;
    }
    let edges = edges(points);
    let count = edges.len();
    for (at, &[corner, next]) in edges.iter().enumerate() {
        let (key, [before, _]) = (format!("{key}[{at}]"), edges[(at + count - 1) % count]);
        let [a, b] = [minus(next, corner), minus(before, corner)];
        let length = to_picometre(libm::hypot(a[0], a[1]));
        let apart = in_mm(length);
        let angle = libm::atan2(cross(a, b).abs(), dot(a, b)).to_degrees();
        // Some corners of exactly 30° come out a bit below.
        let (found, expected) = match (length < CLEARANCE, angle < SHARPEST_CORNER - 1e-9) {
            (true, _) => (format!("a corner {apart} from the next"), "at least 0.1 mm"),
            (_, true) => (format!("a corner of {angle:.3}°"), "at least 30°"),
            _ => continue,
        };
        return refuse(&key, found, expected);
    }
    for i in 0..count {
        // Not the next one, nor the last where it adjoins the first.
        for j in i + 2..count - usize::from(i == 0) {
            let gap = to_picometre(segment_distance(edges[i], edges[j], CLEARANCE));
            if gap < CLEARANCE {
                let (k, l, gap) = (i + 1, (j + 1) % count, in_mm(gap));
                let found = format!("edges from corner {i} to {k} and from {j} to {l} {gap} apart");
                let expected = "at least 0.1 mm apart where they do not adjoin";
                return refuse(key, found, expected);
            }
        }
    }
    Ok(())
}

/// Two outlines that touch, overlap or leave too little between them, and one within another.
fn check_distances(inclusions: &[Inclusion]) -> Check {
    for (at, inclusion) in inclusions.iter().enumerate() {
        for (earlier, other) in inclusions[..at].iter().enumerate() {
            if apart(inclusion.extent(), other.extent()) > 2.0 * CLEARANCE {
                continue;
            }
            let gap = to_picometre(distance(&inclusion.outline(), &other.outline()));
            if gap < CLEARANCE {
                let (key, gap) = (format!("inclusion[{at}]"), in_mm(gap.max(0.0)));
                let found = format!("an outline {gap} from that of inclusion[{earlier}]");
                return refuse(&key, found, "at least 0.1 mm away");
            }
        }
    }
    Ok(())
}

/// The least distance between what has these extents, m; negative where they overlap.
fn apart(a: [f64; 4], b: [f64; 4]) -> f64 {
    let [x, y] = [0, 2].map(|low| (a[low] - b[low + 1]).max(b[low] - a[low + 1]));
    x.max(y)
}

/// A polygon whose outline, moved outwards by a distance, is this one: a circle is one of a single corner, and exact.
fn rounded(outline: &Outline) -> (Vec<[Point; 2]>, f64) {
    match outline {
        Outline::Ellipse(e) if e.radii[0] == e.radii[1] => (edges(&[e.centre]), e.radii[0]),
        _ => (edges(&outline.chords(CHORDS)), 0.0),
    }
}

/// The distance between two outlines, m: 0 or less where they overlap, infinite where it is surely above the clearance.
fn distance(one: &Outline, other: &Outline) -> f64 {
    let [(edges, radius), (others, other_radius)] = [one, other].map(rounded);
    if contains(&edges, others[0][0]) || contains(&others, edges[0][0]) {
        return 0.0;
    }
    let radii = radius + other_radius;
    let mut least = f64::INFINITY;
    for &edge in &edges {
        let gap = |&other| segment_distance(edge, other, radii + 2.0 * CLEARANCE);
        least = others.iter().map(gap).fold(least, f64::min);
    }
    least - radii
}

/// The distance between two segments; infinite if their bounding boxes are more than `enough` apart.
fn segment_distance([a, b]: [Point; 2], [c, d]: [Point; 2], enough: f64) -> f64 {
    if apart(extent(&[a, b]), extent(&[c, d])) > enough {
        return f64::INFINITY;
    }
    // Negative if c and d lie on both sides of the line through a and b.
    let sides = |a, b, c, d| cross(minus(b, a), minus(c, a)) * cross(minus(b, a), minus(d, a));
    if sides(a, b, c, d) < 0.0 && sides(c, d, a, b) < 0.0 {
        return 0.0;
    }
    let ends = [(a, c, d), (b, c, d), (c, a, b), (d, a, b)];
    let distances = ends.map(|(p, a, b)| point_to_segment(p, a, b));
    distances.into_iter().fold(f64::INFINITY, f64::min)
}

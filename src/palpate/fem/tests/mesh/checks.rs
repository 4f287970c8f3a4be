//! What every mesh must be.

use std::collections::{BTreeSet, HashMap, HashSet};

use crate::fem::element::CORNERS;
use crate::fem::mesh::{Mesh, Region};
use crate::fem::size::SizeField;
use crate::phantom::{Ellipse, Outline, Phantom};

/// The polygon along an element's edge, midside nodes included.
fn outline(mesh: &Mesh, nodes: &[u32]) -> Vec<[f64; 2]> {
    let order: &[usize] = &[0, 3, 1, 4, 2, 5];
    let node = |&k: &usize| mesh.nodes[nodes[k] as usize];
    order.iter().map(node).collect()
}

fn area(polygon: &[[f64; 2]]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let doubled = |(a, b): (&[f64; 2], &[f64; 2])| a[0] * b[1] - b[0] * a[1];
    0.5 * polygon.iter().zip(next).map(doubled).sum::<f64>()
}

pub fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The smallest angle at the corners of a triangle, degrees.
fn smallest_angle(corners: &[[f64; 2]]) -> f64 {
    let angle = |k: usize| {
        let [at, a, b] = [0, 1, 2].map(|step| corners[(k + step) % 3]);
        let [p, q] = [a, b].map(|end| [end[0] - at[0], end[1] - at[1]]);
        let (cross, dot) = (p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1]);
        cross.atan2(dot).to_degrees()
    };
    [0, 1, 2].map(angle).into_iter().fold(180.0, f64::min)
}

/// By how much of its radii a point is off an ellipse, or by how many metres off a polygon; negative inside.
fn outside(outline: &Outline, at: [f64; 2]) -> f64 {
    match outline {
        Outline::Ellipse(Ellipse {
            centre,
            radii,
            turn,
        }) => {
            let [x, y] = [at[0] - centre[0], at[1] - centre[1]];
            let along = (x * turn[0] + y * turn[1]) / radii[0];
            let across = (y * turn[0] - x * turn[1]) / radii[1];
            along.hypot(across) - 1.0
        }
        Outline::Polygon(points) => {
            let next = points.iter().cycle().skip(1);
            let edges: Vec<_> = points.iter().zip(next).collect();
            let to_edge = |(a, b): &(&[f64; 2], &[f64; 2])| {
                let along = [b[0] - a[0], b[1] - a[1]];
                let to = [at[0] - a[0], at[1] - a[1]];
                let square = along[0] * along[0] + along[1] * along[1];
                let t = ((to[0] * along[0] + to[1] * along[1]) / square).clamp(0.0, 1.0);
                distance(to, along.map(|x| t * x))
            };
            let least = edges.iter().map(to_edge).fold(f64::INFINITY, f64::min);
            // How often the outline goes round the point.
            let turn = |(a, b): &(&[f64; 2], &[f64; 2])| {
                let [p, q] = [a, b].map(|end| [end[0] - at[0], end[1] - at[1]]);
                (p[0] * q[1] - p[1] * q[0]).atan2(p[0] * q[0] + p[1] * q[1])
            };
            let inside = edges.iter().map(turn).sum::<f64>() > std::f64::consts::PI;
            if inside { -least } else { least }
        }
    }
}

/// The edges of all elements with the middle and the region that each element sees there.
pub fn edges(mesh: &Mesh) -> HashMap<[u32; 2], Vec<(Option<u32>, Region)>> {
    let mut edges: HashMap<[u32; 2], Vec<_>> = HashMap::new();
    for (nodes, &region) in mesh.elements().zip(&mesh.regions) {
        for k in 0..CORNERS {
            let (a, b) = (nodes[k], nodes[(k + 1) % CORNERS]);
            let seen = edges.entry([a.min(b), a.max(b)]).or_default();
            seen.push((nodes.get(CORNERS + k).copied(), region));
        }
    }
    edges
}

pub fn check_edges(phantom: &Phantom, mesh: &Mesh) {
    let (wall, floor) = (0.5 * phantom.well().width, -phantom.height());
    let borders = |[x, y]: [f64; 2]| [x == -wall, x == wall, y == 0.0, (y - floor).abs() < 1e-15];
    for (ends, seen) in edges(mesh) {
        let is_one = seen.windows(2).all(|pair| pair[0].0 == pair[1].0);
        assert!(is_one, "{ends:?}: {seen:?}");
        let [a, b] = ends.map(|node| borders(mesh.nodes[node as usize]));
        let on_border = (0..4).any(|k| a[k] && b[k]);
        let expected = if on_border { 1 } else { 2 };
        assert_eq!(seen.len(), expected, "elements at {ends:?}");
    }
    let used: HashSet<u32> = mesh.connectivity.iter().copied().collect();
    assert_eq!(used.len(), mesh.nodes.len(), "a node without element");
    let places: HashSet<[u64; 2]> = (mesh.nodes.iter())
        .map(|at| at.map(|x| (x + 0.0).to_bits()))
        .collect();
    assert_eq!(places.len(), mesh.nodes.len(), "two nodes at one place");
}

/// Every node between an inclusion and its layer is on the outline, and other edges are straight.
pub fn check_outlines(phantom: &Phantom, mesh: &Mesh) {
    let outlines: Vec<Outline> = phantom.inclusions().iter().map(|i| i.outline()).collect();
    let mut on_outline = vec![0; outlines.len()];
    for (ends, seen) in edges(mesh) {
        let [a, b] = ends.map(|node| mesh.nodes[node as usize]);
        let middle = seen[0].0.map(|node| mesh.nodes[node as usize]);
        let between: BTreeSet<Region> = seen.iter().map(|of| of.1).collect();
        let inclusion = between.iter().find_map(|region| match *region {
            Region::Inclusion(k) if between.len() == 2 => Some(k),
            _ => None,
        });
        match (inclusion.map(|k| (k, &outlines[k])), middle) {
            (Some((k, line)), middle) => {
                on_outline[k] += 1;
                for at in [a, b].into_iter().chain(middle) {
                    // Roundings of the position over the smallest radius, 0.25 mm.
                    let off = outside(line, at).abs();
                    assert!(off < 1e-13, "{at:?} is off the outline {k} by {off:e}");
                }
            }
            (None, Some(middle)) => {
                let straight = [0, 1].map(|k| 0.5 * (a[k] + b[k]));
                assert!(distance(middle, straight) < 1e-17, "{a:?} to {b:?} is bent");
            }
            (None, None) => {}
        }
    }
    // A triangle's outline has three edges at least, a circle's pieces turn by less than a right angle.
    assert!(on_outline.iter().all(|&count| count >= 3), "{on_outline:?}");
}

/// Regions lie where the phantom has them, and no element reaches across a line.
pub fn check_regions(phantom: &Phantom, mesh: &Mesh) {
    let levels = phantom.levels();
    let outlines: Vec<Outline> = phantom.inclusions().iter().map(|i| i.outline()).collect();
    let mut areas = vec![0.0; phantom.layers().len()];
    for (nodes, &region) in mesh.elements().zip(&mesh.regions) {
        let polygon = outline(mesh, nodes);
        assert!(area(&polygon) > 0.0, "{nodes:?} is turned");
        let (top, bottom) = match region {
            Region::Layer(k) => (levels[k], levels[k + 1]),
            Region::Inclusion(_) => (0.0, levels[levels.len() - 1]),
        };
        let centre =
            [0, 1].map(|k| polygon.iter().map(|p| p[k]).sum::<f64>() / polygon.len() as f64);
        for at in &polygon {
            let holds = at[1] <= top + 1e-15 && at[1] >= bottom - 1e-15;
            assert!(holds, "{at:?} in {region:?}");
        }
        for (k, line) in outlines.iter().enumerate() {
            let inside = region == Region::Inclusion(k);
            assert_eq!(
                outside(line, centre) < 0.0,
                inside,
                "{centre:?} in {region:?}"
            );
            let side = if inside { 1.0 } else { -1.0 };
            for &at in &polygon {
                let off = side * outside(line, at);
                assert!(off < 1e-13, "{at:?} in {region:?}: {off:e} beyond {k}");
            }
        }
        let layer = levels[1..].partition_point(|&level| level > centre[1]);
        areas[layer] += area(&polygon);
    }
    for (k, area) in areas.iter().enumerate() {
        let expected = phantom.well().width * phantom.layers()[k].thickness;
        // Sums of some 10⁴ numbers.
        assert!((area / expected - 1.0).abs() < 1e-12, "layer {k}: {area}");
    }
}

/// Nodes, elements, regions, supports and surface have their mirror images.
pub fn check_mirror(phantom: &Phantom, mesh: &Mesh) {
    let key = |[x, y]: [f64; 2]| [x + 0.0, y].map(f64::to_bits);
    let at: HashMap<[u64; 2], u32> = (0u32..)
        .zip(&mesh.nodes)
        .map(|(k, &at)| (key(at), k))
        .collect();
    let image: Vec<u32> = (mesh.nodes.iter())
        .map(|&[x, y]| {
            *at.get(&key([-x, y]))
                .unwrap_or_else(|| panic!("no image of {x}, {y}"))
        })
        .collect();
    let images = phantom.mirror_images();
    let named = |nodes: Vec<u32>, region| {
        let mut nodes = nodes;
        nodes.sort_unstable();
        (nodes, region)
    };
    let all: BTreeSet<_> = (mesh.elements().zip(&mesh.regions))
        .map(|(nodes, &region)| named(nodes.to_vec(), region))
        .collect();
    for (nodes, &region) in mesh.elements().zip(&mesh.regions) {
        let nodes = nodes.iter().map(|&k| image[k as usize]).collect();
        let region = match region {
            Region::Inclusion(k) => Region::Inclusion(images[k]),
            layer => layer,
        };
        let holds = all.contains(&named(nodes, region));
        assert!(holds, "an element of {region:?} without image");
    }
    for (node, &image) in image.iter().enumerate() {
        assert_eq!(mesh.held[node], mesh.held[image as usize]);
    }
    for (&left, &right) in mesh.surface.iter().zip(mesh.surface.iter().rev()) {
        assert_eq!(image[left] as usize, right);
    }
}

pub fn check_surface(phantom: &Phantom, mesh: &Mesh) {
    let wall = 0.5 * phantom.well().width;
    let x = |k: usize| mesh.nodes[mesh.surface[k]][0];
    let last = mesh.surface.len() - 1;
    assert_eq!([x(0), x(last)], [-wall, wall]);
    assert!((0..last).all(|k| x(k) < x(k + 1)));
    let below = mesh.nodes.iter().filter(|at| at[1] < 0.0).count();
    assert_eq!(below + mesh.surface.len(), mesh.nodes.len());
    assert!(mesh.surface.iter().all(|&node| mesh.nodes[node][1] == 0.0));
    // Corners and middles in turn, as contact takes them.
    let middles: HashSet<u32> = mesh
        .elements()
        .flat_map(|nodes| &nodes[3..])
        .copied()
        .collect();
    let is_middle = |&node: &usize| middles.contains(&(node as u32));
    let kinds = mesh.surface.iter().map(is_middle);
    assert!(kinds.eq((0..=last).map(|k| k % 2 == 1)));
}

/// The smallest angle of any triangle, degrees.
pub fn check_angles(mesh: &Mesh) -> f64 {
    let angles = mesh
        .elements()
        .map(|nodes| smallest_angle(&mesh.positions(&nodes[..3])));
    angles.fold(180.0, f64::min)
}

/// The shortest edge, the lengths below which a tenth, half and nine tenths of the edges are, and the longest, over the wanted size.
pub fn lengths(mesh: &Mesh, field: &SizeField) -> [f64; 5] {
    let over_size = |ends: &[u32; 2]| {
        let [a, b] = ends.map(|node| mesh.nodes[node as usize]);
        distance(a, b) / field.at([0, 1].map(|k| 0.5 * (a[k] + b[k])).into())
    };
    let mut lengths: Vec<f64> = edges(mesh).keys().map(over_size).collect();
    lengths.sort_by(f64::total_cmp);
    let last = (lengths.len() - 1) as f64;
    [0.0, 0.1, 0.5, 0.9, 1.0].map(|share| lengths[(share * last) as usize])
}

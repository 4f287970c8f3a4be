use std::collections::{BTreeSet, HashMap, HashSet};

use crate::fem::MESH_SIZE;
use crate::fem::element::CORNERS;
use crate::fem::mesh::{Mesh, Region};
use crate::fem::size::SizeField;
use crate::fem::triangulate::Triangulation;
use crate::phantom::{Ellipse, Outline, Phantom, Support};
use crate::stats::tests::assert_near;

use super::{builtin, disc, ellipse, hard, off_centre, polygon, with, zoo};

/// Mesh sizes, m: those of a default map and its certificate, and the coarsest and finest in common use.
const SIZES: [f64; 5] = [0.25e-3, 0.5e-3, 2e-3 / 3.0, 1e-3, 2e-3];

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

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
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

/// The edges of all elements with the middles that each element sees.
fn edges(mesh: &Mesh) -> HashMap<[u32; 2], Vec<Option<u32>>> {
    let mut edges: HashMap<[u32; 2], Vec<Option<u32>>> = HashMap::new();
    let corners = CORNERS;
    for nodes in mesh.elements() {
        for k in 0..corners {
            let (a, b) = (nodes[k], nodes[(k + 1) % corners]);
            let seen = edges.entry([a.min(b), a.max(b)]).or_default();
            seen.push(nodes.get(corners + k).copied());
        }
    }
    edges
}

fn check_edges(phantom: &Phantom, mesh: &Mesh) {
    let (wall, floor) = (0.5 * phantom.well.width, -phantom.height());
    let borders = |[x, y]: [f64; 2]| [x == -wall, x == wall, y == 0.0, (y - floor).abs() < 1e-15];
    for (ends, middles) in edges(mesh) {
        assert!(
            middles.windows(2).all(|pair| pair[0] == pair[1]),
            "{ends:?}: {middles:?}"
        );
        let [a, b] = ends.map(|node| borders(mesh.nodes[node as usize]));
        let on_border = (0..4).any(|k| a[k] && b[k]);
        let expected = if on_border { 1 } else { 2 };
        assert_eq!(middles.len(), expected, "elements at {ends:?}");
    }
    let used: HashSet<u32> = mesh.connectivity.iter().copied().collect();
    assert_eq!(used.len(), mesh.nodes.len(), "a node without element");
    let places: HashSet<[u64; 2]> = (mesh.nodes.iter())
        .map(|at| at.map(|x| (x + 0.0).to_bits()))
        .collect();
    assert_eq!(places.len(), mesh.nodes.len(), "two nodes at one place");
}

/// Every node between an inclusion and its layer is on the outline, and other edges are straight.
fn check_outlines(phantom: &Phantom, mesh: &Mesh) {
    let outlines: Vec<Outline> = phantom.inclusions.iter().map(|i| i.outline()).collect();
    let mut regions: HashMap<[u32; 2], BTreeSet<Region>> = HashMap::new();
    let corners = CORNERS;
    for (nodes, &region) in mesh.elements().zip(&mesh.regions) {
        for k in 0..corners {
            let (a, b) = (nodes[k], nodes[(k + 1) % corners]);
            regions
                .entry([a.min(b), a.max(b)])
                .or_default()
                .insert(region);
        }
    }
    let mut on_outline = vec![0; outlines.len()];
    for (ends, middles) in edges(mesh) {
        let [a, b] = ends.map(|node| mesh.nodes[node as usize]);
        let middle = middles[0].map(|node| mesh.nodes[node as usize]);
        let between = &regions[&ends];
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
fn check_regions(phantom: &Phantom, mesh: &Mesh) {
    let levels = phantom.levels();
    let outlines: Vec<Outline> = phantom.inclusions.iter().map(|i| i.outline()).collect();
    let mut areas = vec![0.0; phantom.layers.len()];
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
            assert!(
                at[1] <= top + 1e-15 && at[1] >= bottom - 1e-15,
                "{at:?} in {region:?}"
            );
        }
        for (k, line) in outlines.iter().enumerate() {
            let inside = region == Region::Inclusion(k);
            assert_eq!(
                outside(line, centre) < 0.0,
                inside,
                "{centre:?} in {region:?}"
            );
            for &at in &polygon {
                let off = if inside {
                    outside(line, at)
                } else {
                    -outside(line, at)
                };
                assert!(
                    off < 1e-13,
                    "{at:?} in {region:?} is {off:e} beyond the outline {k}"
                );
            }
        }
        let layer = levels[1..].partition_point(|&level| level > centre[1]);
        areas[layer] += area(&polygon);
    }
    for (k, area) in areas.iter().enumerate() {
        let expected = phantom.well.width * phantom.layers[k].thickness;
        // Sums of some 10⁴ numbers.
        assert!((area / expected - 1.0).abs() < 1e-12, "layer {k}: {area}");
    }
}

/// Nodes, elements, regions, supports and surface have their mirror images.
fn check_mirror(phantom: &Phantom, mesh: &Mesh) {
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
        assert!(
            all.contains(&named(nodes, region)),
            "an element of {region:?} without image"
        );
    }
    for (node, &image) in image.iter().enumerate() {
        assert_eq!(mesh.held[node], mesh.held[image as usize]);
    }
    for (&left, &right) in mesh.surface.iter().zip(mesh.surface.iter().rev()) {
        assert_eq!(image[left] as usize, right);
    }
}

fn check_surface(phantom: &Phantom, mesh: &Mesh) {
    let wall = 0.5 * phantom.well.width;
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
fn check_angles(mesh: &Mesh) -> f64 {
    let angles = mesh
        .elements()
        .map(|nodes| smallest_angle(&mesh.positions(&nodes[..3])));
    angles.fold(180.0, f64::min)
}

/// A tenth, half and nine tenths of the edges are shorter than these multiples of the wanted size.
fn lengths(mesh: &Mesh, field: &SizeField) -> [f64; 3] {
    let over_size = |ends: &[u32; 2]| {
        let [a, b] = ends.map(|node| mesh.nodes[node as usize]);
        distance(a, b) / field.at([0, 1].map(|k| 0.5 * (a[k] + b[k])).into())
    };
    let mut lengths: Vec<f64> = edges(mesh).keys().map(over_size).collect();
    lengths.sort_by(f64::total_cmp);
    [0.1, 0.5, 0.9].map(|share| lengths[(share * lengths.len() as f64) as usize])
}

// Verifies: FEM-014, FEM-002, FEM-031, FEM-017, FEM-036.
#[test]
fn phantoms_of_all_kinds_have_sound_meshes() {
    let mut wrong = Vec::new();
    for (number, (what, phantom)) in zoo().into_iter().enumerate() {
        phantom
            .validate()
            .unwrap_or_else(|error| panic!("{what}: {error}"));
        // The finest takes as long as all others.
        for &size in &SIZES[usize::from(number % 5 > 0)..] {
            let what = format!("{what}, {} mm", size * 1e3);
            println!("{what}");
            let mesh = match Mesh::new(&phantom, size) {
                Ok(mesh) => mesh,
                Err(error) => {
                    wrong.push(format!("{what}: {error}"));
                    continue;
                }
            };
            check_edges(&phantom, &mesh);
            check_outlines(&phantom, &mesh);
            check_regions(&phantom, &mesh);
            check_surface(&phantom, &mesh);
            assert_eq!(mesh.symmetric, phantom.is_symmetric());
            if mesh.symmetric {
                check_mirror(&phantom, &mesh);
            }
            let angle = check_angles(&mesh);
            if angle < 25.0 {
                wrong.push(format!("{what}: an angle of {angle:.1}°"));
            }
            // Triangles are refined above 1.35 times the wanted size, which makes edges of twice the radius of
            // their circle, 1.56, and new points keep 0.6 from others; pieces of lines are rounded to whole numbers of them.
            let field = SizeField::new(&phantom, size);
            let [short, middle, long] = lengths(&mesh, &field);
            if short < 0.6 || !(0.9..1.1).contains(&middle) || long > 1.56 {
                wrong.push(format!(
                    "{what}: edges of {short:.2}, {middle:.2}, {long:.2} sizes"
                ));
            }
            let expected = field.expected_nodes() / mesh.nodes.len() as f64;
            if (expected - 1.0).abs() > 0.25 {
                wrong.push(format!("{what}: {expected:.3} of the nodes expected"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

// Verifies: FEM-014, FEM-002.
#[test]
fn two_calls_make_the_same_mesh() {
    for phantom in [builtin("2.6"), off_centre(2.6, 3.0)] {
        let [a, b] = [(); 2].map(|()| Mesh::new(&phantom, MESH_SIZE).unwrap());
        let bits = |mesh: &Mesh| -> Vec<u64> {
            mesh.nodes.iter().flatten().map(|x| x.to_bits()).collect()
        };
        assert_eq!(bits(&a), bits(&b));
        assert_eq!((a.connectivity, a.regions), (b.connectivity, b.regions));
    }
}

// Verifies: FEM-031.
#[test]
fn sizes_are_those_of_the_table() {
    let corners = [[-2.0, 0.0], [2.0, 0.0], [2.0, 4.0], [-2.0, 4.0]];
    let shapes = with(vec![
        hard(-7.0, 5.0, disc(5.0)),
        hard(6.0, 9.0, polygon(&corners)),
        hard(5.0, 3.0, ellipse(3.0, 1.0, 0.0)),
    ]);
    let mut other = builtin("none");
    other.layers[0].thickness = 0.2e-3;
    let mut sliding = other.clone();
    sliding.well.walls = Support::Sliding;
    let near = with([-2.6, 2.6].map(|x| hard(x, 5.0, disc(5.0))).into());
    let size = |phantom: &Phantom, scale: f64, at: [f64; 2]| {
        let field = SizeField::new(phantom, scale * 0.5e-3);
        1e3 * field.at(at.map(|x| x * 1e-3).into())
    };
    // Phantom, H, place and size, mm.
    for (phantom, scale, at, expected) in [
        // The surface, and below it; the largest.
        (&shapes, 1.0, [0.0, 0.0], 0.20),
        (&shapes, 0.5, [0.0, 0.0], 0.10),
        (&shapes, 2.0, [0.0, 0.0], 0.40),
        (&shapes, 1.0, [0.0, -0.3], 0.20 + 0.16 * 0.3),
        (&other, 1.0, [0.0, -14.0], 1.5),
        (&other, 2.0, [0.0, -14.0], 3.0),
        // The strip at a wall, and beside it.
        (&shapes, 1.0, [13.5, 0.0], 0.10),
        (&shapes, 1.0, [-12.8, 0.0], 0.10 + 0.16 * 0.2),
        // A disc's edge from inside and outside, in any direction.
        (&shapes, 1.0, [-7.0, -10.0], 0.20),
        (&shapes, 1.0, [-7.0, -9.5], 0.20 + 0.40 * 0.5),
        (&shapes, 0.5, [-7.0, -10.3], 0.5 * (0.20 + 0.40 * 0.3)),
        // Corners of walls, polygons and ellipses: the radius at this end is 0.5²/1.5.
        (&shapes, 1.0, [17.0, -0.5], 0.015),
        (&shapes, 1.0, [-17.0, -0.6], 0.015 + 0.22 * 0.1),
        (&shapes, 1.0, [8.0, -13.0], 0.05),
        (&shapes, 1.0, [8.0, -13.1], 0.05 + 0.30 * 0.1),
        (&shapes, 1.0, [6.5, -3.5], 0.5 * 0.25 / 1.5),
        (&shapes, 2.0, [6.5, -3.5], 0.5 * 0.25 / 1.5),
        (&shapes, 0.5, [6.5, -3.5], 0.25 * 0.25 / 1.5),
        (&sliding, 1.0, [17.0, 0.0], 0.10),
        // A layer of 0.2 mm, and below it.
        (&other, 1.0, [0.0, -0.1], 0.10),
        (&other, 4.0, [0.0, -0.1], 0.20),
        (&other, 1.0, [0.0, -0.3], 0.10 + 0.16 * 0.1),
        // 0.2 mm between two discs.
        (&near, 1.0, [0.0, -7.5], 0.10),
        (&near, 2.0, [0.0, -7.5], 0.10),
        (&near, 0.5, [0.0, -7.5], 0.05),
    ] {
        let found = size(phantom, scale, at);
        assert_near(found, expected, 1e-9);
    }
}

// Verifies: FEM-002, FEM-031.
#[test]
fn a_thin_layer_has_two_rows() {
    let mut thin = builtin("6.6");
    thin.layers[0].thickness = 1.5e-4;
    for phantom in [builtin("2.6"), thin] {
        let mesh = Mesh::new(&phantom, MESH_SIZE).unwrap();
        let bottom = phantom.levels()[1];
        let across = edges(&mesh).into_keys().filter(|ends| {
            let [a, b] = ends.map(|node| mesh.nodes[node as usize][1]);
            a.max(b) == 0.0 && a.min(b) == bottom
        });
        assert_eq!(across.count(), 0, "edges from the surface through the skin");
    }
}

// Verifies: FEM-004.
#[test]
fn walls_and_floor_hold_their_nodes_and_nothing_else() {
    use Support::{Fixed, Free, Sliding};
    let all = [Fixed, Sliding, Free];
    for (walls, floor) in all.iter().flat_map(|&w| all.map(|f| (w, f))) {
        let mut phantom = builtin("6.6");
        (phantom.well.walls, phantom.well.floor) = (walls, floor);
        if phantom.validate().is_err() {
            continue;
        }
        let (wall, bottom) = (phantom.well.width / 2.0, -phantom.height());
        let mesh = Mesh::new(&phantom, 1e-3).unwrap();
        let mut held = [0; 2];
        for (&[x, y], &found) in mesh.nodes.iter().zip(&mesh.held) {
            let by = |support, across: usize, there: bool| {
                [0, 1].map(|k| there && (support == Fixed || support == Sliding && k == across))
            };
            let by_wall = by(walls, 0, (x.abs() - wall).abs() < 1e-12);
            let by_floor = by(floor, 1, (y - bottom).abs() < 1e-12);
            let expected = [0, 1].map(|k| by_wall[k] || by_floor[k]);
            assert_eq!(found, expected, "{walls:?}, {floor:?}: {x}, {y}");
            held = [0, 1].map(|k| held[k] + usize::from(found[k]));
        }
        assert!(held.iter().sum::<usize>() > 30, "{held:?}");
    }
}

// Verifies: FEM-017, FEM-036.
#[test]
fn sizes_without_a_mesh_are_refused() {
    let phantom = builtin("none");
    for size in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let error = Mesh::new(&phantom, size).unwrap_err();
        let said = error.to_string();
        assert!(
            said.ends_with("mm, expected a finite number above 0"),
            "{said}"
        );
    }
    // Only what counts nodes before it makes them comes back from the smaller ones.
    for (size, least) in [(0.06e-3, 5e5), (1e-6, 1e9), (1e-12, 1e20)] {
        let said = Mesh::new(&phantom, size).unwrap_err().to_string();
        let (_, about) = said.split_once(" makes about ").expect("a forecast");
        let (nodes, _) = about.split_once(" nodes").expect("a number");
        assert!(nodes.parse::<f64>().unwrap() > least, "{said}");
    }
}

// Verifies: FEM-017.
#[test]
fn a_phantom_that_no_sound_triangle_follows_is_refused_with_the_place() {
    // The axis halves a corner of 40°.
    let spike = polygon(&[[0.0, 0.0], [1.5, -4.1], [-1.5, -4.1]]);
    let phantom = with(vec![hard(0.0, 3.0, spike)]);
    phantom.validate().unwrap();
    let size = SizeField::new(&phantom, MESH_SIZE);
    let error = Triangulation::new(&phantom, &size, true).err().unwrap();
    // Within half a millimetre of the corner at (0, −3) mm.
    let said = error.to_string();
    let number = |before: &str| -> f64 {
        let (_, after) = said.split_once(before).expect("a number");
        let end = after.find([' ', '°']).expect("a unit");
        after[..end].parse().expect("a number")
    };
    let at = [number("near x = "), number(", y = ")];
    assert!(distance(at, [0.0, -3.0]) < 0.5, "{said}");
    assert!(
        number("an angle of ") < 25.0 && said.contains("at least 25°"),
        "{said}"
    );
    // Meshed as a whole, it has none so sharp.
    let mesh = Mesh::new(&phantom, MESH_SIZE).unwrap();
    assert!(phantom.is_symmetric() && !mesh.symmetric);
    assert!(check_angles(&mesh) >= 25.0);
}

// Verifies: FEM-013.
#[test]
fn strains_near_sharp_corners_do_not_count() {
    let square = polygon(&[[-2.0, 0.0], [2.0, 0.0], [2.0, 4.0], [-2.0, 4.0]]);
    let mut phantom = with(vec![hard(0.0, 3.0, square), hard(9.0, 4.0, disc(4.0))]);
    let width = 1e3 * phantom.well.width;
    let skin = 1e3 * phantom.layers[0].thickness;
    // A point so far to the right of a place, mm.
    let sharp = |phantom: &Phantom, [x, y]: [f64; 2], distance: f64| {
        let at = [x + distance, y].map(|x| x * 1e-3);
        SizeField::new(phantom, MESH_SIZE).singular(at.into())
    };
    let walls = [[-0.5 * width, 0.0], [-0.5 * width, -skin]];
    let Outline::Polygon(square) = phantom.inclusions[0].outline() else {
        panic!("a polygon")
    };
    let square = square.iter().map(|corner| corner.map(|x| x * 1e3));
    for corner in walls.into_iter().chain(square) {
        assert!(sharp(&phantom, corner, 0.99), "{corner:?}");
        assert!(!sharp(&phantom, corner, 1.01), "{corner:?}");
    }
    // Neither the end of a disc's axis nor the middle of a side is sharp, nor a wall that does not hold.
    for smooth in [[9.0, -4.0], [0.0, -3.0]] {
        assert!(!sharp(&phantom, smooth, 0.0), "{smooth:?}");
    }
    phantom.well.walls = Support::Sliding;
    assert!(!sharp(&phantom, walls[0], 0.0));
}

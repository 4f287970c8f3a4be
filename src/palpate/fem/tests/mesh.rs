mod checks;

use checks::*;

use crate::fem::MESH_SIZE;
use crate::fem::mesh::Mesh;
use crate::fem::size::SizeField;
use crate::fem::triangulate::Triangulation;
use crate::phantom::{Geometry, Outline, Phantom, Support};
use palpate_asserts::{assert_cases, row};

use super::supports::{SUPPORTS, held_by};
use super::{builtin, disc, ellipse, hard, off_centre, polygon, with, zoo};

/// Mesh sizes, m: those of a default map and its certificate, and the coarsest and finest in common use.
const SIZES: [f64; 5] = [0.25e-3, 0.5e-3, 2e-3 / 3.0, 1e-3, 2e-3];

// Verifies: FEM-014, FEM-002, FEM-031, FEM-017, FEM-036.
#[test]
#[ignore = "slow, and rarely breaks"]
fn phantoms_of_all_kinds_have_sound_meshes() {
    let mut wrong = Vec::new();
    for (number, (what, phantom)) in zoo().into_iter().enumerate() {
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
            let [shortest, short, middle, long, longest] = lengths(&mesh, &field);
            if shortest < 0.1 || longest > 2.6 {
                wrong.push(format!(
                    "{what}: edges of {shortest:.3} and {longest:.3} sizes"
                ));
            }
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
    let other = builtin("none").changed(|parts| parts.layers[0].thickness = 0.2e-3);
    let other = other.unwrap();
    let sliding = held_by(other.clone(), (Support::Sliding, Support::Fixed));
    let near = with([-2.6, 2.6].map(|x| hard(x, 5.0, disc(5.0))).into());
    let size = |phantom: &Phantom, scale: f64, at: [f64; 2]| {
        let field = SizeField::new(phantom, scale * 0.5e-3);
        1e3 * field.at(at.map(|x| x * 1e-3).into())
    };
    assert_cases("tables/fem.txt", "sizes", |case| {
        let (name, numbers) = case.split_once(' ').unwrap();
        let phantom = match name {
            "shapes" => &shapes,
            "other" => &other,
            "sliding" => &sliding,
            _ => &near,
        };
        let [scale, x, y] = row(numbers)[..] else {
            panic!("{case}")
        };
        format!("{:.9}", size(phantom, scale, [x, y]))
    });
}

// Verifies: FEM-002, FEM-031.
#[test]
fn a_thin_layer_has_two_rows() {
    let thin = builtin("6.6").changed(|parts| parts.layers[0].thickness = 1.5e-4);
    for phantom in [builtin("2.6"), thin.unwrap()] {
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
    use Support::{Fixed, Sliding};
    for (walls, floor) in SUPPORTS {
        let phantom = held_by(builtin("6.6"), (walls, floor));
        let (wall, bottom) = (phantom.well().width / 2.0, -phantom.height());
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
        let holds = said.ends_with("mm, but must be a finite number above 0");
        assert!(holds, "{said}");
    }
    // Only what counts nodes before it makes them comes back from the smaller ones.
    for (size, least) in [(0.06e-3, 5e5), (1e-6, 1e9), (1e-12, 1e20)] {
        let said = Mesh::new(&phantom, size).unwrap_err().to_string();
        let (_, about) = said.split_once(" makes about ").expect("a forecast");
        let (nodes, _) = about.split_once(" nodes").expect("a number");
        assert!(nodes.parse::<f64>().unwrap() > least, "{said}");
        assert!(said.ends_with("; a larger size makes fewer"), "{said}");
    }
    let thin = phantom.changed(|parts| parts.layers[0].thickness = 1e-6);
    let said = Mesh::new(&thin.unwrap(), 30e-3).unwrap_err().to_string();
    let remedy = "; no size makes few enough: give a layer thicker than 0.001 mm, or wider gaps";
    assert!(said.ends_with(remedy), "{said}");
}

// Verifies: FEM-037.
#[test]
fn a_surface_of_too_many_nodes_is_refused() {
    // Elements of 0.16 mm at the surface: 3125 of them, with two nodes each.
    let wide = builtin("none")
        .changed(|parts| parts.well.width = 0.5)
        .unwrap();
    let said = Mesh::new(&wide, 0.4e-3).unwrap_err().to_string();
    let (_, makes) = said.split_once("mesh size 0.4 mm makes ").expect(&said);
    let (nodes, rest) = makes.split_once(' ').unwrap();
    assert!(
        (5_001.0..10_000.0).contains(&nodes.parse::<f64>().unwrap()),
        "{said}"
    );
    assert_eq!(
        rest,
        "nodes on the surface, allowed: at most 5000; a larger size makes fewer"
    );
    let mesh = Mesh::new(&wide, 1e-3).unwrap();
    assert!(mesh.surface.len() > 1_000);
}

// Verifies: FEM-017.
#[test]
fn a_phantom_that_no_sound_triangle_follows_is_refused_with_the_place() {
    // The axis halves a corner of 40°.
    let spike = polygon(&[[0.0, 0.0], [1.5, -4.1], [-1.5, -4.1]]);
    let phantom = with(vec![hard(0.0, 3.0, spike)]);
    let size = SizeField::new(&phantom, MESH_SIZE);
    let error = Triangulation::new(&phantom, &size, true).err().unwrap();
    // Within half a millimetre of the corner at (0, −3) mm.
    assert_names_corner(&error.to_string(), [0.0, -3.0]);
    // Meshed as a whole, it has none so sharp.
    let mesh = Mesh::new(&phantom, MESH_SIZE).unwrap();
    assert!(phantom.is_symmetric() && !mesh.symmetric);
    assert!(check_angles(&mesh) >= 25.0);
}

/// That a refusal names a triangle which is too flat, within half a millimetre of a corner, mm.
fn assert_names_corner(said: &str, corner: [f64; 2]) {
    let number = |before: &str| -> f64 {
        let (_, after) = said.split_once(before).expect("a number");
        let end = after.find([' ', '°']).expect("a unit");
        after[..end].parse().expect("a number")
    };
    let at = [number("near x = "), number(", y = ")];
    assert!(distance(at, corner) < 0.5, "{said}");
    let holds = number("an angle of ") < 25.0 && said.contains("under 25°");
    assert!(holds, "{said}");
}

// Verifies: FEM-017, FEM-081.
#[test]
fn no_element_lies_across_the_axis_of_an_axisymmetric_phantom() {
    // A cone whose tip has 41°, of which the axis leaves 20.6°.
    let cone = |radius: f64| {
        let points = [[-radius, 0.0], [0.0, -8.0], [radius, 0.0]];
        with(vec![hard(0.0, 3.0, polygon(&points))])
    };
    let turned = |plane: Phantom| {
        let turned = plane.changed(|parts| {
            parts.geometry = Geometry::Axisymmetric;
            parts.probe.length = 2.0 * parts.probe.radius;
        });
        turned.unwrap()
    };
    let [sharp, blunt] = [3.0, 4.0].map(|radius| turned(cone(radius)));
    for size in [0.5e-3, 1e-3, 2e-3] {
        let said = Mesh::new(&sharp, size).unwrap_err().to_string();
        assert_names_corner(&said, [0.0, -11.0]);
        let remedy =
            "; give a polygon's corner on the axis more than 50°, or try another mesh size";
        assert!(said.ends_with(remedy), "{said}");
        // One of 53°.
        let mesh = Mesh::new(&blunt, size).unwrap();
        check_mirror(&blunt, &mesh);
    }
    assert!(!Mesh::new(&cone(3.0), 1e-3).unwrap().symmetric);
}

// Verifies: FEM-013.
#[test]
fn strains_near_sharp_corners_do_not_count() {
    let square = polygon(&[[-2.0, 0.0], [2.0, 0.0], [2.0, 4.0], [-2.0, 4.0]]);
    let phantom = with(vec![hard(0.0, 3.0, square), hard(9.0, 4.0, disc(4.0))]);
    let width = 1e3 * phantom.well().width;
    let skin = 1e3 * phantom.layers()[0].thickness;
    // A point so far to the right of a place, mm.
    let sharp = |phantom: &Phantom, [x, y]: [f64; 2], distance: f64| {
        let at = [x + distance, y].map(|x| x * 1e-3);
        SizeField::new(phantom, MESH_SIZE).singular(at.into())
    };
    let walls = [[-0.5 * width, 0.0], [-0.5 * width, -skin]];
    let Outline::Polygon(square) = phantom.inclusions()[0].outline() else {
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
    let sliding = held_by(phantom, (Support::Sliding, Support::Fixed));
    assert!(!sharp(&sliding, walls[0], 0.0));
}

// Verifies: FEM-013.
#[test]
fn no_corner_of_a_polygon_for_a_disc_is_sharp() {
    let corners = |count: usize, dent: f64| {
        let angle = |k| std::f64::consts::TAU * k as f64 / count as f64;
        let radius = |k| if k == 0 { dent } else { 3.2 };
        let at = |k| {
            [
                radius(k) * f64::sin(angle(k)),
                -radius(k) * f64::cos(angle(k)),
            ]
        };
        polygon(&(0..count).map(at).collect::<Vec<_>>())
    };
    // How many of the corners count; the polygon's highest point is 3 mm deep.
    let sharp = |shape| {
        let phantom = with(vec![hard(0.0, 3.0, shape)]);
        let Outline::Polygon(points) = phantom.inclusions()[0].outline() else {
            panic!("a polygon")
        };
        let size = SizeField::new(&phantom, MESH_SIZE);
        let is_sharp = |point: &&[f64; 2]| size.singular((**point).into());
        points.iter().filter(is_sharp).count()
    };
    for (count, expected) in [(90, 0), (14, 0), (11, 11)] {
        assert_eq!(sharp(corners(count, 3.2)), expected, "{count}");
    }
    // A dent of 1.5 mm in edges of 0.5 mm: the corner in it turns the other way, those beside it are sharp, and the next are near them.
    assert_eq!(sharp(corners(40, 1.7)), 5);
}

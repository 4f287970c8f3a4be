use std::collections::HashMap;

use crate::fem::mesh::{Mesh, Region};
use crate::fem::{Element, FemError, MeshOptions};
use crate::phantom::{BUILTIN_NAMES, Inclusion, Phantom};

use super::builtin;

const ELEMENTS: [Element; 2] = [Element::T6, Element::Q4Full];

fn area(corners: &[[f64; 2]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    0.5 * corners
        .iter()
        .zip(next)
        .map(|(a, b)| a[0] * b[1] - b[0] * a[1])
        .sum::<f64>()
}

/// The polygon along an element's edge, midside nodes included.
fn outline(mesh: &Mesh, nodes: &[u32]) -> Vec<[f64; 2]> {
    let order: &[usize] = if nodes.len() == 6 {
        &[0, 3, 1, 4, 2, 5]
    } else {
        &[0, 1, 2, 3]
    };
    order
        .iter()
        .map(|&k| mesh.nodes[nodes[k] as usize])
        .collect()
}

// Verifies: FEM-001.
#[test]
fn mesh_is_mirror_symmetric_to_the_bit() {
    for name in BUILTIN_NAMES {
        for element in ELEMENTS {
            let mesh = Mesh::new(
                &builtin(name),
                &MeshOptions {
                    element,
                    ..MeshOptions::default()
                },
            )
            .unwrap();
            for row in &mesh.rows {
                for (left, right) in row.clone().zip(row.clone().rev()) {
                    let ([x, y], [mirrored_x, mirrored_y]) = (mesh.nodes[left], mesh.nodes[right]);
                    // −0 and +0 stand for the same place on the axis.
                    assert_eq!(x, -mirrored_x);
                    assert_eq!(y.to_bits(), mirrored_y.to_bits());
                }
            }
            // The mirror image of each element is an element of the same region.
            let mirror: HashMap<u32, u32> = mesh
                .rows
                .iter()
                .flat_map(|row| row.clone().zip(row.clone().rev()))
                .map(|(a, b)| (a as u32, b as u32))
                .collect();
            let key = |nodes: &[u32], region| {
                let mut nodes = nodes.to_vec();
                nodes.sort_unstable();
                (nodes, format!("{region:?}"))
            };
            let all: std::collections::HashSet<_> = mesh
                .elements()
                .zip(&mesh.regions)
                .map(|(nodes, region)| key(nodes, region))
                .collect();
            for (nodes, region) in mesh.elements().zip(&mesh.regions) {
                let image: Vec<u32> = nodes.iter().map(|node| mirror[node]).collect();
                assert!(
                    all.contains(&key(&image, region)),
                    "{name}: no mirror image of {nodes:?}"
                );
            }
        }
    }
}

// Verifies: FEM-001, FEM-002.
#[test]
fn regions_have_the_phantoms_areas() {
    for name in BUILTIN_NAMES {
        for element in ELEMENTS {
            let phantom = builtin(name);
            let mesh = Mesh::new(
                &phantom,
                &MeshOptions {
                    element,
                    ..MeshOptions::default()
                },
            )
            .unwrap();
            let mut areas = [0.0; 3];
            for (nodes, region) in mesh.elements().zip(&mesh.regions) {
                let part = area(&outline(&mesh, nodes));
                assert!(part > 0.0, "{name}: element {nodes:?} is turned");
                areas[match region {
                    Region::Gel => 0,
                    Region::Skin => 1,
                    Region::Disc => 2,
                }] += part;
            }
            let relative = |found: f64, expected: f64| (found / expected - 1.0).abs();
            assert!(
                relative(areas.iter().sum(), 0.034 * 0.0155) < 1e-12,
                "{name}: {areas:?}"
            );
            assert!(
                relative(areas[1], 0.034 * 0.0005) < 1e-12,
                "{name}: {areas:?}"
            );
            if name != "none" {
                // A polygon of n chords lies inside the circle by the factor sin(2π/n)/(2π/n); the mesh has
                // at least 8 cells along each quarter's edge with a node in the middle of each.
                let n = 2.0 * std::f64::consts::PI / 64.0;
                let circle = std::f64::consts::PI * 0.0032 * 0.0032;
                assert!(
                    areas[2] < circle
                        && relative(areas[2], circle) < (1.0 - n.sin() / n) * (1.0 + 1e-9),
                    "{name}: {areas:?}"
                );
            }
        }
    }
}

// Verifies: FEM-002.
#[test]
fn nodes_on_the_discs_edge_lie_on_the_circle() {
    let phantom = builtin("4.6");
    let mesh = Mesh::new(&phantom, &MeshOptions::default()).unwrap();
    let in_region = |wanted: Region| -> std::collections::HashSet<u32> {
        mesh.elements()
            .zip(&mesh.regions)
            .filter(|(_, region)| **region == wanted)
            .flat_map(|(n, _)| n)
            .copied()
            .collect()
    };
    let disc = in_region(Region::Disc);
    let edge: Vec<u32> = in_region(Region::Gel)
        .intersection(&disc)
        .copied()
        .collect();
    assert!(edge.len() >= 64, "{} nodes", edge.len());
    for node in edge {
        let [x, y] = mesh.nodes[node as usize];
        let radius = x.hypot(y + 0.0046 + 0.0032);
        assert!(
            (radius - 0.0032).abs() < 1e-17,
            "node {node} at radius {radius}"
        );
    }
}

// Verifies: FEM-003.
#[test]
fn edges_are_shared_by_two_elements_with_the_same_middle() {
    for element in ELEMENTS {
        let mesh = Mesh::new(
            &builtin("6.6"),
            &MeshOptions {
                size: 1.5e-3,
                refinement: 1,
                element,
            },
        )
        .unwrap();
        let mut edges: HashMap<[u32; 2], Vec<Option<u32>>> = HashMap::new();
        for nodes in mesh.elements() {
            let corners = element.corners();
            for k in 0..corners {
                let (a, b) = (nodes[k], nodes[(k + 1) % corners]);
                edges
                    .entry([a.min(b), a.max(b)])
                    .or_default()
                    .push(nodes.get(corners + k).copied());
            }
        }
        let on_border = |node: u32| {
            let [x, y] = mesh.nodes[node as usize];
            x.abs() == 0.017 || y == 0.0 || y == -0.0155
        };
        for (ends, middles) in edges {
            assert!(
                middles.windows(2).all(|pair| pair[0] == pair[1]),
                "{ends:?}: {middles:?}"
            );
            let border = ends.iter().all(|&node| on_border(node));
            assert!(
                middles.len() == 2 || (border && middles.len() == 1),
                "{ends:?} in {} elements",
                middles.len()
            );
        }
        let used: std::collections::HashSet<u32> = mesh.connectivity.iter().copied().collect();
        assert_eq!(used.len(), mesh.nodes.len(), "a node without element");
    }
}

// Verifies: FEM-003.
#[test]
fn skin_has_two_rows_and_refinement_halves_every_cell() {
    let sizes = |refinement| {
        Mesh::new(
            &builtin("2.6"),
            &MeshOptions {
                refinement,
                ..MeshOptions::default()
            },
        )
        .unwrap()
    };
    let (one, two) = (sizes(1), sizes(2));
    let rows_in_skin = |mesh: &Mesh| {
        let heights: std::collections::BTreeSet<u64> = mesh
            .rows
            .iter()
            .map(|row| mesh.nodes[row.start][1])
            .filter(|&y| y > -0.0005 - 1e-12)
            .map(|y| (-y).to_bits())
            .collect();
        (heights.len() - 1) / 2
    };
    assert!(rows_in_skin(&one) >= 2);
    assert_eq!(rows_in_skin(&two), 2 * rows_in_skin(&one));
    assert_eq!(two.rows[0].len() - 1, 2 * (one.rows[0].len() - 1));
}

// Verifies: FEM-004.
#[test]
fn floor_and_walls_are_held_with_the_edges_of_the_skin_and_nothing_else() {
    for name in BUILTIN_NAMES {
        let phantom = builtin(name);
        let (wall, floor) = (phantom.gel.width / 2.0, -phantom.total_height());
        for element in ELEMENTS {
            let options = MeshOptions {
                size: 2e-3,
                refinement: 1,
                element,
            };
            let mesh = Mesh::new(&phantom, &options).unwrap();
            let mut held_in_skin = 0;
            for (&[x, y], free) in mesh.nodes.iter().zip(mesh.free()) {
                let on_border = (x.abs() - wall).abs() < 1e-12 || (y - floor).abs() < 1e-12;
                assert_eq!(free, !on_border, "{name}, {element:?}: {x}, {y}");
                held_in_skin += usize::from(!free && y > -phantom.skin.thickness);
            }
            // At each wall the surface itself and the row in the middle of the skin, at least.
            assert!(held_in_skin >= 4, "{held_in_skin}");
        }
    }
}

// Verifies: FEM-018.
#[test]
fn sizes_without_a_mesh_are_refused() {
    let phantom = builtin("none");
    for size in [0.0, -1e-3, f64::NAN, f64::INFINITY, 1e-6, 1e-300] {
        let error = Mesh::new(
            &phantom,
            &MeshOptions {
                size,
                ..MeshOptions::default()
            },
        )
        .unwrap_err();
        assert!(
            matches!(error, FemError::MeshSize { .. }),
            "{size}: {error}"
        );
        assert!(error.to_string().contains("mesh size"), "{error}");
    }
    for refinement in [0, usize::MAX] {
        assert!(
            Mesh::new(
                &phantom,
                &MeshOptions {
                    refinement,
                    ..MeshOptions::default()
                }
            )
            .is_err()
        );
    }
}

// Verifies: FEM-002, FEM-017.
#[test]
fn any_valid_phantom_has_a_mesh_without_turned_elements() {
    let mut count = 0;
    for diameter_mm in [0.5, 2.0, 6.4, 12.0] {
        for depth_mm in [0.6, 1.0, 2.6, 5.0, 9.0, 14.0] {
            let mut phantom: Phantom = builtin("2.6");
            let material = phantom.inclusion.unwrap().material;
            phantom.inclusion = Some(Inclusion {
                diameter: diameter_mm * 1e-3,
                depth: depth_mm * 1e-3,
                material,
            });
            if phantom.validate().is_err() {
                continue;
            }
            count += 1;
            for element in ELEMENTS {
                let mesh = Mesh::new(
                    &phantom,
                    &MeshOptions {
                        size: MeshOptions::default().size,
                        refinement: 1,
                        element,
                    },
                )
                .unwrap();
                for nodes in mesh.elements() {
                    assert!(
                        area(&outline(&mesh, nodes)) > 0.0,
                        "{diameter_mm} mm at {depth_mm} mm: {nodes:?}"
                    );
                }
                crate::fem::assembly::StiffnessMatrix::assemble(&mesh, &phantom).unwrap_or_else(
                    |error| panic!("{diameter_mm} mm at {depth_mm} mm, {element:?}: {error}"),
                );
            }
        }
    }
    assert!(count >= 15, "only {count} of the phantoms are valid");
}

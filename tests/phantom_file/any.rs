//! Phantoms and files at random.

use palpate::phantom::{
    Inclusion, Layer, Material, Phantom, PhantomParts, Probe, Shape, Strain, Support, Well,
};
use proptest::collection::vec;
use proptest::prelude::*;

use super::{EXAMPLE, read};
use palpate_asserts::seeded;

fn material() -> impl Strategy<Value = Material> {
    let fibres = prop::option::of((0.0..1e12, -360.0..360.0));
    (1e-3..1e12, -0.999..0.4995, fibres).prop_map(|(youngs_modulus, poisson_ratio, fibres)| {
        let (fibre_modulus, fibre_angle_deg) = fibres.unwrap_or_default();
        Material {
            fibre_modulus,
            fibre_angle_deg,
            ..Material::isotropic(youngs_modulus, poisson_ratio)
        }
    })
}

/// A shape within a square of this side about the origin, which it need not fill: a disc, an ellipse, or a polygon of so many
/// corners, by its sizes and its turn or height.
fn shape(kind: usize, sizes: [f64; 2], turn: f64, side: f64) -> Shape {
    let [width, height] = sizes.map(|size| size * side);
    let radius = 0.5 * width.max(0.6 * side);
    let point = |k: usize| {
        let angle = (k as f64 + sizes[1]) / kind as f64 * std::f64::consts::TAU;
        let y = 4.0 * turn * side;
        [radius * angle.cos(), y + radius * angle.sin()]
    };
    let angle_deg = 360.0 * turn;
    match kind {
        0 => Shape::Disc { diameter: width },
        1 => Shape::Ellipse {
            width,
            height,
            angle_deg,
        },
        corners => Shape::Polygon {
            points: (0..corners).map(point).collect(),
        },
    }
}

/// A phantom that is allowed, by construction: each layer may hold some inclusions side by side, in cells of equal width.
fn phantom() -> impl Strategy<Value = Phantom> {
    let name = || "[^\\p{C}]{1,80}";
    let kind = prop_oneof![Just(0), Just(1), 3..12usize];
    let of = (kind, prop::array::uniform2(0.3..1.0), -1.0..1.0);
    let cells = vec(prop::option::of((of, material())), 0..4);
    let layer = (name(), 1e-6..0.1f64, material(), cells);
    let supports = prop::sample::select(
        &[
            (Support::Fixed, Support::Fixed),
            (Support::Fixed, Support::Free),
            (Support::Sliding, Support::Sliding),
            (Support::Free, Support::Fixed),
        ][..],
    );
    let sizes = (0.01..1.0f64, 0.001..0.999, 1e-6..1.0);
    let finite = prop::option::of((0.0..2.0, 0.0..1e12));
    (name(), sizes, supports, vec(layer, 1..5), finite).prop_map(
        |(name, (width, share, length), (walls, floor), stack, finite)| {
            let (mut layers, mut inclusions, mut top) = (Vec::new(), Vec::new(), 0.0);
            for (name, thickness, material, cells) in stack {
                let cell = (width - 0.0002) / cells.len() as f64;
                let size: f64 = f64::min(cell - 0.0002, 0.9).min(thickness - 0.0003);
                for (at, of) in cells.into_iter().enumerate() {
                    // Edges of 0.3·2·sin(π/11)·size > 0.1 mm.
                    if let Some(((kind, sizes, turn), material)) = of.filter(|_| size > 0.002) {
                        inclusions.push(Inclusion {
                            centre_x: (at as f64 + 0.5) * cell - (width - 0.0002) / 2.0,
                            depth: top + 0.00015,
                            shape: shape(kind, sizes, turn, size),
                            material,
                        });
                    }
                }
                top += thickness;
                layers.push(Layer {
                    name,
                    thickness,
                    material,
                });
            }
            let radius = 1e-6 + (width / 2.0 - 1e-6) * share;
            let well = Well {
                width,
                walls,
                floor,
            };
            let strain = finite.map_or(Strain::Small, |_| Strain::Finite);
            let (friction, yeoh_c20) = finite.unwrap_or_default();
            layers[0].material.yeoh_c20 = yeoh_c20;
            let mut parts = PhantomParts {
                name,
                strain,
                geometry: Default::default(),
                well,
                layers,
                inclusions,
                probe: Probe {
                    radius,
                    length,
                    friction,
                },
            };
            if strain == Strain::Finite {
                let materials = parts.materials_mut();
                materials.for_each(|of| of.poisson_ratio = of.poisson_ratio.max(1e-3));
            }
            Phantom::new(parts).expect("sizes that fit")
        },
    )
}

proptest! {
    #![proptest_config(seeded(1))]

    // Verifies: PHA-006, PHA-027, PHA-029.
    #[test]
    fn any_valid_phantom_survives_the_file_to_the_bit(phantom in phantom()) {
        let text = phantom.to_toml();
        // Texts as well, since −0 = 0.
        prop_assert_eq!(read(&text).unwrap().to_toml(), text.clone());
        prop_assert_eq!(read(&text), Ok(phantom.clone()));
        let parts = PhantomParts::from(phantom);
        let json = serde_json::to_string(&parts).unwrap();
        prop_assert_eq!(serde_json::from_str::<PhantomParts>(&json).unwrap(), parts);
    }

    // Verifies: PHA-026.
    #[test]
    fn mutated_files_never_panic(at in 0..EXAMPLE.len(), removed in 0usize..20, added: String) {
        let end = (at + removed).min(EXAMPLE.len());
        let text = format!("{}{added}{}", &EXAMPLE[..at], &EXAMPLE[end..]);
        if let Err(message) = read(&text) {
            prop_assert!(message.starts_with("gel.toml:"));
            prop_assert!(!message.contains('\n'), "{message:?}");
        }
    }

    // Verifies: PHA-026.
    #[test]
    fn mutated_tokens_never_panic(
        line in 0..29usize,
        token in "[-+0-9a-z_.=\\[\\]{}\"'#\\n,:eE]{0,12}",
    ) {
        let mut lines: Vec<&str> = EXAMPLE.lines().collect();
        lines[line] = &token;
        let _ = read(&lines.join("\n"));
    }
}

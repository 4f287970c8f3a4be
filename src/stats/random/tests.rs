use super::*;
use crate::stats::check::assert_near;

// Verifies: DET-110.
#[test]
fn philox_gives_the_published_words() {
    // Random123's kat_vectors, lines philox4x64 10; NumPy's Philox agrees with the first.
    for (counter, key, expected) in [
        (
            [0; 4],
            [0; 2],
            [
                0x1655_4d9e_ca36_314c,
                0xdb20_fe9d_672d_0fdc,
                0xd7e7_72ce_e186_176b,
                0x7e68_b68a_ec7b_a23b,
            ],
        ),
        (
            [u64::MAX; 4],
            [u64::MAX; 2],
            [
                0x87b0_92c3_013f_e90b,
                0x438c_3c67_be8d_0224,
                0x9cc7_d7c6_9cd7_77b6,
                0xa09c_aebf_594f_0ba0,
            ],
        ),
        (
            [
                0x243f_6a88_85a3_08d3,
                0x1319_8a2e_0370_7344,
                0xa409_3822_299f_31d0,
                0x082e_fa98_ec4e_6c89,
            ],
            [0x4528_21e6_38d0_1377, 0xbe54_66cf_34e9_0c6c],
            [
                0xa528_f454_03e6_1d95,
                0x38c7_2dbd_566e_9788,
                0xa5a1_610e_72fd_18b5,
                0x57bd_43b5_e52b_7fe6,
            ],
        ),
    ] {
        assert_eq!(Generator::new(key[0], key[1]).words(counter), expected);
    }
}

// Verifies: DET-111.
#[test]
fn a_deviate_is_a_function_of_its_address() {
    let generator = Generator::new(7, 3);
    let mut all = [0.0; 4003];
    generator.normals(11, 0, &mut all);
    for (index, &deviate) in all.iter().enumerate() {
        assert_eq!(generator.normal(11, index as u64), deviate);
    }
    let mut prefix = [0.0; 10];
    generator.normals(11, 0, &mut prefix);
    assert_eq!(prefix, all[..10]);
    for first in 0..9 {
        for length in 0..9 {
            generator.normals(11, first as u64, &mut prefix[..length]);
            assert_eq!(prefix[..length], all[first..first + length]);
        }
    }
    // Around the end of the addresses.
    generator.normals(11, u64::MAX - 5, &mut prefix);
    for (step, &deviate) in prefix.iter().enumerate() {
        let index = (u64::MAX - 5).wrapping_add(step as u64);
        assert_eq!(generator.normal(11, index), deviate);
    }
    assert_ne!(generator.normal(12, 0), all[0]);
    assert_ne!(Generator::new(7, 4).normal(11, 0), all[0]);
    assert_ne!(Generator::new(8, 3).normal(11, 0), all[0]);
}

// Verifies: DET-112.
#[test]
fn ziggurat_has_layers_of_equal_area_under_the_curve() {
    let area = EDGES[0] * height(TAIL);
    // The base: a rectangle up to TAIL and the tail, ∫ = √(π/2) erfc(r/√2).
    assert_eq!(EDGES[1], TAIL);
    let tail = libm::sqrt(core::f64::consts::FRAC_PI_2)
        * libm::erfc(TAIL * core::f64::consts::FRAC_1_SQRT_2);
    assert_near(TAIL * height(TAIL) + tail, area, 1e-16);
    assert_eq!(EDGES[512], 0.0);
    for layer in 1..512 {
        assert!(EDGES[layer] < EDGES[layer - 1]);
        let thickness = height(EDGES[layer + 1]) - height(EDGES[layer]);
        assert_near(EDGES[layer] * thickness, area, 2e-15);
    }
}

// Verifies: DET-112.
#[test]
fn deviates_reach_every_part_of_the_ziggurat() {
    // The words that must end in the base's tail, at either sign, and in the top layer's wedge.
    let generator = Generator::new(1, 2);
    let far = |word| generator.deviate(word, 5, 9);
    assert!(far(0x7FFF_FFFF_FFFF_FE00) > TAIL);
    assert!(far(0x8000_0000_0000_0000) < -TAIL);
    let (x, layer) = candidate(0x7FFF_FFFF_FFFF_FFFF);
    assert_eq!(layer, 511);
    assert!(x < EDGES[511] && x > 0.999 * EDGES[511]);
    assert!(far(0x7FFF_FFFF_FFFF_FFFF).is_finite());
}

use super::*;
use palpate_asserts::assert_near;

/// Random123's kat_vectors, lines philox4x64 10: counter, key and words; NumPy's Philox agrees with the first.
const PUBLISHED: &str = "
0 0 0 0 0 0 16554d9eca36314c db20fe9d672d0fdc d7e772cee186176b 7e68b68aec7ba23b
ffffffffffffffff ffffffffffffffff ffffffffffffffff ffffffffffffffff ffffffffffffffff ffffffffffffffff 87b092c3013fe90b 438c3c67be8d0224 9cc7d7c69cd777b6 a09caebf594f0ba0
243f6a8885a308d3 13198a2e03707344 a4093822299f31d0 082efa98ec4e6c89 452821e638d01377 be5466cf34e90c6c a528f45403e61d95 38c72dbd566e9788 a5a1610e72fd18b5 57bd43b5e52b7fe6
";

// Verifies: DET-110.
#[test]
fn philox_gives_the_published_words() {
    for line in PUBLISHED.trim().lines() {
        let mut words = line.split(' ');
        let [a, b, c, d, seed, stream, expected @ ..] =
            [(); 10].map(|()| u64::from_str_radix(words.next().unwrap(), 16).unwrap());
        assert_eq!(Generator::new(seed, stream).words([a, b, c, d]), expected);
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

// Verifies: DET-110, DET-111.
#[test]
fn no_part_of_an_address_is_cut() {
    let ends = [16, 32, 63].map(|bits| 1_u64 << bits);
    let mut numbers: Vec<u64> = ends
        .iter()
        .flat_map(|end| [end - 1, *end, end + 1])
        .collect();
    numbers.extend([0, 1, 2, u64::MAX]);
    let parts: [&dyn Fn(u64) -> f64; 4] = [
        &|seed| Generator::new(seed, 1).normal(1, 1),
        &|stream| Generator::new(1, stream).normal(1, 1),
        &|trial| Generator::new(1, 1).normal(trial, 1),
        &|index| Generator::new(1, 1).normal(1, index),
    ];
    for (at, part) in parts.iter().enumerate() {
        let mut found: Vec<f64> = numbers.iter().map(|number| part(*number)).collect();
        found.sort_by(f64::total_cmp);
        // Of 53 bits, two of 13 are the same once in 10¹⁴.
        assert!(found.is_sorted_by(|a, b| a < b), "part {at}: {found:?}");
    }
}

// Verifies: DET-110.
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

// Verifies: DET-110.
#[test]
fn deviates_reach_every_part_of_the_ziggurat() {
    // The words that must end in the base's tail, at either sign, and in the top layer's wedge.
    let generator = Generator::new(1, 2);
    let far = |word| {
        let (x, layer) = candidate(word);
        assert!(x.abs() >= EDGES[layer + 1]);
        generator.deviate_at_an_edge(x, layer, 5, 9)
    };
    assert!(far(0x7FFF_FFFF_FFFF_FE00) > TAIL);
    assert!(far(0x8000_0000_0000_0000) < -TAIL);
    let (x, layer) = candidate(0x7FFF_FFFF_FFFF_FFFF);
    assert_eq!(layer, 511);
    assert!(x < EDGES[511] && x > 0.999 * EDGES[511]);
    assert!(far(0x7FFF_FFFF_FFFF_FFFF).is_finite());
}

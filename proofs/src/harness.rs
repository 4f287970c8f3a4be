//! One harness, three engines: a test with fixed seeds, bolero's fuzzers, and Kani.

/// Checks a property on values of a type:
///
/// - in the ordinary test run, on 100,000 values from fixed seeds, then on what bolero keeps for
///   the test (its corpus; `BOLERO_RANDOM_SEED`; `BOLERO_RANDOM_ITERATIONS` for fresh seeds);
/// - under a fuzzer, on what it tries;
/// - under Kani, on all values that the type's generator can make.
macro_rules! harness {
    ($case:ty, |$value:ident| $body:block) => {{
        let property = |$value: &$case| $body;
        #[cfg(not(any(kani, fuzzing)))]
        $crate::harness::run::<$case>(property);
        bolero::check!()
            .with_type::<$case>()
            .with_iterations(0)
            .for_each(property);
    }};
}

/// Regions of the inputs that a harness must reach: cover properties for Kani, elsewhere counters.
/// Each case must come by, whether it is in the region or not, so that no region can be overlooked.
macro_rules! reached {
    ($($name:literal: $condition:expr),+ $(,)?) => {{
        $(
            #[cfg(kani)]
            kani::cover!($condition, $name);
            #[cfg(not(kani))]
            $crate::harness::count($name, $condition);
        )+
    }};
}

#[cfg(not(kani))]
pub use counted::count;
#[cfg(not(any(kani, fuzzing)))]
pub use counted::run;

#[cfg(not(kani))]
#[cfg_attr(fuzzing, allow(dead_code))]
mod counted {
    use std::cell::RefCell;
    use std::fmt::Debug;

    use bolero::TypeGenerator;
    use bolero::generator::bolero_generator::driver::{ByteSliceDriver, Options};

    /// Cases of each harness in the ordinary test run.
    const CASES: u64 = 100_000;

    /// The least share of them in each region: 1 in this many.
    const SHARE: u64 = 100;

    /// Bytes from which a case is made; the largest takes fewer than half.
    const ENTROPY: usize = 1024;

    struct Region {
        name: &'static str,
        passed: u64,
        hits: u64,
    }

    thread_local! {
        static REGIONS: RefCell<Vec<Region>> = const { RefCell::new(Vec::new()) };
    }

    /// Counts a case that came by a region.
    pub fn count(name: &'static str, hit: bool) {
        REGIONS.with_borrow_mut(|regions| {
            let place = regions.iter().position(|region| region.name == name);
            let place = place.unwrap_or_else(|| {
                let (passed, hits) = (0, 0);
                regions.push(Region { name, passed, hits });
                regions.len() - 1
            });
            regions[place].passed += 1;
            regions[place].hits += u64::from(hit);
        });
    }

    /// Checks the property on [`CASES`] values, the same in each run, and that 1 % of them are in
    /// each region.
    pub fn run<T: TypeGenerator + Debug>(property: impl Fn(&T)) {
        REGIONS.take();
        for seed in 0..CASES {
            let entropy = bytes(seed);
            let mut driver = ByteSliceDriver::new(&entropy, &Options::default());
            let value = T::generate(&mut driver).expect("validity is by construction");
            assert!(
                driver.as_slice().len() > ENTROPY / 2,
                "too few bytes for a case"
            );
            let shown = ShownOnPanic { seed, value };
            property(&shown.value);
        }
        let regions = REGIONS.take();
        assert!(!regions.is_empty(), "a harness names what it reaches");
        for Region { name, passed, hits } in regions {
            println!("{hits:>7} of {passed} cases: {name}");
            assert_eq!(passed, CASES, "some cases do not come by: {name}");
            assert!(hits * SHARE >= CASES, "too few cases: {name}, {hits}");
        }
    }

    struct ShownOnPanic<T: Debug> {
        seed: u64,
        value: T,
    }

    impl<T: Debug> Drop for ShownOnPanic<T> {
        fn drop(&mut self) {
            if std::thread::panicking() {
                eprintln!("case {}: {:?}", self.seed, self.value);
            }
        }
    }

    /// Bytes of one seed, by SplitMix64 (Steele, Lea, Flood 2014).
    fn bytes(seed: u64) -> [u8; ENTROPY] {
        let mut state = mix(seed);
        let mut bytes = [0; ENTROPY];
        for word in bytes.chunks_exact_mut(8) {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            word.copy_from_slice(&mix(state).to_le_bytes());
        }
        bytes
    }

    fn mix(word: u64) -> u64 {
        let word = (word ^ (word >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let word = (word ^ (word >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        word ^ (word >> 31)
    }
}

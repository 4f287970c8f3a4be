//! Every target, as a test, a replay of what is kept, and a target of a fuzzer (`fuzz/README.md`).

use palpate_fuzz::{TARGETS, Target};

/// A test that checks a target on random changes of its kept inputs, the same in every run, and then
/// on the kept inputs; under a fuzzer, on what that tries.
macro_rules! targets {
    ($($name:ident: $cases:literal),* $(,)?) => {
        $(
            // Verifies: EVD-080, EVD-081, EVD-082, EVD-085.
            #[test]
            fn $name() {
                let target = target(stringify!($name));
                #[cfg(not(fuzzing))]
                ordinary::run(target, $cases);
                bolero::check!().with_iterations(0).for_each(|bytes: &[u8]| {
                    (target.check)(bytes);
                });
            }
        )*

        // Verifies: EVD-080.
        #[test]
        fn every_target_has_a_test() {
            let names: Vec<_> = TARGETS.iter().map(|target| target.name).collect();
            assert_eq!(names, [$(stringify!($name)),*]);
        }
    };
}

targets!(
    phantom_toml: 5_000,
    config_toml: 5_000,
    map_json: 5_000,
    map_csv: 5_000,
    trace_csv: 5_000,
    counts_csv: 2_000,
    journal: 1_000,
    vectors: 5_000,
    oracle_line: 5_000,
    hid_report: 10_000,
    recording: 5_000,
    list: 5_000,
    decimal: 10_000,
    command_line: 2_000,
);

// Verifies: EVD-087.
#[test]
fn the_corpora_stay_small() {
    let kept = TARGETS
        .iter()
        .flat_map(|target| palpate_fuzz::random::kept(target.name));
    let bytes: usize = kept.map(|input| input.len()).sum();
    assert!(bytes <= 200_000, "{bytes} bytes");
}

fn target(name: &str) -> &'static Target {
    let known = TARGETS.iter().find(|target| target.name == name);
    known.expect("a target of that name")
}

#[cfg(not(fuzzing))]
mod ordinary {
    use palpate_fuzz::random::{Random, changed, kept};
    use palpate_fuzz::{Outcome, Target};

    /// Checks a target on `cases` changes of its kept inputs, of which both answers must get 1 in 100: a
    /// reader that takes all or nothing would leave half of the property without a case. Every second
    /// case comes from an input that is accepted, since most of what a fuzzer keeps is refused.
    pub fn run(target: &Target, cases: u64) {
        let kept = kept(target.name);
        let is_accepted = |bytes: &&Vec<u8>| (target.check)(bytes) == Outcome::Accepted;
        let good: Vec<Vec<u8>> = kept.iter().filter(is_accepted).cloned().collect();
        let mut accepted = 0;
        for seed in 0..cases {
            let seeds = if seed % 2 == 0 { &good } else { &kept };
            let case = Case {
                seed,
                bytes: changed(seeds, &mut Random::new(seed)),
            };
            accepted += u64::from((target.check)(&case.bytes) == Outcome::Accepted);
        }
        println!("{}: {accepted} of {cases} accepted", target.name);
        let share = cases / 100;
        assert!((share..=cases - share).contains(&accepted), "{accepted}");
    }

    /// Shown if a property does not hold.
    struct Case {
        seed: u64,
        bytes: Vec<u8>,
    }

    impl Drop for Case {
        fn drop(&mut self) {
            if std::thread::panicking() {
                let text = String::from_utf8_lossy(&self.bytes);
                eprintln!("case {}: {text:?}", self.seed);
            }
        }
    }
}

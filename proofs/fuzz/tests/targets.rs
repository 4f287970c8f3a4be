//! Every target, as a test, a replay of what is kept, and a target of a fuzzer (`proofs/fuzz/README.md`).

use palpate_fuzz::{TARGETS, Target};

/// A test that checks a target on random changes of its kept inputs, the same in every run, and then
/// on the kept inputs; under a fuzzer, on what that tries.
macro_rules! targets {
    ($($name:ident: $cases:literal),* $(,)?) => {
        $(
            #[test]
            fn $name() {
                let target = target(stringify!($name));
                #[cfg(not(fuzzing))]
                ordinary::run(target, $cases);
                #[cfg(fuzzing)]
                bolero::check!().for_each(|bytes: &[u8]| {
                    target.check(bytes);
                });
            }
        )*

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
    live_lines: 5_000,
    path_csv: 5_000,
    curve_csv: 5_000,
    counts_csv: 2_000,
    journal: 1_000,
    vectors: 5_000,
    oracle_line: 5_000,
    hid_report: 10_000,
    pipe_reports: 5_000,
    recording: 5_000,
    list: 5_000,
    decimal: 10_000,
    command_line: 2_000,
);

#[test]
fn the_corpora_stay_small() {
    let kept = TARGETS
        .iter()
        .flat_map(|target| palpate_fuzz::random::kept(target.name));
    let bytes: usize = kept.map(|(_, input)| input.len()).sum();
    assert!(bytes <= 200_000, "{bytes} bytes");
}

/// The rows of the tables of the README that begin with a target's name, as cells.
fn rows(name: &str) -> impl Iterator<Item = Vec<&'static str>> {
    let start = format!("| `{name}` |");
    let lines = include_str!("../README.md")
        .lines()
        .filter(move |line| line.starts_with(&start));
    lines.map(|line| line.split('|').map(str::trim).collect())
}

#[test]
fn each_run_of_a_fuzzer_is_on_record() {
    for target in TARGETS {
        // Duration, processor time, executions, their rate, and three counts of edges.
        let run = rows(target.name).find(|cells| cells.len() == 10);
        let cells = run.unwrap_or_else(|| panic!("{} has no run in the README", target.name));
        for cell in &cells[2..9] {
            assert!(
                cell.starts_with(|digit: char| digit.is_ascii_digit()),
                "{cells:?}"
            );
        }
    }
}

#[test]
fn each_input_that_broke_a_property_is_kept() {
    let mut named = 0;
    for target in TARGETS {
        let finds = rows(target.name).filter(|cells| cells.len() == 6);
        for quoted in finds.flat_map(|cells| cells[2].split('`').skip(1).step_by(2)) {
            let file = format!("crashes/{}", quoted.trim_start_matches("crashes/"));
            let kept = palpate_fuzz::random::kept(target.name);
            assert!(kept.contains_key(&file), "{}: {file}", target.name);
            named += 1;
        }
    }
    assert!(named >= 8, "{named}");
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
        let (mut good, mut all) = (Vec::new(), Vec::new());
        for (what, bytes) in kept(target.name) {
            let case = Case { what, bytes };
            if target.check(&case.bytes) == Outcome::Accepted {
                good.push(case.bytes.clone());
            }
            all.push(case.bytes.clone());
        }
        let mut accepted = 0;
        for seed in 0..cases {
            let seeds = if seed % 2 == 0 { &good } else { &all };
            let case = Case {
                what: format!("case {seed}"),
                bytes: changed(seeds, &mut Random::new(seed)),
            };
            accepted += u64::from(target.check(&case.bytes) == Outcome::Accepted);
        }
        println!("{}: {accepted} of {cases} accepted", target.name);
        let share = cases / 100;
        assert!((share..=cases - share).contains(&accepted), "{accepted}");
    }

    /// Shown if a property does not hold.
    struct Case {
        what: String,
        bytes: Vec<u8>,
    }

    impl Drop for Case {
        fn drop(&mut self) {
            if std::thread::panicking() {
                let text = String::from_utf8_lossy(&self.bytes);
                eprintln!("{}: {text:?}", self.what);
            }
        }
    }
}

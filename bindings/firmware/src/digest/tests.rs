//! What the digest notices, and that the sweep asks what it is for.

extern crate std;

use std::collections::BTreeSet;
use std::format;
use std::string::String;
use std::vec::Vec;

use super::*;

/// The answers to all questions of a sweep.
fn answers((stream, sweep): (u64, &Sweep)) -> Vec<String> {
    let mut draw = Draw::new(stream);
    let answer = |_| {
        let mut text = String::new();
        (sweep.ask)(&mut draw, &mut text).unwrap();
        text
    };
    (0..sweep.questions).map(answer).collect()
}

fn digest(text: &[u8]) -> u64 {
    let mut digest = Digest::default();
    digest.write_str(str::from_utf8(text).unwrap()).unwrap();
    digest.0
}

/// A planted flip in each answer of each function.
#[test]
fn the_digest_changes_with_any_answer() {
    let mut printed = String::new();
    print(&mut printed);
    for (line, numbered) in printed.lines().zip((0..).zip(SWEEPS)) {
        let answers = answers(numbered);
        let mut text = answers.concat().into_bytes();
        let sound = digest(&text);
        assert!(line.ends_with(&format!(" {sound:016x}")), "{line}");
        let mut place = 0;
        for answer in answers.iter().step_by(answers.len() / 64 + 1) {
            let digit = text[place..]
                .iter()
                .position(u8::is_ascii_alphanumeric)
                .unwrap()
                + place;
            text[digit] ^= 1;
            assert_ne!(digest(&text), sound, "{line}: {answer}");
            text[digit] ^= 1;
            place += answer.len();
        }
    }
}

#[test]
fn numbers_that_differ_by_a_bit_have_other_texts() {
    let mut draw = Draw::new(99);
    for _ in 0..10_000 {
        let (double, single) = (f64::from_bits(draw.word()), draw.single(-9.0, 9.0));
        if !double.is_nan() && !single.is_nan() {
            assert_ne!(
                format!("{double:?}"),
                format!("{:?}", f64::from_bits(double.to_bits() ^ 1))
            );
            assert_ne!(
                format!("{single:?}"),
                format!("{:?}", f32::from_bits(single.to_bits() ^ 1))
            );
        }
    }
}

#[test]
fn every_function_answers_most_questions_in_many_ways() {
    for numbered in (0..).zip(SWEEPS) {
        let (answers, name) = (answers(numbered), numbered.1.name);
        let refused = answers
            .iter()
            .filter(|text| text.starts_with("Err") || *text == "None;")
            .count();
        assert!(
            2 * refused < answers.len(),
            "{name}: {refused} of {} are refused",
            answers.len()
        );
        let distinct = answers.iter().collect::<BTreeSet<_>>().len();
        let few = ["decision", "control"].contains(&name);
        assert!(
            few || 8 * distinct > answers.len(),
            "{name}: {distinct} answers"
        );
    }
}

// The scenario is of use if the force follows the table and each fault comes.
#[test]
fn the_scenario_plays_and_has_each_fault() {
    let outcome = scenario::outcome().unwrap();
    assert!(outcome.playing > scenario::CYCLES / 10, "{outcome:?}");
    assert!(
        outcome.faults.iter().all(|&cycles| cycles > 0),
        "{outcome:?}"
    );
}

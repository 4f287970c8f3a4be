//! Vectors that are not valid are refused.

use std::fs;

use serde_json::json;

use crate::program::*;

// Verifies: ORA-041, VEC-001, VEC-003, VEC-004, VEC-005, VEC-006.
#[test]
fn files_that_are_not_valid_are_refused_with_file_and_case() {
    // What becomes the value at a place, which is there unless it is the last key, and words of the refusal.
    for [place, value, words] in rows(
        r#"
        /schema | "other" | palpate-vectors
        /schema_version | 2 | version 2, version 1
        /extra | 1 | extra
        /cases/1/extra | 1 | case choice-002, extra
        /cases/1/line | "x" | case choice-002, either args or line
        /cases/1/args | [] | case choice-002, expected a map
        /cases/3/line | "a\nb" | case choice-004, one line
        /cases/1/error | "bad_json" | case choice-002, either ok or error
        /cases/2/error | "wrong" | case choice-003, bad_argument
        /cases/1/id | "choice-001" | choice-001, twice
        /cases/1/flags | ["other"] | case choice-002, other
        /flags/unused | {"bug": "a", "notes": ""} | unused
        /cases/1/bits/p_correct | "0x3feaec4bd120d37e" | case choice-002, bits, p_correct
        /cases/1/bits | {} | case choice-002, bits
        /cases/1/bits/p_correct | ["0x3feaec4bd120d37d"] | case choice-002, bits
        /tolerance | {} | case choice-001, no tolerance
        /tolerance/p_correct | {"ulp": 1, "relative": 1, "reason": "a"} | one of ulp
        /tolerance/p_correct | {"ulp": 1, "reason": " "} | reason
        /tolerance/p_correct | {"absolute": 1, "reason": "a"} | unit
        /tolerance/p_correct | {"ulp": -1, "reason": "a"} | -1
        /cases/1/wrong/0/ok/p_correct | 0.8413447460685439 | case choice-002, ten times
        /cases/1/wrong/0/ok | {"p": 0.5} | case choice-002, has no "p_correct"
        /cases/1/condition | {"p": 1} | case choice-002, "p"
        /cases/1/condition | {"p_correct": [1]} | case choice-002, another shape
        /cases/1/condition | {"p_correct": -1} | case choice-002, another shape
        /cases/1/roundoff | 1 | case choice-002, roundoff = 1
        /cases/1/wrong/0/flag | "negative" | case choice-002, negative
        /cases | [] | no cases
        "#,
    ) {
        let (object, key) = place.rsplit_once('/').expect("a place");
        let mut vectors = vectors();
        vectors.pointer_mut(object).expect(place)[key] = serde_json::from_str(value).expect(value);
        let folder = write(&format!("invalid{}", place.replace('/', "-")), &vectors);
        let output = conform_at(&folder, "--vectors .", &[&palpate(), "oracle"]);
        fails(&output, 2, &format!("choice.json, {words}"));
    }
}

// Verifies: ORA-041, VEC-007.
#[test]
fn files_that_are_not_those_of_the_manifest_are_refused() {
    let here = write("manifest", &vectors());
    let refused = |file: &str, sum: &str, words: &str| {
        let text = json!({"suite_sha256": "00", "files": [{"name": file, "sha256": sum}]});
        fs::write(here.join("manifest.json"), text.to_string()).unwrap();
        let output = conform_at(&here, "--vectors .", &[&palpate(), "oracle"]);
        fails(&output, 2, words);
        error(&output).to_string()
    };
    let wrong = refused("choice.json", "00", "choice.json, manifest.json states 00");
    let (_, sum) = wrong.split_once("SHA-256 ").unwrap();
    let sum = &sum[..64];
    refused("choice.json", sum, "suite_sha256 is 00");
    refused("other.json", sum, "choice.json: is not in manifest.json");
}

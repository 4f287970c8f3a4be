//! Lines of the oracle.

use std::collections::HashMap;

use palpate::oracle::{Oracle, serve};
use serde::de::{Deserializer, IgnoredAny, MapAccess, Visitor};
use serde_json::Value;
use serde_json::value::RawValue;

use crate::Outcome;
use crate::message::check_message;

/// A question with a known answer, to see that the loop goes on.
const KNOWN: &[u8] = b"{\"id\":7,\"op\":\"normal_cdf\",\"args\":{\"x\":0}}\n";
const ITS_ANSWER: &[u8] = b"{\"id\":7,\"ok\":{\"p\":0.5}}\n";
/// The codes of `spec/oracle.md`.
const CODES: &str = "bad_json bad_request unknown_op bad_argument out_of_range overflow failed";

/// Any bytes get one line of JSON for each line, either `ok` with finite numbers or an error with a
/// known code and a message, with the id of the request byte for byte; the same bytes get the same
/// lines, and the next line its own answer.
pub fn oracle_line(bytes: &[u8]) -> Outcome {
    // A pose that the solver would answer takes seconds, and is no matter of reading.
    if bytes.windows(11).any(|part| part == b"probe_force") && solves(bytes) {
        return Outcome::Refused;
    }
    let input = [bytes, b"\n", KNOWN].concat();
    let mut output = Vec::new();
    serve(&input[..], &mut output).expect("memory can be written");
    let answers = output.strip_suffix(ITS_ANSWER);
    let answers = answers.expect("the next line has its answer");
    let lines: Vec<&[u8]> = bytes.split(|&byte| byte == b'\n').collect();
    let answers: Vec<&[u8]> = answers.split_inclusive(|&byte| byte == b'\n').collect();
    assert_eq!(lines.len(), answers.len());
    let mut outcome = Outcome::Refused;
    for (line, answer) in lines.iter().zip(answers) {
        if check_answer(line, answer) == Outcome::Accepted {
            outcome = Outcome::Accepted;
        }
    }
    outcome
}

/// Whether a line may ask for a solution.
fn solves(bytes: &[u8]) -> bool {
    let named = |name: &&str| {
        bytes
            .windows(name.len())
            .any(|part| part == name.as_bytes())
    };
    palpate::phantom::BUILTIN_NAMES.iter().any(named)
}

fn check_answer(line: &[u8], answer: &[u8]) -> Outcome {
    let text = std::str::from_utf8(answer).expect("UTF-8");
    // The id as it stands: it may be a number that no f64 holds.
    let mut members: HashMap<&str, &RawValue> =
        serde_json::from_str(text).expect("one object of JSON");
    assert_eq!(members.len(), 2, "{text}");
    let found = members.remove("id").expect("an id").get();
    assert_eq!(found, id(line).as_deref().unwrap_or("null"), "{text}");
    let value = |text: &RawValue| -> Value { serde_json::from_str(text.get()).expect("JSON") };
    // The same without anything asked before.
    let mut alone = Vec::new();
    Oracle::default().answer(line, &mut alone);
    assert!(alone == answer, "another answer at another time");
    match (members.get("ok"), members.get("error")) {
        (Some(ok), None) => {
            let ok = value(ok);
            assert!(ok.as_object().is_some_and(|values| !values.is_empty()));
            assert!(no_null(&ok), "{text}");
            Outcome::Accepted
        }
        (None, Some(error)) => {
            let error = value(error);
            let code = error["code"].as_str().expect("a code");
            assert!(CODES.split(' ').any(|known| known == code), "{text}");
            check_message(error["message"].as_str().expect("a message"));
            Outcome::Refused
        }
        _ => panic!("neither ok nor error: {text}"),
    }
}

/// Whether no number is missing: serde_json writes `null` for NaN and infinities.
fn no_null(value: &Value) -> bool {
    match value {
        Value::Null => false,
        Value::Array(values) => values.iter().all(no_null),
        Value::Object(values) => values.values().all(no_null),
        _ => true,
    }
}

/// The JSON text of the id that must come back, read by other means than the oracle's: a text or a
/// number in an object that has no second id.
fn id(line: &[u8]) -> Option<String> {
    let members: HashMap<String, &RawValue> = serde_json::from_slice(line).ok()?;
    let text = std::str::from_utf8(line).ok()?;
    // Values of an object hide its repeated keys: count the ids again.
    if count_ids(text)? != 1 {
        return None;
    }
    let id = members.get("id")?.get();
    let is_id =
        id.starts_with(|first: char| first == '"' || first == '-' || first.is_ascii_digit());
    is_id.then(|| id.to_string())
}

/// How many ids an object has.
fn count_ids(text: &str) -> Option<usize> {
    struct Count;
    impl<'de> Visitor<'de> for Count {
        type Value = usize;

        fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
            f.write_str("an object")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<usize, A::Error> {
            let mut count = 0;
            while let Some((key, IgnoredAny)) = map.next_entry::<String, IgnoredAny>()? {
                count += usize::from(key == "id");
            }
            Ok(count)
        }
    }
    let mut reader = serde_json::Deserializer::from_str(text);
    reader.deserialize_map(Count).ok()
}

//! Phantom files.

use palpate::phantom::{Phantom, PhantomParts};

use crate::message::check_file_message;
use crate::{FILE, Outcome, judged};

/// An accepted phantom is the same when it is written and read again, as TOML and as
/// JSON; a refusal names file, line and key.
pub fn phantom_toml(text: &str) -> Outcome {
    judged(Phantom::from_toml(text, FILE), check_phantom, |error| {
        check_file_message(&error, text);
        // Only a key of the whole file that is not there has no line.
        let is_missing = error.found.ends_with(" is missing");
        assert!(error.line.is_some() || is_missing, "{error}");
    })
}

fn check_phantom(phantom: Phantom) {
    let written = phantom.to_toml();
    let again = Phantom::from_toml(&written, FILE).expect("what was written can be read");
    // Texts as well, since −0 = 0.
    assert_eq!((&again, again.to_toml()), (&phantom, written));
    let phantom = PhantomParts::from(phantom);
    let written = serde_json::to_string(&phantom).expect("numbers and a text");
    let again: PhantomParts = serde_json::from_str(&written).expect("what was written can be read");
    assert_eq!(again, phantom);
    assert_eq!(serde_json::to_string(&again).ok(), Some(written));
}

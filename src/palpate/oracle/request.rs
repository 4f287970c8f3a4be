//! From a line to an op with arguments.

use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;

use super::answer::{Code, Refused};

/// A line that asks something.
#[derive(Debug)]
pub struct Query<'a> {
    /// The JSON text of the id.
    pub id: &'a str,
    /// The name of the op.
    pub op: String,
    /// The JSON text of the arguments.
    pub args: Option<&'a str>,
}

/// The members of a JSON object, each with its JSON text.
#[derive(Debug)]
pub struct Members<'a>(pub Vec<(String, &'a str)>);

/// Most members that an object of the protocol has; the rest of a longer one is not read.
const MOST_MEMBERS: usize = 32;

impl<'de> Deserialize<'de> for Members<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Collect;
        impl<'de> Visitor<'de> for Collect {
            type Value = Members<'de>;

            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut members = Vec::new();
                while let Some(name) = map.next_key::<String>()? {
                    members.push((name, map.next_value::<&RawValue>()?.get()));
                    if members.len() > MOST_MEMBERS {
                        return Err(serde::de::Error::custom(format_args!(
                            "more than {MOST_MEMBERS} members"
                        )));
                    }
                }
                Ok(Members(members))
            }
        }
        deserializer.deserialize_map(Collect)
    }
}

impl<'a> Members<'a> {
    /// The members of the object in `text`; `what` it should be.
    ///
    /// # Errors
    /// A refusal that names a key that is given twice, or what stands there instead of an object.
    pub fn parse(what: &str, text: &'a str, code: Code) -> Result<Members<'a>, Refused> {
        let wrong = |wrong: String| Refused::new(code, format!("{what}: {wrong}"));
        if !text.starts_with('{') {
            return Err(wrong(format!("expected an object, found {}", kind(text))));
        }
        let members: Members =
            serde_json::from_str(text).map_err(|error| wrong(error.to_string()))?;
        for (index, (name, _)) in members.0.iter().enumerate() {
            if members.0[..index].iter().any(|(other, _)| other == name) {
                return Err(wrong(format!("the key {name:?} is given twice")));
            }
        }
        Ok(members)
    }
}

/// What a JSON text is, in words.
pub fn kind(text: &str) -> &'static str {
    match text.as_bytes().first() {
        Some(b'"') => "a text",
        Some(b'{') => "an object",
        Some(b'[') => "a list",
        Some(b't' | b'f') => "a truth value",
        Some(b'n') => "null",
        _ => "a number",
    }
}

impl<'a> Query<'a> {
    /// Reads a line.
    ///
    /// # Errors
    /// The id, if there is one, and what is wrong.
    ///
    /// Implements: ORA-004, ORA-008.
    pub fn parse(line: &'a [u8]) -> Result<Query<'a>, (Option<&'a str>, Refused)> {
        let bad_json = |message: fmt::Arguments| (None, Refused::new(Code::BadJson, message));
        let text = str::from_utf8(line)
            .map_err(|error| bad_json(format_args!("the line is not UTF-8: {error}")))?;
        // The whole line first: what comes after its first mistake has no meaning.
        let value: &RawValue = serde_json::from_str(text)
            .map_err(|error| bad_json(format_args!("the line is no JSON: {error}")))?;
        let Members(members) = Members::parse("request", value.get(), Code::BadRequest)
            .map_err(|error| (None, error))?;
        let find = |key| {
            let mut members = members.iter();
            members.find_map(|(name, text)| (name == key).then_some(*text))
        };
        let id = find("id").filter(|text| matches!(kind(text), "a text" | "a number"));
        let bad = |message: String| (id, Refused::new(Code::BadRequest, message));
        let Some(known_id) = id else {
            return Err(bad("expected an \"id\" that is a text or a number".into()));
        };
        let known = |key: &str| matches!(key, "id" | "op" | "args");
        if let Some((name, _)) = members.iter().find(|(name, _)| !known(name)) {
            return Err(bad(format!("unknown key {name:?}: expected id, op, args")));
        }
        match find("op").map(serde_json::from_str) {
            Some(Ok(op)) => Ok(Query {
                id: known_id,
                op,
                args: find("args"),
            }),
            _ => Err(bad("expected an \"op\" that is a text".into())),
        }
    }
}

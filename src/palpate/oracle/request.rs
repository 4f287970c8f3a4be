//! From a line to an op with arguments.

use std::borrow::Cow;

use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;

use super::answer::{Code, Refused};
use super::arguments::object;

/// A line that asks something.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request<'a> {
    /// What the answer repeats.
    pub id: Id<'a>,
    /// The name of the op.
    #[serde(borrow)]
    pub op: Cow<'a, str>,
    /// The JSON text of the arguments, none if the request has no `args`.
    #[serde(borrow, default, deserialize_with = "given")]
    pub args: Option<&'a RawValue>,
}

/// The JSON text of an `id`: a text or a number.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(try_from = "&RawValue")]
pub struct Id<'a>(pub &'a str);

impl<'a> TryFrom<&'a RawValue> for Id<'a> {
    type Error = &'static str;

    fn try_from(value: &'a RawValue) -> Result<Id<'a>, Self::Error> {
        match value.get().as_bytes() {
            [b'"' | b'-' | b'0'..=b'9', ..] => Ok(Id(value.get())),
            _ => Err("`id` must be a text or a number"),
        }
    }
}

/// A value that is there, be it `null`.
fn given<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<&'de RawValue>, D::Error> {
    Deserialize::deserialize(deserializer).map(Some)
}

impl<'a> Request<'a> {
    /// Reads a line.
    ///
    /// # Errors
    /// The id, if it can be read, and what is wrong.
    ///
    /// Implements: ORA-004, ORA-008.
    pub fn parse(line: &'a [u8]) -> Result<Request<'a>, (Option<Id<'a>>, Refused)> {
        /// A request whose other keys are passed over.
        #[derive(Deserialize)]
        struct Identified<'a> {
            #[serde(borrow)]
            id: Id<'a>,
        }
        let bad_json = |why: String| (None, Refused::new(Code::BadJson, why));
        let text = str::from_utf8(line)
            .map_err(|error| bad_json(format!("the line is not UTF-8: {error}")))?;
        object(text).map_err(|error| {
            // What comes before a mistake of syntax has no meaning either.
            if let Err(error) = serde_json::from_str::<&RawValue>(text) {
                return bad_json(format!("the line is not JSON: {error}"));
            }
            let id = object(text).ok().map(|Identified { id }| id);
            let wrong = format_args!("the line is not a request: {error}");
            (id, Refused::new(Code::BadRequest, wrong))
        })
    }
}

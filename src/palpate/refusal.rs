//! Why an input is refused, in one line.

use std::fmt;

use crate::stats::NumericError;

/// Why an input is refused: where it stands, what it is, and what would be right. The message is one line, whatever it quotes.
///
/// Where nothing but the message is of use, this is the error. A reason that a caller branches on has an enum of its own.
///
/// ```
/// use palpate::refusal::Refusal;
///
/// let refusal = Refusal::value("depths_m[0]", -0.001, "at least 0");
/// assert_eq!(refusal.to_string(), "depths_m[0] = -0.001, but must be at least 0");
/// let refusal = Refusal::state("the map is empty", "give at least one row").at(3).in_file("map.csv");
/// assert_eq!(refusal.to_string(), "map.csv:3: the map is empty; give at least one row");
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Refusal {
    /// The file, as its reader named it; empty without a file.
    pub file: String,
    /// The line in it, from 1.
    pub line: Option<usize>,
    /// The key, option or argument; empty where `found` is a sentence.
    pub key: String,
    /// What is there.
    pub found: String,
    /// What the value of `key` must be, or without a key what to do; empty where `found` says all.
    pub remedy: String,
}

impl Refusal {
    /// `key` has the value `found`, but must be `right`.
    pub fn value(
        key: impl Into<String>,
        found: impl fmt::Display,
        right: impl Into<String>,
    ) -> Refusal {
        Refusal {
            key: key.into(),
            found: found.to_string(),
            remedy: right.into(),
            ..Refusal::default()
        }
    }

    /// Something other than a value is wrong, as the sentence `found` says; what to do, in the imperative, or nothing.
    pub fn state(found: impl fmt::Display, remedy: impl Into<String>) -> Refusal {
        Refusal::value("", found, remedy)
    }

    /// The refusal of `what` for a reason, as an argument for `map_err`.
    ///
    /// Implements: REP-004.
    pub fn because<E: fmt::Display>(what: impl fmt::Display) -> impl FnOnce(E) -> Refusal {
        move |reason| Refusal::state(format!("{what}: {reason}"), "")
    }

    /// This refusal as an error where something is so: `Refusal::state("no maps", "").when(maps.is_empty())?`.
    ///
    /// # Errors
    /// Itself, if `is_wrong`.
    pub fn when(self, is_wrong: bool) -> Result<(), Refusal> {
        if is_wrong { Err(self) } else { Ok(()) }
    }

    /// The same in a line, from 1.
    pub fn at(self, line: usize) -> Refusal {
        let line = Some(line);
        Refusal { line, ..self }
    }

    /// The same in a file.
    pub fn in_file(self, file: impl Into<String>) -> Refusal {
        let file = file.into();
        Refusal { file, ..self }
    }

    /// The same for the part `prefix` of a larger whole: its key comes first.
    pub fn under(self, prefix: &str) -> Refusal {
        let key = match &*self.key {
            "" => prefix.into(),
            key => format!("{prefix}.{key}"),
        };
        Refusal { key, ..self }
    }

    /// The same of one of many parts, whose name comes before the message.
    pub fn of_part(self, part: &str) -> Refusal {
        match &*self.key {
            "" => Refusal {
                found: format!("{part}: {}", self.found),
                ..self
            },
            key => Refusal {
                key: format!("{part}: {key}"),
                ..self
            },
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&*self.file, self.line) {
            ("", None) => {}
            ("", Some(line)) => write!(f, "line {line}: ")?,
            (file, None) => write!(f, "{file}: ")?,
            (file, Some(line)) => write!(f, "{file}:{line}: ")?,
        }
        let (equals, before) = match self.key.is_empty() {
            true => ("", "; "),
            false => (" = ", ", but must be "),
        };
        let before = if self.remedy.is_empty() { "" } else { before };
        let parts = [&*self.key, equals, &self.found, before, &self.remedy];
        f.write_str(&one_line(&parts.concat()))
    }
}

impl std::error::Error for Refusal {}

/// A number that the input holds, or that follows from it, is refused.
impl From<NumericError> for Refusal {
    fn from(error: NumericError) -> Refusal {
        Refusal::state(error, "")
    }
}

/// `text` with a space for each control character: a message that quotes a file stays one line, and
/// no terminal obeys it.
pub fn one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// The beginning of `text`, enough to recognise it in a message.
pub fn shortened(text: &str) -> String {
    text.chars().take(80).collect()
}

/// Which of `names` is similar to `word`, in words for the end of a message; nothing if none is.
///
/// Implements: CLI-222.
pub fn did_you_mean<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let alike = |name| (strsim::jaro(word, name), name);
    let nearest = names.into_iter().map(alike);
    match nearest.max_by(|(one, _), (other, _)| one.total_cmp(other)) {
        Some((similarity, name)) if similarity > 0.7 => format!(" (did you mean {name}?)"),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::Refusal;

    // Verifies: CLI-002.
    #[test]
    fn a_refusal_names_the_part_and_the_key_within_it() {
        let keyed = Refusal::value("depth_mm", -1, "above 0").under("inclusion[0]");
        let keyed = keyed.of_part("maps[3]").in_file("bank.json");
        assert_eq!(
            keyed.to_string(),
            "bank.json: maps[3]: inclusion[0].depth_mm = -1, but must be above 0"
        );
        let state = Refusal::state("no rows", "give one").of_part("maps[3]");
        assert_eq!(
            state.at(7).to_string(),
            "line 7: maps[3]: no rows; give one"
        );
    }
}

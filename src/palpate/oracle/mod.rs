//! Questions and answers in lines of JSON, for other implementations to compare with
//! (`spec/oracle.md`).
//!
//! | file | content |
//! |---|---|
//! | `serve.rs` | the loop: lines in, lines out |
//! | `request.rs` | from a line to an op with arguments |
//! | `arguments.rs` | what arguments are made of, each with a message if it is wrong |
//! | `answer.rs` | what an op gives, or why it gives none |
//! | `ops/` | the table of ops, and the ops, a file a topic |

mod answer;
mod arguments;
mod ops;
mod request;
mod serve;
#[cfg(test)]
mod tests;

pub use answer::Code;
use answer::Refused;
use request::{Id, Request};
pub use serve::{LONGEST_LINE, serve};

/// What answers: the ops, and the models that were solved before.
///
/// ```
/// use palpate::oracle::Oracle;
///
/// let mut oracle = Oracle::default();
/// let mut answers = Vec::new();
/// oracle.answer(br#"{"id":1,"op":"two_afc","args":{"gamma":0}}"#, &mut answers);
/// oracle.answer(br#"{"id":2,"op":"two_afc","args":{"gama":0}}"#, &mut answers);
/// let answers = String::from_utf8(answers)?;
/// let lines: Vec<&str> = answers.lines().collect();
/// assert_eq!(lines[0], r#"{"id":1,"ok":{"p_correct":0.5}}"#);
/// assert!(lines[1].starts_with(r#"{"id":2,"error":{"code":"bad_argument""#));
/// # Ok::<(), std::string::FromUtf8Error>(())
/// ```
#[derive(Debug, Default)]
pub struct Oracle {
    /// Models of the built-in phantoms that were asked for, which take long to make.
    models: ops::Models,
}

impl Oracle {
    /// Answers one line, without its end, and appends the answer's line to `out`.
    ///
    /// Implements: ORA-001, ORA-004, ORA-012, ACC-030, ACC-031.
    pub fn answer(&mut self, line: &[u8], out: &mut Vec<u8>) {
        match Request::parse(line) {
            Ok(request) => answer::write(request.id.0, self.perform(&request), out),
            Err((id, refused)) => {
                answer::write(id.map_or("null", |Id(id)| id), Err(refused), out);
            }
        }
    }

    fn perform(&mut self, request: &Request) -> Result<Vec<u8>, Refused> {
        let op = ops::find(&request.op)?;
        let arguments = request.args.map_or("{}", |args| args.get());
        (op.function)(arguments, &mut self.models)
    }
}

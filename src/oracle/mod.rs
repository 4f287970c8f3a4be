//! Questions and answers in lines of JSON, for other implementations to compare with
//! (`spec/oracle.md`).
//!
//! | file | content |
//! |---|---|
//! | `serve.rs` | the loop: lines in, lines out |
//! | `request.rs` | from a line to an op with arguments |
//! | `arguments.rs` | arguments by name, each with a message if it is wrong |
//! | `answer.rs` | what an op gives, and how it is written |
//! | `refusal.rs` | what it gives instead |
//! | `ops/` | the ops, a file a topic |

mod answer;
mod arguments;
mod ops;
pub mod refusal;
mod request;
mod serve;
#[cfg(test)]
mod tests;

use answer::Answer;
use arguments::Arguments;
use refusal::{Code, Refusal};
pub use serve::{LONGEST_LINE, serve};

use request::Request;

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
    /// ```
    /// let mut answer = Vec::new();
    /// palpate::oracle::Oracle::default().answer(b"no JSON", &mut answer);
    /// assert!(answer.starts_with(br#"{"id":null,"error":{"code":"bad_json""#));
    /// assert_eq!(answer.last(), Some(&b'\n'));
    /// ```
    ///
    /// Implements: ORA-001, ORA-004, ORA-006, ORA-012, ACC-030.
    pub fn answer(&mut self, line: &[u8], out: &mut Vec<u8>) {
        match Request::parse(line) {
            Ok(request) => match self.perform(&request) {
                Ok(answer) => answer.write(request.id, out),
                Err(refusal) => refusal.write(request.id, out),
            },
            Err((id, refusal)) => refusal.write(id.unwrap_or("null"), out),
        }
    }

    fn perform(&mut self, request: &Request) -> Result<Answer, Refusal> {
        let op = ops::find(&request.op)?;
        let mut arguments = Arguments::parse(request.args)?;
        // First, since an argument with a wrong name also makes another one missing.
        arguments.check_known(op)?;
        let answer = (op.function)(&mut self.models, &mut arguments)?;
        arguments.check_used(op)?;
        answer.finite()
    }
}

//! The loop: lines in, lines out.

use std::io::{self, ErrorKind, Read, Write};

use super::{Code, Oracle, Refusal};

/// The longest line that is answered, bytes without its end.
///
/// Implements: ORA-007.
pub const LONGEST_LINE: usize = 16 << 20;

/// How much is read and written at once, bytes.
const CHUNK: usize = 64 << 10;

/// Lines as they come in, of which one at a time is kept.
struct Lines<R> {
    input: R,
    /// What was read and not yet given out begins at `start`.
    buffer: Vec<u8>,
    start: usize,
    /// Up to here there is no end of a line.
    searched: usize,
    /// The line at hand is too long, and what was read of it is gone.
    too_long: bool,
    ended: bool,
}

/// What is at hand.
enum Next<'a> {
    /// A line without its end.
    Line(&'a [u8]),
    /// A line that was too long to keep.
    TooLong,
    /// No whole line: there is more to read.
    Wait,
    /// The end of the input.
    End,
}

impl<R: Read> Lines<R> {
    fn new(input: R) -> Lines<R> {
        Lines {
            input,
            buffer: Vec::with_capacity(CHUNK),
            start: 0,
            searched: 0,
            too_long: false,
            ended: false,
        }
    }

    fn next(&mut self) -> Next<'_> {
        let end = self.buffer[self.searched..]
            .iter()
            .position(|&byte| byte == b'\n');
        let (line, after) = match end {
            Some(distance) => {
                let end = self.searched + distance;
                (self.start..end, end + 1)
            }
            // A last line without an end.
            None if self.ended && (self.too_long || self.start < self.buffer.len()) => {
                (self.start..self.buffer.len(), self.buffer.len())
            }
            None if self.ended => return Next::End,
            None => {
                self.searched = self.buffer.len();
                return Next::Wait;
            }
        };
        self.start = after;
        self.searched = after;
        if std::mem::take(&mut self.too_long) || line.len() > LONGEST_LINE {
            return Next::TooLong;
        }
        Next::Line(&self.buffer[line])
    }

    /// Reads more, and waits for it if there is none yet.
    fn fill(&mut self) -> io::Result<()> {
        self.buffer.drain(..self.start);
        self.searched -= self.start;
        self.start = 0;
        if self.buffer.len() > LONGEST_LINE {
            self.buffer.clear();
            self.searched = 0;
            self.too_long = true;
        }
        // What one long line needed is not kept for the short ones.
        if self.buffer.is_empty() && self.buffer.capacity() > 4 * CHUNK {
            self.buffer.shrink_to(CHUNK);
        }
        let filled = self.buffer.len();
        self.buffer.resize(filled + CHUNK, 0);
        let read = loop {
            match self.input.read(&mut self.buffer[filled..]) {
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                result => break result,
            }
        };
        self.buffer.truncate(filled + *read.as_ref().unwrap_or(&0));
        self.ended = read? == 0;
        Ok(())
    }
}

/// Answers every line of `input` on `output`, until the input ends.
///
/// ```
/// use palpate::oracle::serve;
///
/// let questions = "{\"id\":\"a\",\"op\":\"normal_cdf\",\"args\":{\"x\":0}}\n\n";
/// let mut answers = Vec::new();
/// serve(questions.as_bytes(), &mut answers)?;
/// // Every line is answered, the empty one with an error.
/// assert_eq!(answers.split(|&byte| byte == b'\n').count(), 3);
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// What the system said of input or output, a reader who is gone (`BrokenPipe`) included.
///
/// Implements: ORA-001, ORA-003, ORA-007.
pub fn serve(input: impl Read, mut output: impl Write) -> io::Result<()> {
    let mut oracle = Oracle::default();
    let mut lines = Lines::new(input);
    let mut answers = Vec::with_capacity(2 * CHUNK);
    loop {
        match lines.next() {
            Next::Line(line) => oracle.answer(line, &mut answers),
            Next::TooLong => Refusal::new(
                Code::BadJson,
                format!("the line is longer than {LONGEST_LINE} bytes"),
            )
            .write("null", &mut answers),
            Next::Wait => {
                write(&mut output, &mut answers)?;
                lines.fill()?;
            }
            Next::End => return write(&mut output, &mut answers),
        }
        if answers.len() >= CHUNK {
            write(&mut output, &mut answers)?;
        }
    }
}

/// Writes the answers so far.
fn write(output: &mut impl Write, answers: &mut Vec<u8>) -> io::Result<()> {
    output.write_all(answers)?;
    output.flush()?;
    answers.clear();
    answers.shrink_to(2 * CHUNK);
    Ok(())
}

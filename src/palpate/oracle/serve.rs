//! The loop: lines in, lines out.

use std::io::{self, BufRead, BufReader, Read, Write};

use super::Oracle;
use super::answer::{self, Code, Refused};

/// The longest line that is answered, bytes without its end.
///
/// Implements: ORA-007.
pub const LONGEST_LINE: usize = 16 << 20;

/// How much is read and written at once, bytes.
const CHUNK: usize = 64 << 10;

/// Answers every line of `input` on `output`, until the input ends.
///
/// # Errors
/// What the system said of input or output, a reader who is gone (`BrokenPipe`) included.
///
/// Implements: ORA-001, ORA-007.
pub fn serve(input: impl Read, mut output: impl Write) -> io::Result<()> {
    let mut oracle = Oracle::default();
    let mut input = BufReader::with_capacity(CHUNK, input);
    let (mut line, mut answers) = (Vec::new(), Vec::with_capacity(2 * CHUNK));
    loop {
        // Without a whole line at hand, the next read may wait.
        if answers.len() >= CHUNK || !input.buffer().contains(&b'\n') {
            write(&mut output, &mut answers)?;
        }
        line.clear();
        // What one long line needed is not kept for the short ones.
        line.shrink_to(CHUNK);
        let longest = LONGEST_LINE as u64 + 1;
        if input.by_ref().take(longest).read_until(b'\n', &mut line)? == 0 {
            return write(&mut output, &mut answers);
        }
        let whole = line.pop_if(|byte| *byte == b'\n').is_some();
        if line.len() <= LONGEST_LINE {
            oracle.answer(&line, &mut answers);
            if whole {
                continue;
            }
            // A last line without an end.
            return write(&mut output, &mut answers);
        }
        if !whole {
            input.skip_until(b'\n')?;
        }
        let too_long = format_args!("the line is longer than {LONGEST_LINE} bytes");
        let refused = Refused::new(Code::BadJson, too_long);
        answer::write("null", Err(refused), &mut answers);
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

//! The program that is asked.

use std::ffi::OsString;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use super::text::cut;

/// The longest answer that is read, bytes.
const LONGEST_ANSWER: u64 = 64 << 20;
/// The longest line of standard error that is kept, bytes; a longer one is split.
const LONGEST_WORDS: u64 = 4096;

/// What came from the program.
#[derive(Debug)]
pub enum Event {
    /// A line, without its end.
    Line(Vec<u8>),
    /// It closed its output.
    End,
    /// Nothing, until the deadline.
    Silence,
}

/// A running program.
pub struct Partner {
    child: Child,
    /// Requests for the thread that writes them; its end closes the program's input.
    requests: Option<Sender<String>>,
    lines: Receiver<Vec<u8>>,
    /// The last line of standard error that is not blank.
    last_words: Arc<Mutex<String>>,
}

impl Partner {
    /// Starts a program. Threads write its input and read its output, so that neither side waits for a full pipe.
    ///
    /// # Errors
    /// The system's error.
    pub fn start(command: &[OsString]) -> io::Result<Partner> {
        let (program, arguments) = command.split_first().ok_or(io::ErrorKind::NotFound)?;
        let mut child = Command::new(program)
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        let (requests, to_write) = channel::<String>();
        // A program that floods its output waits, instead of filling the memory.
        let (found, lines) = sync_channel(1024);
        let last_words = Arc::new(Mutex::new(String::new()));
        if let Some(mut input) = child.stdin.take() {
            thread::spawn(move || {
                to_write
                    .iter()
                    .try_for_each(|line| input.write_all(line.as_bytes()))
            });
        }
        if let Some(output) = child.stdout.take() {
            thread::spawn(move || {
                lines_of(output, LONGEST_ANSWER).try_for_each(|line| found.send(line))
            });
        }
        if let Some(errors) = child.stderr.take() {
            let last_words = last_words.clone();
            thread::spawn(move || {
                for line in lines_of(errors, LONGEST_WORDS) {
                    let line = String::from_utf8_lossy(&line);
                    if let (false, Ok(mut last)) = (line.trim().is_empty(), last_words.lock()) {
                        *last = cut(line.trim());
                    }
                }
            });
        }
        Ok(Partner {
            child,
            requests: Some(requests),
            lines,
            last_words,
        })
    }

    /// Sends a request. If the program does not read it, that is no error here: its answer will be missing.
    pub fn ask(&self, line: String) {
        if let Some(requests) = &self.requests {
            let _ = requests.send(line);
        }
    }

    /// The next line, the end, or silence until `deadline`.
    pub fn next(&self, deadline: Instant) -> Event {
        let left = deadline.saturating_duration_since(Instant::now());
        match self.lines.recv_timeout(left) {
            Ok(line) => Event::Line(line),
            Err(RecvTimeoutError::Timeout) => Event::Silence,
            Err(RecvTimeoutError::Disconnected) => Event::End,
        }
    }

    /// Ends the program's input, waits for the program, and kills it if it takes too long. Returns how it ended, with the last line of
    /// its standard error.
    pub fn end(mut self, patience: Duration) -> String {
        self.requests = None;
        let deadline = Instant::now() + patience;
        let status = loop {
            match self.child.try_wait() {
                Ok(Some(status)) => break status.to_string(),
                Ok(None) if Instant::now() < deadline => thread::sleep(Duration::from_millis(2)),
                _ => {
                    let _ = self.child.kill();
                    let _ = self.child.wait();
                    break "it was ended by force".into();
                }
            }
        };
        // What the program said just before its end is still on the way.
        thread::sleep(Duration::from_millis(10));
        match self.last_words.lock() {
            Ok(words) if !words.is_empty() => format!("{status}; standard error: {words}"),
            _ => status,
        }
    }
}

impl Drop for Partner {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The lines of a stream, without their ends.
fn lines_of(stream: impl Read, longest: u64) -> impl Iterator<Item = Vec<u8>> {
    let mut stream = BufReader::new(stream);
    std::iter::from_fn(move || {
        let mut line = Vec::new();
        let mut rest = stream.by_ref().take(longest);
        let length = rest.read_until(b'\n', &mut line).ok()?;
        line.pop_if(|last| *last == b'\n');
        (length > 0).then_some(line)
    })
}

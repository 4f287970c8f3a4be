//! The program that is asked.

use std::collections::VecDeque;
use std::ffi::OsString;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use super::text::cut;

/// The longest answer that is read, bytes.
const LONGEST_ANSWER: u64 = 64 << 20;
/// How much of standard error is kept, bytes.
const STDERR_KEPT: usize = 4096;

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

/// A program that runs.
pub struct Partner {
    child: Child,
    /// Requests for the thread that writes them; its end closes the program's input.
    requests: Option<Sender<Vec<u8>>>,
    lines: Receiver<Vec<u8>>,
    stderr: Arc<Mutex<VecDeque<u8>>>,
}

impl Partner {
    /// Starts a program. Its input is written and its output read by threads of their own, so that
    /// neither side waits for a full pipe.
    ///
    /// # Errors
    /// What the system says.
    pub fn start(command: &[OsString]) -> io::Result<Partner> {
        let (program, arguments) = command.split_first().ok_or(io::ErrorKind::NotFound)?;
        let mut child = Command::new(program)
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        let (requests, to_write) = channel();
        // A program that floods its output waits, instead of filling the memory.
        let (found, lines) = sync_channel(1024);
        let stderr = Arc::new(Mutex::new(VecDeque::new()));
        if let Some(input) = child.stdin.take() {
            thread::spawn(move || write_requests(input, &to_write));
        }
        if let Some(output) = child.stdout.take() {
            thread::spawn(move || read_lines(output, &found));
        }
        if let Some(errors) = child.stderr.take() {
            let kept = stderr.clone();
            thread::spawn(move || keep_last(errors, &kept));
        }
        let requests = Some(requests);
        Ok(Partner {
            child,
            requests,
            lines,
            stderr,
        })
    }

    /// Hands over a request line. One that the program does not read is no error here: its answer
    /// will be missing.
    pub fn ask(&self, line: Vec<u8>) {
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

    /// Ends the program's input, waits for it, and ends it by force if it takes too long. Says how
    /// it ended, with the end of what it said on standard error.
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
        match self.last_words() {
            Some(words) => format!("{status}; standard error: {words}"),
            None => status,
        }
    }

    /// The last line of standard error.
    fn last_words(&self) -> Option<String> {
        // What the program said just before its end is still on the way.
        thread::sleep(Duration::from_millis(10));
        let kept = self.stderr.lock().ok()?;
        let bytes: Vec<u8> = kept.iter().copied().collect();
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let line = text.lines().rev().find(|line| !line.trim().is_empty())?;
        Some(cut(line.trim()))
    }
}

impl Drop for Partner {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Writes the requests until the program reads no more; closes the input when nothing follows.
fn write_requests(mut input: ChildStdin, requests: &Receiver<Vec<u8>>) {
    for line in requests {
        if input.write_all(&line).is_err() {
            return;
        }
    }
}

fn read_lines(output: ChildStdout, lines: &SyncSender<Vec<u8>>) {
    let mut output = BufReader::new(output);
    let mut next = || {
        let mut line = Vec::new();
        let mut answer = output.by_ref().take(LONGEST_ANSWER);
        let length = answer.read_until(b'\n', &mut line).ok()?;
        line.pop_if(|last| *last == b'\n');
        (length > 0).then_some(line)
    };
    while let Some(line) = next()
        && lines.send(line).is_ok()
    {}
}

fn keep_last(mut errors: ChildStderr, kept: &Mutex<VecDeque<u8>>) {
    let mut buffer = [0; 1024];
    while let Ok(read @ 1..) = errors.read(&mut buffer) {
        let Ok(mut kept) = kept.lock() else { return };
        kept.extend(&buffer[..read]);
        let excess = kept.len().saturating_sub(STDERR_KEPT);
        kept.drain(..excess);
    }
}

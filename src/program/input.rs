//! Standard input, line by line.

use std::io::{self, BufRead, Read, stdin};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

/// What is read as one line at most, bytes.
const LONGEST_LINE: u64 = 1 << 16;
/// Lines that wait at most: beyond, the writer waits.
const WAITING: usize = 1024;
/// How long a signal waits at most.
const LOOK: Duration = Duration::from_millis(20);

/// The lines of standard input, which another thread reads, so that a signal need not wait for the next one.
pub(super) fn lines() -> Receiver<io::Result<String>> {
    let (to, lines) = sync_channel(WAITING);
    thread::spawn(move || {
        let (mut input, mut line) = (stdin().lock(), Vec::new());
        loop {
            line.clear();
            let read = input
                .by_ref()
                .take(LONGEST_LINE)
                .read_until(b'\n', &mut line);
            let text = read.map(|_| String::from_utf8_lossy(&line).into_owned());
            let is_end = text.as_ref().is_ok_and(String::is_empty);
            if is_end || to.send(text).is_err() {
                break;
            }
        }
    });
    lines
}

/// The next line; none at the end of the input, or after a signal.
pub(super) fn next(
    lines: &Receiver<io::Result<String>>,
    stop: &AtomicBool,
) -> Option<io::Result<String>> {
    while !stop.load(Ordering::Relaxed) {
        match lines.recv_timeout(LOOK) {
            Err(RecvTimeoutError::Timeout) => {}
            line => return line.ok(),
        }
    }
    None
}

//! Bytes of a pipe, read by the loop itself: a thread between would cost a second wake-up in each cycle.

use std::io::{ErrorKind, Result};
use std::os::fd::AsFd;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};

/// What can be waited for and read: a pipe, standard input.
pub trait Input: AsFd {}

impl<R: AsFd> Input for R {}

/// An input whose bytes can be waited for.
pub struct Source<R>(R);

impl<R: Input> Source<R> {
    /// A source of the bytes of `input`, which nothing else has read ahead.
    pub fn new(input: R) -> Source<R> {
        Source(input)
    }

    /// Reads what has come into `bytes`, and waits up to `timeout` for it if nothing has; how many bytes, 0 at the end of the input.
    /// `None` if nothing came, or a signal interrupted.
    pub fn read(&mut self, bytes: &mut [u8], timeout: Option<Duration>) -> Result<Option<usize>> {
        let timeout = timeout.and_then(|time| Timespec::try_from(time).ok());
        let read = poll(&mut [PollFd::new(&self.0, PollFlags::IN)], timeout.as_ref());
        let read = read.and_then(|ready| match ready {
            0 => Ok(None),
            _ => rustix::io::read(&self.0, bytes).map(Some),
        });
        match read.map_err(std::io::Error::from) {
            Err(error) if error.kind() == ErrorKind::Interrupted => Ok(None),
            read => read,
        }
    }
}

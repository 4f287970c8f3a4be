//! Bytes of a pipe where a system cannot wait for them with a time limit: a thread reads them.

use std::io::{Read, Result};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread::spawn;
use std::time::Duration;

/// What one read of the thread brings at most: fewer bytes than reports leave room for.
const CHUNK: usize = 1024;

/// What a thread can read.
pub trait Input: Read + Send + 'static {}

impl<R: Read + Send + 'static> Input for R {}

/// An input whose bytes can be waited for.
pub struct Source<R> {
    chunks: Receiver<Result<([u8; CHUNK], usize)>>,
    input: std::marker::PhantomData<R>,
}

impl<R: Input> Source<R> {
    /// A source of the bytes of `input`.
    pub fn new(mut input: R) -> Source<R> {
        let (sender, chunks) = sync_channel(super::PIPE / CHUNK);
        spawn(move || {
            loop {
                let mut bytes = [0; CHUNK];
                let read = input.read(&mut bytes).map(|count| (bytes, count));
                let is_last = !matches!(read, Ok((_, 1..)));
                if sender.send(read).is_err() || is_last {
                    return;
                }
            }
        });
        let input = std::marker::PhantomData;
        Source { chunks, input }
    }

    /// Reads what has come into `bytes`, and waits up to `timeout` for it if nothing has; how many bytes, 0 at the end of the input.
    /// `None` if nothing came.
    pub fn read(&mut self, bytes: &mut [u8], timeout: Option<Duration>) -> Result<Option<usize>> {
        let timeout = timeout.unwrap_or(Duration::MAX);
        let mut read = match self.chunks.recv_timeout(timeout) {
            Ok(read) => read?,
            Err(RecvTimeoutError::Timeout) => return Ok(None),
            // The input ended behind bytes that came with others.
            Err(RecvTimeoutError::Disconnected) => return Ok(Some(0)),
        };
        let mut total = 0;
        loop {
            let (chunk, count) = read;
            bytes[total..][..count].copy_from_slice(&chunk[..count]);
            total += count;
            // All that waits, but for what tells the end.
            match (bytes.len() - total >= CHUNK).then(|| self.chunks.try_recv()) {
                Some(Ok(Ok(next))) => read = next,
                _ => return Ok(Some(total)),
            }
        }
    }
}

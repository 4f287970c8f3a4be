//! A digest of texts. The text of a number in Rust (`{:?}`) is the shortest that gives its bits back, so that it is one of bits.

use core::fmt::{self, Write};

/// The digest of what is written to it (FNV-1a). No change of a single byte is lost: each step maps digests one to one.
///
/// Implements: FIR-012.
#[derive(Debug, Clone, Copy)]
pub struct Digest(pub u64);

impl Default for Digest {
    fn default() -> Digest {
        Digest(0xCBF2_9CE4_8422_2325)
    }
}

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3);
        }
        Ok(())
    }
}

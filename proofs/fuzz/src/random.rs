//! Cases without a fuzzer: seeds with a few changes, the same in every run.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// What readers stumble over, with bars between.
const TOKENS: &[u8] =
    b"\0|\r|\n|\r\n|\xEF\xBB\xBF|\xFF|\x1B[2J|,|;|\t|:|\"|[|]|{|}|=|#| |-|-0|0|1|9|.5|\
    1e999999999|1e-999999999|1e308|5e-324|nan|inf|null|18446744073709551616|\xC2\x85|\
    \xE2\x80\xA8|0:1e5:1e-9|999999999999";

/// The inputs that are kept for a target, by their names in its archive: its `corpus`, and the `crashes` that once broke it.
///
/// # Panics
/// If the archive cannot be read or is empty.
pub fn kept(target: &str) -> BTreeMap<String, Vec<u8>> {
    let corpora = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpora");
    let file = File::open(corpora.join(target).with_extension("tar")).expect("an archive");
    let mut archive = tar::Archive::new(file);
    let entries = archive.entries().expect("an archive").map(|entry| {
        let mut entry = entry.expect("an entry");
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).expect("the bytes of a file");
        let name = entry.path().expect("a path").display().to_string();
        (name, bytes)
    });
    let kept: BTreeMap<_, _> = entries.collect();
    assert!(!kept.is_empty(), "no corpus of {target}");
    kept
}

/// A counter-based sequence of numbers: SplitMix64 (Steele, Lea, Flood 2014).
#[derive(Debug)]
pub struct Random(u64);

impl Random {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// A number below `bound`, which is above 0; uniform but for 2⁻⁵⁰ for the small bounds here.
    pub fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let word = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let word = (word ^ (word >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((word ^ (word >> 31)) % bound as u64) as usize
    }
}

/// One of `seeds` with one to three changes, mostly one.
pub fn changed(seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut bytes = seeds[random.below(seeds.len())].clone();
    for _ in 0..=random.below(2) * random.below(3) {
        let (from, to) = range(&bytes, random);
        match random.below(6) {
            0 => {
                if let Some(byte) = bytes.get_mut(from) {
                    *byte ^= 1 << random.below(8);
                }
            }
            1 => bytes.truncate(from.max(1)),
            2 => drop(bytes.drain(from..to)),
            3 => {
                let again = bytes[from..to].to_vec();
                bytes.splice(to..to, again);
            }
            4 => {
                let tokens: Vec<_> = TOKENS.split(|byte| *byte == b'|').collect();
                let token = tokens[random.below(tokens.len())];
                bytes.splice(from..from, token.iter().copied());
            }
            _ => {
                let other = &seeds[random.below(seeds.len())];
                let (first, last) = range(other, random);
                bytes.splice(from..to, other[first..last].iter().copied());
            }
        }
    }
    bytes
}

/// A range of at most 16 bytes.
fn range(bytes: &[u8], random: &mut Random) -> (usize, usize) {
    let from = random.below(bytes.len() + 1);
    let to = (from + random.below(17)).min(bytes.len());
    (from, to)
}

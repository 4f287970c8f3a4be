//! The cases that `vectors.py` has written, asked and compared word by word.

use core::fmt::Write;

mod ops;

/// The groups, by the number of the op. The last four ops are the criteria of one.
const GROUPS: [&str; 15] = [
    "servo_axis",
    "servo_interpolate",
    "report_decode",
    "report_encode",
    "normal_cdf",
    "normal_quantile",
    "error_rates",
    "required_gamma",
    "two_afc",
    "gamma_from_two_afc",
    "chi_square_tail",
    "f_tail",
    "student_tail",
    "theta",
    "threshold",
];

/// At the head of the file.
const MAGIC: u32 = 0x5041_4C50;

/// The most words of a list: one knot more than the kernel takes.
const MOST: usize = 1025;
/// The most words of an answer.
const ANSWER: usize = 17;

/// Why there is no answer.
enum Failure {
    /// `palpate` refuses the question.
    Refused,
    /// The table breaks off, or has other lists than the op asks for.
    Table,
}

fn refused<T, E>(answer: Result<T, E>) -> Result<T, Failure> {
    answer.map_err(|_| Failure::Refused)
}

/// A file of words, read from the front.
struct Words<'a>(&'a [u8]);

impl<'a> Words<'a> {
    fn next(&mut self) -> Result<u32, Failure> {
        let (word, rest) = self.0.split_first_chunk().ok_or(Failure::Table)?;
        self.0 = rest;
        Ok(u32::from_le_bytes(*word))
    }

    fn list(&mut self) -> Result<Words<'a>, Failure> {
        self.lists(1).map(|Words(list)| Words(&list[4..]))
    }

    /// The next lists, with their lengths.
    fn lists(&mut self, count: u32) -> Result<Words<'a>, Failure> {
        let before = self.0;
        for _ in 0..count {
            let length = self.next()? as usize;
            let list = self.0.split_at_checked(4 * length);
            self.0 = list.ok_or(Failure::Table)?.1;
        }
        Ok(Words(&before[..before.len() - self.0.len()]))
    }

    fn length(&self) -> usize {
        self.0.len() / 4
    }
}

/// Room for the numbers of a list.
struct Room<T>([T; MOST]);

impl<T: Copy> Room<T> {
    fn of(nothing: T) -> Self {
        Room([nothing; MOST])
    }

    /// The list in `words`, each entry as `entry` reads it.
    fn filled(
        &mut self,
        mut words: Words,
        entry: impl Fn(&mut Words) -> Result<T, Failure>,
    ) -> Result<&[T], Failure> {
        let mut length = 0;
        while words.length() > 0 {
            *self.0.get_mut(length).ok_or(Failure::Table)? = entry(&mut words)?;
            length += 1;
        }
        Ok(&self.0[..length])
    }
}

fn single(words: &mut Words) -> Result<f32, Failure> {
    words.next().map(f32::from_bits)
}

fn double(words: &mut Words) -> Result<f64, Failure> {
    let [low, high] = [words.next()?, words.next()?].map(u64::from);
    Ok(f64::from_bits(high << 32 | low))
}

/// The words of an answer; none for a refusal.
#[derive(Default)]
struct Answer {
    words: [u32; ANSWER],
    length: usize,
}

impl Answer {
    fn push(&mut self, word: u32) {
        self.words[self.length] = word;
        self.length += 1;
    }

    fn doubles(&mut self, values: &[f64]) {
        for value in values {
            self.push(value.to_bits() as u32);
            self.push((value.to_bits() >> 32) as u32);
        }
    }

    fn words(&self) -> &[u32] {
        &self.words[..self.length]
    }
}

/// One case: its group, and whether it must be refused. Wrong answers are told in `text`.
fn case(words: &mut Words, text: &mut impl Write) -> Result<(usize, bool, bool), Failure> {
    let [op, number, count] = [words.next()?, words.next()?, words.next()?];
    let mut lists = words.lists(count)?;
    let expected = words.list()?;
    let must_refuse = expected.length() == 0;
    let right = match ops::ask(op, &mut lists) {
        Ok(answer) => expected
            .0
            .as_chunks()
            .0
            .iter()
            .map(|&word| u32::from_le_bytes(word))
            .eq(answer.words().iter().copied()),
        Err(Failure::Refused) => must_refuse,
        Err(Failure::Table) => return Err(Failure::Table),
    };
    let group = GROUPS.len().min(op as usize + 1) - 1;
    if !right {
        let _ = writeln!(text, "{}-{number:03}: wrong", GROUPS[group]); // text that is lost changes no verdict
    }
    Ok((group, must_refuse, right))
}

/// Asks all cases of the table in `bytes` and tells how many of each group were answered and refused, as they must be. False if
/// one was not, or the table is broken.
///
/// Implements: FIR-001, FIR-004.
pub fn all(bytes: &[u8], text: &mut impl Write) -> bool {
    let mut words = Words(bytes);
    let mut counts = [[0_u32; 2]; GROUPS.len()];
    let mut right = true;
    let asked = (|| {
        if words.next()? != MAGIC {
            return Err(Failure::Table);
        }
        for _ in 0..words.next()? {
            let (group, must_refuse, as_expected) = case(&mut words, text)?;
            counts[group][usize::from(must_refuse)] += 1;
            right &= as_expected;
        }
        Ok(())
    })();
    for (group, [answered, refused]) in GROUPS.iter().zip(counts) {
        let _ = writeln!(text, "{group}: {answered} answered, {refused} refused");
    }
    if asked.is_err() {
        let _ = writeln!(
            text,
            "the table breaks off or asks what this program does not know"
        );
    }
    right && asked.is_ok()
}

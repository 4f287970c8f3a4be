//! A journal on a disk that fails: the model knows what writers were told, and nothing else.

use super::*;
use palpate_asserts::{assert_error, seeded};
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use std::cell::RefCell;
use std::io::{Read, Write};
use std::rc::Rc;

/// What one file is on a disk.
#[derive(Default)]
struct Disk {
    /// As each process sees it.
    seen: Vec<u8>,
    /// As it is after a power cut that loses all that may be lost.
    durable: Vec<u8>,
    /// What was called since the last sync, in its order; a power cut keeps the beginning of it.
    pending: Vec<Call>,
    is_full: bool,
    is_locked: bool,
    fails: Option<Fault>,
}

#[derive(Clone)]
enum Call {
    Cut(usize),
    Put(usize, u8),
}

/// A call that fails, once.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    Read,
    Cut,
    /// A write, after so many bytes of the line.
    Write(usize),
    /// The system keeps what it could not bring to the disk, or forgets it.
    Sync {
        forgets: bool,
    },
}

impl Disk {
    fn call(&mut self, call: Call) {
        apply(&mut self.seen, &call);
        self.pending.push(call);
    }

    /// Whether this fault was planted; it happens once.
    fn has(&mut self, fault: Fault) -> io::Result<()> {
        match self.fails == Some(fault) {
            true => Err(self.failure()),
            false => Ok(()),
        }
    }

    fn failure(&mut self) -> io::Error {
        self.fails = None;
        io::ErrorKind::StorageFull.into()
    }

    /// The power fails; of what is pending, the disk keeps the first calls.
    fn cut_power(&mut self, kept: usize) {
        let kept = kept.min(self.pending.len());
        let kept: Vec<Call> = self.pending.drain(..).take(kept).collect();
        kept.iter().for_each(|call| apply(&mut self.durable, call));
        self.seen = self.durable.clone();
    }
}

fn apply(bytes: &mut Vec<u8>, call: &Call) {
    match *call {
        Call::Cut(length) => bytes.resize(length, 0),
        Call::Put(place, byte) => {
            bytes.resize(bytes.len().max(place + 1), 0);
            bytes[place] = byte;
        }
    }
}

/// The file, as one process has it open.
struct Open {
    disk: Rc<RefCell<Disk>>,
    place: usize,
    has_lock: RefCell<bool>,
}

impl Open {
    fn new(disk: &Rc<RefCell<Disk>>) -> Open {
        let (disk, has_lock) = (Rc::clone(disk), RefCell::new(false));
        Open {
            disk,
            place: 0,
            has_lock,
        }
    }
}

impl Drop for Open {
    fn drop(&mut self) {
        if self.has_lock.take() {
            self.disk.borrow_mut().is_locked = false;
        }
    }
}

impl Read for Open {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let mut disk = self.disk.borrow_mut();
        disk.has(Fault::Read)?;
        let rest = &disk.seen[self.place.min(disk.seen.len())..];
        let count = rest.len().min(bytes.len()).min(11);
        bytes[..count].copy_from_slice(&rest[..count]);
        self.place += count;
        Ok(count)
    }
}

impl Write for Open {
    /// At most seven bytes at a time.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut disk = self.disk.borrow_mut();
        let room = match disk.fails {
            _ if disk.is_full => 0,
            Some(Fault::Write(room)) => room,
            _ => usize::MAX,
        };
        if room == 0 {
            return Err(disk.failure());
        }
        let count = bytes.len().min(7).min(room);
        if let Some(Fault::Write(room)) = &mut disk.fails {
            *room -= count;
        }
        for byte in &bytes[..count] {
            disk.call(Call::Put(self.place, *byte));
            self.place += 1;
        }
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl io::Seek for Open {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let end = self.disk.borrow().seen.len() as i64;
        self.place = match to {
            SeekFrom::Start(place) => place as usize,
            SeekFrom::Current(by) => (self.place as i64 + by) as usize,
            SeekFrom::End(by) => (end + by) as usize,
        };
        Ok(self.place as u64)
    }
}

impl Store for Open {
    fn set_len(&self, length: u64) -> io::Result<()> {
        let mut disk = self.disk.borrow_mut();
        disk.has(Fault::Cut)?;
        disk.call(Call::Cut(length as usize));
        Ok(())
    }

    fn sync_data(&self) -> io::Result<()> {
        let mut disk = self.disk.borrow_mut();
        disk.has(Fault::Sync { forgets: false })?;
        if let Err(error) = disk.has(Fault::Sync { forgets: true }) {
            disk.cut_power(0);
            return Err(error);
        }
        disk.cut_power(usize::MAX);
        Ok(())
    }

    fn try_lock(&self) -> Result<(), TryLockError> {
        let mut disk = self.disk.borrow_mut();
        if disk.is_locked {
            return Err(TryLockError::WouldBlock);
        }
        (disk.is_locked, *self.has_lock.borrow_mut()) = (true, true);
        Ok(())
    }
}

const REQUEST: &str = "{\"schema\":\"job\",\"seed\":1}\n";

/// What a process finds that opens the file, and what it may append.
fn open(disk: &Rc<RefCell<Disk>>) -> Result<(Lines<Open>, Vec<String>), Refusal> {
    let mut found = Vec::new();
    let take = |line: &str| {
        found.push(line.to_string());
        Ok(())
    };
    let lines = Lines::open(Open::new(disk), "f".into(), REQUEST, "job", take);
    lines.map(|lines| (lines, found))
}

/// What may happen to a job.
#[derive(Debug, Clone)]
enum Event {
    /// A process of either writer begins, or its other one ends and this begins.
    Open(usize),
    /// It appends one of the parts that are left, with a text of this length behind its number.
    Append(usize, usize, usize),
    /// A process is killed; so are all, and the power fails.
    Kill(usize),
    CutPower(usize),
    Plant(Fault),
    Fill,
    MakeSpace,
}

fn fault() -> impl Strategy<Value = Fault> {
    prop_oneof![
        Just(Fault::Read),
        Just(Fault::Cut),
        (0..40usize).prop_map(Fault::Write),
        any::<bool>().prop_map(|forgets| Fault::Sync { forgets }),
    ]
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        4 => (0..2usize).prop_map(Event::Open),
        8 => (0..2usize, 0..PARTS, 0..30usize).prop_map(|(who, part, length)| Event::Append(who, part, length)),
        1 => (0..2usize).prop_map(Event::Kill),
        2 => (0..60usize).prop_map(Event::CutPower),
        4 => fault().prop_map(Event::Plant),
        1 => Just(Event::Fill),
        2 => Just(Event::MakeSpace),
    ]
}

/// The parts of a job.
const PARTS: usize = 12;

/// What the writers of a job know: the lines that they were told are written, in their order, and all that one began to write.
#[derive(Default)]
struct Job {
    disk: Rc<RefCell<Disk>>,
    writers: [Option<Lines<Open>>; 2],
    told: Vec<String>,
    tried: Vec<String>,
}

impl Job {
    fn step(&mut self, event: Event) -> TestCaseResult {
        match event {
            Event::Open(who) => self.open(who)?,
            Event::Append(who, part, length) => self.append(who, part, length)?,
            Event::Kill(who) => self.writers[who] = None,
            Event::CutPower(kept) => {
                self.writers = [None, None];
                self.disk.borrow_mut().cut_power(kept);
            }
            Event::Plant(fault) => self.disk.borrow_mut().fails = Some(fault),
            Event::Fill => self.disk.borrow_mut().is_full = true,
            Event::MakeSpace => self.disk.borrow_mut().is_full = false,
        }
        Ok(())
    }

    fn open(&mut self, who: usize) -> TestCaseResult {
        self.writers[who] = None;
        let before = self.disk.borrow().seen.clone();
        let opened = open(&self.disk);
        if self.writers[1 - who].is_some() {
            let told = opened.err().expect("a second writer is refused");
            prop_assert_eq!(
                told.to_string(),
                "f: another 'job' is writing this file; wait until it ends"
            );
            prop_assert_eq!(&before, &self.disk.borrow().seen);
            return Ok(());
        }
        match opened {
            Ok((lines, found)) => {
                // All that a writer was told, in that order, and at most the one line behind it whose writer knows of no success.
                prop_assert!(found.starts_with(&self.told), "{found:?} {:?}", self.told);
                prop_assert!(found.len() <= self.told.len() + 1, "{found:?}");
                prop_assert!(found.iter().all(|line| self.tried.contains(line)));
                let mut parts: Vec<&str> = found.iter().map(|line| part_of(line)).collect();
                parts.sort_unstable();
                parts.dedup();
                prop_assert_eq!(parts.len(), found.len(), "twice: {:?}", found);
                (self.told, self.writers[who]) = (found, Some(lines));
            }
            Err(error) => self.is_told(&error.to_string())?,
        }
        Ok(())
    }

    /// An error names the file; there is a reason for it.
    fn is_told(&self, error: &str) -> TestCaseResult {
        let is_told = ["read f: ", "write f: "]
            .iter()
            .any(|words| error.starts_with(words));
        prop_assert!(is_told, "{}", error);
        let disk = self.disk.borrow();
        prop_assert!(disk.fails.is_none(), "no fault has happened: {error}");
        Ok(())
    }

    fn append(&mut self, who: usize, part: usize, length: usize) -> TestCaseResult {
        let is_done = |line: &String| part_of(line) == part.to_string();
        let Some(lines) = &mut self.writers[who] else {
            return Ok(());
        };
        if self.told.iter().any(is_done) {
            return Ok(());
        }
        let line = format!("{part}{}", "x".repeat(length));
        let fails = match self.disk.borrow().fails {
            Some(Fault::Write(room)) => room <= line.len(),
            Some(Fault::Cut | Fault::Sync { .. }) => true,
            _ => false,
        };
        let fails = fails || self.disk.borrow().is_full;
        let told = lines.append(&format!("{line}\n"));
        self.tried.push(line.clone());
        prop_assert_eq!(told.is_err(), fails, "{:?}", told);
        match told {
            Ok(()) => self.told.push(line),
            Err(error) => self.is_told(&error.to_string())?,
        }
        Ok(())
    }

    /// The disk is sound again: a process ends the job.
    fn end(&mut self) -> TestCaseResult {
        let disk = &self.disk;
        (disk.borrow_mut().fails, disk.borrow_mut().is_full) = (None, false);
        self.writers = [None, None];
        self.open(0)?;
        for part in 0..PARTS {
            self.append(0, part, part)?;
        }
        prop_assert_eq!(self.told.len(), PARTS);
        self.step(Event::CutPower(0))?;
        let text = format!("{REQUEST}{}\n", self.told.join("\n"));
        prop_assert_eq!(&self.disk.borrow().seen, text.as_bytes());
        Ok(())
    }
}

/// The number of a part, as its line has it.
fn part_of(line: &str) -> &str {
    line.trim_end_matches('x')
}

proptest! {
    #![proptest_config(seeded(20_261_125))]

    // Two writers of a job of 12 parts, which are killed and begin again; a disk that fails at any call, is full, forgets what it could
    // not write, and after a power cut holds any beginning of what was not synced.
    // Verifies: CLI-156, CLI-157, STU-024.
    #[test]
    fn no_part_is_lost_or_there_twice_whatever_fails(events in prop::collection::vec(event(), 60)) {
        let mut job = Job::default();
        for event in events {
            job.step(event)?;
        }
        job.end()?;
    }
}

// Verifies: CLI-156, STU-024.
#[test]
fn a_line_that_was_half_written_leaves_no_hole_before_the_next() {
    let disk = Rc::default();
    let (mut lines, _) = open(&disk).unwrap();
    lines.append("1\n").unwrap();
    for fails in [
        Fault::Write(0),
        Fault::Write(5),
        Fault::Write(8),
        Fault::Sync { forgets: false },
        Fault::Cut,
    ] {
        disk.borrow_mut().fails = Some(fails);
        let told = lines.append("2xxxxxxx\n");
        assert_error(told, "write f: no storage space");
        assert_eq!(lines.whole, REQUEST.len() as u64 + 2, "{fails:?}");
    }
    lines.append("3\n").unwrap();
    assert_eq!(disk.borrow().durable, format!("{REQUEST}1\n3\n").as_bytes());
}

// Verifies: CLI-157.
#[test]
fn a_file_that_another_process_writes_is_refused_and_stays() {
    let path = std::env::temp_dir().join(format!("palpate-journal-two-{}", std::process::id()));
    let open = || Journal::open(path.clone(), &"request", "test", |_| Ok(()));
    let journal = open().unwrap();
    journal.append(&1).unwrap();
    assert_error(
        open(),
        &format!(
            "{}: another 'test' is writing this file; wait until it ends",
            path.display()
        ),
    );
    journal.append(&2).unwrap();
    assert_eq!(
        std::fs::read_to_string(&path).unwrap(),
        "\"request\"\n1\n2\n"
    );
    drop(journal);
    open().unwrap().remove().unwrap();
    assert!(!path.exists());
}

// Verifies: CLI-157.
#[test]
fn a_line_that_is_refused_has_its_number_in_the_file() {
    let path = std::env::temp_dir().join(format!("palpate-journal-{}", std::process::id()));
    let open = |wrong: &str| {
        Journal::open(path.clone(), &"request", "test", |line| {
            Refusal::state("wrong", "").when(line == wrong)
        })
    };
    let journal = open("").unwrap();
    journal.append(&1).unwrap();
    journal.append(&2).unwrap();
    drop(journal);
    for (wrong, number) in [("1", 2), ("2", 3)] {
        let error = open(wrong).unwrap_err().to_string();
        assert_eq!(error, format!("{}:{number}: wrong", path.display()));
    }
    std::fs::remove_file(path).unwrap();
}

// Verifies: CLI-157.
#[test]
fn lines_are_counted_beyond_16_bits() {
    let text = "1\n".repeat(1 << 16) + "not one\nrest";
    let mut taken = 0;
    let refused = take_lines(text.as_bytes(), Path::new("f"), 2, |line| {
        taken += 1;
        Refusal::state("wrong", "").when(line != "1")
    });
    assert_eq!(
        (refused.unwrap_err().to_string(), taken),
        ("f:65538: wrong".into(), 65_537)
    );
    let whole = take_lines(text.as_bytes(), Path::new("f"), 1, |_| Ok(())).unwrap();
    assert_eq!(whole, 2 * 65_536 + 8);
}

// Verifies: CLI-157.
#[test]
fn what_was_finished_for_another_request_is_refused_and_stays() {
    let disk = Rc::default();
    let open =
        |request: &str| Lines::open(Open::new(&disk), "f".into(), request, "job", |_| Ok(()));
    let other = REQUEST.replace('1', "2");
    open(REQUEST).unwrap();
    // Nothing was finished yet, also of a request with a longer first line.
    open(&REQUEST.replace('1', "123")).unwrap();
    let mut lines = open(&other).unwrap();
    lines.append("1\n").unwrap();
    drop(lines);
    let other_request =
        "f: belongs to a different request or version; finish that run or delete the file";
    for (request, refused) in [
        (REQUEST, other_request),
        (
            "{\"schema\":\"other\",\"seed\":2}\n",
            "f: is no journal of 'job'; choose another file",
        ),
    ] {
        assert_error(open(request), refused);
        assert_eq!(disk.borrow().seen, format!("{other}1\n").as_bytes());
    }
}

// A device keeps nothing, and a pipe would be read for ever.
// Verifies: CLI-157.
#[cfg(unix)]
#[test]
fn a_journal_is_a_file() {
    let opened = Journal::open("/dev/null".into(), &1, "job", |_| Ok(()));
    assert_error(
        opened,
        "/dev/null: is no journal of 'job'; choose another file",
    );
}

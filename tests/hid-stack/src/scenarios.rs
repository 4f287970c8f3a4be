//! What must hold on the real stack. Each scenario plugs in its boards, and returns what it measured.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use palpate::hid::real::{Profile, RealDevice, Wanted, list, udev_rule};
use palpate::hid::timing::measure;
use palpate::hid::{
    Control, End, ForceReport, HapticDevice, InvalidReport, PositionReport, Received,
};
use palpate::servo::Fault;

use crate::board::{Act, Answers, Board, CAPABILITIES, Make, PERIOD};
use crate::checks::{
    Run, Scenario, WATCHDOG, ensure, largest, make, plug, reports, run, safe, stopped, text,
};
use crate::link::{Kind, NAME, NUMBERS};
use crate::schedule::{self, Fifo};
use crate::servo::{COUNTS_AT_2_MM, Watched, open, wanted, with_session, with_table};

/// All of them.
pub const ALL: &[(&str, Scenario)] = &[
    ("protocol", || protocol(Kind::Uhid)),
    ("answers", answers),
    ("cycles", || cycles(Kind::Uhid)),
    ("burn", burn),
    ("unplug", || unplug(Kind::Uhid)),
    ("malformed", malformed_reports),
    ("garbage", garbage),
    ("silence", silence),
    ("panic", panics),
    ("killed", killed),
];

/// Verifies: HID-080, HID-081, HID-030, HID-031, HID-032.
pub fn protocol(kind: Kind) -> Result<String, String> {
    let board = plug(kind, "protocol", reports)?;
    let mut device = open("protocol").map_err(text)?;
    let began = Instant::now();
    let listed = list().map_err(text)?;
    let looked = began.elapsed();
    ensure!(listed.len() == 1, "{listed:?}");
    ensure!(listed[0].profile == Profile::Vendor, "{listed:?}");
    ensure!(listed[0].access().is_ok(), "{listed:?}");
    ensure!(listed[0].identity == *device.identity(), "{listed:?}");
    let identity = device.identity().clone();
    ensure!(
        (identity.vendor, identity.product) == (NUMBERS[0], NUMBERS[1]) && identity.name == NAME,
        "{identity}"
    );
    // The rule matches the name of the HID device above the node, as the kernel gives it.
    let node = identity.node.trim_start_matches("/dev/");
    let above = std::fs::read_link(format!("/sys/class/hidraw/{node}/device")).map_err(text)?;
    let above = above.to_string_lossy();
    ensure!(above.contains(":1209:0001."), "{above}");
    ensure!(
        udev_rule(&identity).contains("*:1209:0001.*"),
        "{}",
        udev_rule(&identity)
    );

    let capabilities = device.capabilities().map_err(text)?;
    ensure!(capabilities == CAPABILITIES, "{capabilities:?}");
    let controls = [Control::Enable, Control::ClearFault, Control::Stop];
    for control in controls {
        device.control(control).map_err(text)?;
    }
    let force = ForceReport {
        lateral: -258,
        normal: 772,
        sequence: 0xFEDC,
        flags: ForceReport::PLAY,
    };
    device.write(&force).map_err(text)?;
    let mut sequences = Vec::new();
    while sequences.len() < 20 {
        match device.read(2 * PERIOD).map_err(text)? {
            Received::Report(report) => sequences.push(report.sequence),
            other => return Err(format!("{other:?} instead of a report")),
        }
    }
    let gaps = sequences.windows(2).filter(|pair| pair[1] != pair[0] + 1);
    ensure!(gaps.count() == 0, "{sequences:?}");
    let record = board.unplug().map_err(text)?;
    ensure!(record.controls == controls, "{:?}", record.controls);
    ensure!(record.last == Some(force), "{:?}", record.last);
    ensure!(record.invalid == 0, "{}", record.invalid);
    ensure!(record.questions == 1, "{}", record.questions);
    Ok(format!(
        "{identity}; looking for devices took {} µs",
        looked.as_micros()
    ))
}

/// Verifies: HID-082, HID-034.
fn answers() -> Result<String, String> {
    let mut measured = Vec::new();
    for answers in [Answers::Short, Answers::Error, Answers::None] {
        let board = Board::plug(
            "answers",
            Make {
                answers,
                ..make(Kind::Uhid, reports)
            },
        )
        .map_err(text)?;
        let mut device = open("answers").map_err(text)?;
        let began = Instant::now();
        let answer = device.capabilities();
        let took = began.elapsed();
        let error = answer
            .err()
            .ok_or("a wrong answer was taken for capabilities")?;
        let error = error.to_string();
        let named = device.identity().to_string();
        ensure!(error.starts_with(&named), "{error}");
        ensure!(took < Duration::from_secs(6), "{took:?}");
        let problem = &error[named.len()..];
        measured.push(format!("{answers:?} in {} ms{problem}", took.as_millis()));
        board.unplug().map_err(text)?;
    }
    Ok(measured.join("; "))
}

/// Verifies: HID-083, HID-035.
pub fn cycles(kind: Kind) -> Result<String, String> {
    let board = plug(kind, "cycles", reports)?;
    let allocations = assert_no_alloc::violation_count();
    let Run {
        end,
        settled,
        counters,
        responses,
        ..
    } = run("cycles", 2100)?;
    let record = board.unplug().map_err(text)?;
    ensure!(
        assert_no_alloc::violation_count() == allocations,
        "the loop allocates"
    );
    ensure!(end == End::Asked, "{end}");
    ensure!(counters.cycles - settled.cycles == 2000, "{counters:?}");
    ensure!(counters.missed == settled.missed, "{counters:?}");
    ensure!(counters.skipped == settled.skipped, "{counters:?}");
    ensure!(counters.drained == settled.drained, "{counters:?}");
    ensure!(counters.garbage == 0, "{counters:?}");
    ensure!(counters.played - settled.played == 2000, "{counters:?}");
    ensure!(record.unanswered == 0, "{}", record.unanswered);
    ensure!(record.dropped_after.is_none(), "{:?}", record.dropped_after);
    ensure!(
        record.largest_force == COUNTS_AT_2_MM,
        "{}",
        record.largest_force
    );
    let misses = responses.iter().filter(|&&time| time > PERIOD).count();
    ensure!(misses == 0, "{misses}");
    stopped(&record)?;
    let loops = largest(responses)?;
    let round = largest(record.round_trips)?;
    Ok(format!(
        "2000 cycles at 1 kHz, 0 missed, 0 allocations; response {loops}; round trip at the board {round}"
    ))
}

/// Verifies: HID-084, HID-062.
fn burn() -> Result<String, String> {
    let mut measured = Vec::new();
    schedule::fifo(Fifo::Loop).map_err(text)?;
    for (burn, caught) in [(700, false), (1200, true)] {
        let board = plug(Kind::Uhid, "burn", reports)?;
        let device = Watched {
            device: open("burn").map_err(text)?,
            burn: Duration::from_micros(burn),
        };
        let timing =
            with_table(|table, limits| measure(device, table, limits, 1000, PERIOD, None))?
                .map_err(text)?;
        let record = board.unplug().map_err(text)?;
        ensure!(timing.passed != caught, "{timing:?}");
        ensure!(timing.misses == if caught { 1000 } else { 0 }, "{timing:?}");
        // 1000 cycles of 1.2 ms and more last 1200 ticks and more, so that 200 and more have no answer.
        let unanswered = if caught { 195..400 } else { 0..1 };
        ensure!(
            unanswered.contains(&record.unanswered),
            "{}",
            record.unanswered
        );
        stopped(&record)?;
        measured.push(format!(
            "{burn} µs: {} of 1000 cycles missed, {} ticks unanswered",
            timing.misses, record.unanswered
        ));
    }
    Ok(measured.join("; "))
}

/// Verifies: HID-085, HID-086, HID-036.
pub fn unplug(kind: Kind) -> Result<String, String> {
    let board = plug(kind, "unplug", |tick| match tick {
        500 => Act::Unplug,
        _ => Act::Report,
    })?;
    let device = open("unplug").map_err(text)?;
    let first = device.identity().clone();
    drop(device);
    let Run { end, counters, .. } = run("unplug", 10_000)?;
    let seen = Instant::now();
    let End::Device(error) = end else {
        return Err(format!("the loop went on: {end}"));
    };
    let error = error.to_string();
    ensure!(error.starts_with(&first.to_string()), "{error}");
    ensure!(counters.played > 300, "{counters:?}");
    let record = board.unplug().map_err(text)?;
    let pulled = record.unplugged.ok_or("the cable was not pulled")?;
    let seen = seen - pulled;
    ensure!(seen < 10 * PERIOD, "{seen:?}");
    safe(&record)?;
    let gone = RealDevice::open(&wanted("unplug")).map_err(text).err();
    let told = gone
        .as_ref()
        .is_some_and(|why| why.starts_with("no HID device"));
    ensure!(told, "{gone:?}");

    // Another board takes the node that was the first one's.
    let other = plug(kind, "another", reports)?;
    let device = open("another").map_err(text)?;
    ensure!(
        device.identity().node == first.node,
        "{}",
        device.identity()
    );
    let board = plug(kind, "unplug", reports)?;
    let again = Wanted::again(&first);
    let device = RealDevice::open_within(&again, Duration::from_secs(2)).map_err(text)?;
    let second = device.identity().clone();
    ensure!(second.node != first.node, "{second}");
    drop(device);
    let Run { end, counters, .. } = run("unplug", 300)?;
    ensure!(
        end == End::Asked && counters.played > 200,
        "{end}: {counters:?}"
    );
    stopped(&board.unplug().map_err(text)?)?;
    let untouched = other.unplug().map_err(text)?;
    ensure!(untouched.forces == 0, "{}", untouched.forces);
    Ok(format!(
        "\"{error}\" {} µs after the cable was pulled; found again at {}",
        seen.as_micros(),
        second.node
    ))
}

const SHORT: &[u8] = &[1, 0, 0, 0, 0];
const LONG: &[u8] = &[1; 30];
const WRONG: &[u8] = &[7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
const EMPTY: &[u8] = &[];

fn malformed(tick: u32) -> Act {
    match tick {
        200 => Act::Bytes(SHORT),
        220 => Act::Bytes(LONG),
        240 => Act::Bytes(WRONG),
        260 => Act::Bytes(EMPTY),
        _ => Act::Report,
    }
}

/// Verifies: HID-087, HID-002, HID-006.
fn malformed_reports() -> Result<String, String> {
    let board = plug(Kind::Uhid, "malformed", malformed)?;
    let mut device = open("malformed").map_err(text)?;
    device.control(Control::Enable).map_err(text)?;
    let mut found = Vec::new();
    let mut reports = 0;
    while reports < 300 {
        match device.read(4 * PERIOD).map_err(text)? {
            Received::Report(_) => reports += 1,
            Received::Garbage(problem) => found.push(problem),
            Received::Nothing => return Err("nothing for 4 ms".into()),
        }
    }
    board.unplug().map_err(text)?;
    let length = |found| InvalidReport::Length {
        found,
        expected: PositionReport::LENGTH,
    };
    // Linux 6.1.192 drops one that is too short; whether another kernel does is no matter.
    let expected = [length(5), length(30)];
    ensure!(found == expected || found == expected[1..], "{found:?}");
    Ok(format!(
        "of one too short, one too long, one of another number and an empty one came {found:?}"
    ))
}

/// Verifies: HID-087.
fn garbage() -> Result<String, String> {
    let board = plug(Kind::Uhid, "garbage", |tick| match tick {
        280..285 => Act::Repeat,
        400.. => Act::Bytes(LONG),
        _ => malformed(tick),
    })?;
    let Run {
        end,
        settled,
        counters,
        ..
    } = run("garbage", 10_000)?;
    let record = board.unplug().map_err(text)?;
    ensure!(end == End::Fault(Fault::Watchdog), "{end}");
    // Without a fresh sample are the five cycles that repeat one, and each in which garbage came: one or
    // two between good reports, then 11 until the watchdog of 10 gives up, and at most two more until the
    // force is released.
    let missed = counters.missed - settled.missed;
    ensure!(missed == 5 + counters.garbage, "{counters:?}");
    ensure!((12..=15).contains(&counters.garbage), "{counters:?}");
    ensure!(counters.played > 300, "{counters:?}");
    stopped(&record)?;
    Ok(format!(
        "{} garbage, {missed} cycles without a fresh sample; {end}",
        counters.garbage
    ))
}

/// Verifies: HID-090, HID-016.
fn panics() -> Result<String, String> {
    let board = plug(Kind::Uhid, "panics", reports)?;
    let device = open("panics").map_err(text)?;
    let ended = catch_unwind(AssertUnwindSafe(|| {
        with_session(device, |mut session| {
            session.run(|_, counters| {
                assert!(counters.cycles < 200, "a panic that was asked for");
                true
            })
        })
    }));
    ensure!(ended.is_err(), "the panic was lost");
    let record = board.unplug().map_err(text)?;
    ensure!(record.ticks_with_force > 50, "{}", record.ticks_with_force);
    stopped(&record)?;
    Ok(format!(
        "a panic with force on: zero and stop after {} force reports",
        record.forces
    ))
}

/// Verifies: HID-088.
fn silence() -> Result<String, String> {
    let board = plug(Kind::Uhid, "silence", |tick| match tick {
        300.. => Act::Silence,
        _ => Act::Report,
    })?;
    let Run { end, counters, .. } = run("silence", 10_000)?;
    let record = board.unplug().map_err(text)?;
    ensure!(end == End::Fault(Fault::Watchdog), "{end}");
    ensure!(counters.played > 200, "{counters:?}");
    stopped(&record)?;
    Ok(format!("{end}"))
}

/// Verifies: HID-089, HID-042.
fn killed() -> Result<String, String> {
    let board = plug(Kind::Uhid, "killed", reports)?;
    let mut player = Command::new("/proc/self/exe")
        .args(["play", "killed"])
        .spawn()
        .map_err(text)?;
    while board.record().ticks_with_force < 100 {
        thread::sleep(PERIOD);
        ensure!(board.record().ticks < 5000, "no force for 5 s");
    }
    player.kill().map_err(text)?;
    player.wait().map_err(text)?;
    thread::sleep(3 * WATCHDOG);
    let dead = board.record();
    ensure!(dead.motors == [0, 0], "{:?}", dead.motors);
    ensure!(
        !dead.controls.contains(&Control::Stop),
        "{:?}",
        dead.controls
    );
    // The next session clears the board's fault and plays again.
    let Run { end, counters, .. } = run("killed", 300)?;
    ensure!(
        end == End::Asked && counters.played > 200,
        "{end}: {counters:?}"
    );
    let record = board.unplug().map_err(text)?;
    ensure!(record.motors == [0, 0], "{:?}", record.motors);
    ensure!(record.controls.last() == Some(&Control::Stop), "no stop");
    safe(&dead)?;
    let dropped = dead
        .dropped_after
        .ok_or("the board did not drop the force")?;
    ensure!(dropped <= WATCHDOG + 2 * PERIOD, "{dropped:?}");
    Ok(format!(
        "the board dropped the force {} µs after the last report",
        dropped.as_micros()
    ))
}

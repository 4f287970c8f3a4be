//! The program as it is shipped, `palpate`, in a process of its own: what it says, its exit code, and what
//! signals do to it.

use std::fs;
use std::process::{Child, Command, Stdio};

use crate::Scenario;
use crate::board::{Act, Board, REPORTS};
use crate::checks::{WATCHDOG, stopped};
use crate::link::{Kind, NAME};
use crate::servo::open;

/// Those without a bus.
pub const ALL: &[Scenario] = &[
    ("palpate devices", devices),
    ("palpate play, unplugged", unplugged),
    ("palpate play, SIGINT", || signalled("INT")),
    ("palpate play, SIGTERM", || signalled("TERM")),
    ("palpate play, no device", no_device),
];

const PROGRAM: &str = "/palpate";

fn play(serial: &str) -> Child {
    let arguments =
        "play --map /map.csv --scale --device hid --vid 1209 --pid 0001 --seconds 60 --serial";
    Command::new(PROGRAM)
        .args(arguments.split(' '))
        .arg(serial)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

/// The exit code of the program, and what it said on standard error, of which the last line counts.
fn end(player: Child) -> (Option<i32>, String) {
    let output = player.wait_with_output().expect("the program ends");
    (output.status.code(), text(&output.stderr))
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).trim().to_owned()
}

/// Whether a thread of process `id` runs by SCHED_FIFO, as the system says.
fn has_fifo_thread(id: u32) -> bool {
    const FIFO: &str = "1";
    let threads = fs::read_dir(format!("/proc/{id}/task")).expect("threads");
    let is_fifo = |thread: fs::DirEntry| {
        let stat = fs::read_to_string(thread.path().join("stat")).expect("a thread");
        // After the name in brackets, which may hold anything, the policy is the 39th field.
        let fields = stat.rsplit(')').next().unwrap_or_default();
        fields.split_whitespace().nth(38) == Some(FIFO)
    };
    threads.map(|thread| thread.expect("a thread")).any(is_fifo)
}

/// Verifies: HID-094, HID-031.
fn devices() -> String {
    let board = Board::good(Kind::Uhid, "devices", REPORTS);
    open("devices");
    let output = Command::new(PROGRAM).arg("devices").output();
    let output = output.expect("the program starts");
    let record = board.unplug();
    assert!(output.status.success(), "{output:?}");
    let said = text(&output.stdout);
    for part in [
        NAME,
        "1209:0001",
        "serial devices",
        "/dev/hidraw",
        "vendor profile",
    ] {
        assert!(said.contains(part), "{part} not in {said}");
    }
    assert_eq!((record.forces, record.controls), (0, vec![]));
    said.replace('\n', "; ")
}

/// Verifies: HID-094, HID-085.
fn unplugged() -> String {
    let board = Board::good(Kind::Uhid, "unplugged", &[(500, Act::Unplug)]);
    let (code, said) = end(play("unplugged"));
    let record = board.unplug();
    assert_eq!(code, Some(1), "{said}");
    let ticks = record.ticks_with_force;
    assert!(ticks > 100, "{ticks}: {said}");
    assert!(said.contains("serial unplugged"), "{said}");
    format!("exit code 1, \"{said}\"")
}

/// Verifies: HID-094, HID-055, HID-101.
fn signalled(signal: &str) -> String {
    let board = Board::good(Kind::Uhid, "signalled", REPORTS);
    let player = play("signalled");
    board.wait_for_force();
    let real_time = has_fifo_thread(player.id());
    let id = player.id().to_string();
    let kill = Command::new("/bin/busybox")
        .args(["kill", "-s", signal, &id])
        .status();
    assert!(kill.expect("busybox starts").success());
    let (code, said) = end(player);
    let record = board.unplug();
    assert_eq!(code, Some(0), "{said}");
    assert!(real_time, "no thread by SCHED_FIFO: {said}");
    assert!(said.contains("note: Linux runs the loop"), "{said}");
    let dropped = record.dropped_after;
    assert!(dropped.is_none_or(|after| after > WATCHDOG), "{dropped:?}");
    stopped(&record);
    let forces = record.forces;
    format!("exit code 0, a thread by SCHED_FIFO, {forces} force reports, stopped")
}

/// Verifies: HID-094, HID-054.
pub fn held_up() -> String {
    let board = Board::good(Kind::Usb, "heldup", &[(300, Act::Refuse)]);
    // A USB device is there only a while after it was plugged in.
    open("heldup");
    let (code, said) = end(play("heldup"));
    let record = board.unplug();
    assert_eq!((code, record.motors), (Some(1), [0, 0]), "{said}");
    let (_, told) = said.split_once("held up for ").expect(&said);
    let told = told.split(' ').next().and_then(|told| told.parse().ok());
    assert!(told.is_some_and(|told: u32| told <= 130), "{said}");
    said.replace('\n', "; ")
}

/// Verifies: HID-094, HID-030.
fn no_device() -> String {
    let (code, said) = end(play("nobody"));
    assert_ne!(code, Some(0), "{said}");
    assert!(said.contains("serial nobody"), "{said}");
    format!("{code:?}, \"{said}\"")
}

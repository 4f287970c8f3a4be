//! The program as it is shipped, `palpate`, in a process of its own: what it says, its exit code, and what
//! signals do to it.

use std::fs;
use std::process::{Child, Command, Output, Stdio};
use std::thread;

use palpate::hid::Control;

use crate::board::{Act, Board, PERIOD};
use crate::checks::{Scenario, WATCHDOG, ensure, plug, reports, stopped, text};
use crate::link::{Kind, NAME};

/// Those without a bus.
pub const ALL: &[(&str, Scenario)] = &[
    ("palpate devices", devices),
    ("palpate play, unplugged", unplugged),
    ("palpate play, SIGINT", || signalled("INT")),
    ("palpate play, SIGTERM", || signalled("TERM")),
    ("palpate play, no device", no_device),
];

const PROGRAM: &str = "/palpate";

fn play(serial: &str) -> Result<Child, String> {
    let arguments = [
        "play", "--map", "/map.csv", "--scale", "--device", "hid", "--vid", "1209", "--pid", "0001",
    ];
    Command::new(PROGRAM)
        .args(arguments)
        .args(["--serial", serial, "--seconds", "60"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(text)
}

/// Waits until the board makes a force.
fn wait_for_force(board: &Board) -> Result<(), String> {
    while board.record().ticks_with_force < 100 {
        thread::sleep(PERIOD);
        ensure!(board.record().ticks < 10_000, "no force for 10 s");
    }
    Ok(())
}

/// What the program said on standard error, of which the last line counts.
fn message(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).trim().to_owned()
}

/// Whether a thread of process `id` runs by SCHED_FIFO, as the system says.
fn has_fifo_thread(id: u32) -> Result<bool, String> {
    const FIFO: &str = "1";
    let threads = fs::read_dir(format!("/proc/{id}/task")).map_err(text)?;
    let mut found = false;
    for thread in threads {
        let stat = fs::read_to_string(thread.map_err(text)?.path().join("stat")).map_err(text)?;
        // After the name in brackets, which may hold anything, the policy is the 39th field.
        let fields = stat.rsplit(')').next().unwrap_or_default();
        found |= fields.split_whitespace().nth(38) == Some(FIFO);
    }
    Ok(found)
}

/// Verifies: HID-093, HID-032.
fn devices() -> Result<String, String> {
    let board = plug(Kind::Uhid, "devices", reports)?;
    crate::servo::open("devices").map_err(text)?;
    let output = Command::new(PROGRAM)
        .arg("devices")
        .output()
        .map_err(text)?;
    let record = board.unplug().map_err(text)?;
    let said = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    ensure!(
        output.status.success(),
        "{}: {}",
        output.status,
        message(&output)
    );
    for part in [
        NAME,
        "1209:0001",
        "serial devices",
        "/dev/hidraw",
        "vendor profile",
    ] {
        ensure!(said.contains(part), "{part} not in {said}");
    }
    ensure!(
        record.forces == 0 && record.controls.is_empty(),
        "{:?}",
        record.controls
    );
    Ok(said.replace('\n', "; "))
}

/// Verifies: HID-094, HID-085.
fn unplugged() -> Result<String, String> {
    let board = plug(Kind::Uhid, "unplugged", |tick| match tick {
        500 => Act::Unplug,
        _ => Act::Report,
    })?;
    let player = play("unplugged")?;
    let output = player.wait_with_output().map_err(text)?;
    let record = board.unplug().map_err(text)?;
    let said = message(&output);
    ensure!(output.status.code() == Some(1), "{}: {said}", output.status);
    ensure!(
        record.ticks_with_force > 100,
        "{}: {said}",
        record.ticks_with_force
    );
    ensure!(said.contains("serial unplugged"), "{said}");
    Ok(format!("exit code 1, \"{said}\""))
}

/// Verifies: HID-094, HID-055.
fn signalled(signal: &str) -> Result<String, String> {
    let board = plug(Kind::Uhid, "signalled", reports)?;
    let player = play("signalled")?;
    wait_for_force(&board)?;
    let real_time = has_fifo_thread(player.id())?;
    let id = player.id().to_string();
    let kill = Command::new("/bin/busybox")
        .args(["kill", "-s", signal, &id])
        .status();
    ensure!(kill.map_err(text)?.success(), "kill");
    let output = player.wait_with_output().map_err(text)?;
    let record = board.unplug().map_err(text)?;
    let said = message(&output);
    ensure!(output.status.code() == Some(0), "{}: {said}", output.status);
    ensure!(real_time, "no thread by SCHED_FIFO: {said}");
    ensure!(
        record.dropped_after.is_none_or(|after| after > WATCHDOG),
        "{:?}",
        record.dropped_after
    );
    ensure!(
        record.controls.last() == Some(&Control::Stop),
        "{:?}",
        record.controls
    );
    stopped(&record)?;
    Ok(format!(
        "exit code 0, a thread by SCHED_FIFO, {} force reports, stopped",
        record.forces
    ))
}

/// Verifies: HID-095, HID-054.
pub fn held_up() -> Result<String, String> {
    let board = plug(Kind::Usb, "heldup", |tick| match tick {
        300 => Act::Refuse,
        _ => Act::Report,
    })?;
    // A USB device is there only a while after it was plugged in.
    crate::servo::open("heldup").map_err(text)?;
    let output = play("heldup")?.wait_with_output().map_err(text)?;
    let record = board.unplug().map_err(text)?;
    let said = message(&output);
    ensure!(output.status.code() == Some(1), "{}: {said}", output.status);
    ensure!(record.motors == [0, 0], "{:?}", record.motors);
    let told = said
        .split("held up for ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next());
    let told: u32 = told
        .and_then(|told| told.parse().ok())
        .ok_or(said.clone())?;
    ensure!(told <= 130, "{said}");
    Ok(said.replace('\n', "; "))
}

/// Verifies: HID-094, HID-030.
fn no_device() -> Result<String, String> {
    let output = play("nobody")?.wait_with_output().map_err(text)?;
    let said = message(&output);
    ensure!(output.status.code() != Some(0), "{}: {said}", output.status);
    ensure!(said.contains("serial nobody"), "{said}");
    Ok(format!("{}, \"{said}\"", output.status))
}

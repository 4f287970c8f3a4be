//! The supervisor over devices that fail on the clock of the host.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use super::*;
use crate::hid::simulated::Defect;
use crate::hid::tests::{MS, Sent, Watched, begin, probing};

/// Plays on the paper's device, of which the first write after a second of its time, and one every 100 ms from then on, does
/// `what` it should.
fn played(
    mut what: impl FnMut() + Send,
    stop: impl Fn() -> bool,
    look: impl FnMut(&Counters, Duration),
) -> Option<Played> {
    let mut trouble = 1000 * MS;
    let device = Watched(probing(1000 * MS, vec![]), move |sent, now| {
        if matches!(sent, Sent::Force(_)) && now >= trouble {
            trouble += 100 * MS;
            what();
        }
        Ok(())
    });
    let options = PlayOptions {
        duration: Some(2000 * MS),
        record: 1500,
    };
    play(begin(device), &options, || (), stop, look)
}

// Verifies: HID-053.
#[test]
fn a_session_is_played_and_recorded_as_far_as_there_is_room() {
    // A machine that stands still for a moment holds up the loop too, but hardly ten times in a row.
    let mut sessions = (0..10).map(|_| played(|| (), || false, |_, _| ()).unwrap());
    let played = sessions.find(|played| played.held_up.is_none()).unwrap();
    assert_eq!(played.end, End::Asked);
    assert_eq!(played.counters.cycles, 2000);
    assert_eq!(played.cycles.len(), 1500);
}

// Verifies: HID-054.
#[test]
fn the_longest_time_that_a_loop_is_held_up_is_told() {
    // Each hold lasts until the supervisor has seen it last so long, so that no machine is too slow for this.
    let (seen, holds) = std::sync::mpsc::channel::<()>();
    let hold = move || {
        let _ = holds.recv_timeout(Duration::from_secs(60));
    };
    let mut least = vec![HELD_UP, 3 * HELD_UP];
    let mut seen = Some(seen);
    let look = |_: &Counters, silent| match least.last() {
        Some(&time) if silent > time => {
            least.pop();
            let _ = seen.as_ref().unwrap().send(());
        }
        Some(_) => (),
        None => seen = None,
    };
    let played = played(hold, || false, look).unwrap();
    assert!(least.is_empty());
    assert!(played.held_up > Some(3 * HELD_UP), "{:?}", played.held_up);
}

// Verifies: HID-053.
#[test]
fn a_signal_that_interrupts_a_read_ends_the_session_as_asked_only_if_it_was_asked() {
    let end = |asked: bool| {
        let device = probing(1000 * MS, vec![(MS, Defect::Interrupt)]);
        let options = PlayOptions {
            duration: None,
            record: 0,
        };
        let board = Board::default();
        board.stop.store(asked, Ordering::Relaxed);
        servo_loop(begin(device), &options, &board).end.to_string()
    };
    assert_eq!(end(true), "ended as asked");
    assert_eq!(end(false), "stopped: a signal interrupted the device");
}

// Verifies: HID-054.
#[test]
fn the_wish_to_stop_reaches_the_loop() {
    let asked = std::sync::atomic::AtomicBool::new(false);
    let (sender, receiver) = std::sync::mpsc::channel::<()>();
    // The loop waits in its write until the supervisor has passed the wish on.
    let wait = move || {
        let _ = receiver.recv_timeout(Duration::from_secs(60));
    };
    let mut sender = Some(sender);
    let look = |counters: &Counters, _| {
        if counters.cycles > 900 && asked.swap(true, Ordering::Relaxed) {
            sender.take();
        }
    };
    let played = played(wait, || asked.load(Ordering::Relaxed), look).unwrap();
    assert_eq!(played.end, End::Asked);
    assert!(played.counters.cycles < 1100, "{:?}", played.counters);
}

// Verifies: HID-016.
#[test]
fn a_panic_of_the_supervisor_ends_the_session() {
    let mut writes = 0;
    // Eleven times, if nothing ends the session.
    let wait = || {
        writes += 1;
        std::thread::sleep(HELD_UP);
    };
    // Without a backtrace, which may take a second.
    let session = || played(wait, || false, |_, _| resume_unwind(Box::new(())));
    catch_unwind(AssertUnwindSafe(session)).unwrap_err();
    assert!(writes < 5, "{writes}");
}

// Verifies: HID-016.
#[test]
fn a_panic_on_the_servo_thread_ends_the_supervisor() {
    assert_eq!(played(|| panic!("planted"), || false, |_, _| ()), None);
}

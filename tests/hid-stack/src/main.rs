//! The test on the real HID stack: boards made of uhid on one side of the kernel, the loop that is shipped on
//! the other. Runs as root in a guest (see `run`), where time is virtual: it follows the number of
//! instructions, so that a busy host changes nothing, and is no latency of any hardware.

mod board;
mod checks;
mod link;
mod program_scenarios;
mod scenarios;
mod schedule;
mod servo;
mod uhid;
mod usb;
mod usb_scenarios;

use std::panic::catch_unwind;
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: assert_no_alloc::AllocDisabler = assert_no_alloc::AllocDisabler;

/// Panics if something is wrong, and says what was measured.
type Scenario = (&'static str, fn() -> String);

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let scenarios = match &arguments[..] {
        [tier] if tier == "uhid" => [scenarios::ALL, program_scenarios::ALL].concat(),
        [tier] if tier == "usb" => usb_scenarios::ALL.to_vec(),
        [play, serial] if play == "play" => return servo::play_until_killed(serial),
        _ => {
            eprintln!("hid-stack: give uhid, usb or play SERIAL");
            return ExitCode::from(2);
        }
    };
    let mut passed = 0;
    for &(name, scenario) in &scenarios {
        match catch_unwind(scenario) {
            Ok(measured) => {
                passed += 1;
                println!("hid-stack: ok      {name}: {measured}");
            }
            Err(panic) => {
                let problem = panic.downcast::<String>().unwrap_or_default();
                println!("hid-stack: FAILED  {name}: {}", problem.replace('\n', ";"));
            }
        }
    }
    let all = scenarios.len();
    println!("hid-stack: verdict {passed} of {all} scenarios passed");
    ExitCode::from(u8::from(passed != all))
}

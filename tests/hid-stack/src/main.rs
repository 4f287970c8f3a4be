//! The test on the real HID stack: boards made of uhid on one side of the kernel, the loop that is shipped on
//! the other. Runs as root in a guest (see `run`), where time is virtual: it follows the number of
//! instructions, so that a busy host changes nothing, and is no latency of any hardware.

mod board;
mod scenarios;
mod schedule;
mod servo;
mod uhid;

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: assert_no_alloc::AllocDisabler = assert_no_alloc::AllocDisabler;

fn main() -> ExitCode {
    if let Some(part) = std::env::args().nth(1) {
        return servo::play_until_killed(&part);
    }
    let mut passed = 0;
    for &(name, scenario) in scenarios::ALL {
        match scenario() {
            Ok(measured) => {
                passed += 1;
                println!("hid-stack: ok      {name}: {measured}");
            }
            Err(problem) => println!("hid-stack: FAILED  {name}: {problem}"),
        }
    }
    let all = scenarios::ALL.len();
    println!("hid-stack: verdict {passed} of {all} scenarios passed");
    ExitCode::from(u8::from(passed != all))
}

//! The machine that compares: `host TABLE` says of vectors and scenario what the target must say, and writes what the small image
//! is sent in the scenario to TABLE.frames, and what it must answer to TABLE.reports.

use std::{env, fs, process};

use palpate_firmware::device::{CAPABILITIES, Device};
use palpate_firmware::table::PAPER;
use palpate_firmware::{scenario, told};

fn main() {
    let table = env::args().nth(1).expect("the argument TABLE");
    let bytes = fs::read(&table).expect("the table can be read");
    let mut text = String::new();
    let right = told::all(&bytes, &mut text);
    print!("{text}");

    let paper = PAPER.table().expect("the kernel takes the table");
    let mut device = Device::new(paper, &CAPABILITIES).expect("the kernel takes the device");
    let [mut frames, mut reports] = [
        CAPABILITIES.encode().to_vec(),
        CAPABILITIES.encode().to_vec(),
    ];
    for cycle in 0..scenario::CYCLES {
        let frame = scenario::frame(cycle);
        frames.extend(frame);
        reports.extend(device.cycle(&frame));
    }
    fs::write(format!("{table}.frames"), frames).expect("the frames can be written");
    fs::write(format!("{table}.reports"), reports).expect("the reports can be written");
    process::exit(if right { 0 } else { 1 });
}

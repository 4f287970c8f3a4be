//! The machine that compares: `host STEM` prints what the target must print, and writes what the product image is sent in the
//! scenario to STEM.frames, and what it must answer to STEM.reports.

use std::{env, fs};

use palpate_core::hid::PAPER as DISPLAY;
use palpate_firmware::device::Device;
use palpate_firmware::table::PAPER;
use palpate_firmware::{digest, scenario};

fn main() {
    let stem = env::args().nth(1).expect("the argument STEM");
    let mut text = String::new();
    digest::print(&mut text);
    print!("{text}");

    let paper = PAPER.table().expect("the kernel takes the table");
    let mut device = Device::new(paper, &DISPLAY).expect("the kernel takes the device");
    let [mut frames, mut reports] = [DISPLAY.encode().to_vec(), DISPLAY.encode().to_vec()];
    for cycle in 0..scenario::CYCLES {
        let frame = scenario::frame(cycle);
        frames.extend(frame);
        reports.extend(device.cycle(&frame));
    }
    fs::write(format!("{stem}.frames"), frames).expect("the frames can be written");
    fs::write(format!("{stem}.reports"), reports).expect("the reports can be written");
}

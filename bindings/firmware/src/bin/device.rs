//! The small image: what a product would have. It is given the device's capabilities and then a frame a cycle by the serial line,
//! and sends a force report for each.
//!
//! Implements: FIR-005, FIR-008, FIR-003.
#![no_std]
#![no_main]

use core::hint::black_box;

use palpate_core::hid::{Capabilities, ForceReport, InvalidReport, PositionReport};
use palpate_firmware::board;
use palpate_firmware::device::{Device, Frame};
use palpate_firmware::table::PAPER;

// The rest of the codec, so that the image holds it all, and its size counts it.
#[used]
static DECODE: fn(&[u8]) -> Result<ForceReport, InvalidReport> = ForceReport::decode;
#[used]
static ENCODE: fn(&PositionReport) -> [u8; PositionReport::LENGTH] = PositionReport::encode;

#[unsafe(no_mangle)] // the name that the start calls
#[allow(unsafe_code)]
extern "C" fn run() -> ! {
    board::open_serial();
    let mut capabilities = [0; Capabilities::LENGTH];
    board::receive(&mut capabilities);
    let Some(mut device) = device(&capabilities) else {
        board::exit(2)
    };
    let mut frame = Frame::default();
    loop {
        board::receive(&mut frame);
        board::send(&device.cycle(&frame));
    }
}

fn device(bytes: &[u8]) -> Option<Device<'static>> {
    let capabilities = Capabilities::decode(bytes).ok()?;
    board::send(&capabilities.encode());
    // As if the table came from somewhere else: the compiler must not compute with its values.
    Device::new(black_box(&PAPER).table()?, &capabilities)
}

#[panic_handler]
fn panicked(_: &core::panic::PanicInfo) -> ! {
    board::exit(101)
}

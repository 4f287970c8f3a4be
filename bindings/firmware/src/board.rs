//! The board: start, counter of time, serial line, text to QEMU. The only file with `unsafe`, for addresses of the hardware and the
//! instructions that Rust has no name for.

#![allow(unsafe_code)]

use core::arch::{asm, global_asm};
use core::fmt;

// The processor reads the stack pointer and the address to begin at from the first two words, and the next two when something that
// cannot be masked or a fault happens: nothing here should, so these end the run. First the floating-point unit is let in (CPACR), before
// any instruction that uses it, then variables get their values.
global_asm!(
    ".section .vectors, \"a\"",
    ".word stack_top",
    ".word reset",
    ".word fault",
    ".word fault",
    ".text",
    ".global reset",
    ".type reset, %function",
    ".thumb_func",
    "reset:",
    "ldr r0, =0xE000ED88",
    "ldr r1, [r0]",
    "orr r1, r1, #0xF00000",
    "str r1, [r0]",
    "dsb",
    "isb",
    "ldr r0, =data_start",
    "ldr r1, =data_end",
    "ldr r2, =data_load",
    "1: cmp r0, r1",
    "bhs 2f",
    "ldr r3, [r2], #4",
    "str r3, [r0], #4",
    "b 1b",
    "2: ldr r0, =bss_start",
    "ldr r1, =bss_end",
    "movs r2, #0",
    "3: cmp r0, r1",
    "bhs run",
    "str r2, [r0], #4",
    "b 3b",
    ".pool",
    ".type fault, %function",
    ".thumb_func",
    "fault: b stop_at_fault",
);

#[unsafe(no_mangle)] // the name that the vector table has
extern "C" fn stop_at_fault() -> ! {
    exit(3)
}

/// Ends the run of QEMU with an exit code. Without QEMU or a debugger it is a fault, and the processor stops.
pub fn exit(code: u32) -> ! {
    // "The application ends", with a code behind it.
    semihosting(0x20, &[0x20026, code]);
    loop {
        core::hint::spin_loop();
    }
}

/// A call to QEMU, or to a debugger.
fn semihosting(operation: u32, block: &[u32]) -> u32 {
    let mut operation = operation;
    // SAFETY: the one who is called reads `block`, and text that it points to, and changes r0 alone.
    unsafe { asm!("bkpt 0xAB", inout("r0") operation, in("r1") block.as_ptr(), options(nostack)) };
    operation
}

/// Text to QEMU's output.
#[derive(Debug)]
pub struct Text;

impl fmt::Write for Text {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            // Write a character, whose address is given.
            semihosting(0x03, &[byte.into()]);
        }
        Ok(())
    }
}

/// A register of the hardware.
fn read(address: usize) -> u32 {
    // SAFETY: callers name registers of the board alone, words that may be read at any time.
    unsafe { (address as *const u32).read_volatile() }
}

fn write(address: usize, value: u32) {
    // SAFETY: callers name registers of the board alone, in which no memory of the program lies.
    unsafe { (address as *mut u32).write_volatile(value) }
}

/// The first serial line (CMSDK UART): data, state (bit 0 full to write, bit 1 something to read), control (bits 0 and 1 let both in).
const SERIAL: usize = 0x4000_4000;

/// Opens the serial line.
pub fn open_serial() {
    write(SERIAL + 0x10, 16); // cycles a bit, the least; QEMU needs no more
    write(SERIAL + 0x8, 0b11);
}

/// Waits for as many bytes as `bytes` holds.
pub fn receive(bytes: &mut [u8]) {
    for byte in bytes {
        while read(SERIAL + 4) & 0b10 == 0 {}
        *byte = read(SERIAL) as u8;
    }
}

/// Sends bytes.
pub fn send(bytes: &[u8]) {
    for &byte in bytes {
        while read(SERIAL + 4) & 0b01 != 0 {}
        write(SERIAL, byte.into());
    }
}

/// The processor's own timer, which counts down from 2²⁴ − 1: control, reload, value.
const SYSTICK: usize = 0xE000_E010;

/// Starts the timer.
pub fn start_timer() {
    write(SYSTICK + 4, 0x00FF_FFFF);
    write(SYSTICK + 8, 0);
    write(SYSTICK, 0b101);
}

/// Nanoseconds of a tick: the board's clock is 25 MHz.
const TICK_NS: u32 = 40;
/// Nanoseconds of an instruction, as QEMU is told (`-icount shift=10`).
const INSTRUCTION_NS: u32 = 1024;

/// The instructions of `work`, of at most 650,000. QEMU's virtual time goes on by 1,024 ns with each instruction, and by nothing else;
/// the timer reads it. What reading the timer twice takes is subtracted.
pub fn instructions<T>(work: impl FnOnce() -> T) -> (u32, T) {
    let nothing = ticks(|| ()).0;
    let (ticks, value) = ticks(work);
    (
        ((ticks - nothing) * TICK_NS + INSTRUCTION_NS / 2) / INSTRUCTION_NS,
        value,
    )
}

#[inline(always)]
fn ticks<T>(work: impl FnOnce() -> T) -> (u32, T) {
    let before = now();
    let value = work();
    (before.wrapping_sub(now()) & 0x00FF_FFFF, value)
}

#[inline(never)]
fn now() -> u32 {
    read(SYSTICK + 8)
}

/// A hundred and one instructions, to see that they are counted right.
#[inline(always)]
pub fn hundred_and_one() {
    // SAFETY: counts a register of its own down.
    unsafe {
        asm!("movs {0}, #50", "2: subs {0}, #1", "bne 2b", out(reg) _, options(nomem, nostack))
    };
}

/// What the stack below this function's frame is painted with, and how much of it, bytes.
const PAINT: u32 = 0xA5C3_5A3C;
const PAINTED: usize = 4096;

/// The bytes of stack that `work` uses, from the call on: those that it left without the paint.
#[inline(never)]
pub fn stack_of(work: &mut dyn FnMut()) -> usize {
    let top: usize;
    // SAFETY: reads the stack pointer.
    unsafe { asm!("mov {}, sp", out(reg) top, options(nomem, nostack, preserves_flags)) };
    let bottom = (top - PAINTED) as *mut u32;
    for word in 0..PAINTED / 4 {
        // SAFETY: what lies below the stack pointer belongs to nobody, no interrupt is on, and the stack has 4 MiB.
        unsafe { bottom.add(word).write_volatile(PAINT) };
    }
    work();
    // SAFETY: as above; these words were written.
    let untouched =
        (0..PAINTED / 4).take_while(|&word| unsafe { bottom.add(word).read_volatile() } == PAINT);
    PAINTED - 4 * untouched.count()
}

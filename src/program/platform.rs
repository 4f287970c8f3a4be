//! What differs between operating systems: the signals that end the program, the priority of the servo thread.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::CliError;
use super::output::tell;
pub(super) use system::{PROMISE, raise_priority};

/// A flag that Ctrl-C and the system's other requests to end set; a second one ends the program at once, and leaves the force to the
/// device's watchdog.
pub(super) fn stop_on_signals() -> Result<Arc<AtomicBool>, CliError> {
    let stop = Arc::new(AtomicBool::new(false));
    system::set_on_signals(&stop)?;
    Ok(stop)
}

/// Makes the allocator keep memory of up to 64 MB that is given back. glibc gives back to the system what is more than twice the size of the
/// largest block that it has seen returned, and each model would find all its pages anew: a tenth of a bank's time. Elsewhere
/// this changes nothing.
pub(super) fn keep_memory() {
    // The largest block that glibc takes into account, of which no page is touched.
    const LARGEST: usize = (32 << 20) - (1 << 16);
    let mut block = Vec::<u8>::new();
    // Where there is not as much, it is not needed either.
    let _ = std::hint::black_box(&mut block).try_reserve_exact(LARGEST);
}

#[cfg(unix)]
mod system {
    use super::{Arc, AtomicBool, CliError, tell};
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::flag::{register, register_conditional_shutdown};
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy,
        set_thread_priority_and_policy, thread_native_id,
    };

    pub fn set_on_signals(stop: &Arc<AtomicBool>) -> Result<(), CliError> {
        for signal in [SIGINT, SIGTERM, SIGHUP] {
            let hook = register_conditional_shutdown(signal, 130, stop.clone())
                .and_then(|_| register(signal, stop.clone()));
            hook.map_err(CliError::refused(format_args!("signal {signal}")))?;
        }
        Ok(())
    }

    /// What the system promises of the time at which it wakes the servo thread.
    pub const PROMISE: &str = if cfg!(target_os = "linux") {
        "Linux runs the loop before all else (SCHED_FIFO, locked memory) if it may, without an upper bound of its delay"
    } else {
        "macOS runs the loop before others (SCHED_FIFO), without an upper bound of its delay; it was never tried"
    };

    /// Requests real-time priority and locked memory; prints a note where the system refuses.
    ///
    /// Implements: HID-055.
    pub fn raise_priority() {
        let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
        let priority = 80u8.try_into().map(ThreadPriority::Crossplatform);
        let raised = priority.is_ok_and(|priority| {
            set_thread_priority_and_policy(thread_native_id(), priority, policy).is_ok()
        });
        if !raised {
            tell("no real-time priority (SCHED_FIFO): the system may wake the loop late");
        }
        #[cfg(target_os = "linux")]
        {
            use rustix::mm::{MlockAllFlags, mlockall};
            if mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE).is_err() {
                tell("memory is not locked: a page fault may delay a cycle");
            }
        }
    }
}

#[cfg(windows)]
mod system {
    use std::process::exit;
    use std::sync::atomic::Ordering::Relaxed;

    use super::{Arc, AtomicBool, CliError, tell};
    use thread_priority::{ThreadPriority, WinAPIThreadPriority, set_current_thread_priority};

    /// Ctrl-C, Ctrl-Break and a console that is closed, of which Windows tells in a thread of its own.
    pub fn set_on_signals(stop: &Arc<AtomicBool>) -> Result<(), CliError> {
        let stop = stop.clone();
        let hook = move || {
            if stop.swap(true, Relaxed) {
                exit(130);
            }
        };
        ctrlc::set_handler(hook).map_err(CliError::refused("Ctrl-C"))
    }

    /// What the system promises of the time at which it wakes the servo thread.
    pub const PROMISE: &str = "Windows runs the loop before others (time-critical priority), without an upper bound of its delay; it was \
        never tried with a device";

    /// Requests the highest priority of a thread; prints a note where the system refuses.
    ///
    /// Implements: HID-055.
    pub fn raise_priority() {
        let highest = ThreadPriority::Os(WinAPIThreadPriority::TimeCritical.into());
        if set_current_thread_priority(highest).is_err() {
            tell("no time-critical priority: the system may wake the loop late");
        }
    }
}

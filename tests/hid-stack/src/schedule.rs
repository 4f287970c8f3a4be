//! Who comes first on the guest's only processor.

use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id, thread_schedule_policy,
};

/// A share of the real-time policy `SCHED_FIFO`.
#[derive(Debug, Clone, Copy)]
pub enum Fifo {
    /// The loop under test.
    Loop = 40,
    /// The board's answers: another piece of hardware, which the loop can not hold up.
    Board = 90,
    /// The board's clock.
    BoardClock = 99,
}

/// Gives this thread its share, and checks that it has it: in virtual time no figure would tell.
pub fn fifo(share: Fifo) {
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority = (share as u8).try_into().map(ThreadPriority::Crossplatform);
    let priority = priority.expect("a priority");
    set_thread_priority_and_policy(thread_native_id(), priority, policy).expect("SCHED_FIFO");
    assert_eq!(thread_schedule_policy(), Ok(policy));
}

//! What one level shares with another that interrupts it: flags and queues, each access of which goes through here.
//!
//! With the feature `explore`, a test is asked before each access whether a higher level is to run there. Between two
//! accesses it cannot matter. Without the feature, nothing of this is left.

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use heapless::spsc::{Consumer, Producer};

/// Here a higher level may interrupt.
#[inline(always)]
fn preemption_point() {
    #[cfg(feature = "explore")]
    explore::ask();
}

/// A flag that several levels look at.
#[derive(Debug)]
pub(crate) struct Flag(AtomicBool);

impl Flag {
    pub(crate) const fn lowered() -> Self {
        Self(AtomicBool::new(false))
    }

    pub(crate) fn set(&self, raised: bool) {
        preemption_point();
        self.0.store(raised, Relaxed);
    }

    pub(crate) fn is_raised(&self) -> bool {
        preemption_point();
        self.0.load(Relaxed)
    }
}

impl Default for Flag {
    fn default() -> Self {
        Self::lowered()
    }
}

/// The giving end of a queue.
pub(crate) struct Giver<'q, T>(pub(crate) Producer<'q, T>);

impl<T> Giver<'_, T> {
    pub(crate) fn enqueue(&mut self, item: T) -> Result<(), T> {
        preemption_point();
        self.0.enqueue(item)
    }

    /// Whether there is room.
    pub(crate) fn ready(&self) -> bool {
        preemption_point();
        self.0.ready()
    }

    /// How much room there is.
    pub(crate) fn room(&self) -> usize {
        preemption_point();
        self.0.capacity() - self.0.len()
    }
}

/// The taking end of a queue.
pub(crate) struct Taker<'q, T>(pub(crate) Consumer<'q, T>);

impl<T> Taker<'_, T> {
    pub(crate) fn dequeue(&mut self) -> Option<T> {
        preemption_point();
        self.0.dequeue()
    }

    /// Whether something is there.
    pub(crate) fn ready(&self) -> bool {
        preemption_point();
        self.0.ready()
    }
}

/// For tests that try every order of levels.
#[cfg(feature = "explore")]
pub mod explore {
    use core::cell::Cell;

    std::thread_local! {
        static HOOK: Cell<Option<fn()>> = const { Cell::new(None) };
    }

    /// What is called before each access of this thread from now on.
    pub fn before_each_access(hook: Option<fn()>) {
        HOOK.set(hook);
    }

    #[inline]
    pub(super) fn ask() {
        if let Some(hook) = HOOK.get() {
            hook();
        }
    }
}

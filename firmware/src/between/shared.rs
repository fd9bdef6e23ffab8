//! What one level shares with another that interrupts it: flags and queues, each access of which
//! goes through here.
//!
//! With the feature `explore`, a test decides before each access whether a higher level runs there;
//! between accesses it makes no difference. Without the feature this compiles to nothing.

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use heapless::spsc::{Consumer, Producer};

/// A higher level may interrupt here.
#[inline(always)]
fn preemption_point() {
    #[cfg(feature = "explore")]
    explore::ask();
}

/// A flag shared by levels.
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

/// Producer of a queue.
pub(crate) struct Giver<'q, T>(pub(crate) Producer<'q, T>);

impl<T> Giver<'_, T> {
    pub(crate) fn enqueue(&mut self, item: T) -> Result<(), T> {
        preemption_point();
        self.0.enqueue(item)
    }

    /// Whether it has room.
    pub(crate) fn ready(&self) -> bool {
        preemption_point();
        self.0.ready()
    }

    /// Free places.
    pub(crate) fn room(&self) -> usize {
        preemption_point();
        self.0.capacity() - self.0.len()
    }
}

/// Consumer of a queue.
pub(crate) struct Taker<'q, T>(pub(crate) Consumer<'q, T>);

impl<T> Taker<'_, T> {
    pub(crate) fn dequeue(&mut self) -> Option<T> {
        preemption_point();
        self.0.dequeue()
    }

    /// Whether it has an item.
    pub(crate) fn ready(&self) -> bool {
        preemption_point();
        self.0.ready()
    }
}

/// Hooks for tests that try every order of levels.
#[cfg(feature = "explore")]
pub mod explore {
    use core::cell::Cell;

    std::thread_local! {
        static HOOK: Cell<Option<fn()>> = const { Cell::new(None) };
    }

    /// Sets the function called before each access of this thread.
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

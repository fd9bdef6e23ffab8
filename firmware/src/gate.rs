//! What pulse timer, tick and link tell each other without waiting for each other.

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Flags between levels of one core, of which one interrupts the other: each is set by one side, and cleared by
/// the other or by the same.
#[derive(Debug, Default)]
pub struct Gate {
    /// The tick allows current.
    open: AtomicBool,
    /// The tick has allowed it again.
    renewed: AtomicBool,
    /// The output stage did not answer when it was last spoken to.
    output_failed: AtomicBool,
    /// The pulse timer did not hear of the tick for too long, or its own interrupt came too late.
    late: AtomicBool,
    /// Memory has changed a plan on its way to the pulse timer, or there.
    plan_lost: AtomicBool,
    /// The link has acted upon a frame of the host's.
    heard: AtomicBool,
}

impl Gate {
    /// Shut.
    pub const fn new() -> Self {
        let no = AtomicBool::new;
        Self {
            open: no(false),
            renewed: no(false),
            output_failed: no(false),
            late: no(false),
            plan_lost: no(false),
            heard: no(false),
        }
    }

    pub(crate) fn set_open(&self, open: bool) {
        self.open.store(open, Relaxed);
    }

    pub(crate) fn is_open(&self) -> bool {
        self.open.load(Relaxed)
    }

    pub(crate) fn renew(&self) {
        self.renewed.store(true, Relaxed);
    }

    /// Whether the tick has allowed it since this was asked last. Only for the pulse timer, which the tick cannot
    /// interrupt.
    pub(crate) fn take_renewed(&self) -> bool {
        let renewed = self.renewed.load(Relaxed);
        self.renewed.store(false, Relaxed);
        renewed
    }

    pub(crate) fn set_output_failed(&self, failed: bool) {
        self.output_failed.store(failed, Relaxed);
    }

    pub(crate) fn output_failed(&self) -> bool {
        self.output_failed.load(Relaxed)
    }

    pub(crate) fn set_heard(&self) {
        self.heard.store(true, Relaxed);
    }

    /// Whether the host was heard of since this was asked last. Only for the tick, which the link cannot interrupt.
    pub(crate) fn take_heard(&self) -> bool {
        let heard = self.heard.load(Relaxed);
        self.heard.store(false, Relaxed);
        heard
    }

    pub(crate) fn set_late(&self, late: bool) {
        self.late.store(late, Relaxed);
    }

    pub(crate) fn is_late(&self) -> bool {
        self.late.load(Relaxed)
    }

    pub(crate) fn set_plan_lost(&self, lost: bool) {
        self.plan_lost.store(lost, Relaxed);
    }

    pub(crate) fn is_plan_lost(&self) -> bool {
        self.plan_lost.load(Relaxed)
    }
}

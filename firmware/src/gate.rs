//! What pulse timer, tick and link tell each other without waiting for each other.

use crate::shared::Flag;

/// Flags between levels of one core, of which one interrupts the other: each is set by one side, and cleared by
/// the other or by the same.
#[derive(Debug, Default)]
pub struct Gate {
    /// The tick allows current.
    open: Flag,
    /// The tick has allowed it again.
    renewed: Flag,
    /// The output stage did not answer when it was last spoken to.
    output_failed: Flag,
    /// The pulse timer did not hear of the tick for too long, or its own interrupt came too late.
    late: Flag,
    /// Memory has changed a plan on its way to the pulse timer, or there.
    plan_lost: Flag,
    /// The link has acted upon a frame of the host's.
    heard: Flag,
}

impl Gate {
    /// Shut.
    pub const fn new() -> Self {
        let no = Flag::lowered;
        Self {
            open: no(),
            renewed: no(),
            output_failed: no(),
            late: no(),
            plan_lost: no(),
            heard: no(),
        }
    }

    pub(crate) fn set_open(&self, open: bool) {
        self.open.set(open);
    }

    pub(crate) fn is_open(&self) -> bool {
        self.open.is_raised()
    }

    pub(crate) fn renew(&self) {
        self.renewed.set(true);
    }

    /// Whether the tick has allowed it since this was asked last. Only for the pulse timer, which the tick cannot
    /// interrupt.
    pub(crate) fn take_renewed(&self) -> bool {
        let renewed = self.renewed.is_raised();
        self.renewed.set(false);
        renewed
    }

    pub(crate) fn set_output_failed(&self, failed: bool) {
        self.output_failed.set(failed);
    }

    pub(crate) fn output_failed(&self) -> bool {
        self.output_failed.is_raised()
    }

    pub(crate) fn set_heard(&self) {
        self.heard.set(true);
    }

    /// Whether the host was heard of since this was asked last. Only for the tick, which the link cannot interrupt.
    pub(crate) fn take_heard(&self) -> bool {
        let heard = self.heard.is_raised();
        self.heard.set(false);
        heard
    }

    pub(crate) fn set_late(&self, late: bool) {
        self.late.set(late);
    }

    pub(crate) fn is_late(&self) -> bool {
        self.late.is_raised()
    }

    pub(crate) fn set_plan_lost(&self, lost: bool) {
        self.plan_lost.set(lost);
    }

    pub(crate) fn is_plan_lost(&self) -> bool {
        self.plan_lost.is_raised()
    }
}

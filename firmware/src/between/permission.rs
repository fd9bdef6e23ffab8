//! Flags between pulse timer, tick and link, without waiting.

use crate::between::shared::Flag;

/// Flags between interrupt levels of one core. Each is set by one side and cleared by one side.
#[derive(Debug, Default)]
pub struct Permission {
    /// The tick permits current.
    open: Flag,
    /// The tick has renewed the permission.
    renewed: Flag,
    /// The output stage did not answer the last command.
    output_failed: Flag,
    /// A permission expired, or the pulse timer's interrupt was late.
    late: Flag,
    /// The checksum of a plan failed.
    plan_lost: Flag,
    /// A frame of the host was acted upon.
    heard: Flag,
}

impl Permission {
    /// Closed: no current.
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

    /// Whether the permission was renewed since the last call. Only for the pulse timer, which the
    /// tick cannot interrupt.
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

    /// Whether the host was heard since the last call. Only for the tick, which the link cannot
    /// interrupt.
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

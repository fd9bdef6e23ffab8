//! Names of faults.

use serde::{Deserialize, Serialize};

/// A latched fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Fault {
    /// After every start, also after a stack overflow or a fault of the core.
    Boot,
    /// A request exceeded the amplitude limit.
    Amplitude,
    /// A request exceeded the width limit.
    Width,
    /// A request exceeded the frequency limit.
    Frequency,
    /// A request exceeded the limit of charge per phase.
    Charge,
    /// A request exceeded the limit of r.m.s. current.
    RootMeanSquare,
    /// The session of stimulation without a rest reached its limit.
    Session,
    /// The host was silent for longer than its limit.
    Silence,
    /// An electrode's impedance is below its limit.
    ElectrodeShort,
    /// An electrode's impedance is above its limit.
    ElectrodeOpen,
    /// The supply voltage is out of range.
    Supply,
    /// A sensor gives no reading, or the last one is too old.
    SensorMissing,
    /// The reading is out of range.
    SensorRange,
    /// The reading changed faster than the path can.
    SensorJump,
    /// The reading has not changed for too long.
    SensorStuck,
    /// The last tick was late or did not finish.
    Deadline,
    /// The watchdog restarted the controller.
    Watchdog,
    /// A checksum failed: of state, parameters, limits, scale, rows, drives or plans.
    Checksum,
    /// The output stage did not answer.
    Output,
    /// The stimulator cannot do the requested stimulus, or it is not finite.
    Request,
    /// Stopped by the host: no fault, but arming takes the same two steps.
    Stopped,
    /// The row in force is too old: rows stopped coming, or their traces were not taken.
    StaleRow,
    /// The drive in force is too old: the host did not repeat it.
    StaleDrive,
    /// Time stamps of the joint's angle contradict its stated rate or the ticks.
    SensorTime,
    /// The target in force is too old.
    StaleTarget,
    /// The controller's estimate of the muscles' gain is out of its range or not finite.
    Gain,
}

impl Fault {
    /// Transient fault: latched while acknowledged, because arming checks only the latest tick.
    pub(crate) fn is_transient(self) -> bool {
        matches!(self, Self::Checksum | Self::Deadline | Self::Output)
    }
}

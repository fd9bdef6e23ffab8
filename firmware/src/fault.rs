//! What can go wrong, by name.

use serde::{Deserialize, Serialize};

/// What went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Fault {
    /// Nothing yet: this is how everything starts.
    Boot,
    /// An amplitude beyond its limit was asked for.
    Amplitude,
    /// A width.
    Width,
    /// A frequency.
    Frequency,
    /// A charge per phase.
    Charge,
    /// A mean square of current.
    RootMeanSquare,
    /// Stimulation without a rest has lasted as long as it may.
    Session,
    /// The host was silent for too long.
    Silence,
    /// An electrode is shorted.
    ElectrodeShort,
    /// An electrode has come off.
    ElectrodeOpen,
    /// The supply is out of its range.
    Supply,
    /// The sensor gives no number.
    SensorMissing,
    /// The sensor's number is out of its range.
    SensorRange,
    /// It jumped.
    SensorJump,
    /// It is stuck.
    SensorStuck,
    /// The tick before was late or did not finish.
    Deadline,
    /// The watchdog had to restart the controller.
    Watchdog,
    /// Memory has lost a bit: of state, parameters, limits, scale, rows, drives or plans.
    Checksum,
    /// The output stage did not answer.
    Output,
    /// A stimulus was asked for that the stimulator cannot do, or that is not a number.
    Request,
    /// Somebody has stopped it, which is not a fault, and takes the same two steps to go on.
    Stopped,
    /// The last row whose stimulus is put out is too old: rows stopped coming, or their traces were not taken.
    StaleRow,
    /// The drive whose stimulus is put out is too old: the host did not repeat it.
    StaleDrive,
}

impl Fault {
    /// May have been there for a tick only, and is not to be missed for that: arming looks at the last tick.
    pub(crate) fn is_of_a_moment(self) -> bool {
        matches!(self, Self::Checksum | Self::Deadline | Self::Output)
    }
}

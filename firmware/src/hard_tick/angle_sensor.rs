//! The sensor of the joint's angle: the host over the link, or one of the board.

use crate::between::guarded::Guarded;
use crate::between::motion::AngleReading;
use crate::between::shared::Taker;

/// A sensor of the joint's angle.
///
/// A converter or an inertial unit of the board puts its readings together in an interrupt of its
/// own and hands them over here; the guard goes around a value as early as it is known to be right.
pub trait AngleSensor {
    /// The newest reading since the last call, if there is one. The hard tick calls it once: it
    /// must not wait.
    fn read(&mut self) -> Option<Guarded<AngleReading>>;
}

/// No sensor gives no reading.
impl<A: AngleSensor> AngleSensor for Option<A> {
    fn read(&mut self) -> Option<Guarded<AngleReading>> {
        self.as_mut()?.read()
    }
}

/// The host: readings come over the link.
pub struct HostSensor<'q>(pub(crate) Taker<'q, Guarded<AngleReading>>);

impl AngleSensor for HostSensor<'_> {
    fn read(&mut self) -> Option<Guarded<AngleReading>> {
        let mut newest = None;
        // As many as the queue holds at most.
        while let Some(reading) = self.0.dequeue() {
            newest = Some(reading);
        }
        newest
    }
}

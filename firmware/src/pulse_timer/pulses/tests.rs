//! What a halt leaves: nothing, also of what waits.

use super::Pulses;
use crate::between::guarded::Guarded;
use crate::between::limits::Limits;
use crate::between::permission::Permission;
use crate::between::plan::{Plan, PlanQueue};
use crate::between::stimulus::{Scale, Stimulus};
use crate::pulse_timer::output::{Bridge, OutputStage};
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType as PinErrorType, OutputPin};
use embedded_hal::spi::{ErrorType as SpiErrorType, Operation, SpiDevice};

/// A converter or a pin that takes everything.
struct Patient;

impl SpiErrorType for Patient {
    type Error = Infallible;
}

impl SpiDevice for Patient {
    fn transaction(&mut self, _: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        Ok(())
    }
}

impl PinErrorType for Patient {
    type Error = Infallible;
}

impl OutputPin for Patient {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

#[test]
fn a_halt_throws_away_the_plans_that_wait() {
    let bridge = Bridge { cathodic: Patient, anodic: Patient };
    let stage = OutputStage::new(Patient, bridge, [Patient, Patient, Patient, Patient]);
    let scale = Scale { full_scale_ua: 50_000, full_scale_counts: 4095 };
    let stimulus = Stimulus {
        amplitude_ua: 10_000,
        width_us: 200,
        gap_us: 50,
        frequency_tenths_pps: 400,
        recovery: 1,
    };
    let plan =
        Plan::new(&[Some(stimulus), None, None, None], &scale, &Limits::SURFACE).expect("a plan");
    let mut queue = PlanQueue::new();
    let permission = Permission::new();
    let (mut give, take) = queue.split();
    let mut pulses = Pulses::new(stage.expect("a stage"), take, &permission, 1000);
    // A permission that is open leaves them for the next step; one that is shut does not.
    permission.set_open(true);
    for _ in 0..3 {
        assert!(give.enqueue(Guarded::new(plan)).is_ok());
    }
    pulses.attend();
    assert_eq!(give.len(), 3);
    permission.set_open(false);
    pulses.attend();
    assert_eq!(give.len(), 0);
}

//! What the pulse timer and the link have said of themselves is seen by the next tick, and not
//! forgotten before.

use super::Controller;
use crate::between::fault::Fault;
use crate::between::limits::Limits;
use crate::between::permission::Permission;
use crate::between::plan::PlanQueue;
use crate::between::stimulus::Scale;
use crate::config::CHANNELS;
use crate::hard_tick::safety::{NotArmed, Observed, Requested, State};
use std::boxed::Box;

const SCALE: Scale = Scale { full_scale_ua: 50_000, full_scale_counts: 4095 };

const OBSERVED: Observed = Observed {
    host_heard: true,
    impedance_ohm: [None; CHANNELS],
    supply_mv: 3700,
    path_um: Some(160_000),
    path_is_new: true,
    angle: None,
    in_time: true,
    memory_is_intact: true,
    output_answers: true,
};

/// Armed, and the flags that the pulse timer raises.
fn armed() -> (Controller<'static>, &'static Permission) {
    let queue: &'static mut PlanQueue = Box::leak(Box::default());
    let permission: &'static Permission = Box::leak(Box::default());
    let (give, _) = queue.split();
    let limits = Limits::SURFACE.within_scale(&SCALE);
    let controller = Controller::new(limits, 1000, Fault::Boot, SCALE, give, permission);
    let mut controller = controller.expect("valid limits");
    assert!(!controller.tick(&OBSERVED, &Requested::NOTHING));
    controller.acknowledge(Fault::Boot).expect("its name");
    controller.arm().expect("nothing is wrong");
    assert!(controller.tick(&OBSERVED, &Requested::NOTHING));
    (controller, permission)
}

#[test]
fn what_the_pulse_timer_says_is_a_fault_of_the_next_tick() {
    type Raise = fn(&Permission, bool);
    let cases: [(Fault, Raise); 3] = [
        (Fault::Checksum, Permission::set_plan_lost),
        (Fault::Output, Permission::set_output_failed),
        (Fault::Deadline, Permission::set_late),
    ];
    for (fault, raise) in cases {
        let (mut controller, permission) = armed();
        raise(permission, true);
        assert!(!controller.tick(&OBSERVED, &Requested::NOTHING), "{fault:?}");
        assert_eq!(controller.state(), State::Latched(fault));
        assert!(!permission.is_open());
        // What was late, or a plan that was lost, is over when it has been acknowledged; an output
        // has to answer.
        controller.acknowledge(fault).expect("its name");
        assert!(!controller.tick(&OBSERVED, &Requested::NOTHING));
        if fault == Fault::Output {
            assert_eq!(controller.arm(), Err(NotArmed::StillThere(fault)));
            raise(permission, false);
            assert!(!controller.tick(&OBSERVED, &Requested::NOTHING));
        }
        assert_eq!(controller.arm(), Ok(()), "{fault:?}");
    }
}

/// A scale that has lost a bit allows no arming, although nothing is to be put out.
#[test]
fn a_scale_that_lost_a_bit_is_no_scale() {
    let (mut controller, _) = armed();
    controller.corrupt_scale();
    controller.fail(Fault::Stopped);
    controller.acknowledge(Fault::Stopped).expect("its name");
    assert!(!controller.tick(&OBSERVED, &Requested::NOTHING));
    assert_eq!(controller.wrong(), Some(Fault::Checksum));
    assert!(controller.arm().is_err());
}

#[test]
fn the_host_is_heard_once() {
    let (controller, permission) = armed();
    assert!(!controller.take_heard());
    permission.set_heard();
    assert!(controller.take_heard());
    assert!(!controller.take_heard());
}

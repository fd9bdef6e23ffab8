//! Saved states and checksums of the FES controller.

use model_tests::knee::*;
use vm_nostd::control::*;
use vm_nostd::*;

const STEP: TimeStep = TimeStep::MILLISECOND;

fn saved<S: Scalar>() {
    let mut with_feedback = params();
    with_feedback.feedback = PiParams { proportional: 30.0, integral: 60.0, most: 40.0, ..NONE };
    with_feedback.fatigue[0] = None;
    let controller = FesController::<S, 2>::build(&with_feedback, STEP).expect("a controller");
    let mut state = controller.start(S::from_f64(0.5));
    let run = |state: &mut _, tick: i32| {
        let time = f64::from(tick) * 1e-3;
        controller.step(state, still(0.6 + 0.4 * time.sin()), sensed(0.6 + 0.3 * time.sin()))
    };
    for tick in 0..3000 {
        run(&mut state, tick);
    }
    let words: Vec<S::Bits> = controller.save(&state).collect();
    assert_eq!(words.len(), controller.saved_words());
    let mut restored = controller.restore(words.iter().copied()).expect("a saved state");
    for tick in 3000..3500 {
        assert_eq!(run(&mut state, tick), run(&mut restored, tick));
    }
    assert_eq!(state, restored);
    let short = controller.restore(words[1..].iter().copied());
    assert!(matches!(short, Err(RestoreError::OtherMuscle { .. })), "{short:?}");
    let short = controller.restore(words[..words.len() - 1].iter().copied());
    assert_eq!(short, Err(RestoreError::Length { expected: words.len() }));
    with_feedback.feedback.integral = 61.0;
    let other = FesController::<S, 2>::build(&with_feedback, STEP).expect("a controller");
    assert!(other.restore(words.iter().copied()).is_err());
    // What only the inverse knows of a muscle.
    with_feedback.feedback.integral = 60.0;
    with_feedback.muscles[1].fibers[0].fiber_type.force_length.width *= 1.01;
    let other = FesController::<S, 2>::build(&with_feedback, STEP).expect("a controller");
    assert_ne!(other.checksum(), controller.checksum());
    let refused = other.restore(words.iter().copied());
    assert!(matches!(refused, Err(RestoreError::OtherMuscle { .. })), "{refused:?}");
    let mut beyond = words;
    beyond[2] = S::from_f64(2.0).to_bits();
    assert_eq!(controller.restore(beyond), Err(RestoreError::Value { word: 2 }));
}

#[test]
fn saved_states_continue_with_the_same_bits() {
    saved::<f32>();
    saved::<Fixed>();
}

/// A small change of any parameter changes the checksum of the coefficients, also of what only the
/// muscles' inverse has; and every tick that of the state.
#[test]
fn checksums_cover_controller_and_state() {
    let sum = |params: &FesControllerParams<2>| {
        FesController::<f32, 2>::build(params, STEP).expect("a controller").checksum()
    };
    let of_types: [fn(&mut vm_nostd::FiberType); 4] = [
        |t| t.activation.scale *= 1.01,
        |t| t.force_length.width *= 1.01,
        |t| t.half_force_frequency *= 1.01,
        |t| t.excitation.rise *= 1.01,
    ];
    for change in of_types {
        let mut changed = params();
        change(&mut changed.muscles[1].fibers[0].fiber_type);
        assert_ne!(sum(&params()), sum(&changed));
    }
    let of_controllers: [fn(&mut FesControllerParams<2>); 7] = [
        |p| p.muscles[0].elements.tendon.stiffness *= 1.01,
        |p| p.muscles[0].elements.parallel.stiffness *= 1.01,
        |p| p.electrodes[1].slope *= 1.01,
        |p| p.limb.gravity += 0.1,
        |p| p.cocontraction += 0.1,
        |p| p.stimulation_frequency += 0.1,
        |p| p.feedback.proportional += 0.1,
    ];
    for change in of_controllers {
        let mut changed = params();
        change(&mut changed);
        assert_ne!(sum(&params()), sum(&changed));
    }
    let controller = FesController::<f32, 2>::build(&params(), STEP).expect("a controller");
    let mut state = controller.start(0.5);
    let before = (state.checksum(), state.words().count());
    controller.step(&mut state, still(0.6), sensed(0.5));
    assert_ne!(state.checksum(), before.0);
    assert_eq!(state.words().count(), before.1);
}

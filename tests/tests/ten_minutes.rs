//! Fixed point does not drift: after ten minutes it agrees with the reference.
//!
//! CI runs this a second time in a profile that checks every addition for overflow.

use host_sim::engine::{self, Arithmetic};
use host_sim::reference::{Input as ReferenceInput, Mode};
use host_sim::scenario::paper_muscle;
use host_sim::trace::InputTrace;
use vm_nostd::{
    Fixed, Input, IntramuscularFes, Muscle, NaturalContinuous, Recruitment, Scalar, TimeStep,
};
use vm_nostd_cores::MUSCLE;

/// Steady force of the reference, N, at a constant input.
fn settled(mode: Mode, input: ReferenceInput) -> f64 {
    let muscle = paper_muscle();
    let inputs = vec![input; 8_001];
    let trace = InputTrace { start: 0.0, time_step: 1e-3, inputs };
    let rows = engine::run(&muscle, mode, Arithmetic::Reference, &trace).expect("a run");
    rows.last().expect("rows").0.force
}

/// Force after ten minutes of a constant input, N.
fn after_ten_minutes<R: Recruitment<Fixed, 2, Units = ()>>(input: ReferenceInput) -> f64 {
    let muscle = Muscle::<Fixed, R, 2>::build(&MUSCLE, TimeStep::MILLISECOND).expect("a muscle");
    let input = Input::<Fixed> {
        activation: Scalar::from_f64(input.activation),
        path_length: Fixed::path_length(input.path_length),
        stimulation_frequency: <Fixed as Scalar>::quantity(input.stimulation_frequency),
    };
    let mut state = muscle.rest(input.path_length).expect("a path in range");
    let mut force = 0;
    for _ in 0..600_000 {
        force = muscle.step(&mut state, input).force;
    }
    Fixed::newtons(force)
}

#[test]
fn after_ten_minutes_of_constant_input_the_force_is_the_references() {
    let f0 = paper_muscle().f0();
    for activation in [0.05, 0.35, 0.8, 1.0] {
        let input = ReferenceInput { activation, path_length: 0.163, stimulation_frequency: 23.0 };
        for (mode, force) in [
            (Mode::Continuous, after_ten_minutes::<NaturalContinuous>(input)),
            (Mode::Fes, after_ten_minutes::<IntramuscularFes>(input)),
        ] {
            let error = 100.0 * (force - settled(mode, input)).abs() / f0;
            assert!(error <= 0.02, "{mode:?}, U {activation}: {error} % of F0");
        }
    }
}

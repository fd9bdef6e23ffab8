//! The inverse model of FES: its stimulation, applied to the reference, gives the requested steady
//! force.

use host_sim::engine::{self, Arithmetic};
use host_sim::model_muscle;
use host_sim::reference::{Input, Mode, Muscle};
use host_sim::scenario::paper_muscle;
use host_sim::trace::InputTrace;
use vm_nostd::{Fixed, Scalar, Status, SteadyFes};

const PATHS: [f64; 4] = [0.13, 0.145, 0.16, 0.175];
const FREQUENCIES: [f64; 3] = [8.0, 20.0, 45.0];
/// Time to settle, s.
const HELD: f64 = 4.0;

/// Final force of the reference, N.
fn held(muscle: &Muscle, activation: f64, path_length: f64, stimulation_frequency: f64) -> f64 {
    let input = Input { activation, path_length, stimulation_frequency };
    let time_step = 2e-3;
    let inputs = vec![input; (HELD / time_step) as usize];
    let trace = InputTrace { start: 0.0, time_step, inputs };
    let rows = engine::run(muscle, Mode::Fes, Arithmetic::Reference, &trace).expect("a run");
    rows.last().expect("a row").0.force
}

fn input<S: Scalar>(activation: f64, path: f64, frequency: f64) -> vm_nostd::Input<S> {
    vm_nostd::Input {
        activation: S::from_f64(activation),
        path_length: S::path_length(path),
        stimulation_frequency: S::quantity(frequency),
    }
}

/// A force in N, in an arithmetic.
fn force<S: Scalar>(newtons: f64) -> S::Force {
    S::from_newtons(newtons)
}

/// Largest errors of the steady force and of the inverse, % of F0.
fn errors<S: Scalar>(references: &[(f64, f64, f64, f64)]) -> [f64; 2] {
    let muscle = paper_muscle();
    let f0 = muscle.f0();
    let steady = SteadyFes::<S, 2>::build(&model_muscle::params(&muscle)).expect("a muscle");
    let (mut forward, mut inverse) = (0.0_f64, 0.0_f64);
    for &(activation, path, frequency, reference) in references {
        let found = steady.force(input(activation, path, frequency));
        assert!(found.status.is_empty(), "{:?}", found.status);
        forward = forward.max((S::newtons(found.force) - reference).abs());

        let wanted = force::<S>(reference);
        let (path_length, f) = (S::path_length(path), S::quantity(frequency));
        let found = steady.activation_for(wanted, path_length, f);
        if found.status.is_empty() {
            let got = held(&muscle, found.activation.to_f64(), path, frequency);
            inverse = inverse.max((got - reference).abs());
        } else {
            // At the ends of the reachable range the nearest force may be on either side.
            assert_eq!(found.status, Status::FORCE_UNREACHABLE);
            assert!([0.0, 1.0].contains(&activation), "U {activation} {path} m {frequency} pps");
            inverse = inverse.max((S::newtons(found.force) - reference).abs());
        }
    }
    [forward, inverse].map(|newtons| 100.0 * newtons / f0)
}

#[test]
fn the_reference_settles_at_the_requested_force() {
    let muscle = paper_muscle();
    let mut references = Vec::new();
    for path in PATHS {
        for frequency in FREQUENCIES {
            for activation in [0.0, 0.05, 0.3, 0.6, 0.9, 1.0] {
                let force = held(&muscle, activation, path, frequency);
                references.push((activation, path, frequency, force));
            }
        }
    }
    let (single, fixed) = (errors::<f32>(&references), errors::<Fixed>(&references));
    let within = |found: [f64; 2], most: [f64; 2]| found[0] <= most[0] && found[1] <= most[1];
    assert!(within(single, [1.6e-4, 1.5e-4]), "{single:?}");
    assert!(within(fixed, [1.9e-3, 1.9e-3]), "{fixed:?}");
}

//! The measured cases: the model's tick and its baselines.

use super::adversarial;
use crate::engine::{self, Arithmetic, Class, RunError};
use crate::metrics::{ForceError, forces};
use crate::reference::Mode;
use crate::scenario::{self, Scenario, paper_muscle};
use crate::tolerance;
use literal_port::{Drive, LiteralMuscle, Real, STABLE_STEPS};
use rayon::prelude::*;
use std::collections::BTreeSet;
use vm_nostd::control::FesControllerState;
use vm_nostd::{EffectiveLength, FascicleLength, Fixed, NaturalContinuous, NaturalDiscrete, State};

/// What a case computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// A tick of the model.
    Model(Mode, Arithmetic),
    /// A tick of the literal port, in single or double precision.
    Literal(Mode, Arithmetic),
    /// A tick of the model in `f32` with this number of motor units of each of two types.
    Discrete(usize),
    /// The same with the effective length of each unit.
    EffectiveLength(usize),
    /// The libm calls of one evaluation of the equations.
    Kernels,
    /// A tick of the FES controller of an elbow: two muscles of two types, fatigue, gain estimate.
    Controller(Arithmetic),
}

/// What a case is measured on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measured {
    /// All ticks of all scenarios.
    All,
    /// So many ticks of [`BASELINE_SCENARIO`].
    Excerpt(usize),
    /// The adversarial inputs, as targets and sensors.
    Adversarial,
}

/// State size in bytes for a type of acting length and a number of motor units of each of two
/// types: `units per type => units in total`.
macro_rules! bytes_of_units {
    ($length:ty, $count:expr, $($each:literal => $all:literal),*) => {
        match $count {
            $($each => size_of::<State<f32, NaturalDiscrete<$length, $all>, 2>>(),)*
            other => unreachable!("no case has {other} units"),
        }
    };
}

/// One row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Case {
    /// Unique name.
    pub name: &'static str,
    /// Function of the bench.
    pub function: &'static str,
    /// Computation that is measured.
    pub subject: Subject,
    /// Its inputs.
    pub measured: Measured,
}

/// Every case, in the order of the bench.
pub const CASES: [Case; 21] = {
    use Arithmetic::{F32, F64, Fixed};
    use Measured::{Adversarial, All, Excerpt};
    use Mode::{Continuous, Fes};
    use Subject::{Controller, Discrete, EffectiveLength, Kernels, Literal, Model};
    const fn case(
        name: &'static str,
        function: &'static str,
        subject: Subject,
        measured: Measured,
    ) -> Case {
        Case { name, function, subject, measured }
    }
    // A baseline costs nearly the same on every tick, so an excerpt suffices.
    let (some, few) = (Excerpt(500), Excerpt(20));
    let figure = Excerpt(100);
    [
        case("continuous-f32", "step_continuous_f32", Model(Continuous, F32), All),
        case("fes-f32", "step_fes_f32", Model(Fes, F32), All),
        case("continuous-fixed", "step_continuous_fixed", Model(Continuous, Fixed), All),
        case("fes-fixed", "step_fes_fixed", Model(Fes, Fixed), All),
        case("literal-continuous-f32", "literal_continuous_f32", Literal(Continuous, F32), some),
        case("literal-fes-f32", "literal_fes_f32", Literal(Fes, F32), some),
        case("literal-continuous-f64", "literal_continuous_f64", Literal(Continuous, F64), few),
        case("literal-fes-f64", "literal_fes_f64", Literal(Fes, F64), few),
        case("kernels-f32", "kernels_f32", Kernels, some),
        case("discrete-1+1-f32", "step_discrete_2_f32", Discrete(1), some),
        case("discrete-30+30-f32", "step_discrete_60_f32", Discrete(30), some),
        case("discrete-3+3-f32", "step_discrete_6_f32", Discrete(3), figure),
        case("discrete-6+6-f32", "step_discrete_12_f32", Discrete(6), figure),
        case("discrete-15+15-f32", "step_discrete_30_f32", Discrete(15), figure),
        case("leff-1+1-f32", "step_leff_2_f32", EffectiveLength(1), figure),
        case("leff-3+3-f32", "step_leff_6_f32", EffectiveLength(3), figure),
        case("leff-6+6-f32", "step_leff_12_f32", EffectiveLength(6), figure),
        case("leff-15+15-f32", "step_leff_30_f32", EffectiveLength(15), figure),
        case("leff-30+30-f32", "step_leff_60_f32", EffectiveLength(30), figure),
        case("controller-f32", "step_controller_f32", Controller(F32), Adversarial),
        case("controller-fixed", "step_controller_fixed", Controller(Fixed), Adversarial),
    ]
};

impl Case {
    /// Looks up a case.
    pub fn named(name: &str) -> Option<&'static Case> {
        CASES.iter().find(|case| case.name == name)
    }

    /// Its bit in [`Run::mask`].
    pub fn bit(&self) -> u32 {
        CASES.iter().position(|case| case == self).map_or(0, |index| 1 << index)
    }

    /// Recruitment mode of the model or literal port; `None` for the other cases.
    pub fn mode(&self) -> Option<Mode> {
        match self.subject {
            Subject::Model(mode, _) | Subject::Literal(mode, _) => Some(mode),
            Subject::Kernels
            | Subject::Discrete(_)
            | Subject::EffectiveLength(_)
            | Subject::Controller(_) => None,
        }
    }

    /// Arithmetic.
    pub fn arithmetic(&self) -> Arithmetic {
        match self.subject {
            Subject::Model(_, arithmetic)
            | Subject::Literal(_, arithmetic)
            | Subject::Controller(arithmetic) => arithmetic,
            Subject::Kernels | Subject::Discrete(_) | Subject::EffectiveLength(_) => {
                Arithmetic::F32
            }
        }
    }

    /// Whether it is the model.
    pub fn is_model(&self) -> bool {
        matches!(self.subject, Subject::Model(..))
    }

    /// Whether it has a budget on every core that it is measured on.
    pub fn has_budget(&self) -> bool {
        matches!(self.subject, Subject::Model(..) | Subject::Controller(_))
    }

    /// Whether it is listed in `docs/cycles.md`; the others serve figure 7 only.
    pub fn is_listed(&self) -> bool {
        !matches!(self.subject, Subject::EffectiveLength(_) | Subject::Discrete(3 | 6 | 15))
    }

    /// The module that holds the tables of its arithmetic.
    pub fn tables(&self) -> &'static str {
        match self.arithmetic() {
            Arithmetic::Fixed => "vm_nostd::scalar::fixed",
            _ => "vm_nostd::scalar::float::single",
        }
    }

    /// Bytes of a muscle's state.
    pub fn state_bytes(&self) -> u32 {
        let bytes = match (self.subject, self.arithmetic()) {
            (Subject::Kernels, _) => 0,
            (Subject::Controller(_), Arithmetic::Fixed) => size_of::<FesControllerState<Fixed>>(),
            (Subject::Controller(_), _) => size_of::<FesControllerState<f32>>(),
            (Subject::Discrete(units), _) => {
                bytes_of_units!(FascicleLength, units, 1 => 2, 3 => 6, 6 => 12, 15 => 30, 30 => 60)
            }
            (Subject::EffectiveLength(units), _) => {
                bytes_of_units!(EffectiveLength, units, 1 => 2, 3 => 6, 6 => 12, 15 => 30, 30 => 60)
            }
            (Subject::Model(..), Arithmetic::F64) => size_of::<State<f64, NaturalContinuous, 2>>(),
            (Subject::Model(..), Arithmetic::Fixed) => {
                size_of::<State<Fixed, NaturalContinuous, 2>>()
            }
            (Subject::Model(..), _) => size_of::<State<f32, NaturalContinuous, 2>>(),
            (Subject::Literal(..), Arithmetic::F64) => size_of::<LiteralMuscle<f64>>(),
            (Subject::Literal(..), _) => size_of::<LiteralMuscle<f32>>(),
        };
        bytes as u32
    }

    /// Largest force errors over the scenarios; `None` if the case computes no force.
    pub fn largest_errors(
        &self,
        scenarios: &[Scenario],
        class: Class,
    ) -> Result<Option<LargestErrors>, RunError> {
        let Some(mode) = self.mode() else { return Ok(None) };
        let errors: Vec<(bool, f64)> = scenarios
            .par_iter()
            .map(|scenario| {
                let run = |arithmetic| {
                    let Scenario { muscle, trace, .. } = scenario;
                    let rows = engine::run_in_class(muscle, mode, arithmetic, class, trace)?;
                    Ok::<_, RunError>(forces(rows.iter().map(|row| &row.0)))
                };
                let computed = match self.subject {
                    Subject::Literal(_, Arithmetic::F64) => {
                        literal_forces::<f64>(mode, STABLE_STEPS, scenario)
                    }
                    Subject::Literal(..) => literal_forces::<f32>(mode, STABLE_STEPS, scenario),
                    _ => run(self.arithmetic())?,
                };
                let expected = run(Arithmetic::Reference)?;
                let error = ForceError::between(&computed, &expected, scenario.muscle.f0()).max;
                // Without stimulation a muscle under FES is passive, and rings.
                let is_passive = mode == Mode::Fes && scenario.mode != Mode::Fes;
                Ok((is_passive || tolerance::rings(&scenario.name), error))
            })
            .collect::<Result<_, RunError>>()?;
        // NaN counts as the largest error.
        let larger = |a: f64, b: f64| if b.is_nan() || b > a { b } else { a };
        let smooth = errors.iter().filter(|(rings, _)| !rings).map(|(_, error)| *error);
        Ok(Some(LargestErrors {
            smooth: smooth.fold(0.0, larger),
            any: errors.iter().map(|(_, error)| *error).fold(0.0, larger),
        }))
    }
}

/// Largest force errors of a case, % of F0.
#[derive(Clone, Copy, Debug)]
pub struct LargestErrors {
    /// In scenarios without a ringing tendon.
    pub smooth: f64,
    /// In all scenarios.
    pub any: f64,
}

/// The scenarios of the measured accuracy: the paper's muscle at 1 kHz, as many as fit into the
/// bench's flash.
pub fn scenarios() -> Vec<Scenario> {
    let paper = paper_muscle();
    let mut all = scenario::all();
    // Their ticks are no more demanding than those of `velocity_kinks` and the adversarial run.
    let without = ["yield", "fast_ramps"];
    all.retain(|scenario| {
        let left_out = without.iter().any(|name| scenario.name.starts_with(name));
        !scenario.name.contains('@') && !left_out && scenario.muscle == paper
    });
    // Every case steps through all of them: the same inputs for another mode are the same.
    let mut names = BTreeSet::new();
    all.retain(|scenario| names.insert(scenario.name.clone()));
    all
}

/// A run of the bench: inputs and the cases that step through them.
#[derive(Clone, Debug)]
pub struct Run {
    /// The inputs; the muscle starts at rest on the first row.
    pub scenario: Scenario,
    /// Bits of the cases, see [`Case::bit`].
    pub mask: u32,
}

impl Run {
    /// Length, ticks.
    pub fn ticks(&self) -> usize {
        self.scenario.trace.inputs.len() - 1
    }
}

/// The scenario of the baselines: activation 0.6, 20 pps and a sinusoidal path at 10 Hz.
const BASELINE_SCENARIO: &str = "length_10hz";

/// All runs of the bench, in order of execution.
pub fn runs() -> Vec<Run> {
    let scenarios = scenarios();
    let mask_of = |wanted: fn(Measured) -> bool| {
        CASES.iter().filter(|case| wanted(case.measured)).fold(0, |mask, case| mask | case.bit())
    };
    let all = mask_of(|measured| measured == Measured::All);
    let adversarial = mask_of(|measured| !matches!(measured, Measured::Excerpt(_)));
    let baseline = scenarios.iter().find(|scenario| scenario.name == BASELINE_SCENARIO).cloned();
    let excerpts = CASES.iter().filter_map(|case| {
        let Measured::Excerpt(ticks) = case.measured else { return None };
        let mut scenario = baseline.clone()?;
        scenario.trace.inputs.truncate(ticks + 1);
        Some(Run { scenario, mask: case.bit() })
    });
    let excerpts: Vec<Run> = excerpts.collect();
    scenarios
        .into_iter()
        .map(|scenario| Run { scenario, mask: all })
        .chain([Run { scenario: adversarial::scenario(), mask: adversarial }])
        .chain(excerpts)
        .collect()
}

/// The runs of some of the cases.
pub fn runs_of(cases: &[Case]) -> Vec<Run> {
    let wanted = cases.iter().fold(0, |mask, case| mask | case.bit());
    let all = runs().into_iter().map(|run| Run { mask: run.mask & wanted, ..run });
    all.filter(|run| run.mask != 0).collect()
}

/// Forces of the literal port on a scenario of the paper's muscle, N.
fn literal_forces<R: Real + Into<f64>>(mode: Mode, steps: u32, scenario: &Scenario) -> Vec<f64> {
    let inputs = &scenario.trace.inputs;
    let mut muscle = LiteralMuscle::<R>::at_rest(R::of(inputs[0].path_length), steps);
    let mut forces = vec![muscle.force().into()];
    forces.extend(inputs[1..].iter().map(|input| {
        let [activation, path, frequency] =
            [input.activation, input.path_length, input.stimulation_frequency].map(R::of);
        let drive = match mode {
            Mode::Continuous => Drive::Natural(activation),
            Mode::Fes => Drive::Fes(activation, frequency),
            Mode::Discrete | Mode::DiscreteEffectiveLength => unreachable!("no such baseline"),
        };
        muscle.tick(drive, path).into()
    }));
    forces
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest error of the literal scheme in double precision, % of F0.
    fn error_with(steps: u32) -> f64 {
        let errors = scenarios().into_par_iter().map(|scenario| {
            let computed = literal_forces::<f64>(scenario.mode, steps, &scenario);
            let reference = engine::run(
                &scenario.muscle,
                scenario.mode,
                Arithmetic::Reference,
                &scenario.trace,
            );
            let expected = forces(reference.expect("a run").iter().map(|row| &row.0));
            ForceError::between(&computed, &expected, scenario.muscle.f0()).max
        });
        errors.reduce(|| 0.0, f64::max)
    }

    #[test]
    fn the_literal_port_takes_the_fewest_stable_steps() {
        assert!(error_with(STABLE_STEPS) <= 0.1, "stable");
        assert!(error_with(STABLE_STEPS - 1) > 0.1, "one step fewer is unstable");
    }

    #[test]
    fn names_and_functions_are_unique() {
        for case in &CASES {
            assert_eq!(Case::named(case.name), Some(case));
            assert_eq!(CASES.iter().filter(|other| other.function == case.function).count(), 1);
        }
    }

    #[test]
    fn the_model_runs_at_least_ten_thousand_ticks_and_baselines_an_excerpt() {
        for case in &CASES {
            let runs = runs();
            let of_case = runs.iter().filter(|run| run.mask & case.bit() != 0);
            let ticks: usize = of_case.map(Run::ticks).sum();
            match case.measured {
                Measured::All => assert!(ticks >= 10_000, "{}: {ticks}", case.name),
                Measured::Excerpt(some) => assert_eq!(ticks, some, "{}", case.name),
                Measured::Adversarial => assert_eq!(ticks, 6_000, "{}", case.name),
            }
        }
    }
}

//! What is measured: the model's tick, and what it is compared with.

use super::adversarial;
use crate::engine::{self, Arithmetic, Class, RunError};
use crate::metrics::{ForceError, forces};
use crate::reference::Mode;
use crate::scenario::{self, Scenario, paper_muscle};
use literal_port::{Drive, LiteralMuscle, Real, STABLE_STEPS};
use rayon::prelude::*;
use vm_nostd::{EffectiveLength, FascicleLength, NaturalContinuous, NaturalDiscrete, State};

/// What a case computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// A tick of the model.
    Model(Mode, Arithmetic),
    /// A tick of the literal port, in single or double precision.
    Literal(Mode, Arithmetic),
    /// A tick of the model in `f32` with so many motor units of each of two types.
    Discrete(usize),
    /// The same with an effective length of each unit.
    EffectiveLength(usize),
    /// The functions of libm that one evaluation of the equations calls.
    Kernels,
}

/// Bytes of the state of a muscle of so many motor units of each of two types, as a function of the
/// acting length.
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
    /// Its own name.
    pub name: &'static str,
    /// The bench's function.
    pub function: &'static str,
    /// What it computes.
    pub subject: Subject,
    /// Ticks of a moving muscle that are measured; `None`: all there are.
    pub ticks: Option<usize>,
}

/// Every case, in the order of the bench.
pub const CASES: [Case; 19] = {
    use Arithmetic::{F32, F64, Fixed};
    use Mode::{Continuous, Fes};
    use Subject::{Discrete, EffectiveLength, Kernels, Literal, Model};
    const fn case(
        name: &'static str,
        function: &'static str,
        subject: Subject,
        ticks: Option<usize>,
    ) -> Case {
        Case { name, function, subject, ticks }
    }
    // A tick of a baseline costs much the same whatever its inputs are: a few tell.
    let (some, few) = (Some(500), Some(20));
    let of_figure = Some(100);
    [
        case("continuous-f32", "step_continuous_f32", Model(Continuous, F32), None),
        case("fes-f32", "step_fes_f32", Model(Fes, F32), None),
        case("continuous-fixed", "step_continuous_fixed", Model(Continuous, Fixed), None),
        case("fes-fixed", "step_fes_fixed", Model(Fes, Fixed), None),
        case("literal-continuous-f32", "literal_continuous_f32", Literal(Continuous, F32), some),
        case("literal-fes-f32", "literal_fes_f32", Literal(Fes, F32), some),
        case("literal-continuous-f64", "literal_continuous_f64", Literal(Continuous, F64), few),
        case("literal-fes-f64", "literal_fes_f64", Literal(Fes, F64), few),
        case("kernels-f32", "kernels_f32", Kernels, some),
        case("discrete-1+1-f32", "step_discrete_2_f32", Discrete(1), some),
        case("discrete-30+30-f32", "step_discrete_60_f32", Discrete(30), some),
        case("discrete-3+3-f32", "step_discrete_6_f32", Discrete(3), of_figure),
        case("discrete-6+6-f32", "step_discrete_12_f32", Discrete(6), of_figure),
        case("discrete-15+15-f32", "step_discrete_30_f32", Discrete(15), of_figure),
        case("leff-1+1-f32", "step_leff_2_f32", EffectiveLength(1), of_figure),
        case("leff-3+3-f32", "step_leff_6_f32", EffectiveLength(3), of_figure),
        case("leff-6+6-f32", "step_leff_12_f32", EffectiveLength(6), of_figure),
        case("leff-15+15-f32", "step_leff_30_f32", EffectiveLength(15), of_figure),
        case("leff-30+30-f32", "step_leff_60_f32", EffectiveLength(30), of_figure),
    ]
};

impl Case {
    /// The case of a name.
    pub fn named(name: &str) -> Option<&'static Case> {
        CASES.iter().find(|case| case.name == name)
    }

    /// Its bit in the masks that go to the bench.
    pub fn bit(&self) -> u32 {
        CASES.iter().position(|case| case == self).map_or(0, |index| 1 << index)
    }

    /// Recruitment mode; none where it is no muscle.
    pub fn mode(&self) -> Option<Mode> {
        match self.subject {
            Subject::Model(mode, _) | Subject::Literal(mode, _) => Some(mode),
            Subject::Kernels | Subject::Discrete(_) | Subject::EffectiveLength(_) => None,
        }
    }

    /// What it is computed in.
    pub fn arithmetic(&self) -> Arithmetic {
        match self.subject {
            Subject::Model(_, arithmetic) | Subject::Literal(_, arithmetic) => arithmetic,
            Subject::Kernels | Subject::Discrete(_) | Subject::EffectiveLength(_) => {
                Arithmetic::F32
            }
        }
    }

    /// Whether it is the model, and thus held to a budget.
    pub fn is_model(&self) -> bool {
        matches!(self.subject, Subject::Model(..))
    }

    /// Whether it is in the README's table; the others are only for figure 7.
    pub fn is_listed(&self) -> bool {
        !matches!(self.subject, Subject::EffectiveLength(_) | Subject::Discrete(3 | 6 | 15))
    }

    /// The module whose constants are the tables of what it is computed in.
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
            (Subject::Discrete(units), _) => {
                bytes_of_units!(FascicleLength, units, 1 => 2, 3 => 6, 6 => 12, 15 => 30, 30 => 60)
            }
            (Subject::EffectiveLength(units), _) => {
                bytes_of_units!(EffectiveLength, units, 1 => 2, 3 => 6, 6 => 12, 15 => 30, 30 => 60)
            }
            (Subject::Model(..), Arithmetic::F64) => size_of::<State<f64, NaturalContinuous, 2>>(),
            (Subject::Model(..), Arithmetic::Fixed) => {
                size_of::<State<vm_nostd::Fixed, NaturalContinuous, 2>>()
            }
            (Subject::Model(..), _) => size_of::<State<f32, NaturalContinuous, 2>>(),
            (Subject::Literal(..), Arithmetic::F64) => size_of::<LiteralMuscle<f64>>(),
            (Subject::Literal(..), _) => size_of::<LiteralMuscle<f32>>(),
        };
        bytes as u32
    }

    /// Largest error of the force over the scenarios, % of F0; none where there is no force.
    pub fn largest_error(
        &self,
        scenarios: &[Scenario],
        class: Class,
    ) -> Result<Option<f64>, RunError> {
        let Some(mode) = self.mode() else { return Ok(None) };
        let errors: Vec<f64> = scenarios
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
                Ok(ForceError::between(&computed, &expected, scenario.muscle.f0()).max)
            })
            .collect::<Result<_, RunError>>()?;
        // A NaN is the largest error of all.
        let larger = |a: f64, b: f64| if b.is_nan() || b > a { b } else { a };
        Ok(Some(errors.into_iter().fold(0.0, larger)))
    }
}

/// The scenarios that accuracy is stated for: those of the paper's muscle at 1 kHz, as far as the
/// bench's flash has room for them.
pub fn scenarios() -> Vec<Scenario> {
    let paper = paper_muscle();
    let mut all = scenario::all();
    // Ticks no harder than those of `velocity_kinks` and the adversarial runs.
    let without = ["yield", "fast_ramps"];
    all.retain(|scenario| {
        let left_out = without.iter().any(|name| scenario.name.starts_with(name));
        !scenario.name.contains('@') && !left_out && scenario.muscle == paper
    });
    all
}

/// A run of the bench: inputs, and the cases that are driven through them.
#[derive(Clone, Debug)]
pub struct Run {
    /// The inputs; the first row is the muscle at rest.
    pub scenario: Scenario,
    /// Bits of the cases.
    pub mask: u32,
}

impl Run {
    /// Ticks it lasts.
    pub fn ticks(&self) -> usize {
        self.scenario.trace.inputs.len() - 1
    }
}

/// The scenario that baselines are timed on: 0.6 of activation, 20 pps and a path that swings at
/// 10 Hz.
const BASELINE_SCENARIO: &str = "length_10hz";

/// All runs of the bench, in its order.
pub fn runs() -> Vec<Run> {
    let scenarios = scenarios();
    let all = CASES.iter().filter(|case| case.ticks.is_none());
    let mask = all.fold(0, |mask, case| mask | case.bit());
    let of_baseline = scenarios.iter().find(|scenario| scenario.name == BASELINE_SCENARIO).cloned();
    let excerpts = CASES.iter().filter_map(|case| {
        let mut scenario = of_baseline.clone()?;
        scenario.trace.inputs.truncate(case.ticks? + 1);
        Some(Run { scenario, mask: case.bit() })
    });
    let excerpts: Vec<Run> = excerpts.collect();
    let hurting = adversarial::scenario();
    scenarios
        .into_iter()
        .chain([hurting])
        .map(|scenario| Run { scenario, mask })
        .chain(excerpts)
        .collect()
}

/// The runs that some of the cases are driven through.
pub fn runs_of(cases: &[Case]) -> Vec<Run> {
    let wanted = cases.iter().fold(0, |mask, case| mask | case.bit());
    let all = runs().into_iter().map(|run| Run { mask: run.mask & wanted, ..run });
    all.filter(|run| run.mask != 0).collect()
}

/// The literal port's forces on a scenario, N; its muscle is the paper's.
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
    fn the_literal_port_takes_no_more_steps_than_it_needs() {
        assert!(error_with(STABLE_STEPS) <= 0.1, "stable");
        assert!(error_with(STABLE_STEPS - 1) > 0.1, "a step fewer is not");
    }

    #[test]
    fn cases_are_their_own() {
        for case in &CASES {
            assert_eq!(Case::named(case.name), Some(case));
            assert_eq!(CASES.iter().filter(|other| other.function == case.function).count(), 1);
        }
    }

    #[test]
    fn the_model_is_driven_through_ten_thousand_ticks_and_baselines_through_an_excerpt() {
        for case in &CASES {
            let runs = runs();
            let of_case = runs.iter().filter(|run| run.mask & case.bit() != 0);
            let ticks: usize = of_case.map(Run::ticks).sum();
            match case.ticks {
                None => assert!(ticks >= 10_000, "{}: {ticks}", case.name),
                Some(some) => assert_eq!(ticks, some, "{}", case.name),
            }
        }
    }
}

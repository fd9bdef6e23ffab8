//! A muscle that runs, whatever its mode and arithmetic.

use crate::muscle::Definition;
use vm_nostd::{
    ActingLength, EffectiveLength, FascicleLength, Fixed, Input, IntramuscularFes, MotorUnits,
    Muscle, NaturalContinuous, NaturalDiscrete, Output, ParameterError, Recruitment, Scalar, State,
    Status, TimeStep, UnitSizes,
};

/// Fibre types of a muscle.
const TYPES: usize = 2;
/// Most motor units of a muscle.
const MOST_UNITS: usize = 64;
/// Words of a state before those of the types' gains, see [`State::words`].
const BEFORE_GAINS: usize = 6;

/// A muscle and its state.
pub trait Running {
    /// Steps by 1 ms; the bits of the status.
    fn step(&mut self, activation: f64, path_m: f64, frequency: f64) -> u16;
    /// Force (N), length (L_ce0), velocity (L_ce0/s), and the gain of each type (F0).
    fn output(&self, which: usize) -> f64;
    /// A curve at full activation, F0; see [`curve`](crate::curve).
    fn curve(&self, which: u32, x: f64) -> f64;
}

struct Stepped<S: Scalar, R: Recruitment<S, TYPES>> {
    muscle: Muscle<S, R, TYPES>,
    state: State<S, R, TYPES>,
    output: Output<S>,
    /// F0, N.
    force: f64,
    /// Shares of the types in the cross section.
    fractions: [f64; TYPES],
}

impl<S: Scalar, R: Recruitment<S, TYPES>> Running for Stepped<S, R> {
    fn step(&mut self, activation: f64, path_m: f64, frequency: f64) -> u16 {
        let input = Input {
            activation: S::from_f64(activation),
            path_length: S::path_length(path_m),
            stimulation_frequency: S::quantity(frequency),
        };
        self.output = self.muscle.step(&mut self.state, input);
        self.output.status.bits()
    }

    fn output(&self, which: usize) -> f64 {
        let output = &self.output;
        match which {
            0 => S::newtons_of(output.force, output.relative_force, self.force),
            1 => output.fascicle_length.to_f64(),
            2 => output.fascicle_velocity.to_f64(),
            _ => {
                let mut gains = self.state.words().skip(BEFORE_GAINS).take(TYPES);
                gains.nth(which - 3).map_or(f64::NAN, |word| S::from_bits(word).to_f64())
            }
        }
    }

    fn curve(&self, which: u32, x: f64) -> f64 {
        let curves = self.muscle.curves();
        let (length, velocity) =
            if which == 2 { (S::ONE, S::from_f64(x)) } else { (S::from_f64(x), S::ZERO) };
        let passive = curves.passive(length).to_f64();
        if which == 1 {
            return passive.max(0.0);
        }
        let active = |(index, fraction): (usize, &f64)| {
            curves.fiber(index).map_or(0.0, |fiber| {
                let force = fiber.force_length(length) * fiber.force_velocity(length, velocity);
                fraction * force.to_f64()
            })
        };
        let active: f64 = self.fractions.iter().enumerate().map(active).sum();
        (active + passive + curves.compression(length).to_f64()).max(0.0)
    }
}

/// A muscle at rest on a path (m), or why it is refused.
pub fn at_rest(
    definition: &Definition,
    arithmetic: u32,
    mode: u32,
    path_m: f64,
) -> Result<Box<dyn Running>, String> {
    let running = match arithmetic {
        0 => of_scalar::<f32>(definition, mode, path_m),
        1 => of_scalar::<Fixed>(definition, mode, path_m),
        _ => of_scalar::<f64>(definition, mode, path_m),
    };
    running.map_err(|refusal| refusal.to_string())
}

fn of_scalar<S: Scalar>(
    definition: &Definition,
    mode: u32,
    path_m: f64,
) -> Result<Box<dyn Running>, ParameterError> {
    match mode {
        0 => of_mode::<S, NaturalContinuous>(definition, &(), path_m),
        1 => of_mode::<S, IntramuscularFes>(definition, &(), path_m),
        2 => of_units::<S, FascicleLength>(definition, path_m),
        _ => of_units::<S, EffectiveLength>(definition, path_m),
    }
}

fn of_units<S: Scalar, A: ActingLength<S>>(
    definition: &Definition,
    path_m: f64,
) -> Result<Box<dyn Running>, ParameterError> {
    let sizes = [UnitSizes::Default(definition.units); TYPES];
    let units = MotorUnits::<MOST_UNITS>::new(&definition.params(), sizes)?;
    of_mode::<S, NaturalDiscrete<A, MOST_UNITS>>(definition, &units, path_m)
}

fn of_mode<S: Scalar, R: Recruitment<S, TYPES>>(
    definition: &Definition,
    units: &R::Units,
    path_m: f64,
) -> Result<Box<dyn Running>, ParameterError> {
    let params = definition.params();
    let muscle = Muscle::<S, R, TYPES>::build_with_units(&params, units, TimeStep::MILLISECOND)?;
    let state = muscle.rest(S::path_length(path_m))?;
    let output = muscle.observe(&state);
    let fractions = params.fibers.map(|fiber| fiber.fraction);
    let force = params.max_isometric_force();
    Ok(Box::new(Stepped { muscle, state, output, force, fractions }))
}

/// Name of a bit of a status; empty if it has none.
pub fn status_name(bit: u32) -> &'static str {
    let named = Status::all().iter_names().find(|(_, flag)| u32::from(flag.bits()) == 1 << bit);
    named.map_or("", |(name, _)| name)
}

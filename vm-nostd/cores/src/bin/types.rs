//! Muscles of one to six fibre types: the words that `tests/c/types.c` writes, too.

use std::io::{self, BufWriter, Write};
use vm_nostd::human_vm4::{ELEMENTS, FAST, SLOW, SUPER_SLOW};
use vm_nostd::{
    Class, FiberParams, FiberType, Fixed, Input, IntramuscularFes, Muscle, MuscleParams,
    NaturalContinuous, ParameterError, Recruitment, Scalar, TimeStep,
};

/// Ticks of each muscle.
const TICKS: u16 = 300;
/// The types of a muscle are the first of these.
const TYPES: [&FiberType; 6] = [&SUPER_SLOW, &SLOW, &SLOW, &FAST, &FAST, &FAST];

fn params<const N: usize>() -> MuscleParams<N> {
    let mut types = TYPES.iter();
    MuscleParams {
        mass: 97.5e-3,
        fascicle_length: 0.11,
        tendon_length: 0.02,
        max_path_length: 0.184,
        recruitment_saturation: 0.8,
        class: Class::Standard,
        elements: ELEMENTS,
        fibers: [(); N].map(|()| FiberParams {
            fraction: 1.0 / N as f64,
            fiber_type: **types.next().unwrap_or(&&FAST),
        }),
    }
}

/// An arithmetic with the inputs of a tick.
trait Inputs: Scalar<Bits = u32> {
    fn input(tick: u16) -> Input<Self>;
}

impl Inputs for f32 {
    fn input(tick: u16) -> Input<f32> {
        Input {
            activation: f32::from(tick % 65) / 64.0,
            path_length: 0.15625 + f32::from(tick % 33) / 4096.0,
            stimulation_frequency: f32::from(20 + tick % 16),
        }
    }
}

impl Inputs for Fixed {
    fn input(tick: u16) -> Input<Fixed> {
        let path = 156_250 + i32::from(tick % 33) * 244;
        Input::<Fixed>::from_integers(tick % 65 * 15, path, 200 + tick % 16 * 10)
    }
}

fn play<S: Inputs, R: Recruitment<S, N, Units = ()>, const N: usize>(
    to: &mut impl Write,
) -> Result<(), io::Error> {
    let refused = |error: ParameterError| io::Error::other(error);
    let muscle =
        Muscle::<S, R, N>::build(&params::<N>(), TimeStep::MILLISECOND).map_err(refused)?;
    let mut state = muscle.rest(S::input(0).path_length).map_err(refused)?;
    for tick in 0..TICKS {
        let output = muscle.step(&mut state, S::input(tick));
        let words = [
            S::force_bits(output.force),
            output.fascicle_length.to_bits(),
            output.fascicle_velocity.to_bits(),
            output.relative_force.to_bits(),
            output.status.bits().into(),
        ];
        words.iter().try_for_each(|word| to.write_all(&word.to_le_bytes()))?;
    }
    Ok(())
}

fn of_types<const N: usize>(to: &mut impl Write) -> io::Result<()> {
    play::<f32, NaturalContinuous, N>(to)?;
    play::<f32, IntramuscularFes, N>(to)?;
    play::<Fixed, NaturalContinuous, N>(to)?;
    play::<Fixed, IntramuscularFes, N>(to)
}

fn main() -> io::Result<()> {
    let mut to = BufWriter::new(io::stdout().lock());
    of_types::<1>(&mut to)?;
    of_types::<2>(&mut to)?;
    of_types::<3>(&mut to)?;
    of_types::<4>(&mut to)?;
    of_types::<5>(&mut to)?;
    of_types::<6>(&mut to)?;
    to.flush()
}

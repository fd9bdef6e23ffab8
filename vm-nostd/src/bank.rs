//! A bank of muscles, continuous or FES, stepped together.

use crate::io::{Input, Output};
use crate::muscle::{ContinuousMuscle, FesMuscle};
use crate::recruitment::{IntramuscularFes, NaturalContinuous};
use crate::scalar::Scalar;
use crate::state::State;
use core::fmt;
use heapless::Vec;

/// A muscle with its state.
#[derive(Clone, Copy, Debug)]
// The variants differ by a few words out of about a kilobyte.
#[allow(clippy::large_enum_variant)]
pub enum BankedMuscle<S: Scalar, const N: usize> {
    /// Natural continuous recruitment.
    Continuous(ContinuousMuscle<S, N>, State<S, NaturalContinuous, N>),
    /// Intramuscular FES.
    Fes(FesMuscle<S, N>, State<S, IntramuscularFes, N>),
}

impl<S: Scalar, const N: usize> BankedMuscle<S, N> {
    /// Checksum of the coefficients, see [`Muscle::checksum`](crate::Muscle::checksum).
    pub fn coefficients_checksum(&self) -> u32 {
        match self {
            Self::Continuous(muscle, _) => muscle.checksum(),
            Self::Fes(muscle, _) => muscle.checksum(),
        }
    }

    /// Checksum of the state, see [`State::checksum`].
    pub fn state_checksum(&self) -> u32 {
        match self {
            Self::Continuous(_, state) => state.checksum(),
            Self::Fes(_, state) => state.checksum(),
        }
    }

    /// Steps the muscle by one tick, see [`Muscle::step`](crate::Muscle::step).
    pub fn step(&mut self, input: Input<S>) -> Output<S> {
        match self {
            Self::Continuous(muscle, state) => muscle.step(state, input),
            Self::Fes(muscle, state) => muscle.step(state, input),
        }
    }
}

/// The bank is full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BankFull {
    /// Capacity, muscles.
    pub capacity: usize,
}

impl fmt::Display for BankFull {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the bank is full: it holds {} muscles", self.capacity)
    }
}

impl core::error::Error for BankFull {}

/// Up to `CAPACITY` muscles of `N` fibre types each, without a heap.
///
/// ```
/// use vm_nostd::{Bank, BankedMuscle, Class, FesMuscle, Fixed, Input, MuscleParams, TimeStep};
/// # use vm_nostd::paper_table_1::{ELEMENTS, FAST, SLOW};
/// # use vm_nostd::FiberParams;
/// # let params = MuscleParams {
/// #     mass: 97.5e-3, fascicle_length: 0.11, tendon_length: 0.02, max_path_length: 0.184,
/// #     recruitment_saturation: 0.8, class: Class::Standard, elements: ELEMENTS,
/// #     fibers: [
/// #         FiberParams { fraction: 0.6, fiber_type: SLOW },
/// #         FiberParams { fraction: 0.4, fiber_type: FAST },
/// #     ],
/// # };
/// let rest = Input::<Fixed>::from_integers(0, 160_000, 0);
/// let muscle = FesMuscle::build(&params, TimeStep::MILLISECOND)?;
/// let state = muscle.rest(rest.path_length)?;
/// let mut bank = Bank::<Fixed, 2, 8>::new();
/// bank.add(BankedMuscle::Fes(muscle, state))?;
///
/// // Every tick: one input per place; those of empty places are ignored.
/// let mut inputs = [rest; 8];
/// inputs[0] = Input::<Fixed>::from_integers(500, 160_000, 250);
/// let outputs = bank.step(&inputs);
/// assert_eq!(outputs.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Bank<S: Scalar, const N: usize, const CAPACITY: usize> {
    muscles: Vec<BankedMuscle<S, N>, CAPACITY>,
}

impl<S: Scalar, const N: usize, const CAPACITY: usize> Bank<S, N, CAPACITY> {
    /// An empty bank.
    pub const fn new() -> Self {
        Self { muscles: Vec::new() }
    }

    /// Adds a muscle at the lowest free place and returns the place; an error if the bank is full.
    pub fn add(&mut self, muscle: BankedMuscle<S, N>) -> Result<usize, BankFull> {
        let place = self.muscles.len();
        self.muscles.push(muscle).map_err(|_| BankFull { capacity: CAPACITY })?;
        Ok(place)
    }

    /// The muscles, by place.
    pub fn muscles(&self) -> &[BankedMuscle<S, N>] {
        &self.muscles
    }

    /// Steps all muscles by one tick. Inputs and outputs are in the order of places. Cannot fail.
    pub fn step(&mut self, inputs: &[Input<S>; CAPACITY]) -> Vec<Output<S>, CAPACITY> {
        self.muscles.iter_mut().zip(inputs).map(|(muscle, input)| muscle.step(*input)).collect()
    }
}

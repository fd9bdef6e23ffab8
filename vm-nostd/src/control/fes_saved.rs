//! Saving and restoring a state of the FES controller.

use super::fes_controller::FesController;
use super::fes_state::FesControllerState;
use super::pi::Saturated;
use super::saved::{Parts, fingerprint};
use crate::beyond_paper::fatigue::FatigueState;
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::tick::range::Range;

/// Distinguishes saved controllers: no mode has this number.
const CONTROLLER: u32 = 0x101;

impl<S: Scalar, const N: usize> FesController<S, N> {
    /// Words of a saved state of this controller.
    pub fn saved_words(&self) -> usize {
        let tired = self.inverses.iter().filter(|inverse| inverse.fatigue.is_some()).count();
        FesControllerState::<S>::OWN + tired * FatigueState::<S>::SAVED_WORDS
    }

    /// The words of a saved state: a fingerprint of the controller, and the state.
    pub fn save(&self, state: &FesControllerState<S>) -> impl Iterator<Item = S::Bits> {
        let saturated = state.saturated.bits();
        let own = [state.target, state.angle, state.measured].map(S::to_bits);
        let slow = [state.expected, state.gain];
        let tired = self.inverses.iter().zip(&state.inverses).filter_map(|(inverse, state)| {
            Some(inverse.fatigue.as_ref()?.save(state.fatigue.as_ref()?))
        });
        core::iter::once(S::Bits::from(fingerprint::<S, _>(CONTROLLER, self)))
            .chain(own)
            .chain(core::iter::once(S::Bits::from(saturated)))
            .chain(slow.into_iter().flat_map(S::wide_words))
            .chain(state.feedback.words())
            .chain(state.inverses.iter().flat_map(|inverse| inverse.lead.words()))
            .chain(tired.flatten())
    }

    /// A state saved by [`save`](Self::save); refused unless it is this controller's and one it can
    /// be in.
    pub fn restore(
        &self,
        words: impl IntoIterator<Item = S::Bits>,
    ) -> Result<FesControllerState<S>, RestoreError> {
        let length = FesControllerState::<S>::OWN;
        let mut parts = Parts::new(words.into_iter(), self.saved_words());
        let expected = fingerprint::<S, _>(CONTROLLER, self);
        let mut state = self.start(self.range.least);
        parts.part(length, |words| {
            let mut saved = Saved::new(words, length, expected)?;
            state.target = saved.number(|angle| self.range.contains(angle))?;
            state.angle = saved.number(|angle| self.range.contains(angle))?;
            state.measured = saved.number(S::is_finite)?;
            let saturated = saved.count(4)?;
            state.saturated = Saturated { above: saturated & 1 != 0, below: saturated & 2 != 0 };
            let any = S::from_f64(1e4);
            let range = if self.of_torque { Range { least: -any, most: any } } else { self.range };
            state.expected = saved.wide(&range)?;
            let gains = Range { least: S::ONE, most: S::ONE };
            state.gain = match &self.gain {
                Some(gain) => gain.restored(&mut saved)?,
                None => saved.wide(&gains)?,
            };
            state.feedback = self.feedback.restored(&mut saved)?;
            for (inverse, state) in self.inverses.iter().zip(&mut state.inverses) {
                state.lead = inverse.lead.restored(&mut saved)?;
            }
            saved.finished()
        })?;
        for (inverse, state) in self.inverses.iter().zip(&mut state.inverses) {
            if let Some(fatigue) = &inverse.fatigue {
                let length = FatigueState::<S>::SAVED_WORDS;
                state.fatigue = Some(parts.part(length, |words| fatigue.restore(words))?);
            }
        }
        parts.finished()?;
        Ok(state)
    }
}

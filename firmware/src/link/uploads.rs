//! Uploaded muscles and the controller of their joint: validated, stored and built. Restored
//! uploads are validated like new ones.

use crate::between::link_queues::Bank;
use crate::between::motion::Target;
use crate::config::MUSCLES;
use crate::hard_tick::placed_controller::PlacedController;
use crate::hard_tick::placed_muscle::PlacedMuscle;
use crate::link::storage::{MOST_STORED, NotStored, SlotBuffer, Slots};
use crate::link::{ControlUpload, Refusal, Upload};
use embedded_storage::nor_flash::MultiwriteNorFlash;
use vm_nostd::{Limit, TimeStep};

/// Contents of non-volatile memory.
#[derive(Debug)]
pub(crate) struct Stored {
    muscles: [Option<Upload>; MUSCLES],
    control: Option<ControlUpload>,
}

impl Stored {
    /// Nothing.
    pub(crate) const NOTHING: Self = Self { muscles: [None; MUSCLES], control: None };
}

/// Uploads of all places, their muscles, and the controller.
pub(crate) struct Uploads<'q, F> {
    slots: Slots<'q, F>,
    step: TimeStep,
    uploads: &'q mut Stored,
    built: &'q mut Bank,
    restored: u8,
}

/// Greatest velocity (rad/s) and acceleration (rad/s²) of a target.
const MOST_MOTION: f64 = 100.0;

impl<'q, F: MultiwriteNorFlash> Uploads<'q, F> {
    /// Restores the stored uploads. Those that are invalid are left out and not stored again.
    pub(crate) fn restore(
        memory: F,
        buffer: &'q mut SlotBuffer,
        uploads: &'q mut Stored,
        built: &'q mut Bank,
        step: TimeStep,
    ) -> Self {
        let mut slots = Slots::new(memory, buffer);
        if slots.load().and_then(|stored| take_uploads(stored, uploads)).is_none() {
            *uploads = Stored::NOTHING;
        }
        let mut restored = Self { slots, step, uploads, built, restored: 0 };
        for index in 0..MUSCLES {
            restored.build(index);
        }
        restored.build_controller();
        restored
    }

    /// Builds the stored upload of a place, if it is valid.
    fn build(&mut self, index: usize) {
        let placed = self
            .uploads
            .muscles
            .get(index)
            .and_then(Option::as_ref)
            .map(|upload| self.checked(index, upload));
        let placed = placed.and_then(Result::ok);
        self.restored += u8::from(placed.is_some());
        if let (Some(upload), Some(built)) =
            (self.uploads.muscles.get_mut(index), self.built.muscles.get_mut(index))
        {
            if placed.is_none() {
                *upload = None;
            }
            *built = placed;
        }
    }

    /// Builds the stored controller, if it and its muscles are valid.
    // Not inlined: its frame would add to that of the muscles.
    #[inline(never)]
    fn build_controller(&mut self) {
        let control = self.uploads.control.as_ref();
        self.built.controller = control.and_then(|control| self.controller(control).ok());
        if self.built.controller.is_none() {
            self.uploads.control = None;
        }
    }

    /// Returns the memory.
    pub(crate) fn into_memory(self) -> F {
        self.slots.into_memory()
    }

    /// All muscles and the controller, at rest.
    pub(crate) fn built(&self) -> &Bank {
        self.built
    }

    /// Places restored at boot.
    pub(crate) fn restored(&self) -> u8 {
        self.restored
    }

    /// Whether there is a controller.
    pub(crate) fn is_controlled(&self) -> bool {
        self.uploads.control.is_some()
    }

    /// Validates, stores and builds an upload for a place. It removes the controller, which was of
    /// the muscle before.
    pub(crate) fn take(&mut self, index: usize, upload: Upload) -> Result<(), Refusal<'static>> {
        let placed = self.checked(index, &upload)?;
        self.store(index, &Some(upload))?;
        if let (Some(slot), Some(built)) =
            (self.uploads.muscles.get_mut(index), self.built.muscles.get_mut(index))
        {
            (*slot, *built) = (Some(upload), Some(placed));
        }
        (self.uploads.control, self.built.controller) = (None, None);
        Ok(())
    }

    /// Validates, stores and builds a controller, or removes it.
    pub(crate) fn take_control(
        &mut self,
        control: Option<ControlUpload>,
    ) -> Result<(), Refusal<'static>> {
        let placed = control.as_ref().map(|control| self.controller(control)).transpose()?;
        Self::write(&mut self.slots, self.uploads.muscles.each_ref(), &control)?;
        (self.uploads.control, self.built.controller) = (control, placed);
        Ok(())
    }

    /// Validates a target by the joint's limits; the error has field, value and limit.
    pub(crate) fn check_target(&self, target: &Target) -> Result<(), Refusal<'static>> {
        let control = self.uploads.control.as_ref().ok_or(Refusal::NoController)?;
        let Target { angle, velocity, acceleration, torque } = *target;
        let (range, motion) = (&control.range, (-MOST_MOTION, MOST_MOTION));
        for (field, value, (least, most)) in [
            ("target.angle", angle, (range.least, range.most)),
            ("target.velocity", velocity, motion),
            ("target.acceleration", acceleration, motion),
            ("target.torque", torque, control.torque),
        ] {
            let value = f64::from(value);
            // No number is in no range.
            if !(least..=most).contains(&value) {
                let limit = Limit::Within { least, most };
                return Err(Refusal::Parameter { muscle: None, field, fiber: None, value, limit });
            }
        }
        Ok(())
    }

    /// Builds the muscle of an upload for a place; an error if it is invalid or its channel is
    /// taken.
    fn checked(&self, index: usize, upload: &Upload) -> Result<PlacedMuscle, Refusal<'static>> {
        let placed = PlacedMuscle::build(upload, self.step)?;
        if let Some(channel) = placed.channel() {
            self.only_free(channel, Some(index))?;
        }
        Ok(placed)
    }

    fn controller(&self, control: &ControlUpload) -> Result<PlacedController, Refusal<'static>> {
        let muscles = self.uploads.muscles.each_ref().map(Option::as_ref);
        PlacedController::build(muscles, control, self.step)
    }

    /// Stores all muscles with a new one at a place, without a controller.
    fn store(&mut self, index: usize, upload: &Option<Upload>) -> Result<(), Refusal<'static>> {
        let mut all = self.uploads.muscles.each_ref();
        *all.get_mut(index).ok_or(Refusal::Empty)? = upload;
        Self::write(&mut self.slots, all, &None)
    }

    // Not inlined: its frame would add to that of building.
    #[inline(never)]
    fn write(
        slots: &mut Slots<'q, F>,
        muscles: [&Option<Upload>; MUSCLES],
        control: &Option<ControlUpload>,
    ) -> Result<(), Refusal<'static>> {
        let mut bytes = [0; MOST_STORED];
        let bytes = postcard::to_slice(&(muscles, control), &mut bytes)
            .map_err(|_| Refusal::NotStored(NotStored::TooLong))?;
        slots.store(bytes).map_err(Refusal::NotStored)
    }

    /// Refuses a channel of another muscle's electrode; `own` is the upload's place.
    pub(crate) fn only_free(
        &self,
        channel: u8,
        own: Option<usize>,
    ) -> Result<(), Refusal<'static>> {
        let taken = self.built.muscles.iter().enumerate().find(|(place, placed)| {
            let has = placed.as_ref().and_then(PlacedMuscle::channel);
            Some(*place) != own && has == Some(channel)
        });
        match taken {
            // There are few places.
            Some((place, _)) => Err(Refusal::ChannelTaken { channel, place: place as u8 }),
            None => Ok(()),
        }
    }
}

/// Reads the stored uploads, all or none.
fn take_uploads(stored: &[u8], uploads: &mut Stored) -> Option<()> {
    let mut rest = stored;
    for upload in &mut uploads.muscles {
        (*upload, rest) = postcard::take_from_bytes(rest).ok()?;
    }
    (uploads.control, rest) = postcard::take_from_bytes(rest).ok()?;
    rest.is_empty().then_some(())
}

//! Uploaded muscles: validated, stored and built. Restored uploads are validated like new ones.

use crate::between::link_queues::Bank;
use crate::config::MUSCLES;
use crate::hard_tick::placed_muscle::PlacedMuscle;
use crate::link::storage::{MOST_STORED, NotStored, SlotBuffer, Slots};
use crate::link::{Refusal, Upload};
use embedded_storage::nor_flash::MultiwriteNorFlash;
use vm_nostd::TimeStep;

/// Contents of non-volatile memory.
pub(crate) type Stored = [Option<Upload>; MUSCLES];

/// Uploads of all places and their muscles.
pub(crate) struct Uploads<'q, F> {
    slots: Slots<'q, F>,
    step: TimeStep,
    uploads: &'q mut Stored,
    built: &'q mut Bank,
    restored: u8,
}

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
            *uploads = [None; MUSCLES];
        }
        let mut restored = Self { slots, step, uploads, built, restored: 0 };
        for index in 0..MUSCLES {
            restored.build(index);
        }
        restored
    }

    /// Builds the stored upload of a place, if it is valid.
    fn build(&mut self, index: usize) {
        let placed = self
            .uploads
            .get(index)
            .and_then(Option::as_ref)
            .map(|upload| self.checked(index, upload));
        let placed = placed.and_then(Result::ok);
        self.restored += u8::from(placed.is_some());
        if let (Some(upload), Some(built)) =
            (self.uploads.get_mut(index), self.built.get_mut(index))
        {
            if placed.is_none() {
                *upload = None;
            }
            *built = placed;
        }
    }

    /// Returns the memory.
    pub(crate) fn into_memory(self) -> F {
        self.slots.into_memory()
    }

    /// All muscles, at rest.
    pub(crate) fn built(&self) -> &Bank {
        self.built
    }

    /// Places restored at boot.
    pub(crate) fn restored(&self) -> u8 {
        self.restored
    }

    /// Validates, stores and builds an upload for a place.
    pub(crate) fn take(&mut self, index: usize, upload: Upload) -> Result<(), Refusal<'static>> {
        let placed = self.checked(index, &upload)?;
        self.store(index, &Some(upload))?;
        if let (Some(slot), Some(built)) = (self.uploads.get_mut(index), self.built.get_mut(index))
        {
            (*slot, *built) = (Some(upload), Some(placed));
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

    /// Stores all uploads with a new one at a place.
    // Not inlined: its frame would add to that of building.
    #[inline(never)]
    fn store(&mut self, index: usize, upload: &Option<Upload>) -> Result<(), Refusal<'static>> {
        let mut all = self.uploads.each_ref();
        *all.get_mut(index).ok_or(Refusal::Empty)? = upload;
        let mut bytes = [0; MOST_STORED];
        let bytes = postcard::to_slice(&all, &mut bytes)
            .map_err(|_| Refusal::NotStored(NotStored::TooLong))?;
        self.slots.store(bytes).map_err(Refusal::NotStored)
    }

    /// Refuses a channel of another muscle's electrode; `own` is the upload's place.
    pub(crate) fn only_free(
        &self,
        channel: u8,
        own: Option<usize>,
    ) -> Result<(), Refusal<'static>> {
        let taken = self.built.iter().enumerate().find(|(place, placed)| {
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
    for upload in uploads {
        (*upload, rest) = postcard::take_from_bytes(rest).ok()?;
    }
    rest.is_empty().then_some(())
}

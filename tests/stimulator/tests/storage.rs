//! Power that is lost at any byte of a write, or of an erasure: what was stored before is still
//! there.

use crc::{CRC_32_ISO_HDLC, Crc};
use embedded_storage::nor_flash::{
    ErrorType, MultiwriteNorFlash, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use firmware::link::{Mode, Request, Upload, VERSION};
use firmware::{MOST_STORED, NotStored, RamFlash, Slots};
use stimulator_tests::client::Client;
use stimulator_tests::device::InProcess;
use vm_nostd_cores::MUSCLE;

const BYTES: usize = 8192;

/// A memory whose power goes away after so many bytes have been erased or written.
#[derive(Clone)]
struct Cut {
    memory: RamFlash<BYTES>,
    left: usize,
    /// What becomes of the byte that is being written then: so many of its bits are.
    torn: u8,
}

/// No power.
#[derive(Debug)]
struct Gone;

impl NorFlashError for Gone {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for Cut {
    type Error = Gone;
}

impl ReadNorFlash for Cut {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Gone> {
        if self.left == 0 {
            return Err(Gone);
        }
        self.memory.read(offset, bytes).map_err(|_| Gone)
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl NorFlash for Cut {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = BYTES / 2;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Gone> {
        let length = (to - from) as usize;
        let done = length.min(self.left);
        self.left -= done;
        let end = from + u32::try_from(done).expect("few");
        self.memory.erase(from, end).map_err(|_| Gone)?;
        if done == length && self.left > 0 { Ok(()) } else { Err(Gone) }
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Gone> {
        let done = bytes.len().min(self.left);
        self.left -= done;
        self.memory.write(offset, &bytes[..done]).map_err(|_| Gone)?;
        if let Some(byte) = bytes.get(done) {
            let torn = [byte | self.torn];
            let place = offset + u32::try_from(done).expect("few");
            self.memory.write(place, &torn).map_err(|_| Gone)?;
        }
        if done == bytes.len() && self.left > 0 { Ok(()) } else { Err(Gone) }
    }
}

impl MultiwriteNorFlash for Cut {}

fn content(seed: u8, length: usize) -> Vec<u8> {
    (0..length).map(|index| seed.wrapping_mul(31).wrapping_add(index as u8)).collect()
}

#[test]
fn power_that_is_lost_at_any_byte_leaves_the_old_content_or_the_new_one() {
    let (old, new) = (content(1, 777), content(2, 701));
    for writes_before in 1..=2 {
        let mut buffer = [0; _];
        let mut slots = Slots::new(RamFlash::<BYTES>::new(), &mut buffer);
        for _ in 0..writes_before {
            slots.store(&old).expect("a memory");
        }
        let memory = slots.into_memory();
        let (mut kept_old, mut kept_new) = (0, 0);
        let all = BYTES / 2 + 16 + new.len().next_multiple_of(4);
        for left in 1..=all + 1 {
            for torn in [0x00, 0x55, 0xf0, 0xff] {
                let mut buffer = [0; _];
                let mut slots = Slots::new(Cut { memory: memory.clone(), left, torn }, &mut buffer);
                let stored = slots.store(&new);
                assert_eq!(stored.is_ok(), left > all, "{left} of {all}");
                let mut buffer = [0; _];
                let mut slots = Slots::new(slots.into_memory().memory, &mut buffer);
                let kept = slots.load().expect("a content").to_vec();
                // An error may come too late, and says so; success never comes too early.
                if kept == new {
                    assert!(matches!(stored, Ok(()) | Err(NotStored::Unknown)), "{stored:?}");
                    kept_new += 1;
                } else {
                    assert_eq!(kept, old, "{left} of {all}");
                    kept_old += 1;
                    assert!(stored.is_err());
                }
                // And it goes on.
                slots.store(&content(3, 100)).expect("a memory");
                assert_eq!(slots.load(), Some(content(3, 100).as_slice()));
            }
        }
        assert!(kept_old >= 4 * (all - 4) && kept_new >= 4, "{kept_old} and {kept_new}");
    }
}

#[test]
fn what_was_never_stored_or_is_worn_is_not_made_up() {
    let mut buffer = [0; _];
    let mut slots = Slots::new(RamFlash::<BYTES>::new(), &mut buffer);
    assert_eq!(slots.load(), None);
    let long = content(1, MOST_STORED);
    slots.store(&long).expect("as much as there is room for");
    assert_eq!(slots.store(&content(1, MOST_STORED + 1)), Err(NotStored::TooLong));
    assert_eq!(slots.load(), Some(long.as_slice()));
    // Each byte of the slot that counts, one bit of it flipped: it does not count any more.
    slots.store(&content(2, 60)).expect("room");
    let whole = slots.into_memory();
    for offset in 0..76 {
        for bit in 0..8 {
            let mut worn = whole.clone();
            let mut bytes = vec![0; BYTES];
            worn.read(0, &mut bytes).expect("a memory");
            let newest = BYTES / 2;
            bytes[newest + offset] ^= 1 << bit;
            worn.erase(0, BYTES as u32).expect("a memory");
            worn.write(0, &bytes).expect("a memory");
            let mut buffer = [0; _];
            let mut slots = Slots::new(worn, &mut buffer);
            assert_eq!(slots.load(), Some(long.as_slice()), "byte {offset} bit {bit}");
        }
    }
}

/// A memory that is worn out: it is neither erased nor written, and says that it was.
struct Worn(RamFlash<BYTES>);

impl ErrorType for Worn {
    type Error = Gone;
}

impl ReadNorFlash for Worn {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Gone> {
        self.0.read(offset, bytes).map_err(|_| Gone)
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl NorFlash for Worn {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = BYTES / 2;

    fn erase(&mut self, _from: u32, _to: u32) -> Result<(), Gone> {
        Ok(())
    }

    fn write(&mut self, _offset: u32, _bytes: &[u8]) -> Result<(), Gone> {
        Ok(())
    }
}

impl MultiwriteNorFlash for Worn {}

/// What the slot already held is no proof that it was written: the newest content is another.
#[test]
fn content_of_before_in_a_worn_slot_is_not_taken_for_stored() {
    let mut buffer = [0; _];
    let mut slots = Slots::new(RamFlash::<BYTES>::new(), &mut buffer);
    slots.store(b"first").expect("a memory");
    slots.store(b"second").expect("a memory");
    let memory = slots.into_memory();
    for content in [b"first".as_slice(), b"third"] {
        let mut buffer = [0; _];
        let mut slots = Slots::new(Worn(memory.clone()), &mut buffer);
        assert!(slots.store(content).is_err(), "{content:?}");
        assert_eq!(slots.load(), Some(b"second".as_slice()));
    }
}

/// A memory whose first reads fail.
struct Unreadable {
    memory: RamFlash<BYTES>,
    fails: usize,
}

impl ErrorType for Unreadable {
    type Error = Gone;
}

impl ReadNorFlash for Unreadable {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Gone> {
        if self.fails > 0 {
            self.fails -= 1;
            return Err(Gone);
        }
        self.memory.read(offset, bytes).map_err(|_| Gone)
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl NorFlash for Unreadable {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = BYTES / 2;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Gone> {
        self.memory.erase(from, to).map_err(|_| Gone)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Gone> {
        self.memory.write(offset, bytes).map_err(|_| Gone)
    }
}

impl MultiwriteNorFlash for Unreadable {}

/// What cannot be read for a moment may be what counts: nothing is erased then.
#[test]
fn a_memory_that_cannot_be_read_loses_nothing() {
    for slots_used in 1..=2 {
        let mut buffer = [0; _];
        let mut slots = Slots::new(RamFlash::<BYTES>::new(), &mut buffer);
        (0..slots_used).for_each(|seed| slots.store(&content(seed, 50)).expect("a memory"));
        let memory = slots.into_memory();
        for fails in 1..=2 {
            let mut buffer = [0; _];
            let mut slots = Slots::new(Unreadable { memory: memory.clone(), fails }, &mut buffer);
            assert_eq!(slots.store(&content(9, 60)), Err(NotStored::Read));
            let mut buffer = [0; _];
            let mut slots = Slots::new(slots.into_memory().memory, &mut buffer);
            assert_eq!(slots.load(), Some(content(slots_used - 1, 50).as_slice()));
        }
    }
}

/// The same from outside: an upload under a power that fails leaves the muscle of before, or the
/// new one.
#[test]
fn an_upload_that_is_cut_leaves_a_muscle() {
    let upload = |mass: f64| {
        let mut muscle = MUSCLE;
        muscle.mass = mass;
        Request::Upload { place: 0, upload: Upload { mode: Mode::Fes, muscle, electrode: None } }
    };
    let state = |memory| {
        let mut host = Client::new(InProcess::boot(memory));
        assert_eq!(host.greet().expect("a greeting").restored, 1);
        let rows = [firmware::link::RowInputs {
            activation: 1.0,
            path_length: 0.16,
            stimulation_frequency: 30.0,
        }; 2];
        let rows = heapless::Vec::from_slice(&[rows; 8]).expect("room");
        host.order(&Request::Rest([Some(0.16), None])).expect("rest");
        host.order(&Request::Rows { first: 0, rows }).expect("room");
        (0..20).for_each(|_| host.line().tick());
        host.listen();
        std::iter::from_fn(|| host.next_trace()).last().expect("traces").outputs[0].force
    };
    let mut host = Client::new(InProcess::boot(RamFlash::<BYTES>::new()));
    host.greet().expect("a greeting");
    host.order(&upload(0.05)).expect("a muscle");
    let memory = host.into_line().into_memory();
    let light = state(memory.clone());
    let mut heavy = 0;
    for left in (1..6000).step_by(97) {
        // Reading at boot does not wear the power out.
        let cut = Cut { memory: memory.clone(), left, torn: 0 };
        let mut host = Client::new(InProcess::boot(cut));
        host.greet().expect("a greeting");
        let answer = host.order(&upload(0.1));
        let force = state(host.into_line().into_memory().memory);
        let is_new = (force - 2.0 * light).abs() < 0.02 * light;
        assert!(is_new || force == light, "{left}: {force} N");
        assert!(is_new || answer.is_err(), "{left}: said to be stored");
        heavy += u32::from(is_new);
    }
    assert!((10..30).contains(&heavy), "{heavy} of 62");
}

/// A slot is half of the memory, and is erased by whole pages.
#[test]
fn a_slot_is_whole_pages() {
    let page = RamFlash::<BYTES>::ERASE_SIZE;
    assert!((BYTES / 2).is_multiple_of(page), "{page}");
}

/// The slot that was written after the greatest generation there is counts.
#[test]
fn generations_of_slots_go_round() {
    const HALF: u32 = 4096;
    let slot = |generation: u32, content: &[u8]| {
        let mut bytes = Vec::new();
        let length = u32::try_from(content.len()).expect("short");
        for field in [0x4D53_4D00 + u32::from(VERSION), generation, length] {
            bytes.extend(field.to_le_bytes());
        }
        let crc = Crc::<u32>::new(&CRC_32_ISO_HDLC);
        let mut digest = crc.digest();
        digest.update(&bytes);
        digest.update(content);
        bytes.extend(digest.finalize().to_le_bytes());
        bytes.extend(content);
        bytes
    };
    for (first, second, newest) in [
        (u32::MAX, 0, "second"),
        (0, u32::MAX, "first"),
        (5, 6, "second"),
        (6, 5, "first"),
        (u32::MAX - 1, u32::MAX, "second"),
        (0x7fff_ffff, 0x8000_0000, "second"),
    ] {
        let mut memory = RamFlash::<8192>::new();
        memory.write(0, &slot(first, b"first")).expect("memory");
        memory.write(HALF, &slot(second, b"second")).expect("memory");
        let mut buffer = [0; _];
        let mut slots = Slots::new(memory, &mut buffer);
        assert_eq!(slots.load(), Some(newest.as_bytes()), "{first:x} {second:x}");
        // The next content is newer than both.
        slots.store(b"third").expect("memory");
        assert_eq!(slots.load(), Some(b"third".as_slice()), "{first:x} {second:x}");
    }
}

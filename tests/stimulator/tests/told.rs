//! What a host is told of a muscle that it stores is what the next boot restores, whatever memory
//! fails to do.

use embedded_storage::nor_flash::{
    ErrorType, MultiwriteNorFlash, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use firmware::link::{Answer, ControlUpload, Electrode, Mode, Request, Upload};
use firmware::{NotStored, RamFlash, Slots};
use stimulator_tests::client::{Client, ClientError};
use stimulator_tests::device::InProcess;
use stimulator_tests::host::{ELECTRODE, STIMULUS, fes};
use stimulator_tests::joint::{control, muscles};
use vm_nostd::MuscleParams;

const BYTES: usize = 8192;

/// A memory of whose operations some fail: before they do anything, or when they are done.
#[derive(Clone)]
struct Failing {
    memory: RamFlash<BYTES>,
    operations: usize,
    fails: Vec<(usize, When)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum When {
    Before,
    HalfWay,
    Done,
}

const WHEN: [When; 3] = [When::Before, When::HalfWay, When::Done];

#[derive(Debug)]
struct Failed;

impl NorFlashError for Failed {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for Failing {
    type Error = Failed;
}

impl Failing {
    fn new(memory: &RamFlash<BYTES>, fails: &[(usize, When)]) -> Self {
        Self { memory: memory.clone(), operations: 0, fails: fails.to_vec() }
    }

    /// Does as much of so many bytes as this operation does, and says whether it went well.
    fn operate(
        &mut self,
        bytes: usize,
        operation: impl FnOnce(&mut RamFlash<BYTES>, usize),
    ) -> Result<(), Failed> {
        let number = self.operations;
        self.operations += 1;
        let when = self.fails.iter().find(|(at, _)| *at == number).map(|(_, when)| *when);
        match when {
            Some(When::Before) => (),
            Some(When::HalfWay) => operation(&mut self.memory, bytes / 2),
            Some(When::Done) | None => operation(&mut self.memory, bytes),
        }
        if when.is_none() { Ok(()) } else { Err(Failed) }
    }
}

impl ReadNorFlash for Failing {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Failed> {
        self.operate(bytes.len(), |memory, most| {
            memory.read(offset, &mut bytes[..most]).expect("inside");
        })
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl NorFlash for Failing {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = BYTES / 2;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Failed> {
        self.operate((to - from) as usize, |memory, most| {
            memory.erase(from, from + most as u32).expect("inside");
        })
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Failed> {
        self.operate(bytes.len(), |memory, most| {
            memory.write(offset, &bytes[..most]).expect("inside");
        })
    }
}

impl MultiwriteNorFlash for Failing {}

/// What the next boot restores.
fn restored(memory: &RamFlash<BYTES>) -> Option<Vec<u8>> {
    let mut buffer = [0; _];
    Slots::new(memory.clone(), &mut buffer).load().map(<[u8]>::to_vec)
}

/// Stores a content while operations fail: what was told, what a boot restores, and how many
/// operations it took.
fn store(
    memory: &RamFlash<BYTES>,
    content: &[u8],
    fails: &[(usize, When)],
) -> (Result<(), NotStored>, Option<Vec<u8>>, usize) {
    let mut buffer = [0; _];
    let mut slots = Slots::new(Failing::new(memory, fails), &mut buffer);
    let told = slots.store(content);
    let Failing { memory, operations, .. } = slots.into_memory();
    (told, restored(&memory), operations)
}

#[test]
fn a_host_is_told_what_the_next_boot_restores() {
    let new = [0xa5; 300];
    let mut memory = RamFlash::new();
    for stored_before in 0..=3_u8 {
        let old = restored(&memory);
        assert_eq!(old.is_some(), stored_before > 0);
        let (told, now, all) = store(&memory, &new, &[]);
        assert_eq!((told, now.as_deref()), (Ok(()), Some(&new[..])));
        let (mut unknown, mut one_failed) = (0, 0);
        // One operation fails, or two do; those of what is done after a failure among them.
        let single = (0..all + 4).map(|at| (at, usize::MAX));
        let pairs = (0..all + 4).flat_map(|first| (first + 1..all + 4).map(move |at| (first, at)));
        for (first, second) in single.chain(pairs) {
            for (one, other) in WHEN.iter().flat_map(|one| WHEN.map(|other| (*one, other))) {
                let fails = [(first, one), (second, other)];
                let (told, now, operations) = store(&memory, &new, &fails);
                let happened = fails.iter().filter(|(at, _)| *at < operations).count();
                let case = format!("{fails:?} after {stored_before}: {told:?}");
                match told {
                    Ok(()) => assert_eq!(now.as_deref(), Some(&new[..]), "{case}"),
                    Err(NotStored::Unknown) => {
                        assert!(happened > 1, "{case}");
                        assert!(now == old || now.as_deref() == Some(&new[..]), "{case}");
                        unknown += 1;
                    }
                    Err(_) => {
                        assert_eq!(now, old, "{case}");
                        one_failed += usize::from(happened == 1);
                    }
                }
            }
        }
        assert!(unknown > 0 && one_failed >= 3 * all, "{unknown}, {one_failed} of {all}");
        // And the next one is stored as if nothing had been.
        let mut buffer = [0; _];
        let mut slots = Slots::new(memory, &mut buffer);
        slots.store(&[stored_before; 200]).expect("a memory");
        memory = slots.into_memory();
    }
}

/// The same from outside, of a place that has no muscle: refused is not restored, done is.
#[test]
fn an_upload_that_was_refused_is_not_there_after_a_boot() {
    let upload = Request::Upload { place: 0, upload: fes() };
    let mut refused = 0;
    for at in 0..20 {
        for when in WHEN {
            let mut memory = Failing::new(&RamFlash::new(), &[]);
            memory.fails = vec![(at, when)];
            let mut host = Client::new(InProcess::boot(memory));
            host.greet().expect("a greeting");
            let told = host.order(&upload);
            let there = host.ask(&Request::State { place: 0 });
            assert_eq!(matches!(there, Ok(Answer::State(_))), told.is_ok(), "{at} {when:?}");
            let memory = host.into_line().into_memory().memory;
            let mut host = Client::new(InProcess::boot(memory));
            let restored = host.greet().expect("a greeting").restored;
            assert_eq!(restored, u8::from(told.is_ok()), "{at} {when:?}: {told:?}");
            if let Err(error) = told {
                assert!(matches!(error, ClientError::Refused { .. }), "{error:?}");
                refused += 1;
            }
        }
    }
    assert!(refused > 10, "{refused}");
}

/// Memory with these two uploads, as another firmware may have left them.
fn stored(uploads: &[Option<Upload>; 2]) -> RamFlash<BYTES> {
    stored_with(uploads, None)
}

/// The same with a controller.
fn stored_with(uploads: &[Option<Upload>; 2], control: Option<ControlUpload>) -> RamFlash<BYTES> {
    let mut bytes = [0; 2048];
    let bytes = postcard::to_slice(&(uploads, control), &mut bytes).expect("room");
    let mut buffer = [0; _];
    let mut slots = Slots::new(RamFlash::new(), &mut buffer);
    slots.store(bytes).expect("a memory");
    slots.into_memory()
}

/// Boots: how many were restored, and which places have a muscle.
fn boot(memory: RamFlash<BYTES>) -> (Client<InProcess<RamFlash<BYTES>>>, u8, [bool; 2]) {
    let mut host = Client::new(InProcess::boot(memory));
    let restored = host.greet().expect("a greeting").restored;
    let there = [0, 1].map(|place| host.ask(&Request::State { place }).is_ok());
    (host, restored, there)
}

/// What this firmware would refuse, it does not restore: of two electrodes on a channel the second.
#[test]
fn what_is_restored_could_have_been_uploaded() {
    let of_channel =
        |channel| Some(Upload { electrode: Some(Electrode { channel, ..ELECTRODE }), ..fes() });
    let heavy = Some(Upload { muscle: MuscleParams { mass: -1.0, ..fes().muscle }, ..fes() });
    let natural = Some(Upload { mode: Mode::Continuous, electrode: Some(ELECTRODE), ..fes() });
    for (uploads, there) in [
        ([of_channel(0), of_channel(1)], [true, true]),
        ([of_channel(2), of_channel(2)], [true, false]),
        ([of_channel(4), of_channel(3)], [false, true]),
        ([heavy, of_channel(0)], [false, true]),
        ([of_channel(0), natural], [true, false]),
        ([None, of_channel(1)], [false, true]),
    ] {
        let (_, restored, are) = boot(stored(&uploads));
        assert_eq!(are, there);
        assert_eq!(usize::from(restored), there.iter().filter(|there| **there).count());
    }
    // A channel is free whose electrode was not restored, and does not come back with the next
    // boot.
    let (mut host, ..) = boot(stored(&[of_channel(2), of_channel(2)]));
    let free = Some(STIMULUS);
    host.order(&Request::Drive([None, None, None, free])).expect("a free channel");
    assert!(host.order(&Request::Drive([None, None, free, None])).is_err());
    let (mut host, ..) = boot(stored(&[of_channel(4), of_channel(3)]));
    host.order(&Request::Upload { place: 1, upload: fes() }).expect("a muscle");
    let memory = host.into_line().into_memory();
    let mut buffer = [0; _];
    let mut slots = Slots::new(memory, &mut buffer);
    let stored: ([Option<Upload>; 2], Option<ControlUpload>) =
        postcard::from_bytes(slots.load().expect("a content")).expect("uploads");
    assert_eq!(stored, ([None, Some(fes())], None));
}

/// A controller is restored if it and both of its muscles could have been uploaded.
#[test]
fn a_controller_that_is_restored_could_have_been_uploaded() {
    let [flexor, extensor] = muscles().map(Some);
    let heavy = flexor
        .map(|upload| Upload { muscle: MuscleParams { mass: -1.0, ..upload.muscle }, ..upload });
    let slow = ControlUpload { sensor_period_us: 10_001, ..control() };
    for (uploads, control, is_controlled) in [
        ([flexor, extensor], control(), true),
        ([heavy, extensor], control(), false),
        ([flexor, None], control(), false),
        ([flexor, Some(fes())], control(), false),
        ([flexor, extensor], slow, false),
    ] {
        let mut host = Client::new(InProcess::boot(stored_with(&uploads, Some(control))));
        assert_eq!(host.greet().expect("a greeting").controlled, is_controlled);
    }
}

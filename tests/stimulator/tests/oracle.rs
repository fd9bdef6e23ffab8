//! Random sequences of messages, sensors that fail, silences and late ticks, through the public
//! types; and an oracle of the limits at the electrodes.
//!
//! `VM_MESSAGES=10000000 cargo test --release -p stimulator-tests --test oracle -- --nocapture`
//! sends ten million; where it is not set there are 200,000.

use firmware::Stimulus;
use firmware::link::{AngleReading, Readings, Request, RowInputs, Target};
use firmware::safety::{CHANNELS, Fault, State};
use stimulator_tests::world::{OF_ROWS, World};

/// Numbers that look random.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 >> 11
    }

    fn below(&mut self, most: u64) -> u64 {
        self.next() % most
    }

    fn from(&mut self, least: u64, most: u64) -> u64 {
        least + self.below(most - least + 1)
    }

    fn one_in(&mut self, many: u64) -> bool {
        self.below(many) == 0
    }
}

fn stimulus(chance: &mut Chance) -> Stimulus {
    let width_us = chance.from(20, 450) as u16;
    let most_ua = (10_000_000 / u64::from(width_us)).min(40_000);
    // Now and then beyond a limit.
    let beyond = |chance: &mut Chance| u64::from(chance.one_in(3000));
    Stimulus {
        amplitude_ua: (chance.from(0, most_ua) + beyond(chance) * 45_000) as u32,
        width_us: width_us + beyond(chance) as u16 * 500,
        gap_us: chance.from(40, 200) as u16,
        frequency_tenths_pps: (chance.from(10, 800) + beyond(chance) * 800) as u16,
        recovery: chance.from(1, 8) as u8,
    }
}

fn readings(world: &World, chance: &mut Chance) -> Readings {
    let fails = |chance: &mut Chance| chance.one_in(2000);
    let step = chance.below(601) as i32 - 300;
    let path = (world.path_um + step).clamp(60_000, 400_000);
    Readings {
        impedance_ohm: if fails(chance) { [Some(9000); CHANNELS] } else { [Some(1000); CHANNELS] },
        supply_mv: if fails(chance) { 2500 } else { 3700 },
        path_um: match () {
            () if fails(chance) => None,
            () if fails(chance) => Some(world.path_um + chance.below(40_000) as i32),
            () if fails(chance) => Some(world.path_um),
            () => Some(path),
        },
    }
}

fn row(chance: &mut Chance) -> [RowInputs; 2] {
    let number = |chance: &mut Chance, most: f32| match chance.below(4000) {
        0 => f32::NAN,
        1 => f32::INFINITY,
        2 => -1.0,
        n if n < 200 => 0.0,
        _ => most * chance.below(10_001) as f32 / 10_000.0,
    };
    let activation = number(chance, 1.0);
    let stimulation_frequency = number(chance, 60.0);
    let inputs = RowInputs { activation, path_length: 0.16, stimulation_frequency };
    [inputs, RowInputs::default()]
}

/// An angle of a joint that moves, now and then a wrong one.
fn angle(world: &mut World, chance: &mut Chance) -> AngleReading {
    let fails = |chance: &mut Chance| chance.one_in(3000);
    world.angle_urad =
        (world.angle_urad + chance.below(20_001) as i32 - 10_000).clamp(0, 2_440_000);
    let mut reading = AngleReading { time_us: world.now_us as u32, angle_urad: world.angle_urad };
    match () {
        () if fails(chance) => reading.time_us += 90_000,
        () if fails(chance) => reading.time_us = reading.time_us.wrapping_sub(50_000),
        () if fails(chance) => reading.angle_urad = 3_000_000,
        () if fails(chance) => reading.angle_urad += 700_000,
        () => (),
    }
    reading
}

fn target(chance: &mut Chance) -> Target {
    let angle = chance.below(2_440_000) as f32 * 1e-6;
    // Now and then refused.
    let angle = if chance.one_in(500) { f32::NAN } else { angle };
    Target { angle, velocity: chance.below(5) as f32 - 2.0, ..Target::default() }
}

/// The next message of a host with a controller, or a pause.
fn next_controlled(world: &mut World, chance: &mut Chance, messages: &mut u64) {
    // Readings come every 10 ms, unless they stop for a while.
    if !chance.one_in(1500) {
        while world.now_us < world.next_angle_us {
            world.tick();
        }
        let request = Request::Angle(angle(world, chance));
        world.next_angle_us = world.now_us + 10_000;
        *messages += 1;
        world.ask(request);
        world.tick();
    }
    if chance.one_in(4) {
        *messages += 1;
        world.ask(Request::Target(target(chance)));
    }
    next(world, chance, messages);
}

/// The next message, or a pause.
fn next(world: &mut World, chance: &mut Chance, messages: &mut u64) {
    let request = match chance.below(1000) {
        0..350 => Request::Readings(readings(world, chance)),
        350..550 => {
            let mut stimuli = [None; CHANNELS];
            for place in &mut stimuli[..OF_ROWS] {
                // So that mean squares and loads are mostly within their limits.
                *place = chance.one_in(2).then(|| stimulus(chance));
            }
            Request::Drive(stimuli)
        }
        550..800 => {
            let count = chance.from(1, 8) as usize;
            let rows = std::iter::repeat_with(|| row(chance)).take(count).collect();
            Request::Rows { first: world.next_row, rows }
        }
        800..880 => Request::KeepAlive,
        880..960 => Request::Report,
        960..963 => Request::Stop,
        963..965 => Request::Rest([Some(0.16), None]),
        965..967 => Request::Acknowledge(Fault::Silence),
        967..970 => Request::Arm,
        970 => {
            world.late = true;
            return;
        }
        971..974 => {
            for _ in 0..chance.below(600) {
                world.tick();
            }
            return;
        }
        _ => {
            for _ in 0..chance.from(1, 20) {
                world.tick();
            }
            return;
        }
    };
    *messages += 1;
    world.ask(request);
    let (State::Latched(fault) | State::Acknowledged { fault, .. }) = world.state else { return };
    // The host has read that it is off, and arms again.
    *world.seen.entry(fault).or_default() += 1;
    if world.is_controlled {
        // A series that has ended, and the first angle of the next.
        while world.now_us < world.next_angle_us + 25_000 {
            world.tick();
        }
        world.ask(Request::Angle(AngleReading {
            time_us: world.now_us as u32,
            angle_urad: world.angle_urad,
        }));
        world.next_angle_us = world.now_us + 10_000;
    }
    for request in [
        Request::Readings(Readings {
            supply_mv: 3700,
            path_um: Some(world.path_um + 1),
            ..Readings::default()
        }),
        Request::Acknowledge(fault),
        Request::Arm,
        Request::Report,
    ] {
        *messages += 1;
        world.ask(request);
    }
}

/// So many messages have every kind of failure among them.
const SAMPLE: u64 = 200_000;

fn count() -> u64 {
    let count = std::env::var("VM_MESSAGES").ok().and_then(|text| text.parse().ok());
    count.unwrap_or(SAMPLE)
}

/// Says what `next` says until enough was said.
fn say(mut world: World, next: fn(&mut World, &mut Chance, &mut u64)) -> World {
    let count = count();
    let started = std::time::Instant::now();
    let mut chance = Chance(0x0dd_ba11_5eed);
    let mut messages = 0;
    let (mut armed, mut ticks) = (0_u64, 0_u64);
    while messages < count {
        next(&mut world, &mut chance, &mut messages);
        ticks += 1;
        armed += u64::from(world.patient.is_armed());
    }
    println!("the longest session: {} us", world.patient.longest_session_us());
    println!(
        "{messages} messages, {} s of time, {} pulses, armed for {} %, {:.1?}; faults that were read: {:?}",
        world.now_us / 1_000_000,
        world.patient.pulses,
        100 * armed / ticks,
        started.elapsed(),
        world.seen
    );
    // It was not off all the time.
    assert!(world.patient.pulses > count / 50, "{} pulses", world.patient.pulses);
    assert!(armed > ticks / 4);
    world
}

#[test]
fn whatever_is_said_no_limit_is_broken_at_the_electrodes() {
    say(World::boot(), next);
}

/// The same of a device that controls a joint.
#[test]
fn whatever_is_said_to_a_controller_no_limit_is_broken_at_the_electrodes() {
    let world = say(World::controlled(), next_controlled);
    if count() < SAMPLE {
        println!("SKIPPED: whether each fault was seen, in less than {SAMPLE} messages");
        return;
    }
    for fault in [
        Fault::SensorMissing,
        Fault::SensorTime,
        Fault::SensorRange,
        Fault::SensorJump,
        Fault::StaleTarget,
    ] {
        assert!(world.seen.contains_key(&fault), "{fault:?} was not seen: {:?}", world.seen);
    }
}

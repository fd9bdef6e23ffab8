//! Limits of output, of the age of inputs, and of the duration of stimulation.
//!
//! The values follow IEC 60601-2-10:2012 for stimulators in physical medicine: at most 300 mJ per
//! pulse into 500 Ω, 50 mA r.m.s. up to 400 Hz, and particular care above 2 mA r.m.s. per cm² of
//! electrode. This is no claim of conformity, which a module cannot have. Implanted electrodes, as
//! in intramuscular FES, are outside that standard: their limit is the charge per phase that the
//! electrode bears.

use crate::between::guarded::Sum;
use crate::between::stimulus::{
    LEAST_PHASE_US, MOST_COUNTS, MOST_FULL_SCALE_UA, MOST_RECOVERY, MOST_WIDTH_US, Scale,
};
use crate::config::{LONGEST_TICK_US, SHORTEST_TICK_US};
use core::fmt;
use vm_nostd::Checksum;

/// Limits whose violation is a fault. Validated when a supervisor is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Amplitude, µA; 1 to the full scale of the current source.
    pub amplitude_ua: u32,
    /// Width of the stimulating phase, µs; 20 to 1,000.
    pub width_us: u16,
    /// Frequency, pulses in ten seconds; 10 to 5,000.
    pub frequency_tenths_pps: u16,
    /// Charge per phase, nC; 1 to that of the greatest amplitude and width.
    pub charge_nc: u32,
    /// Root mean square of a channel's current, µA; 1 to `amplitude_ua`.
    pub rms_ua: u32,
    /// Greatest rise of amplitude from one pulse of a channel to the next, µA; eight steps of the
    /// current source to `amplitude_ua`. Faster requests are slowed down, without a fault.
    pub rise_ua: u32,
    /// Longest stimulation without a rest, ms; a tick or more. Stopping and arming again does not
    /// reset it.
    pub session_ms: u32,
    /// A pause without stimulation that begins a new session, ms; a tick or more. It counts from
    /// when the next pulse would have come.
    pub rest_ms: u32,
    /// Longest silence of the host, ms; a tick or more.
    pub silence_ms: u32,
    /// Greatest age of a reading of the path, ms; a tick or more. An older one counts as missing,
    /// which is a fault.
    pub readings_ms: u32,
    /// Greatest age of a row that stimulates, ms; a tick or more.
    pub rows_ms: u32,
    /// Greatest age of a drive, ms; a tick or more. Hosts repeat drives.
    pub drives_ms: u32,
    /// Greatest age of a controller's target, ms; a tick or more.
    pub targets_ms: u32,
    /// Greatest age of a reading of the joint's angle, ms; a tick or more. It also bounds how much
    /// later or earlier readings may come than their time stamps say.
    pub angle_ms: u32,
    /// Greatest angle beyond the range of the joint, mrad; to 6,300.
    pub angle_beyond_mrad: u32,
    /// Greatest speed of the joint from one reading to the next, mrad/s; 1 or more. A change of 50
    /// mrad is always allowed: sensors have noise.
    pub angle_speed_mrad_s: u32,
    /// Impedance of each electrode that stimulates, Ω: below is a short, above an open electrode.
    /// An electrode that was not measured yet is allowed, because measuring takes pulses.
    pub impedance_ohm: (u32, u32),
    /// Supply, mV.
    pub supply_mv: (u32, u32),
    /// Path length of the muscle, µm.
    pub path_um: (i32, i32),
    /// Greatest speed of the path from one reading to the next, mm/s; 1 or more. Time is counted
    /// between the ticks of the readings, and a change of 1 µm is always allowed.
    pub path_speed_mm_s: u32,
    /// Longest stimulation with a constant reading (to the µm), ms; a tick to `session_ms`. A
    /// working sensor has noise.
    pub stuck_ms: u32,
}

/// A refused limit: its value contradicts the stimulator or another limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LimitError {
    /// Name of the field; of a pair, its lower end.
    pub field: &'static str,
    /// The refused value, in the field's unit.
    pub value: i64,
    /// Least allowed value.
    pub least: i64,
    /// Greatest allowed value.
    pub most: i64,
}

impl fmt::Display for LimitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { field, value, least, most } = self;
        write!(f, "limit {field} = {value}: must be {least} to {most}")
    }
}

impl core::error::Error for LimitError {}

impl Limits {
    /// For surface electrodes of 25 cm² and adults: 20 mA r.m.s. are 0.8 mA/cm², and 40 µC at 100
    /// mA no more than 4 mJ in 500 Ω, both phases.
    pub const SURFACE: Self = Self {
        amplitude_ua: 100_000,
        width_us: 500,
        frequency_tenths_pps: 1000,
        charge_nc: 40_000,
        rms_ua: 20_000,
        rise_ua: 2_000,
        session_ms: 30 * 60 * 1000,
        rest_ms: 60 * 1000,
        silence_ms: 100,
        readings_ms: 200,
        rows_ms: 50,
        drives_ms: 1_000,
        targets_ms: 100,
        angle_ms: 30,
        angle_beyond_mrad: 175,
        angle_speed_mrad_s: 20_000,
        impedance_ohm: (100, 5_000),
        supply_mv: (3_000, 4_300),
        path_um: (50_000, 500_000),
        path_speed_mm_s: 1_000,
        stuck_ms: 2_000,
    };

    /// The smaller of these limits and those of a current source.
    #[must_use]
    pub const fn within_scale(mut self, scale: &Scale) -> Self {
        self.amplitude_ua = least(self.amplitude_ua, scale.full_scale_ua);
        self.charge_nc = least(self.charge_nc, greatest_charge_nc(&self));
        self.rms_ua = least(self.rms_ua, self.amplitude_ua);
        self.rise_ua = least(self.rise_ua, self.amplitude_ua);
        self
    }

    /// Validates the limits for a tick time (µs) and scale, and against each other; the error has
    /// field, value and limit.
    pub const fn validate(&self, tick_us: u32, scale: &Scale) -> Result<(), LimitError> {
        let amplitude = self.amplitude_ua as i64;
        let tick_ms = tick_us.div_ceil(1000) as i64;
        // Rounding of a pulse's amplitude: a smaller rise would never raise it.
        let coarsest = (MOST_RECOVERY as u64 * scale.full_scale_ua as u64)
            .div_ceil(scale.counts() as u64) as i64;
        let ever = u32::MAX as i64;
        let checks = [
            check("tick_us", tick_us as i64, SHORTEST_TICK_US as i64, LONGEST_TICK_US as i64),
            check("scale.full_scale_ua", scale.full_scale_ua as i64, 1, MOST_FULL_SCALE_UA as i64),
            check(
                "scale.full_scale_counts",
                scale.full_scale_counts as i64,
                MOST_RECOVERY as i64,
                MOST_COUNTS as i64,
            ),
            check("amplitude_ua", amplitude, 1, scale.full_scale_ua as i64),
            check("width_us", self.width_us as i64, LEAST_PHASE_US as i64, MOST_WIDTH_US as i64),
            check("frequency_tenths_pps", self.frequency_tenths_pps as i64, 10, 5000),
            check("charge_nc", self.charge_nc as i64, 1, greatest_charge_nc(self) as i64),
            check("rms_ua", self.rms_ua as i64, 1, amplitude),
            check("rise_ua", self.rise_ua as i64, coarsest, amplitude),
            check("session_ms", self.session_ms as i64, tick_ms, ever),
            check("rest_ms", self.rest_ms as i64, tick_ms, ever),
            check("silence_ms", self.silence_ms as i64, tick_ms, ever),
            check("readings_ms", self.readings_ms as i64, tick_ms, ever),
            check("rows_ms", self.rows_ms as i64, tick_ms, ever),
            check("drives_ms", self.drives_ms as i64, tick_ms, ever),
            check("targets_ms", self.targets_ms as i64, tick_ms, ever),
            check("angle_ms", self.angle_ms as i64, tick_ms, ever),
            check("angle_beyond_mrad", self.angle_beyond_mrad as i64, 0, 6_300),
            check("angle_speed_mrad_s", self.angle_speed_mrad_s as i64, 1, ever),
            check("impedance_ohm", self.impedance_ohm.0 as i64, 0, self.impedance_ohm.1 as i64),
            check("supply_mv", self.supply_mv.0 as i64, 0, self.supply_mv.1 as i64),
            check("path_um", self.path_um.0 as i64, i32::MIN as i64, self.path_um.1 as i64),
            check("path_speed_mm_s", self.path_speed_mm_s as i64, 1, ever),
            check("stuck_ms", self.stuck_ms as i64, tick_ms, self.session_ms as i64),
        ];
        let mut rest: &[Option<LimitError>] = &checks;
        while let Some((first, others)) = rest.split_first() {
            if let Some(error) = first {
                return Err(*error);
            }
            rest = others;
        }
        Ok(())
    }
}

const fn check(field: &'static str, value: i64, least: i64, most: i64) -> Option<LimitError> {
    if least <= value && value <= most {
        None
    } else {
        Some(LimitError { field, value, least, most })
    }
}

/// Charge of the strongest and widest phase, nC, rounded up.
const fn greatest_charge_nc(limits: &Limits) -> u32 {
    let charge = (limits.amplitude_ua as u64 * limits.width_us as u64).div_ceil(1000);
    if charge > u32::MAX as u64 { u32::MAX } else { charge as u32 }
}

const fn least(one: u32, other: u32) -> u32 {
    if one < other { one } else { other }
}

impl Sum for Limits {
    fn sum(&self, checksum: &mut Checksum) {
        let Self {
            amplitude_ua,
            width_us,
            frequency_tenths_pps,
            charge_nc,
            rms_ua,
            rise_ua,
            session_ms,
            rest_ms,
            silence_ms,
            readings_ms,
            rows_ms,
            drives_ms,
            targets_ms,
            angle_ms,
            angle_beyond_mrad,
            angle_speed_mrad_s,
            impedance_ohm,
            supply_mv,
            path_um,
            path_speed_mm_s,
            stuck_ms,
        } = *self;
        let words = [
            amplitude_ua,
            width_us.into(),
            frequency_tenths_pps.into(),
            charge_nc,
            rms_ua,
            rise_ua,
            session_ms,
            rest_ms,
            silence_ms,
            readings_ms,
            rows_ms,
            drives_ms,
            targets_ms,
            angle_ms,
            angle_beyond_mrad,
            angle_speed_mrad_s,
            impedance_ohm.0,
            impedance_ohm.1,
            supply_mv.0,
            supply_mv.1,
            path_um.0.cast_unsigned(),
            path_um.1.cast_unsigned(),
            path_speed_mm_s,
            stuck_ms,
        ];
        words.into_iter().for_each(|word| checksum.add(word));
    }
}

#[cfg(test)]
mod tests {
    use super::{LimitError, Limits};
    use crate::between::guarded::Guarded;
    use crate::between::stimulus::Scale;
    use std::string::ToString;

    const SCALE: Scale = Scale { full_scale_ua: 100_000, full_scale_counts: 4095 };

    #[test]
    fn limits_that_contradict_the_stimulator_or_each_other_are_named() {
        assert_eq!(Limits::SURFACE.validate(1000, &SCALE), Ok(()));
        let refused = |change: fn(&mut Limits)| {
            let mut limits = Limits::SURFACE;
            change(&mut limits);
            limits.validate(1000, &SCALE).expect_err("limits to refuse").to_string()
        };
        for (change, message) in [
            (
                (|l| l.amplitude_ua = 100_001) as fn(&mut Limits),
                "limit amplitude_ua = 100001: must be 1 to 100000",
            ),
            (|l| l.amplitude_ua = 0, "limit amplitude_ua = 0: must be 1 to 100000"),
            (|l| l.width_us = 1001, "limit width_us = 1001: must be 20 to 1000"),
            (|l| l.width_us = 19, "limit width_us = 19: must be 20 to 1000"),
            (
                |l| l.frequency_tenths_pps = 5001,
                "limit frequency_tenths_pps = 5001: must be 10 to 5000",
            ),
            (|l| l.frequency_tenths_pps = 9, "limit frequency_tenths_pps = 9: must be 10 to 5000"),
            (|l| l.charge_nc = 50_001, "limit charge_nc = 50001: must be 1 to 50000"),
            (|l| l.charge_nc = 0, "limit charge_nc = 0: must be 1 to 50000"),
            (|l| l.rms_ua = 100_001, "limit rms_ua = 100001: must be 1 to 100000"),
            (|l| l.rms_ua = 0, "limit rms_ua = 0: must be 1 to 100000"),
            // Eight counts of 24.42 µA.
            (|l| l.rise_ua = 195, "limit rise_ua = 195: must be 196 to 100000"),
            (|l| l.rise_ua = 100_001, "limit rise_ua = 100001: must be 196 to 100000"),
            (|l| l.session_ms = 0, "limit session_ms = 0: must be 1 to 4294967295"),
            (|l| l.rest_ms = 0, "limit rest_ms = 0: must be 1 to 4294967295"),
            (|l| l.silence_ms = 0, "limit silence_ms = 0: must be 1 to 4294967295"),
            (|l| l.readings_ms = 0, "limit readings_ms = 0: must be 1 to 4294967295"),
            (|l| l.rows_ms = 0, "limit rows_ms = 0: must be 1 to 4294967295"),
            (|l| l.drives_ms = 0, "limit drives_ms = 0: must be 1 to 4294967295"),
            (|l| l.targets_ms = 0, "limit targets_ms = 0: must be 1 to 4294967295"),
            (|l| l.angle_ms = 0, "limit angle_ms = 0: must be 1 to 4294967295"),
            (|l| l.angle_beyond_mrad = 6301, "limit angle_beyond_mrad = 6301: must be 0 to 6300"),
            (|l| l.angle_speed_mrad_s = 0, "limit angle_speed_mrad_s = 0: must be 1 to 4294967295"),
            (|l| l.impedance_ohm = (101, 100), "limit impedance_ohm = 101: must be 0 to 100"),
            (|l| l.supply_mv = (4301, 4300), "limit supply_mv = 4301: must be 0 to 4300"),
            (|l| l.path_um = (7, 6), "limit path_um = 7: must be -2147483648 to 6"),
            (|l| l.path_speed_mm_s = 0, "limit path_speed_mm_s = 0: must be 1 to 4294967295"),
            (|l| l.stuck_ms = 0, "limit stuck_ms = 0: must be 1 to 1800000"),
            (|l| l.stuck_ms = 1_800_001, "limit stuck_ms = 1800001: must be 1 to 1800000"),
        ] {
            assert_eq!(refused(change), message);
        }
        // A converter of 12 bits holds no more counts, and fewer than eight are no recharge phase.
        for (full_scale_ua, full_scale_counts, message) in [
            (100_000, 4096, "limit scale.full_scale_counts = 4096: must be 8 to 4095"),
            (100_000, 7, "limit scale.full_scale_counts = 7: must be 8 to 4095"),
            (500_001, 4095, "limit scale.full_scale_ua = 500001: must be 1 to 500000"),
            (0, 4095, "limit scale.full_scale_ua = 0: must be 1 to 500000"),
        ] {
            let scale = Scale { full_scale_ua, full_scale_counts };
            let error = Limits::SURFACE.validate(1000, &scale).expect_err("a scale to refuse");
            assert_eq!(error.to_string(), message);
        }
        // A tick of 1.5 ms cannot tell 1 ms.
        let limits = Limits { silence_ms: 1, ..Limits::SURFACE };
        let error = LimitError { field: "silence_ms", value: 1, least: 2, most: 4_294_967_295 };
        assert_eq!(limits.validate(1500, &SCALE), Err(error));
    }

    /// Times that protect a patient do not change by themselves.
    #[test]
    fn surface_electrodes_have_half_an_hour_and_a_minutes_rest() {
        let Limits { session_ms, rest_ms, silence_ms, rows_ms, drives_ms, .. } = Limits::SURFACE;
        assert_eq!((session_ms, rest_ms), (1_800_000, 60_000));
        assert_eq!((silence_ms, rows_ms, drives_ms), (100, 50, 1_000));
    }

    #[test]
    fn limits_within_a_scale_are_the_smaller_ones_and_valid() {
        for full_scale_ua in [1_000, 50_000, 100_000, 500_000] {
            let scale = Scale { full_scale_ua, full_scale_counts: 4095 };
            let limits = Limits::SURFACE.within_scale(&scale);
            assert_eq!(limits.validate(1000, &scale), Ok(()), "{full_scale_ua}");
            assert_eq!(limits.amplitude_ua, full_scale_ua.min(100_000));
            assert!(limits.charge_nc <= 40_000 && limits.rms_ua <= 20_000);
        }
        let board = Limits::SURFACE.within_scale(&Scale { full_scale_ua: 50_000, ..SCALE });
        assert_eq!((board.amplitude_ua, board.charge_nc, board.rise_ua), (50_000, 25_000, 2_000));
        // A charge that 32 bits cannot hold is as much as they can.
        let most = Limits { amplitude_ua: u32::MAX, charge_nc: u32::MAX, ..Limits::SURFACE };
        let wide = Limits { width_us: u16::MAX, ..most };
        let scale = Scale { full_scale_ua: u32::MAX, ..SCALE };
        assert_eq!(wide.within_scale(&scale).charge_nc, u32::MAX);
    }

    #[test]
    fn every_field_is_in_the_checksum() {
        let changes: [fn(&mut Limits); 24] = [
            |l| l.amplitude_ua ^= 1,
            |l| l.width_us ^= 1,
            |l| l.frequency_tenths_pps ^= 1,
            |l| l.charge_nc ^= 1,
            |l| l.rms_ua ^= 1,
            |l| l.rise_ua ^= 1,
            |l| l.session_ms ^= 1,
            |l| l.rest_ms ^= 1,
            |l| l.silence_ms ^= 1,
            |l| l.readings_ms ^= 1,
            |l| l.rows_ms ^= 1,
            |l| l.drives_ms ^= 1,
            |l| l.targets_ms ^= 1,
            |l| l.angle_ms ^= 1,
            |l| l.angle_beyond_mrad ^= 1,
            |l| l.angle_speed_mrad_s ^= 1,
            |l| l.impedance_ohm.0 ^= 1,
            |l| l.impedance_ohm.1 ^= 1,
            |l| l.supply_mv.0 ^= 1,
            |l| l.supply_mv.1 ^= 1,
            |l| l.path_um.0 ^= 1,
            |l| l.path_um.1 ^= 1,
            |l| l.path_speed_mm_s ^= 1,
            |l| l.stuck_ms ^= 1,
        ];
        for (index, change) in changes.into_iter().enumerate() {
            let mut limits = Limits::SURFACE;
            change(&mut limits);
            assert_ne!(Guarded::new(limits), Guarded::new(Limits::SURFACE));
            let sums = [limits, Limits::SURFACE].map(|limits| format_sum(&limits));
            assert_ne!(sums[0], sums[1], "field {index}");
        }
    }

    fn format_sum(limits: &Limits) -> u32 {
        let mut checksum = vm_nostd::Checksum::EMPTY;
        crate::between::guarded::Sum::sum(limits, &mut checksum);
        checksum.value()
    }
}

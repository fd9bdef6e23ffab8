//! Inputs of the emulated programs, in whole numbers: the host computes them alike.

/// Number of ticks.
pub const TICKS: u32 = 3000;

/// Inputs as a stimulator has them.
#[derive(Clone, Copy, Debug)]
pub struct Integers {
    /// Thousandths.
    pub activation: u16,
    /// µm.
    pub path_length: i32,
    /// Tenths of a pps.
    pub stimulation_frequency: u16,
}

/// Inputs of a tick: activation and frequency step, the path moves 2 cm forth and back.
pub fn at(tick: u32) -> Integers {
    let phase = tick % 800;
    let moved = if phase < 400 { phase } else { 800 - phase };
    Integers {
        activation: if tick % 700 < 450 { 800 } else { 0 },
        path_length: 150_000 + 50 * moved as i32,
        stimulation_frequency: 100 + 50 * (tick / 300 % 6) as u16,
    }
}

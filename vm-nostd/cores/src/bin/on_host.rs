//! The same scenario on the host, for comparison.

use std::io::{self, BufWriter, Write};
use vm_nostd::Fixed;
use vm_nostd_cores::{Arithmetic, Record, Rig, Scenario, TICKS};

/// Writes words.
struct Outlet<W> {
    to: W,
    result: io::Result<()>,
}

impl<W: Write> Record for Outlet<W> {
    fn record(&mut self, mut words: impl Iterator<Item = u32>) {
        let to = &mut self.to;
        let written = words.try_for_each(|word| to.write_all(&word.to_le_bytes()));
        if self.result.is_ok() {
            self.result = written;
        }
    }
}

fn run<S: Arithmetic>(outlet: &mut impl Record) -> io::Result<()> {
    let mut rig = Rig::<S>::at_rest(Scenario::RESTING_PATH).map_err(io::Error::other)?;
    for _ in 0..TICKS {
        rig.tick(&mut Scenario, outlet);
    }
    Ok(())
}

fn main() -> io::Result<()> {
    let mut outlet = Outlet { to: BufWriter::new(io::stdout().lock()), result: Ok(()) };
    run::<Fixed>(&mut outlet)?;
    run::<f32>(&mut outlet)?;
    outlet.result?;
    outlet.to.flush()
}

//! The stimulator built for the shortest and the longest tick, in QEMU: the host's bits, and no
//! late tick.

use host_sim::engine::Class;
use host_sim::hil::{self, Client, Emulated};
use host_sim::reference::Mode;
use host_sim::scenario;
use host_sim::target::{QEMU, STIMULATOR, STM32F405, start_error};
use std::path::Path;
use system_tests::{build_with, skip};

#[test]
fn a_tick_may_be_half_a_millisecond_or_two() {
    if let Err(error) = std::process::Command::new(QEMU).arg("--version").output() {
        return skip(&start_error(QEMU)(error).to_string());
    }
    let scenarios = scenario::all();
    for (tick_us, name) in [("500", "fes_steps@0.5ms"), ("2000", "fes_steps@2ms")] {
        let variables = [("VM_TICK_US", Path::new(tick_us))];
        let image = match build_with(STM32F405, STIMULATOR, &variables) {
            Err(reason) => return skip(&reason.to_string()),
            Ok(image) => image,
        };
        let played = scenarios.iter().find(|one| one.name == name && one.mode == Mode::Fes);
        let scenario = played.expect("a scenario");
        let mut client = Client::new(Emulated::run(&image, &[]).expect("a machine"));
        let played = hil::play(
            &mut client,
            &scenario.muscle,
            Class::Standard,
            scenario.mode,
            &scenario.trace,
            &mut |_| (),
        )
        .expect("equal bits");
        assert_eq!(played.rows.len(), scenario.trace.inputs.len());
        assert_eq!(played.report.late, 0, "at {tick_us} us");
    }
}

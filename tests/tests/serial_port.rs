//! `vm hil --port` with a pseudo-terminal to the emulated board.

use host_sim::engine::Class;
use host_sim::hil;
use host_sim::reference::Mode;
use host_sim::target::{QEMU, STIMULATOR, STM32F405, start_error};
use host_sim::{muscle_file, trace};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use system_tests::{build, skip};

/// Ends the process with the test.
struct Machine(Child);

impl Drop for Machine {
    fn drop(&mut self) {
        let _gone = self.0.kill();
        let _reaped = self.0.wait();
    }
}

#[test]
fn a_board_on_a_serial_port_has_the_hosts_bits() {
    let image = match build(STM32F405, STIMULATOR) {
        Err(reason) => return skip(&reason.to_string()),
        Ok(image) => image,
    };
    let started = Command::new(QEMU)
        .args(["-M", STM32F405.machine, "-display", "none", "-monitor", "none"])
        .args(["-icount", "shift=3,sleep=off", "-serial", "pty", "-kernel"])
        .arg(image)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn();
    let mut machine = match started {
        Err(error) => return skip(&start_error(QEMU)(error).to_string()),
        Ok(child) => Machine(child),
    };
    // "char device redirected to /dev/pts/0 (label serial0)"
    let mut said = String::new();
    let output = machine.0.stdout.take().expect("it is piped");
    BufReader::new(output).read_line(&mut said).expect("a line");
    let port = said.split(' ').find(|word| word.starts_with("/dev/")).expect("a device");

    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/data");
    let muscle =
        muscle_file::read(&data.join("muscles/deltoid_posterior.toml")).expect("a muscle").muscle;
    let trace = trace::read_inputs(&data.join("vectors/fes_steps.csv")).expect("inputs");
    let mut client = hil::serial(port, 115_200).expect("a port");
    let played = hil::play(&mut client, &muscle, Class::Standard, Mode::Fes, &trace, &mut |_| ())
        .expect("equal bits");
    assert_eq!(played.rows.len(), trace.inputs.len());
    assert_eq!(played.report.late, 0);
}

//! `vm`: runs muscles, and proves the accuracy of `vm-nostd`.

use std::process::ExitCode;

fn main() -> ExitCode {
    host_sim::command_line::main()
}

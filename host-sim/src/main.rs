//! The program `vm`.

use std::process::ExitCode;

fn main() -> ExitCode {
    host_sim::command_line::main()
}

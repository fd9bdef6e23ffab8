//! The C examples of `vm-nostd/c/README.md` compile without a warning, and run.

use crate::{library, root};
use std::process::Command;
use system_tests::skip;

/// What stands around an example of a controller: it is used in a function of a tick.
const BEFORE: &str = "#include \"vm_nostd.h\"\n#include <stdio.h>\n\
    static float angle(void) { return 0.5f; }\n\
    static void stimulate(unsigned muscle, float amplitude_ma, float width_us) {\n\
    \x20   printf(\"%u %g %g\\n\", muscle, (double)amplitude_ma, (double)width_us);\n}\n\
    int main(void) {\n";
const AFTER: &str = "\nreturn 0;\n}\n";

#[test]
fn the_examples_of_the_readme_compile_and_run() {
    let text = std::fs::read_to_string(root().join("vm-nostd/c/README.md")).expect("a document");
    let examples: Vec<&str> =
        text.split("```c\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert!(!examples.is_empty(), "an example");
    let folder = tempfile::tempdir().expect("a folder");
    let library = library(None);
    for example in examples {
        let source = folder.path().join("example.c");
        let program = folder.path().join("example");
        std::fs::write(&source, format!("{BEFORE}{example}{AFTER}")).expect("a source");
        let built = Command::new("cc")
            .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-I"])
            .arg(root().join("vm-nostd/c/include"))
            .arg(&source)
            .arg(&library)
            .args(["-lm", "-lpthread", "-ldl", "-o"])
            .arg(&program)
            .output();
        match built {
            Ok(built) => {
                assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
            }
            Err(error) => return skip(&format!("cc: {error} (apt-get install gcc)")),
        }
        let ran = Command::new(&program).output().expect("a program");
        assert!(ran.status.success(), "{}", ran.status);
        // Pulses of both muscles, neither of them empty.
        let written = String::from_utf8_lossy(&ran.stdout);
        let pulses: Vec<&str> = written.lines().collect();
        assert!(pulses.len() >= 2 && pulses[0].starts_with("0 ") && pulses[1].starts_with("1 "));
    }
}

//! Documents: length, links, line width of comments, and the README's C code and picture.

use host_sim::readme;
use host_sim::target::root;
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use system_tests::skip;

/// Files with an extension below a folder, without hidden and build folders.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if name == "target" || name.starts_with('.') {
            continue;
        } else if path.is_dir() {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).expect("a text")
}

/// Reading time: three minutes for the README, ten for a package's.
#[test]
fn the_readmes_are_short() {
    let limits = [
        ("README.md", 900),
        ("firmware/README.md", 2200),
        ("host-sim/README.md", 900),
        ("tests/README.md", 400),
        ("vm-nostd/README.md", 2200),
    ];
    for (file, most) in limits {
        let words = read(&root().join(file)).split_whitespace().count();
        assert!(words <= most, "{file} has {words} words, of at most {most}");
    }
}

/// rustfmt wraps code at 100 columns; its wrapping of comments is not stable.
#[test]
fn comments_end_by_column_100() {
    let mut found = Vec::new();
    for source in files(&root(), "rs") {
        for (index, line) in read(&source).lines().enumerate() {
            if line.trim_start().starts_with("//") && line.chars().count() > 100 {
                found.push(format!("{}:{}", source.display(), index + 1));
            }
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// The anchor of a heading, as in a link after `#`.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c.to_ascii_lowercase() }).collect()
}

/// Headings of a document, as anchors.
fn anchors(text: &str) -> HashSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    headings.map(|line| anchor(line.trim_start_matches('#'))).collect()
}

/// Targets of a document's links, without code blocks.
fn links(text: &str) -> Vec<String> {
    let prose: Vec<&str> = text.split("```").step_by(2).collect();
    let prose = prose.concat();
    let targets = prose.split("](").skip(1);
    targets.filter_map(|rest| rest.split_once(')')).map(|(link, _)| link.to_owned()).collect()
}

#[test]
fn every_link_has_an_existing_target() {
    let mut broken = Vec::new();
    let mut checked = 0;
    for document in files(&root(), "md") {
        let text = read(&document);
        for link in links(&text).into_iter().filter(|link| !link.starts_with("http")) {
            let (file, heading) = link.split_once('#').unwrap_or((&link, ""));
            let target = match file {
                "" => document.clone(),
                file => document.parent().expect("a folder").join(file),
            };
            let leads = target.exists()
                && (heading.is_empty() || anchors(&read(&target)).contains(heading));
            if !leads {
                broken.push(format!("{}: {link}", document.display()));
            }
            checked += 1;
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
    assert!(checked > 40, "only {checked} links");
}

#[test]
fn links_and_headings_are_parsed() {
    assert_eq!(anchor(" Why not 1,000 cycles and 8 KiB"), "why-not-1000-cycles-and-8-kib");
    let text = "# A b\n[x](one.md#two) and\n```sh\n[y](three)\n```\n![z](four.svg)";
    assert_eq!(links(text), ["one.md#two", "four.svg"]);
    assert!(anchors(text).contains("a-b"));
}

/// A table's rows as trimmed cells.
fn rows(text: &str) -> impl Iterator<Item = Vec<&str>> {
    let lines = text.lines().filter(|line| line.starts_with('|'));
    lines.map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
}

/// The README's errors on real muscle, from the table that `vm measured --write` makes.
#[test]
fn errors_on_real_muscle_are_those_of_the_fits() {
    let fits = read(&root().join("host-sim/docs/fitting.md"));
    let number = |cell: &str| cell.parse::<f64>().expect("a number");
    let means: Vec<f64> = rows(&fits)
        .filter(|row| row.len() == 5 && row[1] == "nothing")
        .map(|row| number(row[3]))
        .collect();
    assert_eq!(means.len(), 2, "two sets of recordings");
    let worst = rows(&fits)
        .filter(|row| row.len() == 7 && row[2] == "predict" && row[3] == "nothing")
        .map(|row| number(row[4]))
        .fold(0.0, f64::max);
    let readme = read(&root().join("README.md"));
    for mean in means {
        let text = format!("a mean error of {mean:.0} % of F0, {worst:.0} % at\nworst");
        assert!(readme.contains(&text), "{text}");
    }
}

/// The rate that `firmware/README.md` states and a test computes.
#[test]
fn the_readme_states_the_link_rate_of_the_firmware() {
    let firmware = read(&root().join("firmware/README.md"));
    assert!(firmware.contains("1440 rows"), "firmware/README.md");
    assert!(read(&root().join("README.md")).contains("at most 1440 rows per second"));
}

#[test]
fn the_picture_is_current() {
    let picture = readme::picture().expect("a picture");
    let current = readme::PICTURE.is_current(&picture).expect("a picture in the repository");
    assert!(current, "{} has drifted: cargo vm readme --write", readme::PICTURE.file());
}

/// Compiled with every warning as an error, linked and run; its force is positive.
#[test]
fn the_c_code_of_the_readme_compiles_and_runs() {
    let text = read(&root().join("README.md"));
    let (_, rest) = text.split_once("```c\n").expect("a block of C");
    let (code, _) = rest.split_once("```").expect("its end");
    let program = format!(
        "#include <stddef.h>\n#include \"vm_nostd.h\"\nint main(void) {{\n{code}\
         return output.force_n > 0.0f && output.status == 0 ? 0 : 2;\n}}\n"
    );
    let folder = tempfile::tempdir().expect("a folder");
    let source = folder.path().join("readme.c");
    fs::write(&source, program).expect("a source");

    let libraries = root().join("target/c-library");
    let built = Command::new(env!("CARGO"))
        .args(["build", "--release", "--package", "vm-nostd-c", "--target-dir"])
        .arg(&libraries)
        .current_dir(root())
        .output()
        .expect("cargo");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let binary = folder.path().join("readme");
    let compiled = Command::new("cc")
        .args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic", "-I"])
        .arg(root().join("vm-nostd/c/include"))
        .arg(&source)
        .arg(libraries.join("release/libvm_nostd.a"))
        .args(["-lm", "-lpthread", "-ldl", "-o"])
        .arg(&binary)
        .output();
    let compiled = match compiled {
        Ok(compiled) => compiled,
        Err(error) => return skip(&format!("cc: {error} (apt-get install gcc)")),
    };
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let run = Command::new(binary).status().expect("a program");
    assert!(run.success(), "{run}");
}

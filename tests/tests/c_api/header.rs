//! The header is current. cbindgen does not expand macros: the templates of `vm-nostd/c/src` are
//! expanded here.

use crate::root;
use std::fmt::Write;

/// The part of a template that C sees.
fn part(text: &str) -> &str {
    let (_, text) = text.split_once("// <functions>").expect("a start");
    text.split_once("// </functions>").expect("an end").0
}

/// The source of an arithmetic with the templates that it uses.
fn expanded(source: &str, suffix: &str, templates: &str, floating: &str) -> String {
    let (own, invocation) = source.split_once("\narithmetic! {\n").expect("an invocation");
    // Inner documentation is at the start of a file only.
    let own = if own.contains("floating! {") { floating } else { own };
    let mut text = format!("{own}{templates}");
    let pairs = invocation.lines().filter_map(|line| {
        let (key, value) = line.trim().strip_suffix(',')?.split_once(" = ")?;
        Some((format!("${key}"), value.to_owned()))
    });
    // Longer keys first: `$S` is the start of others.
    let mut pairs: Vec<(String, String)> = pairs.collect();
    pairs.sort_by_key(|(key, _)| std::cmp::Reverse(key.len()));
    for (key, value) in pairs {
        text = text.replace(&key, &value);
    }
    exported(&named(&text, suffix))
}

/// Names with the arithmetic in place of the templates' `A`.
fn named(text: &str, suffix: &str) -> String {
    let mut named = String::new();
    let mut word = String::new();
    for character in text.chars().chain(['\n']) {
        if character.is_ascii_alphanumeric() || character == '_' {
            word.push(character);
            continue;
        }
        if let Some(name) = word.strip_prefix("vm_a_") {
            write!(named, "vm_{}_{name}", suffix.to_lowercase()).expect("a string");
        } else if word.starts_with("VM_") && word.contains("_A_") {
            named += &word.replace("_A_", &format!("_{}_", suffix.to_uppercase()));
        } else if word.starts_with("Vm") && word.ends_with('A') {
            write!(named, "{}{suffix}", &word[..word.len() - 1]).expect("a string");
        } else {
            named += &word;
        }
        word.clear();
        named.push(character);
    }
    named
}

/// With the attribute that cbindgen knows; the name that is exported is the function's.
fn exported(text: &str) -> String {
    let mut lines = Vec::new();
    let mut expected = None;
    for line in text.lines() {
        let line = line.trim_start();
        if let Some(name) = line.strip_prefix("#[unsafe(export_name = concat!(") {
            let name = name.strip_suffix("))]").expect("an attribute");
            expected = Some(name.replace("\", \"", "").replace('"', ""));
            lines.push("#[unsafe(no_mangle)]");
        } else {
            if let Some(name) = expected.take() {
                assert!(
                    line.starts_with(&format!("pub extern \"C\" fn {name}(")),
                    "{name}: {line}"
                );
            }
            lines.push(line);
        }
    }
    lines.join("\n")
}

/// Assertions of the sizes of all structs.
fn size_assertions(sizes: &str, header: &str) -> String {
    let mut text = String::new();
    let rows = sizes
        .lines()
        .filter_map(|line| line.trim().strip_prefix("Vm")?.strip_suffix(',')?.split_once(" = "));
    for (name, bytes) in rows {
        writeln!(text, "VM_ASSERT_SIZE(Vm{name}, {bytes});").expect("a string");
    }
    for arithmetic in ["F32", "Fixed", "F64"] {
        for thing in ["Muscle", "Steady", "Fatigue", "Curve", "Joint", "Prosthesis", "Fes"] {
            let (upper, kind) = (thing.to_uppercase(), arithmetic.to_uppercase());
            writeln!(text, "VM_ASSERT_SIZE(Vm{thing}{arithmetic}, VM_{upper}_{kind}_SIZE);")
                .expect("a string");
        }
    }
    let structs = header.matches("typedef struct").count();
    assert_eq!(text.lines().count(), structs, "the size of every struct is asserted");
    text
}

#[test]
fn the_header_is_current() {
    let folder = root().join("vm-nostd/c");
    let source = |name: &str| {
        std::fs::read_to_string(folder.join(format!("src/{name}.rs"))).expect("a source")
    };
    let floating = source("floating");
    let templates = ["functions", "extra_functions", "control_functions"].map(source);
    let templates = templates.each_ref().map(|text| part(text)).concat();
    let config =
        cbindgen::Config::from_file(folder.join("cbindgen.toml")).expect("a configuration");
    let mut builder = cbindgen::Builder::new().with_config(config);
    for name in [
        "params",
        "presets",
        "derived",
        "kinds",
        "units",
        "result",
        "status",
        "extras",
        "control",
        "control/joint_params",
        "control/presets",
        "control/prosthesis_params",
        "control/fes_params",
    ] {
        builder = builder.with_src(folder.join(format!("src/{name}.rs")));
    }
    let expansions = tempfile::tempdir().expect("a folder");
    for (name, suffix) in [("f32", "F32"), ("fixed", "Fixed"), ("f64", "F64")] {
        let path = expansions.path().join(format!("{name}.rs"));
        let text = expanded(&source(name), suffix, &templates, part(&floating));
        std::fs::write(&path, text).expect("a source");
        builder = builder.with_src(path);
    }
    let bindings = builder.generate().expect("a header");
    let mut text = Vec::new();
    bindings.write(&mut text);
    // C++98 and C90 know no comma before the end of an enum.
    let mut text = String::from_utf8(text).expect("a text").replace(",\n}", "\n}");
    text += &size_assertions(&source("sizes"), &text);
    let header = folder.join("include/vm_nostd.h");
    if std::env::var_os("VM_WRITE").is_some() {
        std::fs::write(&header, &text).expect("a header");
    }
    let current = std::fs::read_to_string(&header).expect("a header");
    assert!(current == text, "VM_WRITE=1 cargo test --release -p system-tests --test c_api");
}

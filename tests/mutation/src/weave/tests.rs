//! A woven program with one mutant on does what a program with that change alone does.

use super::{Placed, weave};
use crate::mutant::{Genre, Mutant, Place, Span};
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::fs;
use std::path::Path;
use std::process::Command;

/// One of each kind, nested and next to each other. `outcome` tells all mutants apart.
const SOURCE: &str = r#"
use std::format;
use std::string::String;

#[derive(Clone, Copy)]
pub struct Pair {
    pub one: i32,
    pub two: i32,
}

const BASE: Pair = Pair { one: 7, two: 70 };
const ABOVE: i32 = above(4);

const fn above(of: i32) -> i32 {
    of + 1
}

const fn twice(of: i32) -> i32 {
    2 * of
}

fn sum(a: i32, b: i32, c: i32) -> i32 {
    a + b * c - (a - 1)
}

fn both(a: bool, b: bool) -> bool {
    a && b
}

fn any(a: bool, b: bool) -> bool {
    !a || b
}

fn add(mut to: Pair, by: i32) -> Pair {
    to.one += to.one * by;
    to
}

fn order(names: &[String; 2]) -> bool {
    // Neither can be copied.
    names[0] < names[1]
}

fn arm(of: i32) -> i32 {
    match of {
        1 => 10,
        n if n > 5 => -n,
        _ => 0,
    }
}

fn field(one: i32) -> Pair {
    Pair { one, ..BASE }
}

fn chained(of: Option<i32>) -> i32 {
    if let Some(n) = of && n > 3 { n } else { 0 }
}

pub fn outcome() -> String {
    let names = [String::from("a"), String::from("b")];
    let same = [String::from("a"), String::from("a")];
    let truths = [(true, true), (true, false), (false, true), (false, false)];
    format!(
        "{} {} {} {:?} {:?} {} {} {} {:?} {} {:?} {}",
        ABOVE,
        twice(8),
        sum(3, 4, 5),
        truths.map(|(a, b)| both(a, b)),
        truths.map(|(a, b)| any(a, b)),
        add(Pair { one: 3, two: 4 }, 5).one,
        order(&names),
        order(&same),
        [1, 5, 6].map(arm),
        field(1).one,
        [Some(3), Some(4), None].map(chained),
        above(9),
    )
}
"#;

/// A change at the `offset`-th byte of what follows `after`.
fn mutant(genre: Genre, after: &str, what: &str, replacement: &str) -> Mutant {
    let after = SOURCE.find(after).expect("in the source");
    let start = after + SOURCE[after..].find(what).expect("behind it");
    let place = |byte: usize| {
        let before = &SOURCE[..byte];
        let line = before.matches('\n').count() + 1;
        Place { line, column: byte - before.rfind('\n').expect("a line") }
    };
    Mutant {
        name: format!("source.rs:{start}: {what} with {replacement}"),
        file: "source.rs".into(),
        genre,
        replacement: replacement.into(),
        span: Span { start: place(start), end: place(start + what.len()) },
    }
}

fn mutants() -> Vec<Mutant> {
    use Genre::{BinaryOperator, FnValue, MatchArm, MatchArmGuard, StructField, UnaryOperator};
    vec![
        mutant(FnValue, "fn twice", "2 * of", "0"),
        mutant(BinaryOperator, "2 * of", "*", "+"),
        mutant(FnValue, "fn sum", "a + b * c - (a - 1)", "-1"),
        mutant(BinaryOperator, "a + b * c", "+", "-"),
        mutant(BinaryOperator, "a + b * c", "+", "*"),
        mutant(BinaryOperator, "a + b * c", "*", "/"),
        mutant(BinaryOperator, "a + b * c", "-", "+"),
        mutant(BinaryOperator, "(a - 1)", "-", "/"),
        mutant(BinaryOperator, "a && b", "&&", "||"),
        mutant(BinaryOperator, "!a || b", "||", "&&"),
        mutant(UnaryOperator, "!a || b", "!", ""),
        mutant(BinaryOperator, "to.one += ", "+=", "-="),
        mutant(BinaryOperator, "to.one += ", "*", "+"),
        mutant(BinaryOperator, "names[0] < names[1]", "<", "=="),
        mutant(BinaryOperator, "names[0] < names[1]", "<", "<="),
        mutant(MatchArm, "        1 => 10,", "1 => 10,", ""),
        mutant(MatchArm, "n if n > 5", "n if n > 5 => -n,", ""),
        mutant(MatchArmGuard, "n if n > 5", "n > 5", "true"),
        mutant(MatchArmGuard, "n if n > 5", "n > 5", "false"),
        mutant(BinaryOperator, "n if n > 5", ">", ">="),
        mutant(UnaryOperator, "n if n > 5", "-", ""),
        mutant(StructField, "{ one, ..BASE }", "one,", ""),
        // Those that are not woven.
        mutant(BinaryOperator, "fn above", "+", "-"),
        mutant(BinaryOperator, "of && n > 3", "&&", "||"),
        mutant(FnValue, "const ABOVE", "above(4)", "0"),
    ]
}

/// Compiles a program and gives its path.
fn compile(folder: &Path, name: &str, text: &str) -> std::path::PathBuf {
    let (source, program) = (folder.join(format!("{name}.rs")), folder.join(name));
    fs::write(&source, text).expect("a file");
    let output = Command::new("rustc")
        .args(["--edition", "2024", "--cap-lints", "allow", "-o"])
        .arg(&program)
        .arg(&source)
        .output()
        .expect("rustc");
    assert!(output.status.success(), "{text}\n{}", String::from_utf8_lossy(&output.stderr));
    program
}

fn run(program: &Path, argument: &str, mutant: Option<usize>) -> String {
    let mut command = Command::new(program);
    command.arg(argument);
    if let Some(mutant) = mutant {
        command.env("VM_MUTANT", mutant.to_string());
        command.env("VM_MUTANT_LOG", program.with_extension("log"));
    }
    String::from_utf8(command.output().expect("it runs").stdout).expect("a text")
}

#[test]
fn a_woven_mutant_does_what_it_does_alone() {
    let mutants = mutants();
    let numbered: Vec<(usize, &Mutant)> = mutants.iter().enumerate().collect();
    let evaluated = BTreeSet::from(["above".to_owned()]);
    let woven = weave(SOURCE, &numbered, &HashSet::new(), &evaluated).expect("a source");
    let named = |of: &BTreeMap<usize, String>| {
        Vec::from_iter(of.iter().map(|(number, why)| (mutants.len() - number, why.clone())))
    };
    let why = ["evaluated by the compiler: above", "not found in the syntax"].map(String::from);
    assert_eq!(named(&woven.apart), [(3, why[0].clone()), (1, why[1].clone())]);
    assert_eq!(named(&woven.unviable), [(2, "only && chains with let".to_owned())]);
    let woven_in = mutants.len() - 3;
    for (number, mutant) in mutants[..woven_in].iter().enumerate() {
        let times = woven.text.matches(&format!("on({number})")).count();
        assert_eq!(times, 1, "{}", mutant.name);
    }
    let folder = std::env::temp_dir().join(format!("mutation-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    let chooser = include_str!("../woven.rs").replace("//!", "//");
    let main = "fn main() { println!(\"{}\", program::outcome()); }";
    let text = format!("mod woven {{ {chooser} }}\nmod program {{ {} }}\n{main}", woven.text);
    let chosen = compile(&folder, "chosen", &text);
    let mut text = format!("mod none {{ {SOURCE} }}");
    let mut arms = String::from("None => none::outcome(),");
    for (number, mutant) in mutants[..woven_in].iter().enumerate() {
        text.push_str(&format!("\nmod m{number} {{ {} }}", mutant.alone(SOURCE)));
        arms.push_str(&format!("Some({number}) => m{number}::outcome(),"));
    }
    text.push_str(&format!(
        "fn main() {{ let number = std::env::args().nth(1).and_then(|n| n.parse().ok()); \
         println!(\"{{}}\", match number {{ {arms} Some(_) => String::new() }}); }}"
    ));
    let alone = compile(&folder, "alone", &text);
    let unchanged = run(&alone, "", None);
    assert_eq!(run(&chosen, "", None), unchanged);
    for (number, mutant) in mutants[..woven_in].iter().enumerate() {
        let expected = run(&alone, &number.to_string(), None);
        assert_ne!(expected, unchanged, "{}", mutant.name);
        let _ = fs::remove_file(chosen.with_extension("log"));
        assert_eq!(run(&chosen, "", Some(number)), expected, "{}", mutant.name);
        let log = fs::read_to_string(chosen.with_extension("log")).expect("reached");
        assert_eq!(log.trim(), number.to_string());
    }
    fs::remove_dir_all(folder).expect("its folder");
}

#[test]
fn what_the_compiler_complains_of_is_found_in_the_text() {
    let mutants = mutants();
    let numbered: Vec<(usize, &Mutant)> = mutants.iter().enumerate().collect();
    let woven = weave(SOURCE, &numbered, &HashSet::new(), &BTreeSet::new()).expect("a source");
    let at = woven.text.find("l / r").expect("the mutant of b * c");
    let Placed { bytes, mutants, .. } = woven
        .places
        .iter()
        .filter(|place| place.is_replacement)
        .find(|place| place.bytes.contains(&at))
        .expect("a place");
    assert_eq!((&woven.text[bytes.clone()], &mutants[..]), ("l / r", &[5][..]));
    // Left out, it is gone; its neighbours are not.
    let left_out = HashSet::from([5]);
    let woven = weave(SOURCE, &numbered, &left_out, &BTreeSet::new()).expect("a source");
    assert!(!woven.text.contains("on(5)") && woven.text.contains("on(4)"));
}

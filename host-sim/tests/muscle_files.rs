//! Muscle files: strength by mass or by force, and elements overridden by name.

use host_sim::coefficients;
use host_sim::engine::{self, Arithmetic, Class};
use host_sim::muscle_file::parse;
use host_sim::reference::{Input, Mode, Muscle};
use host_sim::trace::InputTrace;
use std::path::Path;

const MUSCLE: &str = include_str!("../data/muscles/deltoid_posterior.toml");

fn muscle(text: &str) -> Muscle {
    parse(text, Path::new("m.toml")).unwrap_or_else(|error| panic!("{error}")).muscle
}

fn refused(text: &str, words: &[&str]) {
    let message = parse(text, Path::new("m.toml")).expect_err("a file to refuse").to_string();
    for word in words {
        assert!(message.contains(word), "no \"{word}\" in: {message}");
    }
}

/// The muscle file with the line of the mass replaced.
fn with(line: &str) -> String {
    MUSCLE.replacen("mass_g = 97.5", line, 1)
}

#[test]
fn a_maximal_force_may_replace_the_mass() {
    let by_mass = muscle(MUSCLE);
    let by_force = muscle(&with(&format!("max_isometric_force_n = {}", by_mass.f0())));
    assert!((by_force.mass / by_mass.mass - 1.0).abs() < 1e-14);
    assert!((by_force.f0() / by_mass.f0() - 1.0).abs() < 1e-14);
    let strong = muscle(&with("max_isometric_force_n = 532"));
    assert!((strong.f0() - 532.0).abs() < 1e-9);
    // Specific tension is the file's.
    let tense = with("max_isometric_force_n = 532\nelements.specific_tension_n_per_cm2 = 20");
    let tense = muscle(&tense);
    assert!((tense.f0() - 532.0).abs() < 1e-9 && tense.mass > 1.5 * strong.mass, "{tense:?}");
}

#[test]
fn exactly_one_of_mass_and_force_is_required() {
    let both = ["mass_g", "max_isometric_force_n", "exactly one"];
    refused(&with("mass_g = 97.5\nmax_isometric_force_n = 266"), &both);
    refused(&with(""), &both);
    for value in ["0", "-1", "inf", "nan", "1e9"] {
        let file = with(&format!("max_isometric_force_n = {value}"));
        refused(&file, &["m.toml, line 3: max_isometric_force_n = ", "mass"]);
    }
    // The error names the cause, not a consequence.
    let file = with("max_isometric_force_n = 266\nelements.density_g_per_cm3 = 0");
    refused(&file, &["elements.density_g_per_cm3 = 0", "between 0.5 and 2"]);
    let file = with("max_isometric_force_n = 266").replace("_cm = 11.0", "_cm = -1");
    refused(&file, &["line 4: fascicle_length_cm = -1"]);
}

#[test]
fn every_element_is_overridden_by_name() {
    let before = muscle(MUSCLE).elements;
    let row = coefficients::element_row(coefficients::DEFAULT_SET).expect("the default set");
    let columns = coefficients::element_columns();
    assert_eq!(columns.len(), 12);
    for column in &columns {
        // 1 % more, both in the reference and in the model.
        let changed = 1.01 * row[column];
        let after = muscle(&format!("{MUSCLE}\n[elements]\n{column} = {changed}\n")).elements;
        let fields = |e: &host_sim::reference::Elements| {
            [
                e.cT,
                e.kT,
                e.LrT,
                e.c1,
                e.k1,
                e.Lr1,
                e.eta,
                e.c2,
                e.k2,
                e.Lr2,
                e.specific_tension,
                e.density,
            ]
        };
        let changes: Vec<f64> =
            fields(&after).iter().zip(fields(&before)).map(|(a, b)| a / b).collect();
        let moved: Vec<usize> = (0..12).filter(|&index| changes[index] != 1.0).collect();
        let index = columns.iter().position(|name| name == column).expect("a column");
        assert_eq!(moved, [index], "{column}");
        assert!((changes[index] - 1.01).abs() < 1e-12, "{column}");
    }
}

#[test]
fn a_custom_element_has_the_same_effect_in_reference_and_model() {
    let stiff = format!("{MUSCLE}\n[elements]\ncT = 20\neta = 0.02\n");
    let input = Input { activation: 0.6, path_length: 0.165, stimulation_frequency: 30.0 };
    let rest = Input { activation: 0.0, ..input };
    let inputs = std::iter::once(rest).chain(std::iter::repeat_n(input, 300)).collect();
    let trace = InputTrace { start: 0.0, time_step: 1e-3, inputs };
    let force = |text: &str, arithmetic| {
        let rows = engine::run(&muscle(text), Mode::Fes, arithmetic, &trace).expect("a run");
        rows.last().expect("rows").0.force
    };
    let (plain, own) = (force(MUSCLE, Arithmetic::Reference), force(&stiff, Arithmetic::Reference));
    assert!((plain - own).abs() > 0.1, "{plain} {own}");
    for arithmetic in [Arithmetic::F32, Arithmetic::Fixed] {
        let found = force(&stiff, arithmetic);
        assert!((found - own).abs() < 0.05, "{arithmetic:?}: {found} {own}");
    }
}

#[test]
fn an_invalid_element_is_refused_with_file_line_key_and_limit() {
    let with = |line: &str| format!("{MUSCLE}\n[elements]\n{line}\n");
    let line = format!("m.toml, line {}: elements.", MUSCLE.lines().count() + 3);
    let unknown: Vec<String> = coefficients::element_columns();
    let mut words: Vec<&str> = vec![&line, "ct = 30", "unknown key"];
    words.extend(unknown.iter().map(String::as_str));
    refused(&with("ct = 30"), &words);
    refused(&with("cT = \"stiff\""), &[&line, "cT", "a number"]);
    refused(&with("cT = nan"), &[&line, "cT = nan", "finite"]);
    refused(&with("cT = 0.5"), &[&line, "cT = 0.5", "between 1 and 200"]);
    refused(&with("density_g_per_cm3 = 9"), &[&line, "density_g_per_cm3 = 9", "0.5 and 2"]);
    let tension = "specific_tension_n_per_cm2 = 0.5";
    refused(&with(tension), &[&line, tension, "1 and 1000"]);
}

#[test]
fn a_file_chooses_its_accuracy_class() {
    let class = |line: &str| {
        let text = MUSCLE.replacen("mass_g", &format!("{line}\nmass_g"), 1);
        parse(&text, Path::new("m.toml")).map(|named| named.class).map_err(|e| e.to_string())
    };
    assert_eq!(class(""), Ok(Class::Standard));
    for known in Class::ALL {
        assert_eq!(class(&format!("class = \"{}\"", known.name())), Ok(known));
    }
    let refusal = "m.toml, line 3: class = \"coarse\": must be one of economy, standard, fine";
    assert_eq!(class("class = \"coarse\""), Err(refusal.to_owned()));
    assert!(class("class = 1").is_err_and(|message| message.contains("class")));
}

//! Against what we did not write: the published tables and figures.

use host_sim::coefficients;
use host_sim::engine::{self, Arithmetic};
use host_sim::link;
use host_sim::reference::{Input, Mode};
use host_sim::scenario::paper_muscle;
use host_sim::trace::InputTrace;
use vm_nostd::{ElementParams, FiberType, feline_vm4, human_vm4, paper_table_1};

/// Steady force (N) of natural continuous recruitment on a 16 cm path, by activation, from the
/// authors' program.
const STATIC_FORCE: [(f64, f64); 11] = [
    (0.05, 5.244),
    (0.1, 10.905),
    (0.2, 23.876),
    (0.3, 38.403),
    (0.4, 53.929),
    (0.5, 68.993),
    (0.6, 84.388),
    (0.7, 103.551),
    (0.8, 123.752),
    (0.9, 143.822),
    (1.0, 163.384),
];

fn steady_force(activation: f64, arithmetic: Arithmetic) -> f64 {
    let input = Input { activation, path_length: 0.16, stimulation_frequency: 0.0 };
    let trace = InputTrace { start: 0.0, time_step: 1e-3, inputs: vec![input; 3001] };
    let rows = engine::run(&paper_muscle(), Mode::Continuous, arithmetic, &trace).expect("a run");
    rows.last().expect("a row").0.force
}

#[test]
fn the_static_curve_of_force_by_activation_is_the_authors() {
    for (activation, force) in STATIC_FORCE {
        // The table has three decimals.
        let reference = steady_force(activation, Arithmetic::Reference);
        assert!((reference - force).abs() < 0.001, "U {activation}: {reference} N, not {force} N");
        let f32 = steady_force(activation, Arithmetic::F32);
        assert!((f32 - force).abs() < 0.002, "U {activation}: {f32} N in f32, not {force} N");
    }
}

#[test]
fn the_paper_muscle_has_the_published_force_and_length() {
    let muscle = paper_muscle();
    assert!((muscle.f0() - 265.909).abs() < 5e-4, "F0 = {} N", muscle.f0());
    let longest = muscle.maximum_fascicle_length();
    assert!((longest - 1.498750).abs() < 5e-7, "L_max = {longest}");
    let params = link::params::<2>(&muscle);
    assert!((params.max_isometric_force() - muscle.f0()).abs() < 1e-9);
    assert!((params.maximum_fascicle_length() - longest).abs() < 1e-9);
}

#[test]
fn presets_are_the_published_tables() {
    let fibers: [(&str, FiberType); 8] = [
        ("paper-table-1/slow", paper_table_1::SLOW),
        ("paper-table-1/fast", paper_table_1::FAST),
        ("human-vm4/super-slow", human_vm4::SUPER_SLOW),
        ("human-vm4/slow", human_vm4::SLOW),
        ("human-vm4/fast", human_vm4::FAST),
        ("feline-vm4/super-slow", feline_vm4::SUPER_SLOW),
        ("feline-vm4/slow", feline_vm4::SLOW),
        ("feline-vm4/fast", feline_vm4::FAST),
    ];
    let rows = coefficients::fiber_rows();
    assert_eq!(rows.len(), fibers.len(), "a preset for every row of fibers.csv");
    for ((name, row), (preset_name, preset)) in rows.iter().zip(fibers) {
        assert_eq!(name, preset_name);
        let published = coefficients::fiber_type(row).expect("a full row");
        assert_eq!(link::fiber_type(&published), preset, "{name}");
    }
    let elements: [(&str, ElementParams); 3] = [
        ("paper-table-1", paper_table_1::ELEMENTS),
        ("human-vm4", human_vm4::ELEMENTS),
        ("feline-vm4", feline_vm4::ELEMENTS),
    ];
    assert_eq!(coefficients::element_rows().len(), elements.len());
    for (name, preset) in elements {
        let published = coefficients::elements(name).expect("a published set");
        assert_eq!(link::element_params(&published), preset, "{name}");
    }
}

//! Comparison with published tables and figures.

use host_sim::coefficients;
use host_sim::engine::{self, Arithmetic};
use host_sim::model_muscle;
use host_sim::reference::{Input, Mode};
use host_sim::scenario::{paper_muscle, paper_muscle_of_units};
use host_sim::trace::InputTrace;
use vm_nostd::{ElementParams, FiberType, feline_vm4, human_vm4, paper_table_1};

/// Steady force (N) on a 16 cm path by activation, from the authors' program: natural continuous
/// recruitment, and natural discrete recruitment of 3 + 3 and of 30 + 30 motor units.
const STATIC_FORCE: [(f64, [f64; 3]); 11] = [
    (0.05, [5.244, 0.307, 5.938]),
    (0.1, [10.905, 0.307, 11.855]),
    (0.2, [23.876, 16.061, 25.549]),
    (0.3, [38.403, 37.293, 41.896]),
    (0.4, [53.929, 42.511, 59.156]),
    (0.5, [68.993, 70.776, 77.675]),
    (0.6, [84.388, 89.337, 96.941]),
    (0.7, [103.551, 111.894, 119.096]),
    (0.8, [123.752, 137.049, 143.575]),
    (0.9, [143.822, 157.451, 159.204]),
    (1.0, [163.384, 165.026, 165.026]),
];

/// Force after three seconds of constant activation; without units in natural continuous
/// recruitment.
fn steady_force(units: Option<usize>, activation: f64, arithmetic: Arithmetic) -> f64 {
    let (muscle, mode) = match units {
        None => (paper_muscle(), Mode::Continuous),
        Some(count) => (paper_muscle_of_units(count), Mode::Discrete),
    };
    let input = Input { activation, path_length: 0.16, stimulation_frequency: 0.0 };
    let trace = InputTrace { start: 0.0, time_step: 1e-3, inputs: vec![input; 3001] };
    let rows = engine::run(&muscle, mode, arithmetic, &trace).expect("a run");
    rows.last().expect("a row").0.force
}

#[test]
fn static_force_over_activation_agrees_with_the_authors() {
    for (activation, forces) in STATIC_FORCE {
        for (units, force) in [None, Some(3), Some(30)].into_iter().zip(forces) {
            // The last unit's threshold is 0.8 within rounding: the authors' program recruits it at
            // 0.8 with 6 units but not with 60. The model is evaluated next to the threshold.
            let beside = match units {
                Some(3) if activation == 0.8 => 1e-6,
                Some(_) if activation == 0.8 => -1e-6,
                _ => 0.0,
            };
            // The table has three decimals.
            for (arithmetic, at, most) in [
                (Arithmetic::Reference, activation, 0.001),
                (Arithmetic::F32, activation + beside, 0.0016),
                (Arithmetic::Fixed, activation + beside, 0.01),
            ] {
                let found = steady_force(units, at, arithmetic);
                let error = (found - force).abs();
                assert!(
                    error < most,
                    "{units:?} U {activation}: {found} {arithmetic:?}, {force} N"
                );
            }
        }
    }
}

#[test]
fn the_paper_muscle_has_the_published_force_and_length() {
    let muscle = paper_muscle();
    assert!((muscle.f0() - 265.909).abs() < 5e-4, "F0 = {} N", muscle.f0());
    let longest = muscle.maximum_fascicle_length();
    assert!((longest - 1.498750).abs() < 5e-7, "L_max = {longest}");
    let params = model_muscle::params::<2>(&muscle);
    assert!((params.max_isometric_force() - muscle.f0()).abs() < 1e-9);
    assert!((params.maximum_fascicle_length() - longest).abs() < 1e-9);
}

#[test]
fn presets_equal_the_published_tables() {
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
        assert_eq!(model_muscle::fiber_type(&published), preset, "{name}");
    }
    let elements: [(&str, ElementParams); 3] = [
        ("paper-table-1", paper_table_1::ELEMENTS),
        ("human-vm4", human_vm4::ELEMENTS),
        ("feline-vm4", feline_vm4::ELEMENTS),
    ];
    assert_eq!(coefficients::element_rows().len(), elements.len());
    for (name, preset) in elements {
        let published = coefficients::elements(name).expect("a published set");
        assert_eq!(model_muscle::element_params(&published), preset, "{name}");
    }
}

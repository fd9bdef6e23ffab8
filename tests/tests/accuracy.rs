//! Every comparison of `vm verify` passes, and each check can fail.

use host_sim::engine::Class;
use host_sim::metrics::ForceError;
use host_sim::tolerance;
use host_sim::{golden, readme, verify};

#[test]
fn every_row_is_within_its_tolerance_and_documented() {
    let report = verify::verify().expect("all scenarios run");
    let failed: Vec<String> = report
        .rows
        .iter()
        .filter(|row| !row.pass)
        .map(|row| format!("{} {} {}: {}", row.scenario, row.mode, row.arithmetic, row.problem))
        .collect();
    assert!(failed.is_empty(), "{failed:#?}");
    assert!(report.unused.is_empty(), "tolerances of no row: {:#?}", report.unused);
    assert!(report.passed());
    for (place, table) in readme::tables(&report).expect("a table of cycles") {
        let current = place.is_current(&table).expect("a file with a place for the table");
        assert!(current, "{} has drifted: cargo vm readme --write", place.file());
    }
}

#[test]
fn tolerances_are_within_the_promised_limits_and_have_reasons() {
    let f0 = host_sim::scenario::paper_muscle().f0();
    for (key, entry) in tolerance::table() {
        let (promised, promised_rms) = tolerance::promise(&key, Class::Standard, f0);
        assert!(entry.max <= promised, "{key:?}: {} > {promised}", entry.max);
        if let Some(promised) = promised_rms {
            let rms = entry.rms.expect("an rms tolerance where one is promised");
            assert!(rms <= promised, "{key:?}: {rms} > {promised}");
        }
        assert!(entry.reason.split_whitespace().count() >= 4, "{key:?}: no reason");
    }
}

#[test]
fn the_promised_limits_are_those_of_the_project() {
    let promise = |scenario: &str, arithmetic: &str| {
        let key = [scenario, "continuous", arithmetic, "reference"].map(str::to_owned);
        tolerance::promise(&key, Class::Standard, 265.909)
    };
    assert_eq!(promise("continuous_steps", "f32"), (0.1, None));
    assert_eq!(promise("activation_10hz@0.5ms", "f32"), (0.05, None));
    assert_eq!(promise("passive_length_3hz", "f32"), (1.0, Some(0.1)));
    assert_eq!(promise("passive_length_3hz@0.5ms", "f32"), (0.5, Some(0.05)));
    assert_eq!(promise("velocity_kinks", "fixed"), (1.0, Some(0.1)));
    assert_eq!(promise("fast_ramps_kinks", "f32"), (1.0, Some(0.1)));
    assert_eq!(promise("fes_variable_trains", "f32"), (0.2, None));
    assert_eq!(promise("activation_10hz@0.1ms", "f32"), (0.05, None));
    assert_eq!(promise("activation_10hz@2ms", "f32"), (1.0, None));
    assert_eq!(promise("velocity_kinks@2ms", "f32"), (10.0, Some(1.0)));
    let newtons = promise("continuous_steps", "reference").0 * 265.909 / 100.0;
    assert!((newtons - 0.005).abs() < 1e-12);
}

#[test]
fn an_error_of_force_is_detected() {
    let error = ForceError::between(&[1.0, 2.0, 3.0], &[1.0, 2.5, 3.0], 100.0);
    assert_eq!(error.max, 0.5);
    assert!((error.bias + 0.5 / 3.0).abs() < 1e-12);
    assert!((error.rms - (0.25_f64 / 3.0).sqrt()).abs() < 1e-12);
    assert!(ForceError::between(&[1.0, f64::NAN, 1.0], &[1.0; 3], 1.0).max.is_nan());
}

#[test]
fn all_bits_equal_the_golden_bits() {
    let differences = golden::differences().expect("golden bits to compare with");
    assert!(
        differences.is_empty(),
        "{differences:#?}\nif they had to change: cargo vm golden --bless --reason \"why\""
    );
}

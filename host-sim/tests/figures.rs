//! `vm figures` leaves its files, its numbers are the authors' where they are known, and its claims say
//! what is found.

use std::fs;
use std::process::Command;

/// Steady forces of the authors' program (N): continuous, 3 + 3, 30 + 30 units.
const AUTHORS: [(f64, [f64; 3]); 3] = [
    (0.2, [23.876, 16.061, 25.549]),
    (0.5, [68.993, 70.776, 77.675]),
    (1.0, [163.384, 165.026, 165.026]),
];

#[test]
fn figures_come_with_their_numbers_and_claims() {
    let folder = tempfile::tempdir().expect("a folder");
    // One that is not there yet.
    let out = folder.path().join("figures");
    let output = Command::new(env!("CARGO_BIN_EXE_vm"))
        .args(["figures", "--out"])
        .arg(&out)
        .output()
        .expect("vm runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| fs::read_to_string(out.join(name)).expect(name);

    for name in [
        "arm",
        "static_force",
        "static_force_start",
        "sinusoid_responses",
        "sinusoids",
        "computation_time",
    ] {
        let svg = read(&format!("{name}.svg"));
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"), "{name}");
        assert!(svg.matches("<polyline").count() >= 2, "{name}: lines");
    }
    let table = read("static_force.csv");
    for (activation, forces) in AUTHORS {
        let cells = |line: &str| -> Vec<f64> { line.split(',').flat_map(str::parse).collect() };
        let row = table.lines().map(cells).find(|row| row.first() == Some(&activation));
        let row = row.expect("a row of that activation");
        for (found, force) in row[1..].iter().zip(forces) {
            assert!((found - force).abs() < 0.002, "U {activation}: {found} N, not {force} N");
        }
    }
    assert_eq!(read("sinusoids.csv").lines().count(), 1 + 2 * 10);
    assert_eq!(read("sinusoid_responses.csv").lines().count(), 1 + 2 * 1000);

    assert_eq!(read("arm.csv").lines().count(), 1 + 5001);

    // The first nine claims do not depend on the machine.
    let claims = read("claims.csv");
    let agree: Vec<bool> =
        claims.lines().skip(1).take(9).map(|line| line.contains(",true,")).collect();
    assert_eq!(agree, [true, true, true, true, true, false, false, true, false], "{claims}");
    assert_eq!(claims.lines().count(), 1 + 11);
    assert!(String::from_utf8_lossy(&output.stdout).contains("why not"));
}

//! `vm figures`: its files, the agreement with the authors' numbers where these are known, and the
//! claims with their results.

use std::fs;
use std::process::Command;

/// Steady forces of the authors' program (N): continuous, 3 + 3, 30 + 30 units.
const AUTHORS: [(f64, [f64; 3]); 3] = [
    (0.2, [23.876, 16.061, 25.549]),
    (0.5, [68.993, 70.776, 77.675]),
    (1.0, [163.384, 165.026, 165.026]),
];

#[test]
fn figures_numbers_and_claims_are_written() {
    let folder = tempfile::tempdir().expect("a folder");
    // A folder that does not exist yet.
    let out = folder.path().join("figures");
    let output = Command::new(env!("CARGO_BIN_EXE_vm"))
        .args(["figures", "--output"])
        .arg(&out)
        .output()
        .expect("vm runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| fs::read_to_string(out.join(name)).expect(name);

    for name in FIGURES {
        let svg = read(&format!("{name}.svg"));
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"), "{name}");
        assert!(svg.matches("<polyline").count() >= 2, "{name}: lines");
        printable(name, &svg);
    }
    // Inputs are drawn above the responses, the paper's printed values beside the computed ones.
    let axes = |name: &str| attributes(&read(&format!("{name}.svg")), "axis");
    assert!(axes("arm").iter().any(|axis| axis.ends_with(">U (1)")));
    let responses = axes("sinusoid_responses");
    for input in [">U (1)", ">L_mt (cm)"] {
        assert!(responses.iter().any(|axis| axis.ends_with(input)), "{responses:?}");
    }
    assert!(read("sinusoid_responses.svg").contains("peak printed in the paper"));
    for (name, marks) in
        [("static_force", 3 * 11 + 1), ("static_force_start", 3 * 4 + 1), ("computation", 2 + 1)]
    {
        // Including one in the legend.
        assert_eq!(read(&format!("{name}.svg")).matches("class=\"mark\"").count(), marks, "{name}");
    }
    // Figure 4(b) ends at U = 0.3; recruitment steps are vertical.
    let start = read("static_force_start.svg");
    let labels = attributes(&start, "tick-x");
    assert!(labels.last().is_some_and(|label| label.ends_with(">0.30")), "{labels:?}");
    let points = points(&start);
    let vertical = |line: &Vec<(f64, f64)>| {
        line.windows(2).any(|pair| pair[0].0 == pair[1].0 && (pair[0].1 - pair[1].1).abs() > 20.0)
    };
    assert!(points.iter().any(vertical), "no vertical step");

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

    // Recruitment steps of 6 and 60 units; the first of 3 + 3 is at 0.8 times 60 % times the first
    // unit's share.
    let steps = read("static_force_steps.csv");
    assert_eq!(steps.lines().count(), 1 + 6 + 60, "{steps}");
    assert!(steps.lines().nth(1).is_some_and(|line| line.starts_with("3,0.12,")), "{steps}");
    assert_eq!(read("arm.csv").lines().count(), 1 + 30_001);

    // Each claim states its limit, and a claim that fails its reason.
    let mut reader = csv::Reader::from_path(out.join("claims.csv")).expect("claims");
    let claims: Vec<Vec<String>> = reader
        .records()
        .map(|row| row.expect("a claim").iter().map(str::to_owned).collect())
        .collect();
    let found: Vec<(&str, bool)> =
        claims.iter().map(|claim| (claim[0].as_str(), claim[5] == "true")).collect();
    let expected = [
        ("3", true),
        ("3", true),
        ("4(b)", true),
        ("5(e)", true),
        ("5(e)", true),
        ("6", true),
        ("6", false),
        ("5", false),
        ("6", false),
        ("7", false),
    ];
    assert_eq!(found, expected, "{claims:#?}");
    for claim in &claims {
        assert!(claim[3].contains(|c: char| c.is_ascii_digit()), "no limit: {claim:?}");
        assert!(claim[5] == "true" || !claim[6].is_empty(), "no reason: {claim:?}");
    }
    // Figure 5(e) is about activation: there is no claim on ratios with sinusoids of length.
    assert!(
        !claims
            .iter()
            .any(|claim| claim[1].contains("over discrete") && claim[1].contains("length,"))
    );
    let number = |text: &str| -> f64 {
        text.split_whitespace().next().and_then(|word| word.parse().ok()).expect(text)
    };
    // At 3 Hz: 0.45 % of peak with activation, 11 % with length, by the authors' formulas in other
    // codes.
    assert!((number(&claims[5][4]) - 0.45).abs() < 0.05, "{}", claims[5][4]);
    assert!((number(&claims[6][4]) - 11.0).abs() < 0.5, "{}", claims[6][4]);
    // The arm keeps swinging with constant amplitude.
    let period = claims[0][4].split("period ").nth(1).expect("a period");
    assert!((number(period) - 2.4).abs() < 0.1, "{}", claims[0][4]);
    assert!(
        claims[0][4].ends_with("+0.00/s") || claims[0][4].ends_with("-0.00/s"),
        "{}",
        claims[0][4]
    );
    assert!(claims[1][4].contains("no period"), "{}", claims[1][4]);
    // The units of figure 7, in cycles, independent of the machine.
    let costs = read("computation.csv");
    assert!(costs == include_str!("../data/computation.csv"), "{costs}");
    for mode in ["discrete", "discrete-leff"] {
        for units in [1, 3, 6, 15, 30] {
            assert!(costs.contains(&format!("\n{mode},{units},")), "{mode} {units}: {costs}");
        }
    }
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(told.contains("why not") && told.contains("held to"), "{told}");
}

const FIGURES: [&str; 6] =
    ["arm", "static_force", "static_force_start", "sinusoid_responses", "sinusoids", "computation"];

/// Attributes and text of each element of a class.
fn attributes(svg: &str, class: &str) -> Vec<String> {
    let begin = format!("<text class=\"{class}\"");
    svg.lines()
        .filter_map(|line| line.strip_prefix(&begin)?.strip_suffix("</text>"))
        .map(str::to_owned)
        .collect()
}

/// An attribute's number.
fn number(text: &str, name: &str) -> f64 {
    let (_, rest) = text.split_once(&format!(" {name}=\"")).expect(name);
    rest.split('"').next().and_then(|number| number.parse().ok()).expect(name)
}

/// The points of each line.
fn points(svg: &str) -> Vec<Vec<(f64, f64)>> {
    let of_line = |line: &str| {
        let points = line.strip_prefix("<polyline points=\"")?.split('"').next()?;
        let point = |pair: &str| {
            let (x, y) = pair.split_once(',').expect("a pair");
            (x.parse().expect("x"), y.parse().expect("y"))
        };
        Some(points.split(' ').map(point).collect())
    };
    svg.lines().filter_map(of_line).collect()
}

/// Requirements of a printed figure: no legend over data, no clipped labels, no stair-stepped
/// lines, and different dashes for the lines of a panel.
fn printable(name: &str, svg: &str) {
    let frames: Vec<(f64, f64)> = svg
        .lines()
        .filter(|line| line.starts_with("<rect class=\"frame\""))
        .map(|line| (number(line, "y"), number(line, "y") + number(line, "height")))
        .collect();
    assert!(!frames.is_empty(), "{name}");
    for legend in attributes(svg, "legend") {
        let y = number(&legend, "y");
        let inside = frames
            .iter()
            .any(|(top, bottom)| (y - 13.0..y + 4.0).contains(top) || (*top..*bottom).contains(&y));
        assert!(!inside, "{name}: a legend over data: {legend}");
    }
    let width = number(svg.lines().next().expect("a line"), "width");
    let labels = attributes(svg, "tick-x");
    assert!(labels.len() >= 4, "{name}: {labels:?}");
    for label in &labels {
        let text = label.split('>').nth(1).expect("a text");
        // A digit of 13 pixels height is at most 8 wide.
        let half = 4.0 * text.len() as f64;
        let x = number(label, "x");
        assert!(x + half <= width && x - half >= 0.0, "{name}: {label} is cut off");
    }
    for title in attributes(svg, "title") {
        // A letter of 18 pixels height is 9 wide on average.
        let letters = title.split('>').nth(1).expect("a text").chars().count();
        assert!(9.0 * (letters as f64) < width, "{name}: {title} is cut off");
    }
    // Except for legend samples and horizontal lines.
    let lines: Vec<_> = points(svg).into_iter().filter(|line| line.len() > 2).collect();
    let fractions = lines.iter().flatten().filter(|point| point.1.fract() != 0.0).count();
    let all = lines.iter().map(Vec::len).sum::<usize>();
    assert!(fractions * 2 > all, "{name}: {fractions} of {all} heights are between pixels");
    // No two lines of a panel have the same dashes.
    let mut dashes = Vec::new();
    for line in svg.lines() {
        if line.starts_with("<rect class=\"frame\"") {
            dashes.clear();
        } else if line.starts_with("<polyline") {
            let dash =
                line.split("stroke-dasharray=").nth(1).and_then(|text| text.split('"').nth(1));
            let dash = dash.expect("dashes").to_owned();
            // The samples of the next legend follow the lines of this panel.
            if line.split('"').nth(1).is_some_and(|points| points.split(' ').count() > 2) {
                assert!(!dashes.contains(&dash), "{name}: two lines with dashes {dash}");
                dashes.push(dash);
            }
        }
    }
}

//! What the page knows: muscles and cycles, from the files that `vm` has them from.

use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::Path;
use vm_nostd::{Class, FiberParams, MuscleParams, human_vm4};

type Row = BTreeMap<String, String>;

/// U_r of the named muscles, the authors' default value, as in `vm muscles`.
const RECRUITMENT_SATURATION: f64 = 0.8;

/// Muscles, and cycles per tick.
pub fn all(host_sim: &Path) -> Result<Value, Box<dyn Error>> {
    let mut muscles = vec![paper(&host_sim.join("data/muscles/deltoid_posterior.toml"))?];
    for row in rows(&host_sim.join("data/human_muscles.csv"))? {
        muscles.push(human(&row)?);
    }
    let mut cycles = measured(&fs::read_to_string(host_sim.join("docs/cycles.md"))?)?;
    for row in rows(&host_sim.join("data/computation.csv"))? {
        if text(&row, "mode")?.starts_with("discrete") {
            cycles.push(by_units(&row)?);
        }
    }
    Ok(json!({ "muscles": muscles, "cycles": cycles }))
}

fn rows(file: &Path) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut reader =
        csv::Reader::from_path(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let headers = reader.headers()?.clone();
    reader
        .records()
        .map(|record| {
            let record = record?;
            Ok(headers.iter().map(str::to_owned).zip(record.iter().map(str::to_owned)).collect())
        })
        .collect()
}

fn text<'a>(row: &'a Row, column: &str) -> Result<&'a str, Box<dyn Error>> {
    Ok(row.get(column).ok_or_else(|| format!("no column {column}"))?)
}

fn number(row: &Row, column: &str) -> Result<f64, Box<dyn Error>> {
    let text = text(row, column)?;
    text.parse().map_err(|error| format!("{column} = {text}: {error}").into())
}

/// The paper's muscle, from its file: `name = value` lines, and the fraction of slow fibres first.
fn paper(file: &Path) -> Result<Value, Box<dyn Error>> {
    let text = fs::read_to_string(file)?;
    let value = |key: &str| -> Result<String, Box<dyn Error>> {
        let line = text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
        let value = line.ok_or_else(|| format!("{}: no {key}", file.display()))?;
        Ok(value.trim_matches('"').to_owned())
    };
    let number = |key: &str| -> Result<f64, Box<dyn Error>> { Ok(value(key)?.parse()?) };
    if !value("preset")?.ends_with("/slow") {
        return Err(format!("{}: the first fibre type must be slow", file.display()).into());
    }
    Ok(json!({
        "name": value("name")?,
        "source": "Song et al. 2008",
        "coefficients": value("coefficients")?,
        "mass_g": number("mass_g")?,
        "fascicle_length_cm": number("fascicle_length_cm")?,
        "tendon_length_cm": number("tendon_length_cm")?,
        "max_path_length_cm": number("max_path_length_cm")?,
        "recruitment_saturation": number("recruitment_saturation")?,
        "slow": number("fraction")?,
    }))
}

/// A muscle of the table, as `--muscle NAME` has it.
fn human(row: &Row) -> Result<Value, Box<dyn Error>> {
    let elements = human_vm4::ELEMENTS;
    let force = number(row, "max_isometric_force_n")?;
    let fascicle_length = number(row, "fascicle_length_cm")? * 1e-2;
    let slow = number(row, "slow_fraction")?;
    let types = [(slow, human_vm4::SLOW), (1.0 - slow, human_vm4::FAST)];
    let params = MuscleParams {
        mass: force * elements.density * fascicle_length / elements.specific_tension,
        fascicle_length,
        tendon_length: number(row, "tendon_slack_length_cm")? * 1e-2 / elements.tendon.slack_length,
        max_path_length: 0.0,
        recruitment_saturation: RECRUITMENT_SATURATION,
        class: Class::Standard,
        elements,
        fibers: types.map(|(fraction, fiber_type)| FiberParams { fraction, fiber_type }),
    };
    // L_max is linear in L_mt_max.
    let at_no_path = params.maximum_fascicle_length();
    let longest = (number(row, "max_fascicle_length_l0")? - at_no_path) * fascicle_length;
    Ok(json!({
        "name": text(row, "muscle")?,
        "source": format!("{}, {}; slow fraction: {}", text(row, "source")?, text(row, "licence")?,
            text(row, "slow_source")?),
        "coefficients": "human-vm4",
        "max_isometric_force_n": force,
        "fascicle_length_cm": number(row, "fascicle_length_cm")?,
        "tendon_length_cm": params.tendon_length * 1e2,
        "max_path_length_cm": longest * 1e2,
        "recruitment_saturation": RECRUITMENT_SATURATION,
        "slow": slow,
    }))
}

/// The rows of the generated table that are of the model in a natural or the FES mode.
fn measured(document: &str) -> Result<Vec<Value>, Box<dyn Error>> {
    let mut lines = document.lines().filter(|line| line.starts_with("| "));
    let cells = |line: &str| -> Vec<String> {
        line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
    };
    let header = cells(lines.next().ok_or("docs/cycles.md: no table")?);
    let column = |name: &str| {
        header.iter().position(|cell| cell == name).ok_or(format!("docs/cycles.md: no {name}"))
    };
    let (typical, most) = (column("typ mean")?, column("pess max")?);
    let (core, case, class) = (column("core")?, column("case")?, column("class")?);
    let mut found = Vec::new();
    for line in lines.take_while(|line| line.starts_with("| cortex-")) {
        let cells = cells(line);
        if let Some((mode @ ("continuous" | "fes"), arithmetic)) = cells[case].split_once('-') {
            found.push(json!({
                "core": cells[core], "mode": mode, "arithmetic": arithmetic,
                "class": cells[class],
                "typical": cells[typical].parse::<u32>()?, "most": cells[most].parse::<u32>()?,
            }));
        }
    }
    if found.is_empty() { Err("docs/cycles.md: no cycles".into()) } else { Ok(found) }
}

/// Cycles of the discrete modes, by motor units of each type.
fn by_units(row: &Row) -> Result<Value, Box<dyn Error>> {
    Ok(json!({
        "core": "cortex-m4f", "mode": text(row, "mode")?, "arithmetic": "f32",
        "class": "standard",
        "units": text(row, "units_per_type")?.parse::<u32>()?,
        "typical": text(row, "cycles")?.parse::<u32>()?, "most": null,
    }))
}

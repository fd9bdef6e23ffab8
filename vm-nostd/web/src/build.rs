//! Puts the page together: markup, style, script, data and WebAssembly in one file.

mod data;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";
/// The script's parts, each of which knows those before it.
const SCRIPTS: [(&str, &str); 6] = [
    ("model.js", include_str!("../page/model.js")),
    ("inputs.js", include_str!("../page/inputs.js")),
    ("copy.js", include_str!("../page/copy.js")),
    ("charts.js", include_str!("../page/charts.js")),
    ("view.js", include_str!("../page/view.js")),
    ("page.js", include_str!("../page/page.js")),
];

/// Writes the page into a folder, `target/web` if none is given; says what was written.
pub fn page(folder: Option<&str>) -> Result<String, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize()?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or(root.join("target"), PathBuf::from);
    let wasm = wasm(&root, &target)?;
    let data = serde_json::to_string(&data::all(&root.join("host-sim"))?)?;
    // Within a script `</` would end it.
    let data = data.replace("</", "<\\/");
    let script: String =
        SCRIPTS.iter().map(|(name, text)| format!("// {name}\n{text}\n")).collect();
    let mut page = include_str!("../page/index.html").to_owned();
    for (mark, text) in [
        ("/*STYLE*/", include_str!("../page/style.css")),
        ("/*SCRIPT*/", &script),
        ("/*DATA*/", &data),
        ("/*WASM*/", &STANDARD.encode(&wasm)),
    ] {
        if page.matches(mark).count() != 1 {
            return Err(format!("{mark}: must be in index.html once").into());
        }
        page = page.replace(mark, text);
    }
    let folder = folder.map_or(target.join("web"), PathBuf::from);
    fs::create_dir_all(&folder)?;
    let file = folder.join("index.html");
    fs::write(&file, &page)?;
    let (kilobytes, of_wasm) = (page.len() / 1024, wasm.len() / 1024);
    Ok(format!("{}: {kilobytes} KiB, of which WebAssembly {of_wasm} KiB", file.display()))
}

/// The model in WebAssembly.
fn wasm(root: &Path, target: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args(["build", "--quiet", "--package", "vm-nostd-web", "--lib"])
        .args(["--profile", "web", "--target", TARGET])
        .current_dir(root)
        .status()?;
    if !status.success() {
        return Err(format!("no WebAssembly: try `rustup target add {TARGET}`").into());
    }
    Ok(fs::read(target.join(TARGET).join("web/vm_nostd_web.wasm"))?)
}

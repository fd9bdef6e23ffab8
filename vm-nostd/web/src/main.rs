//! `cargo run --release -p vm-nostd-web -- [FOLDER]`: puts the page together in one file, which any
//! web server or `file://` shows; FOLDER is `target/web` if none is given.

#[cfg(not(target_family = "wasm"))]
mod build;

#[cfg(not(target_family = "wasm"))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1);
    let written = build::page(folder.as_deref())?;
    println!("{written}");
    Ok(())
}

#[cfg(target_family = "wasm")]
fn main() {}

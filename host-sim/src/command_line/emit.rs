//! `vm emit`: a muscle as constant words for firmware.

use super::ModeName;
use crate::emit::{Emission, Language};
use crate::engine::{Arithmetic, Class, RunError};
use crate::muscles::find;
use crate::output_file::STANDARD;
use crate::trace;
use clap::Args;
use std::error::Error;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct EmitArgs {
    /// Muscle, in TOML, or a name of `vm muscles`. Fatigue and recruitment curve are left out.
    #[arg(long)]
    muscle: PathBuf,
    /// Recruitment mode.
    #[arg(long, value_enum)]
    mode: ModeName,
    /// Arithmetic.
    #[arg(long, value_enum)]
    arithmetic: Arithmetic,
    /// Accuracy class. Default: that of the muscle file, which is standard if it names none.
    #[arg(long, value_enum)]
    class: Option<Class>,
    /// Tick, ms; 0.1 to 2.
    #[arg(long, default_value_t = 1.0)]
    tick: f64,
    /// Language.
    #[arg(long, value_enum)]
    language: Language,
    /// Output; `-` is standard output.
    #[arg(long, visible_alias = "out", default_value = STANDARD)]
    output: PathBuf,
}

/// Writes the words.
pub fn run(args: &EmitArgs) -> Result<(), Box<dyn Error>> {
    let named = find(&args.muscle)?;
    let class = args.class.unwrap_or(named.class);
    if args.arithmetic == Arithmetic::Reference {
        return Err("--arithmetic reference: only f32, fixed and f64 are built".into());
    }
    if trace::same_file(&args.output, &args.muscle) {
        let output = args.output.display();
        return Err(format!("--output {output}: must be another file than --muscle's").into());
    }
    let emission = Emission {
        name: &named.name,
        muscle: &named.muscle,
        mode: args.mode.into(),
        arithmetic: args.arithmetic,
        class,
        time_step: args.tick * 1e-3,
    };
    let text = emission.text(args.language).map_err(|error| match error {
        RunError::Refused(refused) if refused.field == "time_step" => {
            format!("--tick {}: must be 0.1 to 2 ms", args.tick)
        }
        error => error.to_string(),
    })?;
    trace::write_atomically(&args.output, text.as_bytes())?;
    Ok(())
}

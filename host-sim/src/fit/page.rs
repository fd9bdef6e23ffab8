//! A fit as one HTML page that needs no network.

use super::outcome::{Fit, TrialFit};
use super::trials::Role;
use crate::chart::{Chart, Line, Panel};
use askama::Template;

/// Why the page could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// The template failed.
    #[error(transparent)]
    Page(#[from] askama::Error),
}

/// A row of a table.
type Cells = Vec<String>;

#[derive(Template)]
#[template(path = "fit.html")]
struct Page<'a> {
    origin: &'a str,
    noise: String,
    noise_ratio: String,
    starts: (usize, usize),
    parameters: Vec<Cells>,
    pairs: Vec<Cells>,
    trials: Vec<Cells>,
    confirmed: Vec<Cells>,
    plots: Vec<String>,
}

/// The page; `origin` names muscle and recordings.
pub fn page(fit: &Fit, origin: &str) -> Result<String, PageError> {
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.5e}"));
    let page = Page {
        origin,
        noise: format!("{:.4}", fit.noise),
        noise_ratio: format!("{:.2}", fit.noise_ratio),
        starts: fit.starts,
        parameters: fit
            .estimates
            .iter()
            .map(|estimate| {
                let interval = estimate.interval();
                vec![
                    estimate.name.clone(),
                    number(Some(estimate.value)),
                    number(estimate.standard_error),
                    number(interval.map(|interval| interval.0)),
                    number(interval.map(|interval| interval.1)),
                    estimate.note().to_owned(),
                ]
            })
            .collect(),
        pairs: fit
            .pairs
            .iter()
            .map(|pair| {
                let [one, other] = pair.names.clone();
                vec![one, other, format!("{:.3}", pair.correlation)]
            })
            .collect(),
        trials: fit
            .trials
            .iter()
            .map(|trial| {
                vec![
                    trial.name.clone(),
                    trial.role.name().to_owned(),
                    format!("{:.2}", trial.mae_pct_f0),
                    format!("{:.2}", trial.rms_pct_f0),
                    format!("{:+.2}", trial.bias_pct_f0),
                    trial.status_names(),
                ]
            })
            .collect(),
        confirmed: fit
            .confirmed
            .iter()
            .map(|confirmed| {
                let (max, rms) = confirmed.difference;
                let name = confirmed.arithmetic.name().to_owned();
                vec![name, format!("{max:.4}"), format!("{rms:.4}")]
            })
            .collect(),
        plots: fit.trials.iter().map(plot).collect(),
    };
    Ok(page.render()?)
}

fn plot(trial: &TrialFit) -> String {
    let line = |name: &str, forces: &[f64]| {
        Line::new(name, trial.times.iter().copied().zip(forces.iter().copied()))
    };
    let role = match trial.role {
        Role::Fit => "fitted",
        Role::Predict => "predicted",
    };
    let errors: Vec<f64> =
        trial.model.iter().zip(&trial.measured).map(|(model, force)| model - force).collect();
    let title = format!("{}, {role}", trial.name);
    let chart = Chart {
        title: &title,
        x: "time (s)",
        panels: vec![
            Panel::new(
                "force (N)",
                vec![line("measured", &trial.measured), line(role, &trial.model)],
            ),
            Panel::new("error (N)", vec![line("error", &errors)]),
        ],
    };
    chart.draw()
}

//! The first patient's runs of a task, under every controller.

use super::controller::Kind;
use super::patient::Patient;
use super::study::Row;
use super::task::Task;
use super::trial::{Instant, Trial};
use crate::chart::{Chart, Line, Panel};
use vm_nostd::control::JointError;

/// Draws angles and pulse widths in SVG; `rows` have the controllers' settings.
pub fn picture(task: Task, rows: &[Row]) -> Result<String, JointError> {
    let patient = Patient::scored(task, 0);
    let (mut angles, mut widths) = (Vec::new(), Vec::new());
    for (kind, row) in Kind::ALL.into_iter().zip(rows) {
        if kind == Kind::ModelFixed {
            // Differs from `f32` by less than a line's width.
            continue;
        }
        let mut instants: Vec<Instant> = Vec::new();
        let trial = Trial { task, patient: &patient, kind, settings: &row.settings, tuning: false };
        trial.run(|instant| instants.push(instant))?;
        let of = |value: fn(&Instant) -> f64| {
            instants.iter().map(|instant| (instant.time, value(instant))).collect::<Vec<_>>()
        };
        if angles.is_empty() {
            angles.push(Line::new("target", of(|instant| instant.target.to_degrees())));
        }
        angles.push(Line::new(kind.name(), of(|instant| instant.angle.to_degrees())));
        // Extensors' pulses are drawn downwards.
        widths.push(Line::new(
            kind.name(),
            of(|instant| (instant.widths[0] - instant.widths[1]) * 1e6),
        ));
    }
    let panels = vec![Panel::new("angle (deg)", angles), Panel::new("pulse width (us)", widths)];
    Ok(Chart { title: task.name(), x: "time (s)", panels }.draw())
}

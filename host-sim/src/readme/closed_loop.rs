//! The table of controllers in closed loop, row by row: a task takes up to half an hour.

use crate::closed_loop::{COLUMNS, Kind, Row, Study, Task};

/// The table in `before` with the rows of the study's tasks and controllers replaced; the others
/// stay.
pub fn closed_loop(before: &str, study: &Study, rows: &[Row]) -> String {
    let tuning = format!("{} x {}", study.tuning_patients, study.evaluations);
    let line = |cells: &[String]| format!("| {} |", cells.join(" | "));
    let header = COLUMNS.map(str::to_owned);
    let mut text = vec![
        line(&[&header[..], &["tuning".to_owned()]].concat()),
        format!("|---|---|---|{}", "---:|".repeat(COLUMNS.len() - 2)),
    ];
    for task in Task::ALL {
        for kind in Kind::ALL {
            let name = [task.name(), kind.name(), kind.arithmetic()];
            if study.tasks.contains(&task) && study.controllers.contains(&kind) {
                let is_wanted = |row: &&Row| [row.task, row.controller, row.arithmetic] == name;
                let new = rows.iter().filter(is_wanted);
                text.extend(
                    new.map(|row| {
                        line(&[&row.cells()[..], std::slice::from_ref(&tuning)].concat())
                    }),
                );
            } else {
                let begin = format!("| {} |", name.join(" | "));
                let kept = before.lines().filter(|line| line.starts_with(&begin));
                text.extend(kept.map(str::to_owned));
            }
        }
    }
    text.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn study(task: Task) -> Study {
        let (tasks, controllers) = (vec![task], vec![Kind::Pi]);
        Study { tasks, controllers, patients: 2, tuning_patients: 1, evaluations: 3 }
    }

    fn row(task: Task, rms_p95: f64) -> Row {
        Row {
            task: task.name(),
            controller: "PI",
            arithmetic: "f64",
            patients: 2,
            rms_median: 1.0,
            rms_p95,
            overshoot_p95: 3.0,
            charge_median_uc: 4.0,
            endured_p5_s: 5.0,
            unstable: 0,
            limit_broken: 0,
            settings: vec![0.1],
        }
    }

    #[test]
    fn tasks_are_replaced_one_by_one() {
        let (reach, foot) = (Task::ElbowReach, Task::DropFoot);
        let first = closed_loop("", &study(reach), &[row(reach, 2.0)]);
        let both = closed_loop(&first, &study(foot), &[row(foot, 7.0)]);
        let again = closed_loop(&both, &study(foot), &[row(foot, 8.0)]);
        let lines: Vec<&str> = again.lines().collect();
        assert_eq!(lines.len(), 4, "{again}");
        assert!(lines[2].starts_with("| drop-foot | PI | f64 | 2 | 1.00 | 8.00 |"), "{again}");
        assert!(lines[3].starts_with("| elbow-reach | PI | f64 | 2 | 1.00 | 2.00 |"), "{again}");
        assert!(lines.iter().all(|line| line.matches('|').count() == 13), "{again}");
        assert!(lines[3].ends_with("| 1 x 3 |"), "{again}");
    }
}

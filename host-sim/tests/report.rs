//! `vm report`: a complete and self-contained page.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const CYCLES: &str = r#"[{
    "case": "continuous-f32", "mode": "continuous", "arithmetic": "f32", "target": "cortex-m4f",
    "ticks": 10, "instructions_max": 3000, "cycles_opt_mean": 1.0, "cycles_opt_p99": 1,
    "cycles_opt_max": 1, "cycles_typ_mean": 4321.4, "cycles_typ_p99": 1, "cycles_typ_max": 4700,
    "cycles_pess_mean": 1.0, "cycles_pess_p99": 1, "cycles_pess_max": 98765, "worst_tick": 3,
    "replay": "cargo vm cycles --case continuous-f32 --tick 3", "state_bytes": 56,
    "code_bytes": 6890, "stack_bytes": 600, "max_pct_f0": 0.3, "ratio": null, "budget": 98000,
    "pass": false
}]"#;

fn report(out: &Path, cycles: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_vm"))
        .args(["report", "--output"])
        .arg(out)
        .arg("--cycles")
        .arg(cycles)
        .output()
        .expect("vm runs")
}

#[test]
fn the_page_is_complete() {
    let folder = tempfile::tempdir().expect("a folder");
    let (out, cycles) = (folder.path().join("report.html"), folder.path().join("cycles.json"));
    fs::write(&cycles, CYCLES).expect("a file");
    #[cfg(unix)]
    let kept = {
        use std::os::unix::fs::PermissionsExt;
        fs::write(&out, "as it was").expect("a file");
        let kept = fs::Permissions::from_mode(0o664);
        fs::set_permissions(&out, kept.clone()).expect("permissions");
        kept.mode()
    };
    let done = report(&out, &cycles);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        assert_eq!(fs::metadata(&out).expect("a page").permissions().mode() & 0o777, kept);
    }
    let page = fs::read_to_string(&out).expect("a page");

    // No external resources and no scripts.
    let names_svg = r#"xmlns="http://www.w3.org/2000/svg""#;
    let without_names = page.replace(names_svg, "");
    for foreign in ["http:", "https:", "//cdn", "<script", "<link", "<img", "@import", "url("] {
        assert!(!without_names.contains(foreign), "{foreign}");
    }
    assert!(page.starts_with("<!doctype html>") && page.contains("prefers-color-scheme: dark"));
    assert!(page.contains(r#"name="viewport" content="width=device-width"#));

    // Every opened tag is closed.
    for tag in ["table", "tr", "td", "th", "details", "div", "p", "svg", "ul", "li", "h2", "h3"] {
        let opened =
            page.matches(&format!("<{tag}>")).count() + page.matches(&format!("<{tag} ")).count();
        assert_eq!(opened, page.matches(&format!("</{tag}>")).count(), "{tag}");
    }
    // Every scenario at 1 ms has its plot, with axes, units and a legend; there are six
    // figures and the closed loop.
    let scenarios = page.matches("error (% of F0)").count();
    assert!(scenarios >= 38, "{scenarios} plots");
    assert_eq!(page.matches("<svg ").count(), scenarios + 7);
    for label in [
        "time (s)",
        "force (N)",
        "elbow angle (degrees)",
        "pulse width (us)",
        "activation U (1)",
        "frequency (Hz)",
    ] {
        assert!(page.contains(label), "{label}");
    }
    assert!(page.matches(">fixed</text>").count() >= scenarios, "legends");
    // Each plot has its inputs.
    for input in [">U (1)</text>", ">L_mt (cm)</text>"] {
        assert!(page.matches(input).count() >= scenarios, "{input}");
    }

    // Date, version, commit and machine.
    let commit = Command::new("git")
        .args(["-C", env!("CARGO_MANIFEST_DIR"), "rev-parse", "--short=12", "HEAD"])
        .output()
        .ok()
        .filter(|output| output.status.success());
    let commit = commit.map_or("unknown".to_owned(), |output| {
        String::from_utf8_lossy(&output.stdout).trim().to_owned()
    });
    for words in [
        concat!("vm-nostd ", env!("CARGO_PKG_VERSION")),
        &format!("commit {commit}"),
        " UTC",
        std::env::consts::ARCH,
        " cores",
    ] {
        assert!(page.contains(words), "no \"{words}\"");
    }
    cards(&page);

    // The numbers equal those of the other commands.
    let golden = include_str!("../data/golden.toml");
    for line in golden.lines().filter(|line| line.starts_with('"')) {
        let (name, bits) = line.split_once(" = ").expect("a checksum");
        let row = format!(
            "<td>{}</td><td><code>{}</code>",
            name.trim_matches('"'),
            bits.trim_matches('"')
        );
        assert!(page.contains(&row), "{line}");
    }
    let tolerances = include_str!("../data/tolerances.csv").lines().count() - 1;
    assert!(page.contains(&format!("{tolerances} of {tolerances}</b>comparisons")));
    assert!(page.contains("with effective length the arm goes unstable"));
    assert!(page.contains("98765") && page.contains(r#"<span class="bad">NO</span>"#));
    assert!(page.contains("are the committed ones"));
}

/// The cards at the top of the page, and whether they are marked as bad.
fn cards(page: &str) {
    let list =
        page.split("<ul class=\"facts\">").nth(1).and_then(|rest| rest.split("</ul>").next());
    let cards: Vec<&str> =
        list.expect("cards").lines().filter(|line| line.contains("<li>")).collect();
    let card = |words: &str| {
        let found = cards.iter().find(|card| card.contains(words));
        *found.unwrap_or_else(|| panic!("no \"{words}\" in {cards:#?}"))
    };
    // The largest error over all scenarios, with limit, name and mode.
    let all = card("largest error in f32 at 1 kHz, all scenarios");
    assert!(all.contains("fast_ramps_kinks, continuous") && all.contains("limit 1 %"), "{all}");
    let others = card("largest error in f32 at 1 kHz, where the tendon does not ring");
    assert!(others.contains("limit 0.2 %"), "{others}");
    card("largest error in fixed at 1 kHz, all scenarios");
    // The card of the claims is bad if a claim fails.
    let claims = card("claims of the paper reproduced");
    let (found, all) =
        claims.split(['>', '<']).find_map(|text| text.split_once(" of ")).expect("a count");
    assert_eq!(claims.contains("bad"), found != all, "{claims}");
    assert!(found != all && all == "10", "{claims}");
    // State sizes equal those of the table of cycles.
    let budgets = include_str!("../data/budgets.toml");
    for (case, bytes) in [("continuous-f32", 84), ("continuous-fixed", 128)] {
        assert!(budgets.contains(&format!("[core.cortex-m4f.{case}]")));
        let card = card(case);
        assert!(card.contains(&format!(">{bytes} B<")) && card.contains("budget"), "{card}");
    }
    // Thresholds of "close to 1" are shown.
    assert!(page.contains("<td>0.95 to 1.05</td>") && page.contains("<td>0.85 to 1.15</td>"));
}

#[test]
fn an_invalid_file_of_cycles_is_refused_before_measuring() {
    let folder = tempfile::tempdir().expect("a folder");
    let (out, cycles) = (folder.path().join("report.html"), folder.path().join("cycles.json"));
    for text in ["", "{}", r#"[{"case": "continuous-f32"}]"#] {
        fs::write(&cycles, text).expect("a file");
        let done = report(&out, &cycles);
        let message = String::from_utf8_lossy(&done.stderr).into_owned();
        assert_eq!(done.status.code(), Some(2), "{message}");
        assert!(
            message.contains("cycles.json: not the output of cargo vm cycles --json"),
            "{message}"
        );
    }
    fs::write(&cycles, CYCLES).expect("a file");
    let message = |done: Output| String::from_utf8_lossy(&done.stderr).into_owned();
    let same = folder.path().join("cycles.html");
    fs::write(&same, CYCLES).expect("a file");
    assert!(message(report(&same, &same)).contains("must be another file than --cycles's"));
    assert_eq!(fs::read_to_string(&same).expect("a file"), CYCLES);
    let nowhere = message(report(&folder.path().join("none/report.html"), &cycles));
    assert!(nowhere.contains("none: No such file"), "{nowhere}");
    let done = report(&out, &folder.path().join("none.json"));
    assert!(String::from_utf8_lossy(&done.stderr).contains("none.json: "));
    assert!(!out.exists());
}

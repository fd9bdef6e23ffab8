//! tmp
use host_sim::{coefficients as c, reference::*};
fn main() {
    let fiber = |p: &str, fraction| Fiber {
        fraction,
        fiber_type: c::fiber_type(&c::fiber_row(p).unwrap()).unwrap(),
    };
    let m = Muscle {
        mass: 0.0975,
        L_ce0: 0.11,
        L_se0: 0.02,
        L_mt_max: 0.184,
        U_r: 0.8,
        elements: c::elements(c::DEFAULT_SET).unwrap(),
        fibers: vec![
            fiber("paper-table-1/slow", 0.6),
            fiber("paper-table-1/fast", 0.4),
        ],
    };
    println!("{} {}", m.f0(), m.maximum_fascicle_length());
    for (f, mode) in [
        ("continuous_activation_3hz", Mode::Continuous),
        ("continuous_length_3hz", Mode::Continuous),
        ("continuous_steps", Mode::Continuous),
        ("passive_length_3hz", Mode::Continuous),
        ("fes_ramp_20hz", Mode::Fes),
        ("fes_steps", Mode::Fes),
    ] {
        let t0 = std::time::Instant::now();
        let mut r = csv::Reader::from_path(format!("tests/vectors/{f}.csv")).unwrap();
        let rows: Vec<Vec<f64>> = r
            .records()
            .map(|x| x.unwrap().iter().map(|c| c.parse().unwrap()).collect())
            .collect();
        let mut sim = Simulation::at_rest(m.clone(), mode, 1e-3, rows[0][2]);
        let (mut e0, mut e1) = (0f64, (0f64, 0.0));
        for row in &rows[1..] {
            let s = sim
                .step(Input {
                    activation: row[1],
                    path_length: row[2],
                    stimulation_frequency: row[3],
                })
                .unwrap();
            let e = (s.force - row[4]).abs();
            if row[0] <= 0.1 {
                e0 = e0.max(e);
            } else if e > e1.0 {
                e1 = (e, row[0]);
            }
        }
        println!("{f}: {e0:e} {e1:?} {:?}", t0.elapsed());
    }
}

//! Fittable numbers of a muscle file: key, unit, and place in a muscle.

use crate::reference::{Elements, Fatigue, FiberType, Muscle};

/// A number of a muscle file: key, file units per SI unit, and accessor (`None` without sag or
/// yield).
type Number<Part> = (&'static str, f64, fn(&mut Part) -> Option<&mut f64>);

const MUSCLE: &[Number<Muscle>] = &[
    ("mass_g", 1e3, |m| Some(&mut m.mass)),
    ("fascicle_length_cm", 1e2, |m| Some(&mut m.L_ce0)),
    ("tendon_length_cm", 1e2, |m| Some(&mut m.L_se0)),
    ("max_path_length_cm", 1e2, |m| Some(&mut m.L_mt_max)),
    ("recruitment_saturation", 1.0, |m| Some(&mut m.U_r)),
];

const ELEMENTS: &[Number<Elements>] = &[
    ("cT", 1.0, |e| Some(&mut e.cT)),
    ("kT", 1.0, |e| Some(&mut e.kT)),
    ("LrT", 1.0, |e| Some(&mut e.LrT)),
    ("c1", 1.0, |e| Some(&mut e.c1)),
    ("k1", 1.0, |e| Some(&mut e.k1)),
    ("Lr1", 1.0, |e| Some(&mut e.Lr1)),
    ("eta", 1.0, |e| Some(&mut e.eta)),
    ("c2", 1.0, |e| Some(&mut e.c2)),
    ("k2", 1.0, |e| Some(&mut e.k2)),
    ("Lr2", 1.0, |e| Some(&mut e.Lr2)),
];

const FATIGUE: &[Number<Fatigue>] = &[
    ("T_fat_s", 1.0, |f| Some(&mut f.T_fat)),
    ("T_rec_s", 1.0, |f| Some(&mut f.T_rec)),
    ("fit_min", 1.0, |f| Some(&mut f.fit_min)),
    ("beta", 1.0, |f| Some(&mut f.beta)),
];

const FIBER: &[Number<FiberType>] = &[
    ("f05_pps", 1.0, |t| Some(&mut t.f05)),
    ("fmin", 1.0, |t| Some(&mut t.fmin)),
    ("fmax", 1.0, |t| Some(&mut t.fmax)),
    ("omega", 1.0, |t| Some(&mut t.omega)),
    ("beta", 1.0, |t| Some(&mut t.beta)),
    ("rho", 1.0, |t| Some(&mut t.rho)),
    ("Vmax", 1.0, |t| Some(&mut t.Vmax)),
    ("cV0", 1.0, |t| Some(&mut t.cV0)),
    ("cV1", 1.0, |t| Some(&mut t.cV1)),
    ("aV0", 1.0, |t| Some(&mut t.aV0)),
    ("aV1", 1.0, |t| Some(&mut t.aV1)),
    ("aV2", 1.0, |t| Some(&mut t.aV2)),
    ("bV", 1.0, |t| Some(&mut t.bV)),
    ("af", 1.0, |t| Some(&mut t.af)),
    ("nf0", 1.0, |t| Some(&mut t.nf0)),
    ("nf1", 1.0, |t| Some(&mut t.nf1)),
    ("Tf1_ms", 1e3, |t| Some(&mut t.Tf1)),
    ("Tf2_ms", 1e3, |t| Some(&mut t.Tf2)),
    ("Tf3_ms", 1e3, |t| Some(&mut t.Tf3)),
    ("Tf4_ms", 1e3, |t| Some(&mut t.Tf4)),
    ("aS1", 1.0, |t| t.sag.as_mut().map(|s| &mut s.aS1)),
    ("aS2", 1.0, |t| t.sag.as_mut().map(|s| &mut s.aS2)),
    ("TS_ms", 1e3, |t| t.sag.as_mut().map(|s| &mut s.TS)),
    ("cY", 1.0, |t| t.yielding.as_mut().map(|y| &mut y.cY)),
    ("VY", 1.0, |t| t.yielding.as_mut().map(|y| &mut y.VY)),
    ("TY_ms", 1e3, |t| t.yielding.as_mut().map(|y| &mut y.TY)),
];

/// F0 of a muscle, which sets its mass.
pub const FORCE: &str = "max_isometric_force_n";
/// One factor on Tf1 to Tf4 of all types.
pub const EXCITATION: &str = "excitation_time_factor";

/// Time constants of every type that the factor multiplies.
pub const EXCITATION_TIMES: &[&str] = &["Tf1_ms", "Tf2_ms", "Tf3_ms", "Tf4_ms"];

/// Place of a parameter in a muscle.
#[derive(Clone, Debug, PartialEq)]
pub enum Key {
    /// F0, see `FORCE`.
    Force,
    /// The factor `EXCITATION`.
    ExcitationTimes,
    /// Share of the type of this index; the others keep their proportions.
    Fraction(usize),
    /// A number of the muscle.
    Muscle(usize),
    /// `elements.`: a shared coefficient.
    Element(usize),
    /// `fatigue.`: a parameter of fatigue.
    Fatigue(usize),
    /// `fiber[i].`: a coefficient of one type.
    Fiber(usize, usize),
}

fn find<Part>(numbers: &[Number<Part>], name: &str) -> Option<usize> {
    numbers.iter().position(|(key, ..)| *key == name)
}

impl Key {
    /// The key of a name such as `fascicle_length_cm`, `elements.c1` or `fiber[0].f05_pps`.
    pub fn named(name: &str) -> Option<Self> {
        if name == FORCE {
            return Some(Self::Force);
        }
        if name == EXCITATION {
            return Some(Self::ExcitationTimes);
        }
        if let Some(rest) = name.strip_prefix("elements.") {
            return find(ELEMENTS, rest).map(Self::Element);
        }
        if let Some(rest) = name.strip_prefix("fatigue.") {
            return find(FATIGUE, rest).map(Self::Fatigue);
        }
        if let Some(rest) = name.strip_prefix("fiber[") {
            let (index, rest) = rest.split_once("].")?;
            let index = index.parse().ok()?;
            return match rest {
                "fraction" => Some(Self::Fraction(index)),
                _ => find(FIBER, rest).map(|key| Self::Fiber(index, key)),
            };
        }
        find(MUSCLE, name).map(Self::Muscle)
    }

    /// The number in the file's unit; `None` if the muscle has no such part.
    pub fn value(&self, muscle: &Muscle) -> Option<f64> {
        match self {
            Self::Force => Some(muscle.f0()),
            Self::ExcitationTimes => Some(1.0),
            Self::Fraction(index) => muscle.fibers.get(*index).map(|fiber| fiber.fraction),
            _ => {
                let mut muscle = muscle.clone();
                let (number, scale) = self.place(&mut muscle)?;
                Some(*number * scale)
            }
        }
    }

    /// Sets a number given in the file's unit.
    pub fn set(&self, muscle: &mut Muscle, value: f64) {
        match self {
            Self::Force => set_force(muscle, value),
            Self::ExcitationTimes => {
                for fiber in &mut muscle.fibers {
                    let t = &mut fiber.fiber_type;
                    for time in [&mut t.Tf1, &mut t.Tf2, &mut t.Tf3, &mut t.Tf4] {
                        *time *= value;
                    }
                }
            }
            Self::Fraction(index) => {
                let before: f64 = muscle.fibers.iter().map(|fiber| fiber.fraction).sum();
                let old = muscle.fibers.get(*index).map_or(0.0, |fiber| fiber.fraction);
                for (other, fiber) in muscle.fibers.iter_mut().enumerate() {
                    let share = fiber.fraction / (before - old) * (1.0 - value);
                    fiber.fraction = if other == *index { value } else { share };
                }
            }
            _ => {
                if let Some((number, scale)) = self.place(muscle) {
                    *number = value / scale;
                }
            }
        }
    }

    fn place<'a>(&self, muscle: &'a mut Muscle) -> Option<(&'a mut f64, f64)> {
        fn of<'a, Part>(number: &Number<Part>, part: &'a mut Part) -> Option<(&'a mut f64, f64)> {
            (number.2)(part).map(|place| (place, number.1))
        }
        match self {
            Self::Muscle(key) => of(&MUSCLE[*key], muscle),
            Self::Element(key) => of(&ELEMENTS[*key], &mut muscle.elements),
            Self::Fatigue(key) => of(&FATIGUE[*key], muscle.fatigue.as_mut()?),
            Self::Fiber(index, key) => {
                of(&FIBER[*key], &mut muscle.fibers.get_mut(*index)?.fiber_type)
            }
            Self::Force | Self::ExcitationTimes | Self::Fraction(_) => None,
        }
    }
}

/// Sets the mass of a muscle from its F0.
pub fn set_force(muscle: &mut Muscle, force: f64) {
    muscle.mass *= force / muscle.f0();
}

/// All names, for error messages.
pub fn names() -> String {
    let list = |prefix: &str, names: Vec<&str>| {
        names.iter().map(|name| format!("{prefix}{name}")).collect::<Vec<_>>().join(", ")
    };
    let parts = [
        list("", vec![FORCE, EXCITATION]),
        list("", MUSCLE.iter().map(|number| number.0).collect()),
        list("elements.", ELEMENTS.iter().map(|number| number.0).collect()),
        list("fatigue.", FATIGUE.iter().map(|number| number.0).collect()),
        "fiber[0].fraction".to_owned(),
        list("fiber[0].", FIBER.iter().map(|number| number.0).collect()),
    ];
    parts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::paper_muscle;

    #[test]
    fn every_key_reads_back_the_value_it_set() {
        let mut start = paper_muscle();
        start.fatigue = Some(Fatigue { T_fat: 18.0, T_rec: 30.0, fit_min: 0.2, beta: 0.6 });
        let mut seen = 0;
        for name in names().split(", ") {
            let key = Key::named(name).unwrap_or_else(|| panic!("{name}"));
            let mut muscle = start.clone();
            let Some(value) = key.value(&muscle) else { continue };
            key.set(&mut muscle, 1.01 * value + 1e-3);
            assert_ne!(muscle, start, "{name}");
            if key != Key::ExcitationTimes {
                let found = key.value(&muscle).expect("as before");
                assert!(
                    (found - 1.01 * value - 1e-3).abs() < 1e-9 * found.abs(),
                    "{name}: {found}"
                );
            }
            seen += 1;
        }
        // All except the three of sag, which the first type does not have.
        assert_eq!(seen, names().split(", ").count() - 3);
    }

    #[test]
    fn fractions_still_add_to_one() {
        let mut muscle = paper_muscle();
        Key::named("fiber[1].fraction").expect("a key").set(&mut muscle, 0.25);
        assert_eq!(muscle.fibers[1].fraction, 0.25);
        assert_eq!(muscle.fibers[0].fraction, 0.75);
        assert_eq!(Key::named("fiber[2].f05_pps").expect("a key").value(&muscle), None);
        assert_eq!(Key::named("fibre[0].f05_pps"), None);
    }
}

//! A muscle in the paper's symbols and SI units.

use super::fatigue::Fatigue;

/// Coefficients of the elements that all fibre types share (`elements.csv`).
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(non_snake_case)] // the paper's symbols
#[expect(missing_docs, reason = "the names are the paper's symbols, explained in elements.rs")]
pub struct Elements {
    pub cT: f64,
    pub kT: f64,
    pub LrT: f64,
    pub c1: f64,
    pub k1: f64,
    pub Lr1: f64,
    pub eta: f64,
    pub c2: f64,
    pub k2: f64,
    pub Lr2: f64,
    /// N/m².
    pub specific_tension: f64,
    /// kg/m³.
    pub density: f64,
}

/// Sag of a fast type: `dS/dt = (aS - S)/TS`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(non_snake_case)]
#[expect(missing_docs, reason = "the names are the paper's symbols")]
pub struct Sag {
    pub aS1: f64,
    pub aS2: f64,
    /// s.
    pub TS: f64,
}

/// Yield of a slow type: `dY/dt = (1 - cY (1 - exp(-|V|/VY)) - Y)/TY`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(non_snake_case)]
#[expect(missing_docs, reason = "the names are the paper's symbols")]
pub struct Yielding {
    pub cY: f64,
    pub VY: f64,
    /// s.
    pub TY: f64,
}

/// One row of `fibers.csv`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(non_snake_case)]
#[expect(missing_docs, reason = "the names are the paper's symbols, explained in elements.rs")]
pub struct FiberType {
    pub rank: u8,
    /// pps.
    pub f05: f64,
    pub fmin: f64,
    pub fmax: f64,
    pub omega: f64,
    pub beta: f64,
    pub rho: f64,
    pub Vmax: f64,
    pub cV0: f64,
    pub cV1: f64,
    pub aV0: f64,
    pub aV1: f64,
    pub aV2: f64,
    pub bV: f64,
    pub af: f64,
    pub nf0: f64,
    pub nf1: f64,
    /// s.
    pub Tf1: f64,
    /// s.
    pub Tf2: f64,
    /// s.
    pub Tf3: f64,
    /// s.
    pub Tf4: f64,
    /// s; of effective length.
    pub TL: f64,
    pub sag: Option<Sag>,
    pub yielding: Option<Yielding>,
}

/// A fibre type and its share of the muscle's cross section.
#[derive(Clone, Debug, PartialEq)]
pub struct Fiber {
    /// Fractional physiological cross-sectional area, 0..1; the shares of a muscle add to 1.
    pub fraction: f64,
    /// Shares of the type's motor units in its cross section, in order of recruitment; they sum
    /// to 1. Only the discrete modes use them.
    pub units: Vec<f64>,
    /// Coefficients of the type.
    pub fiber_type: FiberType,
}

/// A muscle: morphometry, shared elements and fibre types in order of recruitment.
#[derive(Clone, Debug, PartialEq)]
#[allow(non_snake_case)]
pub struct Muscle {
    /// Mass m, kg.
    pub mass: f64,
    /// Optimal fascicle length L_ce0, m.
    pub L_ce0: f64,
    /// Optimal tendon length L_se0, m.
    pub L_se0: f64,
    /// Longest musculotendon path L_mt_max, m.
    pub L_mt_max: f64,
    /// U_r: the activation at which all units are recruited.
    pub U_r: f64,
    /// Coefficients shared by the fibre types.
    pub elements: Elements,
    /// Fibre types, in order of rank.
    pub fibers: Vec<Fiber>,
    /// Fatigue, if modelled.
    pub fatigue: Option<Fatigue>,
}

impl Muscle {
    /// Maximal isometric force F0 = specific tension × PCSA, PCSA = m/(density L_ce0), in N.
    pub fn f0(&self) -> f64 {
        self.elements.specific_tension * self.mass / (self.elements.density * self.L_ce0)
    }

    /// Maximum fascicle length L_max, in L_ce0: the passive forces of fascicle and tendon
    /// balance there when the path is at its longest.
    pub fn maximum_fascicle_length(&self) -> f64 {
        let e = &self.elements;
        let passive = e.c1 * e.k1 * (((1.0 - e.Lr1) / e.k1).exp() + 1.0).ln();
        let tendon = e.kT * ((passive / (e.cT * e.kT)).exp() - 1.0).ln() + e.LrT;
        (self.L_mt_max - self.L_se0 * tendon) / self.L_ce0
    }

    /// Activation at which each type starts to be recruited in natural continuous recruitment:
    /// 0.001 for the first, U_r times the cross section of all the types before for the others.
    pub fn recruitment_thresholds(&self) -> Vec<f64> {
        let mut before = 0.0;
        self.fibers
            .iter()
            .enumerate()
            .map(|(i, fiber)| {
                let threshold = if i == 0 { 0.001 } else { self.U_r * before };
                before += fiber.fraction;
                threshold
            })
            .collect()
    }
}

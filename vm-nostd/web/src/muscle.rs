//! A muscle of the page, in the units of a muscle file, made into parameters as `vm run` makes
//! them.

use vm_nostd::{
    Class, ElementParams, FiberParams, FiberType, MuscleParams, feline_vm4, human_vm4,
    paper_table_1,
};

/// What defines a muscle of a slow and a fast type.
#[derive(Clone, Copy, Debug)]
pub struct Definition {
    /// Coefficients: 0 `paper-table-1`, 1 `human-vm4`, 2 `feline-vm4`.
    pub set: u32,
    /// 0 economy, 1 standard, 2 fine.
    pub class: u32,
    /// Whether `size` is F0 in N; else it is the mass in g.
    pub size_is_force: bool,
    /// F0 (N) or mass (g).
    pub size: f64,
    /// L_ce0, cm.
    pub fascicle_cm: f64,
    /// L_se0, cm.
    pub tendon_cm: f64,
    /// L_mt_max, cm.
    pub max_path_cm: f64,
    /// U_r.
    pub saturation: f64,
    /// Share of slow fibres in the cross section.
    pub slow_fraction: f64,
    /// Motor units of each type.
    pub units: usize,
}

/// Elements, slow and fast type of a set.
fn coefficients(set: u32) -> (ElementParams, FiberType, FiberType) {
    match set {
        0 => (paper_table_1::ELEMENTS, paper_table_1::SLOW, paper_table_1::FAST),
        1 => (human_vm4::ELEMENTS, human_vm4::SLOW, human_vm4::FAST),
        _ => (feline_vm4::ELEMENTS, feline_vm4::SLOW, feline_vm4::FAST),
    }
}

impl Definition {
    /// The parameters, with the same operations in the same order as `vm run` converts a file.
    pub fn params(&self) -> MuscleParams<2> {
        let (elements, slow, fast) = coefficients(self.set);
        let fascicle_length = self.fascicle_cm * 1e-2;
        let mass = if self.size_is_force {
            self.size * elements.density * fascicle_length / elements.specific_tension
        } else {
            self.size * 1e-3
        };
        let fractions = [(self.slow_fraction, slow), (1.0 - self.slow_fraction, fast)];
        MuscleParams {
            mass,
            fascicle_length,
            tendon_length: self.tendon_cm * 1e-2,
            max_path_length: self.max_path_cm * 1e-2,
            recruitment_saturation: self.saturation,
            class: match self.class {
                0 => Class::Economy,
                1 => Class::Standard,
                _ => Class::Fine,
            },
            elements,
            fibers: fractions.map(|(fraction, fiber_type)| FiberParams { fraction, fiber_type }),
        }
    }

    /// A quantity, see [`quantity`](crate::quantity).
    pub fn quantity(&self, which: u32) -> f64 {
        let params = self.params();
        match which {
            0 => params.mass,
            1 => params.fascicle_length,
            2 => params.tendon_length,
            3 => params.max_path_length,
            4 => params.max_isometric_force(),
            5 => params.path_domain().0,
            6 => params.path_domain().1,
            7 => params.fascicle_domain().0,
            8 => params.fascicle_domain().1,
            9 => {
                let fastest =
                    |fiber: &FiberParams| fiber.fiber_type.force_velocity.maximum_velocity;
                params.fibers.iter().map(fastest).fold(0.0, f64::min)
            }
            _ => f64::NAN,
        }
    }
}

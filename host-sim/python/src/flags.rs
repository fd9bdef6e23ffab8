//! Names and bits of all flags, with which `vm_nostd/_results.py` is compared.

use pyo3::prelude::*;
use std::collections::BTreeMap;
use vm_nostd::bitflags::Flags;
use vm_nostd::control::{ControlStatus, JointStatus, ProsthesisStatus};
use vm_nostd::{PulseStatus, Status};

fn named<F: Flags<Bits: Into<u32>>>() -> Vec<(&'static str, u32)> {
    F::FLAGS.iter().map(|flag| (flag.name(), flag.value().bits().into())).collect()
}

/// Name and bit of every flag, by the class of flags.
#[pyfunction]
pub fn flags() -> BTreeMap<&'static str, Vec<(&'static str, u32)>> {
    BTreeMap::from([
        ("Status", named::<Status>()),
        ("PulseStatus", named::<PulseStatus>()),
        ("JointStatus", named::<JointStatus>()),
        ("ControlStatus", named::<ControlStatus>()),
        ("ProsthesisStatus", named::<ProsthesisStatus>()),
    ])
}

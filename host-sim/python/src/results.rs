//! Named tuples of the Python side, `vm_nostd/_results.py`.

use pyo3::call::PyCallArgs;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

/// A class of `vm_nostd._results`.
pub struct Named {
    name: &'static str,
    class: PyOnceLock<Py<PyType>>,
}

impl Named {
    const fn new(name: &'static str) -> Self {
        Self { name, class: PyOnceLock::new() }
    }

    /// An instance.
    pub fn of<'py>(
        &self,
        py: Python<'py>,
        fields: impl PyCallArgs<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.class.import(py, "vm_nostd._results", self.name)?.call1(fields)
    }
}

/// One tick of a muscle.
pub static OUTPUT: Named = Named::new("Output");
/// A run of a muscle.
pub static TRACE: Named = Named::new("Trace");
/// Flags of a muscle.
pub static STATUS: Named = Named::new("Status");
/// A parameter of a fit.
pub static ESTIMATE: Named = Named::new("Estimate");
/// A trial of a fit.
pub static TRIAL: Named = Named::new("TrialFit");
/// Muscles of a joint at its angles.
pub static POSTURE: Named = Named::new("Posture");
/// Flags of a joint.
pub static JOINT_STATUS: Named = Named::new("JointStatus");
/// Command of the FES controller.
pub static COMMAND: Named = Named::new("FesCommand");
/// Flags of the FES controller.
pub static CONTROL_STATUS: Named = Named::new("ControlStatus");
/// Command of a prosthesis.
pub static PROSTHESIS_COMMAND: Named = Named::new("ProsthesisCommand");
/// Flags of a prosthesis.
pub static PROSTHESIS_STATUS: Named = Named::new("ProsthesisStatus");

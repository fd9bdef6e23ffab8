//! Muscles about one or two joints: angles to path lengths, forces to torques.

use crate::arrays::number;
use crate::choices::{self, with_count, with_scalar};
use crate::errors::{self, refused};
use crate::muscle::Muscle;
use crate::results::{JOINT_STATUS, POSTURE};
use host_sim::model_muscle;
use host_sim::reference::Muscle as Parameters;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyType;
use vm_nostd::Scalar;
use vm_nostd::control::{
    ANKLE, Action, AngleRange, ELBOW, Joint as Coefficients, JointMuscle, JointPreset, KNEE, ORDER,
    PathParams,
};

/// Path of a muscle as a polynomial of the angles of one or two joints (rad), about reference
/// angles: length (m), of each joint the coefficients of the 1st to the 6th power (m/rad^k), with
/// two joints that of their product (m/rad²), and what the muscle does about each joint: "flexes",
/// "extends", "none" or "either".
#[pyclass(module = "vm_nostd", frozen)]
#[derive(Clone)]
pub struct JointPath {
    length: f64,
    reference: Vec<f64>,
    terms: Vec<[f64; ORDER]>,
    product: f64,
    action: Vec<Action>,
}

impl JointPath {
    /// The path about `J` joints; refused if it is one about another number of joints.
    pub fn about<const J: usize>(&self) -> PyResult<PathParams<J>> {
        let of = |field: &str, count: usize| {
            refused(field, &format!("{count} joints"), &format!("must be {J}, as angle_ranges_rad"))
        };
        let reference = self.reference.as_slice();
        let terms = self.terms.as_slice();
        let action = self.action.as_slice();
        Ok(PathParams {
            length: self.length,
            reference: reference.try_into().map_err(|_| of("reference_rad", reference.len()))?,
            terms: terms.try_into().map_err(|_| of("terms_m_per_rad", terms.len()))?,
            product: self.product,
            action: action.try_into().map_err(|_| of("action", action.len()))?,
        })
    }
}

const ACTIONS: [(&str, Action); 4] = [
    ("flexes", Action::Flexes),
    ("extends", Action::Extends),
    ("none", Action::None),
    ("either", Action::Either),
];

#[pymethods]
impl JointPath {
    #[new]
    #[pyo3(signature = (length_m, reference_rad, terms_m_per_rad, action, product_m_per_rad2=0.0))]
    fn new(
        length_m: f64,
        reference_rad: Vec<f64>,
        terms_m_per_rad: Vec<Vec<f64>>,
        action: Vec<String>,
        product_m_per_rad2: f64,
    ) -> PyResult<Self> {
        let terms = terms_m_per_rad.into_iter().map(|given| {
            let count = given.len();
            if count > ORDER {
                let limit = format!("must be at most {ORDER}");
                return Err(refused("terms_m_per_rad", &format!("{count} terms"), &limit));
            }
            Ok(std::array::from_fn(|power| given.get(power).copied().unwrap_or(0.0)))
        });
        let action = action.iter().map(|name| {
            let found = ACTIONS.iter().find(|(known, _)| known == name);
            found
                .map(|(_, action)| *action)
                .ok_or_else(|| refused("action", name, "must be flexes, extends, none or either"))
        });
        Ok(Self {
            length: length_m,
            reference: reference_rad,
            terms: terms.collect::<PyResult<_>>()?,
            product: product_m_per_rad2,
            action: action.collect::<PyResult<_>>()?,
        })
    }
}

/// A built joint, whatever its arithmetic and its numbers of joints and muscles.
trait Built: Send + Sync {
    /// Paths (m), moment arms (m/rad, joint by joint for each muscle), flags.
    fn posture(&self, angles: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>, u8);
    /// Torques (N m) of forces (F0).
    fn torques(&self, angles: &[f64], forces: &[f64]) -> Vec<f64>;
    /// Stiffnesses (N m/rad) of forces (F0) and muscles' stiffnesses (F0/L_ce0).
    fn stiffnesses(&self, angles: &[f64], forces: &[f64], stiffnesses: &[f64]) -> Vec<f64>;
}

impl<S: Scalar, const J: usize, const M: usize> Built for Coefficients<S, J, M> {
    fn posture(&self, angles: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>, u8) {
        let posture = Self::posture(self, std::array::from_fn(|j| S::from_f64(angles[j])));
        let paths = posture.muscles.iter().map(|muscle| S::path_metres(muscle.path_length));
        let arms = posture.muscles.iter().map(|muscle| muscle.moment_arms.map(S::to_f64).to_vec());
        (paths.collect(), arms.collect(), posture.status.bits())
    }

    fn torques(&self, angles: &[f64], forces: &[f64]) -> Vec<f64> {
        let posture = Self::posture(self, std::array::from_fn(|j| S::from_f64(angles[j])));
        let forces = std::array::from_fn(|m| S::from_f64(forces[m]));
        Self::torques(self, &posture, &forces).map(S::quantity_value).to_vec()
    }

    fn stiffnesses(&self, angles: &[f64], forces: &[f64], stiffnesses: &[f64]) -> Vec<f64> {
        let posture = Self::posture(self, std::array::from_fn(|j| S::from_f64(angles[j])));
        let forces = std::array::from_fn(|m| S::from_f64(forces[m]));
        let stiffnesses = std::array::from_fn(|m| S::from_f64(stiffnesses[m]));
        let of_joints = Self::stiffnesses(self, &posture, &forces, &stiffnesses);
        of_joints.map(S::quantity_value).to_vec()
    }
}

/// One to six muscles about one or two joints. angle_ranges_rad: least and greatest angle (rad) of
/// each joint; greater angles are flexion. paths: of each muscle. arithmetic: "f32", "fixed" or
/// "f64".
#[pyclass(module = "vm_nostd", frozen)]
pub struct Joint {
    built: Box<dyn Built>,
    /// Range of each joint, rad.
    pub ranges: Vec<AngleRange>,
    /// Muscles.
    pub muscles: Vec<Py<Muscle>>,
    /// Their paths.
    pub paths: Vec<JointPath>,
}

/// A muscle as a joint takes it.
fn on_joint<const J: usize>(muscle: &Muscle, path: &JointPath) -> PyResult<JointMuscle<J>> {
    let parameters = muscle.parameters();
    Ok(JointMuscle {
        path: path.about()?,
        path_domain: model_muscle::path_domain(parameters),
        max_isometric_force: parameters.f0(),
        fascicle_length: parameters.L_ce0,
    })
}

impl Joint {
    fn build(
        ranges: Vec<AngleRange>,
        muscles: Vec<Py<Muscle>>,
        paths: Vec<JointPath>,
        arithmetic: &str,
    ) -> PyResult<Self> {
        let count = muscles.len();
        if paths.len() != count {
            let limit = format!("must be {count}, as muscles are");
            return Err(refused("paths", &format!("{} paths", paths.len()), &limit));
        }
        let built = with_scalar!(choices::arithmetic(arithmetic)?, S => with_count!(
            "angle_ranges_rad", ranges.len(), [1 2], J => with_count!(
                "muscles", count, [1 2 3 4 5 6], M => {
                    let pairs = muscles.iter().zip(&paths);
                    let placed: Vec<JointMuscle<J>> = pairs
                        .map(|(muscle, path)| on_joint(muscle.get(), path))
                        .collect::<PyResult<_>>()?;
                    let built = Coefficients::<S, J, M>::build(
                        &std::array::from_fn(|j| ranges[j]),
                        &std::array::from_fn(|m| placed[m]),
                    );
                    Ok(Box::new(built.map_err(errors::joint)?) as Box<dyn Built>)
                }
            )
        ))?;
        Ok(Self { built, ranges, muscles, paths })
    }

    /// Numbers of the muscles over what each is relative to.
    fn relative(
        &self,
        field: &str,
        given: &[f64],
        whole: impl Fn(&Parameters) -> f64,
    ) -> PyResult<Vec<f64>> {
        if given.len() != self.muscles.len() {
            let limit = format!("must be {}, one for each muscle", self.muscles.len());
            return Err(refused(field, &format!("{} numbers", given.len()), &limit));
        }
        let muscles = given.iter().zip(&self.muscles);
        muscles
            .map(|(&given, muscle)| Ok(number(field, given)? / whole(muscle.get().parameters())))
            .collect()
    }

    fn angles(&self, given: &[f64]) -> PyResult<()> {
        let joints = self.ranges.len();
        if given.len() != joints {
            let limit = format!("must be {joints}, one for each joint");
            return Err(refused("angles_rad", &format!("{} angles", given.len()), &limit));
        }
        given.iter().try_for_each(|&angle| number("angles_rad", angle).map(|_| ()))
    }
}

/// A preset's muscles as files, and their paths.
fn preset(name: &str) -> PyResult<&'static JointPreset> {
    let found = [&ANKLE, &KNEE, &ELBOW].into_iter().find(|preset| preset.name == name);
    found.ok_or_else(|| refused("name", name, "must be ankle, knee or elbow"))
}

#[pymethods]
impl Joint {
    #[new]
    #[pyo3(signature = (angle_ranges_rad, muscles, paths, *, arithmetic="f32"))]
    fn new(
        angle_ranges_rad: Vec<(f64, f64)>,
        muscles: Vec<Py<Muscle>>,
        paths: Vec<Py<JointPath>>,
        arithmetic: &str,
    ) -> PyResult<Self> {
        let range = |(least, most)| AngleRange { least, most };
        let ranges = angle_ranges_rad.into_iter().map(range).collect();
        let paths = paths.iter().map(|path| path.get().clone()).collect();
        Self::build(ranges, muscles, paths, arithmetic)
    }

    /// "ankle", "knee" or "elbow": a flexor and an extensor with published moment arms.
    #[classmethod]
    #[pyo3(signature = (name, *, mode="fes", arithmetic="f32"))]
    fn named(
        _: &Bound<'_, PyType>,
        py: Python<'_>,
        name: &str,
        mode: &str,
        arithmetic: &str,
    ) -> PyResult<Self> {
        let preset = preset(name)?;
        let (mut muscles, mut paths) = (Vec::new(), Vec::new());
        for muscle in &preset.muscles {
            let params = muscle.params();
            let text = format!(
                "name = {:?}\nmax_isometric_force_n = {}\nfascicle_length_cm = {}\n\
                 tendon_length_cm = {}\nmax_path_length_cm = {}\nrecruitment_saturation = {}\n\
                 coefficients = \"human-vm4\"\n[[fiber]]\npreset = \"human-vm4/slow\"\n\
                 fraction = {}\n[[fiber]]\npreset = \"human-vm4/fast\"\nfraction = {}\n",
                muscle.name,
                muscle.max_isometric_force,
                params.fascicle_length * 1e2,
                params.tendon_length * 1e2,
                params.max_path_length * 1e2,
                params.recruitment_saturation,
                params.fibers[0].fraction,
                params.fibers[1].fraction,
            );
            muscles.push(Py::new(py, Muscle::of_text(&text, mode, arithmetic)?)?);
            let PathParams { length, reference, terms, product, action } = muscle.path();
            paths.push(JointPath {
                length,
                reference: reference.to_vec(),
                terms: terms.to_vec(),
                product,
                action: action.to_vec(),
            });
        }
        Self::build(vec![preset.range], muscles, paths, arithmetic)
    }

    /// The muscles.
    #[getter]
    fn muscles(&self, py: Python<'_>) -> Vec<Py<Muscle>> {
        self.muscles.iter().map(|muscle| muscle.clone_ref(py)).collect()
    }

    /// Least and greatest angle of each joint, rad.
    #[getter]
    fn angle_ranges_rad(&self) -> Vec<(f64, f64)> {
        self.ranges.iter().map(|range| (range.least, range.most)).collect()
    }

    /// Path (m) of each muscle, and its moment arms (m, a row per muscle and a column per joint),
    /// positive where it flexes, at the joints' angles (rad).
    fn posture<'py>(&self, py: Python<'py>, angles_rad: Vec<f64>) -> PyResult<Bound<'py, PyAny>> {
        self.angles(&angles_rad)?;
        let (paths, arms, status) = self.built.posture(&angles_rad);
        let status = JOINT_STATUS.of(py, (status,))?;
        let arms = PyArray2::from_vec2(py, &arms)?;
        POSTURE.of(py, (PyArray1::from_vec(py, paths), arms, status))
    }

    /// Torque about each joint (N m, flexion is positive) of the muscles' tendon forces (N) at the
    /// joints' angles (rad).
    fn torques_nm<'py>(
        &self,
        py: Python<'py>,
        angles_rad: Vec<f64>,
        forces_n: Vec<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.angles(&angles_rad)?;
        let forces = self.relative("forces_n", &forces_n, Parameters::f0)?;
        Ok(PyArray1::from_vec(py, self.built.torques(&angles_rad, &forces)))
    }

    /// Static stiffness about each joint (N m/rad): the torque that comes back by angle, from the
    /// muscles' tendon forces (N) and stiffnesses (N/m, `State.stiffness_n_per_m`) at the joints'
    /// angles (rad). Negative where the posture is unstable.
    fn stiffnesses_nm_per_rad<'py>(
        &self,
        py: Python<'py>,
        angles_rad: Vec<f64>,
        forces_n: Vec<f64>,
        stiffnesses_n_per_m: Vec<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.angles(&angles_rad)?;
        let forces = self.relative("forces_n", &forces_n, Parameters::f0)?;
        let per_length = |muscle: &Parameters| muscle.f0() / muscle.L_ce0;
        let slopes = self.relative("stiffnesses_n_per_m", &stiffnesses_n_per_m, per_length)?;
        Ok(PyArray1::from_vec(py, self.built.stiffnesses(&angles_rad, &forces, &slopes)))
    }
}

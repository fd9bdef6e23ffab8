//! Joints and the controllers of joints.

pub mod controller;
pub mod fes;
pub mod fes_params;
pub mod joint;
pub mod joint_params;
pub mod presets;
pub mod prosthesis;
pub mod prosthesis_params;

/// Muscles of a prosthesis or controller: flexor and extensor.
pub const VM_ANTAGONISTS: usize = 2;

/// What a prosthesis or controller says of itself.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmControlInfo {
    /// Number of fibre types of each muscle.
    pub fiber_count: u32,
    /// Words of a saved state.
    pub state_words: u32,
}

//! Inputs and outputs of a tick in floating point: a template for `float` and `double`.

macro_rules! floating {
    ($S:ident) => {
        // <functions>
        /// Inputs of a tick.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct VmInputA {
            /// Activation U, or strength of the stimulus (FES); 0..1.
            pub activation: $S,
            /// Path length at the tick's end, m.
            pub path_length_m: $S,
            /// Stimulation frequency, pps; 0..500 (FES only).
            pub stimulation_frequency_pps: $S,
        }

        /// Outputs of a tick.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct VmOutputA {
            /// Tendon force, N; never negative.
            pub force_n: $S,
            /// Fascicle length, L_ce0.
            pub fascicle_length: $S,
            /// Fascicle velocity, L_ce0/s, positive when lengthening.
            pub fascicle_velocity: $S,
            /// Tendon force relative to F0.
            pub relative_force: $S,
            /// VM_STATUS_ flags; 0 if nothing was clipped or limited.
            pub status: u16,
        }
        // </functions>

        impl InputOf<$S> for VmInputA {
            fn input(self) -> Input<$S> {
                Input {
                    activation: self.activation,
                    path_length: self.path_length_m,
                    stimulation_frequency: self.stimulation_frequency_pps,
                }
            }
        }

        impl OutputOf<$S> for VmOutputA {
            fn of(output: Output<$S>) -> Self {
                Self {
                    force_n: output.force,
                    fascicle_length: output.fascicle_length,
                    fascicle_velocity: output.fascicle_velocity,
                    relative_force: output.relative_force,
                    status: output.status.bits(),
                }
            }
        }

        impl VmOutputA {
            /// Leaves the force of a fitness, as the model does.
            fn tire(&mut self, fitness: $S) {
                self.force_n = model::Scalar::of_share(fitness, self.force_n);
                self.relative_force *= fitness;
            }
        }
    };
}
pub(crate) use floating;

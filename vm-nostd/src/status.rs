//! Flags of a tick.

bitflags::bitflags! {
    /// Flags of what a tick clipped or limited; empty if inputs and state were in their validity
    /// ranges.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct Status: u16 {
        /// Activation was outside 0..1 and was clipped.
        const ACTIVATION_CLIPPED = 1 << 0;
        /// Activation was not a number (taken as 0) or infinite (clipped).
        const ACTIVATION_NOT_FINITE = 1 << 1;
        /// Stimulation frequency was outside 0..500 pps and was clipped.
        const FREQUENCY_CLIPPED = 1 << 2;
        /// Stimulation frequency was not a number (taken as 0) or infinite (clipped).
        const FREQUENCY_NOT_FINITE = 1 << 3;
        /// Path length was outside the muscle's range and was clipped: shorter than the path with a
        /// slack tendon and the fascicles at FV's pole, longer than the path on which n_f is
        /// defined at some activation, or not representable. The rules are in
        /// [`MuscleParams::path_domain`](crate::MuscleParams::path_domain).
        const PATH_LENGTH_CLIPPED = 1 << 4;
        /// Path length was not a number (the previous one was kept) or infinite (clipped).
        const PATH_LENGTH_NOT_FINITE = 1 << 5;
        /// The fascicles left the validity range of lengths or shortened faster than V_max of a
        /// type: force-length, force-velocity or activation-frequency relation were evaluated at
        /// the limit of their range.
        const FASCICLE_OUTSIDE_DOMAIN = 1 << 6;
        /// Fascicle length was limited to the state range.
        const FASCICLE_LENGTH_LIMITED = 1 << 7;
        /// Fascicle velocity was limited to the state range, 60 L_ce0/s.
        const FASCICLE_VELOCITY_LIMITED = 1 << 8;
        /// The net force at the predicted velocity of a substep exceeded half of F0, as after a
        /// jump of the path: force is less accurate.
        const MECHANICS_UNSETTLED = 1 << 9;
        /// The tendon's extension exceeds the range of the arithmetic: its force saturated. Only in
        /// fixed point, and only above ten times F0.
        const TENDON_FORCE_LIMITED = 1 << 10;
        /// No activation gives the requested steady force: the result is the nearest. Never set by
        /// a tick.
        const FORCE_UNREACHABLE = 1 << 11;
    }
}

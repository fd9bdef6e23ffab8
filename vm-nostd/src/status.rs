//! What a tick had to saturate.

bitflags::bitflags! {
    /// What a tick had to saturate; empty when inputs and state were inside the domain.
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
        /// Path length was outside the muscle's range and was clipped: shorter than a slack tendon
        /// with the fascicles at FV's pole, or longer than any activation could hold with n_f still
        /// defined, or beyond what the arithmetic holds.
        /// [`MuscleParams::path_domain`](crate::MuscleParams::path_domain) has the rules.
        const PATH_LENGTH_CLIPPED = 1 << 4;
        /// Path length was not a number (the one before was kept) or infinite (clipped).
        const PATH_LENGTH_NOT_FINITE = 1 << 5;
        /// The fascicles left the range of lengths, or shortened faster than V_max of a type, so
        /// that force-length, force-velocity or activation-frequency relation do not hold; they
        /// were taken at the edge of their range.
        const FASCICLE_OUTSIDE_DOMAIN = 1 << 6;
        /// The fascicles were stopped at the least or greatest length the state can have.
        const FASCICLE_LENGTH_LIMITED = 1 << 7;
        /// The fascicles were held at the greatest speed the state can have, 60 L_ce0/s.
        const FASCICLE_VELOCITY_LIMITED = 1 << 8;
        /// The forces on the fascicles were out of balance by more than half of F0 at the velocity
        /// foreseen for a substep, as when a path jumps: force is less accurate.
        const MECHANICS_UNSETTLED = 1 << 9;
        /// The tendon is extended by more than the arithmetic can tell: its force was taken at
        /// the most that it can. Only in fixed point, and at no less than ten times F0.
        const TENDON_FORCE_LIMITED = 1 << 10;
        /// No activation holds the force that was asked for: the answer is the nearest. Never set
        /// by a tick.
        const FORCE_UNREACHABLE = 1 << 11;
    }
}

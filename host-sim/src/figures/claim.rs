//! A claim of the paper.

use serde::Serialize;

/// A claim of the paper's section 3.
#[derive(Clone, Debug, Serialize)]
pub struct Claim {
    /// Figure of the claim.
    pub figure: &'static str,
    /// The claim.
    pub claim: &'static str,
    /// The claimed number.
    pub claimed: &'static str,
    /// Limit of the number; ours if the paper gives none.
    pub limit: String,
    /// Measured number.
    pub measured: String,
    /// Whether it is within the limit.
    pub agrees: bool,
    /// Reason if it is not.
    pub why: &'static str,
}

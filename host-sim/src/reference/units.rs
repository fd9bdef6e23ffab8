//! Division of a fibre type's cross section among its motor units.

/// A rule for the sizes of the units, in order of recruitment.
#[derive(Clone, Debug, PartialEq)]
pub enum UnitSizes {
    /// The authors' default: the j-th unit in proportion to rank + j.
    Default,
    /// All equal.
    Equal,
    /// Each larger than the one before by this fraction.
    Geometric(f64),
    /// Given relative sizes.
    Listed(Vec<f64>),
}

impl UnitSizes {
    /// Shares of `count` units in the cross section of a type; they add to 1.
    pub fn shares(&self, rank: u8, count: usize) -> Vec<f64> {
        let relative: Vec<f64> = match self {
            Self::Default => (1..=count).map(|j| f64::from(rank) + j as f64).collect(),
            Self::Equal => vec![1.0; count],
            Self::Geometric(growth) => (0..count).map(|j| (1.0 + growth).powi(j as i32)).collect(),
            Self::Listed(sizes) => sizes.clone(),
        };
        let sum: f64 = relative.iter().sum();
        relative.iter().map(|size| size / sum).collect()
    }
}

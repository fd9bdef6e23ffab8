//! What a sweep says of an arithmetic: the share of cases beyond the error that its class allows.

use super::{MEASURED, Sweep};
use crate::engine::{Arithmetic, Class};
use crate::ledger::Ledger;

/// What an accuracy class promises of the unflagged cases of a random sweep over the default
/// ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Promise {
    /// Error that few cases exceed, % of F0.
    pub common_pct_f0: f64,
    /// Largest share of cases beyond it, %.
    pub beyond_pct: f64,
    /// Largest error, % of F0.
    pub worst_pct_f0: f64,
}

impl Promise {
    /// Least number of random cases per mode of which a share can be promised: with fewer, one case
    /// is too large a share.
    pub const LEAST_CASES: usize = 1000;

    /// The promise of a class.
    pub fn of(class: Class) -> Self {
        let (common_pct_f0, beyond_pct, worst_pct_f0) = match class {
            Class::Economy => (0.5, 5.0, 6.0),
            Class::Standard => (0.1, 3.0, 1.5),
            Class::Fine => (0.1, 0.3, 0.4),
        };
        Self { common_pct_f0, beyond_pct, worst_pct_f0 }
    }
}

/// The errors of an arithmetic in all cases of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Arithmetic.
    pub arithmetic: Arithmetic,
    /// Cases that it ran.
    pub cases: usize,
    /// Of these, cases with a flag, %.
    pub flagged_pct: f64,
    /// Of the cases without a flag, those beyond [`Promise::common_pct_f0`], %.
    pub beyond_pct: f64,
    /// Largest error without a flag, % of F0; NaN if any is.
    pub worst_pct_f0: f64,
}

impl Summary {
    /// Whether a promise is kept. Not a number keeps none.
    pub fn keeps(&self, promise: Promise) -> bool {
        self.beyond_pct <= promise.beyond_pct && self.worst_pct_f0 <= promise.worst_pct_f0
    }
}

impl Sweep {
    /// The summary of each arithmetic.
    pub fn summaries(&self, ledger: &Ledger) -> Vec<Summary> {
        let common = Promise::of(self.class).common_pct_f0;
        let arithmetics = self.arithmetics.iter().enumerate();
        arithmetics
            .map(|(index, &arithmetic)| {
                let at = Self::first_measured() + index * MEASURED.len();
                let measured = ledger.rows().filter_map(|(_, row)| {
                    let status = row.get(at + MEASURED.len() - 1)?;
                    Some((row.get(at)?.parse().ok()?, status == "ok"))
                });
                summary(arithmetic, common, measured)
            })
            .collect()
    }
}

/// Summarises errors (% of F0) and whether each case is without a flag.
fn summary(
    arithmetic: Arithmetic,
    common_pct_f0: f64,
    measured: impl Iterator<Item = (f64, bool)>,
) -> Summary {
    let (mut cases, mut unflagged, mut within, mut worst) = (0, 0, 0, 0.0_f64);
    for (error, is_unflagged) in measured {
        cases += 1;
        if is_unflagged {
            unflagged += 1;
            within += usize::from(error <= common_pct_f0);
            worst = if error.is_nan() || worst.is_nan() { f64::NAN } else { worst.max(error) };
        }
    }
    let share = |part: usize, of: usize| 100.0 * part as f64 / of.max(1) as f64;
    Summary {
        arithmetic,
        cases,
        flagged_pct: share(cases - unflagged, cases),
        beyond_pct: share(unflagged - within, unflagged),
        worst_pct_f0: worst,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(measured: &[(f64, bool)]) -> Summary {
        summary(Arithmetic::F32, 0.1, measured.iter().copied())
    }

    #[test]
    fn shares_are_of_the_cases_without_a_flag() {
        let found = of(&[(0.05, true), (0.1, true), (0.2, true), (9.0, false), (0.3, true)]);
        assert_eq!((found.cases, found.flagged_pct), (5, 20.0));
        assert_eq!((found.beyond_pct, found.worst_pct_f0), (50.0, 0.3));
    }

    #[test]
    fn a_promise_is_broken_by_number_or_by_size_or_by_what_is_no_number() {
        let promise = Promise { common_pct_f0: 0.1, beyond_pct: 50.0, worst_pct_f0: 0.2 };
        assert!(of(&[(0.05, true), (0.2, true), (7.0, false)]).keeps(promise));
        assert!(!of(&[(0.05, true), (0.21, true)]).keeps(promise));
        assert!(!of(&[(0.05, true), (0.2, true), (0.11, true)]).keeps(promise));
        assert!(!of(&[(0.05, true), (f64::NAN, true), (0.05, true)]).keeps(promise));
        assert!(of(&[]).keeps(promise));
    }
}

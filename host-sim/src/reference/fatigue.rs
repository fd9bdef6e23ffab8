//! Fatigue and recovery as a factor on force (Riener, Quintern & Schmidt, J. Biomech. 29 (1996)
//! 1157-1167): d fit/dt = (fit_min - fit) a λ/T_fat + (1 - fit)(1 - a λ)/T_rec, λ = 1 - β + β
//! (f/100 pps)².

/// Coefficients of fatigue, by the paper's symbols.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(non_snake_case)]
#[expect(missing_docs, reason = "the names are the paper's symbols")]
pub struct Fatigue {
    /// s.
    pub T_fat: f64,
    /// s.
    pub T_rec: f64,
    pub fit_min: f64,
    pub beta: f64,
}

impl Fatigue {
    /// fit after `time` (s) at a constant activation and frequency (pps): the equation is linear in
    /// fit.
    pub(super) fn fitness(&self, start: f64, time: f64, a: f64, f: f64) -> f64 {
        let lambda = 1.0 - self.beta + self.beta * (f.clamp(0.0, 100.0) / 100.0).powi(2);
        let tiring = a.clamp(0.0, 1.0) * lambda / self.T_fat;
        let recovering = (1.0 - a.clamp(0.0, 1.0) * lambda) / self.T_rec;
        let rate = tiring + recovering;
        let end = (self.fit_min * tiring + recovering) / rate;
        end + (start - end) * (-rate * time).exp()
    }
}

//! The probabilities with which the lobes are sampled.

/// The probability of sampling each lobe; they sum to 1.
#[derive(Clone, Copy, Debug)]
pub struct LobeProbabilities {
    pub coat: f64,
    pub gloss: f64,
    pub glass: f64,
    /// Diffuse reflection, sheen and multiple scattering on the outgoing side.
    pub spread: f64,
    /// Diffuse transmission.
    pub through: f64,
    /// Multiple scattering on glass.
    pub returned: f64,
}

/// The lobe that a direction is sampled from.
pub enum Lobe {
    Coat,
    Gloss,
    Glass,
    Spread,
    Through,
    Returned,
}

impl LobeProbabilities {
    /// Scaled to sum to 1; if all are 0, the spread lobe gets all.
    pub fn normalized(self) -> Self {
        let all = [self.coat, self.gloss, self.glass, self.spread, self.through, self.returned];
        let all = all.map(|probability| probability.max(0.0));
        let sum: f64 = all.iter().sum();
        let [coat, gloss, glass, spread, through, returned] =
            if sum > 0.0 { all.map(|probability| probability / sum) } else { [0.0, 0.0, 0.0, 1.0, 0.0, 0.0] };
        Self { coat, gloss, glass, spread, through, returned }
    }

    /// The probabilities of all lobes but the spread one, scaled to sum to 1; `None` where there are no others.
    pub fn without_spread(self) -> Option<Self> {
        let others = Self { spread: 0.0, ..self }.normalized();
        (others.spread == 0.0).then_some(others)
    }

    /// The lobe that a uniform number selects, and the number rescaled within that lobe's share.
    pub fn select(&self, u: f64) -> Option<(Lobe, f64)> {
        let mut rest = u;
        let all = [
            (Lobe::Coat, self.coat),
            (Lobe::Gloss, self.gloss),
            (Lobe::Glass, self.glass),
            (Lobe::Spread, self.spread),
            (Lobe::Through, self.through),
            (Lobe::Returned, self.returned),
        ];
        let mut last = None;
        for (lobe, probability) in all.into_iter().filter(|(_, probability)| *probability > 0.0) {
            if rest < probability {
                return Some((lobe, rest / probability));
            }
            rest -= probability;
            // Rounding may leave a little beyond the last.
            last = Some((lobe, 1.0 - f64::EPSILON));
        }
        last
    }
}

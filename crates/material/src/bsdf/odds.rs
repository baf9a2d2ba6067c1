//! How often a direction is drawn from which lobe.

/// The lobes that directions are drawn from, and how often.
#[derive(Clone, Copy, Debug)]
pub struct LobeProbabilities {
    pub coat: f64,
    pub gloss: f64,
    pub glass: f64,
    /// Diffuse, sheen and what comes of multiple scattering, on this side.
    pub spread: f64,
    /// Diffuse, on the other.
    pub through: f64,
    /// What comes of multiple scattering on glass.
    pub returned: f64,
}

/// Which lobe a direction is drawn from.
pub enum Lobe {
    Coat,
    Gloss,
    Glass,
    Spread,
    Through,
    Returned,
}

impl LobeProbabilities {
    /// In proportion, summing to 1; nothing at all is spread.
    pub fn normalized(self) -> Self {
        let all = [self.coat, self.gloss, self.glass, self.spread, self.through, self.returned];
        let all = all.map(|probability| probability.max(0.0));
        let sum: f64 = all.iter().sum();
        let [coat, gloss, glass, spread, through, returned] =
            if sum > 0.0 { all.map(|probability| probability / sum) } else { [0.0, 0.0, 0.0, 1.0, 0.0, 0.0] };
        Self { coat, gloss, glass, spread, through, returned }
    }

    /// Of all lobes but those that are spread; none where there are no others.
    pub fn without_spread(self) -> Option<Self> {
        let others = Self { spread: 0.0, ..self }.normalized();
        (others.spread == 0.0).then_some(others)
    }

    /// The lobe that a uniform number falls to, and where in its share.
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

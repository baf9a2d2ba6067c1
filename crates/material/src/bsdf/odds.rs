//! How often a direction is drawn from which lobe.

/// The lobes that directions are drawn from, and how often.
#[derive(Clone, Copy, Debug)]
pub struct Odds {
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
pub enum Choice {
    Coat,
    Gloss,
    Glass,
    Spread,
    Through,
    Returned,
}

impl Odds {
    /// In proportion, summing to 1; nothing at all is spread.
    pub fn shared(self) -> Self {
        let all = [self.coat, self.gloss, self.glass, self.spread, self.through, self.returned];
        let all = all.map(|odds| odds.max(0.0));
        let sum: f64 = all.iter().sum();
        let [coat, gloss, glass, spread, through, returned] =
            if sum > 0.0 { all.map(|odds| odds / sum) } else { [0.0, 0.0, 0.0, 1.0, 0.0, 0.0] };
        Self { coat, gloss, glass, spread, through, returned }
    }

    /// Of all lobes but those that are spread; none where there are no others.
    pub fn without_spread(self) -> Option<Self> {
        let others = Self { spread: 0.0, ..self }.shared();
        (others.spread == 0.0).then_some(others)
    }

    /// The lobe that a uniform number falls to, and where in its share.
    pub fn choose(&self, u: f64) -> Option<(Choice, f64)> {
        let mut rest = u;
        let all = [
            (Choice::Coat, self.coat),
            (Choice::Gloss, self.gloss),
            (Choice::Glass, self.glass),
            (Choice::Spread, self.spread),
            (Choice::Through, self.through),
            (Choice::Returned, self.returned),
        ];
        let mut last = None;
        for (choice, odds) in all.into_iter().filter(|(_, odds)| *odds > 0.0) {
            if rest < odds {
                return Some((choice, rest / odds));
            }
            rest -= odds;
            // Rounding may leave a little beyond the last.
            last = Some((choice, 1.0 - f64::EPSILON));
        }
        last
    }
}

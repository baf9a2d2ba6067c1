//! A curve through colours: points at equal distances along it, linear between them.

/// Points of a curve.
const POINTS: usize = 64;

/// The curve.
#[derive(Clone, Debug)]
pub struct Palette {
    points: Vec<[f32; 3]>,
}

/// The nearest place of the curve to a colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The place along the curve, in [0, 1].
    pub place: f32,
    /// The distance of the colour from there.
    pub distance: f32,
}

impl Palette {
    /// The curve that passes through these colours in order; `None` if they are all one.
    pub fn through(colours: &[[f32; 3]]) -> Option<Self> {
        let mut lengths = vec![0.0];
        for pair in colours.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + distance(pair[0], pair[1]));
        }
        let whole = *lengths.last()?;
        if whole <= 0.05 {
            return None;
        }
        let mut points = Vec::with_capacity(POINTS);
        let mut segment = 0;
        for k in 0..POINTS {
            let along = whole * k as f32 / (POINTS - 1) as f32;
            while segment + 2 < lengths.len() && lengths[segment + 1] < along {
                segment += 1;
            }
            let length = lengths[segment + 1] - lengths[segment];
            let share =
                if length > 0.0 { ((along - lengths[segment]) / length).clamp(0.0, 1.0) } else { 0.0 };
            let (a, b) = (colours[segment], colours[segment + 1]);
            points.push(std::array::from_fn(|c| a[c] + share * (b[c] - a[c])));
        }
        Some(Self { points })
    }

    /// The colours along the curve, at even distances.
    pub fn points(&self) -> &[[f32; 3]] {
        &self.points
    }

    /// The place on the curve that is nearest to a colour, and its distance.
    pub fn nearest(&self, colour: [f32; 3]) -> Nearest {
        let mut best = Nearest { place: 0.0, distance: f32::MAX };
        for (k, pair) in self.points.windows(2).enumerate() {
            let (mut along, mut square) = (0.0, 0.0);
            for c in 0..3 {
                let side = pair[1][c] - pair[0][c];
                along += side * (colour[c] - pair[0][c]);
                square += side * side;
            }
            let share = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
            let foot = std::array::from_fn(|c| pair[0][c] + share * (pair[1][c] - pair[0][c]));
            let away = distance(colour, foot);
            if away < best.distance {
                best = Nearest { place: (k as f32 + share) / (POINTS - 1) as f32, distance: away };
            }
        }
        best
    }
}

/// The Euclidean distance of two colours, RGB.
pub fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f32>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_lengths() {
        let palette = Palette::through(&[[0.0; 3], [0.0, 0.0, 0.3], [0.1, 0.0, 0.3]]).unwrap();
        let nearest = palette.nearest([0.02, 0.0, 0.2]);
        assert!((nearest.place - 0.5).abs() < 0.01 && (nearest.distance - 0.02).abs() < 1e-3, "{nearest:?}");
        assert!(Palette::through(&[[0.4; 3]; 5]).is_none());
    }
}

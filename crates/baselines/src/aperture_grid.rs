//! The aperture's square in cells: the positions of views, and the share of light of each.

use crate::BaselineError;
use glam::DVec2;
use lens::Aperture;

/// A cell of the aperture's square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ApertureCell {
    /// Its centre, in [−1, 1]².
    pub u: DVec2,
    /// Its share of the open area, in (0, 1].
    pub share: f64,
}

/// The open cells among `side` × `side` of `aperture`, from u = (−1, −1), row by row. Their shares sum to 1.
///
/// # Errors
/// The aperture lets no light through.
pub fn open_cells(aperture: &Aperture, side: u32) -> Result<Vec<ApertureCell>, BaselineError> {
    /// Rows of the aperture in a row of cells.
    const FINENESS: usize = 16;
    let count = side as usize;
    let mut areas = vec![0.0; count * count];
    for (index, row) in aperture.rows(count * FINENESS).rows.iter().enumerate() {
        let areas = &mut areas[index / FINENESS * count..][..count];
        for run in &row.runs {
            let [start, end] = [run.start, run.end].map(|u| (u + 1.0) / 2.0 * count as f64);
            for (column, area) in areas.iter_mut().enumerate() {
                let overlap = end.min(column as f64 + 1.0) - start.max(column as f64);
                *area += overlap.max(0.0) * run.transmission;
            }
        }
    }
    let total: f64 = areas.iter().sum();
    if total <= 0.0 {
        return Err(BaselineError::ClosedAperture);
    }
    let center = |k: usize| (2 * k + 1) as f64 / count as f64 - 1.0;
    let cell = |(index, area): (usize, f64)| ApertureCell {
        u: DVec2::new(center(index % count), center(index / count)),
        share: area / total,
    };
    Ok(areas.into_iter().enumerate().filter(|(_, area)| *area > 0.0).map(cell).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use lens::ApertureShape;

    #[test]
    fn cells_share_the_open_area() {
        let cells = |shape: ApertureShape, side| open_cells(&shape.into(), side).unwrap();
        let square = cells(ApertureShape::Square, 4);
        assert_eq!(square.len(), 16);
        assert!(square.iter().all(|cell| (cell.share - 1.0 / 16.0).abs() < 1e-12));
        assert_eq!(square[1].u, DVec2::new(-0.25, -0.75));

        let disc = cells(ApertureShape::Disc, 2);
        assert!(disc.iter().all(|cell| (cell.share - 0.25).abs() < 1e-6), "{disc:?}");
        assert_eq!(cells(ApertureShape::Disc, 1).len(), 1);
        // The corners of a disc are closed: a cell of 20 a side whose nearest corner is at √2·0.9 > 1.
        assert!(cells(ApertureShape::Disc, 20).iter().all(|cell| cell.u.length() < 1.08));
        let thin = Aperture { shape: ApertureShape::Disc, ratio: 1e-6 };
        assert_eq!(open_cells(&thin, 4), Err(BaselineError::ClosedAperture));
    }
}

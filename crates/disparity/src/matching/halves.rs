//! Halves of the views: where something nearer occludes a point from one side, the views on the other side still agree.
//!
//! What occludes a point of the reference lies on one side of it, and so do the views that it is hidden from. The cost of a point is
//! therefore that of the half plane of views that agrees best (Kang, Szeliski and Chai, *Handling Occlusions in Dense Multi-view
//! Stereo*, CVPR 2001, use halves of a row; Strecke, Alperovich and Goldluecke, *Accurate Depth and Normal Maps from Occlusion-aware Focal
//! Stack Symmetry*, CVPR 2017, those of a cross). Views that lie in the same half planes are summed first: a *group*.

/// Directions of half planes, evenly around: every edge in a picture is within 22.5° of the border of one.
const DIRECTIONS: usize = 8;

/// Which views are summed together, and which sums make a half.
#[derive(Clone, Debug, PartialEq)]
pub struct Halves {
    /// The group of each view.
    pub group_of: Vec<usize>,
    /// How many groups there are.
    pub groups: usize,
    /// The groups of each half plane. The first "half" is the whole.
    pub halves: Vec<Vec<usize>>,
}

impl Halves {
    /// The halves of views at these offsets from the reference (which is not one of them).
    pub fn from_offsets(offsets: &[[f32; 2]]) -> Self {
        let reach = offsets.iter().map(|o| o[0].hypot(o[1])).fold(0.0, f32::max);
        let signature = |offset: &[f32; 2]| -> Vec<bool> {
            (0..DIRECTIONS)
                .map(|k| {
                    let (sin, cos) = (std::f32::consts::TAU * k as f32 / DIRECTIONS as f32).sin_cos();
                    // Views on the border see what the reference sees: they belong to both sides.
                    offset[0] * cos + offset[1] * sin > -1e-3 * reach
                })
                .collect()
        };
        let mut signatures: Vec<Vec<bool>> = Vec::new();
        let group_of = offsets
            .iter()
            .map(|offset| {
                let own = signature(offset);
                signatures.iter().position(|s| *s == own).unwrap_or_else(|| {
                    signatures.push(own);
                    signatures.len() - 1
                })
            })
            .collect();
        let mut halves: Vec<Vec<usize>> = vec![(0..signatures.len()).collect()];
        for k in 0..DIRECTIONS {
            let half: Vec<usize> = (0..signatures.len()).filter(|&g| signatures[g][k]).collect();
            if !half.is_empty() && !halves.contains(&half) {
                halves.push(half);
            }
        }
        Self { group_of, groups: signatures.len(), halves }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(columns: i32, rows: i32) -> Vec<[f32; 2]> {
        (-rows..=rows)
            .flat_map(|y| (-columns..=columns).map(move |x| [x as f32, y as f32]))
            .filter(|o| *o != [0.0, 0.0])
            .collect()
    }

    #[test]
    fn a_row_has_two_halves() {
        let halves = Halves::from_offsets(&grid(4, 0));
        assert_eq!(halves.groups, 2);
        assert_eq!(halves.halves, [vec![0, 1], vec![1], vec![0]]);
    }

    #[test]
    fn a_grid_has_eight_halves_of_nine_groups_of_sixteen() {
        let halves = Halves::from_offsets(&grid(4, 4));
        assert_eq!((halves.groups, halves.halves.len()), (16, 9));
        assert!(halves.halves[1..].iter().all(|half| half.len() == 9));
    }

    #[test]
    fn every_view_of_a_hexagon_is_in_a_half_without_the_opposite_one() {
        let hexagon: Vec<[f32; 2]> =
            (0..6).map(|k| std::f32::consts::TAU * k as f32 / 6.0).map(|a| [a.cos(), a.sin()]).collect();
        let halves = Halves::from_offsets(&hexagon);
        for view in 0..6 {
            let (own, opposite) = (halves.group_of[view], halves.group_of[(view + 3) % 6]);
            assert!(halves.halves.iter().any(|half| half.contains(&own) && !half.contains(&opposite)));
        }
    }
}

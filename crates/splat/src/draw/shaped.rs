//! Images of a lens whose aperture is cut or weighed.

use crate::canvas::Word;
use crate::character::moment_table::Moments;
use crate::character::node_shape::NodeShape;
use crate::character::shaper::Shaper;
use crate::draw::image::Image;
use crate::draw::image_frame::ImageFrame;
use crate::draw::paper::Paper;
use crate::draw::pen::{ALL, BoxPart, Form, Pen};
use crate::fixed::{ONE, WHOLE, mul_shift};
use crate::lens_in_use::Placed;
use crate::nodes::{Cells, SplatNode};
use numerics::with_widest_simd;

impl Pen<'_> {
    /// Draws a node whose light passes the aperture as `shape` says, in the forms of any other.
    // A function of its own, so that other nodes are drawn as quickly as without it.
    #[inline(never)]
    pub(super) fn draw_shaped<W: Word>(
        &self,
        by: (&Shaper, &NodeShape),
        node: &SplatNode,
        light: [f32; 4],
        placed: Placed,
        paper: &mut Paper<W>,
        sign: i32,
    ) {
        with_widest_simd(
            #[inline(always)]
            || self.draw_shaped_forms(by, node, light, placed, paper, sign),
        );
    }

    #[inline(always)]
    fn draw_shaped_forms<W: Word>(
        &self,
        (shaper, shape): (&Shaper, &NodeShape),
        node: &SplatNode,
        light: [f32; 4],
        placed: Placed,
        paper: &mut Paper<W>,
        sign: i32,
    ) {
        let image = self.image(node, light, placed);
        let half_size = [u32::from(node.half_size[0]), u32::from(node.half_size[1])];
        self.forms(
            node,
            placed,
            #[inline(always)]
            |form| {
                let mut image = Image { ..image };
                match form {
                    Form::Box(share) => {
                        image.share = share;
                        let moments = tilted(shaper.moments(node, shape), node, self.stop);
                        self.draw_moments(&mut image, half_size, moments, paper, sign);
                    }
                    Form::Parts(share) => {
                        image.share = share;
                        self.draw_parts(&image, placed.depth_share, Some(shape), paper, sign);
                    }
                    Form::Image(share) => {
                        image.share = share;
                        image.lean(node, self.tilt_shift);
                        self.draw_shaped_image((shaper, shape), &mut image, None, paper, sign);
                    }
                    Form::Tilted(share) => {
                        self.draw_shaped_image((shaper, shape), &mut image, Some((&ALL, share)), paper, sign);
                    }
                    Form::PartialBox => self.draw_shaped_cells((shaper, shape), &mut image, paper, sign),
                    Form::PartialImage => {
                        let visible = Some(self.visible_part(node));
                        self.draw_shaped_image((shaper, shape), &mut image, visible, paper, sign);
                    }
                }
            },
        );
    }

    /// A box of what a partly occluded node sends.
    #[inline(always)]
    fn draw_shaped_cells<W: Word>(
        &self,
        (shaper, shape): (&Shaper, &NodeShape),
        image: &mut Image,
        paper: &mut Paper<W>,
        sign: i32,
    ) {
        let node = image.node;
        let cells = self.nodes.cells(node).unwrap_or(&ALL);
        let half_size = node.half_size.map(|half| u32::from(half) >> image.level);
        image.share = WHOLE;
        self.draw_moments(image, half_size, shaper.moments_of_cells(node, cells, shape), paper, sign);
    }

    /// A box of light with these moments, as a share of what `image` has.
    #[inline(always)]
    fn draw_moments<W: Word>(
        &self,
        image: &mut Image,
        half_size: [u32; 2],
        [light, u, v, uu, vv]: Moments,
        paper: &mut Paper<W>,
        sign: i32,
    ) {
        if light <= 0.0 {
            return;
        }
        let mean = [u, v].map(|first| (first / light).clamp(-1.0, 1.0));
        let variance = [uu / light - mean[0] * mean[0], vv / light - mean[1] * mean[1]];
        image.share = share_of(image.share, light);
        image.shift(mean.map(|u| (u * ONE as f32).round_ties_even() as i32));
        let radius = image.radius.unsigned_abs();
        let half = variance.map(|variance| {
            let half = (3.0 * variance.max(0.0)).sqrt() * 65536.0;
            mul_shift(radius, half.round_ties_even() as u32, 16)
        });
        self.draw_box(image, half_size, half, paper, sign);
    }

    /// The aperture's image, or what `cells` let through of it, cut and weighed row by row.
    #[inline(always)]
    fn draw_shaped_image<W: Word>(
        &self,
        (shaper, shape): (&Shaper, &NodeShape),
        image: &mut Image,
        cells: Option<(&Cells, u32)>,
        paper: &mut Paper<W>,
        sign: i32,
    ) {
        let Some(size) = self.stencil_size_of(image) else {
            return self.draw_large(image, cells, Some(shape), &mut paper.rows, sign);
        };
        let (stencil, base) = self.stencils.stencil_at(size, image.center[1]);
        let (last, end) = (stencil.runs.last(), stencil.runs.first());
        let [first, last] = [end, last].map(|run| base + run.map_or(0, |run| run.row));
        if last < paper.rows.first || first >= paper.rows.end {
            return;
        }
        let shift = image.light.shift(stencil.height_bits);
        let frame = ImageFrame::new(image, size.radius());
        let Some((cells, share)) = cells else {
            for run in &stencil.runs {
                let row = base + run.row;
                if row >= paper.rows.first && row < paper.rows.end {
                    let span = [image.center[0] + run.start, image.center[0] + run.end];
                    shape.visit_row(
                        frame.row(row, Some(run.v), span),
                        #[inline(always)]
                        |part| {
                            let value = image.value(mul_shift(run.height, part.weight, 14), shift, row);
                            paper.rows.add_run(row, part.start, part.end, value, sign);
                        },
                    );
                }
            }
            return;
        };
        let visible = if self.takes_all_rows(image) {
            self.visible_runs::<true>(image, cells, share, stencil, base, &mut paper.runs)
        } else {
            self.visible_runs::<false>(image, cells, share, stencil, base, &mut paper.runs)
        };
        let Some((scale, runs)) = visible else {
            return self.draw_shaped_cells((shaper, shape), image, paper, sign);
        };
        image.share = scale;
        let mut rows = paper.rows.borrowed();
        let here = rows.first..rows.end;
        for run in runs.iter().filter(|run| here.contains(&run.row)) {
            shape.visit_row(
                frame.row(run.row, None, [run.start, run.end]),
                #[inline(always)]
                |part| {
                    let value = image.value(mul_shift(run.height, part.weight, 14), shift, run.row);
                    rows.add_run(run.row, part.start, part.end, value, sign);
                },
            );
        }
    }
}

impl NodeShape {
    /// The light of a part of the aperture, as `share` of all that is not cut.
    #[inline]
    pub(super) fn part_share(&self, share: u32, part: &BoxPart) -> u32 {
        let [x, y] = part.mean.map(|mean| mean as f32);
        let half = (part.half[0] + part.half[1]) as f32 / 8.0;
        let mut light = 1.0;
        for disc in self.discs.iter().flatten() {
            let away = (x - disc.center[0] as f32).hypot(y - disc.center[1] as f32);
            // The edge is straight over a part.
            light *= (0.5 + (disc.radius as f32 - away) / (2.0 * half).max(1.0)).clamp(0.0, 1.0);
        }
        let one = ONE as f32;
        let square = (x * x + y * y) / (one * one) + (part.variance[0] + part.variance[1]) as f32 / one;
        share_of(share, light * self.weight(square))
    }
}

/// A share (times 2²⁴) of which only `light` is sent, in [0, 2].
fn share_of(share: u32, light: f32) -> u32 {
    (f64::from(share) * f64::from(light.clamp(0.0, 2.0))).round_ties_even() as u32
}

/// Moments where the node's weight changes over the aperture, whose lens is `stop` (1/16384) as wide as the baked one: the change within
/// their spread only moves the mean.
fn tilted([light, u, v, uu, vv]: Moments, node: &SplatNode, stop: i32) -> Moments {
    let per_one = stop as f32 / ONE as f32 / ONE as f32;
    let tilt = node.tilt.map(|tilt| f32::from(tilt) * per_one);
    let base = f32::from(node.base) / ONE as f32;
    let sent = base * light + tilt[0] * u + tilt[1] * v;
    if light <= 0.0 || sent <= 0.0 {
        return [0.0; 5];
    }
    let more = sent / light;
    // ∫u·(base + tilt·u), the mixed moment left out.
    let moved = [
        base * u + tilt[0] * uu + tilt[1] * u * v / light,
        base * v + tilt[1] * vv + tilt[0] * u * v / light,
    ];
    let square = |second: f32, first: f32, moved: f32| {
        let variance = second / light - (first / light).powi(2);
        (variance + (moved / sent).powi(2)) * sent
    };
    debug_assert!(more.is_finite());
    [sent, moved[0], moved[1], square(uu, u, moved[0]), square(vv, v, moved[1])]
}

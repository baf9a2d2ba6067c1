//! Sums to a picture, on the processor.

use super::resolve_steps::{Finish, ResolveOutput};
use crate::nodes::Nodes;
use crate::resolve::balance::{Balance, Scaled};
use crate::resolve::partition::{Parts, Share};
use crate::resolve::parts_to_pixels::Pixels;
use crate::resolve::{BLACK, Overflow, Room, Window};
use crate::sums::{RESOLVE_ROWS, SumMarks, Sums};
use lens::Picture;
use rayon::prelude::*;
use std::ops::Range;

/// The picture, and what makes it of the sums.
pub struct Resolver {
    /// Of [`RESOLVE_ROWS`] rows each, of what is free and of what shares the rest.
    marks: Vec<[SumMarks; 2]>,
    /// What each pixel's sums are multiplied by.
    shares: Vec<Share>,
    /// What gives back the light that shares take.
    pub balance: Balance,
    pub picture: Picture,
}

impl Resolver {
    /// A resolver for `sums` of a picture of `width` × `height` px.
    pub fn new([width, height]: [usize; 2], sums: &Sums) -> Self {
        let rows_of_chunk = |first: usize| first as i32..(first + RESOLVE_ROWS).min(height) as i32;
        let chunks = (0..height).step_by(RESOLVE_ROWS).map(rows_of_chunk);
        Self {
            marks: chunks.map(|rows| sums.marks(rows)).collect(),
            shares: vec![Share::NONE; width * height],
            balance: Balance::neutral([width, height]),
            picture: Picture::black(width as u32, height as u32),
        }
    }

    /// The memory that it takes, in bytes, without shares and picture.
    pub fn bytes(&self) -> usize {
        let marks: usize =
            self.marks.iter().flatten().map(|(dim, bright)| dim.bytes() + bright.bytes()).sum();
        self.balance.bytes() + marks
    }

    /// Integrates the sums in some pixel rows and columns to what `output` says.
    ///
    /// # Errors
    /// A sum has overflowed.
    pub fn resolve(
        &mut self,
        nodes: &Nodes,
        sums: &Sums,
        [rows, columns]: [Range<u32>; 2],
        output: ResolveOutput,
        finish: Finish,
    ) -> Result<(), Overflow> {
        if !output.has_shares() {
            if finish != Finish::Balanced {
                return self.pass(nodes, sums, [rows, columns], output, finish);
            }
            // All of the picture: it is not live.
            self.pass(nodes, sums, self.frame(), ResolveOutput::Shared, finish)?;
            self.balance.find_rest();
            return self.pass(nodes, sums, self.frame(), ResolveOutput::PictureOverShared, finish);
        }
        // Evened pictures are multiplied by the gains afterwards.
        self.balance.reset();
        let may_scale = output.has_picture() && finish == Finish::Evened;
        let first = if may_scale { output } else { ResolveOutput::Shares };
        self.pass(nodes, sums, [rows.clone(), columns.clone()], first, finish)?;
        self.balance.find_gains();
        match output {
            ResolveOutput::SharesAndPicture if !may_scale => {
                self.pass(nodes, sums, [rows, columns], ResolveOutput::Picture, finish)
            }
            ResolveOutput::SharesAndPicture => {
                self.balance.gains.scale(&mut self.picture.radiance);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The same with the gains as they are.
    fn pass(
        &mut self,
        nodes: &Nodes,
        sums: &Sums,
        [rows, columns]: [Range<u32>; 2],
        output: ResolveOutput,
        finish: Finish,
    ) -> Result<(), Overflow> {
        let width = self.picture.width as usize;
        // The same chunks for any requested rows.
        let chunks = rows.start as usize / RESOLVE_ROWS..(rows.end as usize).div_ceil(RESOLVE_ROWS);
        let knots = &self.balance.knots;
        let (gains, rest) = (&self.balance.gains, self.balance.rest);
        let is_evened = finish == Finish::Evened;
        // Shares need none; gains of all of the light do.
        let needs_colour = output != ResolveOutput::Shares || is_evened;
        let scaled = if is_evened { Scaled::All } else { Scaled::Sharing };
        let radiance = self.picture.radiance.par_chunks_mut(RESOLVE_ROWS * width);
        let coverage = self.picture.coverage.par_chunks_mut(RESOLVE_ROWS * width);
        let shares = self.shares.par_chunks_mut(RESOLVE_ROWS * width);
        let of_knots = self.balance.rows.par_chunks_mut(RESOLVE_ROWS * knots.columns());
        let of_spans = self.balance.shared.par_chunks_mut(RESOLVE_ROWS * knots.spans());
        let sums_of_rows = of_knots.zip(of_spans);
        let all = radiance.zip(coverage).zip(shares.zip(sums_of_rows)).zip(&mut self.marks).enumerate();
        let chunks = all.skip(chunks.start).take(chunks.len());
        chunks.try_for_each_init(
            Room::default,
            |room, (chunk, (((radiance, coverage), (shares, (of_knots, of_spans))), marks))| {
                let first = (chunk * RESOLVE_ROWS) as u32;
                let here = rows.start.max(first)..rows.end.min(first + (coverage.len() / width) as u32);
                let signed = |range: &Range<u32>| range.start as i32..range.end as i32;
                let window = Window { rows: signed(&here), columns: signed(&columns) };
                let [free_marks, sharing_marks] = marks;
                let [mut free, mut sharing] = [None, None];
                if output.has_free() {
                    let rows = sums.free.rows(nodes.quanta(), &window, free_marks, room)?;
                    free = Some(if needs_colour { rows } else { rows.coverage_only() });
                }
                if output.has_sharing() {
                    sharing = Some(sums.sharing.rows(nodes.quanta(), &window, sharing_marks, room)?);
                }
                let mut lines = [room.take(columns.len()), room.take(columns.len())];
                lines.iter_mut().for_each(|line| line.fill(BLACK));
                for row in here {
                    for (rows, line) in [&mut free, &mut sharing].into_iter().zip(&mut lines) {
                        rows.as_mut().map_or(Ok(()), |rows| rows.read(row as i32, line))?;
                    }
                    let parts = Parts { free: &lines[0], sharing: &lines[1] };
                    let at = (row - first) as usize;
                    let here = at * width + columns.start as usize..at * width + columns.end as usize;
                    let shares = &mut shares[here.clone()];
                    if output.has_shares() {
                        parts.find_shares(shares);
                        let sums = &mut of_knots[at * knots.columns()..][..knots.columns()];
                        knots.sum_row(parts, shares, sums, is_evened);
                    }
                    let pixels = Pixels {
                        first: columns.start as usize,
                        radiance: &mut radiance[here.clone()],
                        coverage: &mut coverage[here],
                    };
                    let gains = || gains.row_gains(row as usize, scaled);
                    match output {
                        ResolveOutput::Shares => (),
                        ResolveOutput::SharesAndPicture => parts.join(shares, None, is_evened, pixels),
                        ResolveOutput::Picture => parts.join(shares, Some(&gains()), is_evened, pixels),
                        ResolveOutput::Shared => {
                            let sums = &mut of_spans[at * knots.spans()..][..knots.spans()];
                            parts.share(shares, &gains(), pixels, sums);
                        }
                        ResolveOutput::PictureOverShared => parts.join_shared(rest, pixels),
                    }
                }
                lines.into_iter().for_each(|line| room.recycle(line));
                [free, sharing].into_iter().flatten().for_each(|rows| rows.recycle(room));
                Ok(())
            },
        )
    }

    /// All rows and columns.
    fn frame(&self) -> [Range<u32>; 2] {
        [0..self.picture.height, 0..self.picture.width]
    }
}

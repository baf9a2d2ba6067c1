//! Entropy coding of partial visibility: about 4 bytes for 8 × 8 or 16 × 16 cells.
//!
//! The cells of one sample resemble each other, and those of the previous sample, which usually has the same occluder. A
//! flag per row says whether the row equals that of the previous sample; if not, each cell is predicted from six cells coded
//! before it and five around its place in the previous sample: for each of these contexts an adaptive model estimates how
//! often a cell is visible (as in JBIG, ITU-T T.82), and an arithmetic coder codes the cell accordingly. Models are reset
//! with every chunk of samples, so that a chunk can be read alone.

use crate::sample::Visibility;

/// The estimated probability that a bit is 0 (a cell is hidden).
#[derive(Clone, Copy)]
struct BitModel {
    /// In 1/65536.
    hidden: u16,
    /// The number of cells it is estimated from, at most [`BitModel::MEMORY`].
    observations: u8,
}

impl BitModel {
    const EVEN: Self = Self { hidden: 1 << 15, observations: 0 };
    /// Only this many recent cells count.
    const MEMORY: usize = 60;
    /// No chance is 0 or 1.
    const LEAST: i64 = 24;

    /// The step by which a cell moves the probability, as a share of the distance, in 1/65536.
    const STEPS: [i64; Self::MEMORY + 1] = {
        let mut steps = [0; Self::MEMORY + 1];
        let mut observations = 0;
        while observations <= Self::MEMORY {
            steps[observations] = (1 << 17) / (2 * observations as i64 + 3);
            observations += 1;
        }
        steps
    };

    fn update(&mut self, is_visible: bool) {
        let (hidden, observations) = (i64::from(self.hidden), self.observations as usize);
        let target = if is_visible { 0 } else { 1 << 16 };
        let moved = hidden + (((target - hidden) * Self::STEPS[observations]) >> 16);
        self.hidden = moved.clamp(Self::LEAST, (1 << 16) - Self::LEAST) as u16;
        self.observations = (observations + 1).min(Self::MEMORY) as u8;
    }
}

/// Patterns that foretell a cell: 11 bits, for 8 and for 16 cells a side.
const PATTERNS: usize = 1 << 12;

/// What foretells that a row is that of the sample before: whether the three rows above it were, for either side.
const ROW_PATTERNS: usize = 1 << 4;

/// What was learned of the cells so far.
struct Model {
    cells: Box<[BitModel; PATTERNS]>,
    rows: [BitModel; ROW_PATTERNS],
    /// The last field of 8 and that of 16 cells a side, row by row.
    last: [[u16; 16]; 2],
}

impl Model {
    fn new() -> Self {
        Self {
            cells: Box::new([BitModel::EVEN; PATTERNS]),
            rows: [BitModel::EVEN; ROW_PATTERNS],
            last: [[u16::MAX; 16]; 2],
        }
    }

    /// Passes the rows and cells of a field to `code`, which takes the model of each bit and its value and returns the value.
    #[inline(always)]
    fn pass(&mut self, rows: &mut [u16; 16], side: usize, mut code: impl FnMut(&mut BitModel, bool) -> bool) {
        // A row with two cells more on either side, like its outermost ones.
        let padded = |row: u16| {
            let row = u32::from(row) & ((1 << side) - 1);
            ((row & 1) * 3) | (row << 2) | (((row >> (side - 1)) * 3) << (side + 2))
        };
        let is_fine = usize::from(side == 16);
        let last = self.last[is_fine].map(padded);
        let [mut above, mut two_above] = [last[0]; 2];
        let mut alike = 0;
        for r in 0..side {
            let chance = &mut self.rows[alike | is_fine << 3];
            let is_alike = code(chance, padded(rows[r]) == last[r]);
            chance.update(is_alike);
            alike = (alike << 1 | usize::from(is_alike)) & 7;
            if is_alike {
                rows[r] = (last[r] >> 2 & ((1 << side) - 1)) as u16;
                (two_above, above) = (above, last[r]);
                continue;
            }
            let [before, below] = [last[r.saturating_sub(1)], last[(r + 1).min(side - 1)]];
            let mut row = last[r] & 3;
            for c in 0..side {
                let pattern = row >> c & 3
                    | (above >> (c + 1) & 7) << 2
                    | (two_above >> (c + 2) & 1) << 5
                    | (last[r] >> (c + 1) & 7) << 6
                    | (before >> (c + 2) & 1) << 9
                    | (below >> (c + 2) & 1) << 10;
                let chance = &mut self.cells[pattern as usize | is_fine << 11];
                let is_visible = code(chance, rows[r] >> c & 1 == 1);
                chance.update(is_visible);
                row |= u32::from(is_visible) << (c + 2);
            }
            rows[r] = (row >> 2) as u16;
            (two_above, above) = (above, padded(rows[r]));
        }
        self.last[is_fine] = *rows;
    }
}

/// Below this the coder's range is widened by a byte.
const NARROW: u32 = 1 << 24;

/// Codes fields of cells.
pub struct MaskWriter {
    model: Model,
    low: u32,
    range: u32,
    codes: Vec<u8>,
    is_empty: bool,
}

impl MaskWriter {
    /// A writer without masks, whose model has learnt nothing.
    pub fn new() -> Self {
        Self { model: Model::new(), low: 0, range: u32::MAX, codes: Vec::new(), is_empty: true }
    }

    /// Codes the next field of cells: the words of a [`Visibility::Cells`].
    pub fn write(&mut self, words: &[u64]) {
        self.is_empty = false;
        let side = Visibility::side_of(words);
        let mut rows =
            std::array::from_fn(|row| if row < side { Visibility::row(words, row) as u16 } else { 0 });
        let (low, range, codes) = (&mut self.low, &mut self.range, &mut self.codes);
        self.model.pass(&mut rows, side, |chance, is_visible| {
            let hidden = (*range >> 16) * u32::from(chance.hidden);
            if is_visible {
                raise(low, hidden, codes);
                *range -= hidden;
            } else {
                *range = hidden;
            }
            while *range < NARROW {
                codes.push((*low >> 24) as u8);
                (*low, *range) = (*low << 8, *range << 8);
            }
            is_visible
        });
    }

    /// The bytes that code all fields.
    pub fn finish(mut self) -> Vec<u8> {
        if !self.is_empty {
            // The range contains a multiple of its least width: one byte identifies it, as zeros follow.
            let up = self.low.wrapping_neg() & (NARROW - 1);
            raise(&mut self.low, up, &mut self.codes);
            self.codes.push((self.low >> 24) as u8);
            while self.codes.last() == Some(&0) {
                self.codes.pop();
            }
        }
        self.codes
    }
}

/// Adds to the low end of the range; a carry propagates into the codes.
#[inline(always)]
fn raise(low: &mut u32, by: u32, codes: &mut [u8]) {
    let carries;
    (*low, carries) = low.overflowing_add(by);
    if carries {
        for byte in codes.iter_mut().rev() {
            let carries_on;
            (*byte, carries_on) = byte.overflowing_add(1);
            if !carries_on {
                break;
            }
        }
    }
}

/// Reads what a [`MaskWriter`] has coded. Of other codes it makes some fields or other.
pub struct MaskReader<'a> {
    model: Model,
    code: u32,
    range: u32,
    codes: std::slice::Iter<'a, u8>,
}

impl<'a> MaskReader<'a> {
    /// Reads the masks that a [`MaskWriter`] has written to `codes`.
    pub fn new(codes: &'a [u8]) -> Self {
        let mut codes = codes.iter();
        let code = (0..4).fold(0, |code, _| code << 8 | next(&mut codes));
        Self { model: Model::new(), code, range: u32::MAX, codes }
    }

    /// Decodes the next field, of `side` = 8 or 16 cells a side.
    pub fn read(&mut self, side: usize) -> Box<[u64]> {
        let mut rows = [0; 16];
        let (code, range, codes) = (&mut self.code, &mut self.range, &mut self.codes);
        self.model.pass(&mut rows, side, |chance, _| {
            let hidden = (*range >> 16) * u32::from(chance.hidden);
            let is_visible = *code >= hidden;
            if is_visible {
                *code -= hidden;
                *range -= hidden;
            } else {
                *range = hidden;
            }
            while *range < NARROW {
                *code = *code << 8 | next(codes);
                *range <<= 8;
            }
            is_visible
        });
        let rows_a_word = 64 / side;
        rows[..side]
            .chunks(rows_a_word)
            .map(|rows| rows.iter().rev().fold(0, |word, &row| word << side | u64::from(row)))
            .collect()
    }
}

/// The next byte; zeros follow the last.
#[inline(always)]
fn next(codes: &mut std::slice::Iter<u8>) -> u32 {
    codes.next().map_or(0, |&byte| byte.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jitter::jitter;

    /// The field of cells on one side of an edge that wanders, with some grain.
    fn field(number: u32) -> Box<[u64]> {
        let side = if number.is_multiple_of(5) { 8 } else { 16 };
        let edge = (f64::from(number) * 0.1).sin() * 12.0;
        let mut words = vec![0; side * side / 64];
        for cell in 0..side * side {
            let [x, y] = [cell % side, cell / side].map(|k| k as f64 * 16.0 / side as f64 - 8.0);
            let grain = jitter(number, cell as u32, 7)[0];
            if x + 0.3 * y + grain > edge || number % 97 == 3 && grain > 0.5 {
                words[cell / 64] |= 1 << (cell % 64);
            }
        }
        words.into()
    }

    fn codes_of(fields: &[Box<[u64]>]) -> Vec<u8> {
        let mut writer = MaskWriter::new();
        fields.iter().for_each(|words| writer.write(words));
        writer.finish()
    }

    #[test]
    fn fields_come_back_bit_for_bit_and_take_few_bytes() {
        for count in [1, 2, 3, 40, 4000] {
            let mut fields: Vec<_> = (0..count).map(field).collect();
            let even: [Box<[u64]>; 4] =
                [[0; 1].into(), [u64::MAX; 1].into(), [0; 4].into(), [u64::MAX; 4].into()];
            fields.extend(even.clone());
            fields.splice(0..0, even.into_iter().rev());
            let codes = codes_of(&fields);
            let mut reader = MaskReader::new(&codes);
            for words in &fields {
                assert_eq!(reader.read(Visibility::side_of(words)), *words);
            }
            assert!(count < 4000 || codes.len() < 9 * fields.len(), "{} bytes", codes.len());
        }
        assert!(codes_of(&[]).is_empty());
    }

    #[test]
    fn grain_alone_takes_hardly_more_than_its_bits() {
        let word = |k: u32| (0..64).fold(0, |word, bit| word << 1 | u64::from(jitter(k, bit, 3)[1] > 0.5));
        let fields: Vec<Box<[u64]>> =
            (0..2000).map(|k| Box::from([0, 1, 2, 3].map(|part| word(4 * k + part)))).collect();
        let codes = codes_of(&fields);
        assert!((62_000..67_000).contains(&codes.len()), "{}", codes.len());
        let mut reader = MaskReader::new(&codes);
        assert!(fields.iter().all(|words| reader.read(16) == *words));
    }

    #[test]
    fn carries_run_through_the_codes() {
        let mut codes = vec![7, 255, 255];
        let mut low = u32::MAX;
        raise(&mut low, 1, &mut codes);
        assert_eq!((low, codes), (0, vec![8, 0, 0]));
    }

    #[test]
    fn any_bytes_can_be_read() {
        let bytes: Vec<u8> = (0..300u32).map(|k| ((k * k * 31) >> 3) as u8).collect();
        let mut reader = MaskReader::new(&bytes);
        for k in 0..200 {
            assert_eq!(reader.read(if k % 2 == 0 { 8 } else { 16 }).len(), if k % 2 == 0 { 1 } else { 4 });
        }
    }
}

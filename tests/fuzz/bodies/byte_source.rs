//! Bytes taken for choices and numbers. Zeros follow the end, so that every string of bytes is a program.

/// Bytes that are still to be taken.
pub struct ByteSource<'a> {
    rest: &'a [u8],
}

impl<'a> ByteSource<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Whether all of them are taken.
    pub fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    pub fn byte(&mut self) -> u8 {
        let (first, rest) = self.rest.split_first().unwrap_or((&0, &[]));
        self.rest = rest;
        *first
    }

    /// A number below `count`, which is above 0.
    pub fn below(&mut self, count: usize) -> usize {
        usize::from(self.byte()) % count
    }

    pub fn pick<'b, T>(&mut self, of: &'b [T]) -> &'b T {
        &of[self.below(of.len())]
    }

    /// A number from `low` to `high` in 65,536 steps.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let step = u16::from_le_bytes([self.byte(), self.byte()]);
        low + (high - low) * f64::from(step) / f64::from(u16::MAX)
    }

    /// A number that somebody may write: mostly usual, sometimes extreme.
    pub fn number(&mut self, low: f64, high: f64) -> f64 {
        const EXTREME: [f64; 12] =
            [0.0, -0.0, 1e-300, 1e-9, -1.0, 1e9, -1e9, 1e38, 1e308, -1e308, f64::EPSILON, 4294967296.0];
        match self.byte() {
            0..16 => *self.pick(&EXTREME),
            16..32 => self.between(low, high).round(),
            _ => self.between(low, high),
        }
    }
}

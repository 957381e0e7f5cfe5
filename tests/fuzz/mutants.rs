//! Mutants of seeds: bytes changed, removed, repeated and joined, in an order that never changes.

/// Endless mutants.
pub struct Mutants {
    seeds: Vec<Vec<u8>>,
    state: u64,
}

/// Bytes that change what a file means: limits of counts, letters and marks of texts.
const TELLING: &[u8] = b"\x00\x01\x7f\x80\xff\n \"'[]{}(),.-+=0129eE/#<>";

impl Mutants {
    /// Mutants of `seeds`; of random bytes where there are none.
    pub fn of(mut seeds: Vec<Vec<u8>>) -> Self {
        let mut state = 0x9e37_79b9_7f4a_7c15;
        if seeds.is_empty() {
            seeds.extend(
                (1..9).map(|length| (0..length * 40).map(|_| random(&mut state) as u8).collect::<Vec<u8>>()),
            );
        }
        Self { seeds, state }
    }

    fn below(&mut self, count: usize) -> usize {
        (random(&mut self.state) % count.max(1) as u64) as usize
    }

    fn mutate(&mut self, bytes: &mut Vec<u8>) {
        let at = self.below(bytes.len());
        let length = 1 + self.below(16).min(bytes.len().saturating_sub(at + 1));
        match self.below(6) {
            _ if bytes.is_empty() => bytes.push(random(&mut self.state) as u8),
            0 => bytes[at] ^= 1 << self.below(8),
            1 => bytes[at] = TELLING[self.below(TELLING.len())],
            2 => drop(bytes.drain(at..at + length)),
            3 => {
                let again = bytes[at..at + length].to_vec();
                bytes.splice(at..at, again);
            }
            4 => {
                let other = self.below(self.seeds.len());
                let from = self.below(self.seeds[other].len());
                let end = (from + length).min(self.seeds[other].len());
                let part = self.seeds[other][from..end].to_vec();
                bytes.splice(at..at + part.len().min(bytes.len() - at), part);
            }
            _ => bytes.truncate(at.max(1)),
        }
    }
}

impl Iterator for Mutants {
    type Item = Vec<u8>;

    fn next(&mut self) -> Option<Vec<u8>> {
        let seed = self.below(self.seeds.len());
        let mut bytes = self.seeds[seed].clone();
        for _ in 0..=self.below(6) {
            self.mutate(&mut bytes);
        }
        Some(bytes)
    }
}

/// The next number of a sequence (xorshift64*, Vigna 2016).
fn random(state: &mut u64) -> u64 {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    state.wrapping_mul(0x2545_f491_4f6c_dd1d)
}

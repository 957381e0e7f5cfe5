//! The filters of a PNG's rows (PNG 3rd edition, section 9): each byte less a prediction from bytes before it.
//!
//! Of a row, the filter is taken whose bytes, read as signed, have the least sum of magnitudes: the heuristic of the
//! specification, section 12.7, with the order of trial and the ties of the crate `png`, so that files keep their bytes.

/// Number of the filter of each row (section 9.2), in the order in which they are tried.
const TRIED: [u8; 4] = [UP, SUB, AVERAGE, PAETH];
const SUB: u8 = 1;
const UP: u8 = 2;
const AVERAGE: u8 = 3;
const PAETH: u8 = 4;

/// A filtered row of its length and one byte more, the filter's number before it, and the memory of another.
pub(super) struct FilteredRow {
    best: Vec<u8>,
    tried: Vec<u8>,
}

impl FilteredRow {
    /// Rows of `bytes` bytes.
    pub fn new(bytes: usize) -> Self {
        Self { best: vec![0; bytes + 1], tried: vec![0; bytes + 1] }
    }

    /// The row `current` below the row `previous`, filtered as packs best; pixels have `channels` bytes. All three have the
    /// length that [`FilteredRow::new`] names.
    pub fn filter(&mut self, previous: &[u8], current: &[u8], channels: usize) -> &[u8] {
        let mut least = u64::MAX;
        for number in TRIED {
            self.tried[0] = number;
            filter(number, previous, current, channels, &mut self.tried[1..]);
            let cost = magnitudes(&self.tried[1..]);
            if cost <= least {
                least = cost;
                std::mem::swap(&mut self.best, &mut self.tried);
            }
            if cost == 0 {
                break;
            }
        }
        &self.best
    }
}

/// The sum of the magnitudes of bytes, read as signed.
fn magnitudes(bytes: &[u8]) -> u64 {
    // Of as many as this the sum fits into 16 bits, which a processor adds many at once.
    bytes
        .chunks(256)
        .map(|bytes| {
            let sum: u16 = bytes.iter().map(|&byte| u16::from((byte as i8).unsigned_abs())).sum();
            u64::from(sum)
        })
        .sum()
}

fn filter(number: u8, previous: &[u8], current: &[u8], channels: usize, filtered: &mut [u8]) {
    let first = channels.min(current.len());
    let inner = current.len() - first;
    let (left, upper_left) = (&current[..inner], &previous[..inner]);
    let (start, rest) = filtered.split_at_mut(first);
    let here = rest.iter_mut().zip(&current[first..]);
    match number {
        UP => {
            start.copy_from_slice(&current[..first]);
            for (start, above) in start.iter_mut().zip(previous) {
                *start = start.wrapping_sub(*above);
            }
            for ((filtered, byte), above) in here.zip(&previous[first..]) {
                *filtered = byte.wrapping_sub(*above);
            }
        }
        SUB => {
            start.copy_from_slice(&current[..first]);
            for ((filtered, byte), left) in here.zip(left) {
                *filtered = byte.wrapping_sub(*left);
            }
        }
        AVERAGE => {
            for ((start, byte), above) in start.iter_mut().zip(current).zip(previous) {
                *start = byte.wrapping_sub(above / 2);
            }
            for (((filtered, byte), left), above) in here.zip(left).zip(&previous[first..]) {
                // Half the sum, rounded down, within a byte.
                *filtered = byte.wrapping_sub((left & above) + ((left ^ above) >> 1));
            }
        }
        _ => {
            for ((start, byte), above) in start.iter_mut().zip(current).zip(previous) {
                *start = byte.wrapping_sub(*above);
            }
            let beside = left.iter().zip(&previous[first..]).zip(upper_left);
            for ((filtered, byte), ((left, above), upper_left)) in here.zip(beside) {
                *filtered = byte.wrapping_sub(paeth(*left, *above, *upper_left));
            }
        }
    }
}

/// The predictor of Paeth (section 9.4): of three neighbors the one nearest to `left + above − upper_left`.
///
/// Within bytes, so that a processor takes many at once: where `upper_left` is the least or the greatest of the three, it is
/// the farthest, and where it is not, its distance is the difference of the other two.
#[inline(always)]
fn paeth(left: u8, above: u8, upper_left: u8) -> u8 {
    let to_left = above.abs_diff(upper_left);
    let to_above = left.abs_diff(upper_left);
    let is_between = (left < upper_left) == (upper_left < above);
    let to_upper_left = if is_between { to_left.abs_diff(to_above) } else { u8::MAX };
    if to_left <= to_above && to_left <= to_upper_left {
        left
    } else if to_above <= to_upper_left {
        above
    } else {
        upper_left
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_predictor_is_that_of_the_specification() {
        let by_definition = |left: u8, above: u8, upper_left: u8| {
            let [a, b, c] = [left, above, upper_left].map(i32::from);
            let [to_a, to_b, to_c] = [a, b, c].map(|value| (a + b - c - value).abs());
            if to_a <= to_b && to_a <= to_c {
                left
            } else if to_b <= to_c {
                above
            } else {
                upper_left
            }
        };
        for index in 0..1 << 18 {
            // Every fourth value of each, from 0 and from 3.
            for more in [0, 3] {
                let [left, above, upper_left] =
                    [0, 6, 12].map(|shift| ((index >> shift) % 64 * 4 + more) as u8);
                let expected = by_definition(left, above, upper_left);
                assert_eq!(paeth(left, above, upper_left), expected, "{left} {above} {upper_left}");
            }
        }
    }
}

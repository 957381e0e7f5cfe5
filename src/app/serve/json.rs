//! JSON written straight into the body: what an answer holds thousands of must not pass through a tree of values.

use serde_json::ser::{CompactFormatter, Formatter};

/// Appends a number, in the fewest digits that read back to the same bits; `null` where it is not finite.
pub fn number(out: &mut Vec<u8>, value: f64) {
    if value.is_finite() {
        CompactFormatter.write_f64(out, value).expect("memory takes every byte");
    } else {
        out.extend_from_slice(b"null");
    }
}

/// Appends a whole number.
pub fn whole(out: &mut Vec<u8>, value: u64) {
    CompactFormatter.write_u64(out, value).expect("memory takes every byte");
}

/// Appends a string in its quotes.
pub fn string(out: &mut Vec<u8>, text: &str) {
    serde_json::to_writer(out, text).expect("memory takes every byte, and a string is always JSON");
}

/// Appends bytes as they are.
pub fn raw(out: &mut Vec<u8>, text: &str) {
    out.extend_from_slice(text.as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(value: f64) -> String {
        let mut out = Vec::new();
        number(&mut out, value);
        String::from_utf8(out).expect("ASCII")
    }

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        let mut bits = 1u64;
        for _ in 0..20_000 {
            bits = bits.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let value = f64::from_bits(bits);
            if value.is_finite() {
                assert_eq!(written(value).parse::<f64>().map(f64::to_bits), Ok(value.to_bits()));
            }
        }
        assert_eq!((written(815.0), written(-0.1)), ("815.0".into(), "-0.1".into()));
        assert_eq!((written(f64::NAN), written(f64::INFINITY)), ("null".into(), "null".into()));
    }

    #[test]
    fn strings_are_escaped() {
        let mut out = Vec::new();
        string(&mut out, "a \"b\"\n");
        assert_eq!(out, br#""a \"b\"\n""#);
    }
}

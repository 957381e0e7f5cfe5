//! Fields of heights for benchmarks: made from nothing, the same on every machine.

/// Heights of an `n` × `n` fractal, meters, row by row from the south-west, for posts 10 m apart.
///
/// Fractional noise with a Hurst exponent of about 0.9: smooth noise summed over octaves, each of half the length
/// and 2⁻⁰·⁹ the height. Smaller sizes are corners of larger ones, so that a post is as rough at every size; over
/// 4097² posts the relief is some thousand meters.
pub fn fractal(n: usize) -> Vec<f32> {
    let mut heights = vec![0f64; n * n];
    let mut spacing = 2048usize;
    let mut amplitude = LARGEST_M;
    while spacing >= 1 {
        add_octave(&mut heights, n, spacing, amplitude);
        amplitude *= OCTAVE_RATIO;
        spacing /= 2;
    }
    heights.into_iter().map(|height| height as f32).collect()
}

/// Of the octave that has a knot every 2,048 posts.
const LARGEST_M: f64 = 1400.0;

/// 2⁻⁰·⁹.
const OCTAVE_RATIO: f64 = 0.535_886_731_268_146_6;

/// Noise at knots, between them blended by smooth steps: along rows of knots first, then between those.
fn add_octave(heights: &mut [f64], n: usize, spacing: usize, amplitude: f64) {
    let blends: Vec<f64> = (0..spacing)
        .map(|at| at as f64 / spacing as f64)
        .map(|t| t * t * t * (t * (t * 6.0 - 15.0) + 10.0))
        .collect();
    let knot_row = |row: usize| -> Vec<f64> {
        let knots: Vec<f64> =
            (0..n / spacing + 2).map(|column| amplitude * noise(column, row, spacing)).collect();
        (0..n)
            .map(|x| {
                let (knot, blend) = (x / spacing, blends[x % spacing]);
                knots[knot] + (knots[knot + 1] - knots[knot]) * blend
            })
            .collect()
    };
    let (mut south, mut north) = (knot_row(0), knot_row(1));
    for (y, row) in heights.chunks_exact_mut(n).enumerate() {
        if y > 0 && y % spacing == 0 {
            south = std::mem::replace(&mut north, knot_row(y / spacing + 1));
        }
        let blend = blends[y % spacing];
        for (height, (south, north)) in row.iter_mut().zip(south.iter().zip(&north)) {
            *height += south + (north - south) * blend;
        }
    }
}

/// A number from -1 to 1 that a knot of an octave always has.
fn noise(column: usize, row: usize, spacing: usize) -> f64 {
    let mut bits = (column as u64) << 40 ^ (row as u64) << 16 ^ spacing as u64 ^ 0x9E37_79B9_7F4A_7C15;
    // The finish of SplitMix64 (Steele, Lea, Flood 2014).
    for (shift, factor) in [(30, 0xBF58_476D_1CE4_E5B9_u64), (27, 0x94D0_49BB_1331_11EB)] {
        bits = (bits ^ bits >> shift).wrapping_mul(factor);
    }
    bits ^= bits >> 31;
    (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

//! Colors of DXF: the index of AutoCAD's table, or 24 bits.

/// The color of an entity or a layer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum DxfColor {
    /// That of its layer.
    #[default]
    ByLayer,
    /// That of the block's reference that it is drawn by.
    ByBlock,
    /// Red, green and blue.
    Rgb([u8; 3]),
}

impl DxfColor {
    /// By an index: 0 is that of the block, 256 that of the layer; of a layer that is off it is negative.
    pub fn of_index(index: i64) -> Self {
        match index.unsigned_abs() {
            0 => Self::ByBlock,
            index @ 1..=255 => Self::Rgb(indexed(index as u8)),
            _ => Self::ByLayer,
        }
    }

    /// By 24 bits.
    pub fn of_true_color(value: i64) -> Self {
        let [_, red, green, blue] = (value as u32).to_be_bytes();
        Self::Rgb([red, green, blue])
    }
}

/// The shades of a hue: the brightest part of even indices; odd ones are half as saturated.
const SHADES: [u16; 5] = [255, 204, 153, 127, 76];

/// The color of an index. 7 is black on paper and white on a dark window; here it is black.
fn indexed(index: u8) -> [u8; 3] {
    match index {
        0 | 7 => [0, 0, 0],
        1 => [255, 0, 0],
        2 => [255, 255, 0],
        3 => [0, 255, 0],
        4 => [0, 255, 255],
        5 => [0, 0, 255],
        6 => [255, 0, 255],
        8 => [128, 128, 128],
        9 => [192, 192, 192],
        250 => [51; 3],
        251 => [91; 3],
        252 => [132; 3],
        253 => [173; 3],
        254 => [214; 3],
        255 => [255; 3],
        _ => hued(u16::from(index)),
    }
}

/// A color of the wheel of 24 hues.
fn hued(index: u16) -> [u8; 3] {
    let most = SHADES[usize::from(index % 10 / 2)];
    let doubled_least = if index % 2 == 1 { most } else { 0 };
    // Hues are quarters of the sixths of the wheel.
    let quarter = index / 10 - 1;
    let (sixth, part) = (quarter / 4, quarter % 4);
    let between = |part: u16| (doubled_least * 4 + (2 * most - doubled_least) * part) / 8;
    let (least, rising, falling) = (doubled_least / 2, between(part), between(4 - part));
    let parts = match sixth {
        0 => [most, rising, least],
        1 => [falling, most, least],
        2 => [least, most, rising],
        3 => [least, falling, most],
        4 => [rising, least, most],
        _ => [most, least, falling],
    };
    parts.map(|part| part as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_those_of_autocad_s_table() {
        let of = |index: i64| match DxfColor::of_index(index) {
            DxfColor::Rgb(rgb) => rgb,
            other => panic!("{other:?}"),
        };
        for (index, rgb) in [
            (1, [255, 0, 0]),
            (10, [255, 0, 0]),
            (11, [255, 127, 127]),
            (13, [204, 102, 102]),
            (19, [76, 38, 38]),
            (20, [255, 63, 0]),
            (31, [255, 191, 127]),
            (40, [255, 191, 0]),
            (90, [0, 255, 0]),
            (170, [0, 0, 255]),
            (240, [255, 0, 63]),
            (252, [132, 132, 132]),
        ] {
            assert_eq!(of(index), rgb, "{index}");
        }
        assert_eq!(of(-1), [255, 0, 0]);
        assert_eq!(DxfColor::of_index(256), DxfColor::ByLayer);
        assert_eq!(DxfColor::of_index(0), DxfColor::ByBlock);
        assert_eq!(DxfColor::of_true_color(0x00_12_34_56), DxfColor::Rgb([0x12, 0x34, 0x56]));
    }
}

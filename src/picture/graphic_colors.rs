//! Colors of tactical graphics and of layers of sight.

use sandtable_description::words::GraphicSide;
use sandtable_draw::color::Srgba;
use sandtable_symbology::graphic::kind::GraphicTint;

/// How opaque the filling of an area is, of 255.
const GROUND_ALPHA: u8 = 110;

/// Obstacles, whoever made them.
const OBSTACLE: Srgba = Srgba::opaque(0, 104, 40);

/// Tints of seen and of hidden ground. Relief shows through both.
pub const SEEN: Srgba = Srgba([60, 200, 70, 96]);
/// See [`SEEN`].
pub const HIDDEN: Srgba = Srgba([24, 20, 52, 112]);

/// Lines of sight over seen and over hidden ground.
pub const SEEN_LINE: Srgba = Srgba::opaque(0, 130, 40);
/// See [`SEEN_LINE`].
pub const HIDDEN_LINE: Srgba = Srgba::opaque(200, 16, 24);

/// The color of a graphic's lines: dark enough to be read on the lightest ground, and light enough to differ from
/// black.
pub fn graphic_color(side: GraphicSide, tint: GraphicTint) -> Srgba {
    match tint {
        GraphicTint::Obstacle => OBSTACLE,
        GraphicTint::Own => side_color(side),
        GraphicTint::Fixed([red, green, blue]) | GraphicTint::Pair([red, green, blue], _) => {
            legible(red, green, blue)
        }
    }
}

/// The color of the lines of the other side of a graphic.
pub fn opposing_color(side: GraphicSide, tint: GraphicTint) -> Srgba {
    match tint {
        GraphicTint::Pair(_, [red, green, blue]) => legible(red, green, blue),
        _ => graphic_color(opposing(side), tint),
    }
}

/// The color of an area that the ground shows through.
pub fn ground_color([red, green, blue]: [u8; 3]) -> Srgba {
    Srgba([red, green, blue, GROUND_ALPHA])
}

/// A color of the standard as a line: darker where it is too light to be seen on a light ground.
fn legible(red: u8, green: u8, blue: u8) -> Srgba {
    /// The luminance of 255 above which lines fade.
    const LIGHT: u32 = 140;
    let luminance = (2126 * u32::from(red) + 7152 * u32::from(green) + 722 * u32::from(blue)) / 10_000;
    let scaled =
        |part: u8| if luminance > LIGHT { (u32::from(part) * LIGHT / luminance) as u8 } else { part };
    Srgba::opaque(scaled(red), scaled(green), scaled(blue))
}

/// The color of a side's lines.
pub fn side_color(side: GraphicSide) -> Srgba {
    match side {
        GraphicSide::Friend => Srgba::opaque(8, 40, 140),
        GraphicSide::Hostile => Srgba::opaque(190, 10, 20),
        GraphicSide::Neutral => Srgba::opaque(20, 110, 30),
        GraphicSide::Unknown => Srgba::opaque(150, 110, 0),
    }
}

/// The color of the lines of the side opposite.
pub fn opposing(side: GraphicSide) -> GraphicSide {
    match side {
        GraphicSide::Hostile => GraphicSide::Friend,
        _ => GraphicSide::Hostile,
    }
}

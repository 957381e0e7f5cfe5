//! Colors of tactical graphics and of layers of sight.

use sandtable_description::words::GraphicSide;
use sandtable_draw::color::Srgba;
use sandtable_symbology::graphic::kind::GraphicTint;

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
    }
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

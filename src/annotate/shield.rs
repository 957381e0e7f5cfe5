//! Shields of road numbers.

use tiny_skia::{Path, PathBuilder};

use crate::drawing::Drawing;
use crate::pixel_box::PixelBox;
use crate::sheet::Sheet;
use sandtable_description::words::RoadShield;
use sandtable_draw::color::Srgba;

/// Around the letters, design pixels: beside them, and above and below.
pub const PADDING: [f32; 2] = [5.0, 3.5];
/// The radius of the corners and the width of the edge, design pixels.
const CORNER: f32 = 4.5;
const EDGE: f32 = 1.4;

const WHITE: Srgba = Srgba::opaque(0xff, 0xff, 0xff);
const BLACK: Srgba = Srgba::opaque(0x1b, 0x1b, 0x1b);

/// The colors of shields: their ground, and that of their letters and edge.
pub const fn colors(shield: RoadShield) -> [Srgba; 2] {
    match shield {
        RoadShield::Motorway => [Srgba::opaque(0x24, 0x57, 0xa4), WHITE],
        RoadShield::National => [Srgba::opaque(0xb3, 0x2b, 0x26), WHITE],
        RoadShield::Regional => [Srgba::opaque(0xf5, 0xd5, 0x4c), BLACK],
        RoadShield::Local => [WHITE, BLACK],
    }
}

/// Draws a shield over `area`, its edge within it.
pub fn draw(shield: RoadShield, area: PixelBox, sheet: &Sheet, drawing: &mut Drawing) {
    let [ground, edge] = colors(shield);
    let (corner, width) = (sheet.px(CORNER), sheet.px(EDGE).max(1.0));
    // A dark line around a white edge keeps it off a bright ground.
    let outer = if edge == WHITE { ground } else { edge };
    for (inset, color) in [(0.0, outer), (width * 0.8, WHITE), (width * 1.8, ground)] {
        let path = rounded(area.grown(-inset), (corner - inset).max(0.5));
        path.into_iter().for_each(|path| drawing.fill(path, color));
    }
}

/// A box with round corners; `None` where it is smaller than these.
fn rounded(area: PixelBox, radius: f32) -> Option<Path> {
    let (min, max) = (area.min, area.max);
    if (max - min).min_element() < radius * 2.0 {
        return None;
    }
    let (near, far) = (min + radius, max - radius);
    let mut path = PathBuilder::new();
    path.move_to(near.x, min.y);
    path.line_to(far.x, min.y);
    path.quad_to(max.x, min.y, max.x, near.y);
    path.line_to(max.x, far.y);
    path.quad_to(max.x, max.y, far.x, max.y);
    path.line_to(near.x, max.y);
    path.quad_to(min.x, max.y, min.x, far.y);
    path.line_to(min.x, near.y);
    path.quad_to(min.x, min.y, near.x, min.y);
    path.close();
    path.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halo::worst_contrast;
    use glam::Vec2;
    use sandtable_base::message::choice::Choice;

    #[test]
    fn numbers_stand_out_of_their_shields() {
        for shield in RoadShield::CHOICES {
            let [ground, letters] = colors(shield.value);
            assert!(worst_contrast(ground, letters) >= 4.5, "{shield:?}", shield = shield.word);
        }
    }

    #[test]
    fn a_shield_stays_in_its_box() {
        let area = PixelBox::at(Vec2::new(10.0, 20.0), Vec2::new(40.0, 18.0));
        let bounds = rounded(area, 4.0).expect("large enough").bounds();
        assert!((bounds.left() - 10.0).abs() < 0.01 && (bounds.right() - 50.0).abs() < 0.01, "{bounds:?}");
        assert!((bounds.top() - 20.0).abs() < 0.01 && (bounds.bottom() - 38.0).abs() < 0.01, "{bounds:?}");
        assert!(rounded(area, 10.0).is_none());
    }
}

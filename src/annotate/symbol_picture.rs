//! A picture of one military symbol with the text round it, on nothing.

use glam::Vec2;

use crate::canvas::paint;
use crate::composer::Composer;
use crate::pixel_box::PixelBox;
use crate::symbol_drawing::{draw_texts, symbol_marks};
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;
use sandtable_symbology::labeled::LabeledSymbol;

/// Least and greatest height of the frame of a friendly unit, in pixels: below, icons cannot be told apart; above, a picture
/// with long texts takes hundreds of megabytes.
pub const FRAME_PX: [f32; 2] = [8.0, 1000.0];
/// Round all, in units of the symbol's box: half the widest line, and a little.
const MARGIN: f32 = 4.0;
/// The picture that texts and halos are designed for; the symbol's own size scales it.
const DESIGN_SIZE: (u32, u32) = (1920, 1080);

/// The symbol with its texts, the frame of a friendly unit `frame_px` high, within [`FRAME_PX`]; transparent where nothing is
/// drawn.
pub fn symbol_picture(labeled: &LabeledSymbol, frame_px: f32) -> Pixels {
    let unit_px = frame_px.clamp(FRAME_PX[0], FRAME_PX[1]) / 100.0;
    let mut composer = Composer::new(DESIGN_SIZE.0, DESIGN_SIZE.1);
    let symbol = &labeled.symbol;
    let texts = draw_texts(symbol, &labeled.texts, unit_px, &mut composer);
    let marks = symbol_marks(symbol, unit_px, None, &mut composer);
    let pixels = |at: Vec2| (at - Vec2::splat(100.0)) * unit_px;
    let area = PixelBox { min: pixels(symbol.bounds.min), max: pixels(symbol.bounds.max) };
    let mut bounds = area.grown(MARGIN * unit_px);
    if !labeled.texts.is_empty() {
        bounds = bounds.union(texts.bounds());
    }
    // The middle of the symbol is on a corner of pixels, so that its lines are equally sharp on both sides.
    let (min, max) = (bounds.min.floor(), bounds.max.ceil());
    let size = (max - min).max(Vec2::ONE).as_uvec2();
    let mut picture = Pixels::filled(size.x, size.y, Srgba([255, 255, 255, 0]));
    paint(&mut picture, [&texts.moved(-min), &marks.moved(-min)]);
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_symbol_lies_on_nothing_and_text_makes_the_picture_wider() {
        let picture = |fields: &[(&str, &str)]| {
            symbol_picture(&LabeledSymbol::new("10031000001211000000", fields).expect("a symbol"), 100.0)
        };
        let bare = picture(&[]);
        assert_eq!((bare.width(), bare.height()), (158, 108));
        assert_eq!(bare.at(0, 0).0[3], 0);
        assert_eq!(bare.at(79, 20), Srgba::opaque(128, 224, 255));
        assert_eq!(bare.at(79, 54), Srgba::opaque(0, 0, 0));
        let named = picture(&[("unique_designation", "1-12"), ("headquarters_element", "CP")]);
        assert!(named.width() > bare.width() + 60 && named.height() > bare.height() + 20);
    }
}

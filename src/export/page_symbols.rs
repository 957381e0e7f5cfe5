//! Military symbols as pictures of their own, for pages that place them.

use glam::Vec2;

use crate::page::PageSymbol;
use sandtable_annotate::annotation::{Annotations, PictureSymbol, SymbolHeight};
use sandtable_annotate::paint::annotate;
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;
use sandtable_scene::military::{SceneSymbol, SymbolSize};
use sandtable_scene::scene_model::SceneModel;

/// The picture that a symbol is painted on, 1080 pixels high as its design is, and its place on the ground there.
const SIZE_PX: (u32, u32) = (900, 1080);
const PLACE_PX: Vec2 = Vec2::new(450.0, 800.0);

/// The height of symbols whose size is stated in meters on the ground, in pixels.
const HEIGHT_PX: f32 = 44.0;

/// The symbols of a scene, each standing over its place. Arrows of movement are left out: a page turns.
pub fn symbol_pictures(scene: &SceneModel) -> Vec<PageSymbol> {
    scene.military.iter().filter_map(|symbol| symbol_picture(scene, symbol)).collect()
}

/// One symbol, standing over its place; `None` of one that draws nothing.
pub fn symbol_picture(scene: &SceneModel, symbol: &SceneSymbol) -> Option<PageSymbol> {
    let [on_white, on_black] =
        [Srgba::WHITE, Srgba::opaque(0, 0, 0)].map(|paper| painted(scene, symbol, paper));
    let seen = |x: u32, y: u32| unpainted(on_white.at(x, y), on_black.at(x, y));
    let is_seen = |&(x, y): &(u32, u32)| seen(x, y).0[3] > 0;
    let places = || (0..SIZE_PX.1).flat_map(|y| (0..SIZE_PX.0).map(move |x| (x, y))).filter(is_seen);
    let low = places().reduce(|a, b| (a.0.min(b.0), a.1.min(b.1)))?;
    let high = places().reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)))?;
    let pixels = Pixels::from_fn(high.0 - low.0 + 1, high.1 - low.1 + 1, |x, y| seen(x + low.0, y + low.1));
    let anchor_px = PLACE_PX - Vec2::new(low.0 as f32, low.1 as f32);
    Some(PageSymbol {
        name: symbol.name.clone(),
        ground: symbol.ground,
        pixels,
        anchor_px,
        rank: symbol.rank,
    })
}

fn painted(scene: &SceneModel, symbol: &SceneSymbol, paper: Srgba) -> Pixels {
    let height = match symbol.size {
        SymbolSize::Design(height) => SymbolHeight::Design(height),
        SymbolSize::Ground(_) => SymbolHeight::Design(HEIGHT_PX),
    };
    let symbols = vec![PictureSymbol {
        symbol: symbol.symbol.clone(),
        texts: symbol.texts.clone(),
        name: symbol.name.clone(),
        reference: None,
        anchor_px: PLACE_PX,
        direction_px: None,
        depth_m: 1.0,
        visible: true,
        is_on_map: false,
        rank: symbol.rank,
        height,
    }];
    let mut pixels = Pixels::filled(SIZE_PX.0, SIZE_PX.1, paper);
    annotate(&mut pixels, &Annotations { symbols, font: scene.font.clone(), ..Annotations::default() });
    pixels
}

/// What was painted on white and on black, with its alpha.
fn unpainted(Srgba(on_white): Srgba, Srgba(on_black): Srgba) -> Srgba {
    let through =
        (0..3).map(|channel| on_white[channel].saturating_sub(on_black[channel])).max().unwrap_or(0);
    let alpha = 255 - through;
    if alpha == 0 {
        return Srgba([0; 4]);
    }
    let [red, green, blue] =
        [0, 1, 2].map(|channel| (u32::from(on_black[channel]) * 255 / u32::from(alpha)).min(255) as u8);
    Srgba([red, green, blue, alpha])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paint_on_white_and_on_black_gives_its_color_and_its_alpha() {
        let [none, red] = [Srgba([0; 4]), Srgba::opaque(200, 30, 10)];
        assert_eq!(unpainted(Srgba::WHITE, Srgba::opaque(0, 0, 0)), none);
        assert_eq!(unpainted(red, red), red);
        let Srgba([red, green, blue, alpha]) =
            unpainted(Srgba::opaque(227, 142, 132), Srgba::opaque(100, 15, 5));
        assert!(
            alpha.abs_diff(128) <= 1
                && red.abs_diff(199) <= 2
                && green.abs_diff(30) <= 2
                && blue.abs_diff(10) <= 2
        );
    }
}

//! The military symbols of a scene over its view: each drawn once, as on a picture, and moved with its place.
//!
//! A symbol's picture is painted on white and on black: what differs between the two is what shows through it.

use egui::{Color32, ColorImage, Context, Painter, Rect, TextureHandle, TextureOptions, pos2, vec2};
use glam::{UVec2, Vec2};

use crate::opened::OpenedScene;
use crate::window_point::window_point;
use sandtable_annotate::annotation::{Annotations, PictureSymbol, SymbolHeight};
use sandtable_annotate::paint::annotate;
use sandtable_draw::color::Srgba;
use sandtable_draw::font::FontFile;
use sandtable_draw::pixels::Pixels;
use sandtable_scene::military::SceneSymbol;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

/// The height of the frame of a friendly unit, in points.
const FRAME_HEIGHT: f32 = 30.0;
/// The room that a symbol is painted in, in heights of a frame: texts stand beside it.
const ROOM: Vec2 = Vec2::new(12.0, 6.0);
/// The symbols painted in a frame: each takes some milliseconds.
const PAINTED_AT_ONCE: usize = 2;
/// The most symbols painted: their pictures are kept.
const MOST_PAINTED: usize = 512;

/// A symbol's picture.
#[derive(Clone, Debug, PartialEq)]
pub struct SymbolPicture {
    /// Pixels across and down.
    pub size: UVec2,
    /// Row by row from the top, multiplied with their alpha.
    pub pixels: Vec<[u8; 4]>,
    /// The place on the ground, in pixels from the upper left corner.
    pub anchor: Vec2,
}

impl SymbolPicture {
    /// The picture of a symbol whose frame is `height` pixels high; `None` of one that draws nothing.
    pub fn new(symbol: &SceneSymbol, height: f32, font: Option<&FontFile>) -> Option<Self> {
        let room = (ROOM * height).as_uvec2();
        let anchor = Vec2::new(room.x as f32 * 0.5, room.y as f32 * 0.85).floor();
        let [on_white, on_black] = [255, 0].map(|gray| {
            let mut pixels = Pixels::filled(room.x, room.y, Srgba::opaque(gray, gray, gray));
            let symbols = vec![PictureSymbol {
                symbol: symbol.symbol.clone(),
                texts: symbol.texts.clone(),
                name: symbol.name.clone(),
                reference: None,
                anchor_px: anchor,
                direction_px: None,
                depth_m: 1.0,
                visible: true,
                is_on_map: false,
                rank: symbol.rank,
                height: SymbolHeight::Pixels(height),
            }];
            annotate(&mut pixels, &Annotations { symbols, font: font.cloned(), ..Annotations::default() });
            pixels
        });
        let shows = |(white, black): (&Srgba, &Srgba)| {
            let alpha = 255
                - (0..3).map(|channel| white.0[channel].saturating_sub(black.0[channel])).max().unwrap_or(0);
            [black.0[0].min(alpha), black.0[1].min(alpha), black.0[2].min(alpha), alpha]
        };
        let pixels: Vec<[u8; 4]> = on_white.data().iter().zip(on_black.data()).map(shows).collect();
        Self { size: room, pixels, anchor }.trimmed()
    }

    /// The same without its empty border.
    fn trimmed(self) -> Option<Self> {
        let width = self.size.x as usize;
        let filled = self.pixels.iter().enumerate().filter(|(_, pixel)| pixel[3] > 0);
        let places = filled.map(|(index, _)| UVec2::new((index % width) as u32, (index / width) as u32));
        let (min, max) = places.fold(None, |found: Option<(UVec2, UVec2)>, at| {
            Some(found.map_or((at, at), |(min, max)| (min.min(at), max.max(at))))
        })?;
        let row =
            |y: u32| &self.pixels[y as usize * width + min.x as usize..=y as usize * width + max.x as usize];
        let pixels = (min.y..=max.y).flat_map(|y| row(y).iter().copied()).collect();
        Some(Self { size: max - min + 1, pixels, anchor: self.anchor - min.as_vec2() })
    }
}

/// The pictures of a scene's symbols, by their numbers.
#[derive(Default)]
pub struct SymbolLayer {
    pictures: Vec<Option<SymbolTexture>>,
    shown: Vec<bool>,
}

struct SymbolTexture {
    texture: TextureHandle,
    size: egui::Vec2,
    anchor: egui::Vec2,
}

impl SymbolLayer {
    /// Forgets the symbols of a scene before.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Draws the symbols in sight, the important first, each where no other is; returns where they are.
    pub fn show(
        &mut self,
        painter: &Painter,
        rect: Rect,
        opened: &OpenedScene,
        camera: &Camera,
    ) -> Vec<Rect> {
        let symbols = &opened.scene.military;
        self.paint_some(painter.ctx(), &opened.scene);
        let mut order: Vec<usize> = (0..self.pictures.len()).collect();
        let rank = |index: usize| symbols[index].rank - if self.shown[index] { 0.5 } else { 0.0 };
        order.sort_by(|a, b| rank(*a).total_cmp(&rank(*b)).then(a.cmp(b)));
        let mut taken: Vec<Rect> = Vec::new();
        for index in order {
            let place = self.pictures[index].as_ref().and_then(|picture| {
                let (at, _) = window_point(camera, rect, symbols[index].ground)?;
                if !rect.contains(at) {
                    return None;
                }
                let place = Rect::from_min_size(at - picture.anchor, picture.size);
                let has_room = !taken.iter().any(|other| other.intersects(place));
                (has_room && opened.is_seen(camera, symbols[index].ground)).then_some((place, picture))
            });
            self.shown[index] = place.is_some();
            if let Some((place, picture)) = place {
                let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                painter.image(picture.texture.id(), place, whole, Color32::WHITE);
                taken.push(place);
            }
        }
        taken
    }

    /// Paints the next symbols that have no picture yet.
    fn paint_some(&mut self, context: &Context, scene: &SceneModel) {
        let scale = context.pixels_per_point();
        let missing = scene.military.iter().take(MOST_PAINTED).enumerate().skip(self.pictures.len());
        for (index, symbol) in missing.take(PAINTED_AT_ONCE) {
            let picture = SymbolPicture::new(symbol, FRAME_HEIGHT * scale, scene.font.as_ref());
            self.shown.push(false);
            self.pictures.push(picture.map(|picture| {
                let SymbolPicture { size, pixels, anchor } = picture;
                let color = |&[red, green, blue, alpha]: &[u8; 4]| {
                    Color32::from_rgba_premultiplied(red, green, blue, alpha)
                };
                let pixels = pixels.iter().map(color).collect();
                let image = ColorImage::new([size.x as usize, size.y as usize], pixels);
                let texture = context.load_texture(format!("symbol {index}"), image, TextureOptions::LINEAR);
                let points = |pixels: Vec2| vec2(pixels.x / scale, pixels.y / scale);
                SymbolTexture { texture, size: points(size.as_vec2()), anchor: points(anchor) }
            }));
            context.request_repaint();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_editing::viewing::open_to_view;
    use std::path::Path;

    #[test]
    fn a_symbol_is_opaque_inside_and_clear_outside_and_stands_over_its_place() {
        let editor = open_to_view(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/symbols.toml")), &[])
            .expect("readable");
        let scene = editor.source().build(&|_| ()).expect("sound");
        let picture = SymbolPicture::new(&scene.military[0], 40.0, None).expect("drawn");
        let at = |x: u32, y: u32| picture.pixels[(y * picture.size.x + x) as usize];
        assert_eq!(picture.pixels.len(), (picture.size.x * picture.size.y) as usize);
        assert!(picture.anchor.y > picture.size.y as f32 * 0.6, "{:?} of {}", picture.anchor, picture.size);
        let opaque = picture.pixels.iter().filter(|pixel| pixel[3] == 255).count();
        assert!(opaque > 400, "{opaque} opaque pixels");
        assert!(
            (0..picture.size.x).any(|x| at(x, 0)[3] < 255)
                && picture.pixels.iter().any(|pixel| pixel[3] == 0)
        );
        assert!(picture.pixels.iter().all(|pixel| pixel[..3].iter().all(|channel| *channel <= pixel[3])));
    }
}

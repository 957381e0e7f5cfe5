//! A picture that is put together from its tiles.

use crate::tiles::PictureTile;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_draw::pixels::Pixels;
use sandtable_render::picture::Rendering;

/// The tiles of a picture so far.
pub struct TiledPicture {
    size: (u32, u32),
    drawn: DrawnPart,
}

/// The part of a picture that is drawn.
enum DrawnPart {
    Nothing,
    /// One tile, which is the whole picture.
    Whole(Rendering),
    /// Some tiles; pixels of others are those of nothing.
    Tiles {
        pixels: Vec<Srgba>,
        depth_m: Vec<f32>,
        features: Vec<FeatureId>,
    },
}

impl TiledPicture {
    /// A picture of a size, without tiles.
    pub fn new(size: (u32, u32)) -> Self {
        Self { size, drawn: DrawnPart::Nothing }
    }

    /// Adds a tile; what lies beyond the picture is dropped.
    pub fn add(&mut self, tile: PictureTile, drawn: Rendering) {
        if tile.size == self.size {
            self.drawn = DrawnPart::Whole(drawn);
            return;
        }
        let [width, height] = [self.size.0, self.size.1].map(|side| side as usize);
        if !matches!(self.drawn, DrawnPart::Tiles { .. }) {
            let count = width * height;
            self.drawn = DrawnPart::Tiles {
                pixels: vec![Srgba::opaque(0, 0, 0); count],
                depth_m: vec![f32::INFINITY; count],
                features: vec![FeatureId::NONE; count],
            };
        }
        let DrawnPart::Tiles { pixels, depth_m, features } = &mut self.drawn else { return };
        let ([x, y], columns) = (tile.first.map(|first| first as usize), tile.size.0 as usize);
        let shown = columns.min(width.saturating_sub(x));
        let colors = drawn.pixels.data();
        for row in 0..(tile.size.1 as usize).min(height.saturating_sub(y)) {
            let (from, to) = (row * columns, (y + row) * width + x);
            pixels[to..to + shown].copy_from_slice(&colors[from..from + shown]);
            depth_m[to..to + shown].copy_from_slice(&drawn.depth_m[from..from + shown]);
            features[to..to + shown].copy_from_slice(&drawn.features[from..from + shown]);
        }
    }

    /// The picture; `None` before there is a tile.
    pub fn whole(self) -> Option<Rendering> {
        match self.drawn {
            DrawnPart::Nothing => None,
            DrawnPart::Whole(drawn) => Some(drawn),
            DrawnPart::Tiles { pixels, depth_m, features } => {
                let pixels = Pixels::from_data(self.size.0, self.size.1, pixels)?;
                Some(Rendering { pixels, depth_m, features })
            }
        }
    }
}

//! Military symbols over each other at one place, on one staff: where they may stand, and their drawing.

use glam::Vec2;
use tiny_skia::{Stroke, StrokeDash};

use crate::annotation::PictureSymbol;
use crate::composer::Composer;
use crate::drawing::{Drawing, polygon, polyline};
use crate::halo::Halo;
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::sheet::{HALO, Sheet};
use crate::symbol_drawing::SymbolBlock;
use sandtable_draw::color::Srgba;

/// The staff's length, in heights of a friendly unit's frame, in the order of preference.
const STAFF_LENGTHS: [f32; 7] = [0.45, 1.1, 1.9, 2.8, 3.8, 5.0, 6.5];
/// How far aside of its place a symbol may stand, in widths of its block.
const ASIDE: [f32; 11] = [0.0, 0.55, -0.55, 1.1, -1.1, 1.7, -1.7, 2.4, -2.4, 3.2, -3.2];
/// Between symbols of a stack, in units of the symbol's box.
const STACK_GAP: f32 = 6.0;
/// The arrow of movement, in heights of a frame.
const ARROW_LENGTH: f32 = 1.1;

const BLACK: Srgba = Srgba::opaque(0, 0, 0);

/// Whether a symbol stands on its own staff, as a headquarters does.
pub(crate) fn has_own_staff(symbol: &PictureSymbol) -> bool {
    symbol.symbol.anchor != Vec2::splat(100.0)
}

/// Symbols over each other, the first at the bottom.
pub(crate) struct PreparedStack<'a> {
    pub symbols: Vec<&'a PictureSymbol>,
    /// With the middle of each, from the stack's foot.
    blocks: Vec<(SymbolBlock, Vec2)>,
    /// Of the first symbol.
    anchor: Vec2,
    frame_px: f32,
    pub is_visible: bool,
}

/// What stands on the picture for a place: its boxes, from the foot.
pub(crate) struct Standing {
    /// The place, pixels.
    pub anchor: Vec2,
    /// What must not be covered.
    pub boxes: Vec<PixelBox>,
    /// What its leader leads to.
    pub face: PixelBox,
    /// Whether the leader ends at the foot instead.
    pub ends_at_foot: bool,
    /// Whether it may lie over its own place.
    pub may_cover_anchor: bool,
}

impl Standing {
    /// The box around all of it, from the foot.
    pub fn bounds(&self) -> PixelBox {
        self.boxes.iter().copied().fold(PixelBox::EMPTY, PixelBox::union)
    }

    /// The position with the foot at `foot`, its leader to the middle of its face, which covers the leader's end; `None` where
    /// it would cover its own place and may not.
    pub fn at(&self, foot: Vec2) -> Option<StackPosition> {
        let face = self.face.moved(foot);
        if face.contains(self.anchor) {
            return self.may_cover_anchor.then_some(StackPosition { foot, staff: None });
        }
        let to = if self.ends_at_foot { foot } else { face.center() };
        Some(StackPosition { foot, staff: Some(PixelSegment { from: self.anchor, to }) })
    }
}

/// Where a stack stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StackPosition {
    /// The stack's foot.
    pub foot: Vec2,
    /// From the place to the foot.
    pub staff: Option<PixelSegment>,
}

impl<'a> PreparedStack<'a> {
    /// The stack at a share of its size, with or without the texts round its symbols.
    pub fn new(
        symbols: &[&'a PictureSymbol],
        (scale, has_texts): (f32, bool),
        composer: &mut Composer,
    ) -> Self {
        let mut blocks: Vec<(SymbolBlock, Vec2)> = Vec::new();
        for symbol in symbols {
            let texts = if has_texts { symbol.texts.as_slice() } else { &[] };
            let block = SymbolBlock::new(symbol, texts, scale, composer);
            let at = match blocks.last() {
                Some((below, at)) => {
                    let top = at.y + below.bounds.min.y - STACK_GAP * block.unit_px;
                    Vec2::new(at.x, top - block.bounds.max.y)
                }
                None if has_own_staff(symbol) => -block.anchor,
                None => Vec2::new(0.0, -block.symbol.max.y),
            };
            blocks.push((block, at));
        }
        Self {
            symbols: symbols.to_vec(),
            anchor: symbols[0].anchor_px,
            frame_px: symbols[0].height.pixels(&composer.sheet) * scale,
            is_visible: symbols.iter().all(|symbol| symbol.visible),
            blocks,
        }
    }

    pub fn names(&self) -> impl Iterator<Item = String> {
        self.symbols.iter().map(|symbol| symbol.name.clone())
    }

    /// How it stands wherever it is, for a search over the whole picture.
    pub fn standing(&self) -> Standing {
        let boxes: Vec<PixelBox> = self.blocks.iter().map(|(block, at)| block.bounds.moved(*at)).collect();
        let faces = self.blocks.iter().map(|(block, at)| block.symbol.moved(*at));
        Standing {
            anchor: self.anchor,
            boxes,
            face: faces.fold(PixelBox::EMPTY, PixelBox::union),
            ends_at_foot: has_own_staff(self.symbols[0]),
            may_cover_anchor: self.symbols[0].is_on_map,
        }
    }

    /// The positions near its place, the best first.
    pub fn positions(&self) -> impl Iterator<Item = StackPosition> {
        let (anchor, frame) = (self.anchor, self.frame_px);
        let own_staff = has_own_staff(self.symbols[0]);
        let center = self.blocks[0].1;
        let moves = self.symbols.iter().any(|symbol| symbol.direction_px.is_some());
        let first = if own_staff {
            Some(StackPosition { foot: anchor, staff: None })
        } else {
            // On a map a symbol's middle is at its place.
            let on_place = self.symbols[0].is_on_map && self.symbols.len() == 1 && !moves;
            on_place.then(|| StackPosition { foot: anchor - center, staff: None })
        };
        let width = self.blocks.iter().map(|(block, _)| block.symbol.size().x).fold(0.0, f32::max);
        let aside = STAFF_LENGTHS.into_iter().flat_map(move |length| {
            ASIDE.into_iter().map(move |aside| {
                let foot = (anchor + Vec2::new(aside * width, -length * frame)).round();
                StackPosition { foot, staff: Some(PixelSegment { from: anchor, to: foot }) }
            })
        });
        first.into_iter().chain(aside)
    }

    /// From the place to where the symbols move.
    pub fn arrows(&self) -> impl Iterator<Item = PixelSegment> {
        let reach = self.frame_px * ARROW_LENGTH;
        let directions = self.symbols.iter().filter_map(|symbol| symbol.direction_px);
        directions
            .map(move |direction| PixelSegment { from: self.anchor, to: self.anchor + direction * reach })
    }

    pub fn boxes(&self, position: &StackPosition) -> impl Iterator<Item = PixelBox> {
        let foot = position.foot;
        self.blocks.iter().map(move |(block, at)| block.bounds.moved(foot + *at))
    }

    pub fn draw_faces(&self, position: &StackPosition, drawing: &mut Drawing) {
        for (block, at) in &self.blocks {
            drawing.append(block.drawing.clone().moved(position.foot + *at));
        }
    }

    /// The staff with its foot, and arrows of movement.
    pub fn draw_staff(&self, position: &StackPosition, sheet: &Sheet, drawing: &mut Drawing) {
        let width = sheet.px(1.6).max(1.1);
        let halo = width + sheet.px(2.4).max(1.6);
        self.arrows().for_each(|arrow| draw_arrow(arrow, sheet, drawing));
        if let Some(staff) = position.staff {
            drawing.line(staff, halo, HALO);
            if self.is_visible {
                drawing.line(staff, width, BLACK);
            } else {
                draw_dashes(staff, width, sheet, drawing);
            }
        }
        let (anchor, radius) = (self.anchor, sheet.px(3.0).max(2.0));
        if !self.is_visible {
            drawing.disc(anchor, radius + width + sheet.px(1.2), HALO);
            drawing.disc(anchor, radius + width * 0.5, BLACK);
            drawing.disc(anchor, radius - width * 0.5, Srgba::opaque(255, 255, 255));
        } else if position.staff.is_some() {
            drawing.disc(anchor, radius + sheet.px(1.2), HALO);
            drawing.disc(anchor, radius, BLACK);
        }
    }
}

/// An arrow along a line, with its head at the line's end.
fn draw_arrow(arrow: PixelSegment, sheet: &Sheet, drawing: &mut Drawing) {
    let PixelSegment { from, to } = arrow;
    let reach = to - from;
    let along = reach.normalize_or_zero();
    let (head, width) = (reach.length() * 0.32, sheet.px(2.2).max(1.4));
    let line = PixelSegment { from, to: to - along * head };
    let corners =
        [to, to - along * head + along.perp() * head * 0.42, to - along * head - along.perp() * head * 0.42];
    let halo = sheet.px(1.6).max(1.0);
    drawing.line(line, width + 2.0 * halo, HALO);
    if let Some(triangle) = polygon(&corners) {
        drawing.line(line, width, BLACK);
        drawing.fill_haloed(triangle, BLACK, Halo::paper(halo));
        drawing.line(line, width, BLACK);
    }
}

fn draw_dashes(line: PixelSegment, width: f32, sheet: &Sheet, drawing: &mut Drawing) {
    let lengths = vec![sheet.px(5.0).max(3.0), sheet.px(3.5).max(2.0)];
    let dashed = StrokeDash::new(lengths, 0.0).zip(polyline(&[line.from, line.to]));
    let dashes = dashed.and_then(|(dash, path)| path.dash(&dash, 1.0));
    let outline = dashes.and_then(|path| path.stroke(&Stroke { width, ..Stroke::default() }, 1.0));
    if let Some(outline) = outline {
        drawing.fill(outline, BLACK);
    }
}

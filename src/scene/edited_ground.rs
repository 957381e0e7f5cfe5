//! The ground of a scene while a user digs in it: earthworks done one after the other, and taken back.
//!
//! Earthworks move true heights; what is shown are drawn ones ([`crate::scene::vertical_scale`]). So this keeps the true
//! ground and gives the drawn one the changes:
//!
//! ```text
//!  works ─► true ground, volumes ─► changes ─► the same posts of the drawn ground, times the exaggeration
//! ```
//!
//! The heights equal, bit for bit, those of the scene built with the same works in its file.

use std::sync::Arc;

use crate::earthworks::brush::{BrushChanges, Change, set_heights};
use crate::earthworks::earthwork::Earthwork;
use crate::earthworks::held_posts::HeldPosts;
use crate::scene::SceneModel;
use crate::scene::vertical_scale::VerticalScale;
use crate::terrain::lattice::Lattice;
use crate::terrain::post_rect::PostRect;
use crate::terrain::volumes::Volumes;

/// The true ground of a scene with the earthworks of a user.
#[derive(Clone, Debug)]
pub struct EditedGround {
    lattice: Arc<Lattice>,
    held: Arc<HeldPosts>,
    scale: VerticalScale,
    /// The changes of each digging, in order, with the heights before.
    done: Vec<BrushChanges>,
}

/// The posts that a digging, or taking it back, changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DugGround {
    /// Rectangles around them; those of several works may overlap.
    pub rects: Vec<PostRect>,
    /// Earth cut and filled by each work after the other; none where it was taken back.
    pub volumes: Volumes,
    /// Area of the posts that each work changed, square meters.
    pub area_m2: f64,
}

impl EditedGround {
    /// The ground of `scene`; its heights are copied at the first change.
    pub fn new(scene: &SceneModel) -> Self {
        Self {
            lattice: Arc::clone(&scene.lattice),
            held: Arc::clone(&scene.held),
            scale: scene.scale,
            done: Vec::new(),
        }
    }

    /// The elevations now, meters, true to scale.
    pub fn lattice(&self) -> &Arc<Lattice> {
        &self.lattice
    }

    /// How many diggings can be taken back.
    pub fn count(&self) -> usize {
        self.done.len()
    }

    /// Does some works, one digging.
    pub fn dig(&mut self, works: &[Earthwork]) -> DugGround {
        let lattice = Arc::make_mut(&mut self.lattice);
        let (mut all, mut area_m2) = (BrushChanges::default(), 0.0);
        for work in works {
            let changes = work.apply(lattice, &self.held);
            area_m2 += changes.area_m2(lattice);
            all = all.and(changes);
        }
        let dug = DugGround { rects: rects(&all), volumes: all.volumes, area_m2 };
        self.done.push(all);
        dug
    }

    /// Takes the last digging back; `None` where there is none.
    pub fn take_back(&mut self) -> Option<DugGround> {
        let last = self.done.pop()?;
        let lattice = Arc::make_mut(&mut self.lattice);
        // The last first: pieces of several works may overlap.
        for Change { posts, before } in last.pieces.iter().rev() {
            set_heights(lattice, *posts, before);
        }
        Some(DugGround { rects: rects(&last), ..DugGround::default() })
    }

    /// What `works` would move: they are done, and taken back.
    pub fn foreseen(&mut self, works: &[Earthwork]) -> DugGround {
        let dug = self.dig(works);
        self.take_back();
        dug
    }

    /// Gives the posts of `dug` on the drawn ground their heights; for [`crate::roam::dynamic::DynamicTerrain::edit`].
    pub fn draw(&self, dug: &DugGround, drawn: &mut Lattice) -> BrushChanges {
        let draw_rect = |changes: BrushChanges, rect: &PostRect| {
            let heights: Vec<f32> =
                rect.posts().map(|post| self.scale.world_z(self.lattice.height(post))).collect();
            changes.and(set_heights(drawn, *rect, &heights))
        };
        dug.rects.iter().fold(BrushChanges::default(), draw_rect)
    }
}

fn rects(changes: &BrushChanges) -> Vec<PostRect> {
    changes.pieces.iter().map(|piece| piece.posts).collect()
}

//! Edits of the ground while it is shown: data that depends on it is updated, not rebuilt.

use crate::Walk;
use crate::frame::WalkError;
use sandtable_draw::patches::PatchId;
use sandtable_earthworks::brush::{BrushChanges, Change, set_heights};
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::sight::ground::SightGround;
use sandtable_terrain::volumes::Volumes;

/// How far beside the ground that an edit changed something may stand that leans on it, in meters: half of a large building.
const LEANING_M: f64 = 50.0;

/// The effects of an edit.
#[derive(Clone, Debug, PartialEq)]
pub struct WalkEdit {
    /// The number of the edit, counted from 1.
    pub number: u64,
    /// The patches whose look changed; the next update hands them over if they are in view.
    pub patches: Vec<PatchId>,
    /// The rectangles of posts that changed, with their former elevations: all that taking the edit back needs.
    pub pieces: Vec<Change>,
    /// The earth moved, true to scale.
    pub volumes: Volumes,
    /// Whether solids or models stand there, so that lists of [`Walk::static_list`] are outdated.
    pub moves_standing: bool,
}

impl Walk {
    /// Lets `brush` change the elevations, true to scale, and updates the data that depends on them; the next update
    /// hands over the changes. `None` where it changed nothing.
    ///
    /// `brush` must return all its changes in the order in which it made them, and may not pin posts.
    ///
    /// # Errors
    /// A patch cannot be read.
    pub fn edit(
        &mut self,
        brush: impl FnOnce(&mut Lattice) -> BrushChanges,
    ) -> Result<Option<WalkEdit>, WalkError> {
        // What holds the heights would make the edit a copy of them.
        let pyramid = self.sight.take().map(SightGround::release);
        let (mut made, scale) = (BrushChanges::default(), self.scene.scale);
        let edit = match &mut self.elevations {
            None => self.mesh.source_mut().edit(|lattice| {
                made = brush(lattice);
                made.clone()
            }),
            Some(elevations) => {
                let elevations = std::sync::Arc::make_mut(elevations);
                made = brush(elevations);
                let drawn = |lattice: &mut Lattice| {
                    let piece = |changes: BrushChanges, posts: PostRect| {
                        let heights: Vec<f32> =
                            posts.posts().map(|post| scale.world_z(elevations.height(post))).collect();
                        changes.and(set_heights(lattice, posts, &heights))
                    };
                    made.pieces.iter().map(|change| change.posts).fold(BrushChanges::default(), piece)
                };
                self.mesh.source_mut().edit(drawn)
            }
        };
        let rects: Vec<PostRect> = made.pieces.iter().map(|change| change.posts).collect();
        if let Some(pyramid) = pyramid {
            let again = SightGround::again(pyramid, std::sync::Arc::clone(self.elevations()), &rects);
            self.sight = again.into();
        }
        let Some(edit) = edit else { return Ok(None) };
        self.mesh.mend(&edit)?;
        self.view.forget();
        let layout = *self.mesh.source().ground().layout;
        let patches: Vec<usize> = edit.patches.iter().map(|&corner| layout.patch_index(corner)).collect();
        for &patch in &patches {
            self.shown.moved(patch);
            self.laid.moved(patch);
        }
        let elevations = std::sync::Arc::clone(self.elevations());
        rects.iter().for_each(|&posts| self.map.edit(&elevations, scale, posts));
        Ok(Some(WalkEdit {
            number: edit.number,
            patches: patches.into_iter().map(|patch| PatchId(patch as u32)).collect(),
            pieces: made.pieces,
            volumes: made.volumes,
            moves_standing: rects.iter().any(|posts| self.holds_standing(*posts)),
        }))
    }

    /// Gives the posts of an edit their former elevations, for one that was the last.
    ///
    /// # Errors
    /// See [`Walk::edit`].
    pub fn take_back(&mut self, pieces: &[Change]) -> Result<Option<WalkEdit>, WalkError> {
        self.edit(|lattice| {
            let back = |changes: BrushChanges, piece: &Change| {
                changes.and(set_heights(lattice, piece.posts, &piece.before))
            };
            pieces.iter().rev().fold(BrushChanges::default(), back)
        })
    }

    /// Whether something stands near posts, or the walls under the border do.
    fn holds_standing(&self, PostRect { first, last }: PostRect) -> bool {
        let lattice = self.elevations();
        let far = (lattice.columns() - 1, lattice.rows() - 1);
        let is_rim = first.column == 0 || first.row == 0 || last.column == far.0 || last.row == far.1;
        let corners = [first, last].map(|post| lattice.position(post).as_dvec2());
        let near = Rect::around(corners).grown(LEANING_M);
        let scene = &self.scene;
        is_rim
            || !scene.uprights.is_empty()
            || scene.placements.iter().any(|placed| near.contains(placed.at.as_dvec2()))
    }
}

//! Posts of a part of the ground that lie closer to each other than those of the ground map.

use crate::ground::GroundPost;

/// A rectangle of posts. Of several for one map, the first has half the distance between the map's posts, and each other
/// half that of the one before; the finest that holds a place is the one that is shown there.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundWindow {
    /// The column and the row of its south-west post, counted in its own posts from that of the map.
    pub first: [u32; 2],
    /// Posts per row.
    pub columns: u32,
    /// One entry per post, row by row from the south-west.
    pub posts: Vec<GroundPost>,
}

impl GroundWindow {
    /// Posts per row, and rows; `None` where the rows are not whole.
    pub fn size(&self) -> Option<[u32; 2]> {
        let rows = u32::try_from(self.posts.len()).ok()?.checked_div(self.columns)?;
        let is_whole = rows > 0 && u64::from(rows) * u64::from(self.columns) == self.posts.len() as u64;
        is_whole.then_some([self.columns, rows])
    }
}

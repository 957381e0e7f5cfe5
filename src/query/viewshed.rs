//! The results of a viewshed: figures, and a raster.

use crate::post_raster::PostBytes;
use sandtable_geom::crs::Crs;
use sandtable_raster::raster::Raster;
use sandtable_raster::windows::Windows;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::sight::viewshed::{PostVisibility, Viewshed, ViewshedCounts};

/// The value of posts that were not looked at or have no data.
const NO_DATA: u8 = 255;

/// The summary of a viewshed: how much is in sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewshedSummary {
    /// Posts of each kind.
    pub counts: ViewshedCounts,
    /// The area in sight, square meters.
    pub visible_m2: f64,
    /// The share of posts in sight among those that were looked at; 0 where there are none.
    pub visible_share: f64,
}

impl ViewshedSummary {
    /// The figures of a viewshed over `lattice`; posts that it does not hold are beyond.
    pub fn new(lattice: &Lattice, viewshed: &Viewshed) -> Self {
        let mut counts = viewshed.counts();
        counts.beyond += lattice.columns() as usize * lattice.rows() as usize - viewshed.posts.len();
        let visible = counts.visible as f64;
        let looked_at = counts.visible + counts.hidden;
        Self {
            counts,
            visible_m2: visible * lattice.cell().element_product(),
            visible_share: if looked_at == 0 { 0.0 } else { visible / looked_at as f64 },
        }
    }
}

/// The viewshed as a raster: 1 in sight, 0 hidden, no data elsewhere.
pub fn raster(lattice: &Lattice, viewshed: &Viewshed, crs: &Crs) -> Raster {
    bytes(viewshed).raster(lattice, crs)
}

/// [`raster`], made window by window.
pub fn windows(lattice: &Lattice, viewshed: &Viewshed, crs: &Crs) -> impl Windows + Send {
    bytes(viewshed).windows(lattice, crs)
}

fn bytes(viewshed: &Viewshed) -> PostBytes<impl Fn(usize, &mut [u8]) + Send + Sync> {
    let value = |post: PostVisibility| match post {
        PostVisibility::Visible => 1,
        PostVisibility::Hidden => 0,
        PostVisibility::Beyond | PostVisibility::NoData => NO_DATA,
    };
    let fill = move |first: usize, bytes: &mut [u8]| {
        bytes.iter_mut().zip(&viewshed.posts[first..]).for_each(|(place, &post)| *place = value(post));
    };
    PostBytes { name: "viewshed", fill, nodata: NO_DATA }
}

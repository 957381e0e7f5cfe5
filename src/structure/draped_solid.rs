//! Structures that are placed again wherever the displayed ground changes.

use crate::building_footing::WallFooting;
use crate::faces::Faces;
use crate::fence::Posts;
use crate::fence_band::FenceBand;
use crate::obstacle::Obstacles;
use crate::power::PowerLine;
use sandtable_draw::list::DrawMesh;
use sandtable_terrain::support_surface::SupportSurface;

/// Something upright.
#[derive(Clone, Debug, PartialEq)]
pub enum DrapedSolid {
    /// A wall, a hedge, a bank of earth or a rail.
    Band(FenceBand),
    /// The posts of a fence.
    Posts(Posts),
    /// A belt of obstacles.
    Obstacles(Obstacles),
    /// Pylons and wires.
    PowerLine(PowerLine),
    /// The footing that keeps a building from floating.
    Footing(WallFooting),
}

impl DrapedSolid {
    /// Its triangles on the ground in world space; empty where there is none under it.
    pub fn mesh(&self, under: SupportSurface<'_>) -> DrawMesh {
        let mut faces = Faces::default();
        match self {
            Self::Band(band) => band.build(under.displayed, &mut faces),
            Self::Posts(posts) => posts.build(under, &mut faces),
            Self::Obstacles(obstacles) => obstacles.build(under, &mut faces),
            Self::PowerLine(line) => line.build(under, &mut faces),
            Self::Footing(footing) => footing.build(under.displayed, &mut faces),
        }
        faces.into_mesh()
    }
}

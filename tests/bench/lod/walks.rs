//! The contenders of the frame: each brings culling, mesh and index lists up to date for one camera.

use sandtable_roam::block::WholeGround;
use sandtable_roam::criterion::spheres::Spheres;
use sandtable_roam::culling::{Culling, InView};
use sandtable_roam::emit::bintree::VertexBlock;
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::DEFAULT_PATCH;
use sandtable_roam::measured_ground::MeasuredGround;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::refine::deferred::Deferred;
use sandtable_roam::refine::queues::{Goal, Queues};
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_roam::spheres::SphereMap;
use sandtable_view::camera::Camera;

use crate::flight;

/// A ground measured once.
pub struct World(MeasuredGround);

impl World {
    /// The ground of heights in meters.
    pub fn new(heights: &[f32]) -> Self {
        let measured =
            MeasuredGround::new(flight::lattice(heights), DEFAULT_PATCH).expect("patches can be laid");
        measured.measure_patches();
        Self(measured)
    }

    /// What refinement reads.
    pub fn ground(&self) -> PatchedGround<'_> {
        self.0.patched()
    }

    /// The spheres in which errors show: `reach` meters of distance a meter of error.
    pub fn spheres(&self, reach: f32) -> SphereMap {
        SphereMap::plain(self.ground(), self.0.midpoint(), reach)
    }
}

/// What is flown.
pub trait Walk {
    /// Brings everything up to date.
    fn update(&mut self, camera: &Camera);
    /// The triangles shown.
    fn triangles(&self) -> usize;
    /// Vertices activated and deactivated, and vertices looked at, by the last update.
    fn work(&self) -> [usize; 2];
    /// Index bytes of patches that changed in the last update.
    fn upload(&self) -> usize;
}

/// The deferred refiner.
pub struct Following<'a> {
    world: &'a World,
    seen: InView,
    walk: Deferred<WholeGround<'a>>,
}

impl<'a> Following<'a> {
    /// By these spheres.
    pub fn new(world: &'a World, spheres: &'a SphereMap) -> Self {
        let source = WholeGround { ground: world.ground(), spheres };
        let walk = Deferred::new(source, f64::from(flight::CELL_M)).expect("small patches");
        Self { world, seen: InView::default(), walk }
    }

    /// How many patches have a mesh of their own.
    pub fn meshes(&self) -> usize {
        self.walk.meshes()
    }
}

impl Walk for Following<'_> {
    fn update(&mut self, camera: &Camera) {
        let culling = Culling::frustum(camera);
        let patches = self.seen.update(self.world.ground(), self.world.0.heights(), culling);
        self.walk.update(camera.eye(), patches).expect("in memory");
    }

    fn triangles(&self) -> usize {
        self.walk.triangle_count()
    }

    fn work(&self) -> [usize; 2] {
        let changes = self.walk.changes();
        [changes.splits + changes.merges, self.walk.examined()]
    }

    fn upload(&self) -> usize {
        let corners: Vec<Vertex> = self.world.0.layout().patches().collect();
        let dirty = self.walk.changes().dirty.iter();
        dirty.map(|&patch| 6 * self.walk.indices(corners[patch]).len()).sum()
    }
}

/// Splits alone: everything anew, the index list of every patch in view.
pub struct Rebuilding<'a> {
    world: &'a World,
    spheres: &'a SphereMap,
    block: VertexBlock,
    seen: InView,
    indices: Vec<[u16; 3]>,
}

impl<'a> Rebuilding<'a> {
    /// By these spheres.
    pub fn new(world: &'a World, spheres: &'a SphereMap) -> Self {
        let block = VertexBlock::new(world.0.layout()).expect("small patches");
        Self { world, spheres, block, seen: InView::default(), indices: Vec::new() }
    }
}

impl Walk for Rebuilding<'_> {
    fn update(&mut self, camera: &Camera) {
        let ground = self.world.ground();
        let patches = self.seen.update(ground, self.world.0.heights(), Culling::frustum(camera));
        let criterion = Spheres::new(ground, self.spheres, camera.eye());
        let active = rebuild(self.world.0.layout(), &criterion, patches.iter().copied());
        self.indices.clear();
        for &corner in patches {
            self.block.append(&active, corner, |_| true, &mut self.indices);
        }
    }

    fn triangles(&self) -> usize {
        self.indices.len()
    }

    fn work(&self) -> [usize; 2] {
        [self.indices.len(); 2]
    }

    fn upload(&self) -> usize {
        6 * self.indices.len()
    }
}

/// Split and merge queues under an exact budget; the lists of patches that changed are written anew.
pub struct Queueing<'a> {
    world: &'a World,
    spheres: &'a SphereMap,
    block: VertexBlock,
    seen: InView,
    queues: Queues<'a>,
    indices: Vec<[u16; 3]>,
    work: usize,
    corners: Vec<Vertex>,
}

impl<'a> Queueing<'a> {
    /// With at most `budget` triangles.
    pub fn new(world: &'a World, spheres: &'a SphereMap, budget: usize) -> Self {
        let block = VertexBlock::new(world.0.layout()).expect("small patches");
        let queues = Queues::new(world.ground(), Goal::Budget(budget));
        let corners = world.0.layout().patches().collect();
        Self { world, spheres, block, seen: InView::default(), queues, indices: Vec::new(), work: 0, corners }
    }
}

impl Walk for Queueing<'_> {
    fn update(&mut self, camera: &Camera) {
        let ground = self.world.ground();
        let patches = self.seen.update(ground, self.world.0.heights(), Culling::frustum(camera));
        let criterion = Spheres::new(ground, self.spheres, camera.eye());
        let changes = self.queues.update(&criterion, patches);
        self.work = changes.splits + changes.merges;
        self.indices.clear();
        for &patch in &changes.dirty {
            self.block.append(self.queues.active(), self.corners[patch], |_| true, &mut self.indices);
        }
    }

    fn triangles(&self) -> usize {
        self.queues.triangles()
    }

    fn work(&self) -> [usize; 2] {
        [self.work; 2]
    }

    fn upload(&self) -> usize {
        6 * self.indices.len()
    }
}

//! The invariants of a walk.

use crate::Walk;
use sandtable_roam::criterion::spheres::Spheres;
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_roam::shown::PatchList;

/// The clearance between the ground and what lies on it that is rounding, as a share of the scene's extent: positions are
/// f32.
const ROUNDING: f64 = 1e-6;

impl Walk {
    /// Checks that the mesh is sound and that of a rebuild from its roots, so that it is conforming; that the spheres nest;
    /// and that what lies on the ground lies in the displayed triangles.
    ///
    /// # Panics
    /// Where one of it is not so.
    pub fn check(&self) {
        self.mesh.check();
        let terrain = self.mesh.source();
        let ground = terrain.ground();
        terrain.spheres().check(ground);
        let criterion = Spheres::new(ground, terrain.spheres(), self.mesh.eye());
        let active = rebuild(ground.layout, &criterion, self.mesh.visible().iter().copied());
        active.check();
        for &corner in self.mesh.visible() {
            let mut own = self.mesh.local_triangles(corner);
            let mut rebuilt = PatchList::bintree(ground, &active, corner).triangles.to_vec();
            for list in [&mut own, &mut rebuilt] {
                list.iter_mut().for_each(|corners| corners.sort_unstable());
                list.sort_unstable();
            }
            assert_eq!(own, rebuilt, "the triangles of the patch at {corner:?} and those of a rebuild");
        }
        let (min, max) = self.scene.bounds;
        let clearance_m = self.laid.check(&self.mesh, &self.shown);
        let most_m = f64::from((max - min).length() + max.length()) * ROUNDING;
        assert!(clearance_m <= most_m, "what lies on the ground is {clearance_m} m off it");
    }
}

//! Shadows of solids: depth maps of the draw list as a light sees it, as fine as the picture and only where solids are.
//!
//! # How
//! A map looks down a direction, that of the sun for shadows or straight down for contact shade. Its levels are grids
//! whose texels double from level to level; the depth of a point from the eye names the level whose texels are about
//! as large as its pixels. A level covers what the camera sees at its depths, and of that only the pages of 32×32
//! texels that a solid touches are stored:
//!
//! ```text
//!   eye ◁─ level 0 ─┬── level 1 ──┬────── level 2 ──────      depths double
//!
//!   level: page table  · · 1 2 · ·      · nothing casts: the point is lit, at the cost of one look-up
//!                      · · 3 4 5 ·      1 2 3 … pages, one after the other, for all levels
//!
//!   texel: [greatest height toward the light of a solid, of the displayed ground]
//! ```
//!
//! A picture with parallel rays has pixels of one size, and so one level for all depths.
//!
//! `casters` turns triangles to the map's space, `levels` finds the pages, `fill` and `coverage` rasterize them with integer
//! coverage, row of pages by row of pages in parallel; the greatest height does not depend on the order. [`filter`]
//! reads them. Both renderers read the same map, so that they show the same shadows. A graphics adapter may draw the texels
//! itself: [`plan`] gives it the pages without them.
//!
//! The ground receives from solids only, since the ground map holds the shadow of terrain on terrain, softer and finer
//! than triangles could cast it. Solids receive from both.
//!
//! # Why not otherwise
//! One map for the whole scene would have texels of meters where a village stands in a scene of 100 km; cascades of a
//! fixed size spend most of their texels on bare ground. Rays through a tree of triangles would be exact, but costly
//! for soft edges, and a graphics adapter could not do the same.
//!
//! # Cost
//! Nothing where a list has no solids. Else, while the maps are made, 44 bytes per triangle of a solid or of the ground
//! and 60 if it is near pages of the map at work, twice that while they are collected; 8 bytes per stored texel, and up to 4 more
//! while it is drawn, of which there are at most [`MOST_PAGES`] pages per map; these are asked for before they are drawn. A pixel costs
//! one look-up per map where nothing is near, and from 9 to some 100 readings where a solid lies toward the light.

mod caster_boxes;
mod casters;
mod coverage;
mod cut;
mod fill;
pub mod filter;
mod levels;
pub mod plan;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::shadow::casters::ListTriangles;
use crate::shadow::levels::MapSource;
use sandtable_base::limits::memory::{MemoryRefused, check_memory};
use sandtable_draw::list::DrawList;
use sandtable_view::camera::Camera;

/// Texels along the side of a page: smaller pages fit solids closer, larger ones have fewer borders to look across.
pub const PAGE: u32 = 32;

/// The most pages of a map, 64 MiB; a map that needs more has larger texels.
pub const MOST_PAGES: usize = 8192;

/// The most levels: the nearest of eight has texels a 128th of the farthest's. What is nearer still shares its texels.
pub const MOST_LEVELS: usize = 8;

/// The shadow radius that filters read at the most, in texels: larger is softer and slower.
const MOST_RADIUS: f32 = 5.0;

/// The greatest side of a texel of the sun's map, in pixels of the picture; the least is half of it. Larger texels cost
/// less and blur the shadows of what is only a few pixels high.
const SUN_TEXEL_PX: f32 = 1.4;

/// The same for the sky's map: contact shade is blurred and needs few.
const SKY_TEXEL_PX: f32 = 4.0;

/// How far above the ground an underside lies at the least of what does not touch it, in texels: as far as contact
/// shade reaches.
pub const FLOATING_TEXELS: f32 = 2.0;

/// The height of a texel where nothing is: finite, since shaders need not know infinity.
const NOTHING: f32 = -1e30;

/// The greatest heights toward a light of solids and of the displayed ground, in meters from the eye.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ShadowTexel {
    /// That of solids.
    pub solid: f32,
    /// That of the ground.
    pub ground: f32,
}

impl ShadowTexel {
    /// A texel where nothing is.
    pub const EMPTY: Self = Self { solid: NOTHING, ground: NOTHING };

    fn highest(self, other: Self) -> Self {
        Self { solid: self.solid.max(other.solid), ground: self.ground.max(other.ground) }
    }
}

/// The place of a page of a level.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ShadowPage {
    /// Its number from 1; 0 where nothing is stored.
    pub number: u32,
    /// The greatest values of its texels and of those of the pages around it; nothing where nothing is stored.
    pub highest: ShadowTexel,
}

/// A grid of pages of one texel size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowLevel {
    /// Meters along the map's first two axes from the eye to the corner of the first texel.
    pub origin: [f32; 2],
    /// The side of a texel, meters.
    pub texel_m: f32,
    /// Pages from west to east of the map.
    pub columns: u32,
    /// Pages from south to north of the map.
    pub rows: u32,
    /// Its first entry in [`ShadowMap::pages`].
    pub first: u32,
}

/// The map's right-handed axes: two across the light and one toward it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightAxes {
    /// Two unit vectors across the light.
    pub across: [Vec3; 2],
    /// The unit vector toward the light.
    pub toward: Vec3,
}

/// The relation between a depth from the eye and a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelScale {
    /// Meters of a texel per meter of depth, at the most.
    pub texel_per_depth: f32,
    /// The base-2 logarithm of the texel of level 0, in meters.
    pub least: i32,
}

/// The shadows of one light in levels of finer and coarser texels around the eye.
#[derive(Clone, Debug)]
pub struct ShadowMap {
    /// The eye of the picture, world space.
    pub eye: Vec3,
    /// Where it looks, a unit vector.
    pub forward: Vec3,
    /// The map's axes.
    pub axes: LightAxes,
    /// Which level a depth is read from.
    pub scale: LevelScale,
    /// The finest first; at least one.
    pub levels: Vec<ShadowLevel>,
    /// The pages of all levels, level by level and row by row.
    pub pages: Vec<ShadowPage>,
    /// Page by page, row by row.
    pub texels: Vec<ShadowTexel>,
}

/// The purpose of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShadowPurpose {
    /// Everything toward the light casts.
    Sun,
    /// Only what reaches down to the ground counts: a bridge high above it does not touch it.
    Contact,
}

/// The maps of the sun and of the sky.
#[derive(Clone, Debug, Default)]
pub struct Shadows {
    /// `None` where no solid casts a shadow, or no sun shines.
    pub sun: Option<ShadowMap>,
    /// `None` where there is no solid.
    pub sky: Option<ShadowMap>,
}

impl Shadows {
    /// The maps of a checked list for what `camera` sees.
    ///
    /// # Errors
    /// There is not the memory for them.
    pub fn new(list: &DrawList, camera: &Camera) -> Result<Self, MemoryRefused> {
        let to_sun = list.lighting.to_sun;
        check_memory(ListTriangles::bytes_of(list), "drawing shadows", "draw fewer or coarser solids")?;
        let Some(triangles) = ListTriangles::new(list, camera) else { return Ok(Self::default()) };
        let map = |toward: Vec3, texel_px: f32, purpose: ShadowPurpose| {
            let axes = LightAxes::new(toward, camera);
            ShadowMap::new(&MapSource { list, camera, triangles: &triangles, axes, purpose }, texel_px)
        };
        let sun = || match to_sun.z > 0.0 {
            true => map(to_sun, SUN_TEXEL_PX, ShadowPurpose::Sun),
            false => Ok(None),
        };
        // One after the other, each by all threads: what they are made of takes more memory than they do.
        let sun = sun()?;
        Ok(Self { sun, sky: map(Vec3::Z, SKY_TEXEL_PX, ShadowPurpose::Contact)? })
    }

    /// The maps of the sun and of the sky.
    pub fn maps(&self) -> [Option<&ShadowMap>; 2] {
        [self.sun.as_ref(), self.sky.as_ref()]
    }
}

impl LightAxes {
    /// Axes toward a light (unit vector), turned with the camera so that little of a level is out of view.
    pub fn new(toward: Vec3, camera: &Camera) -> Self {
        let across = |axis: Vec3| (axis - toward * axis.dot(toward)).try_normalize();
        let ahead = [camera.forward(), camera.up()].into_iter().find_map(across);
        let ahead = ahead.unwrap_or_else(|| toward.any_orthonormal_vector());
        Self { across: [ahead.cross(toward), ahead], toward }
    }

    /// A vector's lengths along the axes.
    pub fn turned(&self, vector: Vec3) -> Vec3 {
        Vec3::new(self.across[0].dot(vector), self.across[1].dot(vector), self.toward.dot(vector))
    }
}

impl LevelScale {
    /// The base-2 logarithm, rounded down, of the texels at a depth; taken from the float's exponent, so that every
    /// renderer finds the same.
    pub fn exponent(&self, depth_m: f32) -> i32 {
        let texel_m = (depth_m * self.texel_per_depth).max(f32::MIN_POSITIVE);
        (texel_m.to_bits() >> (f32::MANTISSA_DIGITS - 1)) as i32 - (f32::MAX_EXP - 1)
    }
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Vec2};

    use super::*;
    use crate::shadow::filter::ShadowReceiver;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::list::{DepthLayer, DrawItem, DrawMesh, DrawVertex, FeatureId};
    use sandtable_draw::material::Material;
    use sandtable_mesh::sink::MeshSink;
    use sandtable_view::axes::DirectionAxes;
    use sandtable_view::camera::ParallelFrame;

    fn rectangle(low: Vec2, high: Vec2, z: f32) -> DrawMesh {
        let mut mesh = DrawMesh::default();
        let corners = [low, Vec2::new(high.x, low.y), high, Vec2::new(low.x, high.y)];
        let ids = corners.map(|at| {
            let (position, normal) = (at.extend(z).to_array(), [0.0, 0.0, 1.0]);
            mesh.vertex(DrawVertex { position, normal, uv: [0.0; 2], color: Srgba::WHITE })
        });
        mesh.triangle([ids[0], ids[1], ids[2]]);
        mesh.triangle([ids[0], ids[2], ids[3]]);
        mesh
    }

    fn add(list: &mut DrawList, mesh: DrawMesh, layer: DepthLayer) {
        let item = DrawItem {
            triangles: 0..mesh.triangles.len() as u32,
            mesh: list.add_mesh(mesh),
            material: list.add_material(Material::default()),
            world_from_mesh: Mat4::IDENTITY,
            layer,
            feature: FeatureId::GROUND,
        };
        list.items.push(item);
    }

    /// 100 km of ground, and on it roofs of 12 m, 30 m apart.
    fn village(houses: u32) -> DrawList {
        let mut list = DrawList::default();
        add(&mut list, rectangle(Vec2::splat(-50_000.0), Vec2::splat(50_000.0), 0.0), DepthLayer::Ground);
        for house in 0..houses {
            let low = Vec2::new((house % 4) as f32, (house / 4) as f32) * 30.0;
            add(&mut list, rectangle(low, low + 12.0, 8.0), DepthLayer::Solid);
        }
        list
    }

    fn looking(eye: Vec3) -> Camera {
        Camera::new(eye, Vec3::ZERO, 0.8, (1920, 1080), (1.0, 200_000.0)).expect("sound")
    }

    /// The village as parallel rays see it, looking down by `pitch_deg`, `width_m` meters wide.
    fn parallel(pitch_deg: f32, width_m: f32, stretch: f32) -> Camera {
        let axes = DirectionAxes::new(0.3, pitch_deg.to_radians());
        let half_m = Vec2::new(width_m, width_m / stretch * (1080.0 / 1920.0)) / 2.0;
        let frame = ParallelFrame { half_m, dpi: 96.0 };
        let eye = Vec3::new(40.0, 30.0, 0.0) - axes.forward * 900.0;
        Camera::parallel(eye, &axes, frame, (1920, 1080), (0.5, 200_000.0)).expect("sound")
    }

    fn of(list: &DrawList, camera: &Camera) -> Shadows {
        Shadows::new(list, camera).expect("memory")
    }

    #[test]
    fn without_solids_there_is_no_map() {
        let shadows = of(&village(0), &looking(Vec3::new(0.0, -400.0, 200.0)));
        assert!(shadows.sun.is_none() && shadows.sky.is_none());
    }

    #[test]
    fn a_village_in_a_wide_land_takes_a_few_pages_with_texels_fine_as_pixels() {
        for distance_m in [100.0, 1_000.0, 15_000.0] {
            let camera = looking(Vec3::new(0.0, -0.8, 0.6) * distance_m);
            let sun = of(&village(12), &camera).sun.expect("solids");
            let depth_m = (Vec3::ZERO - camera.eye()).dot(camera.forward());
            let level = sun.levels[(sun.scale.exponent(depth_m) - sun.scale.least).max(0) as usize];
            let pixel_m = 1.0 / camera.pixels_per_meter(depth_m);
            let most_m = SUN_TEXEL_PX * pixel_m;
            assert!(level.texel_m <= most_m, "{} m of {most_m} m at {distance_m} m", level.texel_m);
            let stored = sun.texels.len() / (PAGE * PAGE) as usize;
            assert!((1..=2500).contains(&stored), "{stored} pages at {distance_m} m");
        }
    }

    #[test]
    fn a_roof_shades_what_lies_behind_it_from_the_sun_and_nothing_else() {
        let list = village(1);
        let camera = looking(Vec3::new(0.0, -80.0, 60.0));
        let sun = of(&list, &camera).sun.expect("a solid");
        let to_sun = list.lighting.to_sun;
        let under = Vec3::new(6.0, 6.0, 8.0) - to_sun * (8.0 / to_sun.z);
        let share = |at: Vec3| sun.sun(at, Vec3::Z, ShadowReceiver::Ground);
        assert_eq!(share(under), 0.0);
        assert_eq!(share(under + Vec3::X * 20.0), 1.0);
        assert_eq!(sun.sun(Vec3::new(6.0, 6.0, 8.0), Vec3::Z, ShadowReceiver::Solid), 1.0, "the roof itself");
        let edge = under + Vec3::X * 6.0;
        assert!((0.2..0.8).contains(&share(edge)), "{}", share(edge));
    }

    #[test]
    fn parallel_rays_see_the_same_shadows_as_an_eye_does() {
        let list = village(12);
        let central = of(&list, &looking(Vec3::new(0.0, -80.0, 60.0)));
        let central = central.sun.expect("solids");
        let to_sun = list.lighting.to_sun;
        let under = Vec3::new(6.0, 6.0, 8.0) - to_sun * (8.0 / to_sun.z);
        for (pitch_deg, stretch) in [(90.0, 1.0), (60.0, 1.0), (45.0, std::f32::consts::SQRT_2), (5.0, 1.0)] {
            for width_m in [150.0, 400.0] {
                let shadows = of(&list, &parallel(pitch_deg, width_m, stretch));
                let (sun, sky) = (shadows.sun.expect("solids"), shadows.sky.expect("solids"));
                assert_eq!(sun.levels.len(), 1, "one size of pixel");
                assert!(sun.levels[0].texel_m <= SUN_TEXEL_PX * width_m / 1920.0);
                let differences = (0..60).map(|step| {
                    let at = under + Vec3::new(step as f32 * 0.4 - 12.0, step as f32 * 0.1 - 3.0, 0.0);
                    let [own, other] =
                        [&sun, &central].map(|map| map.sun(at, Vec3::Z, ShadowReceiver::Ground));
                    (own - other).abs()
                });
                // Texels of other sizes blur edges by other breadths.
                let count = differences.filter(|difference| *difference > 0.02).count();
                assert!(count < 12, "{count} of 60 places, {pitch_deg}° {width_m} m");
                assert_eq!(sun.sun(under, Vec3::Z, ShadowReceiver::Ground), 0.0);
                assert_eq!(sun.sun(under + Vec3::X * 20.0, Vec3::Z, ShadowReceiver::Ground), 1.0);
                assert!(sky.contact(Vec3::new(6.0, 6.0, 0.0), ShadowReceiver::Ground) < 1.0);
            }
        }
    }

    /// No corner of the only roof is in view, and the ground has two triangles.
    #[test]
    fn parallel_rays_see_a_roof_wider_than_the_picture_and_what_lies_behind_the_eye() {
        for height_m in [8.0, 5_000.0] {
            let mut list = village(0);
            let roof = rectangle(Vec2::splat(-500.0), Vec2::new(500.0, 30.0), height_m);
            add(&mut list, roof, DepthLayer::Solid);
            let camera = parallel(90.0, 100.0, 1.0);
            let sky = of(&list, &camera).sky.expect("a solid");
            assert!(sky.contact(Vec3::new(40.0, 20.0, height_m - 0.5), ShadowReceiver::Ground) < 1.0);
            assert!(of(&list, &camera).sun.is_some());
        }
    }

    #[test]
    fn parallel_rays_that_see_no_solid_nor_its_shadow_make_no_map() {
        let list = village(4);
        let aside = parallel(90.0, 100.0, 1.0).moved(Vec3::X * 30_000.0);
        let shadows = of(&list, &aside);
        assert!(shadows.sun.is_none() && shadows.sky.is_none());
        for far in [1e9, 1e30, f32::MAX, f32::INFINITY, f32::NAN] {
            let mut list = village(1);
            add(&mut list, rectangle(Vec2::splat(-far), Vec2::splat(far), 500.0), DepthLayer::Solid);
            let shadows = of(&list, &parallel(40.0, 200.0, 1.0));
            let stored = shadows.sun.map_or(0, |map| map.texels.len()) / (PAGE * PAGE) as usize;
            assert!(stored <= MOST_PAGES, "{stored} pages at {far}");
        }
    }

    #[test]
    fn hostile_corners_are_left_out_and_gigantic_ones_cut() {
        for far in [1e9, 1e30, f32::MAX, f32::INFINITY, f32::NAN] {
            let mut list = village(1);
            add(&mut list, rectangle(Vec2::splat(-far), Vec2::splat(far), 500.0), DepthLayer::Solid);
            let shadows = of(&list, &looking(Vec3::new(0.0, -80.0, 60.0)));
            let stored = shadows.sun.map_or(0, |map| map.texels.len()) / (PAGE * PAGE) as usize;
            assert!(stored <= MOST_PAGES, "{stored} pages at {far}");
        }
    }
}

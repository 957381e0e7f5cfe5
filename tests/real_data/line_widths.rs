//! Roads of a real place are nowhere narrower on its first picture than their class needs.

use std::collections::BTreeMap;
use std::path::PathBuf;

use glam::{DVec2, Vec2};
use sandtable_earthworks::alignment::Support;
use sandtable_new::{self as new_scene, NewSceneOptions};
use sandtable_picture::{build_draw_list, camera, draw_list};
use sandtable_render::cpu::{RenderQuality, render};
use sandtable_render::picture::Rendering;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::symbols::LineSymbol;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

use crate::common::data::data;
use crate::common::scratch::Scratch;

const SIZE: (u32, u32) = (1920, 1080);

/// What casings add to a line on both sides together, in pixels; lines from two pixels on have them.
const CASINGS_PX: f64 = 1.5;

/// A place is seen where its depth on the picture is that of the line, up to this share.
const SEEN: f64 = 2e-3;

/// Ground that rises more than this, in meters per meter, is not seen as level ground is.
const MOST_RISE: f64 = 0.08;

/// What a width loses because a pixel is of the feature at its center, in pixels: half a pixel's diagonal at either end,
/// and a step of the measure.
const SAMPLED_PX: f64 = 1.42 + 0.125;

/// Pixels from the middle of a line in which its edges are looked for.
const REACH_PX: f32 = 12.0;

/// How far a line's middle may be off on the picture, in pixels: half a pixel's diagonal and what vertices are thinned by.
const OFF_PX: f32 = 1.1;

/// Wider places are junctions or neighbors that meet, and say nothing of a line.
const LONE: f64 = 2.0;

/// Widths on the picture of the roads of one class.
#[derive(Default)]
struct ClassWidths {
    least: f64,
    widths_px: Vec<f64>,
}

fn place() -> Option<SceneModel> {
    let dem = data("scenes/porto_alegre_br/poa_elevation.tif")?;
    let vectors: Vec<PathBuf> = vec![data("scenes/porto_alegre_br/poa_osm.pbf")?];
    let folder = Scratch::new();
    let allowed = vec![dem.parent().expect("in a folder").to_path_buf()];
    let options =
        NewSceneOptions { folder: folder.at("scene"), dem: vec![dem], vectors, ..NewSceneOptions::default() };
    let written = new_scene::write(&options, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
    Some(open_scene(&written.path, &allowed, &|_| ()).unwrap_or_else(|error| panic!("{error}")))
}

struct Measured<'a> {
    scene: &'a SceneModel,
    camera: &'a Camera,
    picture: Rendering,
    ground: &'a dyn TriangleSurface,
}

impl Measured<'_> {
    /// The pixel of a place on the ground, where it is in view and nothing hides it.
    fn seen(&self, at: DVec2) -> Option<Vec2> {
        let z = self.ground.displayed_z(at)?;
        let seen = self.camera.project(at.as_vec2().extend(z as f32))?;
        let depth_m = self.picture.depth_m[self.index(seen.pixel)?];
        let away_m = (at.as_vec2().extend(z as f32) - self.camera.eye()).dot(self.camera.forward());
        ((f64::from(depth_m - away_m)).abs() < SEEN * f64::from(away_m)).then_some(seen.pixel)
    }

    fn index(&self, pixel: Vec2) -> Option<usize> {
        let inside = pixel.cmpge(Vec2::ZERO).all() && pixel.x < SIZE.0 as f32 && pixel.y < SIZE.1 as f32;
        inside.then(|| pixel.y as usize * SIZE.0 as usize + pixel.x as usize)
    }

    /// Whether the ground is level enough around a place.
    fn is_level(&self, at: DVec2) -> bool {
        let z = |x: f64, y: f64| self.ground.displayed_z(at + DVec2::new(x, y) * 60.0);
        let rise = |from: Option<f64>, to: Option<f64>| Some((to? - from?).abs() / 120.0);
        let rises = [rise(z(-1.0, 0.0), z(1.0, 0.0)), rise(z(0.0, -1.0), z(0.0, 1.0))];
        rises.iter().all(|rise| rise.is_some_and(|rise| rise < MOST_RISE))
    }

    /// How wide what is of roads is across a line at `at`, in pixels; `None` where that is not seen.
    fn width_px(&self, at: DVec2, along: DVec2) -> Option<f64> {
        const STEP_PX: f32 = 0.125;
        let center = self.seen(at)?;
        let across = (self.seen(at + along)? - center).try_normalize()?.perp();
        // What stands hides roads; the ground, and what is drawn on it below roads, does not.
        let is_road = |away_px: f32| -> Option<bool> {
            let feature = self.picture.features[self.index(center + across * away_px)?];
            match feature.index().map(|index| self.scene.features[index].kind) {
                Some(FeatureKind::Road) => Some(true),
                None | Some(FeatureKind::Area | FeatureKind::River | FeatureKind::Lake) => Some(false),
                Some(_) => None,
            }
        };
        // The line's middle may be off by what its vertices were thinned by, and by a pixel's corner.
        let steps = (OFF_PX / STEP_PX) as i32;
        let mut middle = None;
        for step in (0..=steps).flat_map(|step| [step, -step]) {
            let away_px = step as f32 * STEP_PX;
            if is_road(away_px)? {
                middle = Some(away_px);
                break;
            }
        }
        let Some(middle) = middle else { return Some(0.0) };
        let mut width_px = f64::from(STEP_PX);
        for side in [-STEP_PX, STEP_PX] {
            let mut away_px = middle + side;
            while (away_px - middle).abs() < REACH_PX && is_road(away_px)? {
                width_px += f64::from(STEP_PX);
                away_px += side;
            }
        }
        Some(width_px)
    }

    /// Widths by class, in thousandths of a pixel, of the roads on the ground that are not dashed.
    fn widths(&self) -> BTreeMap<u64, ClassWidths> {
        let mut classes: BTreeMap<u64, ClassWidths> = BTreeMap::new();
        let is_road = |symbol: &&LineSymbol| {
            !matches!(symbol.surface, RibbonSurface::River | RibbonSurface::ShoreLine | RibbonSurface::Track)
                && symbol.alignment.support == Support::Ground
        };
        for symbol in self.scene.symbols.iter().filter(is_road) {
            let class = classes.entry((symbol.least_px * 1000.0) as u64).or_default();
            class.least = symbol.least_px;
            let line = &symbol.alignment.line;
            for leg in line.legs() {
                let (at, along) = (leg[0].midpoint(leg[1]), leg[1] - leg[0]);
                if self.is_level(at) {
                    class.widths_px.extend(self.width_px(at, along.normalize_or_zero() * 30.0));
                }
            }
        }
        classes
    }
}

#[test]
#[ignore = "slow: first pictures of all real places"]
fn no_road_is_narrower_on_a_first_picture_than_its_class_needs() {
    let Some(scene) = place() else { return };
    let view = scene.view(Some("overview")).expect("the first camera");
    let camera = camera(&scene, view, SIZE).expect("sound");
    let shot = build_draw_list(&scene, &camera, &|_| ());
    let measured = |list| {
        let picture = render(list, &camera, &RenderQuality::default()).expect("sound");
        Measured { scene: &scene, camera: &camera, picture, ground: &*shot.displayed }.widths()
    };
    let mut places = 0;
    for class in measured(&shot.list).into_values().filter(|class| class.widths_px.len() >= 30) {
        let needed = class.least + if class.least >= 2.0 { CASINGS_PX } else { 0.0 };
        let count = class.widths_px.len();
        let least = class.widths_px.iter().copied().fold(f64::INFINITY, f64::min);
        let lone: Vec<f64> = class.widths_px.iter().copied().filter(|&px| px < LONE * needed + 1.0).collect();
        let mean = lone.iter().sum::<f64>() / lone.len().max(1) as f64;
        println!("class of {} px: {count} places, from {least} px, {mean} px on average", class.least);
        assert!(least >= needed - SAMPLED_PX, "{least} px where {needed} are needed");
        assert!(mean >= 0.95 * needed, "{mean} px on average where {needed} are needed");
        places += count;
    }
    assert!(places > 1000, "{places} places");
    // In their true width, as an export has them, they are too narrow: the measure finds that.
    let (list, _) = draw_list(&scene, &shot.displayed, &|_| ());
    let narrow = measured(&list);
    assert!(narrow.values().any(|class| class.widths_px.iter().any(|&px| px < class.least - SAMPLED_PX)));
}

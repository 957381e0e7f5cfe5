//! Roads as the scene lays them: the ground that ribbons cover, and that no two of them cover the same.

mod joins;
mod places;
mod scenes;

use sandtable_description::parse::parse_bytes;
use sandtable_ribbon::partition::overlap_m2;
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::scene_model::SceneModel;

use crate::common::scratch::Scratch;

/// Level ground of 1 km² in plain meters, and what `features` says of the rest.
fn scene(folder: &Scratch, features: &str) -> SceneModel {
    let row = "100 ".repeat(21);
    let grid = format!(
        "ncols 21\nnrows 21\nxllcenter 0\nyllcenter 0\ncellsize 50\n{}",
        [row.as_str(); 21].join("\n")
    );
    folder.write("ground.asc", &grid);
    let path = folder.write("scene.toml", format!("[terrain]\ndem = \"ground.asc\"\n{features}"));
    built(&path, &[])
}

fn built(path: &std::path::Path, allowed: &[std::path::PathBuf]) -> SceneModel {
    let text = std::fs::read(path).expect("readable");
    let document = parse_bytes(&path.to_string_lossy(), &text).unwrap_or_else(|report| panic!("{report}"));
    let assets = Assets::new(path, allowed).unwrap_or_else(|error| panic!("{error}"));
    build(&document, &assets, &|_| ()).unwrap_or_else(|diagnostic| panic!("{diagnostic}"))
}

fn area_m2(scene: &SceneModel, surfaces: &[RibbonSurface]) -> f64 {
    let ribbons = scene.ribbons.iter().filter(|ribbon| surfaces.contains(&ribbon.surface));
    ribbons.map(|ribbon| ribbon.plan.area_m2()).sum()
}

/// What every laid scene promises.
///
/// # Panics
/// Where a triangle faces down, or two lie over one another by more than rounding: a square millimeter for each square
/// meter that is covered, a sliver of which each triangle may leave.
fn check_laid(scene: &SceneModel) {
    let plans: Vec<&PlanMesh> = scene.ribbons.iter().map(|ribbon| &ribbon.plan).collect();
    for [a, b, c] in plans.iter().flat_map(|plan| plan.corners()) {
        let doubled = (b.at - a.at).perp_dot(c.at - a.at);
        assert!(doubled > 0.0, "{a:?} {b:?} {c:?} face down");
        assert!([a, b, c].iter().all(|corner| corner.uv.is_finite()), "{a:?} {b:?} {c:?}");
    }
    let area: f64 = plans.iter().map(|plan| plan.area_m2()).sum();
    let overlap = overlap_m2(plans);
    assert!(overlap <= 1e-4 * area, "{overlap} m2 of {area} m2 lie over one another");
}

//! The land of a scene for terrain analysis: its covers, roads, water, woods, buildings and bridges, a value a post.
//!
//! What lies on the ground is laid over the posts in drawing order, so that a post has what a picture shows there. Roads and
//! rivers narrower than the posts lie apart take each post along their centerlines: a stream does not vanish between posts.

use glam::{DVec2, Vec2};

use crate::feature::FeatureKind;
use crate::scene_model::SceneModel;
use crate::symbols::LineSymbol;
use crate::undergrowth::{CrownGround, crown_reach};
use sandtable_analysis::land::{self, Crossing, CrossingKind, Land, RoadLine, Stand, WaterKind, WaterPost};
use sandtable_description::words::Cover;
use sandtable_draw::list::DrawMesh;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_terrain::lattice::{Lattice, Post};

/// Widths in meters from which a paved road is a motorway, and a main road.
const MOTORWAY_M: f64 = 15.0;
const MAIN_M: f64 = 9.0;

/// A track narrower than this is a path, meters.
const TRACK_M: f64 = 2.0;

/// Trees are counted in squares of so many posts: fewer would hold one tree or none.
const STAND_POSTS: u32 = 5;

/// The land of a scene that was built true to scale.
pub fn land_of(scene: &SceneModel) -> Land {
    let grid = PostGrid { lattice: &scene.lattice };
    let mut land = Land::bare(scene.lattice.clone(), scene.crs.clone());
    land.cover = covers(scene, &grid);
    land.water = Some(waters(scene, &grid));
    land.roads = Some(roads(scene, &grid));
    land.obstacles_m = Some(obstacles(scene, &grid));
    land.woods = Some(stands(scene));
    let (lines, crossings) = lines(scene);
    (land.road_lines, land.crossings) = (lines, crossings);
    land
}

/// The posts of the ground, by world positions.
struct PostGrid<'a> {
    lattice: &'a Lattice,
}

impl PostGrid<'_> {
    fn posts(&self) -> usize {
        self.lattice.columns() as usize * self.lattice.rows() as usize
    }

    fn index(&self, column: u32, row: u32) -> usize {
        row as usize * self.lattice.columns() as usize + column as usize
    }

    /// Calls `visit` with each post in a triangle, and its barycentric weights.
    fn triangle(&self, corners: [DVec2; 3], mut visit: impl FnMut(usize, [f64; 3])) {
        let [a, b, c] = corners.map(|corner| corner / self.lattice.cell());
        let area = (b - a).perp_dot(c - a);
        if !area.is_finite() || area == 0.0 {
            return;
        }
        let low = a.min(b).min(c).ceil().max(DVec2::ZERO);
        let last = DVec2::new(f64::from(self.lattice.columns() - 1), f64::from(self.lattice.rows() - 1));
        let high = a.max(b).max(c).floor().min(last);
        if low.x > high.x || low.y > high.y {
            return;
        }
        for row in low.y as u32..=high.y as u32 {
            for column in low.x as u32..=high.x as u32 {
                let at = DVec2::new(f64::from(column), f64::from(row));
                let weights =
                    [(b - at).perp_dot(c - at), (c - at).perp_dot(a - at), (a - at).perp_dot(b - at)]
                        .map(|part| part / area);
                if weights.iter().all(|&weight| weight >= 0.0) {
                    visit(self.index(column, row), weights);
                }
            }
        }
    }

    /// Calls `visit` with the posts along a line, each next to the one before on a side, so that nothing slips through.
    fn line(&self, line: &[DVec2], mut visit: impl FnMut(usize)) {
        let last = DVec2::new(f64::from(self.lattice.columns() - 1), f64::from(self.lattice.rows() - 1));
        let mut visit_at = |at: DVec2| {
            let post = at.round();
            if post.cmpge(DVec2::ZERO).all() && post.cmple(last).all() {
                visit(self.index(post.x as u32, post.y as u32));
            }
        };
        for pair in line.windows(2) {
            let (from, to) = (pair[0] / self.lattice.cell(), pair[1] / self.lattice.cell());
            let steps = ((to - from).abs().max_element() * 2.0).ceil().clamp(1.0, 1e7) as u32;
            let mut before = from.round();
            for step in 0..=steps {
                let at = from + (to - from) * (f64::from(step) / f64::from(steps));
                let post = at.round();
                if post.x != before.x && post.y != before.y {
                    visit_at(DVec2::new(post.x, before.y));
                }
                visit_at(at);
                before = post;
            }
        }
    }
}

fn corners(plan: [sandtable_ribbon::plan::PlanVertex; 3]) -> [DVec2; 3] {
    plan.map(|vertex| vertex.at)
}

/// The covers of areas, and the roofs of buildings; `None` where the scene has neither.
fn covers(scene: &SceneModel, grid: &PostGrid<'_>) -> Option<Vec<land::LandCover>> {
    let mut covers = vec![land::LandCover::Unknown; grid.posts()];
    let mut is_known = false;
    for ribbon in &scene.ribbons {
        let RibbonSurface::Cover(cover) = ribbon.surface else { continue };
        let Some(cover) = land_cover(cover) else { continue };
        is_known = true;
        for triangle in ribbon.plan.corners() {
            grid.triangle(corners(triangle), |index, _| covers[index] = cover);
        }
    }
    for (mesh, _) in buildings(scene) {
        is_known = true;
        mesh_triangles(mesh, |plan, _| {
            grid.triangle(plan, |index, _| covers[index] = land::LandCover::Building)
        });
    }
    is_known.then_some(covers)
}

/// What a cover of a scene is for movement; `None` of what says nothing about the ground.
fn land_cover(cover: Cover) -> Option<land::LandCover> {
    Some(match cover {
        Cover::Forest => land::LandCover::Wood,
        Cover::Scrub => land::LandCover::Scrub,
        Cover::Meadow => land::LandCover::Open,
        Cover::Field => land::LandCover::Crops,
        Cover::Orchard => land::LandCover::Orchard,
        Cover::Wetland => land::LandCover::Wetland,
        Cover::Sand => land::LandCover::Sand,
        Cover::Rock => land::LandCover::Rock,
        Cover::BuiltUp | Cover::Industry => land::LandCover::BuiltUp,
        _ => return None,
    })
}

/// Water of features, and what the elevations themselves show.
fn waters(scene: &SceneModel, grid: &PostGrid<'_>) -> Vec<WaterPost> {
    let inferred = scene.water();
    let level = if scene.has_sea() && inferred.lakes.is_empty() { WaterKind::Sea } else { WaterKind::Lake };
    let post = |kind| WaterPost { kind, depth_m: f32::NAN };
    let mut waters = vec![WaterPost::default(); grid.posts()];
    for (water, _) in waters.iter_mut().zip(&inferred.is_water).filter(|(_, is_water)| **is_water) {
        *water = post(level);
    }
    for ribbon in &scene.ribbons {
        let kind = match ribbon.surface {
            RibbonSurface::River | RibbonSurface::Confluence => WaterKind::River,
            RibbonSurface::Lake => WaterKind::Lake,
            _ => continue,
        };
        for triangle in ribbon.plan.corners() {
            grid.triangle(corners(triangle), |index, _| waters[index] = post(kind));
        }
    }
    for symbol in scene.symbols.iter().filter(|symbol| is_river(symbol)) {
        grid.line(symbol.alignment.line.points(), |index| {
            if waters[index].kind == WaterKind::None {
                waters[index] = post(WaterKind::River);
            }
        });
    }
    waters
}

fn is_river(symbol: &LineSymbol) -> bool {
    matches!(symbol.surface, RibbonSurface::River | RibbonSurface::Confluence)
}

/// The surface of a road of a width in meters; `None` of what is no road.
fn road_surface(surface: RibbonSurface, width_m: f64) -> Option<land::RoadClass> {
    Some(match surface {
        RibbonSurface::Asphalt
        | RibbonSurface::AsphaltSolid
        | RibbonSurface::AsphaltEdges
        | RibbonSurface::AsphaltPlain => match width_m {
            MOTORWAY_M.. => land::RoadClass::Motorway,
            MAIN_M.. => land::RoadClass::Main,
            _ => land::RoadClass::Road,
        },
        RibbonSurface::Gravel => land::RoadClass::Track,
        RibbonSurface::Track if width_m < TRACK_M => land::RoadClass::Path,
        RibbonSurface::Track => land::RoadClass::Track,
        _ => return None,
    })
}

/// The width of a road at its start, meters.
fn width_m(symbol: &LineSymbol) -> f64 {
    symbol.alignment.width.at(0.0)
}

/// The best road over each post.
fn roads(scene: &SceneModel, grid: &PostGrid<'_>) -> Vec<land::RoadClass> {
    let mut roads = vec![land::RoadClass::None; grid.posts()];
    for symbol in &scene.symbols {
        let Some(surface) = road_surface(symbol.surface, width_m(symbol)) else { continue };
        grid.line(symbol.alignment.line.points(), |index| roads[index] = roads[index].max(surface));
    }
    roads
}

/// Center lines of roads, and bridges, in map coordinates.
fn lines(scene: &SceneModel) -> (Vec<RoadLine>, Vec<Crossing>) {
    let origin = scene.lattice.origin();
    let on_map = |line: &[DVec2]| line.iter().map(|at| origin + *at).collect::<Vec<_>>();
    let (mut roads, mut crossings) = (Vec::new(), Vec::new());
    for symbol in &scene.symbols {
        let width_m = width_m(symbol);
        let Some(surface) = road_surface(symbol.surface, width_m) else { continue };
        let feature = symbol.feature.index().and_then(|index| scene.features.get(index));
        let name = feature.map_or_else(String::new, |feature| feature.name.clone());
        if let Some(deck) = &symbol.deck {
            let line = on_map(deck.line.points());
            crossings.push(Crossing {
                name: name.clone(),
                kind: CrossingKind::Bridge,
                line,
                width_m,
                load_t: None,
            });
        }
        roads.push(RoadLine { name, line: on_map(symbol.alignment.line.points()), surface, width_m });
    }
    (roads, crossings)
}

/// The meshes of buildings.
fn buildings(scene: &SceneModel) -> impl Iterator<Item = (&DrawMesh, FeatureKind)> {
    scene.solids.iter().filter_map(|solid| {
        let kind = scene.features.get(solid.feature.index()?)?.kind;
        (kind == FeatureKind::Building).then_some((&solid.mesh, kind))
    })
}

/// Calls `visit` with each triangle of a mesh in plan, and the heights of its corners.
fn mesh_triangles(mesh: &DrawMesh, mut visit: impl FnMut([DVec2; 3], [f64; 3])) {
    for triangle in &mesh.triangles {
        let corners = triangle.map(|vertex| mesh.vertices[vertex.index()].position);
        visit(
            corners.map(|[x, y, _]| Vec2::new(x, y).as_dvec2()),
            corners.map(|[_, _, height]| f64::from(height)),
        );
    }
}

/// The heights above the ground of buildings and of trees.
fn obstacles(scene: &SceneModel, grid: &PostGrid<'_>) -> Vec<f32> {
    let mut heights = vec![0.0_f32; grid.posts()];
    let ground = scene.lattice.heights();
    for (mesh, _) in buildings(scene) {
        mesh_triangles(mesh, |plan, levels| {
            grid.triangle(plan, |index, weights| {
                let top = weights.iter().zip(levels).map(|(weight, level)| weight * level).sum::<f64>();
                let above = top as f32 - ground[index];
                heights[index] = heights[index].max(if above.is_nan() { 0.0 } else { above });
            });
        });
    }
    let crowns =
        CrownGround::new(scene.lattice.cell().as_vec2(), [scene.lattice.columns(), scene.lattice.rows()]);
    let sizes: Vec<(f32, f32)> = scene
        .models
        .iter()
        .map(|model| (crown_reach(model), model.bounds().map_or(0.0, |bounds| bounds.max.z)))
        .collect();
    for placement in &scene.placements {
        let (reach, top) = sizes[placement.model];
        let height_m = top * placement.scale;
        crowns.visit(placement.at, reach * placement.scale, |index, near| {
            if near > 0.0 {
                heights[index] = heights[index].max(height_m);
            }
        });
    }
    heights
}

/// The spacing of the trees that stand in squares of [`STAND_POSTS`] posts; stems are unknown.
fn stands(scene: &SceneModel) -> Vec<Stand> {
    let (columns, rows) = (scene.lattice.columns(), scene.lattice.rows());
    let across = columns.div_ceil(STAND_POSTS) as usize;
    let mut counts = vec![0_u32; across * rows.div_ceil(STAND_POSTS) as usize];
    let cell = scene.lattice.cell();
    let last = Post { column: columns - 1, row: rows - 1 };
    let square =
        |column: u32, row: u32| (row / STAND_POSTS) as usize * across + (column / STAND_POSTS) as usize;
    let trees = scene.placements.iter().filter(|placement| !scene.models[placement.model].tints.is_empty());
    for tree in trees {
        let post = Post::at_grid((tree.at.as_dvec2() / cell).round());
        counts[square(post.column.min(last.column), post.row.min(last.row))] += 1;
    }
    let square_m2 = f64::from(STAND_POSTS * STAND_POSTS) * scene.lattice.cell_m2();
    let stand = |index: u32| {
        let count = counts[square(index % columns, index / columns)];
        let spacing_m = if count == 0 { 0.0 } else { (square_m2 / f64::from(count)).sqrt() as f32 };
        Stand { spacing_m, stem_m: if count == 0 { 0.0 } else { f32::NAN } }
    };
    (0..columns * rows).map(stand).collect()
}

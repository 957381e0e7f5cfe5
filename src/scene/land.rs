//! The land of a scene for terrain analysis: its covers, roads, water, woods, buildings and bridges, a value a post.
//!
//! What lies on the ground is laid over the posts in drawing order, so that a post has what a picture shows there. Rivers
//! narrower than the posts lie apart take each post along their centerlines: a stream does not vanish between posts.

use glam::{DVec2, Vec2};

use crate::feature::FeatureKind;
use crate::fences::{Barrier, BarrierKind};
use crate::placed_model::Placement;
use crate::scene_model::SceneModel;
use crate::symbols::LineSymbol;
use crate::undergrowth::{CrownGround, crown_reach};
use crate::vertical_scale::VerticalScale;
use sandtable_analysis::land::{
    self, Crossing, CrossingKind, Gap, Land, RoadLine, Stand, Step, WaterKind, WaterPost,
};
use sandtable_analysis::line_posts::along_line;
use sandtable_catalog::kind::LandPart;
use sandtable_description::words::Cover;
use sandtable_draw::list::{DrawMesh, FeatureId};
use sandtable_geom::leg_tree::{LegTree, LineLeg};
use sandtable_geom::segment;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;

/// Widths in meters from which a paved road is a motorway, and a main road.
const MOTORWAY_M: f64 = 15.0;
const MAIN_M: f64 = 9.0;

/// A track narrower than this is a path, meters.
const TRACK_M: f64 = 2.0;

/// Streams narrower than this run below roads through a pipe, meters.
const CULVERT_M: f64 = 3.0;

/// How far a road over a culvert reaches on either side of its stream, meters.
const CULVERT_ROAD_M: f64 = 10.0;

/// The height of forests and orchards whose trees the scene does not state, meters: a grown wood of mean yield, and
/// fruit trees.
const FOREST_M: f32 = 15.0;
const ORCHARD_M: f32 = 4.0;

/// Trees are counted in squares of so many posts: fewer would hold one tree or none.
const STAND_POSTS: u32 = 5;

/// The land of a scene, true to scale, with these of its layers; the others are unknown.
pub fn land_of(scene: &SceneModel, layers: &[LandPart]) -> Land {
    let mut land = Land::bare(scene.lattice.clone(), scene.crs.clone());
    land.vehicles.clone_from(&scene.vehicles);
    for Barrier { line, kind } in &scene.barriers {
        let line = on_map(scene, line);
        match *kind {
            BarrierKind::Step(height_m) => land.steps.push(Step { line, height_m }),
            BarrierKind::Gap(width_m) => land.gaps.push(Gap { line, width_m }),
        }
    }
    for layer in layers {
        match layer {
            LandPart::Cover => land.cover = covers(scene),
            LandPart::Roads => land.roads = Some(roads(scene)),
            LandPart::Crossings => {
                land.crossings = bridges(scene);
                land.crossings.extend(culverts(scene));
                land.crossings.extend(inferred_culverts(scene));
                land.knows_crossings = true;
            }
            LandPart::Water => land.water = Some(waters(scene)),
            LandPart::Woods => land.woods = Some(stands(scene)),
            LandPart::Obstacles => land.obstacles_m = Some(obstacles(scene)),
        }
    }
    land
}

/// [`land_of`] a scene whose heights may be drawn exaggerated: what stands on the ground then has its height from the same scene
/// `true_to_scale`, to the last bit, which is opened only for that.
///
/// # Errors
/// Those of `true_to_scale`.
pub fn land_of_drawn<E>(
    scene: &SceneModel,
    layers: &[LandPart],
    true_to_scale: impl FnOnce() -> Result<SceneModel, E>,
) -> Result<Land, E> {
    let mut land = land_of(scene, layers);
    if scene.scale != VerticalScale(1.0) && layers.contains(&LandPart::Obstacles) {
        land.obstacles_m = land_of(&true_to_scale()?, &[LandPart::Obstacles]).obstacles_m;
    }
    Ok(land)
}

/// Calls `visit` with the index of each post in a triangle of world positions, and its barycentric weights.
fn posts_in(lattice: &Lattice, corners: [DVec2; 3], mut visit: impl FnMut(usize, [f64; 3])) {
    let [a, b, c] = corners.map(|corner| lattice.grid_at(corner));
    let area = (b - a).perp_dot(c - a);
    if !area.is_finite() || area == 0.0 {
        return;
    }
    let Some(around) = PostRect::between(lattice, a.min(b).min(c), a.max(b).max(c)) else { return };
    for post in around.posts() {
        let at = post.grid();
        let weights = [(b - at).perp_dot(c - at), (c - at).perp_dot(a - at), (a - at).perp_dot(b - at)]
            .map(|part| part / area);
        if weights.iter().all(|&weight| weight >= 0.0) {
            visit(lattice.index(post), weights);
        }
    }
}

fn corners(plan: [sandtable_ribbon::plan::PlanVertex; 3]) -> [DVec2; 3] {
    plan.map(|vertex| vertex.at)
}

/// The covers of areas, and the roofs of buildings; `None` where the scene has neither.
fn covers(scene: &SceneModel) -> Option<Vec<land::LandCover>> {
    let mut covers = vec![land::LandCover::Unknown; scene.lattice.heights().len()];
    let mut is_known = false;
    for ribbon in &scene.ribbons {
        let RibbonSurface::Cover(cover) = ribbon.surface else { continue };
        let Some(cover) = land_cover(cover) else { continue };
        is_known = true;
        for triangle in ribbon.plan.corners() {
            posts_in(&scene.lattice, corners(triangle), |index, _| covers[index] = cover);
        }
    }
    for mesh in buildings(scene) {
        is_known = true;
        mesh_triangles(mesh, |plan, _| {
            posts_in(&scene.lattice, plan, |index, _| covers[index] = land::LandCover::Building)
        });
    }
    is_known.then_some(covers)
}

/// What a cover of a scene is for movement; `None` of what says nothing about the ground.
fn land_cover(cover: Cover) -> Option<land::LandCover> {
    Some(match cover {
        Cover::Forest => land::LandCover::Wood,
        Cover::Scrub | Cover::Heath => land::LandCover::Scrub,
        Cover::Meadow => land::LandCover::Open,
        Cover::Field => land::LandCover::Crops,
        Cover::Orchard | Cover::Vineyard => land::LandCover::Orchard,
        Cover::Wetland => land::LandCover::Wetland,
        Cover::Sand => land::LandCover::Sand,
        Cover::Rock | Cover::Scree | Cover::Glacier | Cover::Quarry => land::LandCover::Rock,
        Cover::Paved => land::LandCover::Paved,
        Cover::BuiltUp | Cover::DenseBuiltUp | Cover::Industry => land::LandCover::BuiltUp,
        _ => return None,
    })
}

/// Water of features, and what the elevations themselves show.
fn waters(scene: &SceneModel) -> Vec<WaterPost> {
    let inferred = scene.water();
    let level = if scene.has_sea() && inferred.lakes.is_empty() { WaterKind::Sea } else { WaterKind::Lake };
    let post = |kind| WaterPost { kind, depth_m: f32::NAN };
    let mut waters = vec![WaterPost::default(); scene.lattice.heights().len()];
    for (water, _) in waters.iter_mut().zip(&inferred.is_water).filter(|(_, is_water)| **is_water) {
        *water = post(level);
    }
    for ribbon in &scene.ribbons {
        let kind = match ribbon.surface {
            surface if surface.is_channel() => WaterKind::River,
            RibbonSurface::Lake => WaterKind::Lake,
            _ => continue,
        };
        if is_in_culvert(scene, ribbon.feature) {
            continue;
        }
        for triangle in ribbon.plan.corners() {
            posts_in(&scene.lattice, corners(triangle), |index, _| waters[index] = post(kind));
        }
    }
    let is_open = |symbol: &&LineSymbol| is_river(symbol) && !is_in_culvert(scene, symbol.feature);
    for symbol in scene.symbols.iter().filter(is_open) {
        along_line(&scene.lattice, &on_map(scene, symbol.alignment.line.points()), 0.0, |index| {
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

/// A line of world positions in map coordinates.
fn on_map(scene: &SceneModel, line: &[DVec2]) -> Vec<DVec2> {
    line.iter().map(|at| scene.lattice.origin() + *at).collect()
}

/// The roads, each with its symbol.
fn ways(scene: &SceneModel) -> impl Iterator<Item = (RoadLine, &LineSymbol)> {
    scene.symbols.iter().filter_map(|symbol| {
        let width_m = symbol.alignment.width.at(0.0);
        let surface = road_surface(symbol.surface, width_m)?;
        let feature = symbol.feature.index().and_then(|index| scene.features.get(index));
        let name = feature.map_or_else(String::new, |feature| feature.name.clone());
        let line = on_map(scene, symbol.alignment.line.points());
        Some((RoadLine { name, line, surface, width_m }, symbol))
    })
}

fn roads(scene: &SceneModel) -> Vec<RoadLine> {
    ways(scene).map(|(road, _)| road).collect()
}

fn bridges(scene: &SceneModel) -> Vec<Crossing> {
    let bridge = |(RoadLine { name, width_m, .. }, symbol): (RoadLine, &LineSymbol)| {
        let line = on_map(scene, symbol.deck.as_ref()?.line.points());
        Some(Crossing { name, kind: CrossingKind::Bridge, line, width_m, load_t: None })
    };
    ways(scene).filter_map(bridge).collect()
}

/// Whether a river runs in a culvert that the data have.
fn is_in_culvert(scene: &SceneModel, river: FeatureId) -> bool {
    // In the order of their features.
    scene.culverts.binary_search_by_key(&river.0, |culvert| culvert.feature.0).is_ok()
}

/// The culverts that the data have.
fn culverts(scene: &SceneModel) -> impl Iterator<Item = Crossing> {
    scene.culverts.iter().map(|culvert| {
        let feature = culvert.feature.index().and_then(|index| scene.features.get(index));
        let name = feature.map_or_else(String::new, |feature| feature.name.clone());
        let (line, width_m) = (on_map(scene, culvert.line.points()), culvert.width_m);
        Crossing { name, kind: CrossingKind::Culvert, line, width_m, load_t: None }
    })
}

/// The roads on the ground over streams narrower than [`CULVERT_M`]: each of these runs through a pipe, which no map shows.
fn inferred_culverts(scene: &SceneModel) -> Vec<Crossing> {
    let is_open = |symbol: &&LineSymbol| is_river(symbol) && !is_in_culvert(scene, symbol.feature);
    let streams: Vec<&LineSymbol> = scene.symbols.iter().filter(is_open).collect();
    let legs =
        streams.iter().enumerate().flat_map(|(index, symbol)| LineLeg::all(index, &symbol.alignment.line));
    let legs = LegTree::new(legs.collect());
    if legs.legs().is_empty() {
        return Vec::new();
    }
    let snapshot = scene.heights.snapshot();
    let is_bridged = |at: DVec2| snapshot.decks().is_some_and(|decks| decks.height_m(at).is_some());
    let mut culverts = Vec::new();
    for (RoadLine { name, width_m, .. }, symbol) in ways(scene).filter(|(_, symbol)| symbol.deck.is_none()) {
        let line = &symbol.alignment.line;
        for leg in LineLeg::all(0, line) {
            for near in legs.near(&leg) {
                let other = &legs.legs()[near];
                let ends = |leg: &LineLeg| (leg.ends[0], leg.ends[1]);
                let Some([part, along]) = segment::crossing(ends(&leg), ends(other)) else { continue };
                let stream_m = streams[other.line]
                    .alignment
                    .width
                    .at(other.stations[0] + (other.stations[1] - other.stations[0]) * along);
                if stream_m >= CULVERT_M || is_bridged(leg.ends[0].lerp(leg.ends[1], part)) {
                    continue;
                }
                let station_m = leg.stations[0] + (leg.stations[1] - leg.stations[0]) * part;
                let over = line.between(station_m - CULVERT_ROAD_M, station_m + CULVERT_ROAD_M);
                let (kind, line) = (CrossingKind::InferredCulvert, on_map(scene, &over));
                culverts.push(Crossing { name: name.clone(), kind, line, width_m, load_t: None });
            }
        }
    }
    culverts
}

/// The meshes of buildings.
fn buildings(scene: &SceneModel) -> impl Iterator<Item = &DrawMesh> {
    let is_building = |feature: FeatureId| {
        let feature = feature.index().and_then(|index| scene.features.get(index));
        feature.is_some_and(|feature| feature.kind == FeatureKind::Building)
    };
    scene.solids.iter().filter(move |solid| is_building(solid.feature)).map(|solid| &solid.mesh)
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

/// The heights above the ground of buildings and of trees; of forests and orchards those of the trees that the scene has around
/// a post, or else [`FOREST_M`] and [`ORCHARD_M`].
fn obstacles(scene: &SceneModel) -> Vec<f32> {
    let mut heights = vec![0.0_f32; scene.lattice.heights().len()];
    let ground = scene.lattice.heights();
    for mesh in buildings(scene) {
        mesh_triangles(mesh, |plan, levels| {
            posts_in(&scene.lattice, plan, |index, weights| {
                let top = weights.iter().zip(levels).map(|(weight, level)| weight * level).sum::<f64>();
                let above = top as f32 - scene.scale.world_z(ground[index]);
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
    let squares = StandSquares::new(scene);
    let mut tallest_m = vec![0.0_f32; squares.count()];
    for placement in trees(scene) {
        let tallest_m = &mut tallest_m[squares.at(placement.at)];
        *tallest_m = tallest_m.max(sizes[placement.model].1 * placement.scale);
    }
    for (index, (height_m, usual_m)) in (0..).zip(heights.iter_mut().zip(area_heights(scene))) {
        if *height_m <= 0.0 && usual_m > 0.0 {
            let around_m = tallest_m[squares.of(index)];
            *height_m = if around_m > 0.0 { around_m } else { usual_m };
        }
    }
    heights
}

/// The usual height of what grows on forests and orchards, meters; 0 elsewhere, as on the roads and waters through them.
fn area_heights(scene: &SceneModel) -> Vec<f32> {
    let mut heights = vec![0.0; scene.lattice.heights().len()];
    for ribbon in &scene.ribbons {
        let height_m = match ribbon.surface {
            RibbonSurface::Cover(Cover::Forest) => FOREST_M,
            RibbonSurface::Cover(Cover::Orchard) => ORCHARD_M,
            RibbonSurface::Cover(cover) if land_cover(cover).is_none() => continue,
            _ => 0.0,
        };
        for triangle in ribbon.plan.corners() {
            posts_in(&scene.lattice, corners(triangle), |index, _| heights[index] = height_m);
        }
    }
    heights
}

/// The trees of a scene, among its models.
fn trees(scene: &SceneModel) -> impl Iterator<Item = &Placement> {
    scene.placements.iter().filter(|placement| !scene.models[placement.model].tints.is_empty())
}

/// Squares of [`STAND_POSTS`] posts.
struct StandSquares {
    cell: DVec2,
    last: Post,
    across: usize,
}

impl StandSquares {
    fn new(scene: &SceneModel) -> Self {
        let (columns, rows) = (scene.lattice.columns(), scene.lattice.rows());
        let across = columns.div_ceil(STAND_POSTS) as usize;
        Self { cell: scene.lattice.cell(), last: Post { column: columns - 1, row: rows - 1 }, across }
    }

    fn count(&self) -> usize {
        self.across * (self.last.row / STAND_POSTS + 1) as usize
    }

    /// The square of a post.
    fn of(&self, index: u32) -> usize {
        let columns = self.last.column + 1;
        self.square(index % columns, index / columns)
    }

    /// The square of a place in the world.
    fn at(&self, place: Vec2) -> usize {
        let post = Post::at_grid((place.as_dvec2() / self.cell).round());
        self.square(post.column.min(self.last.column), post.row.min(self.last.row))
    }

    fn square(&self, column: u32, row: u32) -> usize {
        (row / STAND_POSTS) as usize * self.across + (column / STAND_POSTS) as usize
    }
}

/// The spacing of the trees that stand in squares of [`STAND_POSTS`] posts; stems are unknown.
fn stands(scene: &SceneModel) -> Vec<Stand> {
    let squares = StandSquares::new(scene);
    let mut counts = vec![0_u32; squares.count()];
    trees(scene).for_each(|tree| counts[squares.at(tree.at)] += 1);
    let square_m2 = f64::from(STAND_POSTS * STAND_POSTS) * scene.lattice.cell_m2();
    let stand = |index: u32| {
        let count = counts[squares.of(index)];
        let spacing_m = if count == 0 { 0.0 } else { (square_m2 / f64::from(count)).sqrt() as f32 };
        Stand { spacing_m, stem_m: if count == 0 { 0.0 } else { f32::NAN } }
    };
    (0..scene.lattice.columns() * scene.lattice.rows()).map(stand).collect()
}

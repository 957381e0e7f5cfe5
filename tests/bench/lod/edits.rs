//! Dynamic terrain: what mending after a small edit costs beside making everything anew; and what constraining the
//! spheres by local roughness (Yu and Zhang) saves at the same height difference.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use glam::{DVec2, Vec3};
use sandtable_dem::hints::DemHints;
use sandtable_dem::read::read;
use sandtable_earthworks::brush::{BrushChanges, set_heights};
use sandtable_mesh::trimesh::TriMesh;
use sandtable_raster::warp::to_metric;
use sandtable_roam::criterion::spheres::Spheres;
use sandtable_roam::culling::patches_in_view;
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_roam::dynamic::{DynamicOptions, DynamicTerrain, ErrorMeasure, Radius};
use sandtable_roam::edit::{mend_exact, mend_midpoint, mend_spheres};
use sandtable_roam::errors::ErrorMap;
use sandtable_roam::errors::exact::own_errors;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::refine::deferred::Deferred;
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_roam::roughness::Roughness;
use sandtable_roam::spheres::{OwnRadius, SphereMap};
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_view::frustum::Frustum;

use crate::fields::fractal;
use crate::flight;

/// Edits whose median and maximum are told.
const EDITS: u32 = 200;

/// Posts along the side of an edit.
const SIDE: u32 = 33;

/// Meters of distance per meter of error: about 1.5 pixels at 768 rows and 47°.
const REACH: f32 = 600.0;

/// Rebuilds whose least counts.
const REBUILDS: usize = 3;

/// Prints all tables.
pub fn print() {
    print_nesting();
    print_edits();
    print_walked();
    print_constrained();
}

fn print_nesting() {
    println!("\nNesting plain spheres over midpoint errors, ms, least of {REBUILDS}");
    for posts in [513, 4097] {
        let lattice = ground(posts);
        let layout = PatchLayout::new(posts, posts, 64).expect("sound");
        let errors = ErrorMap::midpoint(&lattice, &layout);
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        let [one, two] = [1, 2].map(|threads| {
            let pool =
                rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had");
            let make = || timed(|| SphereMap::plain(ground, &errors, REACH)).1 / 1e3;
            pool.install(|| (0..REBUILDS).map(|_| make()).fold(f64::INFINITY, f64::min))
        });
        println!("{:<24}{one:>10.1} with one thread{two:>10.1} with two", format!("{posts}²"));
    }
}

fn print_edits() {
    println!(
        "\nA {SIDE}×{SIDE} edit: µs to mend, median (least..largest) of {EDITS}, and to make anew, least of {REBUILDS}"
    );
    println!(
        "{:<24}{:>24}{:>24}{:>12}{:>9}{:>24}{:>9}",
        "posts, patch, errors", "errors", "with spheres", "anew", "ratio", "whole edit", "unequal"
    );
    let only = std::env::var("SANDTABLE_BENCH_SIDE").ok().and_then(|side| side.parse().ok());
    for posts in [513, 1025, 4097].into_iter().filter(|&posts| only.is_none_or(|only: u32| only == posts)) {
        let lattice = ground(posts);
        for (patch, measure) in
            [(64, ErrorMeasure::Midpoint), (posts - 1, ErrorMeasure::Midpoint), (64, ErrorMeasure::Exact)]
        {
            print_row(&lattice, patch, measure);
        }
    }
}

fn print_row(lattice: &Lattice, patch: u32, measure: ErrorMeasure) {
    let mut lattice = lattice.clone();
    let layout = PatchLayout::new(lattice.columns(), lattice.rows(), patch).expect("sound");
    let anew =
        (0..REBUILDS).map(|_| timed(|| make(&lattice, &layout, measure)).1).fold(f64::INFINITY, f64::min);
    let mut maps = make(&lattice, &layout, measure);
    let (mut errors_us, mut both_us) = (Vec::new(), Vec::new());
    for number in 0..EDITS {
        let changes = bump(&mut lattice, number);
        let change = changes.pieces.first().expect("a bump changes heights");
        let (errors, spent) = timed(|| match measure {
            ErrorMeasure::Midpoint => mend_midpoint(&mut maps.errors, &lattice, &layout, change),
            ErrorMeasure::Exact => mend_exact(&mut maps.own, &mut maps.errors, &lattice, &layout, change),
        });
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        let own = own_radius(&maps.errors, measure);
        let (_, more) = timed(|| mend_spheres(&mut maps.spheres, ground, &own, change, &errors));
        errors_us.push(spent);
        both_us.push(spent + more);
    }
    let fresh = make(&lattice, &layout, measure);
    let unequal = different(maps.errors.values(), fresh.errors.values())
        + different(maps.spheres.values(), fresh.spheres.values());
    let whole_us = whole_edits(&lattice, patch, measure);
    let ratio = anew / median(&both_us);
    println!(
        "{:<24}{:>24}{:>24}{:>12.0}{:>9.0}{:>24}{:>9}",
        format!("{}², {patch}, {measure:?}", lattice.columns()),
        told(&errors_us),
        told(&both_us),
        anew,
        ratio,
        told(&whole_us),
        unequal
    );
}

/// Edits of a terrain that mends everything and tells the dirty patches, writing the heights included.
fn whole_edits(lattice: &Lattice, patch: u32, measure: ErrorMeasure) -> Vec<f64> {
    let radius = match measure {
        ErrorMeasure::Midpoint => Radius::Plain,
        ErrorMeasure::Exact => Radius::Bounding,
    };
    let options = DynamicOptions { patch, measure, radius, reach: REACH };
    let mut terrain = DynamicTerrain::new(lattice.clone(), options).expect("sound");
    (0..EDITS).map(|number| timed(|| terrain.edit(|lattice| bump(lattice, number + EDITS))).1).collect()
}

/// Edits before the eye of a walk: writing and mending, then telling the walk, then its mesh and index lists.
fn print_walked() {
    let posts = 4097;
    let heights = fractal(posts);
    let camera = flight::cameras(&heights, 1.0, 1)[0];
    let options =
        DynamicOptions { patch: 64, measure: ErrorMeasure::Midpoint, radius: Radius::Plain, reach: REACH };
    let terrain = DynamicTerrain::new(flight::lattice(&heights), options).expect("sound");
    let mut walk = Deferred::new(terrain, f64::from(flight::CELL_M)).expect("small patches");
    let patches = patches_in_view(walk.source().ground(), walk.source().heights(), &Frustum::new(&camera));
    walk.update(camera.eye(), &patches).expect("in memory");
    let ahead = (camera.eye() + camera.forward() * 100.0 * flight::CELL_M) / flight::CELL_M;
    let [mut edit_us, mut mesh_us] = [Vec::new(), Vec::new()];
    for number in 0..EDITS {
        let off = |prime: u32| (number * prime % 61) as f32 - 30.0;
        let first = Post { column: (ahead.x + off(17)) as u32, row: (ahead.y + off(29)) as u32 };
        let source = walk.source_mut();
        let (edit, spent) = timed(|| source.edit(|lattice| bump_at(lattice, first)));
        let edit = edit.expect("a bump changes heights");
        edit_us.push(spent);
        let (_, spent) = timed(|| {
            walk.mend(&edit).expect("in memory");
            walk.update(camera.eye(), &patches).expect("in memory");
        });
        mesh_us.push(spent);
    }
    walk.check();
    println!(
        "\nThe same before the eye of a walk, {posts}², {} triangles in view: µs for the edit {}, for mesh and index lists {}",
        walk.triangle_count(),
        told(&edit_us),
        told(&mesh_us)
    );
}

struct Maps {
    own: Vec<f32>,
    errors: ErrorMap,
    spheres: SphereMap,
}

fn make(lattice: &Lattice, layout: &PatchLayout, measure: ErrorMeasure) -> Maps {
    let (own, errors) = match measure {
        ErrorMeasure::Midpoint => (Vec::new(), ErrorMap::midpoint(lattice, layout)),
        ErrorMeasure::Exact => {
            let own = own_errors(lattice, layout);
            (own.clone(), ErrorMap::raised(own, layout))
        }
    };
    let ground = PatchedGround { lattice, layout };
    let spheres = SphereMap::new(ground, &own_radius(&errors, measure));
    Maps { own, errors, spheres }
}

fn own_radius(errors: &ErrorMap, measure: ErrorMeasure) -> OwnRadius<'_> {
    match measure {
        ErrorMeasure::Midpoint => OwnRadius::Plain { errors, reach: REACH },
        ErrorMeasure::Exact => OwnRadius::Bounding { errors, reach: REACH },
    }
}

/// Raises a round bump of 5 m at one of many places.
fn bump(lattice: &mut Lattice, number: u32) -> BrushChanges {
    let places = lattice.columns() - SIDE;
    let at = |prime: u32| (u64::from(number) * u64::from(prime) % u64::from(places)) as u32;
    let first = Post { column: at(7919), row: at(104_729) };
    bump_at(lattice, first)
}

/// Raises a round bump of 5 m whose south-west corner is `first`.
fn bump_at(lattice: &mut Lattice, first: Post) -> BrushChanges {
    let last = Post { column: first.column + SIDE - 1, row: first.row + SIDE - 1 };
    let posts = PostRect { first, last };
    let half = f64::from(SIDE / 2);
    let raised = |post: Post| {
        let off = DVec2::new(f64::from(post.column - first.column), f64::from(post.row - first.row)) - half;
        lattice.height(post) + (5.0 * (1.0 - off.length() / 23.0)) as f32
    };
    let heights: Vec<f32> = posts.posts().map(raised).collect();
    set_heights(lattice, posts, &heights)
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let made = work();
    (made, start.elapsed().as_secs_f64() * 1e6)
}

fn median(times: &[f64]) -> f64 {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

fn told(times: &[f64]) -> String {
    let least = times.iter().copied().fold(f64::INFINITY, f64::min);
    format!("{:.1} ({:.1}..{:.0})", median(times), least, times.iter().copied().fold(0.0, f64::max))
}

fn different(a: &[f32], b: &[f32]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a.to_bits() != b.to_bits()).count()
}

/// Fractal ground, 10 m between posts.
fn ground(posts: u32) -> Lattice {
    Lattice::new(DVec2::ZERO, DVec2::splat(10.0), posts, fractal(posts as usize)).expect("sound")
}

/// Real ground: its name and place in the test data.
const GROUNDS: [(&str, &str); 3] = [
    ("crater", "scenes/crater_lake_bt/crater.bt"),
    ("big tujunga", "dem/bigtujunga_utm11_i16_tiled.tif"),
    ("swellendam", "scenes/swellendam_za/dem_srtm_wgs84_f32.tif"),
];

/// Times the plain spheres' reach within which the constrained ones' is sought, doublings either way.
const SEARCH: (f32, f32) = (0.25, 4096.0);

fn print_constrained() {
    println!(
        "\nSpheres constrained by local roughness (3×3) against plain ones, eight eyes, means over all posts"
    );
    println!(
        "{:<14}{:>12}{:>8}{:>22}{:>30}{:>34}",
        "ground", "posts", "reach", "plain", "constrained, same reach", "constrained, same mean"
    );
    for (name, path) in GROUNDS {
        let path = Path::new(env!("SANDTABLE_ROOT")).join("../shared/data").join(path);
        let Some(lattice) = real(&path) else {
            println!("{name:<14}SKIPPED: no elevation model at {}", path.display());
            continue;
        };
        let lattice = Arc::new(lattice);
        for reach in [150.0, REACH] {
            compare(name, &lattice, reach);
        }
    }
}

fn real(path: &Path) -> Option<Lattice> {
    let bytes = std::fs::read(path).ok()?;
    let companions = |name: &str| std::fs::read(name).ok();
    let hints = DemHints { companions: &companions, ..DemHints::default() };
    let raster = read(&path.to_string_lossy(), &bytes, &hints).expect("a file of the test data");
    Some(Lattice::from_raster(&to_metric(&raster, None).expect("it has a place")).expect("it holds ground"))
}

/// What eight eyes see, on average.
#[derive(Clone, Copy)]
struct Sight {
    triangles: f64,
    mean_m: f64,
}

fn compare(name: &str, lattice: &Arc<Lattice>, reach: f32) {
    let layout = PatchLayout::new(lattice.columns(), lattice.rows(), 64).expect("sound");
    let ground = PatchedGround { lattice, layout: &layout };
    let errors = ErrorMap::midpoint(lattice, &layout);
    let roughness = Roughness::new(lattice, (1, 1));
    let plain = see(lattice, &layout, &SphereMap::plain(ground, &errors, reach));
    let constrained = |reach: f32| see(lattice, &layout, &SphereMap::constrained(ground, reach, &roughness));
    let same_reach = constrained(reach);
    let (mut low, mut high) = (reach * SEARCH.0, reach * SEARCH.1);
    for _ in 0..18 {
        let middle = (low * high).sqrt();
        if constrained(middle).mean_m > plain.mean_m { low = middle } else { high = middle }
    }
    let same_mean = constrained(high);
    let sight = |sight: Sight| format!("{:.0}, {:.3} m", sight.triangles, sight.mean_m);
    println!(
        "{name:<14}{:>12}{reach:>8.0}{:>22}{:>30}{:>34}",
        format!("{}×{}", lattice.columns(), lattice.rows()),
        sight(plain),
        format!("{} ({:.3}×)", sight(same_reach), same_reach.triangles / plain.triangles),
        format!(
            "{} ({:.3}×, reach ×{:.2})",
            sight(same_mean),
            same_mean.triangles / plain.triangles,
            high / reach
        ),
    );
}

fn see(lattice: &Arc<Lattice>, layout: &PatchLayout, spheres: &SphereMap) -> Sight {
    let ground = PatchedGround { lattice, layout };
    let (far, top) = (lattice.extent().max.as_vec2(), lattice.height_range().1);
    let eyes = (0..8u16).map(|eye| {
        let angle = f32::from(eye) * std::f32::consts::FRAC_PI_4;
        let plan = far * 0.5 + far * 0.35 * glam::Vec2::new(angle.cos(), angle.sin());
        plan.extend(top + 100.0)
    });
    let seen: Vec<Sight> = eyes.map(|eye: Vec3| see_from(lattice, ground, spheres, eye)).collect();
    let mean = |part: fn(&Sight) -> f64| seen.iter().map(part).sum::<f64>() / seen.len() as f64;
    Sight { triangles: mean(|sight| sight.triangles), mean_m: mean(|sight| sight.mean_m) }
}

fn see_from(lattice: &Arc<Lattice>, ground: PatchedGround<'_>, spheres: &SphereMap, eye: Vec3) -> Sight {
    let layout = ground.layout;
    let active = rebuild(layout, &Spheres::new(ground, spheres, eye), layout.patches());
    let shown = DisplayedTerrain::new(Arc::clone(lattice), active, layout.patches().collect());
    let mut mesh = TriMesh::default();
    shown.emit(&mut mesh);
    Sight { triangles: mesh.triangles.len() as f64, mean_m: mean_difference(lattice, &mesh) }
}

/// The mean of |mesh − ground| over all posts that the mesh covers, meters.
fn mean_difference(lattice: &Lattice, mesh: &TriMesh) -> f64 {
    let mut seen = vec![false; lattice.heights().len()];
    let (mut sum, mut count) = (0.0, 0u64);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|id| {
            let at = mesh.positions[id.index()].as_dvec3();
            let grid = (at.truncate() / lattice.cell()).round();
            grid.extend(at.z)
        });
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let area = (b - a).truncate().perp_dot((c - a).truncate());
        for row in low.y as u32..=high.y as u32 {
            for column in low.x as u32..=high.x as u32 {
                let at = DVec2::new(f64::from(column), f64::from(row));
                let part = |from: glam::DVec3, to: glam::DVec3| {
                    (to - from).truncate().perp_dot(at - from.truncate()) / area
                };
                let (to_c, to_a, to_b) = (part(a, b), part(b, c), part(c, a));
                let post = Post { column, row };
                if to_a >= 0.0
                    && to_b >= 0.0
                    && to_c >= 0.0
                    && !std::mem::replace(&mut seen[lattice.index(post)], true)
                {
                    let z = a.z * to_a + b.z * to_b + c.z * to_c;
                    let off = (z - f64::from(lattice.height(post))).abs();
                    if !off.is_nan() {
                        sum += off;
                        count += 1;
                    }
                }
            }
        }
    }
    sum / count as f64
}

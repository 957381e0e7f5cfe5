//! What turning bits into triangles costs, and what must be sent for them.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec2;
use sandtable_mesh::trimesh::TriMesh;
use sandtable_roam::active::ActiveSet;
use sandtable_roam::bintree::Triangle;
use sandtable_roam::criterion::flat::Flat;
use sandtable_roam::emit::bintree::VertexBlock;
use sandtable_roam::emit::geomipmap::{self, PatchLevels, Pyramids};
use sandtable_roam::emit::strips::{StripStats, Strips};
use sandtable_roam::emit::{bintree, full, quadtree, world};
use sandtable_roam::errors::ErrorMap;
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_terrain::lattice::Lattice;

use crate::fields::fractal;

/// Posts along a side of the field.
const POSTS: u32 = 1025;

/// Rounds that the least time of each row is taken from; all rows take turns.
const ROUNDS: usize = 31;

/// Prints the section.
pub fn print() {
    let heights = fractal(POSTS as usize);
    let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), POSTS, heights).expect("sound");
    let layout = PatchLayout::new(POSTS, POSTS, 64).expect("sound");
    let errors = ErrorMap::exact(&lattice, &layout);
    let pyramids = Pyramids::new(&lattice, &layout);
    println!("Emitters, fractal {POSTS}², patches of 64, least of {ROUNDS} interleaved rounds");
    for wanted in [20_000, 100_000] {
        let active = bits(&layout, &errors, wanted);
        let levels = levels(&layout, &pyramids, wanted);
        print_rows(&Field { lattice: &lattice, layout: &layout, active: &active, levels: &levels });
    }
}

/// What all rows of a table read.
struct Field<'a> {
    lattice: &'a Lattice,
    layout: &'a PatchLayout,
    active: &'a ActiveSet,
    levels: &'a PatchLevels,
}

/// One way to emit: its name and what makes it do so once, returning what was sent.
type Row<'a> = (&'static str, Box<dyn FnMut() -> StripStats + 'a>);

fn print_rows(field: &Field<'_>) {
    let mut rows = rows(field);
    let mut least = vec![f64::INFINITY; rows.len()];
    let mut sent = vec![StripStats::default(); rows.len()];
    for _ in 0..ROUNDS {
        for (at, (_, emit)) in rows.iter_mut().enumerate() {
            let start = Instant::now();
            sent[at] = emit();
            least[at] = least[at].min(start.elapsed().as_nanos() as f64);
        }
    }
    println!("\n{:<44}{:>11}{:>15}{:>14}{:>9}", "", "triangles", "ns a triangle", "vertices sent", "a strip");
    for ((name, _), (least, sent)) in rows.iter().zip(least.into_iter().zip(sent)) {
        let triangles = sent.triangles as f64;
        println!(
            "{name:<44}{:>11}{:>15.2}{:>14.3}{:>9.1}",
            sent.triangles,
            least / triangles,
            sent.vertices_per_triangle(),
            triangles / sent.strips.max(1) as f64,
        );
    }
}

fn rows<'a>(field: &'a Field<'a>) -> Vec<Row<'a>> {
    let Field { layout, active, levels, .. } = *field;
    let patches = || layout.patches();
    let mut strips = Strips::default();
    let mut list = Vec::new();
    vec![
        (
            "bintree, corner triples split plainly",
            Box::new(|| read(|read| by_corners(active, |at| read.add(at)))),
        ),
        (
            "bintree, grid vertices",
            Box::new(move || read(|read| bintree::triangles(active, patches(), |at| read.add(at)))),
        ),
        ("bintree, 16-bit indices a patch", Box::new(move || index_lists(active, &mut list))),
        (
            "quadtree, grid vertices",
            Box::new(move || read(|read| quadtree::triangles(active, patches(), |at| read.add(at)))),
        ),
        ("quadtree, fans", Box::new(|| fans(active))),
        (
            "strips along the bintree",
            Box::new(move || {
                strips.clear();
                strips.add_patches(active, patches(), |_| true);
                black_box(&strips).stats()
            }),
        ),
        (
            "GeoMipMap",
            Box::new(move || read(|read| geomipmap::triangles(layout, levels, patches(), |at| read.add(at)))),
        ),
        ("full", Box::new(move || read(|read| full::triangles(layout, patches(), |at| read.add(at))))),
        ("bintree, placed, a vertex a post", Box::new(|| placed(field))),
    ]
}

/// Takes triangles and reads every corner, so that none can be left out.
#[derive(Default)]
struct Reader {
    triangles: usize,
    sum: i32,
}

impl Reader {
    fn add(&mut self, corners: [Vertex; 3]) {
        self.triangles += 1;
        self.sum = corners.iter().fold(self.sum, |sum, at| sum.wrapping_add(at.x ^ at.y));
    }
}

/// What a list of an emitter's triangles sends.
fn read(emit: impl FnOnce(&mut Reader)) -> StripStats {
    let mut reader = Reader::default();
    emit(&mut reader);
    black_box(reader.sum);
    StripStats { triangles: reader.triangles, vertices: 3 * reader.triangles, strips: reader.triangles }
}

/// The leaves by triangles of corners on a stack: the plain way beside the walk on indices.
fn by_corners(active: &ActiveSet, mut emit: impl FnMut([Vertex; 3])) {
    let mut stack = Vec::new();
    for corner in active.layout().patches() {
        stack.extend(Triangle::roots(corner, active.layout().patch()));
        while let Some(triangle) = stack.pop() {
            if triangle.is_finest() || !active.is_active(triangle.split_vertex()) {
                emit(triangle.corners());
            } else {
                stack.extend(triangle.split());
            }
        }
    }
}

fn index_lists(active: &ActiveSet, list: &mut Vec<[u16; 3]>) -> StripStats {
    let block = VertexBlock::new(active.layout()).expect("small patches");
    list.clear();
    active.layout().patches().for_each(|corner| block.append(active, corner, |_| true, list));
    StripStats { triangles: list.len(), vertices: 3 * list.len(), strips: list.len() }
}

fn fans(active: &ActiveSet) -> StripStats {
    let (mut sent, mut reader) = (StripStats::default(), Reader::default());
    quadtree::fans(active, active.layout().patches(), |fan| {
        sent.triangles += fan.len() - 2;
        sent.vertices += fan.len();
        sent.strips += 1;
        reader.add([fan[0], fan[1], fan[fan.len() - 1]]);
    });
    black_box(reader.sum);
    sent
}

fn placed(field: &Field<'_>) -> StripStats {
    let mut mesh = TriMesh::default();
    let ground = PatchedGround { lattice: field.lattice, layout: field.layout };
    bintree::triangles(field.active, field.layout.patches(), world::placing(ground, &mut mesh));
    let triangles = black_box(&mesh).triangles.len();
    StripStats { triangles, vertices: mesh.positions.len(), strips: triangles }
}

/// The bits of the object-space tolerance whose mesh has about `wanted` triangles.
fn bits(layout: &PatchLayout, errors: &ErrorMap, wanted: usize) -> ActiveSet {
    let at = |tolerance_m| rebuild(layout, &Flat::new(layout, errors, tolerance_m), layout.patches());
    at(tolerance_for(wanted, |tolerance_m| {
        let active = at(tolerance_m);
        read(|read| bintree::triangles(&active, layout.patches(), |corners| read.add(corners))).triangles
    }))
}

/// The levels of the object-space tolerance whose mesh has about `wanted` triangles.
fn levels(layout: &PatchLayout, pyramids: &Pyramids, wanted: usize) -> PatchLevels {
    let count = |levels: &PatchLevels| {
        read(|read| geomipmap::triangles(layout, levels, layout.patches(), |corners| read.add(corners)))
            .triangles
    };
    pyramids.within(tolerance_for(wanted, |tolerance_m| count(&pyramids.within(tolerance_m))))
}

/// The tolerance in meters that halving finds for about `wanted` triangles.
fn tolerance_for(wanted: usize, triangles: impl Fn(f32) -> usize) -> f32 {
    let (mut fine, mut coarse) = (0f32, 1000f32);
    for _ in 0..20 {
        let middle = (fine + coarse) / 2.0;
        if triangles(middle) > wanted { fine = middle } else { coarse = middle }
    }
    coarse
}

//! Meshes with a bound: what measuring exact errors costs beside other people's midpoint errors, and how many
//! triangles each way of keeping a bound needs.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec2;
use sandtable_mesh::trimesh::TriMesh;
use sandtable_roam::active::ActiveSet;
use sandtable_roam::bound::measure;
use sandtable_roam::closure::least_closure;
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_roam::errors::ErrorMap;
use sandtable_roam::errors::exact::own_errors;
use sandtable_roam::errors::midpoint::midpoint_error_at;
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_terrain::lattice::Lattice;

use crate::fields::fractal;

/// Rounds of each timing; all contestants take turns in every round.
const ROUNDS: usize = 7;

/// Prints both tables.
pub fn print() {
    print_map_times(513, &[512, 64]);
    print_map_times(4097, &[4096]);
    print_triangle_counts(513, &[1.0, 5.0, 20.0]);
}

fn lattice_of(n: usize) -> Lattice {
    Lattice::new(DVec2::ZERO, DVec2::splat(10.0), n as u32, fractal(n)).expect("sound")
}

fn milliseconds(work: &mut dyn FnMut()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64() * 1e3
}

/// A contestant's name and its work.
type Contestant<'a> = (String, Box<dyn FnMut() + 'a>);

fn print_map_times(n: usize, patches: &[u32]) {
    let lattice = lattice_of(n);
    let heights = lattice.heights();
    let columns: Vec<Vec<f32>> = (0..n).map(|x| (0..n).map(|y| heights[y * n + x]).collect()).collect();
    let rtin = martini_rtin::Martini::with_capacity(n);
    let martini = martini::Martini::new(n as u32);
    let mut contestants: Vec<Contestant<'_>> = vec![
        ("midpoint, martini_rtin".into(), Box::new(|| drop(rtin.create_tile(columns.clone())))),
        (
            "midpoint, martini".into(),
            Box::new(|| drop(martini.create_terrain(|x, y| f64::from(heights[y * n + x])))),
        ),
    ];
    for &patch in patches {
        let layout = PatchLayout::new(n as u32, n as u32, patch).expect("sound");
        let lattice = &lattice;
        contestants.push((
            format!("exact, patches of {patch}, own errors"),
            Box::new(move || drop(own_errors(lattice, &layout))),
        ));
        contestants.push((
            format!("exact, patches of {patch}, whole map"),
            Box::new(move || drop(ErrorMap::exact(lattice, &layout))),
        ));
    }
    let mut times = vec![Vec::new(); contestants.len()];
    for _ in 0..if n > 1000 { 3 } else { ROUNDS } {
        for (times, (_, work)) in times.iter_mut().zip(&mut contestants) {
            times.push(milliseconds(work));
        }
    }
    println!("error maps, {n} x {n}: least and median of {} rounds, ms", times[0].len());
    for (times, (name, _)) in times.iter_mut().zip(&contestants) {
        times.sort_by(f64::total_cmp);
        println!("  {name:44} {:9.2} {:9.2}", times[0], times[times.len() / 2]);
    }
}

fn print_triangle_counts(n: usize, bounds_m: &[f32]) {
    let lattice = Arc::new(lattice_of(n));
    let layout = PatchLayout::new(n as u32, n as u32, (n - 1) as u32).expect("sound");
    let exact = ErrorMap::exact(&lattice, &layout);
    let midpoint = ErrorMap::midpoint(&lattice, &layout);
    let wedgies = wedgies(&lattice, &layout);
    println!("triangles for a true bound, {n} x {n} (in brackets: against the least closure; true error)");
    for &bound_m in bounds_m {
        let least = row(&lattice, least_closure(&lattice, &layout, bound_m));
        let lowered = lowered(&lattice, &layout, &midpoint, bound_m);
        println!("  bound {bound_m} m");
        for (name, (triangles, max_m)) in [
            ("least closure", least),
            ("exact errors, raised", row(&lattice, above(&exact, &layout, bound_m))),
            ("midpoint errors as asked", row(&lattice, above(&midpoint, &layout, bound_m))),
            ("midpoint errors, lowered until it holds", lowered),
            ("nested wedgies", row(&lattice, above(&wedgies, &layout, bound_m))),
        ] {
            let ratio = triangles as f64 / least.0 as f64;
            println!("    {name:40} {triangles:9} ({ratio:.3}; {max_m:.3} m)");
        }
        let mut times: Vec<f64> =
            (0..3).map(|_| milliseconds(&mut || drop(least_closure(&lattice, &layout, bound_m)))).collect();
        times.sort_by(f64::total_cmp);
        println!("    least closure found in {:.1} ms", times[0]);
    }
}

/// Triangles and true largest error of a mesh.
fn row(lattice: &Arc<Lattice>, active: ActiveSet) -> (usize, f64) {
    let patches = active.layout().patches().collect();
    let mut mesh = TriMesh::default();
    DisplayedTerrain::new(Arc::clone(lattice), active, patches).emit(&mut mesh);
    (mesh.triangles.len(), measure(lattice, &mesh).expect("a mesh on posts").max_m)
}

fn vertices(layout: &PatchLayout) -> impl Iterator<Item = Vertex> + use<> {
    let (columns, layout) = (layout.columns(), *layout);
    (0..layout.vertex_count())
        .map(move |index| Vertex::new((index % columns) as i32, (index / columns) as i32))
        .filter(move |&vertex| !layout.is_corner(vertex))
}

fn above(map: &ErrorMap, layout: &PatchLayout, tolerance_m: f32) -> ActiveSet {
    let mut active = ActiveSet::new(*layout);
    for vertex in vertices(layout).filter(|&vertex| map.at(layout, vertex) > tolerance_m) {
        active.activate(vertex);
    }
    active
}

/// The mesh of midpoint errors at the highest tolerance that keeps `bound_m`, found by halving.
fn lowered(lattice: &Arc<Lattice>, layout: &PatchLayout, midpoint: &ErrorMap, bound_m: f32) -> (usize, f64) {
    let (mut low, mut high) = (0.0, bound_m);
    let mut best = row(lattice, above(midpoint, layout, 0.0));
    for _ in 0..12 {
        let middle = f32::midpoint(low, high);
        let found = row(lattice, above(midpoint, layout, middle));
        if found.1 <= f64::from(bound_m) {
            (low, best) = (middle, found);
        } else {
            high = middle;
        }
    }
    best
}

/// Duchaineau et al. 1997, equation 1: a wedgie is as thick as its own midpoint is off and its thicker child.
fn wedgies(lattice: &Lattice, layout: &PatchLayout) -> ErrorMap {
    let mut thickness = vec![0f32; layout.vertex_count()];
    let mut finest_first: Vec<Vertex> = vertices(layout).collect();
    finest_first.sort_by_key(|vertex| (vertex.step(), vertex.parents()[0].step() > vertex.step()));
    for vertex in finest_first {
        let children = vertex.children().filter(|&child| layout.contains(child));
        let below = children.map(|child| thickness[layout.index(child)]).fold(0.0, f32::max);
        thickness[layout.index(vertex)] = below + midpoint_error_at(lattice, layout, vertex);
    }
    ErrorMap::raised(thickness, layout)
}

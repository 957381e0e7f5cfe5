//! A scene as a sand table to print: solids in millimeters.
//!
//! The scene is looked at from straight above, a ray for each fifth of a millimeter, and what the rays meet becomes one
//! relief: the ground with its exaggeration, buildings, bridges and models. A relief has no cavities and no loose shells,
//! so that it can always be closed to a solid. Roads stand out of it by a layer of plastic, and water lies as deep below.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DVec2, Vec2, Vec3};

use sandtable_draw::list::FeatureId;
use sandtable_files::disk::{self, WriteFileError};
use sandtable_files::output_files::OutputFiles;
use sandtable_mesh::check::{Flaw, check_solid};
use sandtable_mesh::solid::{BASE_MM, Joint, solid_block};
use sandtable_mesh::write::remarks::Remarks;
use sandtable_mesh::write::stl;
use sandtable_mesh::write::three_mf::{self, PlacedSolid};
use sandtable_picture::build_relief;
use sandtable_query::bounded_mesh::{BoundedMesh, MeshError};
use sandtable_render::cpu::{CpuRenderError, render_buffers};
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::{Lattice, LatticeError};
use sandtable_view::axes::DirectionAxes;
use sandtable_view::camera::{Camera, CameraError, ParallelFrame};

/// The distance of rays in millimeters: half the width of a printer's nozzle.
const RAY_MM: f64 = 0.2;

/// The most rays along a side; a longer model has coarser ones. Time and memory grow with the square.
const MOST_RAYS: f64 = 4096.0;

/// How far the solid may be off the relief, in millimeters: half of the thinnest layer that printers lay.
const TOLERANCE_MM: f64 = 0.05;

/// How far roads stand out of the ground and water lies below it, in millimeters: a layer or two.
const STEP_MM: f32 = 0.3;

/// The thinnest relief, as a share of the model's longer side: of a flatter one little can be felt.
const LEAST_RELIEF: f64 = 0.03;

/// The highest relief, in millimeters: higher than any printer prints.
const HIGHEST_MM: f64 = 2000.0;

/// The gap between pieces on the bed, in millimeters.
const GAP_MM: f32 = 10.0;

/// The size of a printed model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrintSize {
    /// The longer side of the whole, in millimeters.
    pub side_mm: f64,
    /// The side of the printer's bed, in millimeters: what is longer is cut into pieces with pegs and sockets.
    pub bed_mm: f64,
}

/// A model in pieces, row by row from the south-west.
#[derive(Clone, Debug, PartialEq)]
pub struct PrintModel {
    /// Closed solids and their places on a bed, apart from each other.
    pub pieces: Vec<PlacedSolid>,
    /// Pieces from west to east, and from south to north.
    pub counts: [u32; 2],
    /// The extent of the whole along X, Y and Z, in millimeters.
    pub size_mm: Vec3,
    /// `n` of its scale 1:n in plan.
    pub scale: f64,
    /// What its user should know.
    pub notes: Vec<String>,
}

/// Why a scene is not printed.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum PrintError {
    #[error(transparent)]
    Camera(#[from] CameraError),
    #[error(transparent)]
    Render(#[from] CpuRenderError),
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    #[error(
        "the model would be {0:.0} mm high, and none is printed higher than {HIGHEST_MM} mm; state a smaller --side, or a smaller `vertical_exaggeration` in [terrain]"
    )]
    TooHigh(f64),
    #[error("a piece of the model is not closed: {0}")]
    Flaw(#[from] Flaw),
}

/// The solids of a scene. `progress` is called with the name of each step as it begins.
///
/// # Errors
/// See [`PrintError`].
pub fn print_model(
    scene: &SceneModel,
    size: PrintSize,
    progress: &dyn Fn(&'static str),
) -> Result<PrintModel, PrintError> {
    let relief = Relief::of(scene, size.side_mm, progress)?;
    progress("closing solids");
    let counts = relief.size_mm().map(|side_mm| libm::ceil(side_mm / size.bed_mm).max(1.0) as u32);
    let mut model = PrintModel {
        pieces: Vec::new(),
        counts,
        size_mm: Vec2::from(relief.size_mm().map(|side_mm| side_mm as f32)).extend(0.0),
        scale: relief.scale,
        notes: flatness_note(scene, &relief, size).into_iter().collect(),
    };
    for row in 0..counts[1] {
        for column in 0..counts[0] {
            let (at_mm, lattice) = relief.piece([column, row], counts)?;
            let mesh = BoundedMesh::new(&Arc::new(lattice), TOLERANCE_MM)?.to_mesh();
            let joints = [
                (row, 0, Joint::Socket),
                (column, counts[0] - 1, Joint::Peg),
                (row, counts[1] - 1, Joint::Peg),
                (column, 0, Joint::Socket),
            ];
            let joints = joints.map(|(own, border, joint)| if own == border { Joint::None } else { joint });
            let mesh = solid_block(&mesh, joints);
            check_solid(&mesh)?;
            let top = mesh.positions.iter().fold(0.0, |top: f32, at| top.max(at.z));
            model.size_mm.z = model.size_mm.z.max(top);
            let apart = Vec2::new(column as f32, row as f32) * GAP_MM;
            let name = if counts == [1, 1] { "model".to_owned() } else { piece_name(column, row) };
            model.pieces.push(PlacedSolid { name, mesh, at_mm: (at_mm + apart).extend(0.0) });
        }
    }
    Ok(model)
}

/// A format of printed models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrintFormat {
    /// 3MF: all pieces in one file, in millimeters.
    ThreeMf,
    /// STL: a file for each piece; the format has no unit, slicers take millimeters.
    Stl,
}

impl PrintFormat {
    /// The format of files with this extension, in any case.
    pub fn from_extension(extension: &str) -> Option<Self> {
        match extension.to_ascii_lowercase().as_str() {
            "3mf" => Some(Self::ThreeMf),
            "stl" => Some(Self::Stl),
            _ => None,
        }
    }
}

/// Writes a model and returns the files: `path`, or for several pieces as STL one beside it for each, such as
/// `model-B3.stl`.
///
/// # Errors
/// A file cannot be written, or would replace one that the scene is made of.
pub fn write(
    model: &PrintModel,
    scene: &SceneModel,
    path: &Path,
    format: PrintFormat,
) -> Result<Vec<PathBuf>, WriteFileError> {
    let title = scene.title.as_deref().unwrap_or("a scene");
    let lines = [
        format!("{title}, written by sandtable"),
        format!("1:{:.0}, heights times {}, millimeters", model.scale, scene.scale.0),
    ];
    let remarks = Remarks::new(&lines, &format!("sandtable 1:{:.0} mm", model.scale));
    match (format, model.pieces.as_slice()) {
        (PrintFormat::ThreeMf, pieces) => {
            disk::write_with(path, |out| out.write_all(&three_mf::bytes(pieces, &remarks)?))?;
            Ok(vec![path.to_owned()])
        }
        (PrintFormat::Stl, [piece]) => {
            disk::write_with(path, |out| stl::write(&mut &piece.mesh, &remarks, out))?;
            Ok(vec![path.to_owned()])
        }
        (PrintFormat::Stl, pieces) => {
            let stem = disk::file_stem(path);
            let named = |piece: &PlacedSolid| path.with_file_name(format!("{stem}-{}.stl", piece.name));
            let paths: Vec<PathBuf> = pieces.iter().map(named).collect();
            paths.iter().try_for_each(|path| disk::check_output(path, &scene.files))?;
            let mut files = OutputFiles::default();
            for (path, piece) in paths.iter().zip(pieces) {
                files.write_with(path, |out| stl::write(&mut &piece.mesh, &remarks, out))?;
            }
            files.publish()?;
            Ok(paths)
        }
    }
}

/// A note where little of the relief can be felt.
fn flatness_note(scene: &SceneModel, relief: &Relief, size: PrintSize) -> Option<String> {
    let least_mm = LEAST_RELIEF * size.side_mm;
    let factor = f64::from(scene.scale.0) * least_mm / relief.rise_mm;
    (relief.rise_mm > 0.0 && relief.rise_mm < least_mm).then(|| {
        format!(
            "the relief is only {:.1} mm high; `vertical_exaggeration = {}` in [terrain] makes it {least_mm:.1} mm",
            relief.rise_mm,
            libm::ceil(factor)
        )
    })
}

/// The name of a piece: a letter from west to east, a number from south to north, such as `B3`.
fn piece_name(column: u32, row: u32) -> String {
    let letter = char::from(b'A' + (column % 26) as u8);
    format!("{}{}", String::from(letter).repeat(column as usize / 26 + 1), row + 1)
}

/// The heights of a model in millimeters at the posts of a grid.
struct Relief {
    columns: u32,
    rows: u32,
    cell_mm: DVec2,
    heights_mm: Vec<f32>,
    scale: f64,
    /// From the lowest to the highest ground.
    rise_mm: f64,
}

impl Relief {
    fn of(scene: &SceneModel, side_mm: f64, progress: &dyn Fn(&'static str)) -> Result<Self, PrintError> {
        let (min, max) = scene.bounds;
        let span_m = (max - min).truncate();
        let mm_per_m = side_mm / f64::from(span_m.max_element());
        let rise_mm = f64::from(max.z - min.z) * mm_per_m;
        if rise_mm > HIGHEST_MM {
            return Err(PrintError::TooHigh(rise_mm));
        }
        let rays = (side_mm / RAY_MM).min(MOST_RAYS);
        let [columns, rows] = [span_m.x, span_m.y]
            .map(|span| libm::round(f64::from(span / span_m.max_element()) * rays).max(4.0) as u32);
        let camera = from_above(scene, (columns, rows))?;
        let list = build_relief(scene, &camera, progress);
        progress("measuring what is seen from above");
        let seen = render_buffers(&list, &camera)?;
        // The lowest ground is a step above the base, which leaves water room below it.
        let lowest_mm = BASE_MM + STEP_MM;
        let height_mm = |(depth_m, feature): (&f32, &FeatureId)| match *feature {
            FeatureId::NONE | FeatureId::PLINTH => BASE_MM,
            feature => {
                let z_mm = f64::from(camera.eye().z - depth_m - min.z) * mm_per_m;
                (z_mm as f32 + lowest_mm + step_mm(scene, feature)).max(BASE_MM)
            }
        };
        let row = |(depths, features): (&[f32], &[FeatureId])| {
            depths.iter().zip(features).map(height_mm).collect::<Vec<f32>>()
        };
        let columns_of = columns as usize;
        let rows_from_above = seen.depth_m.chunks(columns_of).zip(seen.features.chunks(columns_of));
        let heights_mm = rows_from_above.rev().flat_map(row).collect();
        let cell_mm = span_m.as_dvec2() * mm_per_m / DVec2::new(f64::from(columns), f64::from(rows));
        Ok(Self { columns, rows, cell_mm, heights_mm, scale: 1000.0 / mm_per_m, rise_mm })
    }

    fn size_mm(&self) -> [f64; 2] {
        [f64::from(self.columns - 1) * self.cell_mm.x, f64::from(self.rows - 1) * self.cell_mm.y]
    }

    /// The piece `at` of `counts` from west to east and from south to north, with the place of its south-west corner in the
    /// whole. Neighbors share the posts between them.
    fn piece(&self, at: [u32; 2], counts: [u32; 2]) -> Result<(Vec2, Lattice), LatticeError> {
        let border = |number: u32, count: u32, posts: u32| {
            (u64::from(number) * u64::from(posts - 1) / u64::from(count)) as u32
        };
        let [west, south] = [border(at[0], counts[0], self.columns), border(at[1], counts[1], self.rows)];
        let east = border(at[0] + 1, counts[0], self.columns);
        let north = border(at[1] + 1, counts[1], self.rows);
        let row = |row: u32| {
            let first = row as usize * self.columns as usize;
            &self.heights_mm[first + west as usize..=first + east as usize]
        };
        let heights = (south..=north).map(row).collect::<Vec<_>>().concat();
        let lattice = Lattice::new(DVec2::ZERO, self.cell_mm, east - west + 1, heights);
        let place = DVec2::new(f64::from(west), f64::from(south)) * self.cell_mm;
        Ok((place.as_vec2(), lattice?))
    }
}

/// How far a feature stands out of the ground for its own sake.
fn step_mm(scene: &SceneModel, feature: FeatureId) -> f32 {
    let kind = feature.index().and_then(|index| scene.features.get(index)).map(|feature| feature.kind);
    match kind {
        Some(FeatureKind::Road | FeatureKind::Bridge) => STEP_MM,
        Some(FeatureKind::River | FeatureKind::Lake) => -STEP_MM,
        _ => 0.0,
    }
}

/// The camera that looks straight down on all of the ground, and on nothing beside it.
fn from_above(scene: &SceneModel, size: (u32, u32)) -> Result<Camera, CameraError> {
    let (min, max) = scene.bounds;
    let half_m = (max - min).truncate() / 2.0;
    let above_m = half_m.max_element() + (max.z - min.z);
    let eye = ((min + max) / 2.0).with_z(max.z + above_m);
    let frame = ParallelFrame { half_m, dpi: (25.4 / RAY_MM) as f32 };
    let depth_m = 2.0 * above_m + 2.0 * (max.z - min.z) + 1.0;
    let axes = DirectionAxes::new(0.0, std::f32::consts::FRAC_PI_2);
    Camera::parallel(eye, &axes, frame, size, (above_m * 1e-3 + 1e-3, depth_m))
}

//! Heights under real vertices as an independent reader found them: `oracle/drape_samples.csv`.

use std::path::Path;

use glam::DVec2;
use sandtable_geom::crs::Crs;
use sandtable_raster::answer::Answer;
use sandtable_terrain::query::service::HeightService;
use sandtable_terrain::query::{Interpolation, Surface};

/// One vertex of a real layer and the ground under it.
#[derive(Clone, Debug)]
pub struct Sample {
    /// The layer's file.
    pub file: String,
    /// The vertex in the layer's coordinates.
    pub vertex: DVec2,
    /// The same in the elevation model's.
    pub on_dem: DVec2,
    /// The bilinear height; `None` where all four neighbors hold no data.
    pub height: Option<f64>,
}

/// The samples that lie on the elevation model, of a scene's folder.
pub fn samples(folder: &Path) -> Vec<Sample> {
    let text = std::fs::read_to_string(folder.join("oracle/drape_samples.csv")).expect("samples");
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let column = |wanted: &str| names.iter().position(|&name| name == wanted).expect("a column");
    let (inside, file, z) = (column("inside"), column("file"), column("z_bilinear"));
    let (vx, vy, dem_x, dem_y) = (column("vx"), column("vy"), column("dem_x"), column("dem_y"));
    lines
        .map(|line| line.split(',').collect::<Vec<_>>())
        .filter(|fields| fields[inside] == "1")
        .map(|fields| {
            let number = |at: usize| fields[at].parse::<f64>().expect("a number");
            Sample {
                file: fields[file].to_owned(),
                vertex: DVec2::new(number(vx), number(vy)),
                on_dem: DVec2::new(number(dem_x), number(dem_y)),
                height: fields[z].parse().ok().filter(|height: &f64| height.is_finite()),
            }
        })
        .collect()
}

/// How far answers were off.
#[derive(Clone, Debug, Default)]
pub struct Deviation {
    /// Absolute differences in meters, sorted.
    pub sorted: Vec<f64>,
}

impl Deviation {
    /// The largest difference; 0 of none.
    pub fn max(&self) -> f64 {
        self.sorted.last().copied().unwrap_or_default()
    }

    /// The difference that `part` of all do not exceed.
    pub fn quantile(&self, part: f64) -> f64 {
        let last = self.sorted.len().saturating_sub(1) as f64;
        self.sorted.get((last * part).round() as usize).copied().unwrap_or_default()
    }

    /// The root of the mean square.
    pub fn rms(&self) -> f64 {
        let squares: f64 = self.sorted.iter().map(|off| off * off).sum();
        (squares / self.sorted.len().max(1) as f64).sqrt()
    }
}

/// How far `surface` is off the samples, asked at `place(sample)` in `system`.
///
/// # Panics
/// Where one knows a height and the other does not.
pub fn compare(
    (heights, scene_crs): (&HeightService, &Crs),
    surface: Surface,
    samples: &[Sample],
    place: impl Fn(&Sample) -> (Crs, DVec2),
) -> Deviation {
    let mut off = Vec::new();
    for sample in samples {
        let (system, at) = place(sample);
        let at = system.transform(scene_crs, at).expect("a place on the model");
        match (heights.height(surface, Interpolation::Bilinear, at), sample.height) {
            (Answer::Height(height), Some(expected)) => off.push((height - expected).abs()),
            (Answer::NoData, None) => {}
            // The lattice keeps posts only where the source around has data: along holes it may know less.
            (Answer::NoData | Answer::Outside, _) if surface == Surface::Ground => {}
            (answer, expected) => panic!("{answer:?} where {expected:?} is expected: {sample:?}"),
        }
    }
    off.sort_by(f64::total_cmp);
    Deviation { sorted: off }
}

//! `/v1/tiles/DATASET/Z/X/Y.png`: shaded relief as map tiles, for the page at `/` and for any program that shows tiles.
//!
//! Tiles are those of OpenStreetMap and most web maps: 256 × 256 pixels in Web Mercator (EPSG:3857), `Z` from 0, where one
//! shows the world, each next level twice as fine; `X` to the east and `Y` to the south. What lies outside the dataset, or has
//! no data, is transparent.
//!
//! ```text
//! pixels of up to 4 samples   the heights that a query at /v1/DATASET answers, several to a pixel
//! wider pixels                means of samples: overviews that the first such tile makes
//! ```

use std::f64::consts::PI;

use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use glam::DVec2;

use crate::datasets::ServedDataset;
use crate::parameters::Parameters;
use crate::query::Query;
use crate::reply::{HttpError, quoted};
use crate::service::Service;
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;
use sandtable_files::png::encode_png;
use sandtable_geom::crs::Crs;
use sandtable_query::dataset::{Dataset, check_datums};
use sandtable_sheet::relief::{RELIEF, relief_picture};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, Surface};
use sandtable_terrain::stop_flag::StopFlag;

/// The side of a tile in pixels.
const SIDE: u32 = 256;

/// The finest level: pixels of 3 cm on the equator.
const FINEST: u32 = 22;

/// Half the side of the world in Web Mercator, meters: π times the radius of its sphere.
const HALF_WORLD_M: f64 = PI * 6_378_137.0;

/// The code of Web Mercator.
const WEB_MERCATOR: u32 = 3857;

/// Pixels of more samples than this show overviews, and not the heights of queries.
const MOST_IN_PIXEL: f64 = 4.0;

/// How relief is exaggerated more where a pixel is wider than a sample, as ground looks flatter from afar: at most so many times.
const MOST_RELIEF: f64 = 4.0;

pub struct TileQuery {
    /// The index of the dataset.
    dataset: usize,
    tile: MapTile,
}

/// A tile of the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct MapTile {
    z: u32,
    x: u32,
    y: u32,
}

impl Query for TileQuery {
    fn read(service: &Service, path: &str, _: &Parameters) -> Result<Self, HttpError> {
        let example = service.datasets.at(0).name.as_str();
        let unknown = || {
            HttpError::unknown(format!(
                "there is no tile {}; write DATASET/Z/X/Y.png, as in {example}/0/0/0.png, with Z from 0 to {FINEST}, X and Y below 2 to the power of Z",
                quoted(path)
            ))
        };
        let (name, tile) = path.split_once('/').ok_or_else(unknown)?;
        let dataset = service.datasets.find_one(Some(name))?;
        let tile = MapTile::parse(tile).ok_or_else(unknown)?;
        Ok(Self { dataset, tile })
    }

    fn most_bytes(&self, _: &Service) -> usize {
        (SIDE * SIDE) as usize * size_of::<Srgba>()
    }

    fn answer(self, service: &Service, stop: &StopFlag) -> Result<Response, HttpError> {
        let served = service.datasets.at(self.dataset);
        let mercator = Crs::from_epsg(WEB_MERCATOR).map_err(|error| HttpError::wrong(error.to_string()))?;
        let native = served.dataset.crs();
        if served.bounds().is_none() {
            return Err(HttpError::wrong(format!(
                "dataset {} has no map: it states no coordinate system with a place on Earth, or lies beyond the reach of Web Mercator",
                quoted(&served.name)
            )));
        }
        check_datums(&mercator, &native).map_err(|error| HttpError::wrong(error.to_string()))?;
        let picture = self.tile.picture(served, &mercator, stop)?;
        Ok(([(CONTENT_TYPE, "image/png")], encode_png(&picture)).into_response())
    }
}

impl MapTile {
    /// Parses `Z/X/Y.png`.
    fn parse(text: &str) -> Option<Self> {
        let mut numbers = text.strip_suffix(".png")?.split('/').map(|number| {
            let is_number = !number.is_empty() && number.bytes().all(|digit| digit.is_ascii_digit());
            number.parse::<u32>().ok().filter(|_| is_number)
        });
        let (z, x, y) = (numbers.next()??, numbers.next()??, numbers.next()??);
        let is_tile = numbers.next().is_none() && z <= FINEST && x >> z == 0 && y >> z == 0;
        is_tile.then_some(Self { z, x, y })
    }

    /// The side of a pixel in Web Mercator, meters on the equator.
    fn pixel(self) -> f64 {
        2.0 * HALF_WORLD_M / (f64::from(SIDE) * f64::from(1u32 << self.z))
    }

    /// The position in Web Mercator of a pixel's upper left corner and a part of a pixel beyond.
    fn position(self, pixel: DVec2) -> DVec2 {
        let world = DVec2::new(f64::from(self.x), f64::from(self.y)) * f64::from(SIDE) + pixel;
        DVec2::new(world.x * self.pixel() - HALF_WORLD_M, HALF_WORLD_M - world.y * self.pixel())
    }

    fn picture(self, served: &ServedDataset, mercator: &Crs, stop: &StopFlag) -> Result<Pixels, HttpError> {
        let empty = || Pixels::filled(SIDE, SIDE, Srgba([0; 4]));
        let (header, native) = (served.dataset.header(), served.dataset.crs());
        let middle = self.position(DVec2::splat(f64::from(SIDE) / 2.0));
        // Where the middle has no place in the dataset's system, the tile is far from the dataset.
        let on_raster = |at: DVec2| mercator.transform(&native, at).map(|at| header.grid_from_map(at));
        let beside = middle + DVec2::new(self.pixel(), 0.0);
        let samples = match (on_raster(middle), on_raster(beside)) {
            (Ok(here), Ok(there)) => here.distance(there),
            _ => f64::INFINITY,
        };
        let map = served.tile_map()?;
        if stop.is_stopped() {
            return Err(HttpError::stopped());
        }
        let (dataset, surface, in_pixel) = if samples <= MOST_IN_PIXEL {
            let surface = served.dataset.default_surface();
            if surface != Surface::Source {
                served.prepare_ground()?;
            }
            (&served.dataset, surface, samples.ceil().max(1.0) as u32)
        } else {
            (map.overviews.no_coarser_than(samples), Surface::Source, 2)
        };
        let heights = self.heights((dataset, surface), mercator, in_pixel)?;
        if stop.is_stopped() {
            return Err(HttpError::stopped());
        }
        // The true length of a pixel: Web Mercator enlarges by the secant of the latitude.
        let length = self.pixel() / libm::cosh(middle.y / 6_378_137.0);
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(length), SIDE + 2, heights);
        let Ok(lattice) = lattice else { return Ok(empty()) };
        let relief = libm::sqrt(samples).clamp(1.0, MOST_RELIEF) as f32 * RELIEF;
        Ok(relief_picture(&lattice, &map.ramp, relief))
    }

    /// The heights of the pixels and one more on each side, row by row from the south-west; each the mean of those of
    /// `in_pixel` × `in_pixel` places in it that have one, NaN where none has.
    fn heights(
        self,
        (dataset, surface): (&Dataset, Surface),
        mercator: &Crs,
        in_pixel: u32,
    ) -> Result<Vec<f32>, HttpError> {
        let pixels = SIDE + 2;
        let places: Vec<DVec2> = (0..in_pixel)
            .flat_map(|row| (0..in_pixel).map(move |column| DVec2::new(f64::from(column), f64::from(row))))
            .map(|place| (place + 0.5) / f64::from(in_pixel) - 1.0)
            .collect();
        let row = |row: u32| {
            // Rows are counted from the south, pixels from the north.
            let top = f64::from(pixels - 1 - row);
            let at = (0..pixels).flat_map(|column| {
                let corner = DVec2::new(f64::from(column), top);
                places.iter().map(move |&place| self.position(corner + place))
            });
            at.collect::<Vec<_>>()
        };
        let mut heights = Vec::with_capacity((pixels * pixels) as usize);
        // Some rows at a time, so that positions need little memory.
        for rows in (0..pixels).collect::<Vec<_>>().chunks(32) {
            let at: Vec<DVec2> = rows.iter().flat_map(|&number| row(number)).collect();
            let answers = dataset.heights(surface, Interpolation::Bilinear, mercator, &at)?;
            heights.extend(answers.chunks(places.len()).map(|answers| {
                let known = answers.iter().filter_map(|answer| answer.height_m());
                let (sum, count) = known.fold((0.0, 0u32), |(sum, count), height| (sum + height, count + 1));
                if count == 0 { f32::NAN } else { (sum / f64::from(count)) as f32 }
            }));
        }
        Ok(heights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_those_of_the_world() {
        let tile = |text: &str| MapTile::parse(text);
        assert_eq!(tile("0/0/0.png"), Some(MapTile { z: 0, x: 0, y: 0 }));
        assert_eq!(tile("12/1090/1604.png"), Some(MapTile { z: 12, x: 1090, y: 1604 }));
        for wrong in [
            "",
            "0/0/0",
            "0/0/1.png",
            "1/2/0.png",
            "23/0/0.png",
            "-1/0/0.png",
            "+1/0/0.png",
            "1/0/0/0.png",
            "1/0.png",
            "1/0/.png",
            "1//0.png",
            "4294967296/0/0.png",
            "33/0/0.png",
            "1/0/0.5.png",
        ] {
            assert_eq!(tile(wrong), None, "{wrong}");
        }
        let corner = |text: &str, x: f64, y: f64| tile(text).expect("a tile").position(DVec2::new(x, y));
        assert_eq!(corner("0/0/0.png", 0.0, 0.0), DVec2::new(-HALF_WORLD_M, HALF_WORLD_M));
        assert_eq!(corner("1/1/1.png", 0.0, 0.0), DVec2::ZERO);
        assert_eq!(corner("1/0/0.png", 256.0, 256.0), DVec2::ZERO);
    }
}

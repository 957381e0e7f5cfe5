//! The line symbols of roads, rivers and shores: how wide a line is drawn where its true width would be lost.
//!
//! A map draws a road as wide as its class needs to be told from the others, whatever its width on the ground. So does a
//! picture: a line is drawn as wide as it is, or as its class's least width on the picture, whichever is more. Only
//! pictures are; the ground, its heights, exports and reports have the true width.
//!
//! The least width of a river grows with its order, from nothing at its source.

use glam::DVec2;

use sandtable_draw::list::FeatureId;
use sandtable_earthworks::alignment::{Alignment, Support, Width};
use sandtable_geom::polyline::Polyline;
use sandtable_geom::profile::Profile;
use sandtable_geom::segment;
use sandtable_ribbon::junction::Street;
use sandtable_ribbon::texture::RibbonSurface;

/// Least widths of paved roads: those at least so many meters wide, pixels.
const PAVED: [(f64, f64); 4] = [(9.0, 5.0), (6.5, 3.5), (4.0, 2.5), (0.0, 1.5)];

/// Of rivers: a river that a map of a county shows as two banks, one that has a name, and a stream.
const WATER: [(f64, f64); 3] = [(40.0, 3.0), (8.0, 2.0), (0.0, 1.2)];

/// By how much its least width grows where a river's order rises by one, as a share of that of order 1.
const ORDER_GROWTH: f64 = 0.35;

/// The most that it grows: rivers of many tributaries would crowd the picture.
const MOST_GROWTH: f64 = 2.0;

/// How many widths of a river its source is long, on which it is drawn narrower than it is.
const SOURCE_WIDTHS: f64 = 12.0;

/// The power of the way from a source to the next confluence that a river's width grows with: half of it after an eighth.
const SOURCE_POWER: f64 = 1.0 / 3.0;

/// The width of the point of a source in meters: a ribbon needs one.
const LEAST_SHOWN_M: f64 = 0.01;

/// Vertices nearer than this to one another are one, in meters.
const MERGE_M: f64 = 0.01;

/// Of gravel roads.
const GRAVEL_PX: f64 = 1.5;

/// Of tracks and paths.
const TRACK_PX: f64 = 1.0;

/// The width of a shore's line on the ground in meters.
const SHORE_M: f64 = 0.3;

/// Of shores, of which the outer half shows beside the lake.
const SHORE_PX: f64 = 1.9;

/// The height of the picture that least widths are for, in pixels; they grow with it, as type does.
const PICTURE_PX: f64 = 1080.0;

/// A road or river as a line on a map.
pub struct LineSymbol {
    /// Its centerline and true width.
    pub alignment: Alignment,
    /// What it is made of.
    pub surface: RibbonSurface,
    /// The least width it is drawn with, in pixels of a picture 1080 lines high; a higher class has a greater one.
    pub least_px: f64,
    /// Its order along its centerline, where it is a river; see [`orders`](crate::water::order::orders).
    pub order: Option<Profile>,
    /// The width of the bank on either side in meters, where it is a river.
    pub bank_m: f64,
    /// The deck that carries it, where it is a bridge.
    pub deck: Option<DeckLine>,
    /// The feature it belongs to.
    pub feature: FeatureId,
}

/// The deck of a bridge along its centerline.
#[derive(Clone, Debug, PartialEq)]
pub struct DeckLine {
    /// The centerline, within the elevation model.
    pub line: Polyline,
    /// Its elevation along the centerline, in meters.
    pub level: Profile,
    /// How high parapets stand over it as they are drawn, in meters.
    pub parapet_m: f64,
}

impl DeckLine {
    /// The elevation in meters at the station that is the nearest to a place.
    pub fn level_at(&self, at: DVec2) -> f64 {
        let legs = self.line.points().windows(2).zip(self.line.stations().windows(2));
        let off = |leg: &[DVec2]| segment::distance_squared((leg[0], leg[1]), at);
        let nearest = legs.min_by(|(a, _), (b, _)| off(a).total_cmp(&off(b)));
        let station_m = nearest.map_or(0.0, |(leg, stations)| {
            stations[0] + (stations[1] - stations[0]) * segment::nearest_part((leg[0], leg[1]), at)
        });
        self.level.at(station_m)
    }
}

impl LineSymbol {
    /// The symbol of a street, which `deck` carries where it is a bridge; `None` in a tunnel.
    pub fn of(street: &Street, deck: Option<&DeckLine>, feature: FeatureId) -> Option<Self> {
        let Street { alignment, width_m, surface, .. } = street;
        let least_px = least_px(*surface, *width_m);
        let symbol = || Self {
            alignment: alignment.clone(),
            surface: *surface,
            least_px,
            order: None,
            bank_m: 0.0,
            deck: deck.filter(|_| alignment.support == Support::Bridge).cloned(),
            feature,
        };
        (alignment.support != Support::Tunnel).then(symbol)
    }

    /// The symbol of a river with banks of this width in meters and these orders along its centerline.
    pub fn of_river(street: &Street, bank_m: f64, order: &Profile, feature: FeatureId) -> Self {
        let Street { alignment, width_m, surface, .. } = street;
        Self {
            alignment: alignment.clone(),
            surface: *surface,
            least_px: least_px(*surface, *width_m),
            order: Some(order.clone()),
            bank_m,
            deck: None,
            feature,
        }
    }

    /// The factor of its least width at a station.
    pub fn growth_at(&self, station_m: f64) -> f64 {
        self.order.as_ref().map_or(1.0, |order| growth(order.at(station_m)))
    }

    /// The greatest least width along it, in pixels of a picture 1080 lines high.
    pub fn widest_px(&self) -> f64 {
        let orders = self.order.iter().flat_map(|order| order.values());
        let most = orders.map(|&order| growth(order)).reduce(f64::max).unwrap_or(1.0);
        self.least_px * most
    }

    /// The share of its true width that it shows at a station: less than 1 on the first stretch below a source.
    pub fn shown_share(&self, station_m: f64) -> f64 {
        if !self.has_source() {
            return 1.0;
        }
        (station_m / self.source_m()).min(1.0)
    }

    fn source_m(&self) -> f64 {
        SOURCE_WIDTHS * self.alignment.width.at(0.0)
    }

    /// Its centerline, `more_m` wider on either side than the width that it shows at its source and has elsewhere.
    pub fn shown_alignment(&self, more_m: f64) -> Alignment {
        let (line, source_m) = (&self.alignment.line, self.source_m());
        let points = line.between(0.0, source_m).into_iter().chain(line.between(source_m, line.length()));
        let line = Polyline::new(points, MERGE_M).unwrap_or_else(|| line.clone());
        let shown_m = |&station: &f64| {
            self.shown_share(station) * (self.alignment.width.at(station) + 2.0 * more_m) + LEAST_SHOWN_M
        };
        let widths = Profile::new(line.stations().to_vec(), line.stations().iter().map(shown_m).collect());
        let width = widths.map_or_else(|| self.alignment.width.clone(), Width::Varying);
        Alignment { line, width, ..self.alignment.clone() }
    }

    /// Whether it is the shore of a lake.
    pub fn is_shore(&self) -> bool {
        self.surface == RibbonSurface::ShoreLine
    }

    /// Whether it is the centerline of a river.
    pub fn is_river(&self) -> bool {
        self.order.is_some()
    }

    /// Whether it begins at a source, where it is drawn as a point.
    pub fn has_source(&self) -> bool {
        self.order.as_ref().is_some_and(|order| order.values()[0] <= 0.0)
    }

    /// The symbol of the shore along a closed outline, as wide on the ground as a strip of wet sand; `None` for an outline
    /// without length.
    pub fn of_shore(outline: &[DVec2], feature: FeatureId) -> Option<Self> {
        let line = Polyline::new(outline.iter().chain(outline.first()).copied(), 0.0)?;
        let alignment = Alignment::on_ground(line, SHORE_M);
        Some(Self {
            alignment,
            surface: RibbonSurface::ShoreLine,
            least_px: SHORE_PX,
            order: None,
            bank_m: 0.0,
            deck: None,
            feature,
        })
    }
}

/// What a river of an order, which is 0 at a source, is wider than one of order 1 in full. Below a source it soon has the
/// better part of its width: a river that grew evenly over a hundred kilometers would be lost on half of them.
fn growth(order: f64) -> f64 {
    let above = (order - 1.0).max(0.0);
    libm::pow(order.clamp(0.0, 1.0), SOURCE_POWER) * (1.0 + ORDER_GROWTH * above).min(MOST_GROWTH)
}

/// Pixels of a picture `height_px` high in one pixel of those that least widths are for.
pub fn px_scale(height_px: u32) -> f64 {
    f64::from(height_px) / PICTURE_PX
}

/// The width in meters that a line of `true_m` is drawn with where a pixel is `meters_per_px` wide.
pub fn drawn_width_m(true_m: f64, least_px: f64, meters_per_px: f64) -> f64 {
    true_m.max(least_px * meters_per_px)
}

/// The least width of a line's class, in pixels of a picture 1080 lines high.
fn least_px(surface: RibbonSurface, width_m: f64) -> f64 {
    let class_of = |classes: &[(f64, f64)]| {
        let class = classes.iter().find(|(from_m, _)| width_m >= *from_m);
        class.map_or(TRACK_PX, |&(_, least_px)| least_px)
    };
    match surface {
        RibbonSurface::River => class_of(&WATER),
        RibbonSurface::ShoreLine => SHORE_PX,
        RibbonSurface::Track => TRACK_PX,
        RibbonSurface::Gravel => GRAVEL_PX,
        _ => class_of(&PAVED),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_as_wide_as_it_is_or_as_its_class_needs() {
        assert_eq!(drawn_width_m(6.0, 2.5, 0.1), 6.0);
        assert_eq!(drawn_width_m(6.0, 2.5, 2.4), 6.0);
        assert_eq!(drawn_width_m(6.0, 2.5, 20.0), 50.0);
    }

    #[test]
    fn a_deck_has_the_level_of_the_nearest_station() {
        let line = Polyline::new([(0.0, 0.0), (100.0, 0.0), (100.0, 50.0)].map(DVec2::from), 0.0);
        let level = Profile::new(vec![0.0, 150.0], vec![10.0, 25.0]).expect("rising");
        let deck = DeckLine { line: line.expect("a line"), level, parapet_m: 1.1 };
        let levels =
            [(-20.0, 3.0), (40.0, -9.0), (108.0, 20.0), (99.0, 80.0)].map(|at| deck.level_at(at.into()));
        assert_eq!(levels, [10.0, 14.0, 22.0, 25.0]);
    }

    #[test]
    fn least_widths_fall_from_class_to_class() {
        let roads = [12.0, 7.0, 5.0, 3.0].map(|width_m| least_px(RibbonSurface::Asphalt, width_m));
        assert_eq!(roads, [5.0, 3.5, 2.5, 1.5]);
        assert_eq!(least_px(RibbonSurface::Gravel, 12.0), 1.5);
        assert_eq!(least_px(RibbonSurface::Track, 12.0), 1.0);
        let rivers = [60.0, 12.0, 3.0].map(|width_m| least_px(RibbonSurface::River, width_m));
        assert_eq!(rivers, [3.0, 2.0, 1.2]);
    }

    #[test]
    fn a_river_grows_from_a_point_with_its_order_and_not_without_bound() {
        let widths: Vec<f64> = [0.0, 0.125, 1.0, 2.0, 3.0, 9.0].map(growth).to_vec();
        assert_eq!((widths[0], widths[1], widths[2]), (0.0, 0.5, 1.0), "half of it after an eighth");
        assert!(widths.windows(2).all(|pair| pair[0] < pair[1]), "{widths:?}");
        assert_eq!(widths[5], MOST_GROWTH);
    }

    #[test]
    fn a_picture_twice_as_high_has_lines_twice_as_wide() {
        assert_eq!([540, 1080, 2160].map(px_scale), [0.5, 1.0, 2.0]);
    }
}

//! The kind `streams`: the ways of water that drain at least an area, with their orders.

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{FeatureRole, Figure, Outcome, OutcomeFeature, OutcomeShape, PropertyValue};
use crate::water::drainage::Drainage;
use crate::water::prepared::WaterGround;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// The streams of drained ground, by post.
pub(crate) struct StreamNet {
    /// The posts of streams, each before the one that it drains to.
    pub order: Vec<u32>,
    /// The number of streams that enter each post.
    pub entering: Vec<u8>,
}

impl StreamNet {
    /// The posts that drain at least an area in m². `downstream` is what [`Drainage::downstream`] gives.
    pub fn new(drainage: &Drainage, downstream: &[u32], ground: &Lattice, area_m2: f64) -> Self {
        let least = least_posts(ground, area_m2);
        let counts = drainage.accumulation();
        let is_stream = |&index: &u32| f64::from(counts[index as usize]) >= least;
        let order: Vec<u32> = downstream.iter().copied().filter(is_stream).collect();
        let mut entering = vec![0_u8; counts.len()];
        for to in order.iter().filter_map(|&index| drainage.to(index as usize)) {
            entering[to] += 1;
        }
        Self { order, entering }
    }

    /// The orders at the posts of streams.
    pub fn orders(&self, drainage: &Drainage) -> Vec<StreamOrder> {
        let mut orders = vec![StreamOrder::default(); self.entering.len()];
        for &index in &self.order {
            let own = orders[index as usize];
            if let Some(to) = drainage.to(index as usize) {
                orders[to].join(own);
            }
        }
        orders
    }
}

/// The number of posts that make up an area in m², at least 1.
pub(crate) fn least_posts(ground: &Lattice, area_m2: f64) -> f64 {
    (area_m2 / ground.cell_m2()).ceil().max(1.0)
}

/// The orders of a stream at a post.
#[derive(Clone, Copy, Default)]
pub(crate) struct StreamOrder {
    /// The highest of Strahler's orders (1957) of the streams that enter, and how many have it.
    highest: u8,
    times: u8,
    /// The sum of Shreve's magnitudes (1966) of those that enter.
    magnitude: u32,
}

impl StreamOrder {
    /// Strahler's: 1 at a source; one more than the highest that enter where two have it.
    pub fn strahler(self) -> u8 {
        match (self.highest, self.times) {
            (0, _) => 1,
            (highest, 1) => highest,
            (highest, _) => highest + 1,
        }
    }

    /// Shreve's: the number of sources above.
    pub fn shreve(self) -> u32 {
        self.magnitude.max(1)
    }

    /// Takes in a stream that enters.
    fn join(&mut self, other: Self) {
        let order = other.strahler();
        match order.cmp(&self.highest) {
            std::cmp::Ordering::Greater => (self.highest, self.times) = (order, 1),
            std::cmp::Ordering::Equal => self.times += 1,
            std::cmp::Ordering::Less => {}
        }
        self.magnitude = self.magnitude.saturating_add(other.shreve());
    }
}

/// Streams: the ways of water that drain at least an area, from each source or confluence to the next, with their orders.
///
/// # Errors
/// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
pub(crate) fn streams(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let water = WaterGround::of(land, arguments, stop)?;
    let drainage = water.drained(stop)?;
    let net = StreamNet::new(&drainage, &drainage.downstream(), &land.ground, arguments.number("area_m2"));
    let is_shreve = arguments.word("order") == "shreve";
    let orders = net.orders(&drainage);
    let mut features = Vec::new();
    let (mut total_km, mut highest, mut sources) = (0.0, 0, 0_u32);
    for &start in &net.order {
        let entering = net.entering[start as usize];
        sources += u32::from(entering == 0);
        if entering == 1 {
            continue;
        }
        let line = reach(start, &drainage, &net.entering, &land.ground);
        if line.len() < 2 {
            continue;
        }
        let length_m: f64 = line.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        total_km += length_m / 1000.0;
        let order = orders[start as usize];
        highest = highest.max(order.strahler());
        let [strahler, shreve] = [i64::from(order.strahler()), i64::from(order.shreve())];
        features.push(OutcomeFeature {
            shape: OutcomeShape::Line(line),
            name: String::new(),
            role: FeatureRole::Stream,
            properties: vec![
                ("order", PropertyValue::Whole(if is_shreve { shreve } else { strahler })),
                ("strahler", PropertyValue::Whole(strahler)),
                ("shreve", PropertyValue::Whole(shreve)),
                ("length_m", PropertyValue::Number(length_m)),
            ],
        });
    }
    let figures = vec![
        Figure::new("length of streams", total_km, "km"),
        Figure::new("highest order", f64::from(highest), ""),
        Figure::new("sources", f64::from(sources), ""),
    ];
    Ok(Outcome { features, figures, notes: water.notes, ..Outcome::default() })
}

/// The positions from a source or confluence down to the next confluence, or to the edge of the land.
fn reach(start: u32, drainage: &Drainage, entering: &[u8], ground: &Lattice) -> Vec<glam::DVec2> {
    let place = |index: usize| ground.map_position(ground.post_at(index));
    let mut line = vec![place(start as usize)];
    let mut at = drainage.to(start as usize);
    while let Some(index) = at {
        line.push(place(index));
        if entering[index] != 1 {
            break;
        }
        at = drainage.to(index);
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::test_land::{bare, run_kind};
    use glam::DVec2;

    fn property(feature: &OutcomeFeature, name: &str) -> i64 {
        match feature.properties.iter().find(|(known, _)| *known == name) {
            Some((_, PropertyValue::Whole(number))) => *number,
            _ => panic!("no {name}"),
        }
    }

    /// Gutters from the north, of which three and two meet, and then all, on their way to the south.
    fn gutters(order: &str) -> Vec<OutcomeFeature> {
        #[rustfmt::skip]
        let heights = [
            90., 90., 90., 90., 1., 90., 90., 90., 90.,
            90., 90., 90., 90., 2., 90., 90., 90., 90.,
            90., 90., 90., 3., 80., 3., 90., 90., 90.,
            90., 90., 4., 80., 80., 80., 4., 90., 90.,
            90., 5., 80., 5., 80., 5., 80., 5., 90.,
            90., 6., 80., 6., 80., 6., 80., 6., 90.,
            90., 7., 80., 7., 80., 7., 80., 7., 90.,
        ];
        let land = bare((DVec2::ZERO, DVec2::splat(10.0)), 9, heights.to_vec());
        let arguments =
            [("area_m2", ArgumentValue::Number(300.0)), ("order", ArgumentValue::Word(order.into()))];
        run_kind("streams", &land, arguments).expect("streams").features
    }

    #[test]
    fn four_brooks_join_to_the_third_order_and_a_magnitude_of_four() {
        let mut orders: Vec<(i64, i64)> = gutters("strahler")
            .iter()
            .map(|feature| (property(feature, "strahler"), property(feature, "shreve")))
            .collect();
        orders.sort_unstable();
        assert_eq!(orders, [(1, 1), (1, 1), (1, 1), (1, 1), (2, 2), (2, 2), (3, 4)]);
    }

    #[test]
    fn the_order_is_the_one_that_is_asked_for() {
        let highest = |order: &str| gutters(order).iter().map(|feature| property(feature, "order")).max();
        assert_eq!(highest("strahler"), Some(3));
        assert_eq!(highest("shreve"), Some(4));
    }
}

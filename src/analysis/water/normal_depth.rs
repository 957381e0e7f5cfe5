//! The depth at which a discharge flows through a reach of a valley: Manning's formula on its mean section.
//!
//! The section follows from the heights of the reach's posts above its bed, as in synthetic rating curves (Zheng et al. 2018):
//! the water of a depth, divided by the reach's length, is the area of its mean section.

/// The least slope of a bed: filled ground may be level, and water that stands flows off nowhere.
const LEAST_SLOPE: f64 = 1e-4;

/// The greatest depth that is sought, meters.
const DEEPEST_M: f64 = 1000.0;

/// Halvings of the range of depths: to below a millimeter.
const HALVINGS: usize = 40;

/// A reach of a valley.
pub(super) struct ValleyReach {
    /// The heights of its posts above its bed, rising, and the sums up to each, meters.
    heights_m: Vec<f64>,
    sums_m: Vec<f64>,
    /// The ground of a post in m².
    cell_m2: f64,
    length_m: f64,
    slope: f64,
}

/// How a discharge flows through a reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ReachFlow {
    /// The depth above the bed, meters.
    pub depth_m: f64,
    /// The area of the mean section in m².
    pub section_m2: f64,
    /// The mean width of the water, meters.
    pub width_m: f64,
    /// The discharge in m³/s.
    pub discharge: f64,
}

impl ValleyReach {
    /// A reach of posts of these heights above its bed, whose bed falls by `fall_m` over `length_m`, above 0.
    pub fn new(mut heights_m: Vec<f64>, cell_m2: f64, (length_m, fall_m): (f64, f64)) -> Self {
        heights_m.retain(|height| height.is_finite());
        heights_m.sort_unstable_by(f64::total_cmp);
        let add = |sum: &mut f64, height: &f64| {
            *sum += height;
            Some(*sum)
        };
        let sums_m = heights_m.iter().scan(0.0, add).collect();
        Self { heights_m, sums_m, cell_m2, length_m, slope: (fall_m / length_m).max(LEAST_SLOPE) }
    }

    /// How water of a depth flows, with Manning's `roughness` in s/m^⅓.
    pub fn flow(&self, depth_m: f64, roughness: f64) -> ReachFlow {
        let count = self.heights_m.partition_point(|&height| height < depth_m);
        if count == 0 {
            return ReachFlow { depth_m, section_m2: 0.0, width_m: 0.0, discharge: 0.0 };
        }
        let volume_m3 = (count as f64 * depth_m - self.sums_m[count - 1]) * self.cell_m2;
        let (section_m2, width_m) = (volume_m3 / self.length_m, count as f64 * self.cell_m2 / self.length_m);
        // The bed is as wide as the water, its sides as high as the mean depth.
        let perimeter_m = width_m + 2.0 * section_m2 / width_m;
        let radius = libm::cbrt(section_m2 / perimeter_m);
        let discharge = section_m2 * radius * radius * self.slope.sqrt() / roughness;
        ReachFlow { depth_m, section_m2, width_m, discharge }
    }

    /// How a discharge in m³/s flows; at [`DEEPEST_M`] where it would need more.
    pub fn of_discharge(&self, discharge: f64, roughness: f64) -> ReachFlow {
        let (mut low, mut high) = (0.0, DEEPEST_M);
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            if self.flow(middle, roughness).discharge < discharge {
                low = middle;
            } else {
                high = middle;
            }
        }
        self.flow(high, roughness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_channel_has_the_depth_of_mannings_formula() {
        // 100 posts of 10 m × 10 m along 100 m: 100 m wide, level across, with walls.
        let mut heights = vec![0.0; 100];
        heights.extend([500.0; 50]);
        let reach = ValleyReach::new(heights, 100.0, (100.0, 1.0));
        let flow = reach.of_discharge(600.0, 0.05);
        // 2 m deep: 200 m² · (200/104)^⅔ · 0.1 / 0.05 = 618.6; so a little less.
        let at_two = reach.flow(2.0, 0.05).discharge;
        assert!((at_two - 618.6).abs() < 0.1, "{at_two}");
        assert!(flow.depth_m < 2.0 && flow.depth_m > 1.95 && (flow.discharge - 600.0).abs() < 0.01);
    }

    #[test]
    fn a_section_widens_with_depth_and_level_beds_still_flow() {
        let heights = (0..100).map(|post| f64::from(post) * 0.1).collect();
        let reach = ValleyReach::new(heights, 100.0, (100.0, 0.0));
        let [low, high] = [1.0, 5.0].map(|depth_m| reach.flow(depth_m, 0.05));
        // Ten and fifty posts are wet.
        assert_eq!((low.width_m, high.width_m), (10.0, 50.0));
        assert!(low.discharge > 0.0 && high.discharge > low.discharge);
        assert!(reach.of_discharge(1e15, 0.05).depth_m <= DEEPEST_M);
        assert_eq!(ValleyReach::new(vec![f64::NAN], 100.0, (10.0, 1.0)).of_discharge(5.0, 0.05).width_m, 0.0);
    }
}

//! The formula of [`ReliefShading`] at several pixels at once: most of a picture is ground, and each of its pixels is lit.

use glam::Vec3;

use crate::color::LUMINANCE;
use crate::lanes::{LANES, in_lanes, of_each, unit};
use crate::lighting::{LEAST_SINE, ReliefPoint, ReliefShading};

/// A pixel of ground, to be lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReliefPixel {
    /// Its color in linear light.
    pub albedo: Vec3,
    /// Its place on the ground.
    pub point: ReliefPoint,
}

impl ReliefShading {
    /// How much more light a place receives than level ground, no shadow being cast on it, and how much cast shadows take,
    /// both weighted by its contrast: `r` and `s` of the formula.
    #[inline]
    pub fn relief(&self, point: &ReliefPoint) -> (f32, f32) {
        let lanes = ReliefLanes::new(&[ReliefPixel { albedo: Vec3::ZERO, point: *point }]);
        lanes.relief(self, 0)
    }

    /// The light that a place returns, linear, before haze.
    pub fn shade(&self, albedo: Vec3, point: &ReliefPoint) -> Vec3 {
        let [shown] = self.together(&[ReliefPixel { albedo, point: *point }]);
        shown
    }

    /// [`Self::shade`] of each of `pixels`, in less time.
    pub fn shade_each(&self, pixels: &[ReliefPixel]) -> Vec<Vec3> {
        let level = ReliefPoint {
            normal: Vec3::Z,
            form: Vec3::Z,
            sun_visibility: 1.0,
            sky_visibility: 1.0,
            elevation: 0.0,
        };
        in_lanes(
            pixels,
            ReliefPixel { albedo: Vec3::ZERO, point: level },
            #[inline(always)]
            |pixels: &[ReliefPixel; LANES]| self.together(pixels),
        )
    }

    #[inline(always)]
    fn together<const N: usize>(&self, pixels: &[ReliefPixel; N]) -> [Vec3; N] {
        let lanes = ReliefLanes::new(pixels);
        let [mut red, mut green, mut blue] = [[0.0; N]; 3];
        for lane in 0..N {
            [red[lane], green[lane], blue[lane]] = lanes.shown(self, lane);
        }
        std::array::from_fn(|lane| Vec3::new(red[lane], green[lane], blue[lane]))
    }
}

/// The numbers of several pixels, each beside those of the others.
struct ReliefLanes<const N: usize> {
    albedo: [[f32; N]; 3],
    normal: [[f32; N]; 3],
    form: [[f32; N]; 3],
    sun_visibility: [f32; N],
    sky_visibility: [f32; N],
    elevation: [f32; N],
}

impl<const N: usize> ReliefLanes<N> {
    #[inline(always)]
    fn new(pixels: &[ReliefPixel; N]) -> Self {
        Self {
            albedo: vectors(pixels, |pixel| pixel.albedo),
            normal: vectors(pixels, |pixel| pixel.point.normal),
            form: vectors(pixels, |pixel| pixel.point.form),
            sun_visibility: of_each(pixels, |pixel| pixel.point.sun_visibility),
            sky_visibility: of_each(pixels, |pixel| pixel.point.sky_visibility),
            elevation: of_each(pixels, |pixel| pixel.point.elevation),
        }
    }

    /// `r` and `s` of the formula.
    #[inline(always)]
    fn relief(&self, shading: &ReliefShading, lane: usize) -> (f32, f32) {
        let [main, sides, form] = ReliefShading::SHARES;
        let [first, second, third, fourth] = ReliefShading::SIDE_SHARES;
        let normal = at(&self.normal, lane);
        let [one, two, three, four] = &shading.sides;
        let side_light = facing(normal, one) * first
            + facing(normal, two) * second
            + facing(normal, three) * third
            + facing(normal, four) * fourth;
        let sun = main * facing(normal, &shading.to_sun);
        let shade = sun + sides * side_light + form * facing(at(&self.form, lane), &shading.to_sun);
        let low = ReliefShading::LOW_CONTRAST;
        let contrast = low + (1.0 - low) * unit(self.elevation[lane] / 0.75);
        (contrast * (shade - shading.flat()), contrast * sun * (1.0 - self.sun_visibility[lane]))
    }

    /// The share by which small forms in the shade are brighter, less than [`ReliefShading::MOST_DETAIL`] either way.
    #[inline(always)]
    fn shade_detail(&self, shading: &ReliefShading, lane: usize) -> f32 {
        let most = ReliefShading::MOST_DETAIL;
        let (normal, form) = (at(&self.normal, lane), at(&self.form, lane));
        let lit = self.sun_visibility[lane] * facing(normal, &shading.to_sun);
        let shade = not_negative(1.0 - lit / shading.to_sun.z.max(LEAST_SINE));
        let apart = [normal[0] - form[0], normal[1] - form[1], normal[2] - form[2]];
        let detail = shading.detail * shade * dot(apart, shading.to_sun.to_array());
        most * detail / (most + detail.abs())
    }

    /// Red, green and blue of a pixel, lit.
    #[inline(always)]
    fn shown(&self, shading: &ReliefShading, lane: usize) -> [f32; 3] {
        type Relief = ReliefShading;
        let (relief, shadow) = self.relief(shading, lane);
        let gain = if relief < 0.0 { shading.shade_gain } else { Relief::GAIN };
        let brightness = Relief::soft(1.0 + gain * relief - Relief::GAIN * shadow)
            * (1.0 + self.shade_detail(shading, lane));
        let warm = unit(0.5 + 1.2 * (relief - shadow));
        let sky = Relief::CLOSED + (1.0 - Relief::CLOSED) * self.sky_visibility[lane];
        let filled = shading.fill * unit(1.0 - brightness);
        let glare =
            shading.fill * Relief::GLARE * not_negative((brightness - 1.0) / (Relief::BRIGHTEST - 1.0));
        let albedo = at(&self.albedo, lane);
        let gray = dot(albedo, LUMINANCE);
        let mut shown = [0.0; 3];
        for channel in 0..3 {
            let [cool, warmest] = [Relief::COOL, Relief::WARM].map(
                #[inline(always)]
                |color| color.to_array()[channel],
            );
            let [fill, glare_color] = [Relief::FILL, Relief::GLARE_COLOR].map(
                #[inline(always)]
                |color| color.to_array()[channel],
            );
            let own = albedo[channel];
            let tint = blend(cool, warmest, warm);
            let level = blend(cool, warmest, 0.5);
            let deep = not_negative(own + (own - gray) * Relief::FILL_CHROMA);
            let pale = blend(own, gray * glare_color, glare);
            shown[channel] = (pale * tint / level * brightness + deep * fill * filled) * sky;
        }
        shown
    }
}

/// The numbers of vectors, axis by axis.
#[inline(always)]
fn vectors<T, const N: usize>(items: &[T; N], vector: impl Fn(&T) -> Vec3) -> [[f32; N]; 3] {
    [
        of_each(items, |item| vector(item).x),
        of_each(items, |item| vector(item).y),
        of_each(items, |item| vector(item).z),
    ]
}

#[inline(always)]
fn at<const N: usize>(vectors: &[[f32; N]; 3], lane: usize) -> [f32; 3] {
    [vectors[0][lane], vectors[1][lane], vectors[2][lane]]
}

#[inline(always)]
fn dot(one: [f32; 3], other: [f32; 3]) -> f32 {
    one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
}

/// How much a surface faces a light: 0 where it turns away.
#[inline(always)]
fn facing(normal: [f32; 3], light: &Vec3) -> f32 {
    not_negative(dot(normal, light.to_array()))
}

#[inline(always)]
fn not_negative(value: f32) -> f32 {
    if value > 0.0 { value } else { 0.0 }
}

/// Both at their shares, as vectors are blended.
#[inline(always)]
fn blend(from: f32, to: f32, share: f32) -> f32 {
    from * (1.0 - share) + to * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_together_are_lit_as_each_is_alone() {
        let to_sun = Vec3::new(-0.5, 0.4, 0.6).normalize();
        let shading = ReliefShading { fill: 0.7, shade_gain: 2.9, ..ReliefShading::new(to_sun) };
        let pixels: Vec<ReliefPixel> = (0..997)
            .map(|index| {
                let [a, b, c, d] = [7, 11, 13, 17].map(|every| (index % every) as f32 / every as f32);
                let normal = Vec3::new(3.0 * a - 1.5, 2.0 * b - 1.0, 1.0).normalize();
                let form = Vec3::new(a - 0.5, c - 0.5, 1.0).normalize();
                let point = ReliefPoint {
                    normal,
                    form,
                    sun_visibility: d,
                    sky_visibility: 1.1 * c,
                    elevation: 1.4 * b - 0.2,
                };
                ReliefPixel { albedo: Vec3::new(a, b, d), point }
            })
            .collect();
        let bits = |color: Vec3| color.to_array().map(f32::to_bits);
        let alone = pixels.iter().map(|pixel| bits(shading.shade(pixel.albedo, &pixel.point)));
        assert!(alone.eq(shading.shade_each(&pixels).into_iter().map(bits)));
    }
}

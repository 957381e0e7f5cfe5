//! Few colors for a picture of many, by cutting the space of colors where it is widest (after Heckbert 1982).

use image::RgbImage;

/// Colors are counted by so many bits a channel.
const BITS: u32 = 6;

/// Of so many colors of a palette one is kept for a color that boxes mix with others.
const KEPT_SHARE: usize = 6;

/// The colors of a picture, at most 256.
pub struct Palette(Vec<[u8; 3]>);

/// A picture in the colors of a palette.
pub struct PictureColors {
    /// The colors.
    pub palette: Palette,
    /// The color of each pixel, row by row.
    pub indices: Vec<u8>,
}

impl Palette {
    /// The palette of these bytes, three a color.
    pub fn from_bytes(bytes: &[u8]) -> Self {
        Self(bytes.as_chunks().0.to_vec())
    }

    /// Its bytes, three a color.
    pub fn bytes(&self) -> Vec<u8> {
        self.0.concat()
    }

    /// The color of an index; black where the palette has none.
    pub fn color(&self, index: u8) -> [u8; 3] {
        self.0.get(usize::from(index)).copied().unwrap_or_default()
    }

    /// The index of the color nearest to `color`.
    fn nearest(&self, color: [u8; 3]) -> u8 {
        let nearest = self.0.iter().enumerate().min_by_key(|(_, other)| apart(**other, color));
        nearest.map_or(0, |(index, _)| index as u8)
    }

    /// Adds colors, until it has `most`, each the one that all others replace worst: the swatches of a legend, of which there
    /// are few pixels, and which a reader compares with the map.
    fn keep(&mut self, colors: &ColorBox, most: usize) {
        while self.0.len() < most {
            let fault = |&(color, count): &([u8; 3], u32)| {
                u64::from(apart(self.color(self.nearest(color)), color)) * u64::from(count.isqrt())
            };
            let Some(worst) = colors.iter().max_by_key(|counted| (fault(counted), counted.0)) else { return };
            if fault(worst) == 0 {
                return;
            }
            self.0.push(worst.0);
        }
    }
}

/// How far apart two colors are: the sum of the squares of the differences of their channels.
fn apart(one: [u8; 3], other: [u8; 3]) -> u32 {
    one.iter().zip(other).map(|(&a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
}

/// Colors that are near each other, with their numbers of pixels.
type ColorBox = Vec<([u8; 3], u32)>;

impl PictureColors {
    /// The picture in `most` colors or fewer.
    pub fn of(picture: &RgbImage, most: usize) -> Self {
        let bin = |color: [u8; 3]| {
            color.iter().fold(0, |bin, &channel| bin << BITS | usize::from(channel >> (8 - BITS)))
        };
        let mut counts = vec![(0_u32, [0_u32; 3]); 1 << (3 * BITS)];
        for pixel in picture.pixels() {
            let (count, sums) = &mut counts[bin(pixel.0)];
            *count += 1;
            sums.iter_mut().zip(pixel.0).for_each(|(sum, channel)| *sum += u32::from(channel));
        }
        let mean = |&(count, sums): &(u32, [u32; 3])| (sums.map(|sum| (sum / count) as u8), count);
        let mut boxes: Vec<ColorBox> =
            vec![counts.iter().filter(|(count, _)| *count > 0).map(mean).collect()];
        let all = boxes.concat();
        let kept = most / KEPT_SHARE;
        while boxes.len() < most - kept {
            let weight = |colors: &ColorBox| pixels(colors).isqrt().isqrt() * u32::from(widest(colors).1);
            let chosen = (0..boxes.len()).max_by_key(|&index| (weight(&boxes[index]), index));
            let Some(chosen) = chosen.filter(|&index| weight(&boxes[index]) > 0) else { break };
            let halves = halved(boxes.swap_remove(chosen));
            boxes.extend(halves);
        }
        let mut palette = Palette(boxes.iter().map(middle).collect());
        palette.keep(&all, most);
        let of_bins: Vec<u8> = counts
            .iter()
            .map(|counted| if counted.0 > 0 { palette.nearest(mean(counted).0) } else { 0 })
            .collect();
        let indices = picture.pixels().map(|pixel| of_bins[bin(pixel.0)]).collect();
        Self { palette, indices }
    }
}

impl PictureColors {
    /// The picture, so many pixels wide.
    pub fn picture(&self, width: u32) -> RgbImage {
        let data = self.indices.iter().flat_map(|&index| self.palette.color(index)).collect();
        let height = self.indices.len() as u32 / width;
        RgbImage::from_raw(width, height, data).expect("three bytes a pixel")
    }
}

fn pixels(colors: &ColorBox) -> u32 {
    colors.iter().map(|(_, count)| count).sum()
}

/// The channel in which colors differ most, and by how much.
fn widest(colors: &ColorBox) -> (usize, u8) {
    let range = |channel: usize| {
        let values = || colors.iter().map(move |(color, _)| color[channel]);
        values().max().unwrap_or(0) - values().min().unwrap_or(0)
    };
    (0..3)
        .map(|channel| (channel, range(channel)))
        .max_by_key(|&(channel, range)| (range, channel))
        .unwrap_or((0, 0))
}

/// The colors on each side of the middle between the extremes of the channel in which they differ most, so that a few pixels of
/// a color of their own, as in a legend, keep it.
fn halved(mut colors: ColorBox) -> [ColorBox; 2] {
    let (channel, _) = widest(&colors);
    colors.sort_by_key(|(color, _)| (color[channel], *color));
    let [least, most] = [0, colors.len() - 1].map(|index| u32::from(colors[index].0[channel]));
    let below = colors.partition_point(|(color, _)| 2 * u32::from(color[channel]) <= least + most);
    let above = colors.split_off(below);
    [colors, above]
}

/// The mean color.
fn middle(colors: &ColorBox) -> [u8; 3] {
    let all = u64::from(pixels(colors)).max(1);
    [0, 1, 2].map(|channel| {
        let sum: u64 =
            colors.iter().map(|(color, count)| u64::from(color[channel]) * u64::from(*count)).sum();
        (sum / all) as u8
    })
}

#[test]
fn a_swatch_of_few_pixels_keeps_its_color_beside_a_picture_of_many() {
    let swatch = image::Rgb([250, 240, 190]);
    let many = RgbImage::from_fn(256, 128, |x, y| match (x, y) {
        (0..16, 0..10) => swatch,
        _ => image::Rgb([(x / 2) as u8 + 60, (y * 3 / 2) as u8, ((x * y) % 251) as u8]),
    });
    let reduced = PictureColors::of(&many, 60);
    assert!(apart(reduced.picture(256).get_pixel(5, 5).0, swatch.0) < 100);
}

#[test]
fn a_picture_of_few_colors_keeps_them_and_one_of_many_has_near_ones() {
    let few = RgbImage::from_fn(8, 8, |x, _| image::Rgb([(x * 32) as u8, 0, 255]));
    let kept = PictureColors::of(&few, 16);
    let color = |colors: &PictureColors, index: usize| colors.palette.color(colors.indices[index]);
    assert!(few.pixels().enumerate().all(|(index, pixel)| color(&kept, index) == pixel.0));
    let many = RgbImage::from_fn(64, 64, |x, y| image::Rgb([(x * 4) as u8, (y * 4) as u8, 128]));
    let reduced = PictureColors::of(&many, 64);
    assert_eq!(reduced.palette.bytes().len(), 3 * 64);
    let apart = |(index, pixel): (usize, &image::Rgb<u8>)| {
        color(&reduced, index).iter().zip(pixel.0).map(|(&a, b)| u32::from(a.abs_diff(b))).max().unwrap_or(0)
    };
    let most = many.pixels().enumerate().map(apart).max().unwrap_or(0);
    assert!((1..40).contains(&most), "{most}");
}

//! A texture of wooden boards; the same pixels on every machine, and without a seam where it repeats.

use glam::FloatExt;

use crate::scatter::chance::Chance;
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;

/// Texels along a side.
const SIZE: u32 = 512;
/// Boards across the texture; they run along it.
const BOARDS: u32 = 4;
/// The seed of the grain: any other gives other wood.
const SEED: u64 = 0x0a4b;
/// Light oak, and by how much a board or a fiber differs from it, in steps of 255.
const OAK: [f32; 3] = [205.0, 178.0, 141.0];
const BOARD_CONTRAST: f32 = 13.0;
const GRAIN_CONTRAST: f32 = 26.0;
/// The light in the joint between two boards, and its width in texels.
const JOINT_LIGHT: f32 = 0.66;
const JOINT: u32 = 2;

/// Fibers of the grain, coarse and fine: cells along and across the boards, and their share. Cells are longer than wide
/// by as much as fibers are; their numbers divide [`SIZE`], so that the texture repeats.
const FIBERS: [(u32, u32, f32); 3] = [(4, 64, 0.5), (8, 128, 0.3), (32, 256, 0.2)];

/// The texture: boards along U.
pub fn wood() -> Pixels {
    let board = SIZE / BOARDS;
    Pixels::from_fn(SIZE, SIZE, |x, y| {
        let own = random(0, 0, y / board) - 0.5;
        // Each board is cut from another place of the tree.
        let along = x + (random(1, 0, y / board) * SIZE as f32) as u32;
        let grain: f32 = FIBERS.iter().map(|&(u, v, share)| (fiber(along, y, u, v) - 0.5) * share).sum();
        let light = own * BOARD_CONTRAST + grain * 2.0 * GRAIN_CONTRAST;
        let joint = if y % board < JOINT { JOINT_LIGHT } else { 1.0 };
        let [red, green, blue] = OAK.map(|channel| ((channel + light) * joint + 0.5) as u8);
        Srgba::opaque(red, green, blue)
    })
}

/// Smooth noise in 0..=1 on `columns` × `rows` cells, that repeats with the texture.
fn fiber(x: u32, y: u32, columns: u32, rows: u32) -> f32 {
    let cell = |at: u32, count: u32| {
        let size = SIZE / count;
        let part = (at % size) as f32 / size as f32;
        (at / size % count, part.smoothstep(0.0, 1.0))
    };
    let ((column, u), (row, v)) = (cell(x, columns), cell(y, rows));
    let at = |right: u32, down: u32| random(columns, (column + right) % columns, (row + down) % rows);
    let mix = |from: f32, to: f32, part: f32| from + (to - from) * part;
    mix(mix(at(0, 0), at(1, 0), u), mix(at(0, 1), at(1, 1), u), v)
}

fn random(sort: u32, column: u32, row: u32) -> f32 {
    Chance::of(SEED + u64::from(sort), (i64::from(column), i64::from(row))).part() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wood_is_opaque_and_repeats_along_the_boards_without_a_seam() {
        let wood = wood();
        let light = |x: u32, y: u32| i32::from(wood.at(x, y).0[1]);
        let step = |a: u32, b: u32| (0..SIZE).map(|y| (light(a, y) - light(b, y)).abs()).sum::<i32>();
        assert!(
            step(SIZE - 1, 0) < 2 * step(200, 201) + SIZE as i32,
            "{} {}",
            step(SIZE - 1, 0),
            step(200, 201)
        );
        assert!(wood.data().iter().all(|color| color.0[3] == 255));
        let lights: Vec<i32> = wood.data().iter().map(|color| i32::from(color.0[1])).collect();
        assert!(lights.iter().max() > lights.iter().min().map(|least| least + 30).as_ref());
    }
}

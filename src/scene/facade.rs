//! A texture of one bay of one story of a wall: a window in plaster. Repeated, it gives a wall its rhythm; its coarser
//! levels fade it before it flickers.
//!
//! ```text
//!   0 ┌───────────────┐ eaves or the story above
//!     │    ┌──┬──┐    │
//!     │    │  │  │    │ glass, darker below the lintel
//!     │    ├──┼──┤    │
//!     │    └──┴──┘    │
//!     │   ▔▔▔▔▔▔▔▔▔   │ the sill's shade
//!   1 └───────────────┘
//! ```
//!
//! Plaster is white, and so are the corners of the tile: the colors of a wall's vertices paint it.

use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;

/// Texels along a side.
const SIZE: u32 = 64;
/// The columns and rows of the window.
const COLUMNS: [u32; 2] = [20, 44];
const ROWS: [u32; 2] = [17, 46];
/// Texels of its frame, its bars and the shade of the lintel.
const FRAME: u32 = 2;
const LINTEL: u32 = 3;

const PLASTER: Srgba = Srgba::WHITE;
const JOINERY: Srgba = Srgba::opaque(236, 232, 226);
/// Glass mirrors the sky above and shows the dark of the room below.
const GLASS: [Srgba; 2] = [Srgba::opaque(112, 126, 142), Srgba::opaque(66, 74, 84)];
const LINTEL_SHADE: Srgba = Srgba::opaque(72, 76, 82);
const SILL_SHADE: Srgba = Srgba::opaque(196, 192, 188);

/// The texture: bays along U, stories down V.
pub fn facade() -> Pixels {
    Pixels::from_fn(SIZE, SIZE, texel)
}

fn texel(x: u32, y: u32) -> Srgba {
    let ([left, right], [top, bottom]) = (COLUMNS, ROWS);
    if (bottom..bottom + FRAME).contains(&y) && (left - FRAME..right + FRAME).contains(&x) {
        return SILL_SHADE;
    }
    if !(left..right).contains(&x) || !(top..bottom).contains(&y) {
        return PLASTER;
    }
    if y < top + LINTEL {
        return LINTEL_SHADE;
    }
    let (middle, bar) = ((left + right) / 2, top + (bottom - top) * 2 / 5);
    let is_frame = x < left + FRAME || x >= right - FRAME || y >= bottom - FRAME;
    let is_bar = x.abs_diff(middle) < FRAME / 2 || y.abs_diff(bar) < FRAME / 2;
    if is_frame || is_bar {
        return JOINERY;
    }
    if y < bar { GLASS[0] } else { GLASS[1] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_is_dark_in_white_plaster_that_repeats_without_a_seam() {
        let facade = facade();
        for at in 0..SIZE {
            assert_eq!([facade.at(at, 0), facade.at(at, SIZE - 1)], [PLASTER; 2]);
            assert_eq!([facade.at(0, at), facade.at(SIZE - 1, at)], [PLASTER; 2]);
        }
        let light = |color: &Srgba| f64::from(color.0[1]) / 255.0;
        let mean = facade.data().iter().map(light).sum::<f64>() / f64::from(SIZE * SIZE);
        assert!((0.85..0.95).contains(&mean), "from afar a wall stays light: {mean}");
        assert!(facade.data().iter().any(|color| light(color) < 0.35));
    }
}

//! The place of an Erdas Imagine layer that is turned or sheared: a polynomial from map to pixels.
//!
//! ```text
//! MapToPixelXForm (Exfr_GenericXFormHeader)
//! └── XForm0 (Efga_Polynomial)   order │ 2 │ 2 │ terms │ exponents │ matrix 2 × 2 │ vector 2 × 1
//! ```
//!
//! The matrix is stored by columns; pixel (0, 0) is the center of the first sample. Of order 1 alone it is read.

use glam::{DAffine2, DMat2, DVec2};

use crate::formats::hfa::fault::{broken, unsupported};
use crate::formats::hfa::tree::{HfaFields, HfaNode, HfaTree};
use sandtable_raster::content::FileContent;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::georef::checked;

/// The number of the type of 64-bit floats.
const F64: u16 = 10;

/// The place of a layer by its polynomial; `None` where it has none.
pub(super) fn map_from_grid(
    tree: &HfaTree<impl FileContent>,
    layer: &HfaNode,
) -> Result<Option<DAffine2>, DemErrorKind> {
    let Some(header) = tree.child(layer, |node| node.name == "MapToPixelXForm")? else { return Ok(None) };
    let steps = tree.children(header.clone()).collect::<Result<Vec<_>, _>>()?;
    let bent = || unsupported("a place that is bent (MapToPixelXForm)");
    let [step] = &steps[..] else { return Err(bent()) };
    let mut fields = tree.fields(step)?;
    let [order, _, _, terms] = [fields.u32()?, fields.u32()?, fields.u32()?, fields.u32()?];
    if step.kind != "Efga_Polynomial" || order != 1 || terms != 3 {
        return Err(bent());
    }
    let exponents = fields.pointer()? as usize;
    fields.bytes(exponents.saturating_mul(4))?;
    let [a, b, c, d] = matrix(&mut fields)?;
    let [x, y] = matrix(&mut fields)?;
    let pixel_from_map = DAffine2 {
        matrix2: DMat2::from_cols(DVec2::new(a, b), DVec2::new(c, d)),
        translation: DVec2::new(x, y),
    };
    let map_from_pixel = checked(pixel_from_map)?.inverse();
    checked(map_from_pixel * DAffine2::from_translation(DVec2::splat(-0.5))).map(Some)
}

/// Takes a pointer to a matrix of `N` 64-bit floats.
fn matrix<const N: usize>(fields: &mut HfaFields) -> Result<[f64; N], DemErrorKind> {
    fields.pointer()?;
    let (rows, columns, kind, _object) = (fields.u32()?, fields.u32()?, fields.u16()?, fields.u16()?);
    if u64::from(rows) * u64::from(columns) != N as u64 || kind != F64 {
        return Err(broken(format!("a matrix of its place has {rows} x {columns} numbers")));
    }
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        *number = fields.f64()?;
    }
    Ok(numbers)
}

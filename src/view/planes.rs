//! What planes with normals inward say of a box: outside one of them, within them all, or across some.

use glam::Vec3;

/// The planes of `among`, a bit each, that the box `min..=max` crosses; `None` where it lies outside one of them.
/// Boxes within this one need be asked about these only.
pub fn crossed_planes(planes: &[(Vec3, f32)], min: Vec3, max: Vec3, among: u8) -> Option<u8> {
    let mut crossed = 0;
    for (place, &(normal, offset)) in planes.iter().enumerate() {
        let bit = 1 << place;
        if among & bit != 0 {
            let rising = normal.cmpge(Vec3::ZERO);
            if normal.dot(Vec3::select(rising, max, min)) + offset < 0.0 {
                return None;
            }
            if normal.dot(Vec3::select(rising, min, max)) + offset < 0.0 {
                crossed |= bit;
            }
        }
    }
    Some(crossed)
}

//! Boxes against planes with normals inward: outside one plane, inside all, or across some.

use glam::Vec3;

/// The planes of the bit set `tested` that the box `min..=max` crosses, or `None` where the box lies outside one of
/// them. A plane is a normal and an offset; points inside have `normal · point + offset >= 0`.
pub fn crossed_planes(planes: &[(Vec3, f32)], min: Vec3, max: Vec3, tested: u8) -> Option<u8> {
    let mut crossed = 0;
    for (index, &(normal, offset)) in planes.iter().enumerate() {
        let bit = 1 << index;
        if tested & bit != 0 {
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

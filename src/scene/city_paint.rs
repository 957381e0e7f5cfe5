//! The colors of the surfaces of CityJSON: by the table's keys, else by their material, else by what they are of their
//! building.

use glam::DVec3;

use sandtable_draw::color::Srgba;
use sandtable_structure::building::Paint;
use sandtable_vector::cityjson::body::{CitySurface, SurfaceRole};

/// What an unstated surface is: one that rises less than 75° is a roof, or where it faces down lies on the ground.
const UPRIGHT: f64 = 0.26;

const GLASS: Srgba = Srgba::opaque(96, 112, 130);
const DOOR: Srgba = Srgba::opaque(116, 88, 66);

/// The role that a surface has, else that it has by how it faces.
pub(super) fn role(surface: &CitySurface) -> SurfaceRole {
    surface.role.filter(|role| *role != SurfaceRole::Other).unwrap_or_else(|| {
        let DVec3 { z: up, .. } = surface.doubled_area().normalize_or_zero();
        match up {
            up if up > UPRIGHT => SurfaceRole::Roof,
            up if up < -UPRIGHT => SurfaceRole::Ground,
            _ => SurfaceRole::Wall,
        }
    })
}

/// Colors of walls and of roofs that a table or properties state, and the default ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct CityPaint {
    pub stated: [Option<Srgba>; 2],
    pub default: Paint,
}

impl CityPaint {
    /// The color of a surface.
    pub fn color(&self, surface: &CitySurface) -> Srgba {
        let [wall, roof] = self.stated;
        let material = surface.color.map(|[red, green, blue]| Srgba::opaque(red, green, blue));
        let (stated, default) = match role(surface) {
            SurfaceRole::Roof => (roof, self.default.roof),
            SurfaceRole::Ground => (None, self.default.foundation),
            SurfaceRole::Window => (None, GLASS),
            SurfaceRole::Door => (None, DOOR),
            SurfaceRole::Wall | SurfaceRole::Unseen | SurfaceRole::Other => (wall, self.default.wall),
        };
        stated.or(material).unwrap_or(default)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn surface(ring: [(f64, f64, f64); 3], role: Option<SurfaceRole>) -> CitySurface {
        CitySurface { rings: vec![ring.map(DVec3::from).to_vec()], role, color: None, texture: None }
    }

    #[test]
    fn a_key_comes_before_a_material_and_that_before_the_role() {
        let default = Paint::at(DVec2::ZERO, true);
        let plain = CityPaint { stated: [None; 2], default };
        let level = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)];
        let upright = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)];
        assert_eq!(plain.color(&surface(level, None)), default.roof);
        assert_eq!(plain.color(&surface(upright, Some(SurfaceRole::Other))), default.wall);
        assert_eq!(plain.color(&surface(upright, Some(SurfaceRole::Window))), GLASS);
        let mut tiled = surface(level, Some(SurfaceRole::Roof));
        tiled.color = Some([1, 2, 3]);
        assert_eq!(plain.color(&tiled), Srgba::opaque(1, 2, 3));
        let red = Srgba::opaque(200, 0, 0);
        assert_eq!(CityPaint { stated: [None, Some(red)], default }.color(&tiled), red);
    }
}

//! The map projections that only systems of the EPSG registry have, as well-known text spells them: from the words of
//! the registry's proj string, since [`Definition`](crate::projection::Definition) has no room for an azimuth.

use crate::proj_string::ProjString;
use crate::wkt_writer::WktProjection;

/// The projection and its parameters other than the false origin; `None` where well-known text, version 1, has no name
/// for it.
pub(super) fn registered_projection(text: ProjString<'_>) -> Option<WktProjection> {
    let word = |key: &str| text.number(key);
    let latitude_deg = word("lat_0").unwrap_or(0.0);
    let origin =
        || vec![("latitude_of_origin", latitude_deg), ("central_meridian", word("lon_0").unwrap_or(0.0))];
    let center = |meridian: &str| {
        vec![("latitude_of_center", latitude_deg), ("longitude_of_center", word(meridian).unwrap_or(0.0))]
    };
    let scale = ("scale_factor", word("k_0").or(word("k")).unwrap_or(1.0));
    let oblique = |azimuth_deg: f64, grid_deg: f64| {
        [("azimuth", azimuth_deg), ("rectified_grid_angle", grid_deg), scale]
    };
    Some(match text.value("proj")? {
        "aeqd" if !text.has_flag("guam") => ("Azimuthal_Equidistant", center("lon_0")),
        "cass" => ("Cassini_Soldner", origin()),
        "cea" => (
            "Cylindrical_Equal_Area",
            vec![
                ("standard_parallel_1", word("lat_ts").unwrap_or(0.0)),
                ("central_meridian", word("lon_0")?),
            ],
        ),
        "eqc" if word("lat_ts").is_none_or(|parallel| parallel == 0.0) => ("Equirectangular", origin()),
        "krovak" => {
            let cone = [("azimuth", word("alpha")?), ("pseudo_standard_parallel_1", 78.5), scale];
            ("Krovak", [center("lon_0"), cone.to_vec()].concat())
        }
        "omerc" => {
            let azimuth_deg = word("alpha")?;
            let angles = oblique(azimuth_deg, word("gamma").unwrap_or(azimuth_deg));
            let name = if text.has_flag("no_uoff") {
                "Hotine_Oblique_Mercator"
            } else {
                "Hotine_Oblique_Mercator_Azimuth_Center"
            };
            (name, [center("lonc"), angles.to_vec()].concat())
        }
        "poly" => ("Polyconic", origin()),
        // The Swiss projection is the oblique one whose line runs east.
        "somerc" => (
            "Hotine_Oblique_Mercator_Azimuth_Center",
            [center("lon_0"), oblique(90.0, 90.0).to_vec()].concat(),
        ),
        "sterea" => ("Oblique_Stereographic", [origin(), vec![scale]].concat()),
        "tmerc" if text.value("axis") == Some("wsu") => {
            ("Transverse_Mercator_South_Orientated", [origin(), vec![scale]].concat())
        }
        _ => return None,
    })
}

/// The axes of a system, where they are not east and north.
pub(super) fn registered_axes(text: ProjString<'_>) -> &'static str {
    match text.value("axis") {
        Some("wsu") => ",AXIS[\"Y\",WEST],AXIS[\"X\",SOUTH]",
        Some("swu") => ",AXIS[\"X\",SOUTH],AXIS[\"Y\",WEST]",
        _ => "",
    }
}

//! What GDAL adds to a TIFF beyond the standard: the XML of its metadata tag, and units by name.

use crate::dem::error::DemErrorKind;

/// Length of the US survey foot in meters.
pub(crate) const US_FOOT: f64 = 1200.0 / 3937.0;

/// Scale, offset and unit of the first band; 1, 0 and `None` where not stated.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BandMetadata {
    /// What a stored value is multiplied by.
    pub scale: f64,
    /// What is then added.
    pub offset: f64,
    /// Meters in the unit of the result.
    pub meters_per_z: Option<f64>,
}

/// Reads the first band's items from the text of a GDAL_METADATA tag.
///
/// The text is a flat list of `<Item name="…" sample="0" role="scale">…</Item>`; anything else in it is passed
/// over.
pub(crate) fn first_band(xml: &str) -> Result<BandMetadata, DemErrorKind> {
    let mut band = BandMetadata { scale: 1.0, offset: 0.0, meters_per_z: None };
    for piece in xml.split("<Item").skip(1) {
        let Some((head, rest)) = piece.split_once('>') else { continue };
        let text = rest.split('<').next().unwrap_or_default().trim();
        if attribute(head, "sample").is_some_and(|sample| sample != "0") {
            continue;
        }
        match attribute(head, "role").unwrap_or_default() {
            "scale" => band.scale = number("scale", text)?,
            "offset" => band.offset = number("offset", text)?,
            "unittype" => band.meters_per_z = Some(unit(text)?),
            _ => {}
        }
    }
    Ok(band)
}

fn attribute<'a>(head: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = head.split_once(&format!(" {name}=\""))?;
    rest.split('"').next()
}

fn number(what: &str, text: &str) -> Result<f64, DemErrorKind> {
    let value = text.parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| {
        DemErrorKind::broken("GeoTIFF", format!("the {what} of its values is '{text}', not a number"))
    })
}

/// Meters in a vertical unit by its name.
fn unit(text: &str) -> Result<f64, DemErrorKind> {
    match text.to_ascii_lowercase().as_str() {
        "" | "m" | "metre" | "meter" | "metres" | "meters" => Ok(1.0),
        "ft" | "foot" | "feet" | "international foot" | "international feet" => Ok(0.3048),
        "us-ft" | "ftus" | "sft" | "us survey foot" | "us survey feet" | "foot_us" => Ok(US_FOOT),
        "cm" | "centimetre" | "centimeter" | "centimetres" | "centimeters" => Ok(0.01),
        "dm" | "decimetre" | "decimeter" | "decimetres" | "decimeters" => Ok(0.1),
        "km" | "kilometre" | "kilometer" => Ok(1000.0),
        other => Err(DemErrorKind::Unsupported {
            format: "GeoTIFF",
            what: format!("the vertical unit '{other}'"),
            remedy: "convert it to meters first, for example with gdal_calc.py",
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_band_alone_counts() {
        let xml = r#"<GDALMetadata>
            <Item name="OFFSET" sample="0" role="offset">-10</Item>
            <Item name="SCALE" sample="0" role="scale">0.25</Item>
            <Item name="SCALE" sample="1" role="scale">99</Item>
            <Item name="UNITTYPE" sample="0" role="unittype">ft</Item>
            <Item name="scale">7</Item></GDALMetadata>"#;
        let band = first_band(xml).expect("plain");
        assert_eq!(band, BandMetadata { scale: 0.25, offset: -10.0, meters_per_z: Some(0.3048) });
    }

    #[test]
    fn a_unit_that_is_no_length_is_refused_by_name() {
        let xml = r#"<Item name="U" sample="0" role="unittype">kelvin</Item>"#;
        assert!(first_band(xml).expect_err("no length").to_string().contains("kelvin"));
        assert!(first_band("<Item <Item").is_ok());
    }
}

//! GDAL's metadata tag: XML with scale, offset and unit of bands.

use crate::tiff::fault;
use sandtable_geom::length_unit::length_of_name;
use sandtable_raster::error::DemErrorKind;

pub(crate) const GDAL_METADATA: u16 = 42112;

/// Scale, offset and unit of a band; 1, 0 and `None` where not stated.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BandMetadata {
    /// The factor of stored values.
    pub scale: f64,
    /// The offset that is added after scaling.
    pub offset: f64,
    /// Meters in the unit of the result.
    pub meters_per_z: Option<f64>,
}

impl BandMetadata {
    /// Reads the first band's items, `<Item name="…" sample="0" role="scale">…</Item>`; all else is ignored.
    pub fn first_band(xml: &str) -> Result<Self, DemErrorKind> {
        let mut band = Self { scale: 1.0, offset: 0.0, meters_per_z: None };
        for item in xml.split("<Item").skip(1) {
            let Some((head, rest)) = item.split_once('>') else { continue };
            let text = rest.split('<').next().unwrap_or_default().trim();
            if attribute(head, "sample").is_some_and(|sample| sample != "0") {
                continue;
            }
            match attribute(head, "role").unwrap_or_default() {
                "scale" => band.scale = number("scale", text)?,
                "offset" => band.offset = number("offset", text)?,
                "unittype" if !text.is_empty() => band.meters_per_z = Some(unit(text)?),
                _ => {}
            }
        }
        Ok(band)
    }
}

fn attribute<'a>(head: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = head.split_once(&format!(" {name}=\""))?;
    rest.split('"').next()
}

fn number(what: &str, text: &str) -> Result<f64, DemErrorKind> {
    let value = text.parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| fault::broken(format!("the {what} of its values is '{text}', not a number")))
}

fn unit(text: &str) -> Result<f64, DemErrorKind> {
    let remedy = "convert it to meters first, for example with gdal_calc.py";
    length_of_name(text).ok_or_else(|| fault::unsupported(format!("the vertical unit '{text}'"), remedy))
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
        let band = BandMetadata::first_band(xml).expect("plain");
        assert_eq!(band, BandMetadata { scale: 0.25, offset: -10.0, meters_per_z: Some(0.3048) });
    }

    #[test]
    fn a_unit_that_is_no_length_is_refused_by_name() {
        let xml = r#"<Item name="U" sample="0" role="unittype">kelvin</Item>"#;
        assert!(BandMetadata::first_band(xml).expect_err("no length").to_string().contains("kelvin"));
        assert!(BandMetadata::first_band("<Item <Item").is_ok());
    }
}

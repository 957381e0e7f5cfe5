//! Colors and line styles of overlays, as the properties of simplestyle: `stroke`, `stroke-width`, `stroke-opacity`,
//! `stroke-dasharray`, `fill`, `fill-opacity`, `marker-color`. Colors are `#rrggbb`.

use crate::feature::Properties;
use crate::overlay_symbol::{put, put_number};

/// The colors of HTML 4 and those that symbols are drawn in.
const NAMED: [(&str, u32); 26] = [
    ("black", 0x00_0000),
    ("silver", 0xc0_c0c0),
    ("gray", 0x80_8080),
    ("grey", 0x80_8080),
    ("white", 0xff_ffff),
    ("maroon", 0x80_0000),
    ("red", 0xff_0000),
    ("purple", 0x80_0080),
    ("fuchsia", 0xff_00ff),
    ("magenta", 0xff_00ff),
    ("green", 0x00_8000),
    ("lime", 0x00_ff00),
    ("olive", 0x80_8000),
    ("yellow", 0xff_ff00),
    ("navy", 0x00_0080),
    ("blue", 0x00_00ff),
    ("teal", 0x00_8080),
    ("aqua", 0x00_ffff),
    ("cyan", 0x00_ffff),
    ("orange", 0xff_a500),
    ("brown", 0xa5_2a2a),
    ("pink", 0xff_c0cb),
    ("lightblue", 0xad_d8e6),
    ("darkgreen", 0x00_6400),
    ("darkred", 0x8b_0000),
    ("darkblue", 0x00_008b),
];

/// A color and how opaque it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OverlayColor {
    /// Red, green, blue, from the highest byte of three.
    rgb: u32,
    /// 0 to 1.
    opacity: f64,
}

impl OverlayColor {
    /// Returns the color of CSS: `#rgb`, `#rrggbb`, `#rrggbbaa`, `rgb(…)`, `rgba(…)` or a name; `None` for others.
    pub fn from_css(text: &str) -> Option<Self> {
        let text = text.trim().to_ascii_lowercase();
        if let Some(digits) = text.strip_prefix('#') {
            let value = u32::from_str_radix(digits, 16).ok()?;
            return match digits.len() {
                3 => {
                    let twice = |shift: u32| ((value >> shift) & 0xf) * 0x11;
                    Some(Self::opaque(twice(8) << 16 | twice(4) << 8 | twice(0)))
                }
                6 => Some(Self::opaque(value)),
                8 => Some(Self { rgb: value >> 8, opacity: f64::from(value & 0xff) / 255.0 }),
                _ => None,
            };
        }
        if let Some(inner) = text.strip_prefix("rgb") {
            let inner = inner.strip_prefix('a').unwrap_or(inner).trim().strip_prefix('(')?.strip_suffix(')')?;
            let numbers: Vec<&str> = inner.split(',').map(str::trim).collect();
            let channel = |text: &&str| match text.strip_suffix('%') {
                Some(percent) => percent.trim().parse::<f64>().ok().map(|percent| percent * 2.55),
                None => text.parse::<f64>().ok(),
            };
            let channels: Vec<u32> = numbers
                .iter()
                .take(3)
                // Clamped to a byte.
                .map(|text| channel(text).filter(|c| c.is_finite()).map(|c| c.clamp(0.0, 255.0).round() as u32))
                .collect::<Option<_>>()?;
            let [red, green, blue] = channels[..] else { return None };
            let opacity = match numbers.get(3) {
                Some(text) => text.parse::<f64>().ok().filter(|opacity| opacity.is_finite())?.clamp(0.0, 1.0),
                None => 1.0,
            };
            return (numbers.len() <= 4).then_some(Self { rgb: red << 16 | green << 8 | blue, opacity });
        }
        NAMED.iter().find(|named| named.0 == text).map(|named| Self::opaque(named.1))
    }

    /// Returns the color of Delphi's `TColor`: `$00bbggrr`, `clRed` or a decimal number.
    pub fn from_delphi(text: &str) -> Option<Self> {
        let text = text.trim();
        if let Some(name) = text.strip_prefix("cl") {
            let name = name.to_ascii_lowercase();
            // Delphi's names are those of HTML, but for these.
            return match name.as_str() {
                "ltgray" => Some(Self::opaque(0xc0_c0c0)),
                "dkgray" => Some(Self::opaque(0x80_8080)),
                name => NAMED.iter().find(|named| named.0 == name).map(|named| Self::opaque(named.1)),
            };
        }
        let value = match text.strip_prefix('$') {
            Some(digits) => u32::from_str_radix(digits, 16).ok()?,
            None => text.parse().ok()?,
        };
        let [_, blue, green, red] = value.to_be_bytes();
        Some(Self::opaque(u32::from_be_bytes([0, red, green, blue])))
    }

    /// Returns the color of a number with alpha in its highest byte, which many write with a sign: `-65536` is opaque red.
    pub fn from_argb(text: &str) -> Option<Self> {
        let number: i64 = text.trim().parse().ok()?;
        let in_range = (i64::from(i32::MIN)..=i64::from(u32::MAX)).contains(&number);
        // The lowest 32 bits of either form.
        let argb = in_range.then_some((number & 0xffff_ffff) as u32)?;
        Some(Self { rgb: argb & 0xff_ffff, opacity: f64::from(argb >> 24) / 255.0 })
    }

    const fn opaque(rgb: u32) -> Self {
        Self { rgb, opacity: 1.0 }
    }

    /// Returns it as `#rrggbb`.
    pub fn text(self) -> String {
        format!("#{:06x}", self.rgb)
    }

    /// Adds it as a property, and its opacity where that is less than 1.
    pub fn put(self, properties: &mut Properties, name: &str, opacity_name: &str) {
        put(properties, name, self.text());
        if self.opacity < 1.0 {
            put_number(properties, opacity_name, (self.opacity * 1000.0).round() / 1000.0);
        }
    }
}

/// Adds the declarations of a style, `stroke:#ff0000;stroke-width:2`, as properties; returns those whose value is not read.
/// Declarations of fonts and the like are no properties.
pub(crate) fn put_css(properties: &mut Properties, style: &str) -> Vec<String> {
    let mut unread = Vec::new();
    for declaration in style.split(';') {
        let Some((name, value)) = declaration.split_once(':') else { continue };
        if !put_declaration(properties, name, value) {
            unread.push(declaration.trim().to_owned());
        }
    }
    unread
}

/// Adds one declaration of a style; returns `false` where its value is not read.
pub(crate) fn put_declaration(properties: &mut Properties, name: &str, value: &str) -> bool {
    let (name, value) = (name.trim().to_ascii_lowercase(), value.trim());
    match name.as_str() {
        "stroke" | "fill" if value.eq_ignore_ascii_case("none") => put(properties, &name, "none"),
        "stroke" | "fill" => match OverlayColor::from_css(value) {
            Some(color) => color.put(properties, &name, &format!("{name}-opacity")),
            None => return false,
        },
        "stroke-width" | "stroke-opacity" | "fill-opacity" => {
            let number: Option<f64> = value.trim_end_matches("px").trim().parse().ok();
            match number.filter(|number| (0.0..=1e4).contains(number)) {
                Some(number) => put_number(properties, &name, number),
                None => return false,
            }
        }
        "stroke-dash" | "stroke-dasharray" if value.eq_ignore_ascii_case("none") => {}
        "stroke-dash" | "stroke-dasharray" => {
            let lengths: Option<Vec<f64>> = value
                .split([',', ' '])
                .filter(|length| !length.is_empty())
                .map(|length| length.parse().ok().filter(|length| (0.0..=1e4).contains(length)))
                .collect();
            match lengths.filter(|lengths| !lengths.is_empty() && lengths.len() <= 16) {
                Some(lengths) => {
                    let texts: Vec<String> = lengths.iter().map(f64::to_string).collect();
                    put(properties, "stroke-dasharray", texts.join(","));
                }
                None => return false,
            }
        }
        _ => {}
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_of_three_families_have_one_form() {
        let css = |text: &str| OverlayColor::from_css(text).map(OverlayColor::text);
        assert_eq!(css("#6f6").as_deref(), Some("#66ff66"));
        assert_eq!(css(" RGB(0, 0,255)").as_deref(), Some("#0000ff"));
        assert_eq!(css("rgb(100%,0%,50%)").as_deref(), Some("#ff0080"));
        assert_eq!(css("Red").as_deref(), Some("#ff0000"));
        for wrong in ["", "#12345", "rgb(1,2)", "rgb(nan,0,0)", "rgba(1,2,3,4,5)", "reddish", "#ggg", "#+12"] {
            assert_eq!(css(wrong), None, "{wrong}");
        }
        let delphi = |text: &str| OverlayColor::from_delphi(text).map(OverlayColor::text);
        assert_eq!(delphi("$000080FF").as_deref(), Some("#ff8000"));
        assert_eq!((delphi("clBlue").as_deref(), delphi("255").as_deref()), (Some("#0000ff"), Some("#ff0000")));
        let argb = |text: &str| OverlayColor::from_argb(text);
        assert_eq!(argb("-65536"), Some(OverlayColor { rgb: 0xff_0000, opacity: 1.0 }));
        assert_eq!(argb("2147418112").map(OverlayColor::text).as_deref(), Some("#ff0000"));
        assert_eq!((argb("99999999999"), argb("x")), (None, None));
    }

    #[test]
    fn a_style_becomes_the_properties_of_simplestyle() {
        let mut properties = Properties::new();
        let unread = put_css(
            &mut properties,
            "stroke-width:1;stroke-dash: 15,3 ;fill:rgba(102,255,102,0.25);stroke:none;font-family:Verdana;stroke-opacity:x",
        );
        assert_eq!(unread, ["stroke-opacity:x"]);
        let expected = serde_json::json!({
            "stroke-width": 1.0, "stroke-dasharray": "15,3", "fill": "#66ff66", "fill-opacity": 0.25, "stroke": "none",
        });
        assert_eq!(serde_json::to_value(&properties).expect("texts"), expected);
    }
}

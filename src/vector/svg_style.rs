//! Styles of lines and areas as SVG writes them, `stroke:#f00;fill:none;stroke-width:2`, as properties of simplestyle.

use crate::feature::Properties;
use crate::overlay_schema::{
    FILL, FILL_OPACITY, STROKE, STROKE_DASHES, STROKE_OPACITY, STROKE_WIDTH, set, set_number,
};

/// The colors that overlays name (CSS, level 1 and a few of SVG).
const NAMED: [(&str, u32); 22] = [
    ("aqua", 0x00_ff_ff),
    ("black", 0x00_00_00),
    ("blue", 0x00_00_ff),
    ("brown", 0xa5_2a_2a),
    ("cyan", 0x00_ff_ff),
    ("fuchsia", 0xff_00_ff),
    ("gray", 0x80_80_80),
    ("green", 0x00_80_00),
    ("grey", 0x80_80_80),
    ("lime", 0x00_ff_00),
    ("magenta", 0xff_00_ff),
    ("maroon", 0x80_00_00),
    ("navy", 0x00_00_80),
    ("olive", 0x80_80_00),
    ("orange", 0xff_a5_00),
    ("pink", 0xff_c0_cb),
    ("purple", 0x80_00_80),
    ("red", 0xff_00_00),
    ("silver", 0xc0_c0_c0),
    ("teal", 0x00_80_80),
    ("white", 0xff_ff_ff),
    ("yellow", 0xff_ff_00),
];

/// Sets what a style states.
pub(crate) fn add_style(style: &str, properties: &mut Properties) {
    for part in style.split(';') {
        let Some((key, value)) = part.split_once(':') else { continue };
        let (key, value) = (key.trim().to_ascii_lowercase(), value.trim());
        match key.as_str() {
            STROKE | FILL => set_color(properties, &key, value),
            "stroke-fill" => set_color(properties, STROKE, value),
            STROKE_WIDTH | STROKE_OPACITY | FILL_OPACITY => {
                let number: Option<f64> = value.trim_end_matches("px").trim().parse().ok();
                set_number(properties, &key, number);
            }
            STROKE_DASHES | "stroke-dash" if value != "none" => set(properties, STROKE_DASHES, value),
            _ => {}
        }
    }
}

fn set_color(properties: &mut Properties, key: &str, text: &str) {
    if text.eq_ignore_ascii_case("none") || text.eq_ignore_ascii_case("transparent") {
        set(properties, key, "none");
    } else if let Some([red, green, blue]) = color(text) {
        set(properties, key, hex_color([red, green, blue]));
    }
}

/// A color as `#rrggbb`.
pub(crate) fn hex_color([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The color of Delphi: `$00bbggrr`, `clRed` or a decimal number.
pub(crate) fn delphi_color(text: &str) -> Option<[u8; 3]> {
    let text = text.trim();
    if let Some(name) = text.strip_prefix("cl") {
        return match name {
            "LtGray" => Some([0xc0; 3]),
            "DkGray" => Some([0x80; 3]),
            name => color(name),
        };
    }
    let number: u32 = match text.strip_prefix('$') {
        Some(digits) => u32::from_str_radix(digits, 16).ok()?,
        None => text.parse().ok()?,
    };
    let [_, blue, green, red] = number.to_be_bytes();
    Some([red, green, blue])
}

/// The color of `#rgb`, `#rrggbb`, `rgb(r, g, b)` in numbers or per cent, or a name.
fn color(text: &str) -> Option<[u8; 3]> {
    let lower = text.to_ascii_lowercase();
    if let Some(digits) = lower.strip_prefix('#') {
        let number = u32::from_str_radix(digits, 16).ok()?;
        return match digits.len() {
            3 => Some([number >> 8, number >> 4, number].map(|digit| (digit & 15) as u8 * 17)),
            6 => Some(rgb(number)),
            _ => None,
        };
    }
    if let Some(list) = lower.strip_prefix("rgb(").and_then(|rest| rest.strip_suffix(')')) {
        let mut parts = list.split(',').map(|part| {
            let part = part.trim();
            let value = match part.strip_suffix('%') {
                Some(share) => share.trim().parse::<f64>().ok()? * 2.55,
                None => part.parse().ok()?,
            };
            (0.0..=255.5).contains(&value).then_some(value.round() as u8)
        });
        return Some([parts.next()??, parts.next()??, parts.next()??]);
    }
    NAMED.iter().find(|(name, _)| *name == lower).map(|(_, number)| rgb(*number))
}

fn rgb(number: u32) -> [u8; 3] {
    let [_, red, green, blue] = number.to_be_bytes();
    [red, green, blue]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_style_becomes_properties_of_simplestyle() {
        let mut properties = Properties::new();
        add_style(
            "stroke:rgb(0, 100%,255);stroke-width:2px;fill:none; stroke-dash:15;fill-opacity:x",
            &mut properties,
        );
        let texts = [("stroke", "#00ffff"), ("fill", "none"), ("stroke-dasharray", "15")];
        for (key, expected) in texts {
            assert_eq!(properties[key], expected, "{key}");
        }
        assert_eq!(properties["stroke-width"], 2.0);
        assert!(!properties.contains_key("fill-opacity"));
    }

    #[test]
    fn colors_are_known_in_all_their_forms_and_others_are_none() {
        for (text, expected) in [("#fa0", [255, 170, 0]), ("#66FF66", [102, 255, 102]), ("Navy", [0, 0, 128])]
        {
            assert_eq!(color(text), Some(expected), "{text}");
        }
        for text in ["", "#", "#ffff", "rgb(1,2)", "rgb(300,0,0)", "mauve", "#äöü"] {
            assert_eq!(color(text), None, "{text}");
        }
    }

    #[test]
    fn colors_of_delphi_have_their_red_last() {
        assert_eq!(delphi_color("$000080FF"), Some([255, 128, 0]));
        assert_eq!((delphi_color("clBlue"), delphi_color("255")), (Some([0, 0, 255]), Some([255, 0, 0])));
        assert_eq!((delphi_color("$x"), delphi_color("clMoss")), (None, None));
    }
}

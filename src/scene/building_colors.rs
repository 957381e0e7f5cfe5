//! Colors as OpenStreetMap's properties write them: `#rgb`, `#rrggbb`, or one of the names that CSS began with.

use sandtable_description::color::Color;
use sandtable_description::scalar::Scalar;
use sandtable_draw::color::Srgba;

/// The names in use on buildings (CSS Color Module Level 4, its basic colors and a few more), muted to what paint and
/// stone look like in daylight: a wall tagged `red` is brick, not a signal.
const NAMES: [(&str, Srgba); 22] = [
    ("white", Srgba::opaque(244, 242, 238)),
    ("silver", Srgba::opaque(192, 194, 196)),
    ("lightgrey", Srgba::opaque(206, 206, 204)),
    ("lightgray", Srgba::opaque(206, 206, 204)),
    ("grey", Srgba::opaque(142, 142, 140)),
    ("gray", Srgba::opaque(142, 142, 140)),
    ("darkgrey", Srgba::opaque(106, 106, 106)),
    ("darkgray", Srgba::opaque(106, 106, 106)),
    ("black", Srgba::opaque(54, 54, 56)),
    ("red", Srgba::opaque(178, 74, 60)),
    ("maroon", Srgba::opaque(122, 56, 50)),
    ("brown", Srgba::opaque(138, 96, 70)),
    ("orange", Srgba::opaque(212, 140, 84)),
    ("yellow", Srgba::opaque(228, 204, 128)),
    ("beige", Srgba::opaque(230, 220, 192)),
    ("tan", Srgba::opaque(204, 178, 140)),
    ("cream", Srgba::opaque(240, 230, 204)),
    ("olive", Srgba::opaque(128, 124, 80)),
    ("green", Srgba::opaque(104, 138, 98)),
    ("teal", Srgba::opaque(90, 138, 138)),
    ("blue", Srgba::opaque(98, 122, 160)),
    ("pink", Srgba::opaque(226, 184, 176)),
];

/// The color that a property's value names, in whatever case; `None` where it names none.
pub fn color_named(value: &Scalar) -> Option<Srgba> {
    let Scalar::Text(text) = value else { return None };
    let text = text.trim().to_lowercase();
    let named = NAMES.iter().find(|(name, _)| *name == text).map(|(_, color)| *color);
    named.or_else(|| Color::parse(&text).map(|color| Srgba(color.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_digits_are_read_and_nothing_else() {
        let named = |text: &str| color_named(&Scalar::Text(text.into()));
        assert_eq!(named("#12aB9f"), Some(Srgba::opaque(0x12, 0xab, 0x9f)));
        assert_eq!(named(" Gray "), named("grey"));
        assert!(named("red").is_some() && named("reddish").is_none() && named("#12").is_none());
        assert_eq!(color_named(&Scalar::Number(3.0)), None);
    }
}

//! Material libraries: names, diffuse colors, opacities and the maps of both, as `tobj` reads them from repaired lines.

use std::fmt::Write;

use crate::material::MappedMaterial;
use sandtable_draw::color::Srgba;

use super::assemble::color_from_channels;
use super::map_options::{MtlMap, MtlUvTransform};
use super::sound::{NAME_MARK, unmarked};
use super::text::{logical_lines, number, split_keyword};

/// A material, and what its maps do besides.
#[derive(Clone, Debug)]
pub(super) struct MtlMaterial {
    pub mapped: MappedMaterial,
    pub uv: MtlUvTransform,
    /// Notes on options that are not drawn.
    pub notes: Vec<String>,
}

/// The materials of a library, in order. Unknown statements are ignored.
pub(super) fn parse(text: &str) -> Result<Vec<MtlMaterial>, tobj::LoadError> {
    let mut sound = String::new();
    for (_, line) in logical_lines(text) {
        let (keyword, rest) = split_keyword(&line);
        push_sound(&mut sound, keyword, rest);
    }
    let (materials, _) = tobj::load_mtl_buf(&mut sound.as_bytes())?;
    Ok(materials.into_iter().map(mapped).collect())
}

/// Writes a statement so that `tobj` reads it right; nothing for what is not used. A transparency becomes an opacity.
fn push_sound(sound: &mut String, keyword: &str, rest: &str) {
    let first = || rest.split_whitespace().next().map(number).filter(|value| value.is_finite());
    let _ = match keyword {
        "newmtl" | "map_Kd" | "map_d" => writeln!(sound, "{keyword} {NAME_MARK}{rest}"),
        "Kd" => match color(rest) {
            Some([red, green, blue]) => writeln!(sound, "Kd {red} {green} {blue}"),
            None => return,
        },
        "d" => writeln!(sound, "d {}", first().unwrap_or(1.0).clamp(0.0, 1.0)),
        "Tr" => writeln!(sound, "d {}", 1.0 - first().unwrap_or(0.0).clamp(0.0, 1.0)),
        _ => return,
    };
}

fn mapped(material: tobj::Material) -> MtlMaterial {
    let name = unmarked(&material.name);
    let channels = material.diffuse.unwrap_or([0.8; 3]);
    let color = color_from_channels(channels);
    // Exporters write black under a texture, which would blacken it.
    let is_black = channels.iter().all(|&channel| channel <= 0.0);
    let parsed = |map: &Option<String>| {
        Some(MtlMap::parse(unmarked(map.as_ref()?))).filter(|map| !map.file.name.is_empty())
    };
    let [map, opacity_map] = [&material.diffuse_texture, &material.dissolve_texture].map(parsed);
    let mut notes = Vec::new();
    for (keyword, map) in [("map_Kd", &map), ("map_d", &opacity_map)] {
        for option in map.iter().flat_map(|map| &map.unused) {
            notes.push(format!("option '{option}' of {keyword} of material '{name}' is not drawn"));
        }
    }
    if let (Some(map), Some(mask)) = (&map, &opacity_map)
        && map.uv != mask.uv
    {
        notes.push(format!("-o and -s of map_d of material '{name}' are not drawn: it lies like map_Kd"));
    }
    let uv = map.as_ref().or(opacity_map.as_ref()).map(|map| map.uv).unwrap_or_default();
    let mapped = MappedMaterial {
        name: name.into(),
        color,
        color_under_map: if is_black { Srgba::WHITE } else { color },
        alpha: (material.dissolve.unwrap_or(1.0) * 255.0 + 0.5) as u8,
        map: map.map(|map| map.file),
        opacity_map: opacity_map.map(|map| map.file),
        // The format has no sides, and its files are modeled for viewers that draw both.
        two_sided: true,
    };
    MtlMaterial { mapped, uv, notes }
}

/// Three values, or one for all three; `None` for `spectral` and `xyz` colors.
fn color(rest: &str) -> Option<[f32; 3]> {
    let values: Vec<f32> =
        rest.split_whitespace().map(number).take_while(|value| value.is_finite()).take(3).collect();
    match values[..] {
        [red, green, blue] => Some([red, green, blue]),
        [gray, ..] => Some([gray; 3]),
        [] => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_statements_are_skipped_and_the_library_is_kept() {
        let text =
            "Kd 1 0 0\nnewmtl a b\n  Kd 0.5\n d 0.25\nKd spectral x.rfl\nnewmtl c\nTr 0.25\nmap_Kd\nilum";
        let materials: Vec<MappedMaterial> =
            parse(text).expect("repaired lines").into_iter().map(|material| material.mapped).collect();
        assert_eq!(materials.len(), 2);
        assert_eq!(
            (materials[0].name.as_str(), materials[0].color, materials[0].alpha),
            ("a b", Srgba::opaque(128, 128, 128), 64)
        );
        assert_eq!((materials[1].alpha, &materials[1].map), (191, &None));
    }

    #[test]
    fn options_that_are_not_drawn_are_named_with_their_material() {
        let text = "newmtl wall\nmap_Kd -t 1 1 1 -s 2 2 2 a.png\nmap_d -boost 2 b.png";
        let wall = parse(text).expect("sound").remove(0);
        assert_eq!(wall.mapped.map.map(|map| map.name).as_deref(), Some("a.png"));
        assert_eq!(
            wall.notes,
            [
                "option '-t 1 1 1' of map_Kd of material 'wall' is not drawn",
                "option '-boost 2' of map_d of material 'wall' is not drawn",
                "-o and -s of map_d of material 'wall' are not drawn: it lies like map_Kd",
            ]
        );
        assert!(parse("newmtl wall\nmap_Kd -s 2 2 2 a.png").expect("sound").remove(0).notes.is_empty());
    }
}

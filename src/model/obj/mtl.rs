//! Material libraries: names, diffuse colors, opacities and the maps of both, as `tobj` reads them from repaired lines.

use std::fmt::Write;

use crate::material::MappedMaterial;
use sandtable_draw::color::Srgba;

use super::assemble::color_from_channels;
use super::sound::{NAME_MARK, unmarked};
use super::text::{logical_lines, number, split_keyword};

/// The materials of a library, in order. Unknown statements are ignored.
pub(super) fn parse(text: &str) -> Result<Vec<MappedMaterial>, tobj::LoadError> {
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

fn mapped(material: tobj::Material) -> MappedMaterial {
    let channels = material.diffuse.unwrap_or([0.8; 3]);
    let color = color_from_channels(channels);
    // Exporters write black under a texture, which would blacken it.
    let is_black = channels.iter().all(|&channel| channel <= 0.0);
    let file = |map: Option<String>| Some(without_options(unmarked(&map?))).filter(|file| !file.is_empty());
    MappedMaterial {
        name: unmarked(&material.name).into(),
        color,
        color_under_map: if is_black { Srgba::WHITE } else { color },
        alpha: (material.dissolve.unwrap_or(1.0) * 255.0 + 0.5) as u8,
        map: file(material.diffuse_texture),
        opacity_map: file(material.dissolve_texture),
        // The format has no sides, and its files are modeled for viewers that draw both.
        two_sided: true,
    }
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

/// The file name after map options; it may hold spaces.
fn without_options(rest: &str) -> String {
    let mut words = rest;
    while words.starts_with('-') {
        let (option, after) = words.split_once(char::is_whitespace).unwrap_or((words, ""));
        words = after.trim_start();
        let most = match option {
            "-o" | "-s" | "-t" => 3,
            "-mm" => 2,
            _ => 1,
        };
        for count in 0..most {
            let Some((value, after)) = words.split_once(char::is_whitespace) else { break };
            // Offsets, scales and turbulence may have fewer than three numbers.
            if count > 0 && value.parse::<f32>().is_err() {
                break;
            }
            words = after.trim_start();
        }
    }
    words.trim().trim_matches('"').into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_removed_and_spaces_kept() {
        for (rest, file) in [
            ("texture 01.png", "texture 01.png"),
            ("-o 0.1 diffuse.jpg", "diffuse.jpg"),
            ("-s 1 2 3 -mm 0 1 -clamp on my wall.png", "my wall.png"),
            ("-texres 512 input.jpg", "input.jpg"),
            ("-colorspace sRGB -o 0.1 diffuse.jpg", "diffuse.jpg"),
            ("maps\\brick.bmp", "maps\\brick.bmp"),
        ] {
            assert_eq!(without_options(rest), file);
        }
    }

    #[test]
    fn odd_statements_are_skipped_and_the_library_is_kept() {
        let text =
            "Kd 1 0 0\nnewmtl a b\n  Kd 0.5\n d 0.25\nKd spectral x.rfl\nnewmtl c\nTr 0.25\nmap_Kd\nilum";
        let materials = parse(text).expect("repaired lines");
        assert_eq!(materials.len(), 2);
        assert_eq!(
            (materials[0].name.as_str(), materials[0].color, materials[0].alpha),
            ("a b", Srgba::opaque(128, 128, 128), 64)
        );
        assert_eq!((materials[1].alpha, &materials[1].map), (191, &None));
    }
}

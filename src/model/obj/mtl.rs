//! Material libraries: names, diffuse colors, opacities and the maps of both.

use crate::material::MappedMaterial;
use sandtable_draw::color::Srgba;

use super::parse::color_from_channels;
use super::text::{logical_lines, number, split_keyword};

/// The materials of a library, in order. Unknown statements are ignored.
pub(super) fn parse(text: &str) -> Vec<MappedMaterial> {
    let mut materials: Vec<MappedMaterial> = Vec::new();
    for (_, line) in logical_lines(text) {
        let (keyword, rest) = split_keyword(&line);
        if keyword == "newmtl" {
            materials.push(MappedMaterial {
                name: rest.into(),
                color: color_from_channels([0.8; 3]),
                color_under_map: color_from_channels([0.8; 3]),
                alpha: 255,
                map: None,
                opacity_map: None,
                // The format has no sides, and its files are modeled for viewers that draw both.
                two_sided: true,
            });
        } else if let Some(material) = materials.last_mut() {
            set(material, keyword, rest);
        }
    }
    materials
}

fn set(material: &mut MappedMaterial, keyword: &str, rest: &str) {
    let first = || rest.split_whitespace().next().map(number).filter(|value| value.is_finite());
    let file = || Some(without_options(rest)).filter(|file| !file.is_empty());
    let alpha = |opacity: f32| (opacity * 255.0 + 0.5) as u8;
    match keyword {
        "Kd" => {
            let Some(channels) = color(rest) else { return };
            material.color = color_from_channels(channels);
            // Exporters write black under a texture, which would blacken it.
            let is_black = channels.iter().all(|&channel| channel <= 0.0);
            material.color_under_map = if is_black { Srgba::WHITE } else { material.color };
        }
        "d" => material.alpha = alpha(first().unwrap_or(1.0).clamp(0.0, 1.0)),
        "Tr" => material.alpha = alpha(1.0 - first().unwrap_or(0.0).clamp(0.0, 1.0)),
        "map_Kd" => material.map = file(),
        "map_d" => material.opacity_map = file(),
        _ => {}
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
        let materials = parse(text);
        assert_eq!(materials.len(), 2);
        assert_eq!(
            (materials[0].name.as_str(), materials[0].color, materials[0].alpha),
            ("a b", Srgba::opaque(128, 128, 128), 64)
        );
        assert_eq!((materials[1].alpha, &materials[1].map), (191, &None));
    }
}

//! Material libraries: names, diffuse colors, opacities and the maps of both.

use super::text::{logical_lines, number, split_keyword};

/// A material as stored.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MtlMaterial {
    pub name: String,
    /// The diffuse color: sRGB in 0..=1.
    pub diffuse: [f32; 3],
    /// 1 is opaque.
    pub opacity: f32,
    /// The file of the diffuse map.
    pub map: Option<String>,
    /// The file of the opacity map; often the diffuse map's.
    pub opacity_map: Option<String>,
}

/// The materials of a library, in order. Unknown statements are ignored.
pub(super) fn parse(text: &str) -> Vec<MtlMaterial> {
    let mut materials: Vec<MtlMaterial> = Vec::new();
    for (_, line) in logical_lines(text) {
        let (keyword, rest) = split_keyword(&line);
        if keyword == "newmtl" {
            materials.push(MtlMaterial {
                name: rest.into(),
                diffuse: [0.8; 3],
                opacity: 1.0,
                map: None,
                opacity_map: None,
            });
        } else if let Some(material) = materials.last_mut() {
            set(material, keyword, rest);
        }
    }
    materials
}

fn set(material: &mut MtlMaterial, keyword: &str, rest: &str) {
    let first = || rest.split_whitespace().next().map(number).filter(|value| value.is_finite());
    let file = || Some(without_options(rest)).filter(|file| !file.is_empty());
    match keyword {
        "Kd" => material.diffuse = color(rest).unwrap_or(material.diffuse),
        "d" => material.opacity = first().unwrap_or(1.0).clamp(0.0, 1.0),
        "Tr" => material.opacity = 1.0 - first().unwrap_or(0.0).clamp(0.0, 1.0),
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
            (materials[0].name.as_str(), materials[0].diffuse, materials[0].opacity),
            ("a b", [0.5; 3], 0.25)
        );
        assert_eq!((materials[1].opacity, &materials[1].map), (0.75, &None));
    }
}

//! The constants of shading as declarations of a shading language: the formulas are written in Rust, in WGSL and in GLSL, their
//! numbers once.

use std::fmt::Write;

use glam::Vec3;

use crate::lighting::ReliefShading;
use crate::water::WaterColor;
use crate::{
    area_texture, cover_noise, field_plots, ground_cover, ground_grain, ground_tops, hatching, lighting,
    water, water_relief, wireframe,
};

/// A language that shaders are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShaderLanguage {
    /// The WebGPU Shading Language.
    Wgsl,
    /// The OpenGL ES Shading Language 3.00.
    Glsl,
}

impl ShaderLanguage {
    /// Returns a line that declares each constant by its name: one number as a scalar, two to four as a vector.
    pub fn declarations(self, constants: &[(&str, Vec<f32>)]) -> String {
        let mut text = String::new();
        for (name, values) in constants {
            let list = values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", ");
            let _ = match (self, values.len()) {
                (Self::Wgsl, 1) => writeln!(text, "const {name} = {list};"),
                (Self::Wgsl, count) => writeln!(text, "const {name} = vec{count}f({list});"),
                (Self::Glsl, 1) => writeln!(text, "const float {name} = {list};"),
                (Self::Glsl, count) => writeln!(text, "const vec{count} {name} = vec{count}({list});"),
            };
        }
        text
    }
}

/// Returns the constants of [`ReliefShading`], the grain, the land cover, water and relief in it, hatching and wireframes.
pub fn shader_constants() -> Vec<(&'static str, Vec<f32>)> {
    let vector = |color: Vec3| color.to_array().to_vec();
    let lengths = |waves: &[(f32, f32); 3]| waves.iter().map(|wave| wave.0).collect();
    let shares = |waves: &[(f32, f32); 3]| waves.iter().map(|wave| wave.1).collect();
    vec![
        ("RELIEF_SHARES", ReliefShading::SHARES.to_vec()),
        ("RELIEF_SIDE_RISE", vec![lighting::SIDE_RISE]),
        ("RELIEF_GAIN", vec![ReliefShading::GAIN]),
        ("RELIEF_DARKEST", vec![ReliefShading::DARKEST]),
        ("RELIEF_TOE", vec![ReliefShading::TOE]),
        ("RELIEF_SHOULDER", vec![ReliefShading::SHOULDER]),
        ("RELIEF_BRIGHTEST", vec![ReliefShading::BRIGHTEST]),
        ("RELIEF_MOST_DETAIL", vec![ReliefShading::MOST_DETAIL]),
        ("RELIEF_LEAST_SINE", vec![lighting::LEAST_SINE]),
        ("RELIEF_WARM", vector(ReliefShading::WARM)),
        ("RELIEF_COOL", vector(ReliefShading::COOL)),
        ("RELIEF_FILL", vector(ReliefShading::FILL)),
        ("RELIEF_FILL_CHROMA", vec![ReliefShading::FILL_CHROMA]),
        ("RELIEF_GLARE", vec![ReliefShading::GLARE]),
        ("RELIEF_GLARE_COLOR", vector(ReliefShading::GLARE_COLOR)),
        ("RELIEF_CLOSED", vec![ReliefShading::CLOSED]),
        ("RELIEF_LOW_CONTRAST", vec![ReliefShading::LOW_CONTRAST]),
        ("GRAIN_WAVES_M", lengths(&ground_grain::WAVES)),
        ("GRAIN_SHARES", shares(&ground_grain::WAVES)),
        ("GRAIN_WAVE_PX", vec![ground_grain::WIDE_PX]),
        ("GRAIN_LEVEL", vec![ground_grain::LEVEL]),
        ("GRAIN_STEEP", vec![ground_grain::STEEP]),
        ("NOISE_FIRST_M", vec![cover_noise::FIRST_M]),
        ("NOISE_FINER", vec![cover_noise::FINER]),
        ("NOISE_OCTAVES", vec![cover_noise::OCTAVES as f32]),
        ("NOISE_FIRST_FINE", vec![cover_noise::FIRST_FINE as f32]),
        ("NOISE_SHARE", vec![cover_noise::SHARE]),
        ("NOISE_FAINTER", vec![cover_noise::FAINTER]),
        ("NOISE_TURN", cover_noise::TURN.to_array().to_vec()),
        ("NOISE_WAVE_PX", vec![cover_noise::WAVE_PX]),
        ("NOISE_FORM_CELLS", vec![cover_noise::FORM_CELLS]),
        ("NOISE_BENT", vec![cover_noise::BENT]),
        ("NOISE_CREST", vec![cover_noise::CREST]),
        ("NOISE_MEAN_AWAY", vec![cover_noise::MEAN_AWAY]),
        ("NOISE_GULLY_RISE", cover_noise::GULLY_RISE.to_vec()),
        ("NOISE_GULLIES", vec![cover_noise::GULLIES]),
        ("NOISE_GULLY_HEIGHT", vec![cover_noise::GULLY_HEIGHT]),
        ("NOISE_MOST_GULLIES", vec![cover_noise::MOST_GULLIES]),
        ("NOISE_BRANCHED", vec![cover_noise::BRANCHED]),
        ("COVER_UNEVEN_M", vec![ground_cover::UNEVEN_M]),
        ("COVER_UNEVEN_RISE", vec![ground_cover::UNEVEN_RISE]),
        ("COVER_ASPECT_M", vec![ground_cover::ASPECT_M]),
        ("COVER_SCREE_RISE", ground_cover::SCREE_RISE.to_vec()),
        ("COVER_ROCK_RISE", ground_cover::ROCK_RISE.to_vec()),
        ("COVER_DRY_RISE", vec![ground_cover::DRY_RISE]),
        ("COVER_MEADOW_M", ground_cover::MEADOW_M.to_vec()),
        ("COVER_MOISTER", ground_cover::MOISTER.to_vec()),
        ("COVER_WOODS_MOISTURE", ground_cover::WOODS_MOISTURE.to_vec()),
        ("COVER_WOODS_RISE", ground_cover::WOODS_RISE.to_vec()),
        ("COVER_COPSES", ground_cover::COPSES.to_vec()),
        ("COVER_WILD", ground_cover::WILD.to_vec()),
        ("COVER_WILD_WOODS", vec![ground_cover::WILD_WOODS]),
        ("COVER_FIELD_MEADOW", vec![ground_cover::FIELD_MEADOW]),
        ("COVER_FARMED_MOISTURE", ground_cover::FARMED_MOISTURE.to_vec()),
        ("COVER_FARMED_PATCHES", vec![ground_cover::FARMED_PATCHES]),
        ("COVER_FARMED_RISE", ground_cover::FARMED_RISE.to_vec()),
        ("COVER_LEAST_PIXEL_M", vec![ground_cover::LEAST_PIXEL_M]),
        ("FIELD_M", field_plots::FIELD_M.to_vec()),
        ("COVER_MOST", vec![ground_cover::MOST]),
        ("COVER_HUE", ground_cover::HUE.to_vec()),
        ("COVER_MEADOW_CLIMB", vec![ground_cover::MEADOW_CLIMB]),
        ("COVER_HUE_CLIMB", ground_cover::HUE_CLIMB.to_vec()),
        ("COVER_HUE_MOISTURE", ground_cover::HUE_MOISTURE.to_vec()),
        ("COVER_PATCHES", vec![ground_cover::PATCHES]),
        ("COVER_CROWNS", vec![ground_cover::CROWNS]),
        ("COVER_TUFTS", vec![ground_cover::TUFTS]),
        ("COVER_SHRUBS", ground_cover::SHRUBS.to_vec()),
        ("COVER_SHRUB_SHARE", vec![ground_cover::SHRUB_SHARE]),
        ("COVER_STRATA", vec![ground_cover::STRATA]),
        ("COVER_STRATA_M", ground_cover::STRATA_M.to_vec()),
        ("COVER_FORM_LEVEL", vec![ground_cover::FORM_LEVEL]),
        ("COVER_RIDGES", vec![ground_cover::RIDGES]),
        ("COVER_FORM_RISE", vec![ground_cover::FORM_RISE]),
        ("AREA_OCTAVES", vec![area_texture::OCTAVES as f32]),
        ("AREA_PART_PX", vec![area_texture::PART_PX]),
        ("AREA_PARCEL_JITTER", vec![area_texture::PARCEL_JITTER]),
        ("AREA_PARCEL_TONE", vec![area_texture::PARCEL_TONE]),
        ("AREA_STRIP_LENGTH", vec![area_texture::STRIP_LENGTH]),
        ("AREA_STRIP_BORDER", area_texture::STRIP_BORDER.to_vec()),
        ("AREA_FIGURE_MARGIN", vec![area_texture::FIGURE_MARGIN]),
        ("AREA_FADE_M", vec![area_texture::FADE_M]),
        ("AREA_FADE_WIDE_M", vec![area_texture::FADE_WIDE_M]),
        ("AREA_FADE_MOVED", vec![area_texture::FADE_MOVED]),
        ("AREA_ALONE_M", vec![area_texture::ALONE_M]),
        ("AREA_SALTS", vec![area_texture::PARCEL_SALT as f32, area_texture::FIGURE_SALT as f32]),
        ("RIPPLE_WAVES_M", lengths(&water::RIPPLES)),
        ("RIPPLE_STEEPNESS", shares(&water::RIPPLES)),
        ("RIPPLE_WAVE_PX", vec![water::RIPPLE_PX]),
        ("RIPPLE_GRAZING", water::RIPPLE_GRAZING.to_vec()),
        ("WATER_MIRRORED", vec![WaterColor::MIRRORED]),
        ("WATER_MOST_MIRRORED", vec![WaterColor::MOST_MIRRORED]),
        ("RELIEF_SHOWN", water_relief::SHOWN.to_vec()),
        ("RAY_LEAST_RISE", vec![water_relief::LEAST_RISE]),
        ("RAY_STEPS", vec![water_relief::MOST_STEPS as f32]),
        ("RAY_FIRST_LEVEL", vec![water_relief::FIRST_LEVEL as f32]),
        ("RAY_BISECTIONS", vec![water_relief::BISECTIONS as f32]),
        ("RAY_BLOCK", vec![ground_tops::BLOCK as f32]),
        ("WATER_SHORE", vec![WaterColor::SHORE]),
        ("WATER_WET", vec![WaterColor::WET]),
        ("WATER_SHORE_PX", vec![WaterColor::SHORE_PX]),
        ("HATCHING_PITCH_PX", vec![hatching::PITCH_PX]),
        ("HATCHING_WIDTH_PX", vec![hatching::WIDTH_PX]),
        ("WIREFRAME_COLOR", vector(wireframe::LINE.linear())),
        ("WIREFRAME_ALPHA", vec![f32::from(wireframe::LINE.0[3]) / 255.0]),
        ("WIREFRAME_WIDTH_PX", vec![wireframe::WIDTH_PX]),
        ("WIREFRAME_FADE_PX", wireframe::FADE_PX.to_vec()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_language_declares_scalars_and_vectors() {
        let constants = [("A", vec![0.5]), ("B", vec![1.0, 1e-6]), ("C", vec![-1.0, 0.1, 200.0])];
        let wgsl = "const A = 0.5;\nconst B = vec2f(1.0, 1e-6);\nconst C = vec3f(-1.0, 0.1, 200.0);\n";
        assert_eq!(ShaderLanguage::Wgsl.declarations(&constants), wgsl);
        let glsl =
            "const float A = 0.5;\nconst vec2 B = vec2(1.0, 1e-6);\nconst vec3 C = vec3(-1.0, 0.1, 200.0);\n";
        assert_eq!(ShaderLanguage::Glsl.declarations(&constants), glsl);
    }

    #[test]
    fn no_name_is_declared_twice() {
        let mut names: Vec<_> = shader_constants().into_iter().map(|(name, _)| name).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
    }
}

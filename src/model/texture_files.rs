//! Pictures for surfaces that no model file states, such as those of city models, within the limits of a model's textures.

use crate::Companions;
use crate::texture::Textures;
use sandtable_draw::pixels::Pixels;

/// Pictures as loaded.
#[derive(Debug, Default)]
pub struct LoadedPictures {
    /// Each once.
    pub pictures: Vec<Pixels>,
    /// For every name the number of its picture; `None` where there is none.
    pub numbers: Vec<Option<usize>>,
    /// Why pictures are missing.
    pub notes: Vec<String>,
}

/// Loads the pictures called `names`, PNG, JPEG, WebP, BMP or TGA, from files beside another; `None` names none.
pub fn load(names: &[Option<&str>], companions: &dyn Companions) -> LoadedPictures {
    let mut textures = Textures::new(companions);
    let number = |name: &Option<&str>| textures.load((*name)?).map(|id| id.0 as usize);
    let numbers = names.iter().map(number).collect();
    let (pictures, notes) = textures.into_parts();
    LoadedPictures { pictures, numbers, notes }
}

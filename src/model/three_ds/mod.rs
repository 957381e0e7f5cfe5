//! 3D Studio files (.3ds, Autodesk 1990–1997): nested chunks of binary data, Z up.
//!
//! ```text
//! 4D4D main
//! ├─ 3D3D editor
//! │  ├─ AFFF material …            material.rs
//! │  └─ 4000 object ─ 4100 mesh …  mesh.rs
//! └─ B000 keyframer ─ B002 node …  keyframer.rs
//! ```
//!
//! Vertices are stored where the object was in the editor; the keyframer gives its pose at frame 0. `assemble` brings
//! one to the other. Ids and layouts follow lib3ds and the "3D Studio File Format" notes of Jochen Wilhelmy (1996). A
//! chunk that reaches past its parent is refused, as lib3ds and assimp do: the rest of the file may be anything.

mod assemble;
mod chunk;
mod keyframer;
mod material;
mod mesh;

use crate::error::ModelError;
use crate::{Companions, Model};

use chunk::Chunk;
use keyframer::KeyframeNode;
use material::MaterialChunk;
use mesh::TriObject;

/// The parts of a 3DS file that a picture needs, as stored.
#[derive(Debug, Default)]
struct ThreeDsFile {
    objects: Vec<TriObject>,
    materials: Vec<MaterialChunk>,
    nodes: Vec<KeyframeNode>,
}

/// The model in the bytes of a 3DS file.
///
/// # Errors
/// [`ModelError::ThreeDs`] and [`ModelError::TooLarge`].
pub fn read(bytes: &[u8], companions: &dyn Companions) -> Result<Model, ModelError> {
    assemble::assemble(&parse(bytes)?, companions)
}

fn parse(bytes: &[u8]) -> Result<ThreeDsFile, ModelError> {
    const MAIN: u16 = 0x4D4D;
    const EDITOR: u16 = 0x3D3D;
    const MATERIAL: u16 = 0xAFFF;
    const OBJECT: u16 = 0x4000;
    const KEYFRAMER: u16 = 0xB000;
    let main = Chunk::first(bytes)?;
    if main.id != MAIN {
        let reason = format!("it starts with chunk {:04X} instead of {MAIN:04X}", main.id);
        return Err(ModelError::three_ds(0, reason));
    }
    let mut file = ThreeDsFile::default();
    for section in main.children() {
        let section = section?;
        match section.id {
            EDITOR => {
                for part in section.children() {
                    let part = part?;
                    match part.id {
                        MATERIAL => file.materials.push(material::parse(&part)?),
                        OBJECT => file.objects.extend(mesh::parse(&part)?),
                        _ => {}
                    }
                }
            }
            KEYFRAMER => file.nodes.extend(keyframer::parse(&section)?),
            _ => {}
        }
    }
    Ok(file)
}

//! x
/// x
pub fn read(_: &[u8], _: &dyn crate::model::kind::Companions) -> Result<crate::model::kind::Model, crate::model::error::ModelError> { Err(crate::model::error::ModelError::gltf("x","x")) }

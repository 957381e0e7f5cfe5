//! An entity of the standard and how it is drawn.

/// An entity with its drawing.
#[derive(Clone, Copy, Debug)]
pub struct SymbolEntity {
    /// Entity, type and subtype: six digits.
    pub code: u32,
    /// The standard's name, in lower case.
    pub name: &'static str,
    /// The drawing in the frame.
    pub drawing: &'static str,
}

/// A row of a table.
pub(crate) const fn entity(code: u32, name: &'static str, drawing: &'static str) -> SymbolEntity {
    SymbolEntity { code, name, drawing }
}

//! The ink of classes in black print.

use sandtable_draw::print_pattern::PrintPattern;

/// The ink of a class.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrintInk {
    /// The relief with a pattern over it.
    Pattern(PrintPattern),
    /// A pattern on white in a black outline.
    Outlined(PrintPattern),
    /// White in a black outline.
    Cased,
    /// Black.
    Black,
    /// Dark gray in a black outline.
    Solid,
}

//! `sandtable symbol`: one military symbol as a picture.

use std::path::PathBuf;

use clap::Args;

use crate::error::CliError;
use crate::output::{print_summary, warn};
use crate::output_format::output_format;
use crate::values::number;
use sandtable_annotate::symbol_picture::symbol_picture;
use sandtable_files::disk;
use sandtable_symbology::labeled::LabeledSymbol;
use sandtable_symbology::texts::TEXT_FIELDS;

#[derive(Debug, Args)]
#[command(
    after_help = "scenes/SYMBOLS.md lists the codes and the fields, which are those of `[[symbol]]`, such as \
                        unique_designation, higher_formation, engagement_bar. The symbol stands on nothing."
)]
pub struct SymbolArguments {
    /// The symbol code: 20 or 30 digits (MIL-STD-2525D and E, APP-6D), or 15 letters (2525C)
    #[arg(value_name = "SIDC")]
    pub code: String,
    /// Write the picture to this file: .png or .svg
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Text round the frame by its key or the standard's letter, as in unique_designation=1-12 or T=1-12
    #[arg(long, value_name = "KEY=VALUE", num_args = 1.., value_parser = symbol_field)]
    pub fields: Vec<SymbolFieldArgument>,
    /// Height of the frame of a friendly unit in pixels
    #[arg(long, value_name = "PX", default_value_t = 100.0, allow_negative_numbers = true, value_parser = number::<f32>(8.0..=1000.0, "write pixels as a number from 8 to 1000"))]
    pub size: f32,
    /// Draw in black on white: frames tell friend from foe without their colors
    #[arg(long)]
    pub black_and_white: bool,
}

/// A field with its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SymbolFieldArgument {
    key: String,
    text: String,
}

fn symbol_field(text: &str) -> Result<SymbolFieldArgument, String> {
    let (key, text) = text.split_once('=').ok_or_else(|| {
        let keys: Vec<&str> = TEXT_FIELDS.iter().map(|row| row.key).collect();
        format!("write a field as KEY=VALUE; keys are {}", keys.join(", "))
    })?;
    Ok(SymbolFieldArgument { key: key.trim().to_owned(), text: text.to_owned() })
}

/// The formats that symbols are written in.
#[derive(Clone, Copy, Debug)]
enum SymbolFormat {
    Png,
    Svg,
}

impl SymbolFormat {
    fn from_extension(extension: &str) -> Option<Self> {
        match extension {
            "png" => Some(Self::Png),
            "svg" => Some(Self::Svg),
            _ => None,
        }
    }
}

pub fn run(arguments: &SymbolArguments) -> Result<(), CliError> {
    let written = "symbols are written as .png or .svg";
    let no_inputs: &[PathBuf] = &[];
    let format = output_format(&arguments.output, no_inputs, SymbolFormat::from_extension, written)?;
    let fields: Vec<(&str, &str)> =
        arguments.fields.iter().map(|field| (field.key.as_str(), field.text.as_str())).collect();
    let mut labeled = LabeledSymbol::new(&arguments.code, &fields).map_err(CliError::usage)?;
    for note in &labeled.symbol.notes {
        warn(&format!("note: {note}"));
    }
    if arguments.black_and_white {
        labeled.symbol = labeled.symbol.in_black_and_white();
    }
    match format {
        SymbolFormat::Png => {
            disk::write_picture(&arguments.output, &symbol_picture(&labeled, arguments.size))?;
        }
        SymbolFormat::Svg => disk::write(&arguments.output, labeled.svg(arguments.size).as_bytes())?,
    }
    print_summary(&[format!("{}: {}", arguments.output.display(), labeled.description())])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_is_a_key_and_its_text_which_may_hold_anything() {
        let field = symbol_field("T=1-12 = A").expect("a field");
        assert_eq!((field.key.as_str(), field.text.as_str()), ("T", "1-12 = A"));
        assert!(symbol_field("T").expect_err("no text").contains("unique_designation"));
    }
}

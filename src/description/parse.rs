//! Text to [`Document`], with every error in the file found in one run.

use std::ops::Range;
use std::sync::Arc;

use toml::Spanned;
use toml::de::DeTable;

use crate::description::decode::document;
use crate::description::diagnostic::{Diagnostic, DiagnosticSink, Diagnostics};
use crate::description::document::Document;
use crate::description::include::{Load, gather, merged, moved};
use crate::description::reader::TableReader;
use crate::description::source_text::SourceText;
use crate::description::suggest::quoted;

/// The largest scene file in bytes. Room for some hundred thousand points; reading costs up to a hundred
/// bytes of memory for each byte of a hostile file, so this also bounds memory to a few hundred megabytes.
pub const MAX_BYTES: usize = 4 << 20;

/// The scene that `text` describes; `file_name` is what messages call the file.
///
/// # Errors
/// Everything wrong in the file as far as it can be told without another file. Where the text is not TOML,
/// only that is reported, since what the rest means is then a guess.
pub fn parse(file_name: &str, text: &str) -> Result<Document, Diagnostics> {
    parse_including(file_name, text, ALONE)
}

/// As [`parse`], for a scene file that may include others, which `load` gives.
///
/// # Errors
/// As [`parse`], of all the files, and where one cannot be included.
pub fn parse_including(file_name: &str, text: &str, load: Load<'_>) -> Result<Document, Diagnostics> {
    if text.len() > MAX_BYTES {
        return Err(too_large(file_name, text.len()));
    }
    let gathered = gather(file_name, text, load, MAX_BYTES);
    let source = Arc::new(gathered.source);
    let mut report = DiagnosticSink::new(Arc::clone(&source));
    for (span, message, help) in gathered.refused {
        report.error(span, message, Some(help));
    }
    let tables: Vec<_> = source.texts().map(|placed| toml_table(placed, &mut report)).collect();
    let table = tables.into_iter().collect::<Option<Vec<_>>>();
    let table = table.map(|tables| merged(tables, &gathered.includes));
    let decode =
        |table| TableReader::read_root(&mut report, table, |reader| document(reader, Arc::clone(&source)));
    let parsed = table.and_then(decode);
    match (report.into_diagnostics(), parsed) {
        (None, Some(document)) => Ok(document),
        (errors, _) => Err(errors.unwrap_or_else(|| unread(file_name))),
    }
}

/// As [`parse`], for bytes as they come from a disk.
///
/// # Errors
/// As [`parse`], and where the bytes are not UTF-8.
pub fn parse_bytes(file_name: &str, bytes: &[u8]) -> Result<Document, Diagnostics> {
    parse_bytes_including(file_name, bytes, ALONE)
}

/// As [`parse_including`], for bytes as they come from a disk.
///
/// # Errors
/// As [`parse_including`], and where the bytes are not UTF-8.
pub fn parse_bytes_including(file_name: &str, bytes: &[u8], load: Load<'_>) -> Result<Document, Diagnostics> {
    if bytes.len() > MAX_BYTES {
        return Err(too_large(file_name, bytes.len()));
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => parse_including(file_name, text, load),
        Err(error) => {
            let source = SourceText::new(file_name, String::from_utf8_lossy(bytes));
            let at = error.valid_up_to();
            let wrong = Diagnostic::new(&source, at..at + '\u{fffd}'.len_utf8(), "this is not UTF-8 text");
            Err(wrong.with_help("save the file as UTF-8").into())
        }
    }
}

/// For a scene file that stands alone.
const ALONE: Load<'static> = &|_| Err("other files are not read here".into());

/// What the TOML parser says of a key that is there already.
const DUPLICATE: &str = "duplicate key";

/// Texts up to here have all their syntax errors told, larger ones only the first: collecting them costs
/// hundreds of bytes for each.
const MAX_BYTES_RECOVERED: usize = 256 << 10;

/// The text that starts at the first byte given as a table, where nothing is wrong with it but a key given twice. Reports one syntax error for
/// each line, since what follows an error is often caused by it.
fn toml_table<'i>((start, text): (usize, &'i str), report: &mut DiagnosticSink) -> Option<DeTable<'i>> {
    let (table, mut errors) = if text.len() <= MAX_BYTES_RECOVERED {
        DeTable::parse_recoverable(text)
    } else {
        match DeTable::parse(text) {
            Ok(table) => (table, Vec::new()),
            Err(error) => (Spanned::new(0..0, DeTable::new()), vec![error]),
        }
    };
    errors.sort_by_key(|error| error.span().map_or(0, |span| span.start));
    let mut last_end = None;
    for error in &errors {
        let span = error.span().unwrap_or(0..0);
        let same_line = last_end.is_some_and(|end| span.start <= end);
        if !same_line {
            let (message, help) = syntax(error.message(), &text[clamped(&span, text)]);
            report.error(span.start + start..span.end + start, message, help);
            last_end = Some(report.source().line_at(span.start + start).end - start);
        }
    }
    let recovered = text.len() <= MAX_BYTES_RECOVERED || errors.is_empty();
    let readable = recovered && errors.iter().all(|error| error.message() == DUPLICATE);
    readable.then(|| if start == 0 { table.into_inner() } else { moved(table.into_inner(), start) })
}

/// A sentence and a remedy for the TOML parser's message about the text `found`.
fn syntax(message: &str, found: &str) -> (String, Option<String>) {
    match message {
        DUPLICATE => {
            (format!("`{}` is already given above", quoted(found)), Some("remove one of the two".into()))
        }
        _ if message.starts_with("string values must be quoted") && found.is_empty() => {
            ("a value is missing here".into(), Some("write one after the `=`".into()))
        }
        _ if message.starts_with("string values must be quoted") => {
            ("text must be in quotes".into(), Some(format!("write \"{}\"", quoted(found.trim()))))
        }
        _ if message.ends_with(" string, expected `\"`") || message.ends_with(" string, expected `'`") => {
            ("this text has no closing quote".into(), Some("close it on the line where it starts".into()))
        }
        _ => (message.into(), None),
    }
}

/// `span` within `text`, on character boundaries, at most one line of 60 bytes.
fn clamped(span: &Range<usize>, text: &str) -> Range<usize> {
    let start = text.floor_char_boundary(span.start);
    let end = text.floor_char_boundary(span.end.min(start + 60)).max(start);
    start..text[start..end].find('\n').map_or(end, |feed| start + feed)
}

fn too_large(file_name: &str, bytes: usize) -> Diagnostics {
    let source = SourceText::new(file_name, "");
    Diagnostic::new(
        &source,
        0..0,
        format!("the scene file has {bytes} bytes, more than the {MAX_BYTES} allowed"),
    )
    .with_help("put long lists of points in GeoJSON files and name them with `file`")
    .into()
}

/// For a table that could not be read though nothing was reported: our own bug, said politely.
fn unread(file_name: &str) -> Diagnostics {
    Diagnostic::new(&SourceText::new(file_name, ""), 0..0, "the scene file cannot be understood").into()
}

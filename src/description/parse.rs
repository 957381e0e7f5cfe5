//! Parses a scene file to a [`Document`] and reports all of its errors at once.

use std::ops::Range;
use std::sync::Arc;

use toml::Spanned;
use toml::de::DeTable;

use crate::decode_context::DecodeContext;
use crate::diagnostic::{Diagnostic, DiagnosticSink, Diagnostics};
use crate::document::Document;
use crate::finding_code::FindingCode;
use crate::include::{LoadFile, files_with_values, gather, merged, moved};
use crate::phases::Phases;
use crate::reader::TableReader;
use crate::source_text::SourceText;
use crate::stated::Stated;
use crate::styles::Styles;
use crate::unused::UnusedInclude;
use sandtable_base::limits::SCENE_BYTES;
use sandtable_base::message::suggest::quoted;

/// The scene that `text` describes; `file_name` is the file's name in messages.
///
/// # Errors
/// All errors in the file that show without reading another one; where the text is not TOML, only its syntax errors.
pub fn parse(file_name: &str, text: &str) -> Result<Document, Diagnostics> {
    parse_bytes(file_name, text.as_bytes())
}

/// As [`parse`], for bytes as they come from a disk.
///
/// # Errors
/// As [`parse`], and where the bytes are not UTF-8.
pub fn parse_bytes(file_name: &str, bytes: &[u8]) -> Result<Document, Diagnostics> {
    parse_including(file_name, bytes, &|_| Err("other files are not read here".into()))
}

/// As [`parse_bytes`]; `load` reads included files.
///
/// # Errors
/// As [`parse_bytes`], of all the files, and where one cannot be included.
pub fn parse_including(file_name: &str, bytes: &[u8], load: LoadFile<'_>) -> Result<Document, Diagnostics> {
    parse_in_phase(file_name, bytes, load, None)
}

/// As [`parse_including`], for the phase called `phase` in place of the first.
///
/// # Errors
/// As [`parse_including`]. A phase that is not there is none: [`Document::phase`] then names it all the same.
pub fn parse_in_phase(
    file_name: &str,
    bytes: &[u8],
    load: LoadFile<'_>,
    phase: Option<&str>,
) -> Result<Document, Diagnostics> {
    if bytes.len() > SCENE_BYTES.count() {
        let message =
            format!("the scene file has {} bytes, more than the {SCENE_BYTES} allowed", bytes.len());
        let help = format!(
            "put long lists of points in GeoJSON files and name them with `file`, or {SCENE_BYTES:#}"
        );
        return Err(Diagnostic::new(&SourceText::new(file_name, ""), 0..0, message).with_help(help).into());
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let source = SourceText::new(file_name, String::from_utf8_lossy(bytes));
        let at = error.valid_up_to();
        let wrong = Diagnostic::new(&source, at..at + '\u{fffd}'.len_utf8(), "this is not UTF-8 text");
        wrong.with_help("save the file as UTF-8").with_code(FindingCode::Syntax)
    })?;
    let gathered = gather(file_name, text, load, SCENE_BYTES.count());
    let source = Arc::new(gathered.source);
    let mut report = DiagnosticSink::new(Arc::clone(&source));
    for (span, error) in gathered.errors {
        let help = error.help();
        report.coded(error.code(), span, error, help);
    }
    let tables: Vec<_> = source.texts().map(|(start, text)| toml_table(start, text, &mut report)).collect();
    let tables: Option<Vec<_>> = tables.into_iter().collect();
    let own: Vec<OwnKeys> = tables.iter().flatten().map(OwnKeys::of).collect();
    let root = tables.map(|mut tables| merged(0, &mut tables, &gathered.includes));
    let unused_includes = unused_includes(&source, &own, root.as_ref(), &gathered.named);
    let (parsed, report) = match &root {
        Some(root) => {
            let styles = Styles::read(root, &mut report);
            let (phases, scene_keys) = (Phases::read(root, phase), Document::DECLARATIONS);
            let mut context = DecodeContext { report, styles, phases, unused_includes, scene_keys };
            (TableReader::read_root::<Document>(&mut context, root), context.report)
        }
        None => (None, report),
    };
    match (report.into_diagnostics(), parsed) {
        (None, Some(document)) => Ok(document),
        (Some(errors), _) => Err(errors),
        (None, None) => {
            // A bug: each table that cannot be read notes an error.
            let message = "the scene file cannot be understood";
            Err(Diagnostic::new(&SourceText::new(file_name, ""), 0..0, message).into())
        }
    }
}

/// What a file states itself.
#[derive(Clone, Copy, PartialEq)]
enum OwnKeys {
    Nothing,
    /// Nothing but the files that it includes.
    Includes,
    Values,
}

impl OwnKeys {
    fn of(table: &DeTable<'_>) -> Self {
        match table.len() {
            0 => Self::Nothing,
            1 if table.contains_key("include") => Self::Includes,
            _ => Self::Values,
        }
    }
}

/// The included files without effect on `root`, which is merged of all; `named` holds the places that name them.
fn unused_includes(
    source: &SourceText,
    own: &[OwnKeys],
    root: Option<&DeTable<'_>>,
    named: &[Range<usize>],
) -> Vec<UnusedInclude> {
    let Some(root) = root.filter(|_| !named.is_empty()) else { return Vec::new() };
    let starts: Vec<usize> = source.texts().map(|(start, _)| start).collect();
    let has_value = files_with_values(root, &starts);
    let unused = own.iter().zip(has_value).skip(1).zip(named).filter_map(|((own, has_value), span)| {
        let is_empty = match own {
            OwnKeys::Nothing => true,
            OwnKeys::Values if !has_value => false,
            OwnKeys::Includes | OwnKeys::Values => return None,
        };
        let name = source.text()[span.clone()].trim_matches(['"', '\'']).to_owned();
        Some(UnusedInclude { name: Stated::new(name, span.clone()), is_empty })
    });
    unused.collect()
}

/// The TOML parser's message about a key that is stated twice.
const DUPLICATE: &str = "duplicate key";

/// Larger texts have only their first syntax error reported: collecting them costs hundreds of bytes for each.
const MAX_BYTES_RECOVERED: usize = 256 << 10;

/// The table in `text`, its spans moved by `start`; `None` after any error but duplicate keys. Reports one syntax error
/// a line, since one error often causes the next.
fn toml_table<'i>(start: usize, text: &'i str, report: &mut DiagnosticSink) -> Option<DeTable<'i>> {
    let recovers = text.len() <= MAX_BYTES_RECOVERED;
    let (table, mut errors) = if recovers {
        DeTable::parse_recoverable(text)
    } else {
        match DeTable::parse(text) {
            Ok(table) => (table, Vec::new()),
            Err(error) => (Spanned::new(0..0, DeTable::new()), vec![error]),
        }
    };
    errors.sort_by_key(|error| error.span().map_or(0, |span| span.start));
    let mut line_end = None;
    for error in &errors {
        let span = error.span().unwrap_or_default();
        if line_end.is_none_or(|end| span.start > end) {
            let (message, help) = syntax_message(error.message(), &text[excerpt(&span, text)]);
            let placed = span.start + start..span.end + start;
            let error = Diagnostic::new(report.source(), placed, message).with_code(FindingCode::Syntax);
            line_end = Some(report.source().line_at(span.start + start).end - start);
            report.add(if help.is_empty() { error } else { error.with_help(help) });
        }
    }
    let is_readable =
        errors.iter().all(|error| error.message() == DUPLICATE) && (recovers || errors.is_empty());
    is_readable.then(|| if start == 0 { table.into_inner() } else { moved(table.into_inner(), start) })
}

/// A sentence and a remedy, possibly empty, for the TOML parser's message about the text `found`.
fn syntax_message(message: &str, found: &str) -> (String, String) {
    let must_be_quoted = message.starts_with("string values must be quoted");
    let (message, help) = match message {
        DUPLICATE => {
            return (format!("`{}` is already given above", quoted(found)), "remove one of the two".into());
        }
        _ if must_be_quoted && found.is_empty() => ("a value is missing here", "write one after the `=`"),
        _ if must_be_quoted => {
            return ("text must be in quotes".into(), format!("write \"{}\"", quoted(found.trim())));
        }
        _ if message.ends_with(" string, expected `\"`") || message.ends_with(" string, expected `'`") => {
            ("this text has no closing quote", "close it on the line where it starts")
        }
        _ => (message, ""),
    };
    (message.into(), help.into())
}

/// The part of `span` within `text`, on character boundaries, of at most one line and 60 bytes.
fn excerpt(span: &Range<usize>, text: &str) -> Range<usize> {
    let start = text.floor_char_boundary(span.start);
    let end = text.floor_char_boundary(span.end.min(start + 60)).max(start);
    start..text[start..end].find('\n').map_or(end, |feed| start + feed)
}

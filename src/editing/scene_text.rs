//! Changes to the text of a scene file: only the bytes of what changes are touched, so that comments, order, spaces and
//! line endings stay as their author left them.
//!
//! `toml_edit` says where tables and values stand and writes new values. Its own document is not written back: it would
//! end every line with a line feed, and drop the comment behind a value that is replaced.
//!
//! ```text
//! # A comment right above a table belongs to it      ┐
//! [[model]]                                          │ the table's text
//! file = "conifer"   # a comment behind a value      │
//!                                                    │
//! [model.instances]                                  │ its subtables belong to it
//! file = "trees.geojson"                             ┘
//!
//! # What stands apart belongs to nobody
//! ```

use std::ops::Range;

use toml_edit::{Document, Item, Table, TableLike, Value};

use crate::edit::{EditPlace, EditValue, NewTable};

/// Why a text cannot be changed in this way.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum SceneTextError {
    #[error("the scene file is not TOML: {0}")]
    NotToml(String),
    #[error("the scene file has no {0}; it may have changed, or the table stands in an included file")]
    NoTable(EditPlace),
    #[error("`{0}` is written as one value in the scene file; write it as tables [[{0}]] to edit it here")]
    Inline(String),
    #[error("`{0}` is a table, not a value")]
    TableNotValue(String),
    #[error("`{0}` is a value, which has no keys of its own")]
    ValueNotTable(String),
}

/// `[name]`, `[[name]]` and what follows it, in the order of the text.
#[derive(Clone, Debug)]
struct TableText {
    /// The keys of its name with, for a table of a list, its number there.
    path: Vec<TableStep>,
    /// The first byte of the line of its header.
    start: usize,
    /// The byte after its last value, or after its header.
    values_end: usize,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct TableStep {
    key: String,
    number: Option<usize>,
}

/// A parsed text.
struct ParsedText<'a> {
    text: &'a str,
    document: Document<&'a str>,
    tables: Vec<TableText>,
}

/// The text with one more table, after the last of its kind, or at its end.
///
/// # Errors
/// See [`SceneTextError`].
pub(super) fn with_table(text: &str, table: &NewTable) -> Result<String, SceneTextError> {
    let parsed = ParsedText::new(text)?;
    if parsed.document.get(&table.name).is_some_and(Item::is_value) {
        return Err(SceneTextError::Inline(table.name.clone()));
    }
    let of_kind = |other: &&TableText| other.path[0].key == table.name;
    let at = parsed.tables.iter().filter(of_kind).map(|table| parsed.end(table)).max();
    let mut lines = vec![format!("[[{}]]", table.name)];
    lines.extend(table.keys.iter().map(|(key, value)| format!("{key} = {}", written(value))));
    Ok(parsed.with_lines(parsed.line_end(at.unwrap_or(text.trim_end().len())), &lines, Spacing::Apart))
}

/// The text without a table of a list, its subtables and the comment right above it.
///
/// # Errors
/// See [`SceneTextError`].
pub(super) fn without_table(text: &str, place: &EditPlace) -> Result<String, SceneTextError> {
    let parsed = ParsedText::new(text)?;
    parsed.table(place)?;
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for table in parsed.tables.iter().filter(|table| table.is_of(place)) {
        let end = parsed.line_end(table.values_end);
        let after = &text[end..];
        let blank = after.len() - after.trim_start_matches(['\r', '\n', ' ', '\t']).len();
        // Whole lines alone: what indents the line that stays is not blank.
        let blank = after[..blank].rfind('\n').map_or(0, |feed| feed + 1);
        let range = parsed.comment_start(table.start)..end + blank;
        match ranges.last_mut() {
            Some(last) if last.end >= range.start => last.end = range.end,
            _ => ranges.push(range),
        }
    }
    let mut left = text.to_owned();
    for range in ranges.into_iter().rev() {
        if range.end == text.len() {
            // Nothing follows that a blank line would set apart.
            let kept = left[..range.start].trim_end().len();
            left.truncate(left[kept..].find('\n').map_or(range.start, |feed| kept + feed + 1));
        } else {
            left.replace_range(range, "");
        }
    }
    Ok(left)
}

/// The text with a value at `keys` of a place: replaced where it is stated, else added after the other values of its table.
///
/// # Errors
/// See [`SceneTextError`].
pub(super) fn with_value(
    text: &str,
    place: &EditPlace,
    keys: &[String],
    value: &EditValue,
) -> Result<String, SceneTextError> {
    let parsed = ParsedText::new(text)?;
    let mut table: &dyn TableLike = match place {
        EditPlace::Root => parsed.document.as_table(),
        EditPlace::Table { .. } => parsed.table(place)?,
    };
    let dotted = keys.join(".");
    let own = place.steps();
    // The deepest table with a header of its own, and the keys from there on.
    let (mut header, mut from) = (own.clone(), 0);
    for (depth, key) in keys.iter().enumerate() {
        let is_last = depth + 1 == keys.len();
        match table.get(key) {
            Some(Item::Value(found)) if is_last => {
                let span = found.span().ok_or_else(|| SceneTextError::NoTable(place.clone()))?;
                let mut changed = text.to_owned();
                changed.replace_range(span, &written(value));
                return Ok(changed);
            }
            Some(Item::Table(_) | Item::ArrayOfTables(_)) if is_last => {
                return Err(SceneTextError::TableNotValue(dotted));
            }
            Some(Item::Table(inner)) => {
                if inner.span().is_some() && !inner.is_dotted() && !inner.is_implicit() {
                    header = own.clone();
                    header.extend(keys[..=depth].iter().map(|key| TableStep::plain(key)));
                    from = depth + 1;
                }
                table = inner;
            }
            Some(Item::Value(Value::InlineTable(inner))) => {
                let rest = keys[depth + 1..].join(".");
                let span = inner.span().ok_or_else(|| SceneTextError::NoTable(place.clone()))?;
                if let Some(stated) = inner.get(&keys[depth + 1]).filter(|_| depth + 2 == keys.len()) {
                    let span = stated.span().ok_or_else(|| SceneTextError::NoTable(place.clone()))?;
                    let mut changed = text.to_owned();
                    changed.replace_range(span, &written(value));
                    return Ok(changed);
                }
                if inner.contains_key(&keys[depth + 1]) {
                    return Err(SceneTextError::Inline(keys[..=depth + 1].join(".")));
                }
                return Ok(with_inner(text, span, &format!("{rest} = {}", written(value))));
            }
            Some(_) => return Err(SceneTextError::ValueNotTable(keys[..=depth].join("."))),
            None => break,
        }
    }
    let line = |keys: &[String]| format!("{} = {}", keys.join("."), written(value));
    let new_table = |steps: &[TableStep]| {
        let names: Vec<&str> = steps.iter().map(|step| step.key.as_str()).collect();
        vec![format!("[{}]", names.join(".")), line(&keys[keys.len() - 1..])]
    };
    let is_dotted = parsed.is_dotted(&own, &keys[..=from.min(keys.len() - 1)]);
    let is_nested = keys.len() - from > 1 && !is_dotted;
    let mut whole = own;
    whole.extend(keys[..keys.len() - 1].iter().map(|key| TableStep::plain(key)));
    let holder = parsed.tables.iter().find(|table| table.path == header);
    Ok(match holder {
        Some(holder) => {
            let after = parsed.line_end(holder.values_end);
            match is_nested {
                true => parsed.with_lines(after, &new_table(&whole), Spacing::Apart),
                false => parsed.with_lines(after, &[line(&keys[from..])], Spacing::Close),
            }
        }
        None if is_nested => {
            parsed.with_lines(parsed.line_end(text.trim_end().len()), &new_table(&whole), Spacing::Apart)
        }
        // Outside tables: after what is there, else before the first table.
        None => match (values_end(parsed.document.as_table()), parsed.tables.first()) {
            (Some(end), _) => parsed.with_lines(parsed.line_end(end), &[line(keys)], Spacing::Close),
            (None, Some(first)) => {
                parsed.with_lines(parsed.comment_start(first.start), &[line(keys)], Spacing::Apart)
            }
            (None, None) => {
                parsed.with_lines(parsed.line_end(text.trim_end().len()), &[line(keys)], Spacing::Close)
            }
        },
    })
}

/// The text that a table states for a key; `None` where it states none.
pub(super) fn stated_text(text: &str, place: &EditPlace, key: &str) -> Option<String> {
    let parsed = ParsedText::new(text).ok()?;
    let found = parsed.table(place).ok()?.get(key)?.as_str()?;
    Some(found.to_owned())
}

/// The number that a table states for a key; `None` where it states none.
pub(super) fn stated_number(text: &str, place: &EditPlace, key: &str) -> Option<f64> {
    let parsed = ParsedText::new(text).ok()?;
    let found = parsed.table(place).ok()?.get(key)?;
    found.as_float().or_else(|| found.as_integer().map(|number| number as f64))
}

/// The table of a list in whose text, or whose subtables' text, the byte `at` stands.
pub(super) fn table_at(text: &str, at: usize) -> Option<EditPlace> {
    let parsed = ParsedText::new(text).ok()?;
    let holder = parsed.tables.iter().filter(|table| table.start <= at).max_by_key(|table| table.start)?;
    let step = holder.path.first()?;
    Some(EditPlace::table(&step.key, step.number?))
}

/// The number of the table of the list `name` in whose text, or whose subtables' text, the byte `at` stands.
pub(super) fn number_at(text: &str, name: &str, at: usize) -> Option<usize> {
    let parsed = ParsedText::new(text).ok()?;
    let holder = parsed.tables.iter().filter(|table| table.start <= at).max_by_key(|table| table.start)?;
    holder.path.first().filter(|step| step.key == name).and_then(|step| step.number)
}

/// Whether new lines stand apart from those before and after.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Spacing {
    Close,
    Apart,
}

impl TableStep {
    fn plain(key: &str) -> Self {
        Self { key: key.to_owned(), number: None }
    }
}

impl TableText {
    /// Whether it is the table at `place`, or below it.
    fn is_of(&self, place: &EditPlace) -> bool {
        self.path.starts_with(&place.steps())
    }
}

impl EditPlace {
    fn steps(&self) -> Vec<TableStep> {
        match self {
            Self::Root => Vec::new(),
            Self::Table { name, number } => vec![TableStep { key: name.clone(), number: Some(*number) }],
        }
    }
}

impl<'a> ParsedText<'a> {
    fn new(text: &'a str) -> Result<Self, SceneTextError> {
        let document = Document::parse(text).map_err(|error| SceneTextError::NotToml(error.to_string()))?;
        let mut tables = Vec::new();
        collect(text, document.as_table(), &mut Vec::new(), &mut tables);
        tables.sort_by_key(|table: &TableText| table.start);
        Ok(Self { text, document, tables })
    }

    fn table(&self, place: &EditPlace) -> Result<&Table, SceneTextError> {
        let EditPlace::Table { name, number } = place else { return Ok(self.document.as_table()) };
        let missing = || SceneTextError::NoTable(place.clone());
        match self.document.get(name) {
            Some(Item::ArrayOfTables(list)) => list.get(*number).ok_or_else(missing),
            Some(Item::Value(_)) => Err(SceneTextError::Inline(name.clone())),
            _ => Err(missing()),
        }
    }

    /// Whether the keys below a table are those of a dotted table.
    fn is_dotted(&self, own: &[TableStep], keys: &[String]) -> bool {
        let plain = keys.iter().map(|key| TableStep::plain(key));
        let mut table: &Table = self.document.as_table();
        for TableStep { key, number } in own.iter().cloned().chain(plain) {
            let inner = match (table.get(&key), number) {
                (Some(Item::ArrayOfTables(list)), Some(number)) => list.get(number),
                (Some(Item::Table(inner)), None) => Some(inner),
                _ => None,
            };
            let Some(inner) = inner else { return false };
            table = inner;
        }
        table.is_dotted()
    }

    /// The byte after the last value of a table or of the tables below it that follow at once.
    fn end(&self, table: &TableText) -> usize {
        let after = self.tables.iter().skip_while(|other| other.start <= table.start);
        let below = after.take_while(|other| other.path.starts_with(&table.path));
        below.map(|below| below.values_end).fold(table.values_end, usize::max)
    }

    /// The byte after the line that holds `at`, its ending included.
    fn line_end(&self, at: usize) -> usize {
        self.text[at..].find('\n').map_or(self.text.len(), |feed| at + feed + 1)
    }

    /// The first byte of the comment that stands right above the line that starts at `start`.
    fn comment_start(&self, start: usize) -> usize {
        let mut first = start;
        while let Some(above) = self.text[..first].strip_suffix('\n') {
            let line = above.rfind('\n').map_or(0, |feed| feed + 1);
            if !above[line..].trim_start().starts_with('#') {
                break;
            }
            first = line;
        }
        // What stands at the top of the file is about the file.
        if first == 0 { start } else { first }
    }

    /// The text with lines at `at`, where a line begins or the text ends.
    fn with_lines(&self, at: usize, lines: &[String], spacing: Spacing) -> String {
        let ending = if self.text.contains("\r\n") { "\r\n" } else { "\n" };
        let at = at.max(self.mark_end());
        let (before, after) = self.text.split_at(at);
        let mut new = String::new();
        let is_first = before.trim_start_matches('\u{feff}').is_empty();
        if !is_first && !before.ends_with('\n') {
            new.push_str(ending);
        }
        let is_apart = before.trim_end_matches('\r').ends_with("\n\n") || before.ends_with("\n\r\n");
        if spacing == Spacing::Apart && !is_first && !is_apart {
            new.push_str(ending);
        }
        for line in lines {
            // Values of several lines have line feeds of their own.
            new.push_str(&if ending == "\n" { line.clone() } else { line.replace('\n', ending) });
            new.push_str(ending);
        }
        let is_blank = after.lines().next().is_none_or(|line| line.trim().is_empty());
        if !is_blank && (spacing == Spacing::Apart || is_first) {
            new.push_str(ending);
        }
        [before, &new, after].concat()
    }

    /// The byte after a byte order mark.
    fn mark_end(&self) -> usize {
        if self.text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 }
    }
}

/// Adds the tables below `table` that have headers.
fn collect(text: &str, table: &Table, path: &mut Vec<TableStep>, tables: &mut Vec<TableText>) {
    let mut add = |key: &str, number: Option<usize>, inner: &Table, path: &mut Vec<TableStep>| {
        path.push(TableStep { key: key.to_owned(), number });
        if let Some(span) = inner.span().filter(|_| !inner.is_dotted() && !inner.is_implicit()) {
            let start = text[..span.start].rfind('\n').map_or(0, |feed| feed + 1);
            let values_end = values_end(inner).unwrap_or(span.end).max(span.end);
            tables.push(TableText { path: path.clone(), start, values_end });
        }
        collect(text, inner, path, tables);
        path.pop();
    };
    for (key, item) in table.iter() {
        match item {
            Item::Table(inner) => add(key, None, inner, path),
            Item::ArrayOfTables(list) => {
                list.iter().enumerate().for_each(|(number, inner)| add(key, Some(number), inner, path));
            }
            Item::Value(_) | Item::None => {}
        }
    }
}

/// The byte after the last value that stands below a table's own header; `None` where it has none.
fn values_end(table: &Table) -> Option<usize> {
    let end = |item: &Item| match item {
        Item::Value(value) => value.span().map(|span| span.end),
        Item::Table(inner) if inner.is_dotted() => values_end(inner),
        _ => None,
    };
    table.iter().filter_map(|(_, item)| end(item)).max()
}

/// The text with one more key in the inline table at `span`.
fn with_inner(text: &str, span: Range<usize>, key: &str) -> String {
    let inside = &text[span.start + 1..span.end - 1];
    let kept = inside.trim_end();
    let separator = match kept {
        "" => " ",
        _ if kept.ends_with(',') => " ",
        _ => ", ",
    };
    let at = span.start + 1 + kept.len();
    [&text[..at], separator, key, if kept.len() == inside.len() { " " } else { "" }, &text[at..]].concat()
}

/// A value as a scene file writes it.
fn written(value: &EditValue) -> String {
    match value {
        EditValue::Text(text) => Value::from(text.as_str()).to_string().trim().to_owned(),
        EditValue::Number(number) => written_number(*number),
        EditValue::Numbers(numbers) => {
            let all: Vec<String> = numbers.iter().map(|number| written_number(*number)).collect();
            format!("[{}]", all.join(", "))
        }
        EditValue::Point(point) => written_point(point),
        EditValue::Points(points) => {
            let all: Vec<String> = points.iter().map(written_point).collect();
            match all.concat().len() {
                ..=SHORT_LINE => format!("[{}]", all.join(", ")),
                _ => format!(
                    "[\n    {},\n]",
                    all.chunks(POINTS_A_LINE).map(|line| line.join(", ")).collect::<Vec<_>>().join(",\n    ")
                ),
            }
        }
    }
}

/// Points of more characters than this are written on several lines.
const SHORT_LINE: usize = 90;
/// Points on each of them.
const POINTS_A_LINE: usize = 4;

fn written_point([x, y]: &[f64; 2]) -> String {
    format!("[{}, {}]", written_number(*x), written_number(*y))
}

/// A number with as many digits as it needs; 5 and not 5.0, as a scene file takes both for the same.
fn written_number(number: f64) -> String {
    // No -0.
    format!("{}", number + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "# About the scene.\n\n# The ground.\n[terrain]\ndem = \"a.tif\"  # the file\n\n\
        [style]\nramp = \"gray\"\n\n# Trees.\n[[model]]\nfile = \"conifer\"  # dark\nat = [1, 2] # here\n\n\
        [[model]]\nfile = \"rock\"\n\n[model.instances]\npoints = [[1, 1]]\n\n# The end.\n";

    fn keys(dotted: &str) -> Vec<String> {
        dotted.split('.').map(str::to_owned).collect()
    }

    fn set(text: &str, place: &EditPlace, dotted: &str, number: f64) -> String {
        with_value(text, place, &keys(dotted), &EditValue::Number(number)).expect("sound")
    }

    fn model(number: usize) -> EditPlace {
        EditPlace::table("model", number)
    }

    #[test]
    fn a_value_is_replaced_and_the_comment_behind_it_kept() {
        let value = EditValue::Point([3.5, -0.0]);
        let changed = with_value(SCENE, &model(0), &keys("at"), &value).expect("sound");
        assert_eq!(changed, SCENE.replace("at = [1, 2] # here", "at = [3.5, 0] # here"));
    }

    #[test]
    fn a_value_that_is_not_stated_follows_the_others_of_its_table() {
        let turned = set(SCENE, &model(0), "heading", 90.0);
        assert_eq!(turned, SCENE.replace("# here\n", "# here\nheading = 90\n"));
        let second = set(SCENE, &model(1), "heading", 90.0);
        assert_eq!(second, SCENE.replace("file = \"rock\"\n", "file = \"rock\"\nheading = 90\n"));
        let inner = set(SCENE, &model(1), "instances.layer", 1.0);
        assert_eq!(inner, SCENE.replace("points = [[1, 1]]\n", "points = [[1, 1]]\nlayer = 1\n"));
    }

    #[test]
    fn missing_tables_are_made_below_those_that_are_there() {
        let lit = set(SCENE, &EditPlace::Root, "style.light.azimuth", 30.0);
        assert_eq!(lit, SCENE.replace("\"gray\"\n", "\"gray\"\n\n[style.light]\nazimuth = 30\n"));
        let dotted = "style.light.azimuth = 3\n[terrain]\ndem = \"a\"\n";
        let higher = set(dotted, &EditPlace::Root, "style.light.altitude", 30.0);
        assert_eq!(higher, dotted.replace("= 3\n", "= 3\nstyle.light.altitude = 30\n"));
        let inline = "style = { light = { azimuth = 3 } }\n";
        let higher = set("style.light = { azimuth = 3 }\n", &EditPlace::Root, "style.light.altitude", 30.0);
        assert_eq!(higher, "style.light = { azimuth = 3, altitude = 30 }\n");
        assert!(
            with_value(inline, &EditPlace::Root, &keys("style.light.azimuth"), &EditValue::Number(1.0))
                .is_err()
        );
        let alone = set("[terrain]\ndem = \"a\"", &EditPlace::Root, "style.light.azimuth", 3.0);
        assert_eq!(alone, "[terrain]\ndem = \"a\"\n\n[style.light]\nazimuth = 3\n");
    }

    #[test]
    fn keys_of_the_whole_scene_stand_before_its_tables() {
        let titled = with_value(SCENE, &EditPlace::Root, &keys("title"), &EditValue::Text("Hill".into()));
        assert_eq!(
            titled.expect("sound"),
            SCENE.replace("# The ground.", "title = \"Hill\"\n\n# The ground.")
        );
        let changed = set("title = 1 # so\n\n[terrain]\n", &EditPlace::Root, "subtitle", 2.0);
        assert_eq!(changed, "title = 1 # so\nsubtitle = 2\n\n[terrain]\n");
    }

    #[test]
    fn a_table_follows_the_last_of_its_kind_or_ends_the_file() {
        let rock = NewTable::new("model").with_text("file", "rock").with("at", EditValue::Point([1.0, 2.0]));
        let added = with_table(SCENE, &rock).expect("sound");
        let text = "points = [[1, 1]]\n\n[[model]]\nfile = \"rock\"\nat = [1, 2]\n";
        assert_eq!(added, SCENE.replace("points = [[1, 1]]\n", text));
        let label = NewTable::new("label").with_text("text", "a \"b\"\n");
        let added = with_table(SCENE, &label).expect("sound");
        assert!(
            added.starts_with(SCENE) && added[SCENE.len()..].starts_with("\n[[label]]\ntext = "),
            "{added}"
        );
    }

    #[test]
    fn a_table_is_removed_with_its_comment_and_its_subtables() {
        let first = without_table(SCENE, &model(0)).expect("sound");
        let text = "# Trees.\n[[model]]\nfile = \"conifer\"  # dark\nat = [1, 2] # here\n\n";
        assert_eq!(first, SCENE.replace(text, ""));
        let second = without_table(SCENE, &model(1)).expect("sound");
        let text = "[[model]]\nfile = \"rock\"\n\n[model.instances]\npoints = [[1, 1]]\n\n";
        assert_eq!(second, SCENE.replace(text, ""));
        let last = without_table("[terrain]\na = 1\n\n[[label]]\ntext = 1", &EditPlace::table("label", 0));
        assert_eq!(last.expect("sound"), "[terrain]\na = 1\n");
        assert!(matches!(without_table(SCENE, &model(2)), Err(SceneTextError::NoTable(_))));
    }

    #[test]
    fn line_endings_and_the_byte_order_mark_stay() {
        let windows = format!("\u{feff}{}", SCENE.replace('\n', "\r\n"));
        let turned = set(&windows, &model(0), "heading", 90.0);
        assert_eq!(turned, windows.replace("# here\r\n", "# here\r\nheading = 90\r\n"));
        let bare = "\u{feff}[terrain]\r\ndem = \"a\"\r\n";
        let titled = set(bare, &EditPlace::Root, "title", 1.0);
        assert_eq!(titled, "\u{feff}title = 1\r\n\r\n[terrain]\r\ndem = \"a\"\r\n");
    }

    #[test]
    fn the_table_around_a_byte_is_found() {
        let at = |word: &str| number_at(SCENE, "model", SCENE.find(word).expect("there"));
        assert_eq!(
            [at("conifer"), at("rock"), at("[[1, 1]]"), at("gray")],
            [Some(0), Some(1), Some(1), None]
        );
    }
}

//! What reading the files of sources left out or took for something else.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::scene_findings::SceneFindings;
use sandtable_base::message::suggest::quoted;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::stated::Stated;
use sandtable_vector::feature::VectorLayer;

/// Sentences on how files were read, in the order of reading.
#[derive(Default)]
pub(super) struct ReadingNotes(Vec<ReadingNote>);

/// A sentence on how a file was read.
struct ReadingNote {
    code: FindingCode,
    /// The bytes of the scene file that name the file.
    span: Range<usize>,
    file: String,
    text: String,
}

impl ReadingNotes {
    /// Adds what reading a file left out. What several layers of a file have in common is kept once.
    pub fn add_of_layer(&mut self, file: &Stated<String>, layer: &VectorLayer) {
        let faults = layer.faults.iter().map(|text| (FindingCode::RecordsBroken, text));
        for (code, text) in faults.chain(layer.notes.iter().map(|text| (FindingCode::VectorRead, text))) {
            if !self.0.iter().any(|known| known.text == *text && known.file == file.as_str()) {
                let span = file.span().unwrap_or_default();
                self.0.push(ReadingNote { code, span, file: file.to_string(), text: text.clone() });
            }
        }
    }

    /// Adds how many features of a table match and are left out, because they have another shape than it draws.
    pub fn add_other_shapes(&mut self, file: &Stated<String>, of_other_shape: &BTreeMap<&str, usize>) {
        let count: usize = of_other_shape.values().sum();
        if count == 0 {
            return;
        }
        let kinds: Vec<&str> = of_other_shape.keys().copied().collect();
        let (features, have) = if count == 1 { ("feature", "has") } else { ("features", "have") };
        let kinds = kinds.join(" and ");
        let text =
            format!("left out: {count} {features} that {have} another shape than the table draws: {kinds}");
        let (code, span) = (FindingCode::LeftOut, file.span().unwrap_or_default());
        if !self.0.iter().any(|known| known.text == text && known.span == span) {
            self.0.push(ReadingNote { code, span, file: file.to_string(), text });
        }
    }

    /// Reports them.
    pub fn report(self, findings: &mut SceneFindings) {
        for ReadingNote { code, span, file, text } in self.0 {
            findings.add(code, span, format!("'{}': {text}", quoted(&file)));
        }
    }
}

//! What the readers of overlays have in common: features on WGS 84, layers that are named in the file, and sentences about
//! records that are read but lack something.

use crate::builder::{FeatureParts, LayerBuilder};
use crate::error::VectorError;
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::tally::RecordTally;
use sandtable_geom::crs::Crs;

/// A document of a file, which has several where it is an archive.
pub(crate) struct OverlayDocument<'a> {
    /// Its name in messages; empty where the file is one document.
    pub name: &'a str,
    pub bytes: &'a [u8],
}

/// Collects the features of an overlay.
pub(crate) struct OverlayLayer<'a> {
    pub layer: LayerBuilder,
    wanted: Option<&'a str>,
    /// The names of the layers, in order.
    names: Vec<String>,
    /// The document that is read.
    document: String,
    tallies: Vec<(OverlayRemark, RecordTally)>,
}

/// What is told of records that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OverlayRemark {
    /// The sentence of one and of several records, after the count.
    pub texts: [&'static str; 2],
    /// Whether something is wrong with the file, or only noteworthy.
    pub is_fault: bool,
}

impl<'a> OverlayLayer<'a> {
    /// Collects the features of the layer that `hints` request, or all.
    pub fn new(hints: &VectorHints<'a>) -> Self {
        let mut layer = LayerBuilder::new(Crs::wgs84());
        if hints.crs.is_some_and(|crs| *crs != Crs::wgs84()) {
            layer.note("`crs` has no effect on it: its positions are on WGS 84 or name their system");
        }
        Self { layer, wanted: hints.layer, names: Vec::new(), document: String::new(), tallies: Vec::new() }
    }

    /// Starts the document with this name.
    pub fn begin(&mut self, document: &OverlayDocument<'_>) {
        document.name.clone_into(&mut self.document);
    }

    /// Returns the place of a record of the document.
    pub fn place(&self, line: &str) -> String {
        if self.document.is_empty() { line.to_owned() } else { format!("{} {line}", self.document) }
    }

    /// Notes that the file has the layer `name`, and returns whether its features are requested.
    pub fn admits(&mut self, name: &str) -> bool {
        if !name.is_empty() && !self.names.iter().any(|known| known == name) {
            self.names.push(name.to_owned());
        }
        self.wanted.is_none_or(|wanted| wanted == name)
    }

    /// Adds a feature of the layer `name`.
    pub fn add(&mut self, name: &str, parts: FeatureParts, mut properties: Properties, line: impl Fn() -> String) {
        if !name.is_empty() {
            properties.insert("layer".into(), name.into());
        }
        let document = std::mem::take(&mut self.document);
        let place = || if document.is_empty() { line() } else { format!("{document} {}", line()) };
        self.layer.add_at(parts, properties, place);
        self.document = document;
    }

    /// Leaves out a record that cannot be read.
    pub fn add_broken(&mut self, what: &str, error: VectorError) {
        let place = self.place(what);
        self.layer.add_broken(place, error);
    }

    /// Counts a remark on the record at a line.
    pub fn remark(&mut self, remark: OverlayRemark, line: impl Fn() -> String) {
        let index = self.tallies.iter().position(|(known, _)| *known == remark).unwrap_or_else(|| {
            self.tallies.push((remark, RecordTally::new()));
            self.tallies.len() - 1
        });
        let document = &self.document;
        let place = || if document.is_empty() { line() } else { format!("{document} {}", line()) };
        self.tallies[index].1.add(place);
    }

    /// Returns the layer.
    ///
    /// # Errors
    /// The requested layer is not in the file, and as [`LayerBuilder::finish`].
    pub fn finish(mut self, faults: impl IntoIterator<Item = String>) -> Result<VectorLayer, VectorError> {
        let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        if let Some(wanted) = self.wanted.filter(|wanted| !names.contains(wanted)) {
            return Err(VectorError::no_such_layer(wanted, &names));
        }
        faults.into_iter().for_each(|fault| self.layer.fault(fault));
        for (remark, tally) in &self.tallies {
            let [one, many] = remark.texts;
            let Some(text) = tally.text(one, many) else { continue };
            if remark.is_fault {
                self.layer.fault(text);
            } else {
                self.layer.note(text);
            }
        }
        self.layer.finish()
    }
}

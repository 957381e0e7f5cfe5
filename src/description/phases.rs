//! Phases: what a scene shows one after the other, in one file.
//!
//! ```toml
//! [[phase]]
//! name = "1"
//! title = "Assembly, H-6"
//!
//! [[phase]]
//! name = "2"
//! title = "Attack, H-hour"
//!
//! [[model]]
//! phases = ["1"]           # there in the first phase only; what states no phases is always there
//! file = "truck.glb"
//! at = [750000, 4018000]
//! ```
//!
//! A scene file is read for one phase: the one that is asked for, or the first. Tables of others are checked and left out.

use std::collections::BTreeSet;
use std::ops::Range;

use toml::de::{DeTable, DeValue};

use crate::declaration::{KeyDeclaration, KeyKind, Presence};
use crate::diagnostic::DiagnosticSink;
use crate::finding_code::FindingCode;
use crate::stated::Stated;
use sandtable_base::message::suggest::{quoted, remedy};

/// The key `phases` of every table of features.
pub const PHASES_KEY: KeyDeclaration = KeyDeclaration {
    name: "phases",
    doc: "Names of the phases in which it is there.",
    kind: KeyKind::TextList,
    unit: "",
    presence: Presence::Otherwise("all of them"),
    rivals: &[],
};

/// The phases of a scene, and the one that it is read for.
#[derive(Debug, Default)]
pub(super) struct Phases<'t> {
    names: Vec<&'t str>,
    /// The places of the names.
    spans: Vec<Range<usize>>,
    /// The names that tables state.
    used: BTreeSet<String>,
    chosen: Option<String>,
}

impl<'t> Phases<'t> {
    /// The phases in the root table of a scene file, which is read for the phase called `asked`, or for the first.
    pub fn read(root: &'t DeTable<'t>, asked: Option<&str>) -> Self {
        let tables = root.get("phase").and_then(|value| value.get_ref().as_array());
        let name = |table: &'t toml::Spanned<DeValue<'t>>| {
            let name = table.get_ref().get("name")?;
            Some((name.get_ref().as_str()?, name.span()))
        };
        let (names, spans): (Vec<&str>, _) = tables.into_iter().flatten().filter_map(name).unzip();
        let chosen = asked.or(names.first().copied()).map(str::to_owned);
        Self { names, spans, used: BTreeSet::new(), chosen }
    }

    /// The phase that the scene is read for; `None` where it has none.
    pub fn chosen(&self) -> Option<String> {
        self.chosen.clone()
    }

    /// The phases that no table has named yet.
    pub fn unused(&self) -> Vec<Stated<String>> {
        let unused = self.names.iter().zip(&self.spans).filter(|(name, _)| !self.used.contains(**name));
        unused.map(|(name, span)| Stated::new((*name).to_owned(), span.clone())).collect()
    }

    /// Whether a feature of the phases `stated` exists in the chosen one. Reports names of no phase.
    pub fn hold(&mut self, stated: &Stated<Vec<String>>, report: &mut DiagnosticSink) -> bool {
        self.used.extend(stated.iter().cloned());
        let span = stated.span().unwrap_or_default();
        for name in stated.iter().filter(|name| !self.names.contains(&name.as_str())) {
            let help = match &self.names[..] {
                [] => format!("add a table [[phase]] with `name = \"{}\"`", quoted(name)),
                names => remedy(name, names, "the phases are").replace(" or ", " and "),
            };
            report.coded(
                FindingCode::UnknownName,
                span.clone(),
                format!("there is no phase \"{}\"", quoted(name)),
                help,
            );
        }
        self.chosen.as_ref().is_none_or(|chosen| stated.contains(chosen))
    }
}

#[cfg(test)]
mod tests {
    use crate::document::Document;
    use crate::parse::{parse, parse_in_phase};

    const SCENE: &str = "[terrain]\ndem = \"a.tif\"\n[[phase]]\nname = \"one\"\n[[phase]]\nname = \"two\"\ntitle = \"Two\"\n\
        [[area]]\npoints = [[0, 0], [1, 0], [1, 1]]\ncover = \"forest\"\nphases = [\"one\"]\n[[area]]\npoints = [[0, 0], [2, 0], [1, 1]]\ncover = \"forest\"\n";

    fn read(phase: Option<&str>) -> Document {
        let unread = |_: &str| Err("other files are not read here".into());
        parse_in_phase("scene.toml", SCENE.as_bytes(), &unread, phase).expect("sound")
    }

    #[test]
    fn a_scene_is_read_for_the_first_phase_or_the_one_that_is_asked_for() {
        let (first, second) = (read(None), read(Some("two")));
        assert_eq!((first.areas.len(), first.phase.as_deref()), (2, Some("one")));
        assert_eq!((second.areas.len(), second.phase.as_deref()), (1, Some("two")));
        assert_eq!(second.phase_title(), Some("Two"));
        assert_eq!(first.phase_title(), None);
    }

    #[test]
    fn a_phase_that_is_not_there_is_an_error_where_it_is_named() {
        let wrong = SCENE.replace("phases = [\"one\"]", "phases = [\"on\"]");
        let errors = parse("scene.toml", &wrong).expect_err("wrong").to_string();
        assert!(errors.contains("there is no phase \"on\"") && errors.contains("did you mean"), "{errors}");
        let without = "[terrain]\ndem = \"a.tif\"\n[[area]]\npoints = [[0, 0], [1, 0], [1, 1]]\ncover = \"forest\"\nphases = \"x\"\n";
        let errors = parse("scene.toml", without).expect_err("wrong").to_string();
        assert!(errors.contains("add a table [[phase]]"), "{errors}");
    }

    #[test]
    fn two_phases_of_one_name_are_refused() {
        let twice = SCENE.replace("\"two\"", "\"one\"");
        let errors = parse("scene.toml", &twice).expect_err("wrong").to_string();
        assert!(errors.contains("already has this name"), "{errors}");
    }
}

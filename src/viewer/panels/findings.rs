//! What building the scene found: errors, warnings, and notes on what was left out or guessed.

use egui::{RichText, ScrollArea, Ui};

use sandtable_description::finding::{Finding, Severity};

/// The most findings listed; `sandtable check` prints all.
const MOST_LISTED: usize = 200;

/// The title of the list, with how many there are of each severity.
pub fn findings_title(findings: &[Finding]) -> String {
    let count = |severity| findings.iter().filter(|finding| finding.severity() == severity).count();
    let counted = Severity::ALL.into_iter().filter_map(|severity| match count(severity) {
        0 => None,
        1 => Some(format!("1 {}", severity.word())),
        many => Some(format!("{many} {}s", severity.word())),
    });
    format!("Findings: {}", counted.collect::<Vec<_>>().join(", "))
}

/// Draws the list, the gravest first.
pub fn findings_panel(ui: &mut Ui, findings: &[Finding]) {
    ScrollArea::vertical().id_salt("findings").auto_shrink([false, true]).max_height(200.0).show(ui, |ui| {
        let by_severity = Severity::ALL
            .into_iter()
            .flat_map(|severity| findings.iter().filter(move |finding| finding.severity() == severity));
        for finding in by_severity.take(MOST_LISTED) {
            let place = finding.place.as_ref().map(|place| {
                let position = place.position();
                format!("{}:{}: ", place.file(), position.line)
            });
            ui.label(RichText::new(finding.code.head()).small().strong());
            let response = ui.label(format!("{}{}", place.unwrap_or_default(), finding.message));
            if let Some(help) = &finding.help {
                response.on_hover_text(help);
            }
        }
        if findings.len() > MOST_LISTED {
            ui.weak(format!("and {} more: sandtable check prints all", findings.len() - MOST_LISTED));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use sandtable_description::finding_code::FindingCode;

    #[test]
    fn every_finding_is_listed_with_its_code_and_the_title_counts_them() {
        let findings = [
            Finding::new(FindingCode::VectorRead, "one way leaves the extract"),
            Finding::new(FindingCode::RecordsBroken, "one record cannot be read"),
            Finding::new(FindingCode::LeftOut, "two roads are off the model"),
        ];
        assert_eq!(findings_title(&findings), "Findings: 1 warning, 2 notes");
        let harness =
            Harness::builder().with_size([360.0, 500.0]).build_ui(|ui| findings_panel(ui, &findings));
        for finding in &findings {
            assert!(harness.query_by_label(&finding.message).is_some(), "{}", finding.message);
            assert!(harness.query_by_label(&finding.code.head()).is_some());
        }
    }
}

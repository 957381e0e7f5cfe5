//! The scene as a tree: kinds and their features, shown or hidden, and found by name. The field for names takes positions,
//! too: grid references, UTM, degrees, numbers of the scene's system.

use std::collections::BTreeSet;

use egui::{CollapsingHeader, Key, ScrollArea, TextEdit, Ui};

use sandtable_draw::list::FeatureId;
use sandtable_geom::position::Position;
use sandtable_scene::feature::{FeatureKind, SceneFeature};

/// The most features listed under a kind; further ones are found by their names.
const MOST_LISTED: usize = 200;

/// The state of the tree.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TreePanel {
    /// The text that names must contain, or a position.
    pub find: String,
    /// Features that are not drawn.
    pub hidden: BTreeSet<FeatureId>,
    /// Puts the cursor into the field in the next frame.
    pub focuses_find: bool,
}

/// An event in the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TreeEvent {
    /// Features were shown or hidden.
    Visibility,
    /// A feature was chosen: to go there.
    GoTo(FeatureId),
    /// A position was entered: to go there.
    GoToPosition(Position),
}

/// Draws the tree.
pub fn tree_panel(ui: &mut Ui, panel: &mut TreePanel, features: &[SceneFeature]) -> Option<TreeEvent> {
    let mut event = None;
    let mut is_entered = false;
    ui.horizontal(|ui| {
        let label = ui.label("Find");
        let field = TextEdit::singleline(&mut panel.find)
            .hint_text("name of a feature, or a position")
            .desired_width(f32::INFINITY);
        let field = ui.add(field).labelled_by(label.id);
        if std::mem::take(&mut panel.focuses_find) {
            field.request_focus();
        }
        is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    });
    let wanted = panel.find.trim().to_lowercase();
    let mut kinds: Vec<(FeatureKind, Vec<FeatureId>)> = Vec::new();
    for (index, feature) in features.iter().enumerate() {
        if !wanted.is_empty() && !feature.name.to_lowercase().contains(&wanted) {
            continue;
        }
        let id = FeatureId::of_index(index);
        match kinds.iter_mut().find(|(kind, _)| *kind == feature.kind) {
            Some((_, ids)) => ids.push(id),
            None => kinds.push((feature.kind, vec![id])),
        }
    }
    kinds.sort_by_key(|(kind, _)| *kind);
    if is_entered && let Some(first) = kinds.first().and_then(|(_, ids)| ids.first()) {
        event = Some(TreeEvent::GoTo(*first));
    }
    if kinds.is_empty() {
        match Position::parse(&panel.find) {
            Ok(position) => {
                ui.weak("A position: Enter goes there.");
                if is_entered {
                    event = Some(TreeEvent::GoToPosition(position));
                }
            }
            // What begins like a position is told apart from a name.
            Err(error) if !error.is_unlike_any() => {
                ui.label(error.with_forms());
            }
            Err(_) if features.is_empty() => {
                ui.weak("The scene has ground only.");
            }
            Err(_) => {
                ui.weak("No feature has such a name.");
            }
        }
    }
    ScrollArea::vertical().auto_shrink([false, true]).max_height(280.0).show(ui, |ui| {
        for (kind, ids) in &kinds {
            event = kind_rows(ui, panel, features, (*kind, ids)).or(event);
        }
    });
    event
}

fn kind_rows(
    ui: &mut Ui,
    panel: &mut TreePanel,
    features: &[SceneFeature],
    (kind, ids): (FeatureKind, &[FeatureId]),
) -> Option<TreeEvent> {
    let mut event = None;
    let title = format!("{} {}", ids.len(), kind.noun(ids.len()));
    ui.horizontal(|ui| {
        let mut all_shown = !ids.iter().any(|id| panel.hidden.contains(id));
        if ui.checkbox(&mut all_shown, "").accessible_name(format!("Show {title}")).changed() {
            for id in ids {
                if all_shown {
                    panel.hidden.remove(id)
                } else {
                    panel.hidden.insert(*id)
                };
            }
            event = Some(TreeEvent::Visibility);
        }
        let opens = !panel.find.trim().is_empty();
        let header = CollapsingHeader::new(&title).id_salt(kind as usize).open(opens.then_some(true));
        header.show(ui, |ui| {
            for id in ids.iter().take(MOST_LISTED) {
                let name =
                    id.index().and_then(|index| features.get(index)).map(|feature| feature.name.as_str());
                let name = name.filter(|name| !name.is_empty());
                let name = name.map_or_else(|| format!("{} {}", kind.noun(1), id.0 - 1), str::to_owned);
                ui.horizontal(|ui| {
                    let mut is_shown = !panel.hidden.contains(id);
                    if ui.checkbox(&mut is_shown, "").accessible_name(format!("Show {name}")).changed() {
                        if is_shown {
                            panel.hidden.remove(id)
                        } else {
                            panel.hidden.insert(*id)
                        };
                        event = Some(TreeEvent::Visibility);
                    }
                    if ui.button(&name).on_hover_text("Go there").clicked() {
                        event = Some(TreeEvent::GoTo(*id));
                    }
                });
            }
            if ids.len() > MOST_LISTED {
                ui.weak(format!("and {} more: find them by name", ids.len() - MOST_LISTED));
            }
        });
    });
    event
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    struct TreeTest {
        panel: TreePanel,
        features: Vec<SceneFeature>,
        events: Vec<TreeEvent>,
    }

    fn harness() -> Harness<'static, TreeTest> {
        let feature =
            |kind, name: &str| SceneFeature { kind, name: name.to_owned(), origin: Default::default() };
        let features = vec![
            feature(FeatureKind::Road, "pass road"),
            feature(FeatureKind::Road, ""),
            feature(FeatureKind::Lake, "Norris Lake"),
        ];
        let state = TreeTest { panel: TreePanel::default(), features, events: Vec::new() };
        let draw = |ui: &mut Ui, state: &mut TreeTest| {
            state.events.extend(tree_panel(ui, &mut state.panel, &state.features));
        };
        Harness::builder().with_size([360.0, 500.0]).build_ui_state(draw, state)
    }

    #[test]
    fn a_kind_is_hidden_and_shown_as_a_whole() {
        let mut harness = harness();
        harness.get_by_label("Show 2 roads").click();
        harness.run();
        assert_eq!(harness.state().panel.hidden, BTreeSet::from([FeatureId(2), FeatureId(3)]));
        harness.get_by_label("Show 2 roads").click();
        harness.run();
        assert!(harness.state().panel.hidden.is_empty());
        assert_eq!(harness.state().events, [TreeEvent::Visibility; 2]);
    }

    #[test]
    fn a_feature_is_found_by_a_part_of_its_name_and_a_click_goes_there() {
        let mut harness = harness();
        harness.get_by_label("Find").focus();
        harness.run();
        harness.get_by_label("Find").type_text("NORRIS");
        harness.run();
        assert!(harness.query_by_label("Show 2 roads").is_none());
        harness.get_by_label("Norris Lake").click();
        harness.run();
        assert_eq!(harness.state().events, [TreeEvent::GoTo(FeatureId(4))]);
    }

    fn entered(text: &str) -> Harness<'static, TreeTest> {
        let mut harness = harness();
        harness.get_by_label("Find").focus();
        harness.run();
        harness.get_by_label("Find").type_text(text);
        harness.run();
        harness.key_press(Key::Enter);
        harness.run();
        harness
    }

    #[test]
    fn a_position_in_any_form_is_gone_to_on_enter() {
        for text in ["16SGF5000018000", "16S GF 500 180", "36.277N 84.215W", "750000,4018000"] {
            let position = Position::parse(text).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(entered(text).state().events, [TreeEvent::GoToPosition(position)], "{text}");
        }
    }

    #[test]
    fn a_position_with_two_readings_is_refused_with_both() {
        let harness = entered("16S 755447 4024162");
        assert!(harness.state().events.is_empty());
        assert!(harness.query_by_label_contains("can be read as zone 16, band S").is_some());
        assert!(entered("Atlantis").query_by_label("No feature has such a name.").is_some());
    }

    #[test]
    fn a_feature_whose_name_is_found_comes_before_a_position() {
        let harness = entered("pass");
        assert_eq!(harness.state().events, [TreeEvent::GoTo(FeatureId(2))]);
    }
}

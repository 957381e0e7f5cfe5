//! Positions of a parameter of an analysis, picked by clicks on the ground.

use glam::DVec2;

use sandtable_catalog::parameter::{AnalysisParameter, ParameterForm};

/// Positions that are being picked. Places are map coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacePicking {
    /// The parameter's name.
    pub parameter: &'static str,
    /// The positions so far.
    pub points: Vec<DVec2>,
    form: ParameterForm,
}

impl PlacePicking {
    /// Picks the positions of a parameter anew.
    pub fn new(parameter: &'static AnalysisParameter) -> Self {
        Self { parameter: parameter.name, points: Vec::new(), form: parameter.form }
    }

    /// Adds a position.
    pub fn click(&mut self, at: DVec2) {
        // The second click of a double click is the same point.
        if self.points.last() != Some(&at) {
            self.points.push(at);
        }
    }

    /// Takes the last position back; `false` where there is none.
    pub fn take_back(&mut self) -> bool {
        self.points.pop().is_some()
    }

    /// A hint for the user: what to do next.
    pub fn hint(&self) -> &'static str {
        match self.form {
            ParameterForm::Line => "Click along the line; Enter or a double click ends it",
            ParameterForm::Area => "Click along the outline; Enter or a double click ends it",
            ParameterForm::Extent => {
                "Click at two opposite corners, or along the outline of an area; Enter or a double click ends it"
            }
            _ => "Click at each place; Enter or a double click ends it",
        }
    }

    /// Whether positions are joined on the picture.
    pub fn is_joined(&self) -> bool {
        !matches!(self.form, ParameterForm::Points { .. })
    }

    /// The outline on the picture with the place under the pointer, and whether it is closed.
    pub fn outline(&self, hovered: Option<DVec2>) -> (Vec<DVec2>, bool) {
        let points: Vec<DVec2> = self.points.iter().copied().chain(hovered).collect();
        match (self.form, &points[..]) {
            (ParameterForm::Extent, &[first, last]) => {
                (vec![first, DVec2::new(last.x, first.y), last, DVec2::new(first.x, last.y)], true)
            }
            (ParameterForm::Area | ParameterForm::Extent, _) => (points, true),
            _ => (points, false),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_catalog::parameter::EXTENT;

    #[test]
    fn two_corners_are_a_rectangle_and_three_positions_an_area() {
        let mut picking = PlacePicking::new(&EXTENT);
        picking.click(DVec2::ZERO);
        picking.click(DVec2::ZERO);
        assert_eq!(picking.points.len(), 1, "a double click adds no point");
        let (outline, is_closed) = picking.outline(Some(DVec2::new(4.0, 2.0)));
        assert!(is_closed);
        assert_eq!(outline, [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]].map(DVec2::from));
        picking.click(DVec2::new(4.0, 2.0));
        picking.click(DVec2::new(0.0, 3.0));
        assert_eq!(picking.outline(None).0.len(), 3);
        assert!(picking.take_back() && picking.take_back() && picking.take_back() && !picking.take_back());
    }
}

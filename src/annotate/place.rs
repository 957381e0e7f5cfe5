//! Placement of labels: from boxes to choices.
//!
//! Labels come in order of importance, each with candidate positions in order of preference. One after the other takes
//! the first candidate that is free. Greedy placement by priority is what a reader expects (a minor label never
//! displaces a major one), it is stable (removing an unplaced label changes nothing), and its cost is bounded. Optimal
//! placement is NP-hard (Marks and Shieber 1991) and gains a label or two.
//!
//! It looks one step ahead: a candidate that would cover the symbol of a later label is taken only where no other
//! candidate is free.

use crate::occupied::{OccupiedShape, OccupiedSheet};
use crate::pixel_box::{PixelBox, PixelSegment};

#[derive(Clone, Debug, PartialEq)]
pub struct LabelCandidate {
    pub text: PixelBox,
    /// The boxes of the letters of a name along a line, which take less than `text`; empty for upright text.
    pub letters: Vec<PixelBox>,
    /// Around the symbol at the place; `None` where it is drawn without.
    pub symbol: Option<PixelBox>,
    /// The leader line from the symbol to the text; `None` where it is drawn without.
    pub leader: Option<PixelSegment>,
    pub alignment: TextAlignment,
}

/// The alignment of lines of text; the numbers index the boxes of a label's text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextAlignment {
    /// Flush left: the text is to the right of what it names.
    Left = 0,
    /// Centered: the text is over what it names.
    Center = 1,
    /// Flush right: the text is to the left of what it names.
    Right = 2,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct LabelRequest {
    /// Ways to draw it, the best first.
    pub candidates: Vec<LabelCandidate>,
    /// A box that labels placed before this one avoid where they can.
    pub reserved: Option<PixelBox>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct LabelField {
    /// Everything placed stays inside.
    pub bounds: PixelBox,
    /// Nothing placed overlaps these.
    pub taken: Vec<PixelBox>,
    /// Pixels that leader lines keep from texts, symbols and `taken`.
    pub leader_gap: f32,
}

/// Labels placed so far.
pub struct LabelPlacer<'a> {
    field: &'a LabelField,
    placed: OccupiedSheet,
}

impl<'a> LabelPlacer<'a> {
    pub fn new(field: &'a LabelField) -> Self {
        let mut placed = OccupiedSheet::new(&field.bounds);
        for taken in &field.taken {
            placed.add(OccupiedShape::Box(*taken), 0);
        }
        Self { field, placed }
    }

    /// For every request the index of the candidate chosen, or `None` where none is free of what this placer has placed
    /// before.
    pub fn place(&mut self, requests: &[LabelRequest]) -> Vec<Option<usize>> {
        let mut reserved = OccupiedSheet::new(&self.field.bounds);
        for (number, request) in requests.iter().enumerate() {
            if let Some(area) = request.reserved {
                reserved.add(OccupiedShape::Box(area), number);
            }
        }
        let choose = |(number, request): (usize, &LabelRequest)| {
            let covers_later = |candidate: &LabelCandidate| {
                candidate.text_boxes().any(|own| {
                    let later = reserved.near(own).filter(|mark| mark.number > number);
                    later
                        .map(|mark| mark.shape)
                        .any(|shape| matches!(shape, OccupiedShape::Box(area) if area.overlaps(own)))
                })
            };
            let mut second = None;
            for (which, candidate) in
                request.candidates.iter().enumerate().filter(|(_, one)| self.is_free(one))
            {
                if !covers_later(candidate) {
                    self.keep(candidate);
                    return Some(which);
                }
                second = second.or(Some(which));
            }
            self.keep(&request.candidates[second?]);
            second
        };
        requests.iter().enumerate().map(choose).collect()
    }

    /// Whether nothing is placed in `area`.
    pub fn is_clear(&self, area: &PixelBox) -> bool {
        !self.placed.near(area).any(|mark| match &mark.shape {
            OccupiedShape::Box(taken) => taken.overlaps(area),
            OccupiedShape::Leader(leader) => area.meets(leader),
        })
    }

    fn keep(&mut self, candidate: &LabelCandidate) {
        candidate.boxes().for_each(|area| self.placed.add(OccupiedShape::Box(*area), 0));
        if let Some(leader) = candidate.leader {
            self.placed.add(OccupiedShape::Leader(leader), 0);
        }
    }

    fn is_free(&self, candidate: &LabelCandidate) -> bool {
        let gap = self.field.leader_gap;
        let mut boxes = candidate.boxes();
        self.field.keeps_inside(candidate)
            && !boxes.any(|own| {
                self.placed.near(&own.grown(gap)).any(|mark| match &mark.shape {
                    OccupiedShape::Box(area) => own.overlaps(area),
                    OccupiedShape::Leader(leader) => own.grown(gap).meets(leader),
                })
            })
            && candidate.leader.is_none_or(|own| {
                let around = PixelBox { min: own.from.min(own.to), max: own.from.max(own.to) };
                !self.placed.near(&around.grown(gap)).any(|mark| match &mark.shape {
                    OccupiedShape::Box(area) => area.grown(gap).meets(&own),
                    OccupiedShape::Leader(leader) => own.crosses(leader),
                })
            })
    }
}

impl LabelCandidate {
    fn text_boxes(&self) -> impl Iterator<Item = &PixelBox> {
        let whole = self.letters.is_empty().then_some(&self.text);
        whole.into_iter().chain(&self.letters)
    }

    /// The boxes that it takes.
    pub fn boxes(&self) -> impl Iterator<Item = &PixelBox> {
        self.text_boxes().chain(&self.symbol)
    }
}

impl LabelField {
    fn keeps_inside(&self, candidate: &LabelCandidate) -> bool {
        let contains = |line: PixelSegment| self.bounds.contains(line.from) && self.bounds.contains(line.to);
        candidate.boxes().all(|area| self.bounds.holds(area)) && candidate.leader.is_none_or(contains)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;
    use proptest::collection::vec;
    use proptest::prelude::{Strategy, prop_assert, prop_assert_eq, proptest};

    use super::*;

    fn place(requests: &[LabelRequest], field: &LabelField) -> Vec<Option<usize>> {
        LabelPlacer::new(field).place(requests)
    }

    // Every pair compared, without cells: what the placer is held to.
    impl LabelField {
        fn touches(&self, candidate: &LabelCandidate, area: &PixelBox) -> bool {
            candidate.boxes().any(|own| own.overlaps(area))
                || candidate.leader.is_some_and(|leader| self.passes_near(&leader, area))
        }

        fn passes_near(&self, leader: &PixelSegment, area: &PixelBox) -> bool {
            area.grown(self.leader_gap).meets(leader)
        }

        fn conflict(&self, one: &LabelCandidate, other: &LabelCandidate) -> bool {
            other.boxes().any(|area| self.touches(one, area))
                || other.leader.is_some_and(|leader| {
                    one.boxes().any(|area| self.passes_near(&leader, area))
                        || one.leader.is_some_and(|own| own.crosses(&leader))
                })
        }
    }

    /// A fault of a placement; numbers index the requests.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    enum PlacementFault {
        /// There is not one choice per request, or a choice names no candidate.
        NoSuchCandidate(usize),
        /// A label leaves the bounds.
        Outside(usize),
        /// A label overlaps a box that was taken beforehand.
        OnFurniture(usize, usize),
        Overlap(usize, usize),
    }

    /// Checks that `choices` for `requests` keep the promises of [`place`]: everything inside, nothing overlapping.
    fn check(
        requests: &[LabelRequest],
        choices: &[Option<usize>],
        field: &LabelField,
    ) -> Result<(), PlacementFault> {
        let mut placed: Vec<(usize, LabelCandidate)> = Vec::new();
        if requests.len() != choices.len() {
            return Err(PlacementFault::NoSuchCandidate(requests.len().min(choices.len())));
        }
        for (number, (request, choice)) in requests.iter().zip(choices).enumerate() {
            let Some(which) = *choice else { continue };
            let chosen = request.candidates.get(which).ok_or(PlacementFault::NoSuchCandidate(number))?;
            if !field.keeps_inside(chosen) {
                return Err(PlacementFault::Outside(number));
            }
            if let Some(on) = field.taken.iter().position(|taken| field.touches(chosen, taken)) {
                return Err(PlacementFault::OnFurniture(number, on));
            }
            if let Some((other, _)) = placed.iter().find(|(_, other)| field.conflict(chosen, other)) {
                return Err(PlacementFault::Overlap(*other, number));
            }
            placed.push((number, chosen.clone()));
        }
        Ok(())
    }

    fn field() -> LabelField {
        let bounds = PixelBox::at(Vec2::ZERO, Vec2::new(200.0, 100.0));
        LabelField { bounds, taken: vec![PixelBox::at(Vec2::ZERO, Vec2::new(60.0, 30.0))], leader_gap: 2.0 }
    }

    fn text(x: f32, y: f32) -> LabelCandidate {
        let text = PixelBox::at(Vec2::new(x, y), Vec2::new(40.0, 10.0));
        LabelCandidate { text, letters: vec![], symbol: None, leader: None, alignment: TextAlignment::Center }
    }

    fn request(candidates: &[LabelCandidate]) -> LabelRequest {
        LabelRequest { candidates: candidates.to_vec(), reserved: None }
    }

    #[test]
    fn the_first_free_candidate_is_taken() {
        let requests = [request(&[text(0.0, 0.0), text(170.0, 50.0), text(100.0, 50.0), text(0.0, 80.0)])];
        assert_eq!(place(&requests, &field()), [Some(2)]);
    }

    #[test]
    fn the_earlier_request_wins_and_the_later_steps_aside_or_stays_out() {
        let requests = [
            request(&[text(100.0, 50.0)]),
            request(&[text(110.0, 55.0), text(100.0, 60.0)]),
            request(&[text(120.0, 52.0)]),
        ];
        assert_eq!(place(&requests, &field()), [Some(0), Some(1), None]);
    }

    #[test]
    fn the_symbol_of_a_later_label_is_left_free_where_possible() {
        let reserved = PixelBox::at(Vec2::new(105.0, 52.0), Vec2::splat(4.0));
        let later = LabelRequest { candidates: vec![text(0.0, 80.0)], reserved: Some(reserved) };
        let choosy = request(&[text(100.0, 50.0), text(100.0, 70.0)]);
        assert_eq!(place(&[choosy, later.clone()], &field())[0], Some(1));
        let stuck = request(&[text(100.0, 50.0)]);
        assert_eq!(place(&[stuck, later], &field())[0], Some(0));
    }

    #[test]
    fn a_leader_does_not_pass_under_a_placed_text() {
        let below = Vec2::new(120.0, 90.0);
        let leader = PixelSegment { from: below, to: Vec2::new(120.0, 41.0) };
        let crossing = LabelCandidate { leader: Some(leader), ..text(100.0, 30.0) };
        let requests = [request(&[text(100.0, 60.0)]), request(&[crossing])];
        assert_eq!(place(&requests, &field()), [Some(0), None]);
    }

    #[test]
    fn the_check_finds_each_fault() {
        let requests = [
            request(&[text(100.0, 50.0), text(-5.0, 50.0), text(10.0, 10.0)]),
            request(&[text(110.0, 55.0), text(150.0, 80.0)]),
        ];
        let faults = [
            ([Some(1), None], PlacementFault::Outside(0)),
            ([Some(2), None], PlacementFault::OnFurniture(0, 0)),
            ([Some(0), Some(0)], PlacementFault::Overlap(0, 1)),
            ([Some(0), Some(7)], PlacementFault::NoSuchCandidate(1)),
        ];
        for (choices, fault) in faults {
            assert_eq!(check(&requests, &choices, &field()), Err(fault));
        }
        assert_eq!(check(&requests, &[Some(0), Some(1)], &field()), Ok(()));
    }

    #[test]
    fn a_candidate_that_is_not_a_number_is_never_taken() {
        assert_eq!(place(&[request(&[text(f32::NAN, 50.0)])], &field()), [None]);
    }

    fn any_candidate() -> impl Strategy<Value = LabelCandidate> {
        let numbers = (-20.0..210.0f32, -20.0..110.0f32, 1.0..60.0f32, 1.0..20.0f32, 0..4u8);
        numbers.prop_map(|(x, y, width, height, parts)| {
            let anchor = Vec2::new(x + width * 0.5, y + height + 30.0);
            let leader = PixelSegment { from: anchor, to: anchor - Vec2::new(3.0, 28.0) };
            LabelCandidate {
                text: PixelBox::at(Vec2::new(x, y), Vec2::new(width, height)),
                letters: match parts {
                    // The halves of a text that rises to the right.
                    0 => [(0.0, 8.0), (0.5, 0.0)]
                        .map(|(along, down)| {
                            let min = Vec2::new(x + along * width, y + down);
                            PixelBox::at(min, Vec2::new(width * 0.5, height * 0.5))
                        })
                        .to_vec(),
                    _ => Vec::new(),
                },
                symbol: (parts & 1 > 0).then(|| PixelBox::around(anchor, Vec2::splat(3.0))),
                leader: (parts & 2 > 0).then_some(leader),
                alignment: TextAlignment::Center,
            }
        })
    }

    fn any_request() -> impl Strategy<Value = LabelRequest> {
        vec(any_candidate(), 0..6).prop_map(|candidates| {
            let reserved = candidates.first().and_then(|first| first.symbol);
            LabelRequest { candidates, reserved }
        })
    }

    proptest! {
        #[test]
        fn every_placement_passes_the_check(requests in vec(any_request(), 0..40)) {
            let choices = place(&requests, &field());
            prop_assert_eq!(check(&requests, &choices, &field()), Ok(()));
        }

        #[test]
        fn a_label_left_out_has_no_free_candidate(requests in vec(any_request(), 0..25)) {
            let choices = place(&requests, &field());
            for number in (0..requests.len()).filter(|&number| choices[number].is_none()) {
                for which in 0..requests[number].candidates.len() {
                    let mut forced = choices.clone();
                    forced[number] = Some(which);
                    prop_assert!(check(&requests, &forced, &field()).is_err());
                }
            }
        }
    }
}

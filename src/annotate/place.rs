//! Where labels go: a pure function from boxes to choices, and the check it must pass.
//!
//! Labels come in order of importance, each with candidate positions in order of preference. One after the
//! other takes the first candidate that is free. Greedy placement by priority is what a reader expects (a
//! minor label never displaces a major one), it is stable (removing an unplaced label changes nothing),
//! and its cost is bounded; optimal placement is NP-hard (Marks and Shieber 1991) and gains a label or two.
//!
//! One look ahead is taken: a candidate that would cover the spot another label is about to stand on is
//! taken only where no candidate avoids it.

use crate::annotate::pixel_box::{PixelBox, PixelSegment};

/// One way to draw a label.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelCandidate {
    /// Around the text.
    pub text: PixelBox,
    /// Around the symbol at the place; `None` where it is drawn without.
    pub symbol: Option<PixelBox>,
    /// The leader line from the symbol to the text; `None` where it is drawn without.
    pub leader: Option<PixelSegment>,
}

/// A label to be placed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Ways to draw it, the best first.
    pub candidates: Vec<LabelCandidate>,
    /// What others had better keep clear of even before this one is placed.
    pub spot: Option<PixelBox>,
}

/// The picture to place labels on.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelField {
    /// Everything placed stays inside.
    pub bounds: PixelBox,
    /// Nothing placed overlaps these.
    pub taken: Vec<PixelBox>,
    /// Leader lines keep this many pixels from texts, symbols and `taken`.
    pub leader_room: f32,
}

/// What is wrong with a placement; numbers index the requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlacementFault {
    /// There is not one choice a request, or a choice names no candidate.
    #[error("label {0} has no such candidate")]
    NoSuchCandidate(usize),
    /// A label leaves the bounds.
    #[error("label {0} leaves the picture")]
    Outside(usize),
    /// A label overlaps what was taken beforehand.
    #[error("label {0} overlaps furniture {1}")]
    OnFurniture(usize, usize),
    /// Two labels overlap.
    #[error("labels {0} and {1} overlap")]
    Overlap(usize, usize),
}

/// For every request the number of the candidate chosen, or `None` where none is free.
pub fn place(requests: &[Request], field: &LabelField) -> Vec<Option<usize>> {
    let mut placed: Vec<LabelCandidate> = Vec::new();
    let mut choices = Vec::with_capacity(requests.len());
    for (number, request) in requests.iter().enumerate() {
        let is_free = |candidate: &LabelCandidate| {
            field.admits(candidate) && !placed.iter().any(|other| field.conflict(candidate, other))
        };
        let free: Vec<usize> =
            (0..request.candidates.len()).filter(|&which| is_free(&request.candidates[which])).collect();
        let coming = &requests[number + 1..];
        let polite = |&&which: &&usize| !covers_a_spot(&request.candidates[which], coming);
        let choice = free.iter().find(polite).or(free.first()).copied();
        placed.extend(choice.map(|which| request.candidates[which]));
        choices.push(choice);
    }
    choices
}

/// Whether `choices` for `requests` keep the promises of [`place`]: everything inside, nothing overlapping.
///
/// # Errors
/// The first [`PlacementFault`] found.
pub fn check(
    requests: &[Request],
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
        placed.push((number, *chosen));
    }
    Ok(())
}

impl LabelField {
    fn admits(&self, candidate: &LabelCandidate) -> bool {
        self.keeps_inside(candidate) && !self.taken.iter().any(|taken| self.touches(candidate, taken))
    }

    fn keeps_inside(&self, candidate: &LabelCandidate) -> bool {
        self.bounds.holds(&candidate.text)
            && candidate.symbol.is_none_or(|symbol| self.bounds.holds(&symbol))
            && candidate
                .leader
                .is_none_or(|leader| self.bounds.contains(leader.from) && self.bounds.contains(leader.to))
    }

    /// Whether any part of `candidate` touches `area`.
    fn touches(&self, candidate: &LabelCandidate, area: &PixelBox) -> bool {
        candidate.text.overlaps(area)
            || candidate.symbol.is_some_and(|symbol| symbol.overlaps(area))
            || candidate.leader.is_some_and(|leader| area.grown(self.leader_room).meets(&leader))
    }

    /// Whether two labels drawn so would touch.
    fn conflict(&self, one: &LabelCandidate, other: &LabelCandidate) -> bool {
        self.touches(one, &other.text)
            || other.symbol.is_some_and(|symbol| self.touches(one, &symbol))
            || other.leader.is_some_and(|leader| {
                let near = |area: &PixelBox| area.grown(self.leader_room).meets(&leader);
                near(&one.text)
                    || one.symbol.as_ref().is_some_and(near)
                    || one.leader.is_some_and(|own| own.crosses(&leader))
            })
    }
}

fn covers_a_spot(candidate: &LabelCandidate, coming: &[Request]) -> bool {
    coming.iter().filter_map(|request| request.spot).any(|spot| candidate.text.overlaps(&spot))
}

#[cfg(test)]
mod tests {
    use glam::Vec2;
    use proptest::collection::vec;
    use proptest::prelude::{Strategy, prop_assert, prop_assert_eq, proptest};

    use super::*;

    fn field() -> LabelField {
        let bounds = PixelBox::at(Vec2::ZERO, Vec2::new(200.0, 100.0));
        LabelField { bounds, taken: vec![PixelBox::at(Vec2::ZERO, Vec2::new(60.0, 30.0))], leader_room: 2.0 }
    }

    fn text(x: f32, y: f32) -> LabelCandidate {
        let text = PixelBox::at(Vec2::new(x, y), Vec2::new(40.0, 10.0));
        LabelCandidate { text, symbol: None, leader: None }
    }

    fn request(candidates: &[LabelCandidate]) -> Request {
        Request { candidates: candidates.to_vec(), spot: None }
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
    fn a_coming_labels_spot_is_left_free_where_that_is_possible() {
        let spot = PixelBox::at(Vec2::new(105.0, 52.0), Vec2::splat(4.0));
        let coming = Request { candidates: vec![text(0.0, 80.0)], spot: Some(spot) };
        let choosy = request(&[text(100.0, 50.0), text(100.0, 70.0)]);
        assert_eq!(place(&[choosy, coming.clone()], &field())[0], Some(1));
        let stuck = request(&[text(100.0, 50.0)]);
        assert_eq!(place(&[stuck, coming], &field())[0], Some(0));
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
                symbol: (parts & 1 > 0).then(|| PixelBox::around(anchor, Vec2::splat(3.0))),
                leader: (parts & 2 > 0).then_some(leader),
            }
        })
    }

    fn any_request() -> impl Strategy<Value = Request> {
        vec(any_candidate(), 0..6).prop_map(|candidates| {
            let spot = candidates.first().and_then(|first| first.symbol);
            Request { candidates, spot }
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

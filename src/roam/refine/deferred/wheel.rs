//! A wheel of buckets keyed by distance travelled.
//!
//! Distances are counted in ticks from the start of the walk. Level 0 has one slot a tick for the next 63; each
//! further level has slots four times as wide, so any distance ahead finds a slot that begins at most a sixteenth
//! too early. What is in a slot is handed out when the walk reaches the slot's *beginning*: early, never late.
//! What may change before the next tick lies in a list of its own that is handed out every time.
//!
//! Entries are vertices of a patch, linked through the array that the patch keeps of its vertices; the wheel holds
//! only the heads of the lists.

use crate::roam::refine::deferred::topology::NONE;

/// Slots of a level; one word of bits tells which are not empty.
const SLOTS: u64 = 64;

/// Each level's slots are 2 to this power as wide as those of the one below.
const SHIFT: u32 = 2;

/// Levels: the last reaches 2²⁸ ticks ahead, farther than any terrain.
const LEVELS: usize = 12;

/// The farthest that an entry is put ahead, in ticks; what is due later is handed out early and put back.
const FARTHEST: u64 = (SLOTS - 2) << (SHIFT * (LEVELS as u32 - 1));

/// Where the list of what is handed out next time is found among the heads.
const NEXT_TIME: usize = LEVELS * SLOTS as usize;

/// One entry's links: the array of all vertices' links belongs to the patch.
pub trait Links {
    /// The link of `vertex`.
    fn link(&mut self, vertex: u16) -> &mut Link;
}

/// What an entry knows of its list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    /// The next entry, or [`NONE`].
    pub next: u16,
    /// The list it is in, or [`NONE`].
    pub list: u16,
}

impl Link {
    /// In no list.
    pub const FREE: Self = Self { next: NONE, list: NONE };
}

/// The heads of the lists.
#[derive(Clone, Debug)]
pub struct Wheel {
    now: u64,
    filled: [u64; LEVELS],
    heads: [u16; NEXT_TIME + 1],
}

impl Wheel {
    /// An empty wheel at tick `now`.
    pub fn new(now: u64) -> Self {
        Self { now, filled: [0; LEVELS], heads: [NONE; NEXT_TIME + 1] }
    }

    /// The tick it was last moved on to.
    pub fn now(&self) -> u64 {
        self.now
    }

    /// The first tick at which [`Wheel::take_due`] may find something: now, if something may change before the next
    /// tick; the farthest there is, if the wheel is empty.
    pub fn next(&self) -> u64 {
        if self.heads[NEXT_TIME] != NONE {
            return self.now;
        }
        let begin = |level: usize| {
            let shift = level as u32 * SHIFT;
            let slot = self.now >> shift;
            let ahead = self.filled[level].rotate_right((slot % SLOTS) as u32).trailing_zeros();
            (slot + u64::from(ahead)) << shift
        };
        (0..LEVELS).filter(|&level| self.filled[level] != 0).map(begin).min().unwrap_or(u64::MAX)
    }

    /// Puts `vertex`, which is in no list, where it is handed out at tick `due` or up to a sixteenth of the way
    /// earlier; at the next taking where that is now.
    pub fn put(&mut self, links: &mut impl Links, vertex: u16, due: u64) {
        let due = due.min(self.now + FARTHEST);
        let list = if due <= self.now { NEXT_TIME } else { self.slot(due) };
        *links.link(vertex) = Link { next: self.heads[list], list: list as u16 };
        self.heads[list] = vertex;
    }

    /// The slot of a tick after now, marked as filled.
    fn slot(&mut self, due: u64) -> usize {
        // The lowest level on which the tick is fewer than a turn away.
        let bits = u64::BITS - (due - self.now).leading_zeros();
        let mut level = bits.saturating_sub(6).div_ceil(SHIFT);
        if (due >> (level * SHIFT)) - (self.now >> (level * SHIFT)) >= SLOTS {
            level += 1;
        }
        let slot = (due >> (level * SHIFT)) % SLOTS;
        self.filled[level as usize] |= 1 << slot;
        level as usize * SLOTS as usize + slot as usize
    }

    /// Takes `vertex` out of the list it is in.
    pub fn remove(&mut self, links: &mut impl Links, vertex: u16) {
        let Link { next, list } = *links.link(vertex);
        *links.link(vertex) = Link::FREE;
        let head = self.heads[list as usize];
        if head == vertex {
            self.heads[list as usize] = next;
            return;
        }
        let mut before = head;
        while links.link(before).next != vertex {
            before = links.link(before).next;
        }
        links.link(before).next = next;
    }

    /// Moves on to tick `now`, which must not be before the last, and appends everything due by then to `due`.
    pub fn take_due(&mut self, links: &mut impl Links, now: u64, due: &mut Vec<u16>) {
        take_list(&mut self.heads[NEXT_TIME], links, due);
        for level in 0..LEVELS {
            if (self.now >> (level as u32 * SHIFT)) == (now >> (level as u32 * SHIFT)) {
                break;
            }
            let mut slots = self.due_slots(level, now);
            self.filled[level] &= !slots;
            while slots != 0 {
                let slot = slots.trailing_zeros() as usize;
                take_list(&mut self.heads[level * SLOTS as usize + slot], links, due);
                slots &= slots - 1;
            }
        }
        self.now = now;
    }

    /// The filled slots of a level that begin after the last tick and by `now`.
    fn due_slots(&self, level: usize, now: u64) -> u64 {
        let shift = level as u32 * SHIFT;
        let (from, to) = (self.now >> shift, now >> shift);
        if to - from >= SLOTS {
            return self.filled[level];
        }
        let ahead = (1u64 << (to - from)) - 1;
        self.filled[level] & ahead.rotate_left(((from + 1) % SLOTS) as u32)
    }
}

fn take_list(head: &mut u16, links: &mut impl Links, due: &mut Vec<u16>) {
    let mut vertex = std::mem::replace(head, NONE);
    while vertex != NONE {
        due.push(vertex);
        let link = links.link(vertex);
        vertex = link.next;
        *link = Link::FREE;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    impl Links for Vec<Link> {
        fn link(&mut self, vertex: u16) -> &mut Link {
            &mut self[vertex as usize]
        }
    }

    proptest! {
        #[test]
        fn everything_is_handed_out_once_never_late_and_at_most_a_sixteenth_early(
            start in 0u64..1 << 40,
            ahead in proptest::collection::vec(0u64..1 << 20, 1..60),
            strides in proptest::collection::vec(0u64..1 << 14, 1..400),
        ) {
            let mut links = vec![Link::FREE; ahead.len()];
            let mut wheel = Wheel::new(start);
            for (vertex, &ahead) in ahead.iter().enumerate() {
                wheel.put(&mut links, vertex as u16, start + ahead);
            }
            let (mut now, mut waiting) = (start, ahead.len());
            for stride in strides {
                let last = now;
                now += stride;
                let mut due = Vec::new();
                let next = wheel.next();
                wheel.take_due(&mut links, now, &mut due);
                prop_assert!(next <= now || due.is_empty(), "{next} was too late");
                prop_assert!(next > now || !due.is_empty(), "{next} was too early");
                waiting -= due.len();
                for vertex in due {
                    let ahead = ahead[vertex as usize];
                    prop_assert!(ahead == 0 || start + ahead >= last, "late");
                    prop_assert!(start + ahead - ahead / 8 <= now + 1, "{ahead} at {}", now - start);
                }
                let left = links.iter().enumerate().filter(|(_, link)| link.list != NONE);
                for (vertex, _) in left {
                    prop_assert!(start + ahead[vertex] > now, "{} is overdue at {}", ahead[vertex], now - start);
                }
            }
            prop_assert_eq!(waiting, links.iter().filter(|link| link.list != NONE).count());
        }

        #[test]
        fn what_is_taken_out_is_not_handed_out(ahead in proptest::collection::vec(0u64..500, 2..40)) {
            let mut links = vec![Link::FREE; ahead.len()];
            let mut wheel = Wheel::new(7);
            for (vertex, &ahead) in ahead.iter().enumerate() {
                wheel.put(&mut links, vertex as u16, 7 + ahead);
            }
            for vertex in (0..ahead.len()).step_by(2) {
                wheel.remove(&mut links, vertex as u16);
            }
            let mut due = Vec::new();
            wheel.take_due(&mut links, 600, &mut due);
            due.sort_unstable();
            let kept: Vec<u16> = (0..ahead.len() as u16).filter(|vertex| vertex % 2 == 1).collect();
            prop_assert_eq!(due, kept);
        }
    }
}

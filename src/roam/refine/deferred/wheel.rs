//! A wheel of buckets keyed by distance traveled.
//!
//! Distances are counted in ticks from the start. Level 0 has one slot a tick for the next 63; each further level has slots
//! four times as wide, so any distance ahead has a slot that begins at most a sixteenth too early. The entries of a slot are
//! taken when its *beginning* is reached: early, never late. Those that may change before the next tick are in a separate
//! list, which is taken every time.
//!
//! Entries are numbers of the owner's choice, linked through cells that the owner stores; the wheel holds only the heads of
//! the lists, three kilobytes for any number of entries.

/// No entry, no list.
pub const FREE: u32 = u32::MAX;

/// Slots of a level; one word of bits tells which are not empty.
const SLOTS: u64 = 64;

/// Each level's slots are 2 to this power as wide as those of the one below.
const SHIFT: u32 = 2;

/// Levels: the last reaches 2²⁸ ticks ahead, farther than any terrain.
const LEVELS: usize = 12;

/// The farthest that an entry is put ahead, in ticks; one that is due later is taken early and put back.
pub const FARTHEST: u64 = (SLOTS - 2) << (SHIFT * (LEVELS as u32 - 1));

/// The head of the list that is taken every time.
const NEXT_TIME: usize = LEVELS * SLOTS as usize;

/// The owner of the entries' links.
pub trait Links {
    /// The link of an entry that is in a list.
    fn link(&mut self, entry: u32) -> &mut WheelLink;

    /// Marks an entry as in no list; returns its last link.
    fn leave(&mut self, entry: u32) -> WheelLink;
}

/// The link of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WheelLink {
    /// The next entry, or [`FREE`].
    pub next: u32,
    /// The list it is in.
    list: u16,
}

impl WheelLink {
    /// In no list yet.
    pub const FREE: Self = Self { next: FREE, list: u16::MAX };
}

/// The heads of the lists.
#[derive(Clone, Debug)]
pub struct Wheel {
    now: u64,
    filled: [u64; LEVELS],
    heads: [u32; NEXT_TIME + 1],
}

impl Wheel {
    /// An empty wheel at tick `now`.
    pub fn new(now: u64) -> Self {
        Self { now, filled: [0; LEVELS], heads: [FREE; NEXT_TIME + 1] }
    }

    /// Puts `entry`, which is in no list, into the list that is taken at tick `due` or up to a sixteenth of the distance
    /// earlier; next time where that is now. Returns the link that its owner must store.
    #[must_use]
    pub fn put(&mut self, entry: u32, due: u64) -> WheelLink {
        let due = due.min(self.now + FARTHEST);
        let list = if due <= self.now { NEXT_TIME } else { self.slot(due) };
        let next = std::mem::replace(&mut self.heads[list], entry);
        WheelLink { next, list: list as u16 }
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

    /// The tick at which the list of `link` is taken; 0 for the one that is taken every time.
    pub fn begin(&self, link: WheelLink) -> u64 {
        let list = u64::from(link.list);
        if list as usize == NEXT_TIME {
            return 0;
        }
        let (shift, slot) = ((list / SLOTS) as u32 * SHIFT, list % SLOTS);
        let now = self.now >> shift;
        (now + slot.wrapping_sub(now) % SLOTS) << shift
    }

    /// Takes an entry out of the list it is in, walking the list.
    pub fn remove(&mut self, links: &mut impl Links, entry: u32) {
        let WheelLink { next, list } = links.leave(entry);
        let head = &mut self.heads[list as usize];
        if *head == entry {
            *head = next;
            return;
        }
        let mut before = *head;
        while links.link(before).next != entry {
            before = links.link(before).next;
        }
        links.link(before).next = next;
    }

    /// Takes out every entry for which `keep` returns false.
    pub fn retain(&mut self, links: &mut impl Links, keep: impl Fn(u32) -> bool) {
        for head in &mut self.heads {
            let mut entry = std::mem::replace(head, FREE);
            while entry != FREE {
                let kept = keep(entry);
                let next = if kept {
                    std::mem::replace(&mut links.link(entry).next, std::mem::replace(head, entry))
                } else {
                    links.leave(entry).next
                };
                entry = next;
            }
        }
    }

    /// Advances to tick `now`, which must not be before the last, and appends the entries due by then to `due`.
    pub fn take_due(&mut self, links: &mut impl Links, now: u64, due: &mut Vec<u32>) {
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

fn take_list(head: &mut u32, links: &mut impl Links, due: &mut Vec<u32>) {
    let mut entry = std::mem::replace(head, FREE);
    while entry != FREE {
        due.push(entry);
        entry = links.leave(entry).next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    impl Links for Vec<WheelLink> {
        fn link(&mut self, entry: u32) -> &mut WheelLink {
            &mut self[entry as usize]
        }

        fn leave(&mut self, entry: u32) -> WheelLink {
            std::mem::replace(&mut self[entry as usize], WheelLink::FREE)
        }
    }

    proptest! {
        #[test]
        fn everything_is_handed_out_once_never_late_and_at_most_a_sixteenth_early(
            start in 0u64..1 << 40,
            ahead in proptest::collection::vec(0u64..1 << 20, 1..60),
            strides in proptest::collection::vec(0u64..1 << 14, 1..400),
        ) {
            let mut links = vec![WheelLink::FREE; ahead.len()];
            let mut wheel = Wheel::new(start);
            for (vertex, &ahead) in ahead.iter().enumerate() {
                links[vertex] = wheel.put(vertex as u32, start + ahead);
            }
            let (mut now, mut waiting) = (start, ahead.len());
            for stride in strides {
                let last = now;
                now += stride;
                let mut due = Vec::new();
                wheel.take_due(&mut links, now, &mut due);
                waiting -= due.len();
                for vertex in due {
                    let ahead = ahead[vertex as usize];
                    prop_assert!(ahead == 0 || start + ahead >= last, "late");
                    prop_assert!(start + ahead - ahead / 8 <= now + 1, "{ahead} at {}", now - start);
                }
                let left = links.iter().enumerate().filter(|(_, link)| **link != WheelLink::FREE);
                for (vertex, _) in left {
                    prop_assert!(start + ahead[vertex] > now, "{} is overdue at {}", ahead[vertex], now - start);
                }
            }
            prop_assert_eq!(waiting, links.iter().filter(|link| **link != WheelLink::FREE).count());
        }

        #[test]
        fn what_is_taken_out_is_not_handed_out(ahead in proptest::collection::vec(0u64..500, 2..40)) {
            let mut links = vec![WheelLink::FREE; ahead.len()];
            let mut wheel = Wheel::new(7);
            for (vertex, &ahead) in ahead.iter().enumerate() {
                links[vertex] = wheel.put(vertex as u32, 7 + ahead);
            }
            let begins: Vec<u64> = links.iter().map(|&link| wheel.begin(link)).collect();
            prop_assert!(begins.iter().zip(&ahead).all(|(&begin, &ahead)| begin <= 7 + ahead));
            wheel.retain(&mut links, |vertex| vertex % 4 != 0);
            for vertex in (2..ahead.len() as u32).step_by(4) {
                wheel.remove(&mut links, vertex);
            }
            let mut due = Vec::new();
            wheel.take_due(&mut links, 600, &mut due);
            due.sort_unstable();
            let kept: Vec<u32> = (0..ahead.len() as u32).filter(|vertex| vertex % 2 == 1).collect();
            prop_assert_eq!(due, kept);
        }
    }
}

//! A wheel of buckets keyed by distance traveled.
//!
//! Distances are counted in ticks from the start. Level 0 has one slot a tick for the next 63; each further level has slots
//! four times as wide, so any distance ahead has a slot that begins at most a sixteenth too early. The entries of a slot are
//! taken when its *beginning* is reached: early, never late. Those that may change before the next tick are in a separate
//! list, which is taken every time.
//!
//! Entries are numbers of the owner's choice; the owner stores the list of each. A list is a chain of chunks of one cache
//! line, so that reading the entry after next seldom waits for the next, as in a chain through the vertices' own records.
//! An entry to take out is found by a scan. The chunks of all lists come from one pool: those that a list gives back, still
//! in the cache, are the next to be filled, and once the pool is as large as the most that wait at a time no frame asks for
//! memory.

/// Slots of a level; one word of bits tells which are not empty.
const SLOTS: u64 = 64;

/// Each level's slots are 2 to this power as wide as those of the one below.
const SHIFT: u32 = 2;

/// Levels: the last reaches 2²⁸ ticks ahead, farther than any terrain.
const LEVELS: usize = 12;

/// The farthest that an entry is put ahead, in ticks; one that is due later is taken early and put back.
pub const FARTHEST: u64 = (SLOTS - 2) << (SHIFT * (LEVELS as u32 - 1));

/// The list that is taken every time.
const NEXT_TIME: usize = LEVELS * SLOTS as usize;

/// The number of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WheelList(u16);

impl WheelList {
    /// No list.
    pub const NONE: Self = Self(u16::MAX);
}

/// Entries in a chunk: with the link, one cache line.
const CHUNK: usize = 15;

/// The link of the last chunk of a list.
const NO_CHUNK: u32 = u32::MAX;

/// Entries of one list.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct WheelChunk {
    entries: [u32; CHUNK],
    /// The chunk that was filled before this.
    before: u32,
}

/// The newest chunk of a list, the only one that may have fewer than [`CHUNK`] entries.
#[derive(Clone, Copy, Debug)]
struct NewestChunk {
    chunk: u32,
    /// Its entries; [`CHUNK`] where there is no chunk, so that the next entry begins one.
    count: u32,
}

const EMPTY_LIST: NewestChunk = NewestChunk { chunk: NO_CHUNK, count: CHUNK as u32 };

/// The lists.
#[derive(Clone, Debug)]
pub struct Wheel {
    now: u64,
    filled: [u64; LEVELS],
    lists: Vec<NewestChunk>,
    pool: Vec<WheelChunk>,
    /// Chunks of no list.
    spare: Vec<u32>,
}

impl Wheel {
    /// An empty wheel at tick `now`.
    pub fn new(now: u64) -> Self {
        let lists = vec![EMPTY_LIST; NEXT_TIME + 1];
        Self { now, filled: [0; LEVELS], lists, pool: Vec::new(), spare: Vec::new() }
    }

    /// Puts `entry`, which is in no list, into the list that is taken at tick `due` or up to a sixteenth of the distance
    /// earlier; next time where that is now. Returns the list, which its owner must store.
    #[must_use]
    #[inline]
    pub fn put(&mut self, entry: u32, due: u64) -> WheelList {
        let due = due.min(self.now + FARTHEST);
        let list = if due <= self.now { NEXT_TIME } else { self.slot(due) };
        self.add(list, entry);
        WheelList(list as u16)
    }

    #[inline]
    fn add(&mut self, list: usize, entry: u32) {
        let newest = &mut self.lists[list];
        if newest.count as usize == CHUNK {
            let chunk = self.spare.pop().unwrap_or_else(|| {
                self.pool.push(WheelChunk { entries: [0; CHUNK], before: NO_CHUNK });
                self.pool.len() as u32 - 1
            });
            self.pool[chunk as usize].before = newest.chunk;
            *newest = NewestChunk { chunk, count: 0 };
        }
        self.pool[newest.chunk as usize].entries[newest.count as usize] = entry;
        newest.count += 1;
    }

    /// Empties a list and appends its entries to `taken`, the newest first.
    fn take(&mut self, list: usize, taken: &mut Vec<u32>) {
        let NewestChunk { mut chunk, mut count } = std::mem::replace(&mut self.lists[list], EMPTY_LIST);
        while chunk != NO_CHUNK {
            let WheelChunk { entries, before } = &self.pool[chunk as usize];
            taken.extend(entries[..count as usize].iter().rev());
            self.spare.push(chunk);
            (chunk, count) = (*before, CHUNK as u32);
        }
    }

    /// The slot of a tick after now, marked as filled.
    #[inline]
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

    /// The tick at which a list is taken; 0 for the one that is taken every time.
    #[inline]
    pub fn begin(&self, WheelList(list): WheelList) -> u64 {
        let list = u64::from(list);
        if list as usize == NEXT_TIME {
            return 0;
        }
        let (shift, slot) = ((list / SLOTS) as u32 * SHIFT, list % SLOTS);
        let now = self.now >> shift;
        (now + slot.wrapping_sub(now) % SLOTS) << shift
    }

    /// Takes an entry out of the list that it is in; the newest entry of the list takes its place.
    pub fn remove(&mut self, entry: u32, WheelList(list): WheelList) {
        let newest = self.lists[list as usize];
        let (mut chunk, mut count) = (newest.chunk, newest.count as usize);
        let at = loop {
            assert!(chunk != NO_CHUNK, "the owner stores the list that an entry is in");
            let WheelChunk { entries, before } = &self.pool[chunk as usize];
            match entries[..count].iter().position(|&other| other == entry) {
                Some(at) => break at,
                None => (chunk, count) = (*before, CHUNK),
            }
        };
        let last = self.pool[newest.chunk as usize];
        self.pool[chunk as usize].entries[at] = last.entries[newest.count as usize - 1];
        self.lists[list as usize].count -= 1;
        if newest.count == 1 {
            self.spare.push(newest.chunk);
            self.lists[list as usize] = NewestChunk { chunk: last.before, ..EMPTY_LIST };
        }
    }

    /// Takes out every entry for which `keep` returns false.
    pub fn retain(&mut self, keep: impl Fn(u32) -> bool) {
        let mut taken = Vec::new();
        for list in 0..self.lists.len() {
            self.take(list, &mut taken);
            taken.drain(..).rev().filter(|&entry| keep(entry)).for_each(|entry| self.add(list, entry));
        }
    }

    /// Advances to tick `now`, which must not be before the last, and appends the entries due by then to `due`,
    /// those of a list in the reverse of the order in which they were put there.
    pub fn take_due(&mut self, now: u64, due: &mut Vec<u32>) {
        self.take(NEXT_TIME, due);
        for level in 0..LEVELS {
            if (self.now >> (level as u32 * SHIFT)) == (now >> (level as u32 * SHIFT)) {
                break;
            }
            let mut slots = self.due_slots(level, now);
            self.filled[level] &= !slots;
            while slots != 0 {
                let slot = slots.trailing_zeros() as usize;
                self.take(level * SLOTS as usize + slot, due);
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn everything_is_handed_out_once_never_late_and_at_most_a_sixteenth_early(
            start in 0u64..1 << 40,
            ahead in proptest::collection::vec(0u64..1 << 20, 1..60),
            strides in proptest::collection::vec(0u64..1 << 14, 1..400),
        ) {
            let mut lists = vec![WheelList::NONE; ahead.len()];
            let mut wheel = Wheel::new(start);
            for (vertex, &ahead) in ahead.iter().enumerate() {
                lists[vertex] = wheel.put(vertex as u32, start + ahead);
            }
            let (mut now, mut waiting) = (start, ahead.len());
            for stride in strides {
                let last = now;
                now += stride;
                let mut due = Vec::new();
                wheel.take_due(now, &mut due);
                waiting -= due.len();
                for vertex in due {
                    lists[vertex as usize] = WheelList::NONE;
                    let ahead = ahead[vertex as usize];
                    prop_assert!(ahead == 0 || start + ahead >= last, "late");
                    prop_assert!(start + ahead - ahead / 8 <= now + 1, "{ahead} at {}", now - start);
                }
                let left = lists.iter().enumerate().filter(|(_, list)| **list != WheelList::NONE);
                for (vertex, _) in left {
                    prop_assert!(start + ahead[vertex] > now, "{} is overdue at {}", ahead[vertex], now - start);
                }
            }
            prop_assert_eq!(waiting, lists.iter().filter(|list| **list != WheelList::NONE).count());
        }

        #[test]
        fn what_is_taken_out_is_not_handed_out(ahead in proptest::collection::vec(0u64..500, 2..40)) {
            let mut wheel = Wheel::new(7);
            let put = |(vertex, &ahead): (usize, &u64)| wheel.put(vertex as u32, 7 + ahead);
            let lists: Vec<WheelList> = ahead.iter().enumerate().map(put).collect();
            let begins: Vec<u64> = lists.iter().map(|&list| wheel.begin(list)).collect();
            prop_assert!(begins.iter().zip(&ahead).all(|(&begin, &ahead)| begin <= 7 + ahead));
            wheel.retain(|vertex| vertex % 4 != 0);
            for vertex in (2..ahead.len() as u32).step_by(4) {
                wheel.remove(vertex, lists[vertex as usize]);
            }
            let mut due = Vec::new();
            wheel.take_due(600, &mut due);
            due.sort_unstable();
            let kept: Vec<u32> = (0..ahead.len() as u32).filter(|vertex| vertex % 2 == 1).collect();
            prop_assert_eq!(due, kept);
        }
    }
}

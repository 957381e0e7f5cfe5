//! What was used last, within a bound: the least recently used goes first.
//!
//! Two ordered maps, by key and by the time of the last use, so that nothing depends on hashing and the order of
//! evictions is a function of the order of uses alone. Room is made before a value is put in: the bound is never
//! exceeded, not even for a moment.

use std::collections::BTreeMap;

/// Values by key, each with a weight; the weights together never exceed a bound.
#[derive(Clone, Debug)]
pub struct Recent<K, V> {
    bound: usize,
    held: usize,
    clock: u64,
    values: BTreeMap<K, CacheEntry<V>>,
    by_use: BTreeMap<u64, K>,
}

#[derive(Clone, Debug)]
struct CacheEntry<V> {
    value: V,
    weight: usize,
    used: u64,
}

impl<K: Ord + Copy, V> Recent<K, V> {
    /// Nothing yet, and never more than a weight of `bound`.
    pub fn new(bound: usize) -> Self {
        Self { bound, held: 0, clock: 0, values: BTreeMap::new(), by_use: BTreeMap::new() }
    }

    /// The value of `key`, used now; `None` where it is not held.
    pub fn get(&mut self, key: K) -> Option<&V> {
        let kept = self.values.get_mut(&key)?;
        self.by_use.remove(&kept.used);
        self.clock += 1;
        kept.used = self.clock;
        self.by_use.insert(self.clock, key);
        Some(&kept.value)
    }

    /// Whether `key` is held; that is no use.
    pub fn holds(&self, key: K) -> bool {
        self.values.contains_key(&key)
    }

    /// Lets the least recently used go until `weight` more fits, or nothing is left; returns how many went.
    pub fn make_room(&mut self, weight: usize) -> usize {
        let before = self.values.len();
        while self.held > self.bound.saturating_sub(weight) {
            let Some((_, key)) = self.by_use.pop_first() else { break };
            if let Some(kept) = self.values.remove(&key) {
                self.held -= kept.weight;
            }
        }
        before - self.values.len()
    }

    /// Holds `value`, used now, in place of what `key` held; not at all where `weight` alone exceeds the bound.
    /// Returns how many others were let go for it.
    pub fn put(&mut self, key: K, value: V, weight: usize) -> usize {
        if let Some(old) = self.values.remove(&key) {
            self.by_use.remove(&old.used);
            self.held -= old.weight;
        }
        if weight > self.bound {
            return 0;
        }
        let gone = self.make_room(weight);
        self.clock += 1;
        self.held += weight;
        self.by_use.insert(self.clock, key);
        self.values.insert(key, CacheEntry { value, weight, used: self.clock });
        gone
    }

    /// All that is held, by key; that is no use.
    pub fn iter(&self) -> impl Iterator<Item = (K, &V)> {
        self.values.iter().map(|(key, kept)| (*key, &kept.value))
    }

    /// The weight of all that is held.
    pub fn held(&self) -> usize {
        self.held
    }

    /// Whether the weights add up, stay within the bound, and every value has its place in the order of use.
    ///
    /// # Errors
    /// A sentence with the numbers that disagree.
    pub fn check(&self) -> Result<(), String> {
        let weights: usize = self.values.values().map(|kept| kept.weight).sum();
        if weights != self.held || self.held > self.bound {
            return Err(format!("weights of {weights}, {} said, at most {} wanted", self.held, self.bound));
        }
        let ordered =
            self.by_use.iter().all(|(used, key)| self.values.get(key).is_some_and(|kept| kept.used == *used));
        if !ordered || self.by_use.len() != self.values.len() {
            return Err(format!("{} uses of {} values", self.by_use.len(), self.values.len()));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_least_recently_used_goes_first() {
        let mut recent = Recent::new(3);
        for key in [1, 2, 3] {
            recent.put(key, key * 10, 1);
        }
        assert_eq!(recent.get(1), Some(&10));
        assert_eq!(recent.put(4, 40, 1), 1);
        assert_eq!([1, 2, 3, 4].map(|key| recent.holds(key)), [true, false, true, true]);
    }

    proptest! {
        #[test]
        fn whatever_is_put_the_bound_is_kept_and_what_just_went_in_is_there(
            puts in proptest::collection::vec((0..9u8, 0..7usize), 0..60),
        ) {
            let mut recent = Recent::new(10);
            for (key, weight) in puts {
                recent.put(key, weight, weight);
                prop_assert_eq!(recent.check(), Ok(()));
                prop_assert_eq!(recent.get(key), Some(&weight));
                prop_assert_eq!(recent.check(), Ok(()));
            }
        }
    }
}

//! A cache of bounded weight that evicts the least recently used value first.
//!
//! Two ordered maps, by key and by the time of the last use: nothing depends on hashing, and the order of evictions is
//! a function of the order of uses alone. Room is made before a value is put in, so that the bound is never exceeded.
//! (The kept crates bound the number of values, or evict in an order that depends on hashing.)

use std::collections::BTreeMap;

/// Values by key, each with a weight; the weights together never exceed a bound.
#[derive(Clone, Debug)]
pub struct LruCache<K, V> {
    bound: usize,
    weight: usize,
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

impl<K: Ord + Copy, V> LruCache<K, V> {
    /// An empty cache with a bound on its weight.
    pub fn new(bound: usize) -> Self {
        Self { bound, weight: 0, clock: 0, values: BTreeMap::new(), by_use: BTreeMap::new() }
    }

    /// The value of `key`, which counts as used now; `None` where it is not cached.
    pub fn get(&mut self, key: K) -> Option<&V> {
        let entry = self.values.get_mut(&key)?;
        self.by_use.remove(&entry.used);
        self.clock += 1;
        entry.used = self.clock;
        self.by_use.insert(self.clock, key);
        Some(&entry.value)
    }

    /// Takes the value of `key` out; `None` where it is not cached.
    pub fn take(&mut self, key: K) -> Option<V> {
        let CacheEntry { value, weight, used } = self.values.remove(&key)?;
        self.by_use.remove(&used);
        self.weight -= weight;
        Some(value)
    }

    /// Whether `key` is cached; does not count as a use.
    pub fn contains(&self, key: K) -> bool {
        self.values.contains_key(&key)
    }

    /// Evicts the least recently used values until `weight` more fits or nothing is left; returns how many.
    pub fn make_room(&mut self, weight: usize) -> usize {
        let before = self.values.len();
        while self.weight > self.bound.saturating_sub(weight) {
            let Some((_, key)) = self.by_use.pop_first() else { break };
            self.weight -= self.values.remove(&key).map_or(0, |entry| entry.weight);
        }
        before - self.values.len()
    }

    /// Caches `value` as the most recently used, in place of the previous value of `key`; does nothing where `weight`
    /// alone exceeds the bound. Returns how many other values were evicted for it.
    pub fn put(&mut self, key: K, value: V, weight: usize) -> usize {
        if let Some(old) = self.values.remove(&key) {
            self.by_use.remove(&old.used);
            self.weight -= old.weight;
        }
        if weight > self.bound {
            return 0;
        }
        let evicted = self.make_room(weight);
        self.clock += 1;
        self.weight += weight;
        self.by_use.insert(self.clock, key);
        self.values.insert(key, CacheEntry { value, weight, used: self.clock });
        evicted
    }

    /// All values in the order of their keys; does not count as a use.
    pub fn iter(&self) -> impl Iterator<Item = (K, &V)> {
        self.values.iter().map(|(key, entry)| (*key, &entry.value))
    }

    /// The weight of all values.
    pub fn weight(&self) -> usize {
        self.weight
    }

    /// Checks the invariants.
    ///
    /// # Panics
    /// The weights do not add up or exceed the bound, or a value has no place in the order of use.
    pub fn check(&self) {
        let weights: usize = self.values.values().map(|entry| entry.weight).sum();
        assert!(
            weights == self.weight && weights <= self.bound,
            "{weights}, {} of {}",
            self.weight,
            self.bound
        );
        let is_ordered =
            |(used, key): (&u64, &K)| self.values.get(key).is_some_and(|entry| entry.used == *used);
        assert_eq!(self.by_use.len(), self.values.len());
        assert!(self.by_use.iter().all(is_ordered), "the order of use names other values");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_least_recently_used_goes_first() {
        let mut cache = LruCache::new(3);
        for key in [1, 2, 3] {
            cache.put(key, key * 10, 1);
        }
        assert_eq!(cache.get(1), Some(&10));
        assert_eq!(cache.put(4, 40, 1), 1);
        assert_eq!([1, 2, 3, 4].map(|key| cache.contains(key)), [true, false, true, true]);
    }

    proptest! {
        #[test]
        fn the_bound_is_kept_and_what_just_went_in_is_there(
            puts in proptest::collection::vec((0..9u8, 0..7usize), 0..60),
        ) {
            let mut cache = LruCache::new(10);
            for (key, weight) in puts {
                cache.put(key, weight, weight);
                cache.check();
                prop_assert_eq!(cache.get(key), Some(&weight));
                cache.check();
            }
            let keys: Vec<u8> = cache.iter().map(|(key, _)| key).collect();
            for key in keys {
                prop_assert!(cache.take(key).is_some() && cache.take(key).is_none());
                cache.check();
            }
            prop_assert_eq!(cache.weight(), 0);
        }
    }
}

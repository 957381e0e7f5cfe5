//! A queue of posts by time: buckets in a ring (Dial 1969), each as wide as the shortest step takes.
//!
//! Within such a bucket no post can better another, so that the order within it has no effect. Where the longest step
//! would need more than [`MOST_BUCKETS`], buckets are wider; a post whose time falls is then queued again, and the times
//! are the same. An entry is stale where its time is not its post's any more.

/// The most buckets of a ring; each has 24 bytes.
const MOST_BUCKETS: usize = 1 << 16;

/// A queue of posts by time.
pub(crate) struct BucketQueue {
    buckets: Vec<Vec<(u32, f32)>>,
    per_second: f64,
    /// The bucket that is emptied, counted from time 0.
    current: u64,
    entries: usize,
}

impl BucketQueue {
    /// A queue for steps that take from `shortest_s` to `longest_s`, both above 0.
    pub fn new(shortest_s: f64, longest_s: f64) -> Self {
        let shortest_s = shortest_s.max(1e-6);
        let width = shortest_s.max(longest_s / (MOST_BUCKETS - 3) as f64);
        let count = ((longest_s / width) as usize).min(MOST_BUCKETS - 3) + 3;
        Self { buckets: vec![Vec::new(); count], per_second: 1.0 / width, current: 0, entries: 0 }
    }

    /// Puts a post into the queue.
    #[inline]
    pub fn push(&mut self, index: u32, time_s: f32) {
        let count = self.buckets.len() as u64;
        let bucket = (f64::from(time_s) * self.per_second) as u64;
        let bucket = bucket.clamp(self.current, self.current + count - 1);
        self.buckets[(bucket % count) as usize].push((index, time_s));
        self.entries += 1;
    }

    /// Takes a post of the first bucket.
    #[inline]
    pub fn pop(&mut self) -> Option<(u32, f32)> {
        if self.entries == 0 {
            return None;
        }
        let count = self.buckets.len() as u64;
        loop {
            if let Some(entry) = self.buckets[(self.current % count) as usize].pop() {
                self.entries -= 1;
                return Some(entry);
            }
            self.current += 1;
        }
    }
}

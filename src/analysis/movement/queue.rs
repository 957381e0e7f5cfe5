//! A queue of posts by time: buckets in a ring (Dial 1969), each as wide as the shortest step takes.
//!
//! Within such a bucket no post can better another, so that the order within it has no effect. Where the longest step
//! would need more than [`MOST_BUCKETS`], buckets are wider; a post whose time falls is then queued again, and the times
//! are the same. An entry is stale where its time is not its post's any more.

/// The most buckets of a ring; each has 24 bytes.
const MOST_BUCKETS: usize = 1 << 16;

/// A post with the time at which it was reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct QueuedPost {
    pub index: u32,
    pub time_s: f32,
}

/// A queue of posts by time.
pub(crate) struct BucketQueue {
    buckets: Vec<Vec<QueuedPost>>,
    per_second: f64,
    /// The bucket that is emptied, counted from time 0.
    current: u64,
    entries: usize,
    /// An empty bucket, for its memory.
    spare: Vec<QueuedPost>,
}

impl BucketQueue {
    /// A queue for steps that take from `shortest_s` to `longest_s`, both above 0.
    pub fn new(shortest_s: f64, longest_s: f64) -> Self {
        let shortest_s = shortest_s.max(1e-6);
        let width = shortest_s.max(longest_s / (MOST_BUCKETS - 3) as f64);
        let count = ((longest_s / width) as usize).min(MOST_BUCKETS - 3) + 3;
        let buckets = vec![Vec::new(); count];
        Self { buckets, per_second: 1.0 / width, current: 0, entries: 0, spare: Vec::new() }
    }

    /// Puts a post into the queue, in the order of when it is expected at the goal; without one, of its time.
    #[inline]
    pub fn push(&mut self, post: QueuedPost, expected_s: f32) {
        let count = self.buckets.len() as u64;
        let bucket = (f64::from(expected_s) * self.per_second) as u64;
        let bucket = bucket.clamp(self.current, self.current + count - 1);
        self.buckets[(bucket % count) as usize].push(post);
        self.entries += 1;
    }

    /// Takes the posts of the first bucket that has any; posts that are pushed into it later are taken next.
    pub fn take_bucket(&mut self) -> Option<Vec<QueuedPost>> {
        if self.entries == 0 {
            return None;
        }
        let count = self.buckets.len() as u64;
        loop {
            let bucket = &mut self.buckets[(self.current % count) as usize];
            if !bucket.is_empty() {
                self.entries -= bucket.len();
                return Some(std::mem::replace(bucket, std::mem::take(&mut self.spare)));
            }
            self.current += 1;
        }
    }

    /// Gives back what was taken, for its memory.
    pub fn give_back(&mut self, mut bucket: Vec<QueuedPost>) {
        bucket.clear();
        self.spare = bucket;
    }
}

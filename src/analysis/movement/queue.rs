//! A queue of posts by time: buckets in a ring (Dial 1969), each as wide as the shortest step takes.
//!
//! Within such a bucket hardly a post betters another, and the order within it has no effect. Where the longest step would
//! need more than [`MOST_BUCKETS`], buckets are wider; a post whose time falls is then queued again, and the times are the
//! same. A post is queued once a bucket: an entry is stale where its post was queued in another one since.

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
    /// The least time beyond the bucket that is emptied, seconds.
    emptied_to_s: f32,
    /// Whether a post was put into a bucket before its own, since that lay beyond the ring.
    has_early: bool,
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
        let per_second = 1.0 / width;
        let emptied_to_s = emptied_to_s(0, per_second);
        Self {
            buckets,
            per_second,
            current: 0,
            entries: 0,
            emptied_to_s,
            has_early: false,
            spare: Vec::new(),
        }
    }

    /// The bucket of a time, counted from time 0; never one that was emptied, nor one beyond the ring.
    #[inline]
    fn bucket_of(&self, expected_s: f32) -> u64 {
        let bucket = (f64::from(expected_s) * self.per_second) as u64;
        bucket.clamp(self.current, self.current + self.buckets.len() as u64 - 1)
    }

    /// Puts a post into the queue, in the order of when it is expected at the goal; without one, of its time. `before_s` is
    /// when it was expected before, infinite where it was not.
    #[inline]
    pub fn push(&mut self, post: QueuedPost, expected_s: f32, before_s: f32) {
        let count = self.buckets.len() as u64;
        let bucket = self.bucket_of(expected_s);
        self.has_early |= bucket == self.current + count - 1;
        // It may lie in its bucket already; in the one that is emptied, it may have been taken.
        let is_queued = before_s.is_finite() && self.bucket_of(before_s) == bucket;
        if is_queued && bucket != self.current && !self.has_early {
            return;
        }
        self.buckets[(bucket % count) as usize].push(post);
        self.entries += 1;
    }

    /// Whether an entry of the bucket that is emptied holds: its post, now expected at `expected_s`, was queued in no other.
    #[inline]
    pub fn holds(&self, entry: QueuedPost, time_s: f32, expected_s: f32) -> bool {
        entry.time_s == time_s || (f64::from(expected_s) * self.per_second) as u64 == self.current
    }

    /// The least time, seconds, of a post beyond the bucket that is emptied: those expected before it are or were in buckets
    /// that were emptied.
    #[inline]
    pub fn emptied_to_s(&self) -> f32 {
        self.emptied_to_s
    }

    /// When a bucket begins, seconds.
    pub fn start_s(&self, bucket: u64) -> f64 {
        bucket as f64 / self.per_second
    }

    /// Puts back a post that is expected beyond the bucket in which it was, since that lay beyond the ring.
    pub fn put_back(&mut self, post: QueuedPost, expected_s: f32) {
        self.push(post, expected_s, f32::INFINITY);
    }

    /// The first bucket from the one that is emptied on that has posts.
    pub fn first_bucket(&self) -> Option<u64> {
        let count = self.buckets.len() as u64;
        let has_posts = |bucket: &u64| !self.buckets[(bucket % count) as usize].is_empty();
        if self.entries == 0 { None } else { (self.current..self.current + count).find(has_posts) }
    }

    /// Takes the posts of a bucket, no earlier than any that was taken and no later than the first that has posts; posts that
    /// are pushed into it later are taken next.
    pub fn take_bucket(&mut self, bucket: u64) -> Vec<QueuedPost> {
        if bucket != self.current {
            self.current = bucket;
            self.emptied_to_s = emptied_to_s(bucket, self.per_second);
        }
        let count = self.buckets.len() as u64;
        let posts = &mut self.buckets[(bucket % count) as usize];
        self.entries -= posts.len();
        std::mem::replace(posts, std::mem::take(&mut self.spare))
    }

    /// How many posts a bucket has.
    pub fn posts_in(&self, bucket: u64) -> usize {
        self.buckets[(bucket % self.buckets.len() as u64) as usize].len()
    }

    /// Gives back what was taken, for its memory.
    pub fn give_back(&mut self, mut bucket: Vec<QueuedPost>) {
        bucket.clear();
        self.spare = bucket;
    }
}

/// The least time that lies beyond a bucket.
fn emptied_to_s(bucket: u64, per_second: f64) -> f32 {
    let is_beyond = |time_s: f32| (f64::from(time_s) * per_second) as u64 > bucket;
    let mut time_s = ((bucket + 1) as f64 / per_second) as f32;
    while time_s > 0.0 && is_beyond(time_s.next_down()) {
        time_s = time_s.next_down();
    }
    while time_s.is_finite() && !is_beyond(time_s) {
        time_s = time_s.next_up();
    }
    time_s
}

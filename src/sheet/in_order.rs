//! Several pictures at once, handed over one after the other.
//!
//! ```text
//! threads   1  2  3  4
//! picture  [1         ]      alone: what all pictures of a scene share is made, and the memory of one is known
//!          [2   ][3   ]      at once, by some of the threads each
//!          [4   ][5   ]
//!          [6         ]      what is left over is made by all threads
//! ```
//!
//! A picture of many pixels keeps all threads busy while it is drawn, but not while it is refined, labeled and written; small
//! ones never do. Each picture has a pool of its own: a thread that waits for a part of its picture would otherwise begin
//! another picture, and wait there for what it has locked itself.
//!
//! Pictures, errors and steps come in the order in which one pool would make them one by one, and pictures have the same bytes:
//! no picture depends on the number of threads.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuilder};

use sandtable_base::limits::memory::check_memory;

/// The memory in bytes that pictures take together while they are made, unless one alone takes more.
const MOST_BYTES: u64 = 1 << 30;

/// The addresses that a thread takes beside its picture: a stack, and what an allocator reserves for it.
const THREAD_BYTES: u64 = 72 << 20;

/// Is called with the name of each step as it begins.
pub type StepNote<'a> = &'a dyn Fn(&'static str);

/// Makes pictures, or what else is made on a pool, which take about as much memory each as the first.
#[allow(missing_debug_implementations, reason = "it is two functions")]
pub struct PicturesInOrder<'a, T> {
    /// How many there are.
    pub count: usize,
    /// Makes one on the current `rayon` pool, and calls what it is handed with the name of each step as it begins.
    pub make: &'a (dyn Fn(usize, StepNote<'_>) -> T + Sync),
    /// How much memory making one has taken, in bytes.
    pub bytes: &'a (dyn Fn(&T) -> u64 + Sync),
    /// Is called with the name of each step of the one that is handed over next.
    pub progress: &'a (dyn Fn(&'static str) + Sync),
}

/// How far the making is, shared by its threads.
struct SharedMaking<T> {
    making: Mutex<Making<T>>,
    changed: Condvar,
}

struct Making<T> {
    /// The next that nobody has begun.
    next: usize,
    /// The one that is handed over next.
    first: usize,
    /// Those that are made and not yet handed over.
    made: BTreeMap<usize, T>,
    /// The step of each that is being made.
    steps: BTreeMap<usize, &'static str>,
    /// Whether no other is begun.
    is_stopped: bool,
}

/// Stops the making when a thread ends, by whatever: who waits for what it makes would wait without end.
struct StopAtEnd<'a, T>(&'a SharedMaking<T>);

impl<T: Send> PicturesInOrder<'_, T> {
    /// Hands them to `take`, first to last.
    ///
    /// # Errors
    /// The first error of `take`; what comes after it is not handed over.
    pub fn each<E>(&self, mut take: impl FnMut(usize, T) -> Result<(), E>) -> Result<(), E> {
        let threads = rayon::current_num_threads();
        let mut bytes = None;
        let mut done = 0;
        while done < self.count {
            let left = self.count - done;
            let pools = bytes.map(|bytes| pools(threads, at_once(left, threads, bytes))).unwrap_or_default();
            if pools.len() > 1 {
                let end = self.count - left % pools.len();
                self.round(&pools, done..end, &mut take)?;
                done = end;
            } else {
                let made = (self.make)(done, self.progress);
                bytes = Some((self.bytes)(&made));
                take(done, made)?;
                done += 1;
            }
        }
        Ok(())
    }

    /// Makes those of a range, one at a time in each pool.
    fn round<E>(
        &self,
        pools: &[ThreadPool],
        range: Range<usize>,
        take: &mut impl FnMut(usize, T) -> Result<(), E>,
    ) -> Result<(), E> {
        let (next, first, is_stopped) = (range.start, range.start, false);
        let making = Making { next, first, made: BTreeMap::new(), steps: BTreeMap::new(), is_stopped };
        let shared = SharedMaking { making: Mutex::new(making), changed: Condvar::new() };
        let ahead = 2 * pools.len();
        with_pools(pools, &|| self.make_on(&shared, range.end, ahead), || {
            let _stop = StopAtEnd(&shared);
            for index in range.clone() {
                let Some(made) = shared.wait_for(index) else { break };
                take(index, made)?;
                self.go_on(&shared);
            }
            Ok(())
        })
    }

    /// Makes one after the other until none is left, and none that is handed over after `ahead` others.
    fn make_on(&self, shared: &SharedMaking<T>, end: usize, ahead: usize) {
        let stop = StopAtEnd(shared);
        while let Some(index) = shared.begin(end, ahead) {
            let made = (self.make)(index, &|step| {
                let mut making = shared.lock();
                making.steps.insert(index, step);
                if making.first == index {
                    (self.progress)(step);
                }
            });
            let mut making = shared.lock();
            making.steps.remove(&index);
            making.made.insert(index, made);
            shared.changed.notify_all();
        }
        // What other threads make is still waited for.
        std::mem::forget(stop);
    }

    /// Notes that one is handed over, and names the step that the next is at.
    fn go_on(&self, shared: &SharedMaking<T>) {
        let mut making = shared.lock();
        making.first += 1;
        if let Some(step) = making.steps.get(&making.first) {
            (self.progress)(step);
        }
        shared.changed.notify_all();
    }
}

impl<T> SharedMaking<T> {
    fn lock(&self) -> MutexGuard<'_, Making<T>> {
        self.making.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, making: MutexGuard<'a, Making<T>>) -> MutexGuard<'a, Making<T>> {
        self.changed.wait(making).unwrap_or_else(PoisonError::into_inner)
    }

    /// The next to make before `end`, once not too many are ahead of the one that is handed over next.
    fn begin(&self, end: usize, ahead: usize) -> Option<usize> {
        let mut making = self.lock();
        while !making.is_stopped && making.next < end && making.next >= making.first + ahead {
            making = self.wait(making);
        }
        let index = making.next;
        (!making.is_stopped && index < end).then(|| {
            making.next += 1;
            index
        })
    }

    /// The one with this number, once it is made; `None` where the making has stopped.
    fn wait_for(&self, index: usize) -> Option<T> {
        let mut making = self.lock();
        loop {
            if let Some(made) = making.made.remove(&index) {
                return Some(made);
            }
            if making.is_stopped {
                return None;
            }
            making = self.wait(making);
        }
    }
}

impl<T> Drop for StopAtEnd<'_, T> {
    fn drop(&mut self) {
        self.0.lock().is_stopped = true;
        self.0.changed.notify_all();
    }
}

/// Runs `work` in each pool, and `beside` on this thread meanwhile.
fn with_pools<R>(pools: &[ThreadPool], work: &(dyn Fn() + Sync), beside: impl FnOnce() -> R) -> R {
    match pools {
        [] => beside(),
        [pool, others @ ..] => pool.in_place_scope(|scope| {
            scope.spawn(|_| work());
            // By address: a type of closures in closures would have no end.
            with_pools(others, work, Box::new(beside) as Box<dyn FnOnce() -> R>)
        }),
    }
}

/// How many of `left` things, each of which takes `bytes`, are made at once.
fn at_once(left: usize, threads: usize, bytes: u64) -> usize {
    let most = usize::try_from(MOST_BYTES / bytes.max(1)).unwrap_or(usize::MAX);
    let mut count = left.min(threads).min(most);
    let needed = |count: usize| bytes * count as u64 + THREAD_BYTES * threads as u64;
    while count > 1 && check_memory(needed(count), "several pictures", "draw fewer").is_err() {
        count -= 1;
    }
    count
}

/// `count` pools that have `threads` threads together; fewer where the system refuses some.
fn pools(threads: usize, count: usize) -> Vec<ThreadPool> {
    if count < 2 {
        return Vec::new();
    }
    let own = |number: usize| threads / count + usize::from(number < threads % count);
    let pool = |number: usize| ThreadPoolBuilder::new().num_threads(own(number)).build().ok();
    (0..count).map_while(pool).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    /// What is handed over of `count` things, each as large as `bytes` says, made by so many threads; and the steps named.
    fn run(threads: usize, count: usize, bytes: u64, fails: usize) -> (Vec<usize>, Vec<&'static str>) {
        const STEPS: [&str; 8] = ["0", "1", "2", "3", "4", "5", "6", "7"];
        let named = Mutex::new(Vec::new());
        let making = PicturesInOrder {
            count,
            make: &|index, progress| {
                progress(STEPS[index]);
                // Later ones are done first.
                std::thread::sleep(Duration::from_millis(3 * (count - index) as u64));
                index
            },
            bytes: &|_| bytes,
            progress: &|step| named.lock().expect("whole").push(step),
        };
        let mut taken = Vec::new();
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let outcome = pool.install(|| {
            making.each(|number, made| {
                assert_eq!(number, made);
                taken.push(made);
                if made == fails { Err(made) } else { Ok(()) }
            })
        });
        assert_eq!(outcome, if fails < count { Err(fails) } else { Ok(()) });
        (taken, named.into_inner().expect("whole"))
    }

    #[test]
    fn things_are_handed_over_in_order_by_any_number_of_threads() {
        for (threads, count) in [(1, 3), (2, 0), (2, 1), (2, 2), (2, 5), (3, 6), (5, 8), (16, 8)] {
            let (taken, steps) = run(threads, count, 1, usize::MAX);
            assert_eq!(taken, (0..count).collect::<Vec<_>>(), "{threads}");
            assert!(steps.is_sorted(), "{steps:?}");
        }
    }

    #[test]
    fn nothing_is_handed_over_after_an_error() {
        for threads in [1, 2, 4] {
            assert_eq!(run(threads, 8, 1, 3).0, [0, 1, 2, 3]);
        }
    }

    #[test]
    fn large_things_are_made_one_by_one() {
        let (_, steps) = run(4, 5, MOST_BYTES, usize::MAX);
        assert_eq!(steps, ["0", "1", "2", "3", "4"]);
        assert_eq!(at_once(9, 8, MOST_BYTES / 3), 3);
        assert_eq!(at_once(9, 2, 1), 2);
        assert_eq!(at_once(1, 2, 1), 1);
    }

    #[test]
    #[should_panic(expected = "the third is wrong")]
    fn who_waits_for_one_whose_making_panics_does_not_wait_without_end() {
        let making = PicturesInOrder {
            count: 6,
            make: &|index, _| assert!(index != 2, "the third is wrong"),
            bytes: &|()| 1,
            progress: &|_| (),
        };
        let pool = ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
        let _ = pool.install(|| making.each(|_, ()| Ok::<(), ()>(())));
    }
}

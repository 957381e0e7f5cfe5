//! Work on threads of its own, so that no frame waits for it.
//!
//! A job has threads of its own for what it does in parallel, too: where it took those that all share, a frame that does a
//! little in parallel would wait until they are free.

use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use egui::Context;
use rayon::ThreadPoolBuilder;

/// Work that is being done.
pub struct WorkerJob<T> {
    done: Receiver<T>,
}

/// Work that ended without a result: a fault of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it ended without a result; please report this")]
pub struct WorkerFailure;

impl<T: Send + 'static> WorkerJob<T> {
    /// Begins to work; the window shows a frame when [`WorkerJob::poll`] has the result.
    pub fn start(context: &Context, work: impl FnOnce() -> T + Send + 'static) -> Self {
        let ((sender, done), context) = (channel(), context.clone());
        thread::spawn(move || {
            // Nobody waits for the result where the window was closed.
            let _ = sender.send(run_apart(work));
            context.request_repaint();
        });
        Self { done }
    }

    /// The result; `None` while it is being worked at.
    pub fn poll(&self) -> Option<Result<T, WorkerFailure>> {
        match self.done.try_recv() {
            Ok(result) => Some(Ok(result)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(WorkerFailure)),
        }
    }

    /// The result of the job in `slot`, which has none then; `None` where there is no job, or while it works.
    pub fn take(slot: &mut Option<Self>) -> Option<Result<T, WorkerFailure>> {
        let done = slot.as_ref()?.poll()?;
        *slot = None;
        Some(done)
    }
}

/// Does `work` with threads of its own, as many as the machine has processors.
pub fn run_apart<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let processors = thread::available_parallelism().map_or(1, usize::from);
    match ThreadPoolBuilder::new().num_threads(processors).build() {
        Ok(threads) => threads.install(work),
        // A machine that has no thread left does it on this one.
        Err(_) => work(),
    }
}

/// Frees what is large without a frame that waits for it.
pub fn drop_apart(unused: impl Send + 'static) {
    thread::spawn(move || drop(unused));
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;
    use std::time::{Duration, Instant};

    fn result_of<T: Send + 'static>(job: &WorkerJob<T>) -> Result<T, WorkerFailure> {
        let end = Instant::now() + Duration::from_secs(60);
        loop {
            match job.poll() {
                Some(result) => return result,
                None => assert!(Instant::now() < end, "nothing came of it in a minute"),
            }
            thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn a_result_arrives_and_one_who_waits_is_woken() {
        let (sender, woken) = channel();
        let context = Context::default();
        context.set_request_repaint_callback(move |_| sender.send(()).expect("awaited"));
        let job = WorkerJob::start(&context, || 6 * 7);
        assert_eq!(result_of(&job), Ok(42));
        assert!(woken.recv_timeout(Duration::from_secs(60)).is_ok());
    }

    #[test]
    fn work_that_fails_is_reported() {
        let job: WorkerJob<u32> = WorkerJob::start(&Context::default(), || panic!("a fault of the program"));
        assert_eq!(result_of(&job), Err(WorkerFailure));
    }

    #[test]
    fn a_job_goes_on_while_the_threads_that_all_share_are_taken() {
        let taken = thread::available_parallelism().map_or(1, usize::from) * 2;
        let end = Instant::now() + Duration::from_secs(5);
        // They are taken for five seconds, or until the job is done.
        let (sender, done) = channel();
        rayon::in_place_scope(|scope| {
            let is_done = std::sync::atomic::AtomicBool::new(false);
            let is_done = std::sync::Arc::new(is_done);
            for _ in 0..taken {
                let is_done = std::sync::Arc::clone(&is_done);
                scope.spawn(move |_| {
                    while Instant::now() < end && !is_done.load(std::sync::atomic::Ordering::Relaxed) {
                        thread::sleep(Duration::from_millis(1));
                    }
                });
            }
            thread::sleep(Duration::from_millis(50));
            let job = WorkerJob::start(&Context::default(), || (0..10_000u64).into_par_iter().sum::<u64>());
            while Instant::now() < end && !is_done.load(std::sync::atomic::Ordering::Relaxed) {
                if let Some(result) = job.poll() {
                    is_done.store(true, std::sync::atomic::Ordering::Relaxed);
                    sender.send(result).expect("awaited");
                }
                thread::sleep(Duration::from_millis(1));
            }
        });
        assert_eq!(done.try_recv(), Ok(Ok(49_995_000)), "it had threads of its own");
    }
}

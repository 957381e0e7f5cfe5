//! Plans of shards, as the workers of a cluster do them.

use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::PoisonError;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::{ThreadPool, ThreadPoolBuilder};
use sandtable::WorkPlan;

use crate::error::{failed, wrong_value};

/// The most threads of a shard, as the command line has it.
const MOST_THREADS: usize = 1024;

/// A plan that `sandtable plan` wrote.
#[pyclass(name = "Plan", module = "sandtable", frozen)]
pub struct PyPlan {
    plan: WorkPlan,
    folder: PathBuf,
    /// Pools that compute no shard now.
    idle: Mutex<Vec<ThreadPool>>,
}

impl PyPlan {
    /// A pool of so many threads: one that is idle, or a new one.
    fn pool(&self, threads: usize) -> PyResult<ThreadPool> {
        let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(at) = idle.iter().position(|pool| pool.current_num_threads() == threads) {
            return Ok(idle.swap_remove(at));
        }
        let made = ThreadPoolBuilder::new().num_threads(threads).build();
        made.map_err(|error| PyRuntimeError::new_err(error.to_string()))
    }
}

#[pymethods]
impl PyPlan {
    /// The plan in a folder. Raises SandtableError.
    #[staticmethod]
    fn open(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let plan = py.detach(|| WorkPlan::open(&folder)).map_err(failed)?;
        Ok(Self { plan, folder, idle: Mutex::default() })
    }

    /// What is made: "heights", "viewsheds", "atlas", "tiles" or "analysis".
    #[getter]
    fn product(&self) -> &'static str {
        self.plan.product()
    }

    /// The number of shards.
    fn __len__(&self) -> usize {
        self.plan.count()
    }

    /// Whether a shard is done, by its record and the sizes of its files.
    fn is_done(&self, py: Python<'_>, shard: usize) -> bool {
        py.detach(|| self.plan.is_done(shard))
    }

    /// Checks that the inputs are what was planned with. Raises SandtableError, which names the first that is not.
    fn check_inputs(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| self.plan.verify_inputs()).map_err(failed)
    }

    /// Does a shard on so many threads: "done", or "skipped" where it is done already. Raises SandtableError.
    #[pyo3(signature = (shard, threads = 1))]
    fn work(&self, py: Python<'_>, shard: usize, threads: usize) -> PyResult<&'static str> {
        if !(1..=MOST_THREADS).contains(&threads) {
            return Err(wrong_value(format!("threads is {threads}; give 1 to {MOST_THREADS}")));
        }
        if self.is_done(py, shard) {
            return Ok("skipped");
        }
        let pool = self.pool(threads)?;
        py.detach(|| pool.install(|| self.plan.work(shard))).map_err(failed)?;
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(pool);
        Ok("done")
    }

    /// How far the plan is, as `sandtable gather --json` says it; writes the product, to `output` or into the folder of the
    /// plan, where all shards are done. Raises SandtableError.
    #[pyo3(signature = (output = None))]
    fn gather<'py>(&self, py: Python<'py>, output: Option<PathBuf>) -> PyResult<Bound<'py, PyDict>> {
        let gathered = py.detach(|| self.plan.gather(output.as_deref())).map_err(failed)?;
        let said = PyDict::new(py);
        said.set_item("product", self.plan.product())?;
        said.set_item("shards", self.plan.count())?;
        said.set_item("done", gathered.done)?;
        said.set_item("missing", gathered.missing)?;
        said.set_item("stale", gathered.stale)?;
        let files: Vec<String> = gathered.output.iter().map(|path| path.display().to_string()).collect();
        said.set_item("output", files)?;
        Ok(said)
    }

    fn __repr__(&self) -> String {
        format!("<Plan {}: {} shards of {}>", self.folder.display(), self.plan.count(), self.plan.product())
    }
}

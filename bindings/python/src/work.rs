//! Long work: off the interpreter, with progress, and ended by an interrupt or by what a progress function raises.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How often an interrupt is looked for.
const LOOK: Duration = Duration::from_millis(50);

/// What unwinds the work once it is to end: no panic, nothing is printed of it.
struct Stopped;

/// Tells a Python function of progress, and ends the work at the next report once that is asked for.
#[derive(Clone)]
pub(crate) struct Teller {
    progress: Option<Arc<Py<PyAny>>>,
    raised: Arc<Mutex<Option<PyErr>>>,
    stop: Arc<AtomicBool>,
}

impl Teller {
    pub(crate) fn new(progress: Option<Py<PyAny>>) -> Self {
        Self { progress: progress.map(Arc::new), raised: Arc::default(), stop: Arc::default() }
    }

    /// Tells what is being done and its share of the whole, 0 to 1.
    pub(crate) fn tell(&self, what: &str, share: f64) {
        let called = match &self.progress {
            // Not where the interpreter is going down.
            Some(progress) if !self.stopped() => Python::try_attach(|py| progress.call1(py, (what, share)).map(drop)),
            _ => None,
        };
        if let Some(Err(error)) = called {
            self.stop.store(true, Ordering::Relaxed);
            if let Ok(mut raised) = self.raised.lock() {
                raised.get_or_insert(error);
            }
        }
        if self.stopped() {
            resume_unwind(Box::new(Stopped));
        }
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Does the work on a thread of its own with the interpreter free. An interrupt is raised at once; the work ends at its next
    /// report of progress, and what it would have found is dropped.
    pub(crate) fn run<T: Send + 'static>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&Self) -> T + Send + 'static,
    ) -> PyResult<T> {
        let (done, ended) = channel();
        let teller = self.clone();
        thread::spawn(move || {
            // Nobody waits any longer where an interrupt has come.
            let _ = done.send(catch_unwind(AssertUnwindSafe(|| work(&teller))));
        });
        // A receiver is not shared between threads; here one thread at a time has it.
        let ended = Mutex::new(ended);
        loop {
            let next = py.detach(|| {
                let ended = ended.lock().map_err(|_| RecvTimeoutError::Disconnected)?;
                ended.recv_timeout(LOOK)
            });
            match next {
                Ok(Ok(found)) => return Ok(found),
                Ok(Err(payload)) => return Err(self.why(payload)),
                Err(RecvTimeoutError::Timeout) => py.check_signals().inspect_err(|_| {
                    self.stop.store(true, Ordering::Relaxed);
                })?,
                Err(RecvTimeoutError::Disconnected) => return Err(PyRuntimeError::new_err("the work was lost")),
            }
        }
    }

    /// Why the work ended early: what its progress function raised, or a fault of the library.
    fn why(&self, payload: Box<dyn Any + Send>) -> PyErr {
        if payload.is::<Stopped>()
            && let Ok(mut raised) = self.raised.lock()
            && let Some(error) = raised.take()
        {
            return error;
        }
        resume_unwind(payload)
    }
}

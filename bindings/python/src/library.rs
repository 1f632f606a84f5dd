//! The library's commands: what the command line writes as JSON, as text that the Python side reads.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Instant;

use pyo3::prelude::*;
use shakedown::closed_loop::trial::{Seen, Setup, Trial};
use shakedown::closed_loop::twin::Twin;
use shakedown::diagnose::Options;
use shakedown::identify::answer;
use shakedown::identify::outcome;
use shakedown::motion::fit::answer::Answer;
use shakedown::motion::fit::method::{Method, modify};
use shakedown::motion::fit::named::PREVIEW;
use shakedown::motion::fit::{Limits, Norm};
use shakedown::plant::sensors::SensorModel;
use shakedown::recording::Experiment;

use crate::motion::{PyMotion, PyRecord, array};
use crate::said;
use crate::settings::PySettings;

/// Calls a Python function from whichever thread tells of progress; what it raises is kept.
struct Teller {
    progress: Option<Py<PyAny>>,
    raised: Mutex<Option<PyErr>>,
}

impl Teller {
    fn new(progress: Option<Py<PyAny>>) -> Self {
        Self { progress, raised: Mutex::new(None) }
    }

    fn tell(&self, what: &str, share: f64) {
        Python::attach(|py| {
            let called = self.progress.as_ref().map_or(Ok(()), |progress| progress.call1(py, (what, share)).map(drop));
            if let Err(error) = called.and_then(|()| py.check_signals())
                && let Ok(mut raised) = self.raised.lock()
            {
                raised.get_or_insert(error);
            }
        });
    }

    /// What was raised meanwhile.
    fn end(self) -> PyResult<()> {
        self.raised.into_inner().ok().flatten().map_or(Ok(()), Err)
    }
}

fn load(path: &Path) -> PyResult<Experiment> {
    Experiment::load(path).map_err(said)
}

/// Where model and recordings part: the command line's JSON without what it says of itself and of the files.
///
/// `progress` is called with what is being done and a share of the whole; what it raises is raised when the work has ended.
#[pyfunction]
#[pyo3(signature = (path, progress = None))]
pub(crate) fn diagnose(py: Python<'_>, path: PathBuf, progress: Option<Py<PyAny>>) -> PyResult<String> {
    let experiment = load(&path)?;
    let teller = Teller::new(progress);
    let say = |what: &str, share: f64| teller.tell(what, share);
    let examined = py.detach(|| shakedown::diagnose::diagnose(&experiment, &Options { progress: Some(&say) }));
    teller.end()?;
    serde_json::to_string(&examined.map_err(said)?.diagnosis).map_err(said)
}

/// A model fitted to recordings, with error bars: the same of `shakedown identify`.
#[pyfunction]
pub(crate) fn identify(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    let experiment = load(&path)?;
    let found = py.detach(|| outcome::identify(&experiment)).map_err(said)?;
    Ok(answer::value(&found).to_string())
}

/// A record fitted to limits: the same of `shakedown modify`, and the motion that came out.
#[pyfunction]
#[pyo3(signature = (record, method, velocity, stroke, acceleration, jerk, stall, preview, as_is))]
#[allow(clippy::too_many_arguments, reason = "the Python side names them")]
pub(crate) fn fit_record(
    py: Python<'_>,
    record: &PyRecord,
    method: &str,
    velocity: f64,
    stroke: f64,
    acceleration: Option<f64>,
    jerk: Option<f64>,
    stall: Option<f64>,
    preview: Option<f64>,
    as_is: bool,
) -> PyResult<(String, PyMotion)> {
    let method = match method {
        "convex" => Method::Convex(Norm::Two),
        "taut" => Method::Taut,
        "clip" => Method::Clip,
        "causal" => Method::Causal,
        "preview" => Method::Preview(preview.unwrap_or(PREVIEW)),
        other => return Err(said(format!("method {other}: expected convex, taut, clip, causal or preview"))),
    };
    if !matches!(method, Method::Convex(_)) && (acceleration.is_some() || jerk.is_some() || stall.is_some()) {
        return Err(said("acceleration, jerk and stall are limits that only method convex keeps"));
    }
    let limits = Limits { acceleration, jerk, stall, ..Limits::table(velocity, stroke) };
    let motion = record.conditioned(as_is)?;
    py.detach(|| {
        let begin = Instant::now();
        let modified = modify(&motion, &limits, method, |_| {}).map_err(said)?;
        let seconds = begin.elapsed().as_secs_f64();
        let clipped = modify(&motion, &limits, Method::Clip, |_| {}).map_err(said)?.motion;
        let answer = Answer {
            name: record.0.name.clone(),
            conditioning: PyRecord::conditioning(as_is),
            method,
            limits,
            motion,
            modified,
            clipped,
            relaxations: Vec::new(),
            target: None,
            seconds,
            drive: Vec::new(),
        };
        Ok((answer.json().map_err(said)?.to_string(), PyMotion(answer.modified.motion)))
    })
}

/// A run of the closed loop: arrays by name, and how near the table came to the motion.
#[pyfunction]
#[pyo3(signature = (motion, settings, table))]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    motion: &PyMotion,
    settings: &PySettings,
    table: Option<PathBuf>,
) -> PyResult<(Bound<'py, pyo3::types::PyDict>, String)> {
    settings.0.validate().map_err(said)?;
    let table = table.map_or_else(|| Ok(Twin::default()), |path| Twin::load(&path)).map_err(said)?;
    let setup = Setup { settings: settings.0, table, sensors: SensorModel::default(), steps: 10 };
    let trial = py.detach(|| setup.play(&motion.0)).map_err(said)?;
    let arrays = pyo3::types::PyDict::new(py);
    let trace = &trial.trace;
    for (name, values) in [
        ("reference", &trace.reference),
        ("commanded", &trace.commanded),
        ("command", &trace.command),
        ("displacement", &trace.displacement),
        ("velocity", &trace.velocity),
        ("acceleration", &trace.acceleration),
    ] {
        arrays.set_item(name, array(py, values)?)?;
    }
    Ok((arrays, scores(&trial)?))
}

fn scores(trial: &Trial) -> PyResult<String> {
    let scores = trial.scores(Seen::Truly, None).map_err(said)?;
    let against = &scores.against_wanted;
    let value = serde_json::json!({
        "dt": trial.trace.dt,
        "e_a": against.e_a.ratio,
        "e_d": against.e_d.ratio,
        "saturated_s": scores.saturated_s,
    });
    Ok(value.to_string())
}

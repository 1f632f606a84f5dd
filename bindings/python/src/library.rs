//! The library's commands: what the command line writes as JSON, as text that the Python side reads.

use std::path::PathBuf;
use std::time::Instant;

use pyo3::prelude::*;
use shakedown::blocks::closed_loop::bode::{self, Grid};
use shakedown::blocks::closed_loop::design::{Demand, Spread, Table, answer as design_answer};
use shakedown::blocks::plant::sensors::SensorModel;
use shakedown::diagnose::Options;
use shakedown::fit::{Answer, Compared, Limits, Method, Norm, PREVIEW, modify};
use shakedown::identify::{answer, identify as identify_with};
use shakedown::recording::{Experiment, Model};
use shakedown::simulate::{ScoredSignal, Setup, Trial, Twin};

use crate::motion::{PyMotion, PyRecord, array};
use crate::said;
use crate::settings::PySettings;
use crate::work::Teller;

/// Control rate of a sweep, Hz: that of the command line.
const SWEEP_RATE: f64 = 1000.0;

/// Where model and recordings part: the command line's JSON without what it says of itself and of the files.
///
/// `progress` is called with what is being done and a share of the whole; what it raises ends the work.
#[pyfunction]
#[pyo3(signature = (path, progress = None))]
pub(crate) fn diagnose(py: Python<'_>, path: PathBuf, progress: Option<Py<PyAny>>) -> PyResult<String> {
    let examined = Teller::new(progress).run(py, move |teller| {
        let experiment = Experiment::load(&path).map_err(|e| e.to_string())?;
        let say = |what: &str, share: f64| teller.tell(what, share);
        let options = Options { progress: Some(&say) };
        let examined = shakedown::diagnose::diagnose(&experiment, &options).map_err(|e| e.to_string())?;
        serde_json::to_string(&examined.diagnosis).map_err(|e| e.to_string())
    })?;
    examined.map_err(said)
}

/// A model fitted to recordings, with error bars: the same of `shakedown identify`.
#[pyfunction]
pub(crate) fn identify(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    let found = Teller::new(None).run(py, move |_| {
        let experiment = Experiment::load(&path).map_err(|e| e.to_string())?;
        identify_with(&experiment).map(|found| answer(&found).to_string()).map_err(|e| e.to_string())
    })?;
    found.map_err(said)
}

/// A record fitted to limits: the same of `shakedown modify`, and the motion that came out.
#[pyfunction]
#[pyo3(signature = (record, method, velocity, stroke, acceleration, jerk, stall, preview, as_is, progress))]
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
    progress: Option<Py<PyAny>>,
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
    let (name, conditioning) = (record.0.name.clone(), PyRecord::conditioning(as_is));
    let fitted = Teller::new(progress).run(py, move |teller| {
        let begin = Instant::now();
        // How far a convex program has come is not known beforehand.
        let tell = |what: &str| teller.tell(what, f64::NAN);
        let modified = modify(&motion, &limits, method, tell).map_err(|e| e.to_string())?;
        let seconds = begin.elapsed().as_secs_f64();
        let clipped = modify(&motion, &limits, Method::Clip, |_| {}).map_err(|e| e.to_string())?.motion;
        let compared = Compared::new(&motion, &modified.motion, &clipped).map_err(|e| e.to_string())?;
        let answer = Answer {
            name,
            conditioning,
            method,
            limits,
            motion,
            modified,
            clipped,
            compared,
            relaxations: Vec::new(),
            target: None,
            seconds,
            drive: Vec::new(),
        };
        let figures = answer.json().to_string();
        Ok::<_, String>((figures, PyMotion(answer.modified.motion)))
    })?;
    fitted.map_err(said)
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
    let scores = trial.scores(ScoredSignal::Truly, None).map_err(said)?;
    let against = &scores.against_wanted;
    let value = serde_json::json!({
        "dt": trial.trace.dt,
        "e_a": against.e_a.ratio,
        "e_d": against.e_d.ratio,
        "saturated_s": scores.saturated_s,
    });
    Ok(value.to_string())
}

/// Bode diagrams of the displacement loop around the paper's plant: the part `bode` of `shakedown sweep`.
#[pyfunction]
#[pyo3(signature = (gains, amplitudes, frequencies, progress = None))]
pub(crate) fn sweep(
    py: Python<'_>,
    gains: Vec<(f64, f64)>,
    amplitudes: Vec<f64>,
    frequencies: Vec<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    if let Some((kp, ki)) = gains.iter().find(|&&pair| !bode::settles(pair)) {
        return Err(said(format!(
            "gains {kp},{ki}: the loop is not stable with them; expected Kp above zero, Ki zero or more"
        )));
    }
    let inside = |values: &[f64], most: f64| !values.is_empty() && values.iter().all(|v| *v > 0.0 && *v <= most);
    if !inside(&amplitudes, 1.0) {
        return Err(said("amplitudes: expected amplitudes above 0 and at most 1 m, for instance [0.001, 0.01]"));
    }
    if !inside(&frequencies, SWEEP_RATE / 20.0) || frequencies.windows(2).any(|two| two[0] >= two[1]) {
        return Err(said(
            "frequencies: expected ascending frequencies above 0 and at most 50 Hz, for instance [0.5, 1.0]",
        ));
    }
    let grid = Grid { amplitudes, frequencies };
    let swept = Teller::new(progress).run(py, move |teller| {
        let mut all = Vec::new();
        for (k, &pair) in gains.iter().enumerate() {
            teller.tell(&format!("gains {},{}", pair.0, pair.1), k as f64 / gains.len() as f64);
            let curves = bode::displacement_loop(pair, SWEEP_RATE, &grid, || {}).map_err(|e| e.to_string())?;
            let curves: Vec<_> = curves.iter().map(bode::Curve::json).collect();
            all.push(serde_json::json!({"kp": pair.0, "ki": pair.1, "curves": curves}));
        }
        Ok::<_, String>(serde_json::Value::from(all).to_string())
    })?;
    swept.map_err(said)
}

/// Gains of the tracking law from a model and its uncertainty, margins first: the JSON of `shakedown design`, and the settings.
#[pyfunction]
#[pyo3(signature = (path, spread, margins, rate, progress = None))]
pub(crate) fn design(
    py: Python<'_>,
    path: PathBuf,
    spread: f64,
    margins: (f64, f64),
    rate: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, PySettings)> {
    for (name, value, low, high) in [
        ("spread", spread, 0.0, 0.95),
        ("gain_margin", margins.0, 0.0, 40.0),
        ("phase_margin", margins.1, 0.0, 90.0),
        ("rate", rate, 200.0, 20_000.0),
    ] {
        if !(low..=high).contains(&value) {
            return Err(said(format!("{name} {value}: expected {low} to {high}")));
        }
    }
    let designed = Teller::new(progress).run(py, move |teller| {
        let refuse = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
        let model = Model::load(&path).map_err(|e| e.to_string())?;
        let (table, unused) = Table::from_model(&model).map_err(|e| refuse(&e))?;
        let demand = Demand { margins, spread: Spread::stated(&model, spread), rate };
        let tell = |bandwidth: f64, disturbance: f64| {
            teller.tell(&format!("feedback of {bandwidth:.1} Hz, disturbances up to {disturbance:.0} Hz"), f64::NAN);
        };
        let found = shakedown::blocks::closed_loop::design::design(&table, &demand, tell).map_err(|e| refuse(&e))?;
        Ok::<_, String>((design_answer::json(&found, &demand, &unused).to_string(), PySettings(found.settings)))
    })?;
    designed.map_err(said)
}

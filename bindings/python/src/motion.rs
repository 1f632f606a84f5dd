//! Records and motions, their arrays as NumPy's.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use shakedown::fit::read::{Options, record};
use shakedown::fit::{Motion, Recipe, Record};

use crate::said;

/// Numbers as an array of NumPy that cannot be written to.
pub(crate) fn array<'py>(py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyAny>> {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    py.import("numpy")?.call_method1("frombuffer", (PyBytes::new(py, &bytes), "<f8"))
}

/// A ground-motion record, as its file has it, SI.
#[pyclass(name = "Record", module = "shakedown_table", frozen)]
#[derive(Debug)]
pub(crate) struct PyRecord(pub(crate) Record);

#[pymethods]
impl PyRecord {
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Sampling interval, s.
    #[getter]
    fn dt(&self) -> f64 {
        self.0.dt
    }

    /// Ground acceleration, m/s2.
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, &self.0.acceleration)
    }

    /// What the header states, in its order.
    #[getter]
    fn facts(&self) -> Vec<(String, String)> {
        self.0.facts.iter().map(|fact| (fact.key.to_string(), fact.value.clone())).collect()
    }

    /// The motion: with rest before and after and what is below 0.1 Hz taken out, or as it is.
    #[pyo3(signature = (*, as_is = false))]
    fn motion(&self, as_is: bool) -> PyResult<PyMotion> {
        self.conditioned(as_is).map(PyMotion)
    }

    fn __repr__(&self) -> String {
        format!("Record({:?}, {} samples at {} s)", self.0.name, self.0.acceleration.len(), self.0.dt)
    }
}

impl PyRecord {
    pub(crate) fn conditioned(&self, as_is: bool) -> PyResult<Motion> {
        let steps = if as_is { Vec::new() } else { Recipe::specimen(self.0.dt).steps };
        Recipe { steps }.apply(&self.0).map_err(said)
    }

    pub(crate) fn conditioning(as_is: bool) -> String {
        if as_is { "nothing else done to the record".into() } else { Recipe::SPECIMEN.into() }
    }
}

/// A motion: displacement, velocity and acceleration at even times, SI.
#[pyclass(name = "Motion", module = "shakedown_table", frozen)]
#[derive(Debug)]
pub(crate) struct PyMotion(pub(crate) Motion);

#[pymethods]
impl PyMotion {
    /// Sampling interval, s.
    #[getter]
    fn dt(&self) -> f64 {
        self.0.dt
    }

    /// Displacement, m.
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, &self.0.displacement)
    }

    /// Velocity, m/s.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, &self.0.velocity)
    }

    /// Acceleration, m/s2.
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, &self.0.acceleration)
    }
}

/// Reads a record.
#[pyfunction]
#[pyo3(signature = (path, dt, unit, channel))]
pub(crate) fn read_record(
    py: Python<'_>,
    path: PathBuf,
    dt: Option<f64>,
    unit: Option<&str>,
    channel: Option<&str>,
) -> PyResult<PyRecord> {
    let unit = unit.map(str::parse).transpose().map_err(|error| said(format!("unit: {error}")))?;
    let channel = channel.map_or_else(Default::default, |name| {
        let Ok(channel) = name.parse();
        channel
    });
    let options = Options { dt, unit, channel, ..Options::default() };
    py.detach(|| record(&path, &options)).map(PyRecord).map_err(said)
}

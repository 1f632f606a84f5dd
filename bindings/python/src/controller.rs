//! The controller: one sample in, one command out; or a whole run at once.

use numpy::{PyReadonlyArray1, PyReadwriteArray1};
use pyo3::prelude::*;
use shakedown_core::host::{self, code};
use shakedown_core::{Command, Controller, Relay, Sample, Settings};

use crate::refused;
use crate::settings::PySettings;

/// What sensors and reference say at one tick, SI. Its numbers may be set anew for the next: one object serves a whole run.
#[pyclass(name = "Sample", module = "shakedown_table", get_all, set_all)]
#[derive(Debug, Clone, Copy)]
pub(crate) struct PySample {
    reference: f32,
    displacement: f32,
    acceleration: f32,
    external: f32,
    velocity: f32,
    pressure_difference: f32,
    reference_velocity: f32,
    reference_acceleration: f32,
    second_displacement: f32,
    limit_switch: bool,
    relay_closed: bool,
}

#[pymethods]
impl PySample {
    #[new]
    #[pyo3(signature = (
        reference = 0.0, displacement = 0.0, acceleration = 0.0, *, external = 0.0, velocity = 0.0,
        pressure_difference = 0.0, reference_velocity = 0.0, reference_acceleration = 0.0, second_displacement = 0.0,
        limit_switch = false, relay_closed = false
    ))]
    #[allow(clippy::too_many_arguments, reason = "one for each field, all of them by name")]
    #[allow(clippy::fn_params_excessive_bools, reason = "the same")]
    fn new(
        reference: f32,
        displacement: f32,
        acceleration: f32,
        external: f32,
        velocity: f32,
        pressure_difference: f32,
        reference_velocity: f32,
        reference_acceleration: f32,
        second_displacement: f32,
        limit_switch: bool,
        relay_closed: bool,
    ) -> Self {
        Self {
            reference,
            displacement,
            acceleration,
            external,
            velocity,
            pressure_difference,
            reference_velocity,
            reference_acceleration,
            second_displacement,
            limit_switch,
            relay_closed,
        }
    }

    fn __repr__(&self) -> String {
        format!("{self:?}").replacen("PySample", "Sample", 1)
    }
}

impl From<&PySample> for Sample {
    fn from(p: &PySample) -> Self {
        Self {
            reference: p.reference,
            displacement: p.displacement,
            acceleration: p.acceleration,
            external: p.external,
            velocity: p.velocity,
            pressure_difference: p.pressure_difference,
            reference_velocity: p.reference_velocity,
            reference_acceleration: p.reference_acceleration,
            second_displacement: p.second_displacement,
            limit_switch: p.limit_switch,
            relay_closed: p.relay_closed,
        }
    }
}

/// What the valve is told, and what happened.
#[pyclass(name = "Command", module = "shakedown_table", frozen)]
#[derive(Debug, Clone, Copy)]
pub(crate) struct PyCommand {
    command: Command,
    changes: u8,
}

const STATES: [&str; 6] = ["off", "ready", "running", "hold", "ramp-down", "tripped"];

#[pymethods]
impl PyCommand {
    #[getter]
    fn valve(&self) -> f32 {
        self.command.valve
    }

    #[getter]
    fn reference(&self) -> f32 {
        self.command.reference
    }

    #[getter]
    fn velocity_limit(&self) -> f32 {
        self.command.status.velocity_limit
    }

    #[getter]
    fn state(&self) -> &'static str {
        STATES.get(self.command.status.state as usize).copied().unwrap_or_default()
    }

    #[getter]
    fn trip(&self) -> u8 {
        self.command.status.trip.map_or(0, |trip| trip as u8)
    }

    #[getter]
    fn relay_closed(&self) -> bool {
        self.command.status.relay == Relay::Closed
    }

    #[getter]
    fn saturated(&self) -> bool {
        self.command.status.saturated
    }

    #[getter]
    fn held(&self) -> bool {
        self.command.status.held
    }

    #[getter]
    fn limited(&self) -> bool {
        self.command.status.limited
    }

    #[getter]
    fn missing(&self) -> u8 {
        self.command.status.missing.bits()
    }

    #[getter]
    fn changes(&self) -> u8 {
        self.changes
    }

    fn __repr__(&self) -> String {
        let status = &self.command.status;
        format!("Command(valve={}, reference={}, state={:?})", self.command.valve, self.command.reference, status.state)
    }
}

/// Bytes of a sample and of a command in a run: nine f32 and a u32 of flags; three f32 and a u32 of status.
const SAMPLE: usize = 40;
const COMMAND: usize = 16;

/// One tick of a run.
fn stepped(controller: &mut Controller, bytes: &[u8; SAMPLE]) -> [u8; COMMAND] {
    let words = bytes.as_chunks::<4>().0;
    let mut numbers = [0.0; 9];
    for (number, word) in numbers.iter_mut().zip(words) {
        *number = f32::from_le_bytes(*word);
    }
    let flags = words.last().map_or(0, |word| u32::from_le_bytes(*word));
    let command = controller.step(&host::sample(&numbers, flags));
    let numbers = [command.valve, command.reference, command.status.velocity_limit].map(f32::to_le_bytes);
    let mut place = [0; COMMAND];
    for (place, word) in place.as_chunks_mut::<4>().0.iter_mut().zip(numbers) {
        *place = word;
    }
    if let Some(last) = place.as_chunks_mut::<4>().0.last_mut() {
        *last = host::status(&command, controller.changes()).to_le_bytes();
    }
    place
}

/// The control core. With a guard it is off, and moves nothing before it is armed and started.
#[pyclass(name = "Controller", module = "shakedown_table", subclass)]
#[derive(Debug)]
pub(crate) struct PyController(Controller);

#[pymethods]
impl PyController {
    #[new]
    #[pyo3(signature = (settings = None))]
    fn new(py: Python<'_>, settings: Option<&PySettings>) -> PyResult<Self> {
        let settings = settings.map_or_else(Settings::default, |settings| settings.0);
        let refusal = |error| refused(py, host::settings_code(&error), error.to_string());
        Controller::new(&settings).map(Self).map_err(refusal)
    }

    /// Exchanges the settings between two ticks, whole or not at all.
    fn retune(&mut self, py: Python<'_>, settings: &PySettings) -> PyResult<()> {
        let refusal = |error| refused(py, host::settings_code(&error), error.to_string());
        self.0.retune(&settings.0).map_err(refusal)
    }

    /// Asks for a change of state.
    fn request(&mut self, py: Python<'_>, request: &str) -> PyResult<()> {
        const NAMES: [&str; 8] = ["arm", "start", "hold", "resume", "stop", "off", "reset", "trip"];
        let number = NAMES.iter().position(|name| *name == request).unwrap_or(NAMES.len());
        let answer = host::request(&mut self.0, number as u32);
        let meaning = match answer {
            code::OK => return Ok(()),
            code::REFUSED_STATE => format!("{request}: does not apply in state {}", self.state()),
            code::REFUSED_MOVING => format!("{request}: the safe ramp after the trip has not ended"),
            code::REFUSED_CAUSE => format!("{request}: the guard sees a reason to trip already"),
            code::REFUSED_NO_GUARD => format!("{request}: there is no guard, and so nothing to ask"),
            _ => format!("{request}: expected one of {}", NAMES.join(", ")),
        };
        Err(refused(py, answer, meaning))
    }

    /// One tick.
    fn step(&mut self, sample: &PySample) -> PyCommand {
        let command = self.0.step(&sample.into());
        PyCommand { command, changes: self.0.changes() }
    }

    /// A run: samples as bytes in, commands as bytes out, neither copied, the interpreter free meanwhile.
    fn _steps(
        &mut self,
        py: Python<'_>,
        samples: PyReadonlyArray1<'_, u8>,
        mut commands: PyReadwriteArray1<'_, u8>,
    ) -> PyResult<()> {
        let wrong = |what: &str| refused(py, code::WRONG_VALUE, what.to_owned());
        let Ok((samples, [])) = samples.as_slice().map(<[u8]>::as_chunks::<SAMPLE>) else {
            return Err(wrong("samples: expected whole samples, side by side"));
        };
        let Ok((commands, [])) = commands.as_slice_mut().map(<[u8]>::as_chunks_mut::<COMMAND>) else {
            return Err(wrong("commands: expected room for whole commands, side by side"));
        };
        if samples.len() != commands.len() {
            return Err(wrong("expected room for one command a sample"));
        }
        let controller = &mut self.0;
        py.detach(|| {
            for (bytes, place) in samples.iter().zip(commands) {
                *place = stepped(controller, bytes);
            }
        });
        Ok(())
    }

    /// Where the test stands.
    #[getter]
    fn state(&self) -> &'static str {
        STATES.get(self.0.state() as usize).copied().unwrap_or_default()
    }
}

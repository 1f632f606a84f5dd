//! The Python package's native part: the controller of the core, and the library's commands as functions that give what the
//! command line writes as JSON.

mod controller;
mod library;
mod motion;
mod settings;
mod work;

use pyo3::prelude::*;

pyo3::create_exception!(
    shakedown_table,
    ShakedownError,
    pyo3::exceptions::PyValueError,
    "What the core or the library refuses, in the command line's words. Of the core, `code` is the C interface's number."
);

/// The module.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("ShakedownError", module.py().get_type::<ShakedownError>())?;
    module.add_class::<settings::PySettings>()?;
    module.add_class::<controller::PySample>()?;
    module.add_class::<controller::PyCommand>()?;
    module.add_class::<controller::PyController>()?;
    module.add_class::<motion::PyRecord>()?;
    module.add_class::<motion::PyMotion>()?;
    module.add_function(wrap_pyfunction!(motion::read_record, module)?)?;
    module.add_function(wrap_pyfunction!(library::fit_record, module)?)?;
    module.add_function(wrap_pyfunction!(library::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(library::sweep, module)?)?;
    module.add_function(wrap_pyfunction!(library::design, module)?)?;
    module.add_function(wrap_pyfunction!(library::identify, module)?)?;
    module.add_function(wrap_pyfunction!(library::diagnose, module)?)?;
    Ok(())
}

/// An error of the library, in its words.
fn said(error: impl std::fmt::Display) -> PyErr {
    ShakedownError::new_err(error.to_string())
}

/// An error of the core with its number.
fn refused(py: Python<'_>, code: i32, message: String) -> PyErr {
    let error = ShakedownError::new_err(message);
    match error.value(py).setattr("code", code) {
        Ok(()) => error,
        Err(other) => other,
    }
}

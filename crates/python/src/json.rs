//! Values of Python as JSON and back, in which files and functions of the crates below take what has many fields.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use serde_json::Value;

/// The JSON of the keyword arguments `fields`. Arrays become lists, an infinite number "inf".
///
/// # Errors
/// A value has no JSON, such as NaN.
pub fn json_from_fields(fields: Option<&Bound<'_, PyDict>>) -> PyResult<Value> {
    let entries = fields.into_iter().flatten();
    let entries =
        entries.map(|(name, value)| Ok((name.extract::<String>()?, json_from_python(&name, &value)?)));
    Ok(Value::Object(entries.collect::<PyResult<_>>()?))
}

fn json_from_python(field: &Bound<'_, PyAny>, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    let unusable = || {
        let what = "is no number, text, list or dict of such (give one of them)";
        PyValueError::new_err(format!("{field}: {} {what}", value.get_type()))
    };
    if value.is_none() {
        return Ok(Value::Null);
    }
    // Arrays and numbers of NumPy.
    if let Ok(plain) = value.call_method0("tolist") {
        return json_from_python(field, &plain);
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.to_string()));
    }
    if let Ok(is) = value.extract::<bool>() {
        return Ok(Value::Bool(is));
    }
    if let Ok(whole) = value.extract::<i64>() {
        return Ok(whole.into());
    }
    if let Ok(number) = value.extract::<f64>() {
        return match serde_json::Number::from_f64(number) {
            Some(number) => Ok(Value::Number(number)),
            None if number == f64::INFINITY => Ok(Value::String("inf".into())),
            None => {
                Err(PyValueError::new_err(format!("{field}: {number} cannot be used (give a finite number)")))
            }
        };
    }
    if let Ok(dict) = value.cast::<PyDict>() {
        return json_from_fields(Some(dict));
    }
    let items = value.try_iter().map_err(|_| unusable())?;
    items.map(|item| json_from_python(field, &item?)).collect::<PyResult<Vec<_>>>().map(Value::Array)
}

/// The object of Python for a JSON value.
///
/// # Errors
/// None for JSON; those of Python's own parser.
pub fn python_from_json<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (value.to_string(),))
}

//! Where a muscle comes from: a dict, a name, a file or the text of one.

use crate::errors::{muscle_file, refused, wrong_type};
use host_sim::fit::Start;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// The muscle of a dict with the keys of a muscle file, of a file, or of a name.
pub fn muscle(source: &Bound<'_, PyAny>) -> PyResult<Start> {
    if let Ok(dict) = source.cast::<PyDict>() {
        let mut table = table("muscle", dict)?;
        table.entry("name").or_insert_with(|| Value::String("muscle".to_owned()));
        let text = toml::to_string(&table).map_err(|error| {
            refused("muscle", "dict", &format!("must have the keys of a muscle file: {error}"))
        })?;
        return text_of_muscle(&text, "dict");
    }
    let path: PathBuf = source.extract().map_err(|_| {
        let found = source.get_type().to_string();
        wrong_type("muscle", &found, "a name, the path of a muscle file, or a dict")
    })?;
    Start::read(&path).map_err(muscle_file)
}

/// The muscle of a muscle file's text; `name` is for the messages.
pub fn text_of_muscle(text: &str, name: &str) -> PyResult<Start> {
    Start::parse(text, Path::new(name)).map_err(muscle_file)
}

/// A dict as a table of TOML; `name` is for the messages.
pub fn table(name: &str, dict: &Bound<'_, PyDict>) -> PyResult<Table> {
    dict.iter()
        .map(|(key, item)| {
            let Ok(key) = key.extract::<String>() else {
                return Err(wrong_type(name, "a dict with other keys", "a dict of names"));
            };
            let value = value(&format!("{name}.{key}"), &item)?;
            Ok((key, value))
        })
        .collect()
}

fn value(name: &str, item: &Bound<'_, PyAny>) -> PyResult<Value> {
    // A bool is an int to Python.
    if let Ok(flag) = item.cast::<PyBool>() {
        return Ok(Value::Boolean(flag.is_true()));
    }
    if item.cast::<PyInt>().is_ok() {
        return Ok(Value::Integer(item.extract()?));
    }
    if item.cast::<PyFloat>().is_ok() {
        return Ok(Value::Float(item.extract()?));
    }
    if item.cast::<PyString>().is_ok() {
        return Ok(Value::String(item.extract()?));
    }
    if let Ok(dict) = item.cast::<PyDict>() {
        return Ok(Value::Table(table(name, dict)?));
    }
    // NumPy's scalars and arrays as Python's.
    if item.hasattr("tolist")? {
        return value(name, &item.call_method0("tolist")?);
    }
    let items = item.try_iter().map_err(|_| {
        wrong_type(name, &item.get_type().to_string(), "a number, text, list or dict")
    })?;
    let items = items.enumerate().map(|(index, item)| value(&format!("{name}[{index}]"), &item?));
    Ok(Value::Array(items.collect::<PyResult<_>>()?))
}

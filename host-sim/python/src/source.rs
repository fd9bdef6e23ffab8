//! Where a muscle comes from: a dict, a name, a file or the text of one.

use crate::errors::{muscle_file, refused, wrong_type};
use host_sim::fit::Start;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
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
    table_at(name, dict, 1)
}

fn table_at(name: &str, dict: &Bound<'_, PyDict>, level: usize) -> PyResult<Table> {
    dict.iter()
        .map(|(key, item)| {
            let Ok(key) = key.extract::<String>() else {
                return Err(wrong_type(name, "a dict with other keys", "a dict of names"));
            };
            let value = value(&format!("{name}.{key}"), &item, level + 1)?;
            Ok((key, value))
        })
        .collect()
}

/// Levels of dicts and lists. No file needs half as many; what contains itself has no end of them.
const MOST_LEVELS: usize = 16;

fn value(name: &str, item: &Bound<'_, PyAny>, level: usize) -> PyResult<Value> {
    if level > MOST_LEVELS {
        let limit = format!("must be dicts and lists of at most {MOST_LEVELS} levels");
        return Err(refused(name, &format!("{level} levels"), &limit));
    }
    // A bool is an int to Python.
    if let Ok(flag) = item.cast::<PyBool>() {
        return Ok(Value::Boolean(flag.is_true()));
    }
    if item.cast::<PyInt>().is_ok() {
        let whole = item.extract().map_err(|_| {
            refused(name, &item.to_string(), "must be a whole number of at most 64 bits")
        });
        return whole.map(Value::Integer);
    }
    if item.cast::<PyFloat>().is_ok() {
        return Ok(Value::Float(item.extract()?));
    }
    if item.cast::<PyString>().is_ok() {
        return Ok(Value::String(item.extract()?));
    }
    if let Ok(dict) = item.cast::<PyDict>() {
        return Ok(Value::Table(table_at(name, dict, level)?));
    }
    // NumPy's scalars and arrays as Python's.
    if item.hasattr("tolist")? {
        let plain = item.call_method0("tolist")?;
        // Python has no longer float.
        if plain.get_type().is(item.get_type()) {
            return Ok(Value::Float(plain.extract()?));
        }
        return value(name, &plain, level + 1);
    }
    if !(item.is_instance_of::<PyList>() || item.is_instance_of::<PyTuple>()) {
        let found = item.get_type().to_string();
        return Err(wrong_type(name, &found, "a number, text, list or dict"));
    }
    let items = item.try_iter()?.enumerate();
    let items = items.map(|(index, item)| value(&format!("{name}[{index}]"), &item?, level + 1));
    Ok(Value::Array(items.collect::<PyResult<_>>()?))
}

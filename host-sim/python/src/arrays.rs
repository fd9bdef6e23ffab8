//! Columns of numbers from Python: everything is checked before anything runs.

use crate::errors::{refused, wrong_type};
use numpy::prelude::*;
use numpy::{PyArray1, PyReadonlyArray1, PyUntypedArray};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

/// One number for all rows, or one for each.
pub enum Column {
    /// The same in every row.
    Constant(f64),
    /// One per row.
    Each(Vec<f64>),
}

impl Column {
    /// A column from a number or a one-dimensional array of real, finite numbers.
    pub fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let numpy = value.py().import("numpy")?;
        // The array of it has a number where it has none.
        if numpy.getattr("ma")?.call_method1("is_masked", (value,))?.is_truthy()? {
            return Err(refused(name, "masked", "must have a number in every row"));
        }
        // Ragged lists have no array.
        let array =
            numpy.call_method1("asarray", (value,)).map_err(|_| not_numbers(name, value))?;
        let untyped = array.cast::<PyUntypedArray>()?;
        if !matches!(untyped.dtype().kind(), b'f' | b'i' | b'u') {
            return Err(not_numbers(name, &untyped.dtype()));
        }
        if untyped.ndim() > 1 {
            let shape = format!("of {} dimensions", untyped.ndim());
            return Err(refused(name, &shape, "must be a number or one-dimensional"));
        }
        if untyped.ndim() == 0 {
            let number = finite(name, None, array.extract()?)?;
            return Ok(Self::Constant(number));
        }
        let doubles = array.call_method1("astype", ("float64",))?;
        let doubles: PyReadonlyArray1<'_, f64> = doubles.extract()?;
        let numbers = doubles.as_array().to_vec();
        for (row, &number) in numbers.iter().enumerate() {
            finite(name, Some(row), number)?;
        }
        Ok(Self::Each(numbers))
    }

    /// The number of a row.
    pub fn at(&self, row: usize) -> f64 {
        match self {
            Self::Constant(number) => *number,
            Self::Each(numbers) => numbers[row],
        }
    }
}

fn not_numbers(name: &str, found: &Bound<'_, PyAny>) -> PyErr {
    let found = found.str().map_or_else(|_| "something".to_owned(), |text| text.to_string());
    wrong_type(name, &found, "a real number or an array of them")
}

fn finite(name: &str, row: Option<usize>, number: f64) -> PyResult<f64> {
    if number.is_finite() {
        return Ok(number);
    }
    let field = row.map_or(name.to_owned(), |row| format!("{name}[{row}]"));
    Err(refused(&field, &number.to_string(), "must be finite"))
}

/// A number that must be finite.
pub fn number(name: &str, number: f64) -> PyResult<f64> {
    finite(name, None, number)
}

/// The number of rows of columns: none if all are constant. All arrays must be equally long.
pub fn rows<const N: usize>(columns: [(&str, &Column); N]) -> PyResult<Option<usize>> {
    let mut first: Option<(&str, usize)> = None;
    for (name, column) in columns {
        let Column::Each(numbers) = column else { continue };
        match first {
            None => first = Some((name, numbers.len())),
            Some((other, length)) if length != numbers.len() => {
                let limit = format!("must be {length} numbers, as {other} is");
                return Err(refused(name, &format!("{} numbers", numbers.len()), &limit));
            }
            Some(_) => {}
        }
    }
    Ok(first.map(|(_, length)| length))
}

/// Rows between two looks for Ctrl-C.
const CHUNK: usize = 1000;

/// What is made of each row, without the interpreter's lock.
pub fn each_row<T: Send>(
    py: Python<'_>,
    count: usize,
    mut of: impl FnMut(usize) -> T + Send,
) -> PyResult<Vec<T>> {
    let mut made = Vec::with_capacity(count);
    for from in (0..count).step_by(CHUNK) {
        py.detach(|| made.extend((from..count.min(from + CHUNK)).map(&mut of)));
        py.check_signals()?;
    }
    Ok(made)
}

/// A function of columns, row by row: a number if all columns are, else an array.
pub fn mapped<'py, const N: usize>(
    py: Python<'py>,
    columns: [(&str, &Column); N],
    of: impl Fn([f64; N]) -> f64 + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let at = |row| of(columns.map(|(_, column)| column.at(row)));
    match rows(columns)? {
        None => at(0).into_bound_py_any(py),
        Some(count) => each_row(py, count, at)?.into_pyarray(py).into_bound_py_any(py),
    }
}

/// The same with flags: a pair of numbers, or of arrays.
pub fn mapped_with_flags<'py, const N: usize>(
    py: Python<'py>,
    columns: [(&str, &Column); N],
    of: impl Fn([f64; N]) -> (f64, u16) + Sync,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let at = |row| of(columns.map(|(_, column)| column.at(row)));
    match rows(columns)? {
        None => {
            let (value, flags) = at(0);
            Ok((value.into_bound_py_any(py)?, flags.into_bound_py_any(py)?))
        }
        Some(count) => {
            let (values, flags): (Vec<f64>, Vec<u16>) =
                each_row(py, count, at)?.into_iter().unzip();
            let (values, flags) = (values.into_pyarray(py), flags.into_pyarray(py));
            Ok((values.into_any(), flags.into_any()))
        }
    }
}

/// The numbers of an array, checked as those of a run are; a copy.
#[pyfunction]
pub fn numbers<'py>(name: &str, value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
    match Column::read(name, value)? {
        Column::Each(numbers) => Ok(numbers.into_pyarray(value.py())),
        Column::Constant(number) => Err(refused(name, &number.to_string(), "must be an array")),
    }
}

/// Saved words; a copy.
pub fn saved(words: &Bound<'_, PyAny>) -> PyResult<Vec<u64>> {
    let Ok(array) = words.cast::<PyArray1<u64>>() else {
        let found = words.cast::<PyUntypedArray>().map_or_else(
            |_| words.get_type().to_string(),
            |array| format!("{} in {} dimensions", array.dtype(), array.ndim()),
        );
        return Err(wrong_type("words", &found, "the uint64 array that save() gave"));
    };
    Ok(array.readonly().as_array().to_vec())
}

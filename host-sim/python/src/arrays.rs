//! Columns of numbers from Python: everything is checked before anything runs.

use crate::errors::{refused, wrong_type};
use numpy::prelude::*;
use numpy::{PyReadonlyArray1, PyUntypedArray};
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

/// A function of columns, row by row: a number if all columns are, else an array.
pub fn mapped<'py, const N: usize>(
    py: Python<'py>,
    columns: [(&str, &Column); N],
    of: impl Fn([f64; N]) -> f64,
) -> PyResult<Bound<'py, PyAny>> {
    let at = |row| of(columns.map(|(_, column)| column.at(row)));
    match rows(columns)? {
        None => at(0).into_bound_py_any(py),
        Some(count) => {
            (0..count).map(at).collect::<Vec<f64>>().into_pyarray(py).into_bound_py_any(py)
        }
    }
}

/// The same with flags: a pair of numbers, or of arrays.
pub fn mapped_with_flags<'py, const N: usize>(
    py: Python<'py>,
    columns: [(&str, &Column); N],
    of: impl Fn([f64; N]) -> (f64, u16),
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let at = |row| of(columns.map(|(_, column)| column.at(row)));
    match rows(columns)? {
        None => {
            let (value, flags) = at(0);
            Ok((value.into_bound_py_any(py)?, flags.into_bound_py_any(py)?))
        }
        Some(count) => {
            let (values, flags): (Vec<f64>, Vec<u16>) = (0..count).map(at).unzip();
            let (values, flags) = (values.into_pyarray(py), flags.into_pyarray(py));
            Ok((values.into_any(), flags.into_any()))
        }
    }
}

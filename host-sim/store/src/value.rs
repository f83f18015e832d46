//! A value of a row, as both back ends have it.

use truepath_ground::diagnostics::Failure;

/// What stands in a column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// Nothing.
    Null,
    /// A whole number.
    Integer(i64),
    /// A number, all 64 bits of it.
    Real(f64),
    /// A text.
    Text(String),
}

impl From<i64> for Value {
    fn from(value: i64) -> Self {
        Self::Integer(value)
    }
}
impl From<bool> for Value {
    fn from(value: bool) -> Self {
        Self::Integer(value.into())
    }
}
impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self::Real(value)
    }
}
impl From<&str> for Value {
    fn from(value: &str) -> Self {
        Self::Text(value.to_owned())
    }
}
impl From<&String> for Value {
    fn from(value: &String) -> Self {
        Self::Text(value.clone())
    }
}
impl From<String> for Value {
    fn from(value: String) -> Self {
        Self::Text(value)
    }
}
impl<T: Into<Value>> From<Option<T>> for Value {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Null, Into::into)
    }
}

/// A row that was asked for.
#[derive(Clone, Debug)]
pub(crate) struct Row(pub(crate) Vec<Value>);

/// Values as parameters of a statement.
macro_rules! values {
    ($($value:expr),* $(,)?) => { [$($crate::value::Value::from($value)),*] };
}
pub(crate) use values;

impl Row {
    /// A whole number, if there is one.
    pub(crate) fn some_integer(&self, column: usize) -> Result<Option<i64>, Failure> {
        match self.0.get(column) {
            Some(Value::Integer(value)) => Ok(Some(*value)),
            Some(Value::Null) => Ok(None),
            other => Err(unexpected(column, other)),
        }
    }
    /// A whole number.
    pub(crate) fn integer(&self, column: usize) -> Result<i64, Failure> {
        self.some_integer(column)?.ok_or_else(|| unexpected(column, None))
    }
    /// A number. SQLite keeps a whole one of a column of numbers as such.
    pub(crate) fn real(&self, column: usize) -> Result<f64, Failure> {
        match self.0.get(column) {
            Some(Value::Real(value)) => Ok(*value),
            other => Err(unexpected(column, other)),
        }
    }
    /// A number, if there is one.
    pub(crate) fn some_real(&self, column: usize) -> Result<Option<f64>, Failure> {
        match self.0.get(column) {
            Some(Value::Null) => Ok(None),
            _ => self.real(column).map(Some),
        }
    }
    /// A text, if there is one.
    pub(crate) fn some_text(&self, column: usize) -> Result<Option<&str>, Failure> {
        match self.0.get(column) {
            Some(Value::Text(value)) => Ok(Some(value)),
            Some(Value::Null) => Ok(None),
            other => Err(unexpected(column, other)),
        }
    }
    /// A text.
    pub(crate) fn text(&self, column: usize) -> Result<&str, Failure> {
        self.some_text(column)?.ok_or_else(|| unexpected(column, None))
    }
}

fn unexpected(column: usize, found: Option<&Value>) -> Failure {
    Failure::Internal(format!("column {column} of a row of the store is {found:?}"))
}

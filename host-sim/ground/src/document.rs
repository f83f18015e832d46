//! A job file before its values mean anything: tables, keys and source spans.
//!
//! A [`Section`] hands out the values of one table by key and remembers which keys were asked for; what is left over
//! when the section is [`closed`](Section::close) is an unknown key. Every value's span is kept, so that layers above
//! can point at it later.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::decimal::Decimal;
use super::limits::Limits;
use crate::codes::{J003, J004, J005, J006, J007, J008};
use crate::diagnostics::{InputError, Source};
use crate::length::{Unit, in_inches, in_millimetres};

/// Where the value of a key stands; keys are written with their table, `tool.diameter_mm`.
pub type Spans = BTreeMap<String, Range<usize>>;

/// What a reader takes for a key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Whatever the key is made of; the reader looks itself.
    Any,
    /// A table.
    Table,
    /// A list of tables.
    Tables,
    /// A text.
    Text,
    /// A number in a range.
    Number(String),
    /// A whole number in a range.
    Whole(String),
    /// One of some names.
    Choice(Vec<String>),
}

/// A key that a reader asked for, whether the file has it or not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Asked {
    /// With its table, `tool.diameter_mm`.
    pub path: String,
    /// What it takes.
    pub kind: Kind,
}

thread_local! {
    /// Where the keys asked for on this thread are noted, while somebody listens.
    static LISTENED: RefCell<Option<Vec<Asked>>> = const { RefCell::new(None) };
}

/// Every key that is asked for while some work is done, in the order of asking: what the page of all keys is made from, so
/// that it says what the readers do.
pub fn asked_during<T>(work: impl FnOnce() -> T) -> (T, Vec<Asked>) {
    LISTENED.set(Some(Vec::new()));
    let done = work();
    (done, LISTENED.take().unwrap_or_default())
}

fn note(path: impl FnOnce() -> String, kind: impl FnOnce() -> Kind) {
    LISTENED.with_borrow_mut(|listened| {
        if let Some(list) = listened {
            list.push(Asked { path: path(), kind: kind() });
        }
    });
}

/// One table of the file.
pub struct Section<'d> {
    source: &'d Source,
    name: &'static str,
    span: Range<usize>,
    table: &'d DeTable<'d>,
    asked: RefCell<Vec<&'static str>>,
    spans: &'d RefCell<Spans>,
    unit: Unit,
}

/// A value with its place.
pub struct Value<'d> {
    /// Its key with the table, `tool.diameter_mm`.
    pub path: String,
    /// Its bytes in the file.
    pub span: Range<usize>,
    /// As it was read.
    pub raw: &'d DeValue<'d>,
    /// Whether it stands under the key in inches, [`in_inches`].
    pub inches: bool,
}

impl Value<'_> {
    /// Millimetres of a number that stands in it.
    pub fn mm(&self, number: Decimal) -> Decimal {
        if self.inches { number.of_inches() } else { number }
    }
    /// The unit that its key says.
    pub const fn unit(&self) -> Unit {
        if self.inches { Unit::Inch } else { Unit::Millimetre }
    }
}

/// The unit of a file: inches where the key of any length says so.
fn unit_of(table: &DeTable<'_>) -> Unit {
    let is_inch = |key: &str, value: &DeValue<'_>| match value {
        DeValue::Table(table) => unit_of(table) == Unit::Inch,
        DeValue::Array(list) => {
            list.iter().filter_map(|entry| entry.get_ref().as_table()).any(|table| unit_of(table) == Unit::Inch)
        }
        _ => in_millimetres(key).is_some(),
    };
    if table.iter().any(|(key, value)| is_inch(key.get_ref(), value.get_ref())) { Unit::Inch } else { Unit::Millimetre }
}

impl<'d> Section<'d> {
    /// The table outside of any other; the places of its values go to `spans`.
    pub fn root(source: &'d Source, table: &'d Spanned<DeTable<'d>>, spans: &'d RefCell<Spans>) -> Self {
        let unit = unit_of(table.get_ref());
        Self { source, name: "", span: 0..0, table: table.get_ref(), asked: RefCell::default(), spans, unit }
    }

    /// The unit of the file's lengths; a file that has them in both is in inches.
    pub const fn unit(&self) -> Unit {
        self.unit
    }

    fn path(&self, key: &str) -> String {
        if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) }
    }

    /// The value of a key, if it is there; a length may stand under its key in inches.
    pub fn value(&self, key: &'static str) -> Option<Value<'d>> {
        self.asked.borrow_mut().push(key);
        note(|| self.path(key), || Kind::Any);
        let inch_key = || in_inches(key).filter(|key| self.table.contains_key(key.as_str()));
        let (path, value, inches) = match (self.table.get(key), inch_key()) {
            (Some(value), _) => (self.path(key), value, false),
            (None, Some(key)) => (self.path(&key), self.table.get(key.as_str())?, true),
            (None, None) => return None,
        };
        // Layers above know it by its name in millimetres.
        self.spans.borrow_mut().insert(self.path(key), value.span());
        Some(Value { path, span: value.span(), raw: value.get_ref(), inches })
    }

    /// A sub-table, if it is there.
    pub fn section(&self, key: &'static str) -> Result<Option<Section<'d>>, InputError> {
        note(|| self.path(key), || Kind::Table);
        let Some(value) = self.value(key) else { return Ok(None) };
        let Some(table) = value.raw.as_table() else {
            return Err(self.wrong_type(&value, "a table", &format!("write it as [{key}] with one key a line")));
        };
        Ok(Some(Section {
            source: self.source,
            name: key,
            span: value.span,
            table,
            asked: RefCell::default(),
            spans: self.spans,
            unit: self.unit,
        }))
    }

    /// The tables of a list written as `[[key]]`, in order.
    pub fn sections(&self, key: &'static str) -> Result<Vec<Section<'d>>, InputError> {
        self.sections_named(key, key)
    }

    /// The tables of a list within a table, in order; `name` is that of both, as in `[[plan.cutter]]`.
    pub fn sections_named(&self, key: &'static str, name: &'static str) -> Result<Vec<Section<'d>>, InputError> {
        note(|| self.path(key), || Kind::Tables);
        let Some(value) = self.value(key) else { return Ok(Vec::new()) };
        let help = format!("write every one of them as [[{name}]] with one key a line");
        let Some(list) = value.raw.as_array() else { return Err(self.wrong_type(&value, "a list of tables", &help)) };
        let table = |entry: &'d Spanned<DeValue<'d>>| {
            let Some(table) = entry.get_ref().as_table() else {
                return Err(self.wrong_type(&value, "a list of tables", &help));
            };
            let Section { source, spans, unit, .. } = *self;
            Ok(Section { source, name, span: entry.span(), table, asked: RefCell::default(), spans, unit })
        };
        list.iter().map(table).collect()
    }

    /// A sub-table that the file does not have, with other contents: `table`.
    pub fn section_of(&self, key: &'static str, table: &'d DeTable<'d>) -> Section<'d> {
        let Section { source, spans, unit, .. } = *self;
        Section { source, name: key, span: self.end(), table, asked: RefCell::default(), spans, unit }
    }

    /// The error of a sub-table that must be there; `needs` lists what belongs in it.
    pub fn missing_section(&self, key: &'static str, needs: &str) -> InputError {
        self.missing_or_misspelt(
            key,
            format!("[{key}] is missing"),
            &format!("a table [{key}]"),
            format!("add [{key}] with {needs}"),
            self.end(),
        )
    }

    /// A sub-table that must be there; `needs` lists what belongs in it.
    pub fn required_section(&self, key: &'static str, needs: &str) -> Result<Section<'d>, InputError> {
        self.section(key)?.ok_or_else(|| self.missing_section(key, needs))
    }

    /// A number within limits, if the key is there.
    pub fn number(&self, key: &'static str, limits: Limits) -> Result<Option<Decimal>, InputError> {
        note(|| self.path(key), || Kind::Number(limits.phrase()));
        self.value(key).map(|value| self.number_in(&value, limits)).transpose()
    }

    /// A number within limits that must be there.
    pub fn required_number(&self, key: &'static str, limits: Limits) -> Result<Decimal, InputError> {
        self.number(key, limits)?
            .ok_or_else(|| self.missing(key, &format!("a number, {}", limits.phrase_in(self.unit))))
    }

    /// The number a value holds.
    pub fn number_in(&self, value: &Value<'_>, limits: Limits) -> Result<Decimal, InputError> {
        note(|| value.path.clone(), || Kind::Number(limits.phrase()));
        let limits_in_words = limits.phrase_in(value.unit());
        let text = match value.raw {
            DeValue::Integer(i) if i.radix() == 10 => i.as_str().to_owned(),
            DeValue::Float(f) => f.as_str().to_owned(),
            _ => {
                let help =
                    if value.raw.is_str() { "remove the quotation marks" } else { "write a plain decimal number" };
                return Err(self.wrong_type(value, &format!("a number, {limits_in_words}"), help));
            }
        };
        match Decimal::parse(&text).map(|n| (n, value.mm(n))) {
            Some((_, n)) if limits.admits(n) => Ok(n),
            Some((number, _)) => {
                let help = match in_millimetres(&value.path).filter(|_| value.inches && limits.admits(number)) {
                    Some(key) => format!("check the value; if it is in millimetres, write {} = {text}", own_name(&key)),
                    None => "check the value and its unit: the key's name carries it".to_owned(),
                };
                let found = format!("{} is {text}", value.path);
                Err(InputError::new(J006, found, limits_in_words, help).at(self.source, value.span.clone()))
            }
            None => {
                Err(self.out_of_range(value, &limits_in_words, "write a plain decimal number with at most 36 digits"))
            }
        }
    }

    /// A whole number within limits, if the key is there.
    pub fn whole<T: TryFrom<i64>>(
        &self,
        key: &'static str,
        limits: Limits,
        help: &str,
    ) -> Result<Option<T>, InputError> {
        note(|| self.path(key), || Kind::Whole(limits.phrase()));
        let Some(value) = self.value(key) else { return Ok(None) };
        let whole = self.number_in(&value, limits)?.as_whole().and_then(|n| T::try_from(n).ok());
        let expected = || format!("a whole number, {}", limits.phrase());
        whole.map(Some).ok_or_else(|| self.out_of_range(&value, &expected(), help))
    }

    /// A text, if the key is there.
    pub fn text(&self, key: &'static str) -> Result<Option<(&'d str, Value<'d>)>, InputError> {
        note(|| self.path(key), || Kind::Text);
        let Some(value) = self.value(key) else { return Ok(None) };
        match value.raw.as_str() {
            Some(text) => Ok(Some((text, value))),
            None => Err(self.wrong_type(&value, "a text in quotation marks", "put the value between quotation marks")),
        }
    }

    /// One of a list of names, if the key is there.
    pub fn choice<T: Copy>(&self, key: &'static str, choices: &[(&str, T)]) -> Result<Option<T>, InputError> {
        note(|| self.path(key), || Kind::Choice(choices.iter().map(|(name, _)| (*name).to_owned()).collect()));
        let Some((text, value)) = self.text(key)? else { return Ok(None) };
        match choices.iter().find(|(name, _)| *name == text) {
            Some((_, choice)) => Ok(Some(*choice)),
            None => {
                let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
                let help = match nearest(text, &names) {
                    Some(name) => format!("did you mean \"{name}\"?"),
                    None => "write one of these names exactly".to_owned(),
                };
                Err(InputError::new(J007, format!("{} is \"{text}\"", value.path), one_of(&names), help)
                    .at(self.source, value.span))
            }
        }
    }

    /// An error at a value that is well formed but not allowed.
    pub fn out_of_range(&self, value: &Value<'_>, expected: &str, help: &str) -> InputError {
        let found = format!("{} is {}", value.path, self.source.excerpt(value.span.clone()));
        InputError::new(J006, found, expected, help)
            .told_in(value.unit())
            .with_keys_in(value.unit())
            .at(self.source, value.span.clone())
    }

    /// An error at a value that another one excludes.
    pub fn contradiction(&self, value: &Value<'_>, found: &str, expected: &str, help: &str) -> InputError {
        InputError::new(J008, found, expected, help)
            .told_in(value.unit())
            .with_keys_in(value.unit())
            .at(self.source, value.span.clone())
    }

    /// An error at a value of the wrong type.
    pub fn wrong_type(&self, value: &Value<'_>, expected: &str, help: &str) -> InputError {
        let article = match value.raw.type_str() {
            kind @ ("integer" | "array") => format!("an {kind}"),
            "string" => "a text".to_owned(),
            "datetime" => "a date".to_owned(),
            kind => format!("a {kind}"),
        };
        InputError::new(J005, format!("{} is {article}", value.path), expected, help)
            .told_in(value.unit())
            .with_keys_in(value.unit())
            .at(self.source, value.span.clone())
    }

    /// The error of a key that must be there.
    pub fn missing(&self, key: &'static str, expected: &str) -> InputError {
        let place =
            if self.name.is_empty() { "at the top of the file".to_owned() } else { format!("under [{}]", self.name) };
        self.missing_or_misspelt(
            key,
            format!("{} is missing", self.path(key)),
            expected,
            format!("add {key} {place}"),
            self.span.clone(),
        )
    }

    /// Points at a key nobody knows whose name is close to the missing one, else at `place`.
    fn missing_or_misspelt(
        &self,
        key: &'static str,
        found: String,
        expected: &str,
        help: String,
        place: Range<usize>,
    ) -> InputError {
        let told = |text: &str| self.unit.keys(&self.unit.retold(text)).into_owned();
        let own = told(key);
        let misspelt = self.table.keys().find(|k| nearest(k.get_ref(), &[key, &own]).is_some());
        let (help, place) = match misspelt {
            Some(k) => (format!("did you mean {own} where {} is written?", k.get_ref()), k.span()),
            None => (told(&help), place),
        };
        InputError::new(J004, told(&found), told(expected), help).at(self.source, place)
    }

    /// Ends the reading of this table.
    ///
    /// # Errors
    /// `J003` at the first key nobody asked for, `J008` at a length that is given in both units.
    pub fn close(&self) -> Result<(), InputError> {
        let asked = self.asked.borrow();
        for key in asked.iter() {
            let inches = in_inches(key).and_then(|inch_key| self.table.get_key_value(inch_key.as_str()));
            if let (Some((inch_key, _)), true) = (inches, self.table.contains_key(*key)) {
                let found = format!("{} is given as well as {key}", self.path(inch_key.get_ref()));
                let error = InputError::new(J008, found, "the length in one unit", "take one of the two lines out");
                return Err(error.at(self.source, inch_key.span()));
            }
        }
        let is_known =
            |name: &str| asked.iter().any(|key| *key == name || in_inches(key).is_some_and(|key| key == name));
        let unknown = self.table.keys().filter(|key| !is_known(key.get_ref())).min_by_key(|key| key.span().start);
        let Some(key) = unknown else { return Ok(()) };
        let (name, place) = (
            key.get_ref(),
            if self.name.is_empty() { "the top of the file".to_owned() } else { format!("[{}]", self.name) },
        );
        // A key whose name says its unit is near to one of that unit.
        let unit = match (in_inches(name), in_millimetres(name)) {
            (_, Some(_)) => Unit::Inch,
            (Some(_), None) => Unit::Millimetre,
            (None, None) => self.unit,
        };
        let named: Vec<_> = asked.iter().map(|key| unit.keys(key)).collect();
        let mut known: Vec<&str> = named.iter().map(|key| &**key).collect();
        let help = match nearest(name, &known) {
            Some(known) => format!("did you mean {known}?"),
            None => J003.remedy.to_owned(),
        };
        known.sort_unstable();
        known.dedup();
        Err(InputError::new(J003, format!("{name} is no key of {place}"), one_of(&known), help)
            .at(self.source, key.span()))
    }

    /// Where the table stands in the file.
    pub fn place(&self) -> Range<usize> {
        self.span.clone()
    }

    /// The text of the file at a span.
    pub fn text_at(&self, span: Range<usize>) -> String {
        self.source.excerpt(span)
    }

    fn end(&self) -> Range<usize> {
        let end = self.source.bytes().len();
        let trimmed = self.source.bytes().iter().rposition(|b| !b.is_ascii_whitespace()).map_or(end, |last| last + 1);
        trimmed..trimmed
    }
}

/// The name of a key without its table.
fn own_name(path: &str) -> &str {
    path.rsplit_once('.').map_or(path, |(_, name)| name)
}

fn one_of(names: &[&str]) -> String {
    match names {
        [only] => (*only).to_owned(),
        _ => format!("one of {}", names.join(", ")),
    }
}

/// The known name closest to a mistyped one, when it is close at all (a third of its letters).
fn nearest<'n>(text: &str, names: &[&'n str]) -> Option<&'n str> {
    let text = text.to_lowercase();
    let distance = |name: &str| edit_distance(&text, &name.to_lowercase());
    let best = names.iter().min_by_key(|name| distance(name))?;
    (distance(best) * 3 <= best.len().max(text.len())).then_some(best)
}

/// Letters inserted, left out, changed or swapped with their neighbour between two words.
fn edit_distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let mut cost =
                (rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1])).min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                cost = cost.min(rows[i - 2][j - 2] + 1);
            }
            row.push(cost);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

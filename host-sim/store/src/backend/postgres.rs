//! A store in a database of PostgreSQL.
//!
//! One writes at a time, as in a file: a transaction takes a lock of the whole store, which is short, as a part is some hundred
//! rows. So no two of them can wait for each other, and readers wait for nobody.

use std::collections::HashMap;
use std::error::Error as _;
use std::time::Duration;

use postgres::error::SqlState;
use postgres::types::private::BytesMut;
use postgres::types::{IsNull, ToSql, Type, to_sql_checked};
use postgres::{Client, Config, Error, Statement};
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_job::job::without_password;

use super::connection::{Backend, refuses};
use super::encryption::{Encryption, Failed};
use super::passwords::password;

use crate::codes::O001;
use crate::value::{Row, Value};

/// How long a server may take to answer at first.
const PATIENCE: Duration = Duration::from_secs(5);
/// The lock of a store: any number that nobody else takes.
const LOCK: i64 = 0x7472_7565_7061_7468;
/// How long a writer waits for the others, and a statement may take at most.
const SETTINGS: &str = "SET application_name = 'truepath'; SET client_min_messages = warning; SET lock_timeout = '30s'";

/// A connection to a server.
pub(super) struct Postgres {
    place: String,
    client: Client,
    prepared: HashMap<String, Statement>,
}

impl Postgres {
    pub(super) fn open(url: &str) -> Result<Self, Failure> {
        let place = without_password(url);
        let no_url = |why: &str| {
            let help = "write it as postgres://user@host:5432/database";
            InputError::new(O001, format!("{place} is no URL of a server ({why})"), "a URL", help)
        };
        let (url, encryption) = Encryption::of(url).map_err(|why| no_url(&why))?;
        let mut config: Config = url.parse().map_err(|e: Error| no_url(&reason(&e)))?;
        if config.get_connect_timeout().is_none() {
            config.connect_timeout(PATIENCE);
        }
        if config.get_password().is_none()
            && let Some(password) = password(&config)
        {
            config.password(password);
        }
        let mut connect = || {
            let mut client = encryption.connect(&mut config)?;
            client.batch_execute(SETTINGS)?;
            Ok(client)
        };
        let client = connect().map_err(|failed| match failed {
            Failed::Server(e) => unreachable(&place, &e),
            Failed::Roots(why) => cannot_be_reached(&place, &why, UNTRUSTED),
        })?;
        Ok(Self { place, client, prepared: HashMap::new() })
    }

    /// A statement that the server has read once.
    fn prepared(&mut self, statement: &str) -> Result<Statement, Failure> {
        if let Some(known) = self.prepared.get(statement) {
            return Ok(known.clone());
        }
        let new = self.client.prepare(statement).map_err(|e| failure(&self.place, &e))?;
        self.prepared.insert(statement.to_owned(), new.clone());
        Ok(new)
    }
}

impl Backend for Postgres {
    fn script(&mut self, statements: &str) -> Result<(), Failure> {
        self.client.batch_execute(statements).map_err(|e| failure(&self.place, &e))
    }

    fn rows(&mut self, statement: &str, values: &[Value]) -> Result<Vec<Row>, Failure> {
        let prepared = self.prepared(statement)?;
        let rows = self.client.query(&prepared, &parameters(values)).map_err(|e| failure(&self.place, &e))?;
        rows.iter().map(|row| held(row).map_err(|e| failure(&self.place, &e))).collect()
    }

    fn change(&mut self, statement: &str, values: &[Value]) -> Result<u64, Failure> {
        let prepared = self.prepared(statement)?;
        self.client.execute(&prepared, &parameters(values)).map_err(|e| failure(&self.place, &e))
    }

    fn begin(&mut self) -> Result<(), Failure> {
        self.script(&format!("BEGIN; SELECT pg_advisory_xact_lock({LOCK})"))
    }

    fn in_its_words(&self, statements: &str) -> String {
        statements.to_owned()
    }

    fn has_table(&mut self, name: &str) -> Result<bool, Failure> {
        let known = "SELECT 1 FROM pg_tables WHERE schemaname = current_schema() AND tablename = $1";
        Ok(!self.rows(known, &[Value::from(name)])?.is_empty())
    }

    fn damage(&mut self) -> Result<Option<String>, Failure> {
        // A server sees to its pages itself.
        Ok(None)
    }
}

fn parameters(values: &[Value]) -> Vec<&(dyn ToSql + Sync)> {
    values.iter().map(|value| value as &(dyn ToSql + Sync)).collect()
}

impl ToSql for Value {
    fn to_sql(&self, kind: &Type, out: &mut BytesMut) -> Result<IsNull, Box<dyn std::error::Error + Sync + Send>> {
        match self {
            Self::Null => Ok(IsNull::Yes),
            Self::Integer(value) => value.to_sql(kind, out),
            Self::Real(value) => value.to_sql(kind, out),
            Self::Text(value) => value.to_sql(kind, out),
        }
    }
    fn accepts(kind: &Type) -> bool {
        [Type::INT8, Type::FLOAT8, Type::TEXT, Type::NAME].contains(kind)
    }
    to_sql_checked!();
}

fn held(row: &postgres::Row) -> Result<Row, Error> {
    let of = |(at, column): (usize, &postgres::Column)| {
        Ok(match *column.type_() {
            Type::INT4 => row.try_get::<_, Option<i32>>(at)?.map(i64::from).into(),
            Type::FLOAT8 => row.try_get::<_, Option<f64>>(at)?.into(),
            Type::TEXT | Type::NAME => row.try_get::<_, Option<String>>(at)?.into(),
            // Of another type it says so itself.
            _ => row.try_get::<_, Option<i64>>(at)?.into(),
        })
    };
    row.columns().iter().enumerate().map(of).collect::<Result<Vec<Value>, Error>>().map(Row)
}

/// What the server or the way to it says.
fn reason(error: &Error) -> String {
    if let Some(said) = error.as_db_error() {
        return format!("{}: {}", said.code().code(), said.message());
    }
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(inner) = source {
        text += &format!(": {inner}");
        source = inner.source();
    }
    text
}

/// What to do where nobody vouches for the server.
const UNTRUSTED: &str = "name the certificate of who vouches for the server by sslrootcert=FILE behind the ? of the URL; sslmode=disable goes without encryption";

fn unreachable(place: &str, error: &Error) -> Failure {
    let why = reason(error);
    // The kind of an error shows in its words only.
    let help = if why.contains("TLS") {
        UNTRUSTED
    } else {
        "check name, server and rights; the password comes from PGPASSFILE, ~/.pgpass or PGPASSWORD, and truepath store init makes a new store"
    };
    cannot_be_reached(place, &why, help)
}

fn cannot_be_reached(place: &str, why: &str, help: &str) -> Failure {
    let found = format!("{place} cannot be reached ({why})");
    InputError::new(O001, found, "a server that answers within 5 s", help).into()
}

fn failure(place: &str, error: &Error) -> Failure {
    let why = reason(error);
    let Some(code) = error.code() else { return unreachable(place, error) };
    let refused = [
        SqlState::INSUFFICIENT_PRIVILEGE,
        SqlState::READ_ONLY_SQL_TRANSACTION,
        SqlState::DISK_FULL,
        SqlState::INSUFFICIENT_RESOURCES,
        SqlState::IO_ERROR,
    ];
    if refused.contains(code) {
        return refuses(place, &why).into();
    }
    if *code == SqlState::LOCK_NOT_AVAILABLE {
        let expected = "a store that can be written to within half a minute";
        return O001.error(format!("{place} is held by others ({why})"), expected).into();
    }
    // Classes of a server that goes down or breaks off.
    if ["08", "53", "57", "58"].iter().any(|class| code.code().starts_with(class)) {
        return unreachable(place, error);
    }
    Failure::Internal(format!("{place}: {why}"))
}

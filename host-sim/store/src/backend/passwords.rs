//! The password of a server, from where every program of PostgreSQL takes it: `PGPASSWORD`, then the file of `PGPASSFILE`, else
//! `~/.pgpass`, of which the first line that fits counts.
//!
//! A line is `host:port:database:user:password`; `*` fits anything, `\` takes its meaning from `:` and `\`. A file that others
//! can read is left alone, as everywhere.

use std::path::{Path, PathBuf};

use postgres::Config;
use postgres::config::Host;

/// What is to be looked for.
struct Wanted<'a> {
    host: &'a str,
    port: &'a str,
    database: &'a str,
    user: &'a str,
}

/// The password for a connection, if there is one.
pub(super) fn password(config: &Config) -> Option<String> {
    if let Some(password) = std::env::var("PGPASSWORD").ok().filter(|password| !password.is_empty()) {
        return Some(password);
    }
    let file = std::env::var_os("PGPASSFILE").map(PathBuf::from);
    let file = file.or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".pgpass")))?;
    let text = is_private(&file).then(|| std::fs::read_to_string(&file).ok())??;
    let own = std::env::var("USER").unwrap_or_default();
    let user = config.get_user().unwrap_or(&own);
    let host = match config.get_hosts().first() {
        Some(Host::Tcp(host)) => host.as_str(),
        _ => "localhost",
    };
    let port = config.get_ports().first().copied().unwrap_or(5432).to_string();
    in_lines(&text, &Wanted { host, port: &port, database: config.get_dbname().unwrap_or(user), user })
}

#[cfg(unix)]
fn is_private(file: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    std::fs::metadata(file).is_ok_and(|found| found.is_file() && found.permissions().mode() & 0o077 == 0)
}

#[cfg(not(unix))]
fn is_private(file: &Path) -> bool {
    file.is_file()
}

fn in_lines(text: &str, wanted: &Wanted<'_>) -> Option<String> {
    let wanted = [wanted.host, wanted.port, wanted.database, wanted.user];
    text.lines().filter(|line| !line.starts_with('#')).find_map(|line| {
        let mut fields = fields(line);
        let password = (fields.len() == 5).then(|| fields.pop())??;
        fields.iter().zip(wanted).all(|(field, wanted)| field == "*" || field == wanted).then_some(password)
    })
}

fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut letters = line.chars();
    while let Some(letter) = letters.next() {
        match letter {
            ':' => fields.push(String::new()),
            letter => {
                let letter = if letter == '\\' { letters.next() } else { Some(letter) };
                if let (Some(letter), Some(field)) = (letter, fields.last_mut()) {
                    field.push(letter);
                }
            }
        }
    }
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_line_that_fits_counts() {
        let text = "# shop\ndb:5432:other:ann:no\n*:5432:shop:ann:se\\:c\\\\ret\n*:*:*:*:any\nbroken:line\n";
        let found = |user, port| in_lines(text, &Wanted { host: "db", port, database: "shop", user });
        assert_eq!(found("ann", "5432").as_deref(), Some("se:c\\ret"));
        assert_eq!(found("bob", "5432").as_deref(), Some("any"));
        assert_eq!(in_lines("a:b\n", &Wanted { host: "a", port: "b", database: "c", user: "d" }), None);
    }
}

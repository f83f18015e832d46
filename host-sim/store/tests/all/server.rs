//! The same on a server of PostgreSQL, which is started for the test in a folder of its own.
//!
//! Without one installed the tests say so and pass; `TRUEPATH_POSTGRES=required` makes that a failure.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use truepath_store::{PartFolder, Place, Store};

use crate::support::{code, folder, history, setup, shown};
use crate::{round_trip, writers};

/// Who runs the server where root must not.
const NOBODY: &str = "65534";

/// A server that ends with this.
struct Server {
    programs: PathBuf,
    folder: tempfile::TempDir,
    port: u16,
}

impl Server {
    /// Starts one; `None`, said, where none is installed.
    fn start() -> Option<Self> {
        let Some(programs) = installed() else {
            let required = std::env::var("TRUEPATH_POSTGRES").is_ok_and(|value| value == "required");
            assert!(!required, "TRUEPATH_POSTGRES=required, and no PostgreSQL server is installed");
            // Past the capture of the test's output, so that it is seen.
            let _ = writeln!(std::io::stderr(), "note: no PostgreSQL server is installed: nothing of it was tested");
            return None;
        };
        let folder = tempfile::Builder::new().prefix("pg").tempdir_in("/tmp").expect("a folder");
        // A port that is free now.
        let port =
            std::net::TcpListener::bind("127.0.0.1:0").and_then(|free| free.local_addr()).expect("a port").port();
        let server = Self { programs, folder, port };
        let data = server.data();
        fs::create_dir(&data).expect("a folder");
        if is_root() {
            let given =
                Command::new("chown").args(["-R", &format!("{NOBODY}:{NOBODY}")]).arg(server.folder.path()).status();
            assert!(given.expect("chown").success());
        }
        fs::write(server.folder.path().join("first"), "geheim\n").expect("written");
        let init = server
            .program("initdb")
            .args(["--username=admin", "--auth=scram-sha-256", "--no-sync", "--encoding=UTF8", "--locale=C"])
            .arg(format!("--pwfile={}", server.folder.path().join("first").display()))
            .arg("-D")
            .arg(&data)
            .output()
            .expect("initdb");
        assert!(init.status.success(), "{}", String::from_utf8_lossy(&init.stderr));
        let options = format!("-c listen_addresses=127.0.0.1 -c port={port} -c unix_socket_directories= -c fsync=off");
        assert!(server.control(&["start", "-w", "-t", "30", "-o", &options]), "the server does not start");
        Some(server)
    }

    fn data(&self) -> PathBuf {
        self.folder.path().join("data")
    }

    /// One of its programs, as an ordinary user.
    fn program(&self, name: &str) -> Command {
        let path = self.programs.join(name);
        let mut command = if is_root() {
            let mut command = Command::new("setpriv");
            command.args([&format!("--reuid={NOBODY}"), &format!("--regid={NOBODY}"), "--clear-groups"]).arg(path);
            command
        } else {
            Command::new(path)
        };
        command.current_dir("/tmp").env("LC_ALL", "C").stdin(Stdio::null());
        command
    }

    fn control(&self, arguments: &[&str]) -> bool {
        let mut command = self.program("pg_ctl");
        command.arg("-D").arg(self.data()).arg("-l").arg(self.folder.path().join("log")).args(arguments);
        command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|ended| ended.success())
    }

    /// A database of a user.
    fn place(&self, user: &str, password: &str, database: &str) -> Place {
        Place::of(&format!("postgres://{user}:{password}@127.0.0.1:{}/{database}", self.port))
    }

    /// Gives it a file that only the server may read.
    fn write(&self, name: &str, text: &str) {
        use std::os::unix::fs::PermissionsExt;
        let path = self.data().join(name);
        fs::write(&path, text).expect("written");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o600)).expect("its rights");
        if is_root() {
            let given = Command::new("chown").arg(format!("{NOBODY}:{NOBODY}")).arg(&path).status();
            assert!(given.expect("chown").success());
        }
    }

    fn say(&self, database: &str, statements: &str) {
        let url = format!("postgres://admin:geheim@127.0.0.1:{}/{database}", self.port);
        let mut client = postgres::Client::connect(&url, postgres::NoTls).expect("the server");
        client.batch_execute(statements).unwrap_or_else(|e| panic!("{statements}: {e:?}"));
    }

    /// A new database with a store.
    fn store(&self, database: &str) -> Place {
        self.say("postgres", &format!("CREATE DATABASE {database}"));
        let place = self.place("admin", "geheim", database);
        shown(Store::init(&place, false));
        place
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.control(&["stop", "-m", "immediate"]);
    }
}

/// Where Debian keeps the programs of a server: of several the newest.
fn installed() -> Option<PathBuf> {
    let versions = fs::read_dir("/usr/lib/postgresql").ok()?.filter_map(Result::ok);
    let bins = versions.map(|version| version.path().join("bin")).filter(|bin| bin.join("initdb").is_file());
    bins.max_by_key(|bin| bin.parent()?.file_name()?.to_str()?.parse::<u32>().ok())
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output();
    id.is_ok_and(|said| said.stdout.trim_ascii() == b"0")
}

fn part(at: &Path, job: u64) -> PartFolder {
    shown(PartFolder::read(&folder(at, &format!("of-{job}"), &history(job, 2, 8)))).expect("a history")
}

/// One server for all of it, as starting one takes longer than the rest.
#[test]
fn a_server_does_what_a_file_does() {
    let Some(server) = Server::start() else { return };
    let at = tempfile::tempdir().expect("a folder");
    round_trip::whole_way(&server.store("whole"), at.path());
    round_trip::what_others_say(&server.store("others"), at.path());
    writers::thirty_writers(&server.store("writers"), at.path());
    a_reader_reads_only(&server, at.path());
    what_is_wrong_with_a_server_is_told(&server);
    what_is_encrypted_is_checked(&server);
}

/// A certificate that vouches for others, and one that it vouches for, of a server that is called so; in PEM, with the key.
fn certificates(name: &str) -> (String, String, String) {
    let mut of_shop = rcgen::CertificateParams::default();
    of_shop.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
    let key = rcgen::KeyPair::generate().expect("a key");
    let authority = of_shop.self_signed(&key).expect("a certificate").pem();
    let issuer = rcgen::Issuer::new(of_shop, key);
    let own = rcgen::KeyPair::generate().expect("a key");
    let server = rcgen::CertificateParams::new([name.to_owned()]).expect("a name");
    let server = server.signed_by(&own, &issuer).expect("a certificate");
    (authority, server.pem(), own.serialize_pem())
}

/// The server of the test is on this computer, where nothing is encrypted unless asked for.
fn what_is_encrypted_is_checked(server: &Server) {
    let plain = server.store("encrypted");
    let place = |query: &str| Place::of(&format!("postgres://admin:geheim@{query}"));
    let at = |host: &str, query: &str| place(&format!("{host}:{}/encrypted?{query}", server.port));
    let roots = |name: &str| format!("sslrootcert={}", server.folder.path().join(name).display());
    // A server that offers nothing is refused where encryption is demanded, and taken where it is preferred.
    let said = |place: &Place| Store::open(place).err().map(|failure| failure.to_string()).unwrap_or_default();
    assert!(
        said(&at("localhost", "sslmode=verify-full")).contains("TLS"),
        "{}",
        said(&at("localhost", "sslmode=require"))
    );
    shown(Store::open(&at("localhost", "sslmode=prefer")));

    let (authority, certificate, key) = certificates("localhost");
    fs::write(server.folder.path().join("shop.pem"), authority).expect("written");
    fs::write(server.folder.path().join("other.pem"), certificates("localhost").0).expect("written");
    fs::write(server.folder.path().join("none.pem"), "no certificate\n").expect("written");
    server.write("server.crt", &certificate);
    server.write("server.key", &key);
    server.say("postgres", "ALTER SYSTEM SET ssl = on");
    assert!(server.control(&["reload"]));
    let reached = |roots: &str| {
        let encrypted = at("localhost", &format!("sslmode=verify-full&{roots}"));
        let start = Instant::now();
        loop {
            match Store::open(&encrypted) {
                Err(_) if start.elapsed() < Duration::from_secs(10) => std::thread::sleep(Duration::from_millis(50)),
                opened => break shown(opened),
            }
        }
    };
    let mut store = reached(&roots("shop.pem"));
    // It works, and the server knows it as encrypted; not so what nobody asked to be.
    assert_eq!(shown(store.status(1)).parts, 0);
    let encrypted_now = || {
        let url = format!("postgres://admin:geheim@127.0.0.1:{}/postgres", server.port);
        let mut client = postgres::Client::connect(&url, postgres::NoTls).expect("the server");
        let count = "SELECT count(*) FROM pg_stat_ssl s JOIN pg_stat_activity a USING (pid) WHERE s.ssl AND a.application_name = 'truepath'";
        client.query_one(count, &[]).expect("an answer").get::<_, i64>(0)
    };
    assert_eq!(encrypted_now(), 1);
    drop(store);
    let mut unasked = shown(Store::open(&plain));
    assert_eq!(shown(unasked.status(1)).parts, 0);
    let ended = Instant::now();
    while encrypted_now() != 0 {
        assert!(ended.elapsed() < Duration::from_secs(10), "encrypted without being asked");
        std::thread::sleep(Duration::from_millis(20));
    }
    // By another's word, by nobody's, and under another name there is no connection, and what to do is said.
    for (host, query) in [
        ("localhost", format!("sslmode=verify-full&{}", roots("other.pem"))),
        ("localhost", "sslmode=prefer".to_owned()),
        ("127.0.0.1", format!("sslmode=require&{}", roots("shop.pem"))),
        ("localhost", format!("sslmode=require&{}", roots("none.pem"))),
        ("localhost", format!("sslmode=require&{}", roots("missing.pem"))),
    ] {
        let refused = Store::open(&at(host, &query));
        assert_eq!(code(refused), "O001", "{host} {query}");
    }
    shown(Store::open(&at("localhost", "sslmode=disable")));
    // A certificate that vouches for itself, as Debian makes one for its server, does where it is named.
    let key = rcgen::KeyPair::generate().expect("a key");
    let own =
        rcgen::CertificateParams::new(["localhost".to_owned()]).expect("a name").self_signed(&key).expect("signed");
    fs::write(server.folder.path().join("own.pem"), own.pem()).expect("written");
    server.write("server.crt", &own.pem());
    server.write("server.key", &key.serialize_pem());
    assert!(server.control(&["reload"]));
    assert_eq!(shown(reached(&roots("own.pem")).status(1)).parts, 0);
}

fn a_reader_reads_only(server: &Server, at: &Path) {
    let admin = server.store("rights");
    // Twice, as after a migration.
    for _ in 0..2 {
        shown(Store::init(&admin, true));
    }
    for role in ["reader", "operator", "engineer"] {
        server.say("rights", &format!("CREATE USER a_{role} PASSWORD 'p'; GRANT truepath_{role} TO a_{role}"));
    }
    let as_role = |role: &str| server.place(&format!("a_{role}"), "p", "rights");
    let mut operator = shown(Store::open(&as_role("operator")));
    assert_eq!(shown(operator.add(&part(at, 1), &setup()))[0].new_parts, 2);
    let mut reader = shown(Store::open(&as_role("reader")));
    assert_eq!(shown(reader.status(5)).parts, 2);
    assert_eq!(code(reader.add(&part(at, 2), &setup())), "O004");
    assert_eq!(shown(reader.status(5)).parts, 2);
    // What is known already is no writing.
    assert!(shown(reader.history(1)) == history(1, 2, 8));
    let refused = |role: &str, statement: &str| {
        let url = format!("postgres://a_{role}:p@127.0.0.1:{}/rights", server.port);
        let mut client = postgres::Client::connect(&url, postgres::NoTls).expect("the server");
        let refused = client.batch_execute(statement).err().and_then(|e| e.code().cloned());
        refused == Some(postgres::error::SqlState::INSUFFICIENT_PRIVILEGE)
    };
    for table in ["part", "reading", "counter", "event", "schema_version"] {
        assert!(refused("reader", &format!("INSERT INTO {table} DEFAULT VALUES")), "a reader writes {table}");
        assert!(refused("operator", &format!("DELETE FROM {table}")), "an operator removes {table}");
    }
    assert!(refused("operator", "UPDATE reading SET error_nm = 0") && refused("engineer", "DELETE FROM event"));
    assert!(!refused("engineer", "UPDATE part SET temperature_c = 21.5 WHERE number = 1"));
}

fn what_is_wrong_with_a_server_is_told(server: &Server) {
    assert_eq!(code(Store::open(&server.place("admin", "wrong", "rights"))), "O001");
    assert_eq!(code(Store::open(&server.place("admin", "geheim", "none"))), "O001");
    assert_eq!(code(Store::open(&server.place("admin", "geheim", "postgres"))), "O002");
    let start = Instant::now();
    assert_eq!(code(Store::open(&Place::of("postgres://ann@127.0.0.1:1/shop"))), "O001");
    assert_eq!(code(Store::open(&Place::of("postgres://ann@127.0.0.1/shop?sslmode=odd"))), "O001");
    assert!(start.elapsed() < Duration::from_secs(6));
}

//! What is said of wrong input.

use std::fmt::Write;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

use expect_test::expect_file;
use rusqlite::Connection;

use crate::history::{begin, empty};
use crate::server::{Server, copier, outcome};

const SECRET: &str = "zwölf Katzen";

/// The outcomes of commands, as text.
struct Told<'a> {
    server: &'a Server,
    text: String,
}

impl Told<'_> {
    /// `FOLDER` is that of the server; variables come first, as in a shell.
    fn of(&mut self, variables: &[(&str, &str)], arguments: &[&str]) {
        let folder = self.server.path().to_str().unwrap();
        let arguments: Vec<String> = arguments.iter().map(|one| one.replace("FOLDER", folder)).collect();
        let mut command = copier();
        command.current_dir(folder).args(&arguments);
        for (name, value) in variables {
            command.env(name, value.replace("FOLDER", folder));
        }
        let (code, told) = outcome(&command.output().unwrap());
        let shown: String = variables.iter().map(|(name, value)| format!("{name}={value} ")).collect();
        let _ = writeln!(self.text, "$ {shown}saoms-postgres {}\n{told}[{code}]\n", arguments.join(" "));
        self.text = self.text.replace(folder, "FOLDER");
    }
}

#[test]
fn each_wrong_input_says_what_to_do() {
    let access = "local all ada scram-sha-256";
    let Some(server) = Server::start_with(&["listen_addresses="], access, |_| {}) else { return };
    let mut client = server.client("fleet");
    client
        .batch_execute(&format!(
            "CREATE USER ada PASSWORD '{SECRET}'; CREATE USER eve; CREATE SCHEMA music; CREATE TABLE music.titles (title text);
             CREATE SCHEMA given AUTHORIZATION ada"
        ))
        .unwrap();
    let path = |name: &str| server.path().join(name);
    begin(&empty(&path("h.db")), "hall", "2026-01-01T00:00:00.000Z");
    begin(&empty(&path("other.db")), "hall", "2026-01-01T00:00:00.000Z");
    fs::write(path("text.db"), "no database at all, but a text that is longer than a header of SQLite").unwrap();
    Connection::open(path("music.db")).unwrap().execute_batch("CREATE TABLE music (title TEXT)").unwrap();
    let earlier = empty(&path("earlier.db"));
    earlier.execute_batch("DROP TABLE history").unwrap();
    fs::write(path("passwords"), format!("*:*:fleet:ada:{SECRET}\n")).unwrap();
    let allow = |mode| fs::set_permissions(path("passwords"), fs::Permissions::from_mode(mode)).unwrap();
    server.bring(&path("h.db"), &[]);

    let mut told = Told { server: &server, text: String::new() };
    let fleet = "postgres:///fleet?host=FOLDER&user=postgres";
    told.of(&[], &["none.db", "--to", fleet]);
    told.of(&[], &["text.db", "--to", fleet]);
    told.of(&[], &["music.db", "--to", fleet]);
    told.of(&[], &["earlier.db", "--to", fleet]);
    told.of(&[], &["h.db", "--to", "fleet"]);
    told.of(&[], &["h.db", "--to", "postgres:///fleet?host=FOLDER&colour=red"]);
    told.of(&[], &["h.db", "--to", "postgres://server:port/fleet"]);
    told.of(&[], &["h.db", "--to", "postgres://server/fleet?sslmode=full"]);
    told.of(&[], &["h.db", "--to", "postgres://server/fleet?sslmode=verify-full"]);
    told.of(&[], &["h.db", "--to", "postgres://server/fleet?sslmode=verify-full&sslrootcert=text.db"]);
    told.of(&[], &["h.db", "--to", "postgres://ada:secret@server/fleet"]);
    told.of(&[], &["h.db", "--to-env", "FLEET_DATABASE"]);
    told.of(&[], &["h.db", "--to", fleet, "--schema", "pg_fleet"]);
    told.of(&[], &["h.db", "--to", "postgres:///fleet?host=FOLDER/none&user=postgres"]);
    told.of(&[], &["h.db", "--to", "postgres:///none?host=FOLDER&user=postgres"]);
    told.of(&[], &["h.db", "--to", "postgres:///fleet?host=FOLDER&user=nobody"]);
    told.of(&[], &["h.db", "--to", "postgres:///fleet?host=FOLDER&user=ada"]);
    told.of(&[("PGPASSWORD", "wrong")], &["h.db", "--to", "postgres:///fleet?host=FOLDER&user=ada"]);
    let url = "postgres://ada:wrong@/fleet?host=FOLDER";
    told.of(&[("FLEET_DATABASE", url)], &["h.db", "--to-env", "FLEET_DATABASE"]);
    allow(0o644);
    let file = [("PGPASSFILE", "FOLDER/passwords")];
    told.of(&file, &["h.db", "--to", "postgres:///fleet?host=FOLDER&user=ada", "--schema", "given"]);
    allow(0o600);
    told.of(&[], &["h.db", "--to", "postgres:///fleet?host=FOLDER&user=eve", "--schema", "eves"]);
    told.of(&[], &["h.db", "--to", "postgres:///fleet?host=FOLDER&user=eve", "--schema", "saoms"]);
    told.of(&[], &["h.db", "--to", fleet, "--schema", "music"]);
    told.of(&[], &["other.db", "--to", fleet]);
    // Those that are right.
    told.of(&file, &["h.db", "--to", "postgres:///fleet?host=FOLDER&user=ada", "--schema", "given"]);
    let escaped = "postgres://ada:zw%C3%B6lf%20Katzen@/fleet?host=FOLDER";
    told.of(&[("FLEET_DATABASE", escaped)], &["h.db", "--to-env", "FLEET_DATABASE", "--schema", "given"]);
    assert!(!told.text.contains(SECRET));
    expect_file!["wrong.txt"].assert_eq(&told.text);
}

#[test]
fn a_host_that_does_not_exist_is_wrong_input() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("h.db");
    begin(&empty(&file), "hall", "2026-01-01T00:00:00.000Z");
    let told = |file: &Path| {
        outcome(&copier().arg(file).args(["--to", "postgres://ada@nosuch.invalid/fleet"]).output().unwrap())
    };
    let (code, told) = told(&file);
    assert_eq!(code, 2, "{told}");
    assert!(told.contains("database `fleet` at nosuch.invalid:5432: there is no such host"), "{told}");
}

/// The command line of the unit for systemd is one that there is.
#[test]
fn the_service_of_the_package_starts() {
    let unit = fs::read_to_string("../../packages/saoms-postgres@.service").unwrap().replace("%i", "hall");
    let line = unit.lines().find_map(|line| line.strip_prefix("ExecStart=/usr/bin/saoms-postgres ")).unwrap();
    let mut command = copier();
    command.args(line.split(' ')).env("SAOMS_DATABASE", "postgres:///fleet?host=/none");
    let (code, told) = outcome(&command.output().unwrap());
    assert_eq!(code, 2, "{told}");
    assert!(told.contains("there is no history at `/var/lib/saoms/hall/history.db`"), "{told}");
}

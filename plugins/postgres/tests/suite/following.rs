//! A history that is followed while it is written.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use postgres::Client;
use rusqlite::Connection;

use crate::history::{airport, assert_same, begin, empty, hall, records};
use crate::server::{PATIENCE, Server, outcome, signal};

/// Waits until a table has so many rows.
pub(crate) fn wait_for(client: &mut Client, table: &str, count: i64) {
    let begun = Instant::now();
    loop {
        let found = client.query_one(&format!("SELECT count(*) FROM saoms.{table}"), &[]);
        let found = found.map_or(0, |row| row.get::<_, i64>(0));
        assert!(found <= count, "{found} rows of `{table}` in place of {count}");
        if found == count {
            return;
        }
        assert!(begun.elapsed() < PATIENCE, "{found} rows of `{table}` in place of {count}");
        sleep(Duration::from_millis(50));
    }
}

fn follow(server: &Server, file: &Path) -> Child {
    let mut copier = server.copier(file, &["--follow"]);
    copier.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Ends it as systemd does.
fn end(copier: Child) -> String {
    signal(&copier, libc::SIGTERM);
    let (code, told) = outcome(&copier.wait_with_output().unwrap());
    assert_eq!(code, 0, "{told}");
    told
}

#[test]
fn what_fleets_write_comes_over_meanwhile() {
    let Some(server) = Server::start() else { return };
    let file = server.path().join("airport.db");
    let history = empty(&file);
    let copier = follow(&server, &file);
    for seed in 1..=3 {
        airport(&file, seed);
    }
    let count: i64 = history.query_row("SELECT count(*) FROM records", [], |row| row.get(0)).unwrap();
    let mut client = server.client("fleet");
    wait_for(&mut client, "records", count);
    wait_for(&mut client, "reports", 3);
    let told = end(copier);
    assert!(told.starts_with("brought: runs ") && told.lines().count() == 1, "{told}");
    // A run is known as complete after its last rows; the next look finds it so.
    server.bring(&file, &[]);
    assert_same(&history, &mut client, "saoms");
}

#[test]
fn a_server_that_is_away_is_waited_for_and_nothing_is_lost() {
    let Some(mut server) = Server::start() else { return };
    let (file, mut history, run) = hall(&server);
    server.stop();
    let copier = follow(&server, &file);
    records(&mut history, run, 1..=6000);
    server.go_on();
    wait_for(&mut server.client("fleet"), "records", 6000);
    for round in 1..=3 {
        server.stop();
        let first = 6000 + (round - 1) * 1000;
        records(&mut history, run, first + 1..=first + 1000);
        history.execute("UPDATE runs SET lost = ?", [round]).unwrap();
        server.go_on();
        wait_for(&mut server.client("fleet"), "records", first + 1000);
    }
    let told = end(copier);
    assert_same(&history, &mut server.client("fleet"), "saoms");
    // It says once that the server is away, and once that it is there again.
    let (away, again) = (told.matches("waiting until that is over").count(), told.matches("is there again").count());
    assert!(away == again && (1..=4).contains(&away), "{told}");
}

#[test]
fn a_copier_that_is_killed_at_any_moment_neither_loses_nor_doubles_rows() {
    let Some(server) = Server::start() else { return };
    let (file, mut history, run) = hall(&server);
    records(&mut history, run, 1..=50_000);
    let mut last = 50_000;
    // A generator of Lehmer: the moments differ.
    let mut chance: u64 = 20_261_130;
    for round in 1..=20 {
        let mut copier = follow(&server, &file);
        chance = chance * 48_271 % 0x7fff_ffff;
        let begun = Instant::now();
        while begun.elapsed() < Duration::from_millis(chance % 400) {
            // Some records come late, as those of components whose executions last.
            records(&mut history, run, last + 11..=last + 510);
            records(&mut history, run, last + 1..=last + 10);
            last += 510;
            let written = [
                "INSERT INTO deliveries (run, time_s, piece, number, robot) VALUES (1, ?1, 'luggage', ?1, 'Robot1')",
                "INSERT INTO alerts VALUES (1, ?1, 'assistance', 'Robot1', '', 'is stuck', ?1 / 1.0, NULL)",
                "UPDATE alerts SET over_s = ?1 / 1.0 WHERE run = 1 AND alert < ?1 AND over_s IS NULL",
            ];
            for statement in written {
                history.execute(statement, [last]).unwrap();
            }
        }
        copier.kill().unwrap();
        let (code, told) = outcome(&copier.wait_with_output().unwrap());
        assert_eq!((code, told.as_str()), (-1, ""), "round {round}");
    }
    server.bring(&file, &[]);
    assert_same(&history, &mut server.client("fleet"), "saoms");
}

#[test]
fn two_copiers_at_a_time_double_nothing() {
    let Some(server) = Server::start() else { return };
    let (file, mut history, run) = hall(&server);
    let copiers = [follow(&server, &file), follow(&server, &file)];
    for batch in 0..20 {
        records(&mut history, run, batch * 1000 + 1..=batch * 1000 + 1000);
        let insert = "INSERT INTO deliveries (run, time_s, number) VALUES (1, 1.0, ?)";
        history.execute(insert, [batch]).unwrap();
        sleep(Duration::from_millis(50));
    }
    let mut client = server.client("fleet");
    wait_for(&mut client, "records", 20_000);
    wait_for(&mut client, "deliveries", 20);
    copiers.into_iter().for_each(|copier| drop(end(copier)));
    assert_same(&history, &mut client, "saoms");
}

#[test]
fn a_file_that_is_replaced_ends_it() {
    let Some(server) = Server::start() else { return };
    let file = server.path().join("h.db");
    begin(&empty(&file), "hall", "2026-01-01T00:00:00.000Z");
    let copier = follow(&server, &file);
    wait_for(&mut server.client("fleet"), "runs", 1);
    let other = server.path().join("other.db");
    begin(&empty(&other), "yard", "2026-01-01T00:00:05.000Z");
    Connection::open(&other).unwrap().execute_batch("PRAGMA wal_checkpoint(TRUNCATE)").unwrap();
    std::fs::rename(&other, &file).unwrap();
    let (code, told) = outcome(&copier.wait_with_output().unwrap());
    assert!(code == 2 && told.contains("was removed or replaced while it was read"), "{told}");
}

#[test]
fn who_is_stopped_halfway_says_so_and_fails() {
    let Some(server) = Server::start() else { return };
    let (file, mut history, run) = hall(&server);
    server.bring(&file, &[]);
    records(&mut history, run, 1..=20_000);
    let mut client = server.client("fleet");
    // The copier waits with its first batch until this is over.
    let mut lock = client.transaction().unwrap();
    lock.batch_execute("LOCK TABLE saoms.records IN SHARE MODE").unwrap();
    let copier = server.copier(&file, &[]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let begun = Instant::now();
    while lock.query("SELECT 1 FROM pg_locks WHERE NOT granted", &[]).unwrap().is_empty() {
        assert!(begun.elapsed() < PATIENCE);
        sleep(Duration::from_millis(20));
    }
    signal(&copier, libc::SIGTERM);
    // It hears of the signal in a thread of its own.
    sleep(Duration::from_millis(300));
    lock.rollback().unwrap();
    let (code, told) = outcome(&copier.wait_with_output().unwrap());
    let expected = "brought: records 5000\nerror: stopped before all was brought: start it again to bring the rest\n";
    assert_eq!((code, told.as_str()), (1, expected));
    assert_eq!(server.bring(&file, &[]), "brought: records 15000\n");
}

#[test]
fn a_server_that_only_reads_is_waited_for_and_nothing_is_counted_twice() {
    let Some(mut server) = Server::start() else { return };
    let (file, mut history, run) = hall(&server);
    records(&mut history, run, 1..=100);
    server.bring(&file, &[]);
    records(&mut history, run, 101..=200);
    history.execute_batch("DELETE FROM records WHERE id <= 120").unwrap();
    server.stop();
    // As one of which another server is the copy, until it takes over.
    server.go_on_with(&["listen_addresses=", "default_transaction_read_only=on"]);
    let mut copier = follow(&server, &file);
    let mut told = String::new();
    BufReader::new(copier.stderr.as_mut().unwrap()).read_line(&mut told).unwrap();
    assert!(told.contains("read-only transaction; waiting until that is over"), "{told}");
    server.stop();
    server.go_on_with(&["listen_addresses="]);
    wait_for(&mut server.client("fleet"), "records", 180);
    let told = end(copier);
    let expected = "brought: records 80; records that were removed from the file before: 20\n";
    assert!(told.contains(expected), "{told}");
}

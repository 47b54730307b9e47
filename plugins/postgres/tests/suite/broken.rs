//! Schemas and files that became others than they were.

use std::fs;

use rusqlite::Connection;

use crate::history::{begin, hall};
use crate::server::{Server, outcome};

#[test]
fn a_schema_that_lacks_what_was_brought_or_has_other_types_is_refused() {
    let Some(server) = Server::start() else { return };
    let (file, history, _) = hall(&server);
    let insert = "INSERT INTO deliveries (run, time_s, number) VALUES (1, 1.0, 2)";
    history.execute_batch(insert).unwrap();
    server.bring(&file, &[]);
    let told = |change: &str| {
        server.client("fleet").batch_execute(change).unwrap();
        let (code, told) = outcome(&server.copier(&file, &[]).output().unwrap());
        assert_eq!(code, 2, "{told}");
        told
    };
    let text = told("ALTER TABLE saoms.deliveries ALTER number TYPE text");
    assert!(text.contains("the column `number` of the table `deliveries`"), "{text}");
    assert!(text.contains("is of the type text, expected bigint: name another schema"), "{text}");
    let text = told("DROP TABLE saoms.deliveries");
    assert!(text.contains("`deliveries` of the schema `saoms`") && text.contains("was removed, though rows"), "{text}");
}

#[test]
fn an_earlier_copy_of_the_file_is_refused() {
    let Some(server) = Server::start() else { return };
    let (file, history, _) = hall(&server);
    let copy = server.path().join("copy.db");
    history.execute_batch("PRAGMA wal_checkpoint(TRUNCATE)").unwrap();
    fs::copy(&file, &copy).unwrap();
    begin(&history, "hall", "2026-01-02T00:00:00.000Z");
    server.bring(&file, &[]);
    begin(&Connection::open(&copy).unwrap(), "hall", "2026-01-03T00:00:00.000Z");
    let (code, told) = outcome(&server.copier(&copy, &[]).output().unwrap());
    assert_eq!(code, 2, "{told}");
    assert!(told.contains("has run 2, which began at 2026-01-02T00:00:00.000Z and is not in"), "{told}");
    assert!(told.contains("name the file that has this run, or name another schema"), "{told}");
}

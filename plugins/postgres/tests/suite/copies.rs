//! What comes over, once.

use std::process::Command;

use expect_test::expect;
use rusqlite::Connection;

use crate::history::{airport, assert_same, begin, empty, hall, records};
use crate::server::Server;

#[test]
fn the_history_of_an_airport_comes_over_row_for_row() {
    let Some(server) = Server::start() else { return };
    let file = server.path().join("airport.db");
    airport(&file, 1);
    airport(&file, 2);
    let history = Connection::open(&file).unwrap();
    let told = server.bring(&file, &[]);
    let count = |table: &str| -> i64 {
        history.query_row(&format!("SELECT count(*) FROM {table}"), [], |row| row.get(0)).unwrap()
    };
    let rows = ["runs", "components", "records", "alerts", "reports", "history", "deliveries", "requests"];
    let rows = rows.map(|table| format!("{table} {}", count(table))).join(", ");
    assert_eq!(told, format!("brought: {rows}\n"));
    let mut client = server.client("fleet");
    assert_same(&history, &mut client, "saoms");
    assert_eq!(server.bring(&file, &[]), "brought: nothing new\n");
    assert_same(&history, &mut client, "saoms");
    // Another run is added to them.
    airport(&file, 3);
    server.bring(&file, &[]);
    assert_same(&history, &mut client, "saoms");
    let answer = client
        .query_one(
            "SELECT count(*), min(report -> 'outcome' ->> 'status') FROM saoms.records JOIN saoms.reports USING (run) \
             WHERE data ->> 'before' IS NOT NULL",
            &[],
        )
        .unwrap();
    assert!(answer.get::<_, i64>(0) > 0 && answer.get::<_, &str>(1) == "done");
}

#[test]
fn tables_are_documented_and_have_keys_and_indexes() {
    let Some(server) = Server::start() else { return };
    let (file, _history, _) = hall(&server);
    server.bring(&file, &["--schema", "Halle 7"]);
    let mut shown = String::new();
    for table in ["deliveries", "alerts", "copied"] {
        let shows = |what: &str| {
            let mut psql = Command::new("psql");
            psql.args(["--no-psqlrc", "--tuples-only", "--no-align"]).arg(server.url()).args(["-c", what]);
            String::from_utf8(psql.output().unwrap().stdout).unwrap()
        };
        let class = format!("'\"Halle 7\".{table}'::regclass");
        shown += &shows(&format!("SELECT '{table}: ' || obj_description({class})"));
        shown += &shows(&format!(
            "SELECT format('  %s  %s  %s', attname, format_type(atttypid, -1), col_description(attrelid, attnum)) \
             FROM pg_attribute WHERE attrelid = {class} AND attnum > 0 ORDER BY attnum LIMIT 6"
        ));
        shown += &shows(&format!(
            "SELECT '  ' || regexp_replace(pg_get_indexdef(indexrelid), ' USING.*[(]', ' (') \
             FROM pg_index WHERE indrelid = {class}"
        ));
    }
    expect![[r#"
        deliveries: A piece of luggage that was brought or given up, or a visit that was done
          run  bigint  the run
          time_s  double precision  when, in seconds of the run
          site  text  the site, such as `North`; empty outside of sites
          piece  text  `luggage` or `visit`
          number  bigint  the number of the luggage, or of the visit from 1 on
          outcome  text  `delivered` or `given up`
          CREATE INDEX deliveries_as_written ON "Halle 7".deliveries (run)
          CREATE INDEX deliveries_of_run ON "Halle 7".deliveries (run, time_s)
        alerts: What needed a person
          run  bigint  the run
          alert  bigint  its number in the run, from 1 on
          kind  text  its kind, as `assistance`
          component  text  the component; empty for the whole fleet
          subject  text  what it is about, where a component has several of a kind
          text  text  what is wrong, as it was said last
          CREATE UNIQUE INDEX alerts_pkey ON "Halle 7".alerts (run, alert)
        copied: How far saoms-postgres has brought each table
          table_name  text  the table
          run  bigint  the run; 0 where a table is not brought by runs
          position  bigint  the last record or row; of the table runs 1 if all of a run is here
          gaps  text  records before it that are not there yet, or were lost, as 17-17 101-105
          CREATE UNIQUE INDEX copied_pkey ON "Halle 7".copied (table_name, run)
    "#]]
    .assert_eq(&shown);
}

#[test]
fn rows_that_change_are_brought_up_to_date_and_removed_ones_stay() {
    let Some(server) = Server::start() else { return };
    let (file, mut history, run) = hall(&server);
    let other = begin(&history, "yard", "2026-01-01T00:00:01.000Z");
    records(&mut history, run, 1..=100);
    history
        .execute_batch(
            "INSERT INTO components VALUES (1, 'Robot1', '1', 0.1), (2, 'Robot1', NULL, NULL);
             INSERT INTO alerts VALUES (1, 1, 'assistance', 'Robot1', '', 'is stuck', 3.5, NULL);",
        )
        .unwrap();
    let mut client = server.client("fleet");
    server.bring(&file, &[]);
    assert_same(&history, &mut client, "saoms");
    history
        .execute_batch(
            "UPDATE alerts SET text = 'is stuck again', over_s = 5.0;
             INSERT INTO components VALUES (1, 'Joined', NULL, NULL);
             UPDATE runs SET ended = '2026-01-01T00:01:00.000Z', status = 'failed', time_s = 59.5, lost = 2
                 WHERE run = 1;
             INSERT INTO reports VALUES (1, '{\"outcome\":{\"status\":\"failed\"}}');
             UPDATE runs SET lost = 7 WHERE run = 2;",
        )
        .unwrap();
    let told = server.bring(&file, &[]);
    assert_eq!(told, "brought: runs 2, components 1, alerts 1, reports 1\n");
    assert_same(&history, &mut client, "saoms");
    // What is said of a run that has ended is still compared; what the file no longer has stays.
    history.execute_batch("UPDATE runs SET lost = 3 WHERE run = 1; DELETE FROM records WHERE id <= 50").unwrap();
    records(&mut history, other, 1..=10);
    assert_eq!(server.bring(&file, &[]), "brought: runs 1, records 10\n");
    let kept: i64 = client.query_one("SELECT count(*) FROM saoms.records", &[]).unwrap().get(0);
    assert_eq!(kept, 110);
    // Unless that is asked for: the first run has ended long ago, the other one goes on.
    let told = server.bring(&file, &["--keep", "24h"]);
    assert_eq!(told, "brought: nothing new; old records removed: 110\n");
    assert_eq!(server.bring(&file, &[]), "brought: nothing new\n");
}

#[test]
fn records_that_come_late_are_brought_too() {
    let Some(server) = Server::start() else { return };
    let (file, mut history, run) = hall(&server);
    let mut client = server.client("fleet");
    for (added, count) in [(11..=20, 10), (31..=40, 10), (21..=25, 5), (1..=10, 10), (29..=30, 2), (26..=28, 3)] {
        records(&mut history, run, added);
        let told = server.bring(&file, &[]);
        assert!(told.contains(&format!("records {count}")), "{told}");
        assert_same(&history, &mut client, "saoms");
    }
    let gaps: String = client.query_one("SELECT gaps FROM saoms.copied", &[]).unwrap().get(0);
    assert_eq!(gaps, "");
}

#[test]
fn records_that_were_removed_before_they_were_brought_are_counted() {
    let Some(server) = Server::start() else { return };
    let (file, mut history, run) = hall(&server);
    records(&mut history, run, 1..=100);
    server.bring(&file, &[]);
    records(&mut history, run, 101..=200);
    history.execute_batch("DELETE FROM records WHERE id <= 120").unwrap();
    let told = server.bring(&file, &[]);
    assert_eq!(told, "brought: records 80; records that were removed from the file before: 20\n");
}

#[test]
fn texts_of_all_kinds_come_over_and_nul_is_replaced() {
    let Some(server) = Server::start() else { return };
    let file = server.path().join("h.db");
    let history = empty(&file);
    let name = "<script>alert('x')</script> \"q\" \\ $1 🤖 ü\u{202e}\u{1b}[2J\t\n%s; DROP TABLE saoms.runs; --";
    let run = begin(&history, name, "2026-01-01T00:00:00.000Z");
    let insert =
        "INSERT INTO records (run, id, time_s, component, phase, text, data) VALUES (?, ?, 1e-300, ?, 'effect', ?, ?)";
    let data = serde_json::json!({ name: [name, 1.5, null, { "\\u0000": "\\u0000" }] }).to_string();
    history.execute(insert, rusqlite::params![run, i64::MAX, name, name, data]).unwrap();
    history
        .execute(
            "INSERT INTO deliveries (run, time_s, robot, number) VALUES (?, ?, ?, ?)",
            rusqlite::params![run, f64::INFINITY, name, i64::MIN],
        )
        .unwrap();
    let mut client = server.client("fleet");
    assert_eq!(server.bring(&file, &[]), "brought: runs 1, records 1, history 1, deliveries 1\n");
    assert_same(&history, &mut client, "saoms");
    let nul = serde_json::json!({ "a\0b": "c\0d" }).to_string();
    history.execute(insert, rusqlite::params![run, 1, "Robot\u{0}1", "\u{0}", nul]).unwrap();
    let broken = begin(&history, "next", "2026-01-01T00:00:02.000Z");
    history.execute(insert, rusqlite::params![broken, 1, "Robot1", "", "no json"]).unwrap();
    let told = server.bring(&file, &[]);
    assert_eq!(
        told,
        "brought: runs 1, records 2; rows with characters that PostgreSQL does not take, which were replaced: 2\n"
    );
    let rows =
        client.query("SELECT component, text, data::text FROM saoms.records WHERE id = 1 ORDER BY run DESC", &[]);
    let rows: Vec<[String; 3]> = rows.unwrap().iter().map(|row| [row.get(0), row.get(1), row.get(2)]).collect();
    assert_eq!(rows[0], ["Robot1", "", "\"no json\""]);
    assert_eq!(rows[1], ["Robot\u{fffd}1", "\u{fffd}", "{\"a\u{fffd}b\": \"c\u{fffd}d\"}"]);
}

#[test]
fn rows_that_the_server_refuses_are_counted_and_the_others_come() {
    let Some(server) = Server::start() else { return };
    let (file, mut history, run) = hall(&server);
    server.bring(&file, &[]);
    let mut client = server.client("fleet");
    client.batch_execute("ALTER TABLE saoms.records ADD CHECK (id NOT IN (17, 6001, 6002))").unwrap();
    records(&mut history, run, 1..=7000);
    let output = server.copier(&file, &[]).output().unwrap();
    let (code, told) = crate::server::outcome(&output);
    assert_eq!(code, 1);
    let expected = "brought: records 6997; refused: 3, the first in `records`: new row for relation \"records\" violates \
                    check constraint \"records_id_check\"";
    assert!(told.starts_with(expected), "{told}");
    assert_eq!(server.bring(&file, &[]), "brought: nothing new\n");
}

#[test]
fn tables_and_columns_of_a_later_version_are_added() {
    let Some(server) = Server::start() else { return };
    let (file, history, _) = hall(&server);
    server.bring(&file, &[]);
    history
        .execute_batch(
            "ALTER TABLE runs ADD COLUMN place TEXT;
             UPDATE runs SET place = 'Graz';
             CREATE TABLE doors (run INTEGER NOT NULL, time_s REAL NOT NULL, \"loop\" TEXT) STRICT;
             INSERT INTO doors VALUES (1, 0.5, 'open'), (1, 0.5, 'open');",
        )
        .unwrap();
    assert_eq!(server.bring(&file, &[]), "brought: runs 1, doors 2\n");
    assert_same(&history, &mut server.client("fleet"), "saoms");
}

#[test]
fn a_backslash_is_one_whatever_the_server_is_set_to() {
    let options = ["listen_addresses=", "standard_conforming_strings=off"];
    let Some(server) = Server::start_with(&options, "", |_| {}) else { return };
    let file = server.path().join("h.db");
    let history = empty(&file);
    let doc = r"Doors with a \ in it, and a \' at the end \";
    history.execute_batch(&format!("CREATE TABLE doors (\n    -- {doc}\n    name TEXT\n) STRICT")).unwrap();
    server.bring(&file, &[]);
    let told = server.client("fleet").query_one("SELECT obj_description('saoms.doors'::regclass)", &[]).unwrap();
    assert_eq!(told.get::<_, &str>(0), doc);
}

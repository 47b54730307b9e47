//! What is written of a run, and what becomes of rows that cannot be.

use std::path::Path;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

use rusqlite::Connection;
use saoms_api::Time;
use saoms_api::extension::HistoryValue;
use saoms_core::observe::{Beginning, Observer, Occurrence, RunEvent};

use crate::{History, HistoryError, HistoryEvents, HistoryRun, Questions};

/// What was told, in order.
#[derive(Clone, Default)]
struct Told(Arc<Mutex<Vec<String>>>);

impl HistoryEvents for Told {
    fn fails(&self, text: &str) {
        self.0.lock().unwrap().push(text.to_owned());
    }

    fn works(&self) {
        self.0.lock().unwrap().push("works".to_owned());
    }
}

fn begun(path: &Path, told: &Told) -> History {
    let run = HistoryRun { name: "hall".to_owned(), version: "1".to_owned(), ..HistoryRun::default() };
    let history = History::open(path, run, None, Box::new(told.clone())).unwrap();
    history.begin(&Beginning { seed: u64::MAX, is_virtual: false, components: &[] }).unwrap();
    history
}

fn alert(second: u64, subject: &str, text: Option<&str>) -> RunEvent {
    RunEvent {
        time: Time::from_nanos(second * 1_000_000_000),
        component: Some(Arc::from("Robot1")),
        what: Occurrence::Alert {
            kind: Arc::from("assistance"),
            subject: Arc::from(subject),
            text: text.map(str::to_owned),
        },
    }
}

fn ask(path: &Path, question: &str) -> Vec<Vec<HistoryValue>> {
    Questions::open(path).unwrap().ask(question).unwrap().rows
}

#[test]
fn an_alert_is_one_row_from_its_begin_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("h.db");
    let history = begun(&path, &Told::default());
    for event in [
        alert(1, "a", Some("is stuck")),
        alert(2, "b", Some("is lost")),
        alert(3, "a", Some("is stuck again")),
        alert(4, "a", None),
        alert(5, "a", None),
        alert(6, "a", Some("is stuck")),
    ] {
        history.event(&event);
    }
    let rows = ask(&path, "select alert, subject, text, raised_s, over_s from alerts order by alert");
    let row = |alert, subject: &str, text: &str, raised, over: Option<f64>| {
        let [subject, text] = [subject, text].map(|text| HistoryValue::Text(text.to_owned()));
        vec![
            HistoryValue::Integer(alert),
            subject,
            text,
            HistoryValue::Real(raised),
            over.map_or(HistoryValue::Null, HistoryValue::Real),
        ]
    };
    assert_eq!(
        rows,
        [
            row(1, "a", "is stuck again", 1.0, Some(4.0)),
            row(2, "b", "is lost", 2.0, None),
            row(3, "a", "is stuck", 6.0, None)
        ]
    );
    let seed = ask(&path, "select seed, ended from runs");
    assert_eq!(seed, [[HistoryValue::Text(u64::MAX.to_string()), HistoryValue::Null]]);
}

#[test]
fn rows_that_cannot_be_written_are_counted_and_told_until_they_can() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("h.db");
    let told = Told::default();
    let history = begun(&path, &told);
    let other = Connection::open(&path).unwrap();
    other.execute_batch("begin immediate").unwrap();
    for second in 1..=3 {
        history.event(&alert(second, "a", Some("is stuck")));
    }
    assert_eq!(history.lost().load(Ordering::Relaxed), 3);
    other.execute_batch("commit").unwrap();
    history.event(&alert(4, "b", Some("is lost")));
    let told = told.0.lock().unwrap().clone();
    assert!(told[0].contains("h.db`: database is locked; rows are lost"), "{told:?}");
    assert_eq!(told[1..], ["works"]);
    assert_eq!(ask(&path, "select subject from alerts"), [[HistoryValue::Text("b".to_owned())]]);
    assert_eq!(ask(&path, "select lost from runs"), [[HistoryValue::Integer(3)]]);
    history.event(&alert(5, "a", Some("is stuck")));
    let row = |number, subject: &str| vec![HistoryValue::Integer(number), HistoryValue::Text(subject.to_owned())];
    assert_eq!(ask(&path, "select alert, subject from alerts order by alert"), [row(1, "b"), row(2, "a")]);
}

#[test]
fn a_history_has_a_name_for_good_and_says_what_stands_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let [path, other] = ["h.db", "other.db"].map(|name| folder.path().join(name));
    let name = |path: &Path| {
        drop(begun(path, &Told::default()));
        ask(path, "select id, length(id) from history")
    };
    let [first, again, different] = [name(&path), name(&path), name(&other)];
    assert!(first == again && first != different, "{first:?}");
    assert_eq!(first[0][1], HistoryValue::Integer(32));
    let [HistoryValue::Text(statement)] = &ask(&path, "select sql from sqlite_schema where name = 'components'")[0][..]
    else {
        panic!("no statement");
    };
    assert_eq!(
        statement,
        "CREATE TABLE components (\n  -- A component of a run\n  run INTEGER NOT NULL, -- the run\n  \
         component TEXT NOT NULL, -- its path, as `North/Gate`\n  id TEXT, -- its `ID`\n  \
         period_s REAL -- its period, in seconds\n, PRIMARY KEY (run, component)) STRICT, WITHOUT ROWID"
    );
}

#[test]
fn a_question_may_have_values() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("h.db");
    drop(begun(&path, &Told::default()));
    let values = [HistoryValue::Integer(1), HistoryValue::Text("a\0'b".to_owned()), HistoryValue::Null];
    let answer = Questions::open(&path).unwrap().ask_with("select run, ?2, ?3 from runs where run = ?1", &values);
    assert_eq!(answer.unwrap().rows, [values]);
}

#[test]
fn histories_of_others_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let [foreign, later] = ["foreign.db", "later.db"].map(|name| folder.path().join(name));
    Connection::open(&foreign).unwrap().execute_batch("create table music (title text)").unwrap();
    let open = |path: &Path| History::open(path, HistoryRun::default(), None, Box::new(Told::default())).map(|_| ());
    assert!(matches!(open(&foreign), Err(HistoryError::Foreign { .. })));
    assert!(matches!(Questions::open(&foreign), Err(HistoryError::Foreign { .. })));
    assert!(matches!(Questions::open(&folder.path().join("none.db")), Err(HistoryError::Missing { .. })));
    open(&later).unwrap();
    Connection::open(&later).unwrap().pragma_update(None, "user_version", 2).unwrap();
    assert!(matches!(open(&later), Err(HistoryError::Version { version: 2, .. })));
}

//! What is written of a run, and what becomes of rows that cannot be.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex};

use rusqlite::Connection;
use saoms_api::extension::{HistoryColumn, HistoryKind, HistoryRow, HistoryTable, HistoryValue};
use saoms_api::host::Registration;
use saoms_api::{Class, Component, Context, Failure, Time, Work};
use saoms_core::observe::{Beginning, LostEvents, Observer, Occurrence, RunEvent, WriterEvents};
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;

use crate::retention::OF_EARLIER_RUNS;
use crate::writer::{Writer, earlier, open};
use crate::{History, HistoryError, HistoryRun, Questions};

/// What was told, in order.
#[derive(Clone, Default)]
struct Told(Arc<Mutex<Vec<String>>>);

impl WriterEvents for Told {
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

/// Waits in its first event until somebody lets it go on, and counts all that come.
#[derive(Default)]
struct Slow {
    goes_on: Mutex<bool>,
    wake: Condvar,
    alerts: AtomicU64,
    lost: AtomicU64,
}

impl Observer for Slow {
    fn event(&self, event: &RunEvent) {
        drop(self.wake.wait_while(self.goes_on.lock().unwrap(), |goes_on| !*goes_on).unwrap());
        self.alerts.fetch_add(u64::from(matches!(event.what, Occurrence::Alert { .. })), Ordering::Relaxed);
    }

    fn lost(&self, lost: LostEvents) {
        self.lost.fetch_add(lost.alerts, Ordering::Relaxed);
    }
}

/// Raises an alert again and again.
#[derive(Class)]
#[class(name = "test.Bell", periodic)]
struct Bell {
    rung: u64,
}

/// Alerts in each execution, and executions: more than may wait beside those that are being delivered.
const AT_ONCE: u64 = 1000;
const TIMES: u64 = 90;

impl Component for Bell {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Bell { rung: 0 })
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for _ in 0..AT_ONCE {
            self.rung += 1;
            context.alert("bell", "door", format_args!("rings {} times", self.rung));
        }
        context.vote(if self.rung >= AT_ONCE * TIMES { Work::Done } else { Work::Open });
        Ok(())
    }
}

#[test]
fn what_is_lost_before_it_comes_here_is_counted_as_rows_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("h.db");
    let run = HistoryRun { name: "hall".to_owned(), version: "1".to_owned(), ..HistoryRun::default() };
    let history = Arc::new(History::open(&path, run, None, Box::new(Told::default())).unwrap());
    let (slow, mut registry) = (Arc::new(Slow::default()), Registry::new());
    registry.add(Registration::of::<Bell>()).unwrap();
    let text = "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"hall\" \
                targetNamespace=\"urn:hall\"><component name=\"Bell\"><implementation.rust class=\"test.Bell\"/>\
                <property name=\"ID\">Bell</property><property name=\"period\">1</property></component></composite>";
    let assembly = Project::new().text("hall.composite", text).in_memory().compile(&registry).output.unwrap();
    let observers: Vec<Arc<dyn Observer>> = vec![slow.clone(), history.clone()];
    let fleet = RunningFleet::start(assembly, Settings::default(), observers).unwrap();
    fleet.wait_for_end();
    *slow.goes_on.lock().unwrap() = true;
    slow.wake.notify_all();
    fleet.run_to_end();
    let (heard, lost) = (slow.alerts.load(Ordering::Relaxed), slow.lost.load(Ordering::Relaxed));
    assert!(lost > 0 && heard + lost >= AT_ONCE * TIMES, "{heard} heard, {lost} lost");
    assert_eq!(history.lost().load(Ordering::Relaxed), lost);
    assert_eq!(ask(&path, "select lost from runs"), [[HistoryValue::Integer(lost as i64)]]);
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
fn rows_of_earlier_programs_come_one_by_one_as_they_were_written() {
    const TABLES: &[HistoryTable] = &[HistoryTable {
        name: "rings",
        doc: "A ring of a bell",
        columns: &[HistoryColumn { name: "bell", kind: HistoryKind::Text, doc: "the bell" }],
    }];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("h.db");
    let tables: Vec<&HistoryTable> = TABLES.iter().collect();
    let begin = |state: &str, from_s: Option<f64>| {
        let connection = open(&path, &tables).unwrap();
        let mut writer = Writer::begin(connection, &tables, (&HistoryRun::default(), None), ("real", 1)).unwrap();
        writer.has_state(state, from_s).unwrap();
        writer
    };
    let write = |writer: &mut Writer, rings: &[(f64, &str)]| {
        for (time_s, bell) in rings {
            let row = HistoryRow { table: 0, values: vec![HistoryValue::from(*bell)] };
            writer.rows(TABLES, *time_s, &[row]).unwrap();
        }
    };
    // What a thread beside the others sent may have an earlier time than what was written before.
    write(&mut begin("hall", None), &[(1.0, "a"), (3.0, "b"), (2.0, "c"), (3.0, "d"), (5.0, "undone")]);
    write(&mut begin("other", None), &[(1.0, "of another fleet")]);
    write(&mut begin("hall", Some(4.0)), &[(4.0, "e"), (4.0, "f")]);
    let mut read = Vec::new();
    let last = begin("hall", Some(6.0));
    last.each_earlier((0, &TABLES[0]), |time_s, row| read.push((time_s, row.values[0].clone()))).unwrap();
    let expected = [(1.0, "a"), (3.0, "b"), (2.0, "c"), (3.0, "d"), (4.0, "e"), (4.0, "f")];
    assert_eq!(read, expected.map(|(time_s, bell)| (time_s, HistoryValue::from(bell))));
    // Nothing is sorted, which would take as much memory or space as there are rows, and no rows of other fleets are
    // looked at.
    let steps = plan(&path, &earlier(&TABLES[0]));
    assert!(!steps.iter().any(|step| step.starts_with("SCAN") || step.contains("B-TREE")), "{steps:?}");
}

#[test]
fn old_records_are_looked_for_in_runs_alone_that_may_have_some() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("h.db");
    drop(begun(&path, &Told::default()));
    let steps = plan(&path, OF_EARLIER_RUNS);
    let scans: Vec<&String> = steps.iter().filter(|step| step.starts_with("SCAN")).collect();
    assert_eq!(scans, ["SCAN r"], "{steps:?}");
    let connection = Connection::open(&path).unwrap();
    let ago = |hours: u32| format!("strftime('%Y-%m-%dT%H:%M:%fZ', 'now', '-{hours} hours')");
    // Two that ended, one of them long ago, and one that was killed: its first record is old.
    for (began, ended) in [(9, Some(7)), (9, Some(1)), (6, None)] {
        let ended = ended.map_or_else(|| "NULL".to_owned(), ago);
        let run = format!(
            "INSERT INTO runs (name, composites, version, clock, seed, began, ended) \
             VALUES ('hall', '[]', '1', 'real', '1', {}, {ended})",
            ago(began)
        );
        connection.execute(&run, []).unwrap();
        let record = "INSERT INTO records (run, id, time_s, component, phase, text) \
                      VALUES (last_insert_rowid(), ?1, ?2, 'Robot1', 'effect', 'moved')";
        for (id, time_s) in [(1, 60.0), (2, 7100.0)] {
            connection.execute(record, rusqlite::params![id, time_s]).unwrap();
        }
    }
    let removed = connection.execute(OF_EARLIER_RUNS, rusqlite::params![1, 5.0 * 3600.0, 50_000]).unwrap();
    let left = ask(&path, "select run, id from records order by 1, 2");
    let row = |run, id| vec![HistoryValue::Integer(run), HistoryValue::Integer(id)];
    assert_eq!((removed, left), (3, vec![row(3, 1), row(3, 2), row(4, 2)]));
}

/// The steps in which SQLite answers.
fn plan(path: &Path, statement: &str) -> Vec<String> {
    let connection = Connection::open(path).unwrap();
    let mut plan = connection.prepare(&format!("EXPLAIN QUERY PLAN {statement}")).unwrap();
    let values = vec![1; plan.parameter_count()];
    let steps = plan.query_map(rusqlite::params_from_iter(values), |row| row.get::<_, String>(3)).unwrap();
    steps.map(Result::unwrap).collect()
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

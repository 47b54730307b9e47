//! Executions on other threads: who called another component, and that one, go back to the same moment.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::sleep;
use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Saved, Subscription};
use saoms_core::schedule::{InjectedContent, Injection};
use serde_json::json;

use super::{Count, behind, first_number, run};
use crate::actor::{EchoReference, NUMBERS, Own};
use crate::fleet::real;

/// Number of executions of the clerk that have called, and of those that are over.
static CALLED: AtomicU64 = AtomicU64::new(0);
static RETURNED: AtomicU64 = AtomicU64::new(0);

/// Asks a book in each execution, and does something else for long, on a thread of its own.
#[derive(Class)]
#[class(name = "clerk", periodic, saves, apart)]
pub(super) struct Clerk {
    /// For how long, in milliseconds.
    #[property(default = 0)]
    takes: u64,
    #[reference("peer")]
    book: Option<EchoReference>,
    asked: u64,
}

impl Component for Clerk {
    type Properties = saoms_api::Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let Some(book) = &self.book else { return Ok(()) };
        let counted = book.echo(context, String::new())?;
        self.asked += 1;
        if counted != self.asked.to_string() {
            return Err(Failure::new(format!("gap: it asked {} times, and the book has {counted}", self.asked)));
        }
        if context.execution() == 0 {
            context.info(format!("has asked {counted}"));
        }
        CALLED.fetch_add(1, Ordering::SeqCst);
        sleep(Duration::from_millis(self.takes));
        RETURNED.fetch_add(1, Ordering::SeqCst);
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&Count { count: self.asked }))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.asked = saved.read::<Count>()?.unwrap_or_default().count;
        Ok(())
    }
}

/// The patients that have failed.
static FAILED: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
/// True while a patient takes long to start again.
static STARTS: AtomicBool = AtomicBool::new(false);

/// Fails when it hears a number for the first time.
#[derive(Class)]
#[class(name = "patient", periodic, saves)]
pub(super) struct Patient {
    /// For how long it starts again, in milliseconds.
    #[property(default = 0)]
    takes: u64,
    #[subscribes(NUMBERS)]
    numbers: Subscription<Own>,
}

impl Component for Patient {
    type Properties = saoms_api::Own<Self>;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if self.takes > 0 && context.goes_on() && !context.goes_on_from_earlier_program() {
            STARTS.store(true, Ordering::SeqCst);
            sleep(Duration::from_millis(self.takes));
            STARTS.store(false, Ordering::SeqCst);
        }
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for number in context.receive(&self.numbers) {
            if FAILED.lock().unwrap().insert(context.name().to_owned()) {
                return Err("it is ill".into());
            }
            context.info(format!("has heard {}", number.value));
        }
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&Count { count: 1 }))
    }

    fn restore(&mut self, _: &Saved) -> Result<(), Failure> {
        Ok(())
    }
}

/// True while the porter carries something.
static CARRIES: AtomicBool = AtomicBool::new(false);

/// Counts what it carries in the report, and takes long, on a thread of its own.
#[derive(Class)]
#[class(name = "porter", periodic, saves, apart)]
pub(super) struct Porter {
    carried: u64,
}

impl Component for Porter {
    type Properties = ();

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.count("porter.carried", 1);
        self.carried += 1;
        CARRIES.store(true, Ordering::SeqCst);
        sleep(Duration::from_millis(40));
        CARRIES.store(false, Ordering::SeqCst);
        context.count("porter.carried", 1);
        Ok(())
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.info(format!("has carried {}", self.carried));
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&Count { count: self.carried }))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.carried = saved.read::<Count>()?.unwrap_or_default().count;
        Ok(())
    }
}

/// What a crash at this moment would leave.
pub(super) fn copy(folder: &Path) -> tempfile::TempDir {
    let copy = tempfile::tempdir().unwrap();
    std::fs::copy(folder.join("store.log"), copy.path().join("store.log")).unwrap();
    copy
}

fn wait_for_call(calls: u64) {
    while CALLED.load(Ordering::SeqCst) < calls {
        sleep(Duration::from_millis(1));
    }
}

#[test]
fn who_called_and_who_was_called_go_back_to_the_same_moment() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = "C clerk period=5 takes=60 peer=B\nB book\nT teller period=2";
    let mut crashes = Vec::new();
    run(fleet, real(20_000), folder.path(), |handle| {
        for calls in 1..5 {
            wait_for_call(calls);
            handle.commit(Duration::from_secs(10)).unwrap();
            crashes.push(copy(folder.path()));
        }
        // A usual end during the code.
        let called = CALLED.load(Ordering::SeqCst);
        wait_for_call(called + 1);
        handle.stop();
    });
    crashes.push(folder);
    for (place, crash) in crashes.iter().enumerate() {
        let (report, told) = run(fleet, real(100), crash.path(), |_| {});
        assert!(!told.contains("gap"), "{place}: {told}");
        assert!(told.contains("goes on from its state"), "{place}: {told}");
        assert!(!behind(&told, "C: has asked ").is_empty(), "{told}");
        assert_eq!(report.outcome.reasons, Vec::<String>::new());
    } // Code that does not return is waited for once.
    let folder = tempfile::tempdir().unwrap();
    let fleet = fleet.replace("takes=60", "takes=4000");
    CALLED.store(0, Ordering::SeqCst);
    RETURNED.store(0, Ordering::SeqCst);
    run(&fleet, real(20_000), folder.path(), |handle| {
        wait_for_call(1);
        (0..20).for_each(|_| handle.commit(Duration::from_secs(10)).unwrap());
        assert_eq!(RETURNED.load(Ordering::SeqCst), 0, "nobody waits for it for long");
        handle.stop();
    });
}

#[test]
fn the_report_has_no_more_than_what_is_gone_on_from() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = "P porter period=5\nT teller period=2";
    let mut crashes = Vec::new();
    run(fleet, real(20_000), folder.path(), |handle| {
        for _ in 0..4 {
            while !CARRIES.load(Ordering::SeqCst) {
                sleep(Duration::from_millis(1));
            }
            handle.commit(Duration::from_secs(10)).unwrap();
            crashes.push(copy(folder.path()));
            while CARRIES.load(Ordering::SeqCst) {
                sleep(Duration::from_millis(1));
            }
        }
        handle.stop();
    });
    crashes.push(folder);
    for (place, crash) in crashes.iter().enumerate() {
        let (report, told) = run(fleet, real(100), crash.path(), |_| {});
        let carried = first_number(behind(&told, "P: has carried "));
        assert_eq!(report.sections["porter"]["carried"], 2 * carried, "{place}: {told}");
    }
}

#[test]
fn what_a_component_heard_in_vain_is_there_while_it_starts_again() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = "P patient takes=200 period=3 restart=1ms/5\nT teller period=2";
    let mut crash = None;
    run(fleet, real(20_000), folder.path(), |handle| {
        let content = InjectedContent::Fields(json!({"value": 42}));
        let text = "a number".to_owned();
        handle.inject(Injection { topic: "NUMBERS".to_owned(), content, at: None, text }).unwrap();
        while !STARTS.load(Ordering::SeqCst) {
            sleep(Duration::from_millis(1));
        }
        handle.commit(Duration::from_secs(10)).unwrap();
        assert!(STARTS.load(Ordering::SeqCst), "it still starts");
        crash = Some(copy(folder.path()));
        handle.stop();
    });
    let (_, told) = run(fleet, real(1_000), crash.unwrap().path(), |_| {});
    assert_eq!(told.matches("P: has heard 42").count(), 1, "{told}");
}

//! A fleet with a state folder goes on where it was, after a usual end and after a kill at any moment.

mod apart;
mod ends;
mod kills;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::sleep;
use std::time::Duration;

use saoms_api::host::Registration;
use saoms_api::{Class, Component, Context, Failure, Message, Publisher, Saved, Subscription, Work};
use saoms_core::report::{RunReport, RunStatus};
use saoms_core::schedule::{ChangeOptions, Handle, InjectedContent, Injection, Order, RunningFleet, Settings};
use saoms_core::store::Store;
use saoms_lang::assembly::Assembly;
use saoms_lang::registry::Registry;
use serde_json::json;

use crate::actor::{Actor, Echo, EchoReference, NUMBERS, OWN, Own, TALK, Words};
use crate::fleet::{Diary, assembly_of, outcome, real};

/// What the teller had said when its present execution began.
static SAID: AtomicU64 = AtomicU64::new(0);

#[derive(Clone, Debug, Default, Message)]
struct Told {
    said: u64,
    asked: u64,
}

/// Says numbers, one after the other, and asks a book each time, which counts that.
#[derive(Class)]
#[class(name = "teller", periodic, saves)]
struct Teller {
    /// What it says of itself.
    #[property(default = "", live)]
    mood: String,
    /// The number at which its work is done; 0 for never.
    #[property(default = 0)]
    most: u64,
    /// True if it cannot read what it saved.
    #[property(default = false)]
    forgets: bool,
    /// It panics in each execution of this number; 0 for never.
    #[property(default = 0)]
    panics: u64,
    #[publishes(TALK)]
    words: Publisher<Words>,
    #[publishes(OWN)]
    own: Publisher<Own>,
    #[reference("peer")]
    book: Option<EchoReference>,
    told: Told,
    has_executed: bool,
}

impl Component for Teller {
    type Properties = saoms_api::Own<Self>;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if !context.goes_on() {
            // It is never said again.
            context.send(&self.own, Own { value: 7 })?;
        }
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if !std::mem::replace(&mut self.has_executed, true) {
            context.info(format!("has said {} at {}, {}", self.told.said, context.now(), self.mood));
        }
        SAID.store(self.told.said, Ordering::SeqCst);
        self.told.said += 1;
        context.count("teller.said", 1);
        context.send(&self.words, Words { text: self.told.said.to_string() })?;
        panic_sometimes(self.panics, &TELLER_EXECUTIONS);
        if let Some(book) = &self.book {
            let counted = book.echo(context, String::new())?;
            self.told.asked += 1;
            if counted != self.told.asked.to_string() {
                return Err(Failure::new(format!(
                    "gap: it asked {} times, and the book has {counted}",
                    self.told.asked
                )));
            }
        }
        if self.most > 0 {
            context.vote(if self.told.said >= self.most { Work::Done } else { Work::Open });
        }
        Ok(())
    }

    fn update(&mut self, properties: Self::Properties) -> Result<(), Failure> {
        self.mood = properties.mood;
        Ok(())
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.info(format!("ends with {}", self.told.said));
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&self.told))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        if self.forgets {
            return Err("it is of another form".into());
        }
        self.told = saved.read()?.unwrap_or_default();
        Ok(())
    }
}

#[derive(Clone, Debug, Default, Message)]
struct Heard {
    last: u64,
    numbers: Vec<i64>,
    own: i64,
}

/// Executions of the teller and of the hearer in this program.
static TELLER_EXECUTIONS: AtomicU64 = AtomicU64::new(0);
static HEARER_EXECUTIONS: AtomicU64 = AtomicU64::new(0);

/// Panics in one of so many executions.
fn panic_sometimes(panics: u64, executions: &AtomicU64) {
    if panics > 0 && executions.fetch_add(1, Ordering::SeqCst) % panics == panics - 1 {
        panic!("it was told to");
    }
}

/// Hears the numbers, none twice and none left out, and others from outside.
#[derive(Class)]
#[class(name = "hearer", periodic, saves, reacts)]
struct Hearer {
    /// As of the teller.
    #[property(default = 0)]
    panics: u64,
    #[subscribes(TALK)]
    words: Subscription<Words>,
    #[subscribes(NUMBERS)]
    numbers: Subscription<Own>,
    #[subscribes(OWN)]
    own: Subscription<Own>,
    heard: Heard,
    has_executed: bool,
}

impl Hearer {
    fn hear(&mut self, context: &Context<'_>) -> Result<(), Failure> {
        for Words { text } in context.receive(&self.words) {
            let number: u64 = text.parse().unwrap_or_default();
            if number != self.heard.last + 1 {
                return Err(Failure::new(format!("gap: it heard {}, and then {number}", self.heard.last)));
            }
            self.heard.last = number;
        }
        self.heard.numbers.extend(context.receive(&self.numbers).map(|number| number.value));
        self.heard.own = context.receive(&self.own).next_back().map_or(self.heard.own, |own| own.value);
        Ok(())
    }
}

impl Component for Hearer {
    type Properties = saoms_api::Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.hear(context)?;
        panic_sometimes(self.panics, &HEARER_EXECUTIONS);
        if !std::mem::replace(&mut self.has_executed, true) {
            let Heard { last, numbers, own } = &self.heard;
            context.info(format!("has heard up to {last}, own {own}, {numbers:?}"));
        }
        Ok(())
    }

    fn react(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.hear(context)?;
        panic_sometimes(self.panics, &HEARER_EXECUTIONS);
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&self.heard))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.heard = saved.read()?.unwrap_or_default();
        Ok(())
    }
}

#[derive(Clone, Debug, Default, Message)]
struct Count {
    count: u64,
}

/// Counts its calls.
#[derive(Class)]
#[class(name = "book", passive, saves, service("echo": Echo))]
struct Book {
    count: u64,
}

impl Component for Book {
    type Properties = ();

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&Count { count: self.count }))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.count = saved.read::<Count>()?.unwrap_or_default().count;
        Ok(())
    }
}

impl Echo for Book {
    fn echo(&mut self, _: &mut Context<'_>, _: String) -> Result<String, Failure> {
        self.count += 1;
        Ok(self.count.to_string())
    }
}

fn fleet_of(text: &str) -> Assembly {
    let mut registry = Registry::new();
    for class in [
        Registration::of::<Actor>(),
        Registration::of::<Teller>(),
        Registration::of::<Hearer>(),
        Registration::of::<Book>(),
        Registration::of::<apart::Clerk>(),
        Registration::of::<apart::Patient>(),
        Registration::of::<apart::Porter>(),
    ] {
        registry.add(class).unwrap();
    }
    assembly_of(text, &registry)
}

fn start(fleet: &str, settings: Settings, folder: &Path) -> (RunningFleet, Arc<Diary>) {
    let diary = Arc::new(Diary::default());
    let store = Store::open(folder).unwrap();
    let fleet =
        RunningFleet::start_with(fleet_of(fleet), settings, vec![diary.clone()], |handle| handle.use_store(store));
    (fleet.unwrap(), diary)
}

/// Runs a fleet and does something meanwhile; gives the report and what was told.
fn run(fleet: &str, settings: Settings, folder: &Path, meanwhile: impl FnOnce(&Handle)) -> (RunReport, String) {
    let (fleet, diary) = start(fleet, settings, folder);
    meanwhile(&fleet.handle());
    let report = fleet.run_to_end();
    (report, diary.lines())
}

/// The text behind another one in a line.
fn behind<'t>(text: &'t str, start: &str) -> &'t str {
    text.split_once(start).unwrap_or_else(|| panic!("no `{start}` in {text}")).1.split('\n').next().unwrap()
}

fn first_number(text: &str) -> u64 {
    text.split(|letter: char| !letter.is_ascii_digit()).find(|digits| !digits.is_empty()).unwrap().parse().unwrap()
}

const FLEET: &str = "T teller period=2 peer=B\nB book\nH hearer period=3 trigger=NUMBERS";

fn counted(report: &RunReport) -> u64 {
    report.sections["teller"]["said"].as_u64().unwrap()
}

#[test]
fn a_fleet_goes_on_after_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let (report, told) = run(FLEET, real(60), folder.path(), |_| {});
    assert!(told.contains("has said 0 at 0.") && told.contains("has heard up to"), "{told}");
    let (first, time) = (counted(&report), report.time_s);
    assert!(first > 3, "{told}");
    let (report, told) = run(FLEET, real(60), folder.path(), |_| {});
    assert!(told.contains("goes on from its state of "), "{told}");
    assert_eq!(first_number(behind(&told, "T: has said ")), first, "{told}");
    // The state that was announced once is there, and the time and the report go on.
    assert!(behind(&told, "H: has heard up to ").contains("own 7"), "{told}");
    assert!(report.time_s >= time + 0.059 && report.outcome.status == RunStatus::Elapsed, "{}", outcome(&report));
    assert!(counted(&report) > first && !told.contains("gap"), "{first} {}: {told}", counted(&report));
}

#[test]
fn operators_need_not_say_again_what_they_said() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = format!("{FLEET}\nA actor period=5\nS actor period=5");
    run(&fleet, real(10_000), folder.path(), |handle| {
        let give = |order: Order| handle.order(order, None).unwrap().wait(Duration::from_secs(5)).unwrap();
        let (component, property, value) = ("T".to_owned(), "mood".to_owned(), "gay".to_owned());
        give(Order::Set { component, property, value });
        give(Order::Stop { component: "A".to_owned() });
        give(Order::EmergencyStop { components: vec!["S".to_owned()], by: None });
        // It is for a time that only the next program sees.
        let content = InjectedContent::Fields(json!({"value": 42}));
        let at = handle.progress().time + Duration::from_millis(200);
        let text = "a number".to_owned();
        handle.inject(Injection { topic: "NUMBERS".to_owned(), content, at: Some(at), text }).unwrap();
        handle.stop();
    });
    let mut executed = Vec::new();
    let (report, told) = run(&fleet, real(10_000), folder.path(), |handle| {
        sleep(Duration::from_millis(300));
        let status = handle.status();
        executed = status.components.iter().map(|one| (one.report.name.clone(), one.report.executions)).collect();
        let stopped: Vec<_> = status.components.iter().filter(|one| one.emergency_stop).collect();
        assert_eq!(stopped.iter().map(|one| one.report.name.as_str()).collect::<Vec<_>>(), ["S"]);
        handle.stop();
    });
    assert!(behind(&told, "T: has said ").ends_with(", gay"), "{told}");
    let executions = |name: &str| executed.iter().find(|(known, _)| known == name).unwrap().1;
    assert_eq!((executions("A"), executions("S")), (0, 0));
    assert!(executions("T") > 3, "{}", outcome(&report));
    let (_, told) = run(&fleet, real(30), folder.path(), |_| {});
    assert!(told.contains("[42]"), "{told}");
    // A composite with another value has the last word.
    let changed = fleet.replace("T teller", "T teller mood=sad");
    let (_, told) = run(&changed, real(30), folder.path(), |_| {});
    assert!(behind(&told, "T: has said ").ends_with(", sad"), "{told}");
    // What is set then lasts, and what was set before that is forgotten.
    run(&changed, real(10_000), folder.path(), |handle| {
        let (component, property, value) = ("T".to_owned(), "mood".to_owned(), "merry".to_owned());
        let set = Order::Set { component, property, value };
        handle.order(set, None).unwrap().wait(Duration::from_secs(5)).unwrap();
        handle.stop();
    });
    let (_, told) = run(&changed, real(30), folder.path(), |_| {});
    assert!(behind(&told, "T: has said ").ends_with(", merry"), "{told}");
    let (_, told) = run(&fleet, real(30), folder.path(), |_| {});
    assert!(behind(&told, "T: has said ").ends_with(", "), "{told}");
}

#[test]
fn what_a_change_of_the_fleet_took_back_does_not_come_again() {
    let folder = tempfile::tempdir().unwrap();
    let changed = "T teller period=2 most=1000000\nD teller period=5 most=1000000";
    run("T teller period=2\nD teller period=5", real(10_000), folder.path(), |handle| {
        let give = |order: Order| handle.order(order, None).unwrap().wait(Duration::from_secs(5)).unwrap();
        for component in ["T", "D"] {
            let (component, property, value) = (component.to_owned(), "mood".to_owned(), "gay".to_owned());
            give(Order::Set { component, property, value });
        }
        // One that does not run takes the new values when it starts.
        give(Order::Stop { component: "D".to_owned() });
        while handle.is_running("D").unwrap() {
            sleep(Duration::from_millis(1));
        }
        let options = ChangeOptions { allow_loss: true, ..ChangeOptions::default() };
        assert_eq!(handle.apply(&fleet_of(changed), options).unwrap().replaced.len(), 2);
        handle.stop();
    });
    let (_, told) = run(changed, real(10_000), folder.path(), |handle| {
        handle.schedule("D").unwrap();
        while handle.status().components.iter().any(|one| one.report.executions == 0) {
            sleep(Duration::from_millis(1));
        }
        handle.stop();
    });
    for component in ["T", "D"] {
        assert!(behind(&told, &format!("{component}: has said ")).ends_with(", "), "{told}");
    }
}

#[test]
fn a_state_that_came_from_outside_is_there_for_who_begins_later() {
    let folder = tempfile::tempdir().unwrap();
    run(FLEET, real(10_000), folder.path(), |handle| {
        let (topic, content) = ("OWN".to_owned(), InjectedContent::Fields(json!({"value": 9})));
        handle.inject(Injection { topic, content, at: None, text: "a value".to_owned() }).unwrap();
        handle.commit(Duration::from_secs(5)).unwrap();
        sleep(Duration::from_millis(50));
        handle.stop();
    });
    let (_, told) = run("N hearer period=3", real(40), folder.path(), |_| {});
    assert!(told.contains("N: has heard up to 0, own 9"), "{told}");
}

#[test]
fn what_cannot_go_on_begins_anew() {
    let folder = tempfile::tempdir().unwrap();
    run(FLEET, real(40), folder.path(), |_| {});
    let (_, told) = run("H hearer period=3\nN hearer period=3", real(40), folder.path(), |_| {});
    assert!(told.contains("the state folder has what `B`, `T` kept, and the fleet has no such component"), "{told}");
    assert!(told.contains("N: has heard up to 0, own 7"), "{told}");
    let (report, told) = run("T teller period=2 forgets=true\nH actor period=3", real(40), folder.path(), |_| {});
    let why = "T: begins anew, since it cannot go on from the state folder: could not continue with its saved state: it is of another form";
    assert!(told.contains(why) && told.contains("T: has said 0"), "{told}");
    assert_eq!(report.outcome.reasons, Vec::<String>::new());
    // It has the numbers of what was there, which saved states name.
    let (_, told) =
        run("Z actor period=5 publishes=TALK each=[0: say 1]\nH hearer period=2", real(40), folder.path(), |_| {});
    assert!(!told.contains("gap"), "{told}");
}

#[test]
fn a_run_whose_work_is_done_ends_at_once_when_it_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = "T teller period=1 most=5";
    let (report, _) = run(fleet, real(20_000), folder.path(), |_| {});
    let first = counted(&report);
    assert!(report.outcome.status == RunStatus::Done && first >= 5, "{}", outcome(&report));
    let (report, told) = run(fleet, real(20_000), folder.path(), |_| {});
    assert_eq!((report.outcome.status, counted(&report), report.periods), (RunStatus::Done, first, 0));
    assert!(told.contains("all work was done then, so that it ends at once unless more comes"), "{told}");
}

#[test]
fn an_answer_waits_for_the_commit() {
    let folder = tempfile::tempdir().unwrap();
    run(FLEET, real(20_000), folder.path(), |handle| {
        for _ in 0..5 {
            let before = std::fs::metadata(folder.path().join("store.log")).unwrap().len();
            handle.commit(Duration::from_secs(10)).unwrap();
            assert!(std::fs::metadata(folder.path().join("store.log")).unwrap().len() > before);
        }
        handle.pause().unwrap();
        let content = InjectedContent::Fields(json!({"value": 1}));
        handle.inject(Injection { topic: "NUMBERS".to_owned(), content, at: None, text: "one".to_owned() }).unwrap();
        handle.commit(Duration::from_secs(10)).unwrap();
        handle.stop();
    });
}

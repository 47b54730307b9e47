use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use saoms_api::host::{Phase, SharedMessage};
use saoms_api::{Cause, Failure, Header, Level, Time, record};

use super::{
    Beginning, EventQueue, FleetSample, Interest, JournalFile, LostEvents, Notification, Observer, Observers,
    Occurrence, Records, RunEvent, RunProgress, SampleRate, SentMessage, deliver_records,
};
use crate::journal::{ComponentName, RecordQueue, Recorder, Stamp};
use crate::status::{FleetPhase, FleetStatus};

/// A slow observer.
#[derive(Default)]
struct Listener {
    told: Mutex<Vec<String>>,
    progress: AtomicUsize,
    lost: Mutex<Vec<LostEvents>>,
}

impl Observer for Listener {
    fn event(&self, event: &RunEvent) {
        self.told.lock().unwrap().push(event.to_string());
    }

    fn interest(&self) -> Interest {
        Interest { progress: Some(Duration::from_millis(1)), ..Interest::default() }
    }

    fn progress(&self, _: &RunProgress) {
        self.progress.fetch_add(1, Ordering::Relaxed);
    }

    fn lost(&self, lost: LostEvents) {
        self.lost.lock().unwrap().push(lost);
    }
}

fn event(number: usize) -> RunEvent {
    let what = Occurrence::Log { level: Level::Info, text: number.to_string() };
    RunEvent { time: Time::START, component: Some(Arc::from("A")), what }
}

#[test]
fn events_beyond_the_bound_are_counted_and_lost_in_real_time() {
    let listener = Arc::new(Listener::default());
    let observers = Observers::new(vec![listener.clone()]);
    let queue = EventQueue::new(observers.interest(), false);
    for number in 0..70_000 {
        queue.put(event(number));
    }
    queue.close();
    queue.deliver(&observers, RunProgress::default);
    let told = listener.told.lock().unwrap();
    assert_eq!(told.len(), 65_536 + 1);
    assert_eq!(told[65_535], "[0.000 s] A: 65535");
    assert_eq!(told[65_536], "[0.000 s] 4464 events came faster than they could be shown, and were lost");
    assert!(listener.progress.load(Ordering::Relaxed) > 0);
}

#[test]
fn observers_hear_how_many_alerts_and_messages_they_lack() {
    let all = [0, 1, 2].map(|_| Arc::new(Listener::default()));
    let observers = Observers::new(all.iter().map(|one| Arc::clone(one) as Arc<dyn Observer>).collect());
    let queue = EventQueue::new(observers.interest(), false);
    for number in 0..65_536 {
        queue.put(event(number));
    }
    let alert = |text: Option<&str>| RunEvent {
        time: Time::START,
        component: None,
        what: Occurrence::Alert { kind: Arc::from("jam"), subject: Arc::from("left"), text: text.map(str::to_owned) },
    };
    queue.put(alert(Some("jams")));
    queue.put(alert(None));
    queue.put(event(1));
    let sent = |who: &[u32]| {
        let header = Header { sender: 0, sent: Time::START, cause: Cause::default() };
        let message = SharedMessage::from_bytes(header, None, Vec::new());
        let sent = SentMessage { topic: Arc::from("T"), component: Arc::from("A"), message, is_of_other: false };
        Notification::Sent(sent, who.into())
    };
    queue.put(sent(&[1]));
    queue.put(sent(&[0, 1]));
    queue.close();
    queue.deliver(&observers, RunProgress::default);
    let lost = all.map(|one| one.lost.lock().unwrap().clone());
    let of = |messages: u64| vec![LostEvents { alerts: 2, messages }];
    assert_eq!(lost, [of(1), of(2), of(0)]);
}

#[test]
fn long_lines_have_less_room() {
    let listener = Arc::new(Listener::default());
    let observers = Observers::new(vec![listener.clone()]);
    let queue = EventQueue::new(observers.interest(), false);
    for _ in 0..200 {
        let what = Occurrence::Log { level: Level::Info, text: "x".repeat(1 << 20) };
        queue.put(RunEvent { time: Time::START, component: None, what });
    }
    queue.close();
    queue.deliver(&observers, RunProgress::default);
    let told = listener.told.lock().unwrap();
    assert_eq!(told.len(), 64 + 1);
    assert_eq!(told[64], "[0.000 s] 136 events came faster than they could be shown, and were lost");
}

/// An observer that gets samples beside what it listens to.
#[derive(Default)]
struct Looks {
    listener: Listener,
    times: Mutex<Vec<u64>>,
}

impl Observer for Looks {
    fn interest(&self) -> Interest {
        let samples = Some(SampleRate { every: Duration::from_secs(1), most: None });
        Interest { samples, ..Interest::default() }
    }

    fn event(&self, event: &RunEvent) {
        self.listener.event(event);
    }

    fn sample(&self, sample: &FleetSample) {
        self.times.lock().unwrap().push(sample.time.as_nanos());
    }
}

fn sample(nanos: u64, is_last: bool) -> Notification {
    let (time_s, phase) = (0.0, FleetPhase::Running);
    let (summaries, components) = (Vec::new(), Vec::new());
    let status = FleetStatus { time_s, phase, paused: false, speed: None, summaries, components };
    Notification::Sample(Box::new(FleetSample { time: Time::from_nanos(nanos), status, states: Vec::new(), is_last }))
}

#[test]
fn few_samples_wait_and_they_take_no_room_from_events() {
    let looks = Arc::new(Looks::default());
    let observers = Observers::new(vec![looks.clone()]);
    let queue = EventQueue::new(observers.interest(), false);
    for number in 0..65_536 {
        queue.put(event(number));
        if number < 10 {
            queue.put(sample(number as u64, false));
        }
    }
    queue.put(sample(10, true));
    queue.close();
    queue.deliver(&observers, RunProgress::default);
    let told = looks.listener.told.lock().unwrap();
    assert_eq!(told.len(), 65_536 + 1);
    let lost = "[0.000 s] 8 samples of the fleet came faster than they could be taken in, and were left out";
    assert_eq!(told[65_536], lost);
    assert_eq!(*looks.times.lock().unwrap(), [0, 1, 10]);
}

#[test]
fn samples_wait_for_room_in_virtual_time() {
    let looks = Arc::new(Looks::default());
    let observers = Observers::new(vec![looks.clone()]);
    let queue = Arc::new(EventQueue::new(observers.interest(), true));
    let deliverer = {
        let queue = Arc::clone(&queue);
        thread::spawn(move || queue.deliver(&observers, RunProgress::default))
    };
    (0..1000).for_each(|number| queue.put(sample(number, false)));
    queue.close();
    deliverer.join().unwrap();
    assert_eq!(looks.times.lock().unwrap().len(), 1000);
}

#[test]
fn events_beyond_the_bound_wait_in_virtual_time() {
    let listener = Arc::new(Listener::default());
    let observers = Observers::new(vec![listener.clone()]);
    let queue = Arc::new(EventQueue::new(observers.interest(), true));
    let deliverer = {
        let queue = Arc::clone(&queue);
        thread::spawn(move || queue.deliver(&observers, RunProgress::default))
    };
    for number in 0..200_000 {
        queue.put(event(number));
    }
    queue.close();
    deliverer.join().unwrap();
    let told = listener.told.lock().unwrap();
    assert_eq!(told.len(), 200_000);
    assert_eq!(told[199_999], "[0.000 s] A: 199999");
}

#[test]
fn an_observer_gets_the_lines_that_it_wants_and_panics_alone() {
    struct Clumsy;
    impl Observer for Clumsy {
        fn interest(&self) -> Interest {
            Interest { log: Some(Level::Debug), console: true, ..Interest::NONE }
        }

        fn event(&self, _: &RunEvent) {
            // Not `panic!`, whose message would be shown among those of the tests.
            std::panic::resume_unwind(Box::new("clumsy"));
        }
    }
    let listener = Arc::new(Listener::default());
    let observers = Observers::new(vec![Arc::new(Clumsy), listener.clone()]);
    let interest = observers.interest();
    assert_eq!((interest.log, interest.console, interest.journal), (Some(Level::Debug), true, false));
    for what in [
        Occurrence::Log { level: Level::Debug, text: "unasked".to_owned() },
        Occurrence::Console { text: "unasked".to_owned() },
        Occurrence::Log { level: Level::Info, text: "asked".to_owned() },
        Occurrence::Started,
    ] {
        observers.event(&RunEvent { time: Time::START, component: None, what });
    }
    assert_eq!(*listener.told.lock().unwrap(), ["[0.000 s] asked", "[0.000 s] started"]);
}

/// An observer that fails after a number of records.
struct FailingObserver {
    room: usize,
    records: AtomicUsize,
}

impl Observer for FailingObserver {
    fn interest(&self) -> Interest {
        Interest { journal: true, ..Interest::NONE }
    }

    fn records(&self, records: &Records<'_>) -> Result<(), Failure> {
        let before = self.records.fetch_add(records.entries.len(), Ordering::Relaxed);
        if before + records.entries.len() > self.room { Err(Failure::new("full")) } else { Ok(()) }
    }
}

/// A recorder with this number of records of component 0.
fn recorder(records: usize) -> Recorder {
    let (mut recorder, ids) = (Recorder::default(), AtomicU64::new(0));
    recorder.begin(Cause::default());
    let stamp = Stamp { ids: &ids, component: 0, time: 1_000_000_000 };
    for _ in 0..records {
        recorder.write(stamp, Phase::Effect, &record!("acts"), &[]);
    }
    recorder
}

#[test]
fn an_observer_that_takes_no_records_is_told_once_and_all_that_is_missing_is_counted() {
    let small = Arc::new(FailingObserver { room: 0, records: AtomicUsize::new(0) });
    let large = Arc::new(FailingObserver { room: 99, records: AtomicUsize::new(0) });
    let observers = Observers::new(vec![small, large.clone()]);
    let queue = RecordQueue::new(true);
    queue.join(ComponentName { name: "A".to_owned(), id: None, period_us: None }, false);
    queue.put(0, &recorder(5));
    queue.close(Time::START);
    let said = AtomicU64::new(0);
    let delivery = deliver_records(&queue, &observers, |_| {
        said.fetch_add(1, Ordering::Relaxed);
    });
    assert_eq!((delivery.lost, delivery.failures), (5, vec![Failure::new("full")]));
    assert_eq!(said.into_inner(), 1);
    assert_eq!(large.records.load(Ordering::Relaxed), 5);
}

#[test]
fn nothing_is_delivered_while_there_are_no_records() {
    let queue = Arc::new(RecordQueue::new(false));
    queue.join(ComponentName { name: "A".to_owned(), id: None, period_us: None }, false);
    let reader = Arc::clone(&queue);
    let delivered = thread::spawn(move || {
        let (mut entries, mut joined, mut delivered) = (Vec::new(), Vec::new(), Vec::new());
        loop {
            let (_, end) = reader.next(&mut entries, &mut joined);
            delivered.push(entries.len());
            if end.is_some() {
                return delivered;
            }
        }
    });
    // Long enough for a reader that looks from time to time.
    thread::sleep(Duration::from_millis(350));
    queue.put(0, &recorder(5));
    thread::sleep(Duration::from_millis(350));
    queue.close(Time::START);
    // The component, its records, and the end.
    let delivered = delivered.join().unwrap();
    assert!(delivered.len() <= 3 && delivered.iter().sum::<usize>() == 5, "{delivered:?}");
}

#[test]
fn in_real_time_records_that_find_no_room_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("journal");
    let file = Arc::new(JournalFile::new(&path));
    let components = [ComponentName { name: "A".to_owned(), id: None, period_us: None }];
    file.begin(&Beginning { seed: 1, is_virtual: false, components: &components }).unwrap();
    let queue = RecordQueue::new(false);
    queue.join(ComponentName { name: "A".to_owned(), id: None, period_us: None }, false);
    let recorder = recorder(1000);
    for _ in 0..70 {
        queue.put(0, &recorder);
    }
    queue.close(Time::from_nanos(5));
    let delivery = deliver_records(&queue, &Observers::new(vec![file]), |_| {});
    assert_eq!((delivery.lost, delivery.failures), (4000, Vec::new()));
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(text.lines().last(), Some(r#"{"end":{"lost":4000,"records":70000,"time_s":5e-9}}"#));
}

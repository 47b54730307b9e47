//! What a program asks before its components begin.

use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use saoms_api::host::cdr;

use super::{WIRES, Wire, own, session, wait};
use crate::network::client::{Entry, RUNS, enter};
use crate::network::exchange::wire::Begins;
use crate::network::transport::{Delivered, Receiver as _};
use crate::network::{Port, key};

/// Questions that a program asks at least which waits longer than for the answers of those that are connected.
const MANY: usize = 8;

/// A program that enters, and what others see of it.
struct Entering {
    wire: Arc<Wire>,
    port: Arc<Port>,
    entered: Mutex<Option<Result<(Entry, u64), String>>>,
    told: Mutex<Vec<String>>,
}

impl Entering {
    /// Number of its questions.
    fn questions(&self) -> usize {
        let begins = key::begins(1);
        self.wire.put.lock().unwrap().iter().filter(|(key, ..)| *key == begins).count()
    }

    fn says(&self, answer: &Begins) {
        let (key, message) = (key::runs(1), cdr::encode(answer));
        assert!(self.port.deliver(Delivered { token: RUNS, key: &key, message: &message, attachment: &[] }));
    }

    fn has_entered(&self) -> bool {
        self.entered.lock().unwrap().is_some()
    }
}

/// Lets a program enter while something happens. Gives the outcome, with the date of the program.
fn entered(url: &str, is_fresh: bool, is_router: bool, meanwhile: impl Fn(&Entering)) -> Result<(Entry, u64), String> {
    entered_within(url, is_fresh, is_router, None, meanwhile)
}

/// The same where a link that is lost is waited for so long.
fn entered_within(
    url: &str,
    is_fresh: bool,
    is_router: bool,
    longest: Option<Duration>,
    meanwhile: impl Fn(&Entering),
) -> Result<(Entry, u64), String> {
    let (wire, port) = (Arc::<Wire>::default(), Arc::<Port>::default());
    WIRES.lock().unwrap().insert(url.to_owned(), Arc::clone(&wire));
    let session = session(url, &port, is_router);
    let entering = Entering { wire, port, entered: Mutex::default(), told: Mutex::default() };
    thread::scope(|scope| {
        scope.spawn(|| {
            let mut settings = own();
            let tell = |text| entering.told.lock().unwrap().push(text);
            let entry = enter(&session, &entering.port, &mut settings, is_fresh, tell, longest, || false);
            *entering.entered.lock().unwrap() = Some(entry.map(|entry| (entry, settings.began)));
        });
        meanwhile(&entering);
    });
    entering.entered.into_inner().unwrap().unwrap()
}

/// Another program, which has been connected after many questions, says that it has the component, for as long as it is
/// asked.
fn answers_late(entering: &Entering) {
    wait("it asks no more", || entering.questions() >= MANY || entering.has_entered());
    let runs = Begins {
        program: 2,
        name: "other".to_owned(),
        patience: 50,
        components: vec!["Own".to_owned()],
        ..Begins::default()
    };
    while !entering.has_entered() {
        entering.says(&runs);
        thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_program_that_is_connected_late_is_asked_by_routers_and_on_fresh_networks() {
    for (url, is_fresh, is_router) in [("fresh", true, false), ("router", false, true)] {
        let outcome = entered(url, is_fresh, is_router, answers_late);
        assert!(outcome.as_ref().is_err_and(|why| why.contains("runs in program `other`")), "{url}: {outcome:?}");
    }
}

#[test]
fn who_enters_waits_longer_where_the_router_says_that_it_has_just_begun() {
    let outcome = entered("young", false, false, |entering| {
        wait("it asks nothing", || entering.questions() > 0);
        entering.says(&Begins { program: 9, settles: 1_500, ..Begins::default() });
        answers_late(entering);
    });
    assert!(outcome.is_err(), "{outcome:?}");
}

#[test]
fn a_link_that_comes_again_lets_it_ask_anew() {
    let outcome = entered("again", false, false, |entering| {
        wait("it asks nothing", || entering.questions() > 0);
        entering.port.link(false, "");
        thread::sleep(Duration::from_millis(700));
        assert!(!entering.has_entered(), "nobody could be asked");
        entering.port.link(true, "");
        let before = entering.questions();
        wait("it asks no more", || entering.questions() >= before + MANY || entering.has_entered());
        answers_late(entering);
    });
    assert!(outcome.is_err(), "{outcome:?}");
}

#[test]
fn a_link_that_is_lost_while_a_program_enters_is_told_and_waited_for_no_longer_than_asked() {
    let outcome = entered_within("gone", false, false, Some(Duration::from_millis(50)), |entering| {
        entering.port.link(false, "");
        wait("it waits for ever", || entering.has_entered());
        let told = entering.told.lock().unwrap();
        assert!(told.len() == 1 && told[0].starts_with("the link to the network is lost"), "{told:?}");
    });
    assert_eq!(outcome.map(|(entry, _)| entry), Ok(Entry::Lost));
}

#[test]
fn a_program_begins_later_than_all_of_which_others_know() {
    let outcome = entered("later", false, false, |entering| {
        wait("it asks nothing", || entering.questions() > 0);
        entering.says(&Begins { program: 2, latest: 70, ..Begins::default() });
        // It is about to end.
        let components = vec!["Own".to_owned()];
        entering.says(&Begins { program: 3, latest: 60, began: 90, components, ..Begins::default() });
        entering.says(&Begins { program: 4, began: 200, ..Begins::default() });
    });
    assert_eq!(outcome, Ok((Entry::Free, 91)));
}

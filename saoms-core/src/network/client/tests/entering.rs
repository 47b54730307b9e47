//! What a program asks before its components begin.

use std::sync::Arc;
use std::time::{Duration, Instant};

use saoms_api::host::cdr;

use super::{WIRES, Wire, own, session};
use crate::network::client::{BEGINS, Entrance, Entry, RUNS, Refused};
use crate::network::exchange::Settings;
use crate::network::exchange::wire::Begins;
use crate::network::transport::{Delivered, Receiver as _};
use crate::network::{Membership, Port, key};

/// Questions that a program asks at least which waits longer than for the answers of those that are connected.
const MANY: usize = 8;
/// Time between two looks.
const LOOK: Duration = Duration::from_millis(5);
const HOUR: Duration = Duration::from_secs(3_600);

/// A program that enters networks in virtual time, and what others see of it.
struct Entering {
    entrance: Entrance,
    networks: Vec<(Arc<Wire>, Arc<Port>)>,
    now: Instant,
    told: Vec<String>,
    longest: Option<Duration>,
}

impl Entering {
    /// One that enters a network.
    fn of(url: &str) -> Entering {
        let mut entering = Entering {
            entrance: Entrance::default(),
            networks: Vec::new(),
            now: Instant::now(),
            told: Vec::new(),
            longest: None,
        };
        entering.add(url, false, false);
        entering
    }

    fn add(&mut self, url: &str, is_fresh: bool, is_router: bool) {
        let (wire, port) = (Arc::<Wire>::default(), Arc::<Port>::default());
        WIRES.lock().unwrap().insert(url.to_owned(), Arc::clone(&wire));
        let session = session(url, &port, is_router);
        let settings = Settings { program: 1 + self.networks.len() as u64, ..own() };
        self.entrance.add(session, &port, settings, &Membership::default(), is_fresh, self.now).unwrap();
        self.networks.push((wire, port));
    }

    /// What it has put on a network that begins so.
    fn put(&self, place: usize, key: &str) -> usize {
        self.networks[place].0.put.lock().unwrap().iter().filter(|(put, ..)| put.starts_with(key)).count()
    }

    /// Number of its questions.
    fn questions(&self, place: usize) -> usize {
        self.put(place, &key::begins(1 + place as u64))
    }

    fn hears(&self, place: usize, (token, key): (u64, String), said: &Begins) {
        let message = cdr::encode(said);
        assert!(self.networks[place].1.deliver(Delivered { token, key: &key, message: &message, attachment: &[] }));
    }

    /// Another program answers on a network.
    fn is_told(&self, place: usize, answer: &Begins) {
        self.hears(place, (RUNS, key::runs(1 + place as u64)), answer);
    }

    fn look(&mut self, after: Duration) -> Result<Entry, Refused> {
        self.now += after;
        let told = &mut self.told;
        self.entrance.look(self.now, self.longest, |text| told.push(text))
    }

    /// Looks until it is known whether it may begin, while something happens.
    fn decides(&mut self, meanwhile: impl Fn(&Entering)) -> Result<Entry, Refused> {
        let until = self.now + HOUR;
        while self.now < until {
            meanwhile(self);
            let entry = self.look(LOOK)?;
            if entry != Entry::Open {
                return Ok(entry);
            }
        }
        panic!("it waits for ever: {:?}", self.told);
    }

    /// The dates with which it begins.
    fn dates(self) -> Vec<u64> {
        self.entrance.into_all().into_iter().map(|one| one.settings.began).collect()
    }
}

/// What a program with the component says.
fn runs() -> Begins {
    let components = vec!["Own".to_owned()];
    Begins { program: 9, name: "other".to_owned(), patience: 50, components, ..Begins::default() }
}

#[track_caller]
fn is_refused(outcome: &Result<Entry, Refused>, at: usize) {
    let refused = outcome.as_ref().unwrap_err();
    assert!(refused.place == at && refused.why.contains("`Own` runs in program `other`"), "{refused:?}");
}

/// Another program, which has been connected after many questions, says that it has the component.
fn answers_late(entering: &Entering) {
    if entering.questions(0) >= MANY {
        entering.is_told(0, &runs());
    }
}

#[test]
fn a_program_that_is_connected_late_is_asked_by_routers_and_on_fresh_networks() {
    for (url, is_fresh, is_router) in [("fresh", true, false), ("router", false, true)] {
        let mut entering = Entering { entrance: Entrance::default(), networks: Vec::new(), ..Entering::of("other") };
        entering.add(url, is_fresh, is_router);
        is_refused(&entering.decides(answers_late), 0);
    }
    assert_eq!(Entering::of("usual").decides(answers_late), Ok(Entry::Free), "it asks no more");
}

#[test]
fn who_enters_waits_longer_where_the_router_says_that_it_has_just_begun() {
    let mut entering = Entering::of("young");
    entering.look(LOOK).unwrap();
    entering.is_told(0, &Begins { program: 9, settles: 1_500, ..Begins::default() });
    is_refused(&entering.decides(answers_late), 0);
}

#[test]
fn a_link_that_comes_again_lets_it_ask_anew() {
    let mut entering = Entering::of("again");
    entering.look(LOOK).unwrap();
    entering.networks[0].1.link(false, "");
    for _ in 0..1_000 {
        assert_eq!(entering.look(LOOK), Ok(Entry::Open), "nobody could be asked");
    }
    entering.networks[0].1.link(true, "");
    let before = entering.questions(0);
    let answers = |entering: &Entering| {
        if entering.questions(0) >= before + MANY {
            entering.is_told(0, &runs());
        }
    };
    is_refused(&entering.decides(answers), 0);
}

#[test]
fn a_link_that_is_lost_while_a_program_enters_is_told_and_waited_for_no_longer_than_asked() {
    let mut entering = Entering::of("gone");
    entering.longest = Some(Duration::from_millis(50));
    entering.add("there", false, false);
    entering.networks[1].1.link(false, "");
    assert_eq!(entering.decides(|_| {}), Ok(Entry::Lost(1)));
    let told = entering.told;
    assert!(told.len() == 1 && told[0].starts_with("the link to the network is lost"), "{told:?}");
}

#[test]
fn a_program_begins_later_than_all_of_which_others_know_on_each_of_its_networks() {
    let mut entering = Entering::of("later");
    entering.add("as late", false, false);
    entering.look(LOOK).unwrap();
    entering.is_told(0, &Begins { program: 2, latest: 70, ..Begins::default() });
    // It is about to end.
    entering.is_told(0, &Begins { latest: 60, began: 90, ..runs() });
    entering.is_told(0, &Begins { program: 4, began: 200, ..Begins::default() });
    assert_eq!(entering.decides(|_| {}), Ok(Entry::Free));
    assert_eq!(entering.dates(), [91, 91]);
}

#[test]
fn a_program_that_is_refused_on_one_network_has_begun_on_no_other_one() {
    let mut entering = Entering::of("free");
    for _ in 0..400 {
        assert!(entering.look(LOOK).is_ok(), "the second network is not there yet");
    }
    entering.add("occupied", false, false);
    is_refused(&entering.decides(|entering| entering.is_told(1, &runs())), 1);
    assert_eq!(entering.put(0, ""), entering.questions(0), "it says nothing but that it asks");
}

#[test]
fn who_waits_on_one_network_goes_on_to_ask_on_the_others() {
    let mut entering = Entering::of("first");
    entering.add("second", false, false);
    // There, a program is about to end; meanwhile one begins here.
    for _ in 0..MANY {
        entering.is_told(1, &Begins { patience: 60_000, ..runs() });
        for _ in 0..1_000 {
            assert_eq!(entering.look(LOOK), Ok(Entry::Open));
        }
    }
    assert!(entering.questions(0) > 40 * MANY, "{}", entering.questions(0));
    is_refused(&entering.decides(|entering| entering.is_told(0, &runs())), 0);
}

#[test]
fn a_program_that_was_suspended_while_it_entered_asks_again() {
    // Anywhere, and also just before it would have begun.
    for looks in [1, 50, 99, 100] {
        let mut entering = Entering::of("suspended");
        for _ in 0..looks {
            assert_eq!(entering.look(LOOK), Ok(Entry::Open));
        }
        assert_eq!(entering.look(HOUR), Ok(Entry::Open), "after {looks} looks");
        is_refused(&entering.decides(|entering| entering.is_told(0, &runs())), 0);
    }
}

#[test]
fn of_two_programs_that_ask_at_once_the_same_one_begins_on_all_networks() {
    let mut entering = Entering::of("both");
    entering.add("both of them", false, false);
    for place in 0..2 {
        entering.hears(place, (BEGINS, key::begins(9)), &runs());
        entering.hears(place, (BEGINS, key::begins(0)), &Begins { program: 0, ..runs() });
    }
    entering.look(LOOK).unwrap();
    for place in 0..2 {
        let answers = [9, 0].map(|program| entering.put(place, &key::runs(program)));
        assert_eq!(answers, [1, 0], "the one with the lower number goes first");
    }
}

use saoms_api::host::{Registration, SharedMessage, cdr};
use saoms_api::{
    Cause, Class, Component, Context, Failure, Header, Message, Publisher, ReportValue, Subscription, Time, Topic, Work,
};

use super::host::FakeHost;

#[derive(Clone, Debug, PartialEq, Message)]
#[message(key = "robot")]
pub(crate) struct Position {
    pub(crate) robot: u8,
    pub(crate) name: String,
}

/// The same message in a library that was built separately.
mod elsewhere {
    use saoms_api::Message;

    #[derive(Clone, Debug, PartialEq, Message)]
    #[message(key = "robot")]
    pub(crate) struct Position {
        pub(crate) robot: u8,
        pub(crate) name: String,
    }
}

const POSITION: Topic<Position> = Topic::state("POSITION");
const HEADER: Header = Header { sender: 9, sent: Time::from_nanos(5), cause: Cause(0) };

/// Sends on what it hears, and says what it sees.
#[derive(Class)]
#[class(name = "test.Echo", periodic, publishes(POSITION), subscribes(POSITION))]
struct Echo {
    publisher: Publisher<Position>,
    subscription: Subscription<Position>,
}

impl Component for Echo {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Echo { publisher: Publisher::default(), subscription: Subscription::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.publisher = context.publish(&POSITION)?;
        self.subscription = context.subscribe(&POSITION)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for (header, position) in context.receive(&self.subscription).with_headers() {
            context.info(format_args!("{} from {}", position.name, header.sender));
            context.send(&self.publisher, position.clone())?;
        }
        if let Some(last) = context.receive_last(&self.subscription) {
            context.report("echo.last", last.name.as_str());
        }
        context.count("echo.executions", 1);
        context.console(format_args!("{} at {}", context.name().to_owned(), context.now()));
        context.vote(Work::Done);
        Ok(())
    }
}

fn position(robot: u8, name: &str) -> Position {
    Position { robot, name: name.to_owned() }
}

#[test]
fn a_component_reads_and_sends_messages() {
    let mut host = FakeHost::new();
    let registration = Registration::linked().find(|class| class.declaration() == Echo::DECLARATION).unwrap();
    let mut component = registration.construct(&[]).unwrap();
    host.run(|context| component.initialize(context)).unwrap();
    assert_eq!(
        (host.published.as_slice(), host.subscribed.as_slice()),
        (&["POSITION".to_owned()][..], &["POSITION".to_owned()][..])
    );

    let broken = SharedMessage::from_bytes(HEADER, None, vec![0, 1, 0, 0]);
    let inbox = [vec![
        SharedMessage::new(HEADER, position(1, "one")),
        SharedMessage::from_bytes(HEADER, Some(2), cdr::encode(&position(2, "two"))),
        broken,
    ]];
    component.execute(&mut Context::new(&mut host, &inbox)).unwrap();
    component.shutdown(&mut Context::new(&mut host, &[])).unwrap();
    let sent: Vec<_> = host.sent.iter().map(|(_, message)| message.get::<Position>().unwrap().clone()).collect();
    assert_eq!(sent, [position(1, "one"), position(2, "two")]);
    let expected = Header { sender: 3, sent: Time::from_nanos(1_000_000_000), cause: Cause(0) };
    assert!(host.sent.iter().all(|(publisher, message)| *publisher == 0 && message.header() == expected));
    assert_eq!(host.sent[1].1.key(), Some(2));
    assert_eq!(host.lines, ["Info: one from 9", "Info: two from 9", "hall/Fake at 1.500 s"]);
    let last = ("echo.last".to_owned(), ReportValue::Text("two".to_owned()));
    assert_eq!(host.report, [last, ("echo.executions".to_owned(), ReportValue::Integer(1))]);
    assert_eq!(host.votes, [Work::Done]);
}

#[test]
fn handles_that_were_never_asked_for_say_so() {
    let mut host = FakeHost::new();
    let sent = host.run(|context| context.send(&Publisher::default(), position(1, "one")));
    assert_eq!(sent.unwrap_err().message(), "the publisher belongs to no topic");
    let inbox = [vec![SharedMessage::new(HEADER, position(1, "one"))]];
    let context = Context::new(&mut host, &inbox);
    assert_eq!(context.receive(&Subscription::<Position>::default()).count(), 0);
}

#[test]
fn other_copies_of_a_type_share_one_decoded_value() {
    let shared = SharedMessage::new(HEADER, elsewhere::Position { robot: 4, name: "four".to_owned() });
    let own = shared.get::<elsewhere::Position>().unwrap();
    assert!(std::ptr::eq(own, shared.get().unwrap()));
    let (first, second) = (shared.get::<Position>().unwrap(), shared.clone());
    assert_eq!(*first, position(4, "four"));
    assert!(std::ptr::eq(first, second.get().unwrap()), "decoded twice");
    assert!(std::ptr::eq(shared.bytes(), second.bytes()), "encoded twice");

    let arrived = SharedMessage::from_bytes(HEADER, shared.key(), shared.bytes().to_vec());
    let (one, other) = (arrived.get::<Position>().unwrap(), arrived.get::<elsewhere::Position>().unwrap());
    assert_eq!((one.robot, other.robot, arrived.key()), (4, 4, Some(4)));
    assert!(std::ptr::eq(one, arrived.get().unwrap()) && std::ptr::eq(other, arrived.get().unwrap()));
}

/// A message whose bytes could be those of a position.
#[derive(Clone, Debug, PartialEq, Message)]
struct Door {
    number: u8,
    label: String,
}

#[test]
fn a_message_of_another_schema_is_none_even_where_its_bytes_could_be() {
    let door = Door { number: 4, label: "four".to_owned() };
    assert_eq!(cdr::encode(&door), cdr::encode(&position(4, "four")));
    let shared = SharedMessage::new(HEADER, door.clone());
    assert_eq!((shared.get::<Position>(), shared.get::<Door>()), (None, Some(&door)));
}

#[test]
fn threads_that_decode_at_once_see_one_value() {
    for _ in 0..50 {
        let shared = SharedMessage::from_bytes(HEADER, None, cdr::encode(&position(1, "one")));
        let places: Vec<(usize, usize)> = std::thread::scope(|scope| {
            let read = || {
                let here: *const Position = shared.get::<Position>().unwrap();
                let there: *const elsewhere::Position = shared.get::<elsewhere::Position>().unwrap();
                (here.addr(), there.addr())
            };
            let threads: Vec<_> = (0..4).map(|_| scope.spawn(read)).collect();
            threads.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        assert!(places.iter().all(|place| *place == places[0]), "{places:?}");
    }
}

#[test]
fn bytes_for_passing_use_are_those_that_are_kept() {
    let mut bytes = vec![9; 100];
    let shared = SharedMessage::new(HEADER, position(4, "four"));
    shared.encode_into(&mut bytes);
    assert_eq!(bytes, cdr::encode(&position(4, "four")));
    assert_eq!(shared.bytes(), bytes);
    shared.encode_into(&mut bytes);
    assert_eq!(shared.bytes(), bytes);
    SharedMessage::from_bytes(HEADER, None, vec![1, 2]).encode_into(&mut bytes);
    assert_eq!(bytes, [1, 2]);
}

use saoms_api::{Class, Component, Failure, Message, Topic};

#[derive(Clone, Debug, Message)]
struct Ping;

const PING: Topic<Ping> = Topic::event("PING");

#[derive(Class)]
#[class(name = "test.Deaf", passive, subscribes(PING))]
struct Deaf;

impl Component for Deaf {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Deaf)
    }
}

fn main() {}

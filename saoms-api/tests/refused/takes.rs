use saoms_api::{Class, Component, Context, Failure, Message, Own, Publisher, Subscription, Topic};

#[derive(Clone, Debug, Message)]
struct Fire {
    size: u8,
}

#[derive(Clone, Debug, Message)]
struct Flood {
    depth: u32,
}

const FIRE: Topic<Fire> = Topic::event("FIRE");
const SMOKE: Topic<Fire> = Topic::state("SMOKE");
const FLOOD: Topic<Flood> = Topic::event("FLOOD");

/// Its newest message alone would count.
#[derive(Class)]
#[class(name = "test.State", periodic)]
struct State {
    #[takes("smoke", SMOKE)]
    smoke: Subscription<Fire>,
}

/// Messages of another topic.
#[derive(Class)]
#[class(name = "test.Other", periodic)]
struct Other {
    #[takes("flood", FLOOD)]
    floods: Subscription<Fire>,
}

/// Nothing arrives there.
#[derive(Class)]
#[class(name = "test.Sends", periodic)]
struct Sends {
    #[takes("fire", FIRE)]
    fires: Publisher<Fire>,
}

macro_rules! component {
    ($($class:ty),*) => {
        $(impl Component for $class {
            type Properties = Own<Self>;

            fn execute(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
                Ok(())
            }
        })*
    };
}

component!(State, Other, Sends);

fn main() {}

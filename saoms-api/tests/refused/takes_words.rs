use saoms_api::{Class, Message, Subscription, Topic};

#[derive(Clone, Debug, Message)]
struct Fire {
    size: u8,
}

const FIRE: Topic<Fire> = Topic::event("FIRE");

#[derive(Class)]
#[class(name = "test.NoName", periodic)]
struct NoName {
    #[takes("a fire", FIRE)]
    fires: Subscription<Fire>,
}

#[derive(Class)]
#[class(name = "test.NoTopic", periodic)]
struct NoTopic {
    #[takes("fire")]
    fires: Subscription<Fire>,
}

#[derive(Class)]
#[class(name = "test.NoEvent", periodic)]
struct NoEvent {
    #[takes(FIRE)]
    fires: Subscription<Fire>,
}

#[derive(Class)]
#[class(name = "test.Nothing", periodic)]
struct Nothing {
    #[takes]
    fires: Subscription<Fire>,
}

#[derive(Class)]
#[class(name = "test.Twice", periodic)]
struct Twice {
    #[takes("fire", FIRE)]
    fires: Subscription<Fire>,
    #[takes("fire", FIRE)]
    again: Subscription<Fire>,
}

#[derive(Class)]
#[class(name = "test.Passive", passive)]
struct Passive {
    #[takes("fire", FIRE)]
    fires: Subscription<Fire>,
}

#[derive(Class)]
#[class(name = "test.Both", periodic)]
struct Both {
    #[takes("fire", FIRE)]
    #[subscribes(FIRE)]
    fires: Subscription<Fire>,
}

fn main() {}

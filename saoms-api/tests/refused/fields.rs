use saoms_api::{
    Class, Component, Effector, Entry, Failure, LoopClass, Loops, Message, Publisher, Subscription, Topic,
};

#[derive(Clone, Debug, Message)]
struct Count {
    number: u32,
}

const COUNT: Topic<Count> = Topic::state("COUNT");

#[derive(Class)]
#[class(name = "test.Twice", periodic, publishes(COUNT))]
struct Twice {
    #[publishes(COUNT)]
    count: Publisher<Count>,
}

#[derive(Class)]
#[class(name = "test.Deaf", passive)]
struct Deaf {
    #[subscribes(COUNT)]
    count: Subscription<Count>,
}

#[derive(Class)]
#[class(name = "test.Both", periodic)]
struct Both {
    #[property(default = 1)]
    one: u32,
    #[properties]
    all: (),
}

#[derive(Class)]
#[class(name = "test.Marked", periodic)]
struct Marked {
    #[property]
    #[publishes(COUNT)]
    count: Publisher<Count>,
}

#[derive(Class)]
#[class(name = "test.Loopless", periodic)]
struct Loopless {
    #[loops]
    loops: Loops,
}

#[derive(Class)]
#[class(name = "test.Senses", periodic)]
struct Senses {
    #[senses]
    battery: Entry<f64>,
}

#[derive(LoopClass)]
#[looping(name = "test.Own")]
struct OwnEntry {
    #[entry]
    battery: u32,
}

#[derive(LoopClass)]
#[looping(name = "test.Again", senses("battery"))]
struct Again {
    #[senses]
    battery: Entry<f64>,
    #[effects("charge")]
    charge_at: Effector<f64>,
}

#[derive(Class)]
#[class(name = "test.References", passive)]
struct References {
    #[reference("gps", many)]
    gps: u32,
}

#[derive(Class)]
#[class(name = "test.Unnamed", passive)]
struct Unnamed(#[publishes(COUNT)] Publisher<Count>);

/// Has no class.
struct Classless;

impl Component for Classless {
    type Properties = ();
}

#[derive(Class)]
#[class(name = "test.WrongType", periodic)]
struct WrongType {
    #[publishes(COUNT)]
    count: u32,
}

impl Component for WrongType {
    type Properties = ();
}

fn findings() -> Result<(), Failure> {
    Err(Vec::<saoms_api::Finding>::new())?
}

fn main() {}

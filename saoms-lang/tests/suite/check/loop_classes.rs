//! A class with loops, and loops that fit it or not.

use saoms_api::host::{LoopRegistration, Registration};
use saoms_api::{
    Class, Component, Context, Entries, Extras, Failure, Finding, Knowledge, Loop, LoopClass, Place, Properties,
    PropertyField, Record, Topic,
};
use saoms_lang::registry::Registry;

use crate::check::classes::{Order, Positions, Wheels};

pub(crate) fn add(registry: &mut Registry) {
    registry.add(Registration::of::<Cart>()).unwrap();
    let loops = [
        LoopRegistration::of::<BatterySaver>(),
        LoopRegistration::of::<Courteous>(),
        LoopRegistration::of::<Racer>(),
        LoopRegistration::of::<Boating>(),
        LoopRegistration::of::<Dreamer>(),
        LoopRegistration::of::<Watch>(),
        LoopRegistration::of::<Twin>(),
        LoopRegistration::of::<Radio>(),
        LoopRegistration::of::<Talker>(),
    ];
    loops.into_iter().for_each(|one| registry.add_loop(one).unwrap());
}

/// The knowledge of a cart.
#[derive(Default, Knowledge)]
#[knowledge(name = "example.Cart")]
struct CartKnowledge {
    /// Its charge.
    #[entry(unit = "%")]
    battery: f64,
    #[entry]
    busy: bool,
    /// Whether it stops.
    #[entry(effector)]
    stopped: bool,
    /// Where it goes.
    #[entry(effector)]
    next: i32,
    #[extras]
    extras: Extras,
}

#[derive(Clone, Copy, PartialEq, PropertyField)]
enum Policy {
    Safe,
    Classic,
}

#[derive(Properties)]
struct CartProperties {
    #[property(default = "safe")]
    policy: Policy,
}

/// Brings things.
#[derive(Class)]
#[class(
    name = "example.Cart",
    periodic,
    knowledge = CartKnowledge,
    loops(property = "policy", safe(BatteryMS, CollisionMS, PathMS), classic(PathMS)),
    reference("wheels": Wheels, optional),
    also("example.ClassicCart", policy = "classic")
)]
struct Cart;

impl Component for Cart {
    type Properties = CartProperties;

    fn new(properties: CartProperties) -> Result<Self, Failure> {
        let _ = properties.policy;
        Ok(Cart)
    }
}

/// Loops that do nothing.
macro_rules! idle {
    ($name:ident, $knowledge:ty, $properties:ty, $new:expr) => {
        impl Loop for $name {
            type Properties = $properties;
            type Knowledge = $knowledge;
            type Symptom = Record;
            type Decision = Record;

            fn new(properties: $properties) -> Result<Self, Failure> {
                let judge: fn($properties) -> Result<(), Failure> = $new;
                judge(properties).map(|()| $name)
            }

            fn analyze(&mut self, _: &mut $knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
                Ok(None)
            }

            fn plan(&mut self, _: Record, _: &mut $knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
                Ok(None)
            }

            fn execute(&mut self, _: Record, _: &mut $knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
                Ok(())
            }
        }
    };
    ($name:ident) => {
        idle!($name, dyn Knowledge, (), |()| Ok(()));
    };
}

#[derive(LoopClass)]
#[looping(name = "example.BatteryMS", senses("busy"), effects("battery"))]
struct BatteryMS;
idle!(BatteryMS, CartKnowledge, (), |()| Ok(()));

#[derive(Properties)]
struct CollisionProperties {
    /// How long to wait for others.
    #[property(default = 3, range = 1..=100, unit = "executions")]
    patience: u32,
    /// Where to look.
    #[property(default = 5, range = 1..)]
    reach: u32,
}

/// Gives way.
#[derive(LoopClass)]
#[looping(name = "example.CollisionMS", effects("stopped"), publishes(GIVE_WAY))]
struct CollisionMS;
idle!(CollisionMS, CartKnowledge, CollisionProperties, |properties| {
    match properties.patience > properties.reach * 10 {
        true => Err(Finding::new(Place::property("patience"), "60 is too long for so short a reach").into()),
        false => Ok(()),
    }
});

const GIVE_WAY: Topic<Order> = Topic::event("GIVEWAY");
const QUIET: Topic<Order> = Topic::state("GIVEWAY");

#[derive(LoopClass)]
#[looping(name = "example.PathMS", effects("next"))]
struct PathMS;
idle!(PathMS, CartKnowledge, (), |()| Ok(()));

#[derive(Properties)]
struct SaverProperties {
    /// Below this charge the cart saves.
    #[property(range = 0.0..=100.0, unit = "%")]
    threshold: f64,
}

#[derive(Default, Entries)]
struct Saving {
    /// What it saved.
    #[entry]
    saved: u32,
}

/// Spares the battery.
#[derive(LoopClass)]
#[looping(name = "example.BatterySaver", senses("battery"), effects("busy"), entries(Saving))]
struct BatterySaver;
idle!(BatterySaver, dyn Knowledge, SaverProperties, |properties| {
    let _ = properties.threshold;
    Ok(())
});

/// Gives way to everybody.
#[derive(LoopClass)]
#[looping(name = "example.Courteous", effects("stopped"))]
struct Courteous;
idle!(Courteous);

#[derive(LoopClass)]
#[looping(name = "example.Racer", effects("next"))]
struct Racer;
idle!(Racer);

#[derive(LoopClass)]
#[looping(name = "example.Boating", knowledge = "example.Boat", senses("depth"))]
struct Boating;
idle!(Boating);

#[derive(LoopClass)]
#[looping(name = "example.Dreamer", senses("batery"), effects("mood"))]
struct Dreamer;
idle!(Dreamer);

#[derive(LoopClass)]
#[looping(name = "example.Watch", senses("batery"))]
struct Watch;
idle!(Watch);

#[derive(Default, Entries)]
struct Busy {
    #[entry]
    busy: bool,
}

#[derive(LoopClass)]
#[looping(name = "example.Twin", entries(Busy))]
struct Twin;
idle!(Twin);

#[derive(LoopClass)]
#[looping(name = "example.Radio", reference("wheels": Positions, optional))]
struct Radio;
idle!(Radio);

#[derive(LoopClass)]
#[looping(name = "example.Talker", subscribes(QUIET), reference("fix": Positions))]
struct Talker;
idle!(Talker);

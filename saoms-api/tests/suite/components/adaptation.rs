//! Loops over a knowledge: what they reach, what they may change, what is recorded.

use saoms_api::host::{KnowledgeClass, LoopRegistration, Registration};
use saoms_api::{
    Class, Component, Context, Effector, Entries, Entry, Extras, Failure, Field, Knowledge, Loop, LoopClass, Loops,
    Properties, PropertyField, Record, Value, record,
};

use super::host::FakeHost;

#[derive(Clone, Copy, Debug, Default, PartialEq, Field)]
#[field(pair)]
struct Block {
    x: i32,
    y: i32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Field)]
enum Light {
    #[default]
    Off,
    LowBeam,
}

#[derive(Debug, Default, Entries)]
struct Variables {
    /// It has a job.
    #[entry]
    busy: bool,
    #[entry(effector)]
    stopped: bool,
}

/// Knowledge of a cart.
#[derive(Debug, Default, Knowledge)]
#[knowledge(name = "example.Cart")]
struct Cart {
    /// Position.
    #[entry]
    block: Block,
    #[entry(flatten)]
    variables: Variables,
    /// Battery level.
    #[entry(unit = "%", name = "charge")]
    battery: f64,
    /// Target.
    #[entry(effector)]
    next: Option<Block>,
    #[entry]
    light: Light,
    /// Numbers of known carts.
    #[entry]
    peers: Vec<u16>,
    secret: u64,
    #[extras]
    extras: Extras,
}

#[derive(Default, Entries)]
struct Saving {
    /// Number of times that it saved.
    #[entry]
    saved: u32,
}

#[derive(Properties)]
struct SaverProperties {
    #[property(default = 50.0)]
    threshold: f64,
}

/// Stops a cart.
#[derive(LoopClass)]
#[looping(name = "example.Saver", senses("charge"), effects("stopped"), entries(Saving))]
struct Saver {
    properties: SaverProperties,
    charge: Entry<f64>,
    stopped: Effector<bool>,
    saved: Effector<u32>,
}

impl Loop for Saver {
    type Properties = SaverProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Record;
    type Decision = Record;

    fn new(properties: SaverProperties) -> Result<Self, Failure> {
        let (charge, stopped, saved) = (Entry::default(), Effector::default(), Effector::default());
        Ok(Saver { properties, charge, stopped, saved })
    }

    fn initialize(&mut self, knowledge: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.charge = knowledge.entry("charge")?;
        self.stopped = knowledge.effector("stopped")?;
        self.saved = knowledge.effector("saved")?;
        Ok(())
    }

    fn analyze(&mut self, knowledge: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        let charge = self.charge.get(knowledge)?;
        Ok((charge < self.properties.threshold).then(|| record!("has {charge} % left", charge)))
    }

    fn plan(
        &mut self,
        _: Record,
        knowledge: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<Record>, Failure> {
        Ok((!self.stopped.get(knowledge)?).then(|| record!("stops")))
    }

    fn execute(&mut self, _: Record, knowledge: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.stopped.set(knowledge, true)?;
        let saved = self.saved.get(knowledge)?;
        self.saved.set(knowledge, saved + 1)
    }
}

/// Goes on along the row. Works on the struct, and on the entry that another loop added.
#[derive(LoopClass)]
#[looping(name = "example.Driver", senses("saved"), effects("next", "block", "peers"))]
struct Driver {
    saved: Entry<u32>,
}

impl Loop for Driver {
    type Properties = ();
    type Knowledge = Cart;
    type Symptom = Record;
    type Decision = Record;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Driver { saved: Entry::default() })
    }

    fn initialize(&mut self, cart: &mut Cart, _: &mut Context<'_>) -> Result<(), Failure> {
        self.saved = Entry::of(cart, "saved")?;
        Ok(())
    }

    fn analyze(&mut self, cart: &mut Cart, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(self.saved.changed(cart).then(|| record!("somebody saves")))
    }

    fn plan(&mut self, _: Record, cart: &mut Cart, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        let to = Block { x: cart.block.x + 1, y: cart.block.y };
        Ok(Some(record!("goes to {to}", to = (to.x, to.y))))
    }

    fn execute(&mut self, _: Record, cart: &mut Cart, _: &mut Context<'_>) -> Result<(), Failure> {
        cart.next = Some(Block { x: cart.block.x + 1, ..cart.block });
        cart.light = Light::LowBeam;
        cart.peers.push(7);
        cart.secret += 1;
        Ok(())
    }
}

/// Changes what it does not declare.
#[derive(LoopClass)]
#[looping(name = "example.Rogue", knowledge = Cart)]
struct Rogue;

impl Loop for Rogue {
    type Properties = ();
    type Knowledge = dyn Knowledge;
    type Symptom = Record;
    type Decision = Record;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Rogue)
    }

    fn analyze(&mut self, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(Some(record!("is bored")))
    }

    fn plan(&mut self, symptom: Record, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(Some(symptom))
    }

    fn execute(&mut self, _: Record, knowledge: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        let place = knowledge.all_declared().position(|entry| entry.name == "stopped").unwrap();
        knowledge.set_value(place as u32, Value::Bool(true))
    }
}

#[derive(Clone, Copy, PartialEq, PropertyField)]
enum Mood {
    Calm,
    Wild,
}

#[derive(Properties)]
#[expect(dead_code, reason = "it chooses the loops")]
struct CarProperties {
    #[property(default = "calm")]
    mood: Mood,
}

#[derive(Class)]
#[class(
    name = "example.Car",
    periodic,
    knowledge = Cart,
    loops(property = "mood", calm(Saver, Driver), wild(Driver, Rogue))
)]
struct Car {
    cart: Cart,
    loops: Loops,
}

impl Component for Car {
    type Properties = CarProperties;

    fn new(_: CarProperties) -> Result<Self, Failure> {
        Ok(Car { cart: Cart { battery: 60.0, ..Cart::default() }, loops: Loops::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops = context.loops()?;
        self.loops.initialize(&mut self.cart, context)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.cart.battery -= 6.0;
        self.loops.monitor(&mut self.cart, context)?;
        self.loops.adapt(&mut self.cart, context)
    }
}

const SAVER: LoopRegistration = LoopRegistration::of::<Saver>();
const DRIVER: LoopRegistration = LoopRegistration::of::<Driver>();
const ROGUE: LoopRegistration = LoopRegistration::of::<Rogue>();

#[test]
fn what_loops_change_is_told_and_seen_by_others() {
    let mut host = FakeHost::new();
    host.loops = &[("Driver", DRIVER), ("Saver", SAVER)];
    let mut car = Registration::of::<Car>().construct(&[]).unwrap();
    host.run(|context| car.initialize(context)).unwrap();
    for _ in 0..3 {
        host.run(|context| car.execute(context)).unwrap();
    }
    assert_eq!(
        host.journal,
        [
            "Symptom: has 48 % left", "Decision: stops", "stopped: no -> yes", "saved: 0 -> 1",
            "Symptom: somebody saves", "Decision: goes to (1,0)", "next: none -> (1,0)", "light: OFF -> LOW_BEAM",
            "Symptom: has 42 % left",
        ]
    );
}

/// Entries of which one changes all the time.
#[derive(Debug, Default, Entries)]
struct Wheels {
    #[entry]
    block: Block,
    #[entry(effector, quiet)]
    turns: u32,
}

#[test]
fn quiet_entries_are_read_and_set_by_name_but_are_no_effects() {
    let mut wheels = Wheels::default();
    Entries::set(&mut wheels, 1, Value::Integer(7)).unwrap();
    assert_eq!(Entries::get(&wheels, 1), Some(Value::Integer(7)));
    let mut compared = Vec::new();
    Entries::read(&wheels, &mut compared);
    assert_eq!(compared, [Value::Pair(0, 0), Value::Nothing]);
    assert!(Wheels::DECLARED[1].effector);
}

#[test]
fn an_effector_that_is_not_declared_cannot_be_changed() {
    let mut host = FakeHost::new();
    host.loops = &[("Calm", ROGUE)];
    let mut car = Registration::of::<Car>().construct(&[]).unwrap();
    host.run(|context| car.initialize(context)).unwrap();
    let failure = host.run(|context| car.execute(context)).unwrap_err();
    assert_eq!(
        failure.message(),
        "loop `Calm`: it changed the effector `stopped`, which it does not declare: write `effects(\"stopped\")`"
    );
}

#[test]
fn two_loops_cannot_add_one_entry() {
    let mut host = FakeHost::new();
    host.loops = &[("Saver", SAVER), ("Again", SAVER)];
    let mut car = Registration::of::<Car>().construct(&[]).unwrap();
    let failure = host.run(|context| car.initialize(context)).unwrap_err();
    assert_eq!(
        failure.message(),
        "loop `Again`: the knowledge already has an entry `saved`: no loop can add another one"
    );
}

#[test]
fn entries_are_reached_by_name_and_by_place() {
    let mut cart = Cart { peers: vec![1, 2], ..Cart::default() };
    let knowledge: &mut dyn Knowledge = &mut cart;
    let names: Vec<&str> = knowledge.all_declared().map(|entry| entry.name).collect();
    assert_eq!(names, ["block", "busy", "stopped", "charge", "next", "light", "peers"]);

    let (mut peers, next) =
        (knowledge.entry::<Vec<u16>>("peers").unwrap(), knowledge.entry::<Option<Block>>("next").unwrap());
    assert_eq!(peers.get(knowledge).unwrap(), [1, 2]);
    assert_eq!(next.get(knowledge).unwrap(), None);
    assert_eq!((knowledge.value(6), knowledge.value(7)), (None, None));
    knowledge.set_value(4, Value::Pair(2, 3)).unwrap();
    knowledge.set_value(2, true.into()).unwrap();
    knowledge.set_value(5, Value::Word("LOW_BEAM")).unwrap();
    assert!(!peers.changed(knowledge));
    knowledge.set_to_bytes(6, &saoms_api::host::cdr::encode(&vec![9_u16])).unwrap();
    assert!(peers.changed(knowledge));
    assert!(!peers.changed(knowledge));
    assert_eq!(next.get(knowledge).unwrap(), Some(Block { x: 2, y: 3 }));
    assert!(cart.variables.stopped && !cart.variables.busy);
    assert_eq!((cart.peers.as_slice(), cart.light), (&[9_u16][..], Light::LowBeam));
}

#[test]
fn wrong_entries_are_refused() {
    let mut cart = Cart::default();
    let knowledge: &mut dyn Knowledge = &mut cart;
    let say = |result: Result<(), Failure>| result.unwrap_err().message().to_owned();
    assert_eq!(say(knowledge.entry::<f64>("charges").map(drop)), "there is no entry `charges`; did you mean `charge`?");
    assert_eq!(
        say(knowledge.entry::<bool>("charge").map(drop)),
        "entry `charge` is of the type \"float64\", and not \"bool\""
    );
    assert_eq!(
        say(knowledge.effector::<f64>("charge").map(drop)),
        "the loop does not declare that it changes entry `charge`: write `effects(\"charge\")`, and ask in `initialize`"
    );
    assert_eq!(say(knowledge.set_value(3, true.into())), "entry `charge`: `yes` is not a \"float64\"");
    assert_eq!(say(knowledge.set_value(9, true.into())), "there is no entry 9");
    assert!(say(knowledge.set_to_bytes(6, &[1])).starts_with("entry `peers`: "));
    let strange = "this entry is not one of this knowledge: ask for it in `initialize`";
    assert_eq!(say(Entry::<f64>::default().get(knowledge).map(drop)), strange);
}

const BLOCK: &str = r#"{"name":"Block","fields":[{"name":"x","type":"int32"},{"name":"y","type":"int32"}]}"#;

#[test]
fn knowledge_and_loops_declare_themselves() {
    let knowledge = [
        r#"{"name":"example.Cart","doc":"Knowledge of a cart.","entries":["#,
        r#"{"name":"block","type":"#,
        BLOCK,
        r#","value":"pair","doc":"Position."},"#,
        r#"{"name":"busy","type":"bool","value":"bool","doc":"It has a job."},"#,
        r#"{"name":"stopped","type":"bool","value":"bool","effector":true},"#,
        r#"{"name":"charge","type":"float64","value":"number","doc":"Battery level.","unit":"%"},"#,
        r#"{"name":"next","type":{"optional":"#,
        BLOCK,
        r#"},"value":"pair","doc":"Target.","effector":true},"#,
        r#"{"name":"light","type":{"enumeration":"uint8","values":{"OFF":0,"LOW_BEAM":1}},"value":"word"},"#,
        r#"{"name":"peers","type":{"sequence":"uint16"},"doc":"Numbers of known carts."}]}"#,
    ]
    .concat();
    assert_eq!(Cart::DECLARATION, knowledge);
    assert_eq!(
        Saver::DECLARATION,
        concat!(
            r#"{"contract":1,"loop":"example.Saver","doc":"Stops a cart.","properties":["#,
            r#"{"name":"threshold","type":"float","default":"50.0"}],"senses":["charge"],"effects":["stopped"],"#,
            r#""entries":[{"name":"saved","type":"uint32","value":"integer","doc":"Number of times that it saved."}],"#,
            r#""publishes":[],"subscribes":[],"references":[]}"#
        )
    );
    assert_eq!(<Driver as LoopClass>::KNOWLEDGE, Some("example.Cart"));
    assert!(Driver::DECLARATION.contains(r#""knowledge":"example.Cart","direct":true,"properties":[]"#));
    let class = <Car as Class>::DECLARATION;
    let loops = r#","loops":{"property":"mood","lists":{"calm":["example.Saver","example.Driver"],"wild":["example.Driver","example.Rogue"]}}}"#;
    assert_eq!(class.split_once(r#","knowledge":"#).unwrap().1, format!("{knowledge}{loops}"));
    assert_eq!(Car::LOOPS.len(), 3);
}

use saoms_api::{Class, Component, Context, Entries, Extras, Failure, Field, Knowledge, Loop, LoopClass, Record};

#[derive(Knowledge)]
#[knowledge(name = "example.Cart")]
struct WithoutExtras {
    #[entry]
    battery: f64,
}

#[derive(Knowledge)]
struct WithoutName {
    #[extras]
    extras: Extras,
}

#[derive(Entries)]
struct Nothing {
    hidden: bool,
}

#[derive(Entries)]
struct Twice {
    #[entry]
    one: bool,
    #[entry(name = "one")]
    other: bool,
}

#[derive(Entries)]
struct Unknown {
    #[entry(output)]
    one: bool,
}

#[derive(Field)]
#[field(pair)]
struct Long {
    x: i64,
    y: i64,
}

#[derive(Knowledge)]
#[knowledge(name = "example.Cart")]
struct Cart {
    #[entry]
    battery: f64,
    #[extras]
    extras: Extras,
}

#[derive(LoopClass)]
#[looping(name = "example.")]
struct Nameless;

#[derive(LoopClass)]
#[looping(name = "example.Saver", sense("battery"))]
struct Misspelt;

#[derive(LoopClass)]
#[looping(name = "example.Lift", knowledge = "example.Tower")]
struct Lift;

impl Loop for Lift {
    type Properties = ();
    type Knowledge = dyn Knowledge;
    type Symptom = Record;
    type Decision = Record;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Lift)
    }

    fn analyze(&mut self, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(None)
    }

    fn plan(&mut self, _: Record, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(None)
    }

    fn execute(&mut self, _: Record, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        Ok(())
    }
}

#[derive(Class)]
#[class(name = "example.Ignorant", periodic, loops(Lift))]
struct Ignorant;

#[derive(Class)]
#[class(name = "example.Robot", periodic, knowledge = Cart, loops(property = "mood", calm(Lift)))]
struct Robot;

impl Component for Robot {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Robot)
    }
}

fn main() {}

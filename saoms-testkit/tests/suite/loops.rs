//! Loops alone, held to the rules, and loops in the component that they are made for.

use std::panic::{AssertUnwindSafe, catch_unwind};

use saoms_api::{Context, Effector, Entry, Extras, Failure, Knowledge, Loop, LoopClass, Properties, Record, record};
use saoms_components::grid::Block;
use saoms_components::messages::POSITION;
use saoms_components::robot::Robot;
use saoms_testkit::{Bench, comply_as, comply_loop};

/// What the loops of these tests work on.
#[derive(Default, Knowledge)]
#[knowledge(name = "test.Boiler")]
struct Boiler {
    #[entry(unit = "C")]
    heat: i32,
    #[entry]
    people: Vec<u32>,
    #[entry(effector)]
    burns: bool,
    #[extras]
    extras: Extras,
}

#[derive(Properties)]
struct ThermostatProperties {
    /// It refuses to work with more people than this.
    #[property(default = 1000)]
    most: u32,
    /// It also changes what it only senses.
    #[property(default = false)]
    meddles: bool,
}

/// Burns while it is cold and somebody is there.
#[derive(LoopClass)]
#[looping(name = "test.Thermostat", senses("heat", "people"), effects("burns"))]
struct Thermostat {
    properties: ThermostatProperties,
    heat: Entry<i32>,
    people: Entry<Vec<u32>>,
    burns: Effector<bool>,
    executions: u32,
}

impl Loop for Thermostat {
    type Properties = ThermostatProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Record;
    type Decision = Record;

    fn new(properties: ThermostatProperties) -> Result<Self, Failure> {
        let (heat, people, burns) = (Entry::default(), Entry::default(), Effector::default());
        Ok(Thermostat { properties, heat, people, burns, executions: 0 })
    }

    fn initialize(&mut self, boiler: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.heat = boiler.entry("heat")?;
        self.people = boiler.entry("people")?;
        self.burns = boiler.effector("burns")?;
        Ok(())
    }

    fn analyze(&mut self, boiler: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        self.executions += 1;
        let people = self.people.get(boiler)?;
        if people.iter().any(|person| *person > self.properties.most) {
            return Err("who is that?".into());
        }
        let wanted = self.heat.get(boiler)? < 20 && !people.is_empty();
        Ok((wanted != self.burns.get(boiler)?).then(|| record!(is_wrong: "burns although it should not, or not")))
    }

    fn plan(&mut self, _: Record, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(Some(record!(switches: "switches")))
    }

    fn execute(&mut self, _: Record, boiler: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        if self.properties.meddles {
            boiler.effector::<i32>("heat")?.set(boiler, 20)?;
        }
        let burns = self.burns.get(boiler)?;
        self.burns.set(boiler, !burns)
    }
}

/// Orders a block, and says what a voltmeter measures.
#[derive(Default, LoopClass)]
#[looping(name = "test.Jumper", senses("block"), effects("drive", "battery"))]
struct Jumper {
    to: i32,
    drive: Effector<Option<Block>>,
    battery: Effector<f64>,
}

#[derive(Properties)]
struct JumperProperties {
    /// The column to drive to.
    #[property(default = 0)]
    to: i32,
}

impl Loop for Jumper {
    type Properties = JumperProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Record;
    type Decision = Record;

    fn new(properties: JumperProperties) -> Result<Self, Failure> {
        Ok(Jumper { to: properties.to, ..Jumper::default() })
    }

    fn initialize(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.drive = robot.effector("drive")?;
        self.battery = robot.effector("battery")?;
        Ok(())
    }

    fn monitor(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.battery.set(robot, 41.5)
    }

    fn analyze(&mut self, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(Some(record!(wants_to_jump: "wants to jump")))
    }

    fn plan(&mut self, _: Record, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(Some(record!(jumps: "jumps")))
    }

    fn execute(&mut self, _: Record, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.drive.set(robot, Some(Block::new(self.to, 1)))
    }
}

fn told(test: impl FnOnce()) -> String {
    let cause = catch_unwind(AssertUnwindSafe(test)).unwrap_err();
    cause.downcast_ref::<String>().unwrap().clone()
}

#[test]
fn a_loop_complies_with_any_values_of_what_it_senses() {
    comply_loop::<Thermostat, Boiler>(Boiler::default, &[("most", "4294967295")]);
    let said = told(|| comply_loop::<Thermostat, Boiler>(Boiler::default, &[]));
    assert!(said.contains("any values of the entries that it senses: ") && said.ends_with("who is that?"), "{said}");
    let said =
        told(|| comply_loop::<Thermostat, Boiler>(Boiler::default, &[("most", "4294967295"), ("meddles", "true")]));
    assert!(said.starts_with("the loop does not keep the rule that ") && said.contains("entry `heat`"), "{said}");
}

/// The robot of a bench with this loop in place of the one that follows its path.
fn robot(to: &str) -> Bench {
    let robot = Bench::of::<Robot>(&[("ID", "Robot1")]).unwrap();
    robot.with_loop::<Jumper>("PathFollowerMS", &[("to", to)]).unwrap()
}

#[test]
fn a_robot_carries_out_the_orders_of_a_loop_and_takes_over_what_it_measures() {
    let mut bench = robot("1");
    bench.start().unwrap();
    bench.execute().unwrap();
    let moved = ["PathFollowerMS block: (0,1) -> (1,1)", "PathFollowerMS next: (0,1) -> (1,1)"];
    assert_eq!(&bench.journal()[bench.journal().len() - 2..], moved, "they are effects of the loop that ordered it");
    bench.execute().unwrap();
    assert!(bench.transcript().contains("battery level: 41.5"), "{}", bench.transcript());
    assert!(bench.sent(&POSITION).is_empty(), "the loop announces nothing");
}

#[test]
fn an_order_to_drive_too_far_is_a_failure() {
    let mut bench = robot("5");
    bench.start().unwrap();
    let failure = bench.execute().unwrap_err().to_string();
    assert_eq!(failure, "`drive` is (5,1), but the robot is at (0,1): expected a free block beside that one");
}

#[test]
fn a_component_complies_with_a_loop_of_the_test() {
    comply_as(|| {
        let robot = Bench::of::<Robot>(&[("ID", "Robot1")])?;
        robot.with_loop::<Jumper>("PathFollowerMS", &[("to", "0")])
    });
    let Err(refused) = Bench::of::<Robot>(&[("ID", "Robot1")]).unwrap().with_loop::<Jumper>("Jumper", &[("to", "x")])
    else {
        panic!("it takes any value")
    };
    assert!(refused.to_string().contains("to"), "{refused}");
}

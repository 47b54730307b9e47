//! Every component that ships complies with the rules for components.

use saoms_components::broker::MessageBroker;
use saoms_components::environment::Environment;
use saoms_components::master::{MasterEnvironment, MasterRobot};
use saoms_components::robot::Robot;
use saoms_components::world::World;
use saoms_testkit::{Bench, comply, comply_as};

#[test]
fn robots_comply() {
    comply::<Robot>(&[("ID", "Robot1")]);
    comply::<Robot>(&[("ID", "Robot1"), ("policy", "classic")]);
}

#[test]
fn robots_in_a_world_comply() {
    comply_as(|| {
        let mut world = Bench::of::<World>(&[])?;
        world.start()?;
        Ok(Bench::of::<Robot>(&[("ID", "Robot1")])?.wire("world", world, "hardware"))
    });
}

#[test]
fn worlds_comply() {
    comply::<World>(&[]);
}

#[test]
fn masters_comply() {
    comply::<MasterEnvironment>(&[]);
    comply::<MasterRobot>(&[]);
}

#[test]
fn environments_comply() {
    comply::<Environment>(&[("scenario", "at 1s luggage (1,1) to (2,2)")]);
}

#[test]
fn brokers_comply() {
    comply::<MessageBroker>(&[]);
}

use saoms_api::builtin_interfaces;
use saoms_api::host::cdr;
use saoms_api::{Cause, Header, Message, Topic};

use super::messages::{OccupancyGrid, Scene, Transforms};
use super::*;
use crate::grid::{Block, Map};
use crate::messages::{HandlingKind, LuggageStage};

/// A drawing of the messages of these topics in a site.
struct Drawn(Sites);

impl Drawn {
    fn say<M: Message>(&mut self, site: &str, topic: &Topic<M>, message: M) {
        let (name, declared) = (format!("{site}{}", topic.declaration().name), topic.declaration());
        if !self.0.topics.contains_key(&name) {
            self.0.topic(&name, &declared);
        }
        let header = Header { sender: 0, sent: Time::START, cause: Cause::default() };
        self.0.message(&name, &SharedMessage::new(header, message));
    }

    /// Names of the topics that are drawn, with the messages.
    fn draw(&mut self, second: u64) -> BTreeMap<String, Vec<u8>> {
        let at = Time::from_nanos(second * 1_000_000_000);
        self.0.draw(at).into_iter().map(|one| (one.topic, one.bytes)).collect()
    }
}

fn robot(robot: u32, x: i32, battery: f64) -> RobotList {
    let (block, charger) = (Block::new(x, 0), Block::new(0, 1));
    RobotList { robot, active: true, battery, block, charger, ..RobotList::default() }
}

fn ids(scene: &Scene) -> Vec<&str> {
    scene.entities.iter().map(|entity| entity.id.as_str()).collect()
}

#[test]
fn a_site_is_drawn_with_its_robots_where_they_are() {
    let mut drawn = Drawn(Sites::default());
    let map = Map::read("..@\n...").unwrap();
    drawn.say("North/", &AREA, Area::from(&map));
    drawn.say("North/", &ROBOT_LIST, robot(7, 1, 82.6));
    let (block, next) = (Block::new(1, 0), Block::new(1, 1));
    drawn.say("North/", &POSITION, Position { robot: 7, block, next, wanted: next, ..Position::default() });
    drawn.say("North/", &TERRITORY, Territory { zone: 1, width: 3, height: 2, ..Territory::default() });
    let found = drawn.draw(3);
    assert_eq!(Vec::from_iter(found.keys()), ["/North/floor", "/North/map", "/North/scene", "/North/tf"]);
    let grid: OccupancyGrid = cdr::decode(&found["/North/map"]).unwrap();
    assert_eq!((grid.info.width, grid.info.height, grid.info.origin.position.y), (3, 2, -2.0));
    // The lowest row comes first.
    assert_eq!(grid.data, [0, 0, 0, 0, 0, 100]);
    let stamp = builtin_interfaces::Time { sec: 3, nanosec: 0 };
    assert_eq!((grid.header.stamp, &*grid.header.frame_id), (stamp, "North/map"));
    let Transforms { transforms } = cdr::decode(&found["/North/tf"]).unwrap();
    let [frame] = &transforms[..] else { panic!("{transforms:?}") };
    assert_eq!((&*frame.header.frame_id, &*frame.child_frame_id), ("North/map", "North/robot7"));
    let place = frame.transform.translation;
    assert_eq!((place.x, place.y), (1.5, -0.5), "the centre of its block");
    assert!(frame.transform.rotation.z < 0.0, "it looks down");
    let scene: Scene = cdr::decode(&found["/North/scene"]).unwrap();
    assert_eq!((ids(&scene), &*scene.entities[0].texts[0].text), (vec!["robot7"], "7\n83 %"));
    assert_eq!((&*scene.entities[0].frame_id, scene.entities[0].frame_locked), ("North/robot7", true));
    let floor: Scene = cdr::decode(&found["/North/floor"]).unwrap();
    assert_eq!(ids(&floor), ["blocks", "zone1", "chargers"]);
    assert_eq!(floor.entities[0].cubes[0].pose.position.x, 2.5);
    assert_eq!(drawn.draw(4), BTreeMap::new(), "nothing has changed");
    // A move changes its frame alone.
    drawn.say("North/", &POSITION, Position { robot: 7, block: next, next, wanted: next, ..Position::default() });
    assert_eq!(Vec::from_iter(drawn.draw(5).keys()), ["/North/tf"]);
    drawn.0.begin_again();
    assert_eq!(drawn.draw(6).len(), 4, "another file has everything");
}

#[test]
fn luggage_lies_on_the_floor_or_on_a_robot() {
    let mut drawn = Drawn(Sites::default());
    let scene = |drawn: &mut Drawn| -> Scene { cdr::decode(&drawn.draw(1)["/scene"]).unwrap() };
    let request = EventLuggage::request(3, Block::new(1, 0), Block::new(2, 0));
    let handling = |kind| Handling { luggage: 3, robot: 1, kind, block: Block::new(1, 0), other: 0 };
    drawn.say("", &ROBOT_LIST, robot(1, 0, 50.0));
    drawn.say("", &EVENT_LUGGAGE, request.clone());
    let waits = scene(&mut drawn);
    assert_eq!(ids(&waits), ["robot1", "luggage3"]);
    let place = waits.entities[1].cubes[0].pose.position;
    assert_eq!((place.x, place.y), (1.5, -0.5));
    let state = |scene: &Scene| scene.entities[0].metadata[1].value.clone();
    assert_eq!(state(&waits), "free");
    drawn.say("", &EVENT_LUGGAGE, EventLuggage { robot: 1, stage: LuggageStage::Taken, ..request.clone() });
    assert_eq!(state(&scene(&mut drawn)), "goes to luggage");
    drawn.say("", &HANDLING, handling(HandlingKind::Collected));
    let carried = scene(&mut drawn);
    assert_eq!((ids(&carried), state(&carried)), (vec!["robot1"], "carries luggage".to_owned()));
    assert_eq!((carried.entities[0].cubes.len(), &*carried.deletions[0].id), (2, "luggage3"));
    drawn.say("", &HANDLING, handling(HandlingKind::Delivered));
    drawn.say("", &EVENT_LUGGAGE, EventLuggage { robot: 1, stage: LuggageStage::Delivered, ..request });
    let free = scene(&mut drawn);
    assert_eq!((state(&free), free.entities[0].cubes.len()), ("free".to_owned(), 1));
    // Somebody takes the robot off the floor.
    drawn.say("", &FAULT, Fault::gone(1));
    let gone = scene(&mut drawn);
    assert_eq!((ids(&gone), &*gone.deletions[0].id), (vec![], "robot1"));
}

//! What a drawing knows of a site, from the messages of its robots, zones and world.

use std::collections::{BTreeMap, BTreeSet};
use std::mem;

use saoms_api::Message;
use saoms_api::builtin_interfaces::Time;
use saoms_api::extension::DrawnMessage;

use super::floor;
use super::messages::{Deletion, Entity, Header, Scene, Transform, TransformStamped, Transforms, Vector3};
use super::robots::{Robot, Said, centre, piece};
use crate::grid::{Block, Map};
use crate::hardware::Area;
use crate::messages::{
    EventLuggage, Fault, FaultKind, Handling, HandlingKind, LuggageStage, Position, Removal, RobotList, Territory,
    is_visit,
};

/// A site, and what of it has changed since it was drawn.
#[derive(Debug)]
pub(super) struct Site {
    /// What stands before the names of its topics and frames: nothing, or `North/`.
    prefix: String,
    robots: BTreeMap<u32, Robot>,
    /// The luggage that was not delivered.
    pieces: BTreeMap<u32, Piece>,
    chargers: BTreeMap<u32, Block>,
    zones: BTreeMap<u32, Territory>,
    map: Option<Map>,
    /// The entities of the scene as it was drawn.
    shown: BTreeSet<String>,
    changed: Changed,
}

/// A piece of luggage on the floor or on a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Piece {
    block: Block,
    /// The robot that brings it, and whether it has collected it.
    robot: Option<u32>,
    is_carried: bool,
}

/// Topics that are to be written.
#[derive(Clone, Copy, Debug, Default)]
struct Changed {
    frames: bool,
    scene: bool,
    floor: bool,
    map: bool,
}

impl Site {
    pub(super) fn new(name: &str) -> Site {
        Site {
            prefix: if name.is_empty() { String::new() } else { format!("{name}/") },
            robots: BTreeMap::new(),
            pieces: BTreeMap::new(),
            chargers: BTreeMap::new(),
            zones: BTreeMap::new(),
            map: None,
            shown: BTreeSet::new(),
            changed: Changed::default(),
        }
    }

    /// Changes a robot, and notes what has to be drawn of it.
    fn change(&mut self, number: u32, change: impl FnOnce(&mut Robot)) {
        let prefix = &self.prefix;
        let robot = self.robots.entry(number).or_insert_with(|| Robot::new(format!("{prefix}robot{number}")));
        let before = (robot.block, robot.heading);
        let looks = |robot: &Robot| (robot.block.is_some(), robot.said, robot.takes, robot.carries, robot.is_broken);
        let looked = looks(robot);
        change(robot);
        self.changed.frames |= robot.block.is_some() && before != (robot.block, robot.heading);
        self.changed.scene |= looked != looks(robot);
    }

    /// Changes the luggage, and what the robots have of it.
    fn carry(&mut self, number: u32, new: Option<Piece>) {
        let old = match new {
            Some(new) => self.pieces.insert(number, new),
            None => self.pieces.remove(&number),
        };
        if old == new {
            return;
        }
        self.changed.scene = true;
        if let Some(robot) = old.and_then(|old| old.robot) {
            self.change(robot, |robot| {
                for has in [&mut robot.takes, &mut robot.carries] {
                    *has = has.filter(|has| *has != number);
                }
            });
        }
        if let Some((robot, is_carried)) = new.and_then(|new| Some((new.robot?, new.is_carried))) {
            self.change(
                robot,
                |robot| {
                    if is_carried { robot.carries = Some(number) } else { robot.takes = Some(number) }
                },
            );
        }
    }

    pub(super) fn area(&mut self, area: &Area) {
        let map: Option<Map> = area.clone().into();
        if map.is_some() && map != self.map {
            self.map = map;
            (self.changed.map, self.changed.floor) = (true, true);
        }
    }

    pub(super) fn territory(&mut self, territory: &Territory) {
        let known = self.zones.insert(territory.zone, territory.clone());
        self.changed.floor |= known.as_ref() != Some(territory);
    }

    pub(super) fn position(&mut self, &Position { robot, block, next, .. }: &Position) {
        self.change(robot, |robot| {
            robot.heading = robot.heading.of(robot.block.unwrap_or(block), block).of(block, next);
            robot.block = Some(block);
        });
    }

    pub(super) fn robot(&mut self, said: &RobotList) {
        let known = self.chargers.insert(said.robot, said.charger);
        self.changed.floor |= known != Some(said.charger);
        self.change(said.robot, |robot| {
            robot.said = Said::from(said);
            // By the manual's rules a robot does not say the position that it charges at.
            let is_elsewhere = said.in_charge && robot.block != Some(said.charger);
            if robot.block.is_none() || is_elsewhere {
                robot.block = Some(if said.in_charge { said.charger } else { said.block });
            }
            // One that began anew was repaired.
            robot.is_broken &= robot.began == said.began;
            robot.began = said.began;
        });
    }

    pub(super) fn fault(&mut self, fault: &Fault) {
        if fault.is_any() {
            return;
        }
        self.change(fault.robot, |robot| match fault.kind {
            FaultKind::Breakdown | FaultKind::Failed | FaultKind::Restarting => robot.is_broken = true,
            FaultKind::Gone => robot.block = None,
        });
    }

    pub(super) fn removal(&mut self, removal: &Removal) {
        if removal.kind == Some(FaultKind::Gone) {
            self.change(removal.robot, |robot| robot.block = None);
        }
        if let Some(block) = removal.block {
            for number in &removal.luggage {
                self.carry(*number, Some(Piece { block, robot: None, is_carried: false }));
            }
        }
        removal.delivered.iter().for_each(|number| self.carry(*number, None));
    }

    pub(super) fn handling(&mut self, &Handling { luggage, robot, kind, block, .. }: &Handling) {
        let piece = |robot, is_carried| Some(Piece { block, robot, is_carried });
        match kind {
            HandlingKind::Collected => self.carry(luggage, piece(Some(robot), true)),
            HandlingKind::PutDown => self.carry(luggage, piece(None, false)),
            HandlingKind::Delivered => self.carry(luggage, None),
        }
    }

    pub(super) fn luggage(&mut self, event: &EventLuggage) {
        let EventLuggage { luggage, robot, from, stage, .. } = *event;
        if is_visit(luggage) {
            return;
        }
        let known = self.pieces.get(&luggage).copied();
        let is_carried = known.is_some_and(|known| known.is_carried);
        let block = known.map_or(from, |known| known.block);
        match stage {
            LuggageStage::Delivered | LuggageStage::GivenUp => self.carry(luggage, None),
            LuggageStage::Request if known.is_none() => {
                self.carry(luggage, Some(Piece { block, robot: None, is_carried: false }));
            }
            LuggageStage::Taken if !is_carried => {
                self.carry(luggage, Some(Piece { block, robot: Some(robot), is_carried: false }));
            }
            LuggageStage::Release | LuggageStage::Refused
                if !is_carried && known.is_some_and(|known| known.robot == Some(robot)) =>
            {
                self.carry(luggage, Some(Piece { block, robot: None, is_carried: false }));
            }
            _ => {}
        }
    }

    /// Has everything be drawn.
    pub(super) fn begin_again(&mut self) {
        let (has_robots, has_floor) = (!self.robots.is_empty(), !self.chargers.is_empty() || !self.zones.is_empty());
        let (scene, map) = (has_robots || !self.pieces.is_empty(), self.map.is_some());
        self.changed = Changed { frames: has_robots, scene, floor: map || has_floor, map };
        self.shown.clear();
    }

    /// Draws what has changed.
    pub(super) fn draw(&mut self, at: Time, to: &mut Vec<DrawnMessage>) {
        let Changed { frames, scene, floor, map } = mem::take(&mut self.changed);
        let frame = format!("{}map", self.prefix);
        if let Some(grid) = self.map.as_ref().filter(|_| map) {
            to.push(self.on("map", &floor::grid(grid, at, &frame)));
        }
        if floor {
            let mut entities: Vec<Entity> = self.map.iter().map(|map| floor::blocks(map, at, &frame)).collect();
            entities.extend(self.zones.values().map(|zone| floor::zone(zone, at, &frame)));
            entities.push(floor::chargers(self.chargers.values().copied(), at, &frame));
            to.push(self.on("floor", &Scene { deletions: Vec::new(), entities }));
        }
        // A robot is nowhere before its frame.
        if frames {
            let transforms = self.robots.values().filter_map(|robot| transform(robot, at, &frame)).collect();
            to.push(self.on("tf", &Transforms { transforms }));
        }
        if scene {
            let scene = self.scene(at, &frame);
            to.push(self.on("scene", &scene));
        }
    }

    /// Robots and luggage, and what was there and is no more.
    fn scene(&mut self, at: Time, frame: &str) -> Scene {
        let robots = self.robots.iter().filter(|(_, robot)| robot.block.is_some());
        let mut entities: Vec<Entity> = robots.map(|(number, robot)| robot.entity(*number, at)).collect();
        let pieces = self.pieces.iter().filter(|(_, piece)| !piece.is_carried);
        entities.extend(pieces.map(|(number, one)| piece(*number, one.block, one.robot.is_some(), (at, frame))));
        let shown: BTreeSet<String> = entities.iter().map(|entity| entity.id.clone()).collect();
        let gone = mem::replace(&mut self.shown, shown);
        let gone = gone.into_iter().filter(|id| !self.shown.contains(id));
        let deletions = gone.map(|id| Deletion { timestamp: at, r#type: Deletion::MATCHING_ID, id }).collect();
        Scene { deletions, entities }
    }

    fn on<M: Message>(&self, topic: &str, message: &M) -> DrawnMessage {
        DrawnMessage::new(format!("/{}{topic}", self.prefix), message)
    }
}

/// Where the frame of a robot lies.
fn transform(robot: &Robot, at: Time, frame: &str) -> Option<TransformStamped> {
    let place = centre(robot.block?);
    Some(TransformStamped {
        header: Header { stamp: at, frame_id: frame.to_owned() },
        child_frame_id: robot.frame.clone(),
        transform: Transform {
            translation: Vector3 { x: place.x, y: place.y, z: place.z },
            rotation: robot.heading.rotation(),
        },
    })
}

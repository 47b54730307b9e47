use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::path::{Path, Pieces, Robot};
use crate::grid::{Block, Map};
use crate::hardware::Area;
use crate::messages::{
    AREA, COLLISION, Collision, EVENT_LUGGAGE, EventLuggage, FAULT, Fault, FaultKind, LuggageStage, POSITION, Position,
    ROBOT_LIST, RobotList, carries,
};
use saoms_api::host::{SharedMessage, TopicDeclaration};

/// The limit of legs that can be distinguished: beyond this number, only how often each block was entered is kept.
const LEGS: usize = 20_000;

/// The messages of a run, as far as the picture shows them. A recording grows with the area and the number of robots,
/// not with the length of the run.
#[derive(Debug, Default)]
pub(super) struct Recording {
    pub(super) robots: BTreeMap<u32, Robot>,
    pub(super) map: Option<Map>,
    /// Luggage that was asked for and not delivered: where it was to be collected.
    pub(super) open: BTreeMap<u32, Block>,
    pub(super) collected: BTreeMap<Block, Pieces>,
    pub(super) delivered: BTreeMap<Block, Pieces>,
    pub(super) collisions: BTreeMap<Block, u32>,
    /// Number of robots that broke down, by their block.
    pub(super) breakdowns: BTreeMap<Block, u32>,
    /// These robots: one that breaks down again where it is counts once.
    broken: BTreeSet<(u32, Block)>,
    pub(super) visits: BTreeMap<Block, Visits>,
    legs: usize,
}

/// The number of times a block was entered, and the surplus of rightward and downward moves over those the other way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Visits {
    pub(super) count: u64,
    pub(super) right: i64,
    pub(super) down: i64,
}

/// The content of a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    Area,
    Position,
    Robot,
    Luggage,
    Collision,
    Fault,
}

impl Content {
    /// The content of a topic whose messages the picture shows, whatever the name of the topic.
    pub(super) fn of(declared: &TopicDeclaration<'_>) -> Option<Content> {
        Some(match declared {
            area if carries(area, &AREA) => Content::Area,
            position if carries(position, &POSITION) => Content::Position,
            robot if carries(robot, &ROBOT_LIST) => Content::Robot,
            luggage if carries(luggage, &EVENT_LUGGAGE) => Content::Luggage,
            collision if carries(collision, &COLLISION) => Content::Collision,
            fault if carries(fault, &FAULT) => Content::Fault,
            _ => return None,
        })
    }
}

impl Recording {
    /// Records a message that a component sent on a topic with this content. Requests for luggage are kept elsewhere,
    /// as nobody says in which world it is; of luggage that is delivered now, `from` is where it was to be collected.
    pub(super) fn record(
        &mut self,
        content: Content,
        component: &Arc<str>,
        message: &SharedMessage,
        from: Option<Block>,
    ) {
        match content {
            Content::Area => self.record_area(message),
            Content::Position => self.record_position(component, message),
            Content::Robot => self.record_robot(component, message),
            Content::Luggage => self.record_luggage(component, message, from),
            Content::Collision => self.record_collision(message),
            Content::Fault => self.record_fault(message),
        }
    }

    /// Takes in another recording, of other robots.
    pub(super) fn absorb(&mut self, other: Recording) {
        let Recording { robots, map, open, collected, delivered, collisions, breakdowns, visits, legs, .. } = other;
        self.robots.extend(robots);
        self.map = self.map.take().or(map);
        self.open.extend(open);
        self.legs += legs;
        for (own, others) in [(&mut self.collected, collected), (&mut self.delivered, delivered)] {
            for (block, pieces) in others {
                own.entry(block).or_default().absorb(pieces);
            }
        }
        for (own, others) in [(&mut self.collisions, collisions), (&mut self.breakdowns, breakdowns)] {
            for (block, count) in others {
                *own.entry(block).or_default() += count;
            }
        }
        for (block, more) in visits {
            let visits = self.visits.entry(block).or_default();
            visits.count += more.count;
            visits.right += more.right;
            visits.down += more.down;
        }
    }

    /// True if the paths were too long to be kept.
    pub(super) fn is_too_long(&self) -> bool {
        self.legs > LEGS
    }

    fn record_area(&mut self, message: &SharedMessage) {
        if let Some(area) = message.get::<Area>() {
            self.map = area.clone().into();
        }
    }

    fn record_position(&mut self, component: &Arc<str>, message: &SharedMessage) {
        if let Some(position) = message.get::<Position>() {
            self.robot_at(position.robot, component, position.block);
        }
    }

    fn record_robot(&mut self, component: &Arc<str>, message: &SharedMessage) {
        let Some(said) = message.get::<RobotList>() else { return };
        let robot = self.robots.entry(said.robot).or_insert_with(|| Robot::new(component));
        robot.charger = Some(said.charger);
        robot.empty = said.is_out_of_battery();
        if said.in_charge {
            // By the manual's rules a robot does not say the position that it charges at.
            self.robot_at(said.robot, component, said.charger);
        }
    }

    fn record_luggage(&mut self, component: &Arc<str>, message: &SharedMessage, from: Option<Block>) {
        let Some(event) = message.get::<EventLuggage>() else { return };
        match event.stage {
            LuggageStage::Request => {}
            LuggageStage::Delivered => {
                self.robot_at(event.robot, component, event.block);
                let from = from.unwrap_or(event.from);
                self.collected.entry(from).or_default().add(event.luggage);
                self.delivered.entry(event.to).or_default().add(event.luggage);
                if let Some(robot) = self.robots.get_mut(&event.robot) {
                    robot.delivered.add(event.luggage);
                }
            }
            // The master says that no robot can bring it.
            LuggageStage::GivenUp if event.robot == 0 => {}
            // The robot responds, and says where it is.
            _ => self.robot_at(event.robot, component, event.block),
        }
    }

    fn record_collision(&mut self, message: &SharedMessage) {
        let Some(collision) = message.get::<Collision>() else { return };
        // An exchange of blocks was reported as a meeting before.
        if !collision.swap {
            *self.collisions.entry(collision.block).or_default() += 1;
        }
    }

    fn record_fault(&mut self, message: &SharedMessage) {
        let Some(fault) = message.get::<Fault>().filter(|fault| fault.kind == FaultKind::Breakdown) else { return };
        if let Some(path) = self.robots.get(&fault.robot).and_then(|robot| robot.path.as_ref())
            && self.broken.insert((fault.robot, path.now))
        {
            *self.breakdowns.entry(path.now).or_default() += 1;
        }
    }

    fn robot_at(&mut self, number: u32, component: &Arc<str>, block: Block) {
        let robot = self.robots.entry(number).or_insert_with(|| Robot::new(component));
        let Some(path) = &mut robot.path else {
            robot.path = Some(Path::new(block));
            self.visits.entry(block).or_default().count += 1;
            return;
        };
        let from = path.now;
        if from == block {
            return;
        }
        self.legs += path.go(block);
        let visits = self.visits.entry(block).or_default();
        visits.count += 1;
        if from.distance(block) == 1 {
            visits.right += i64::from(block.x - from.x);
            visits.down += i64::from(block.y - from.y);
        }
        if self.is_too_long() {
            for path in self.robots.values_mut().filter_map(|robot| robot.path.as_mut()) {
                path.legs = Vec::new();
            }
        }
    }
}

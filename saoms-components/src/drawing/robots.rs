//! Robots and luggage in a drawing.

use saoms_api::builtin_interfaces::Time;

use super::colours::{ACCENT, DANGER, GOOD, MUTED, PALE, WARN};
use super::messages::{Color, Cube, Cylinder, Entity, KeyValuePair, Point, Pose, Quaternion, Text, Vector3};
use crate::grid::Block;
use crate::messages::RobotList;

/// Diameter and height of a robot, and the side of a piece of luggage, in blocks.
const DIAMETER: f64 = 0.8;
const HEIGHT: f64 = 0.4;
const PIECE: f64 = 0.35;
/// The height of a line of text.
const FONT: f64 = 0.25;

/// A robot, as far as it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Robot {
    /// The name of its frame.
    pub(super) frame: String,
    /// Where it is; `None` until it has said that, and once it is off the floor.
    pub(super) block: Option<Block>,
    pub(super) heading: Heading,
    pub(super) said: Said,
    /// The luggage that it took, and that it carries.
    pub(super) takes: Option<u32>,
    pub(super) carries: Option<u32>,
    pub(super) is_broken: bool,
    /// When it began to work.
    pub(super) began: Option<saoms_api::Time>,
}

/// What a robot says of itself, as far as it is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Said {
    /// In whole percent.
    battery: Option<u8>,
    pub(super) in_charge: bool,
    asleep: bool,
    is_off: bool,
}

/// The direction of the last move of a robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Heading {
    #[default]
    Right,
    Up,
    Left,
    Down,
}

impl From<&RobotList> for Said {
    fn from(said: &RobotList) -> Said {
        let battery = said.battery.round().clamp(0.0, 100.0);
        Said {
            battery: (!battery.is_nan()).then_some(battery as u8),
            in_charge: said.in_charge,
            asleep: said.asleep,
            is_off: !said.active,
        }
    }
}

impl Heading {
    /// The direction of a move; the same one for no move.
    pub(super) fn of(self, from: Block, to: Block) -> Heading {
        match (to.x.cmp(&from.x), to.y.cmp(&from.y)) {
            (std::cmp::Ordering::Greater, _) => Heading::Right,
            (std::cmp::Ordering::Less, _) => Heading::Left,
            // Rows are counted downwards, as pictures show them.
            (_, std::cmp::Ordering::Greater) => Heading::Down,
            (_, std::cmp::Ordering::Less) => Heading::Up,
            _ => self,
        }
    }

    /// The rotation around the vertical axis.
    pub(super) fn rotation(self) -> Quaternion {
        const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;
        let (z, w) = match self {
            Heading::Right => (0.0, 1.0),
            Heading::Up => (HALF, HALF),
            Heading::Left => (1.0, 0.0),
            Heading::Down => (-HALF, HALF),
        };
        Quaternion { z, w, ..Quaternion::default() }
    }
}

/// The centre of a block: a block is a square metre, and y grows upwards.
pub(super) fn centre(block: Block) -> Point {
    Point { x: f64::from(block.x) + 0.5, y: -f64::from(block.y) - 0.5, z: 0.0 }
}

impl Robot {
    pub(super) fn new(frame: String) -> Robot {
        let (heading, said) = (Heading::default(), Said::default());
        Robot { frame, block: None, heading, said, takes: None, carries: None, is_broken: false, began: None }
    }

    fn colour(&self) -> Color {
        match self {
            _ if self.is_broken => DANGER,
            Robot { carries: Some(_), .. } => GOOD,
            Robot { takes: Some(_), .. } => ACCENT,
            _ if self.said.is_off || self.said.asleep => PALE,
            _ if self.said.in_charge => WARN,
            _ => MUTED,
        }
    }

    fn state(&self) -> &'static str {
        match self {
            _ if self.is_broken => "broken",
            Robot { carries: Some(_), .. } => "carries luggage",
            Robot { takes: Some(_), .. } => "goes to luggage",
            _ if self.said.is_off => "off",
            _ if self.said.asleep => "asleep",
            _ if self.said.in_charge => "charges",
            _ => "free",
        }
    }

    /// The robot in its frame.
    pub(super) fn entity(&self, number: u32, at: Time) -> Entity {
        let body = Cylinder {
            pose: Pose::at(0.0, 0.0, HEIGHT / 2.0),
            size: Vector3 { x: DIAMETER, y: DIAMETER, z: HEIGHT },
            bottom_scale: 1.0,
            top_scale: 1.0,
            color: self.colour(),
        };
        // Its front.
        let front = cuboid(Pose::at(DIAMETER / 2.0, 0.0, HEIGHT / 2.0), [0.12, 0.3, 0.2], self.colour());
        let luggage = self.carries.map(|_| cuboid(Pose::at(0.0, 0.0, HEIGHT + PIECE / 2.0), [PIECE; 3], WARN));
        let battery = self.said.battery.map(|battery| battery.to_string());
        let label = match &battery {
            Some(battery) => format!("{number}\n{battery} %"),
            None => number.to_string(),
        };
        let mut metadata = vec![value("robot", number.to_string()), value("state", self.state().to_owned())];
        metadata.extend(battery.map(|battery| value("battery", battery)));
        metadata.extend(self.carries.or(self.takes).map(|piece| value("luggage", piece.to_string())));
        Entity {
            timestamp: at,
            frame_id: self.frame.clone(),
            id: format!("robot{number}"),
            frame_locked: true,
            metadata,
            cylinders: vec![body],
            cubes: std::iter::once(front).chain(luggage).collect(),
            texts: vec![text(Pose::at(0.0, 0.0, HEIGHT + PIECE + 0.3), label, self.colour())],
            ..Entity::default()
        }
    }
}

/// A piece of luggage on the floor.
pub(super) fn piece(number: u32, block: Block, is_taken: bool, (at, frame): (Time, &str)) -> Entity {
    let Point { x, y, .. } = centre(block);
    let colour = if is_taken { ACCENT } else { WARN };
    Entity {
        timestamp: at,
        frame_id: frame.to_owned(),
        id: format!("luggage{number}"),
        metadata: vec![value("luggage", number.to_string())],
        cubes: vec![cuboid(Pose::at(x, y, PIECE / 2.0), [PIECE; 3], colour)],
        texts: vec![text(Pose::at(x, y, PIECE + 0.2), number.to_string(), colour)],
        ..Entity::default()
    }
}

pub(super) fn cuboid(pose: Pose, [x, y, z]: [f64; 3], color: Color) -> Cube {
    Cube { pose, size: Vector3 { x, y, z }, color }
}

pub(super) fn text(pose: Pose, text: String, color: Color) -> Text {
    Text { pose, billboard: true, font_size: FONT, scale_invariant: false, color, text }
}

fn value(key: &str, value: String) -> KeyValuePair {
    KeyValuePair { key: key.to_owned(), value }
}

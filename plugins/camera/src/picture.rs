use saoms_api::{Message, Topic};
use saoms_components::grid::Block;

/// How bright a block is that no robot can enter.
pub(crate) const WALL: u8 = 0;
/// How bright the floor is.
pub(crate) const FLOOR: u8 = 120;
/// How bright a robot is.
pub(crate) const ROBOT: u8 = 255;

/// What the camera of a robot saw: a square of blocks around the robot, seen from above.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(key = "robot")]
pub struct Snapshot {
    /// The robot's number.
    pub robot: u32,
    /// The block in the middle, where the robot was.
    pub block: Block,
    /// How many blocks the picture is wide and high.
    pub size: u32,
    /// How bright each block is, row by row from the lowest x and y on.
    pub pixels: Vec<u8>,
}

/// The newest picture of each robot.
pub const CAMERA: Topic<Snapshot> = Topic::state("CAMERATOPIC");

impl Snapshot {
    /// Takes a picture that reaches so many blocks in each direction.
    pub(crate) fn take(robot: u32, block: Block, reach: u32, brightness: impl Fn(Block) -> u8) -> Snapshot {
        let size = 2 * reach + 1;
        let at = |pixel: u32| {
            let shift = |place: u32| i32::try_from(place).unwrap_or(0) - i32::try_from(reach).unwrap_or(0);
            Block::new(block.x + shift(pixel % size), block.y + shift(pixel / size))
        };
        let pixels = (0..size * size).map(|pixel| brightness(at(pixel))).collect();
        Snapshot { robot, block, size, pixels }
    }

    /// How many other robots are in the picture. One that was made elsewhere may be any.
    pub fn others(&self) -> usize {
        let robots = self.pixels.iter().filter(|pixel| **pixel == ROBOT).count();
        robots.saturating_sub(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_shows_what_is_around() {
        let brightness = |block: Block| match (block.x, block.y) {
            (4, 0) | (5, 1) => ROBOT,
            (_, y) if y < 0 => WALL,
            _ => FLOOR,
        };
        let picture = Snapshot::take(7, Block::new(4, 0), 1, brightness);
        assert_eq!(picture.pixels, [WALL, WALL, WALL, FLOOR, ROBOT, FLOOR, FLOOR, FLOOR, ROBOT]);
        assert_eq!((picture.size, picture.others()), (3, 1));
    }
}

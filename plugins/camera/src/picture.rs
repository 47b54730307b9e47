use saoms_api::{Message, Topic};
use saoms_components::grid::Block;

/// Brightness of a block that no robot can enter.
pub(crate) const WALL: u8 = 0;
/// Brightness of the floor.
pub(crate) const FLOOR: u8 = 120;
/// Brightness of a robot.
pub(crate) const ROBOT: u8 = 255;

/// A picture of a robot's camera: a square of blocks around the robot, seen from above.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(key = "robot")]
pub struct CameraPicture {
    /// Number of the robot.
    pub robot: u32,
    /// Block in the middle, the position of the robot.
    pub block: Block,
    /// Width and height of the picture, in blocks.
    pub size: u32,
    /// Brightness of each block, row by row, starting at the lowest x and y.
    pub pixels: Vec<u8>,
}

/// The newest picture of each robot.
pub const CAMERA: Topic<CameraPicture> = Topic::state("CAMERATOPIC");

impl CameraPicture {
    /// Takes a picture of `reach` blocks in each direction.
    pub(crate) fn take(robot: u32, block: Block, reach: u32, brightness: impl Fn(Block) -> u8) -> CameraPicture {
        let size = 2 * reach + 1;
        let at = |pixel: u32| {
            let shift = |place: u32| i32::try_from(place).unwrap_or(0) - i32::try_from(reach).unwrap_or(0);
            Block::new(block.x + shift(pixel % size), block.y + shift(pixel / size))
        };
        let pixels = (0..size * size).map(|pixel| brightness(at(pixel))).collect();
        CameraPicture { robot, block, size, pixels }
    }

    /// Number of other robots in the picture, which may come from any sender and so have any content.
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
        let picture = CameraPicture::take(7, Block::new(4, 0), 1, brightness);
        assert_eq!(picture.pixels, [WALL, WALL, WALL, FLOOR, ROBOT, FLOOR, FLOOR, FLOOR, ROBOT]);
        assert_eq!((picture.size, picture.others()), (3, 1));
    }
}

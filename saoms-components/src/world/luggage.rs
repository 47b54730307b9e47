use std::collections::HashMap;

use crate::grid::Block;

/// All luggage, and where it really is.
#[derive(Debug, Default)]
pub(super) struct Stock {
    pieces: HashMap<u32, Piece>,
    delivered: usize,
    /// Luggage that a robot asked for before the world heard of it.
    awaited: Vec<(u32, bool)>,
}

#[derive(Debug)]
struct Piece {
    to: Block,
    place: Place,
}

/// Where a piece is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    At(Block),
    On(u32),
    Delivered,
}

/// What became of a robot's attempt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Luggage {
    /// It is on the robot, or on a block that is not its destination.
    Handled,
    /// It is where it was to be brought.
    Delivered,
    /// The world did not hear of it yet.
    Unknown,
}

impl Stock {
    /// Takes in a request. A number that is known already does not count again.
    pub(super) fn add(&mut self, luggage: u32, from: Block, to: Block) {
        self.pieces.entry(luggage).or_insert(Piece { to, place: Place::At(from) });
    }

    /// After all that was said is heard: what is unknown for a whole period stays unknown.
    pub(super) fn settle(&mut self) {
        for (_, settled) in &mut self.awaited {
            *settled = true;
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    pub(super) fn is_delivered(&self) -> bool {
        self.delivered == self.pieces.len()
    }

    /// A robot collects a piece from a block. It may also be on another robot, if that lies on the block like luggage.
    pub(super) fn collect(
        &mut self,
        luggage: u32,
        robot: u32,
        block: Block,
        lies_here: impl Fn(u32) -> bool,
    ) -> Result<Luggage, String> {
        let Some(piece) = self.pieces.get_mut(&luggage) else { return self.unknown(luggage) };
        self.awaited.retain(|(awaited, _)| *awaited != luggage);
        match piece.place {
            Place::At(place) if place == block => {
                piece.place = Place::On(robot);
                Ok(Luggage::Handled)
            }
            Place::On(other) if lies_here(other) => {
                piece.place = Place::On(robot);
                Ok(Luggage::Handled)
            }
            Place::At(place) => Err(format!("luggage {luggage} is not here but at {place}")),
            Place::On(other) => Err(format!("luggage {luggage} is on robot {other}")),
            Place::Delivered => Err(format!("luggage {luggage} is delivered already")),
        }
    }

    pub(super) fn deposit(&mut self, luggage: u32, robot: u32, block: Block) -> Result<Luggage, String> {
        let piece = self.pieces.get_mut(&luggage).filter(|piece| piece.place == Place::On(robot));
        let Some(piece) = piece else { return Err(format!("it does not carry luggage {luggage}")) };
        if block != piece.to {
            piece.place = Place::At(block);
            return Ok(Luggage::Handled);
        }
        piece.place = Place::Delivered;
        self.delivered += 1;
        Ok(Luggage::Delivered)
    }

    fn unknown(&mut self, luggage: u32) -> Result<Luggage, String> {
        match self.awaited.iter().position(|(awaited, _)| *awaited == luggage) {
            None => {
                self.awaited.push((luggage, false));
                Ok(Luggage::Unknown)
            }
            Some(place) if self.awaited[place].1 => {
                self.awaited.remove(place);
                Err(format!("there is no luggage {luggage}"))
            }
            Some(_) => Ok(Luggage::Unknown),
        }
    }
}

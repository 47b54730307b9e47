use std::collections::HashMap;
use std::collections::hash_map::Entry;

use crate::grid::Block;

/// All luggage, and where it really is.
#[derive(Debug, Default)]
pub(super) struct Stock {
    pieces: HashMap<u32, Piece>,
    /// How many are neither delivered nor given up.
    open: usize,
    /// Luggage that a robot asked for before the world heard of it.
    awaited: Vec<(u32, bool)>,
}

#[derive(Debug)]
struct Piece {
    to: Block,
    place: Place,
    /// Whether nobody can bring it, as somebody said.
    given_up: bool,
}

impl Piece {
    fn is_open(&self) -> bool {
        !self.given_up && self.place != Place::Delivered
    }
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
    /// Takes in a request; `false` for a number that is known already.
    pub(super) fn add(&mut self, luggage: u32, from: Block, to: Block) -> bool {
        let Entry::Vacant(free) = self.pieces.entry(luggage) else { return false };
        free.insert(Piece { to, place: Place::At(from), given_up: false });
        self.open += 1;
        true
    }

    /// Nobody can bring it.
    pub(super) fn give_up(&mut self, luggage: u32) {
        if let Some(piece) = self.pieces.get_mut(&luggage)
            && piece.is_open()
        {
            piece.given_up = true;
            self.open -= 1;
        }
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

    /// Whether nothing is left to bring.
    pub(super) fn is_settled(&self) -> bool {
        self.open == 0
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
        if piece.is_open() {
            self.open -= 1;
        }
        piece.place = Place::Delivered;
        Ok(Luggage::Delivered)
    }

    /// What a robot has on board lies on a block from now on.
    pub(super) fn unload(&mut self, robot: u32, block: Block) {
        for piece in self.pieces.values_mut().filter(|piece| piece.place == Place::On(robot)) {
            piece.place = Place::At(block);
        }
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

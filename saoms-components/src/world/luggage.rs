use std::collections::HashMap;
use std::collections::hash_map::Entry;

use saoms_api::Field;

use super::memory::StockMemory;
use crate::grid::Block;
use crate::state::Numbers;

/// Pieces of luggage and their real positions.
#[derive(Debug, Default)]
pub(super) struct Stock {
    /// Those that are not delivered.
    pieces: HashMap<u32, Piece>,
    /// Those that are.
    delivered: Numbers,
    /// Number of pieces that are neither delivered nor given up.
    open: usize,
    /// Pieces that a robot asked for before their request arrived.
    awaited: Vec<(u32, bool)>,
}

#[derive(Debug)]
struct Piece {
    to: Block,
    place: PiecePosition,
    /// True if a message gave the piece up.
    given_up: bool,
}

impl Piece {
    fn is_open(&self) -> bool {
        !self.given_up
    }
}

/// Position of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PiecePosition {
    At(Block),
    On(u32),
}

/// A piece that is not delivered, for a world that goes on.
#[derive(Clone, Copy, Debug, Field)]
pub(super) struct PieceMemory {
    luggage: u32,
    to: Block,
    /// Where it lies, unless it is on a robot.
    at: Block,
    on: Option<u32>,
    given_up: bool,
}

/// Outcome of a robot's attempt to collect or deposit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum HandlingOutcome {
    /// The piece is on the robot, or on a block that is not its destination.
    Handled,
    /// The piece is at its destination; it may have been given up before.
    Delivered { given_up: bool },
    /// No request for the piece has arrived yet.
    Unknown,
}

impl Stock {
    /// The stock of a world that goes on.
    pub(super) fn of(memory: StockMemory) -> Stock {
        let piece = |piece: PieceMemory| {
            let place = piece.on.map_or(PiecePosition::At(piece.at), PiecePosition::On);
            (piece.luggage, Piece { to: piece.to, place, given_up: piece.given_up })
        };
        let open = memory.pieces.iter().filter(|piece| !piece.given_up).count();
        let pieces = memory.pieces.into_iter().map(piece).collect();
        let settled = memory.settled.iter().map(|luggage| (*luggage, true));
        let awaited = memory.awaited.iter().map(|luggage| (*luggage, false)).chain(settled).collect();
        Stock { pieces, delivered: memory.delivered, open, awaited }
    }

    /// The stock for a world that goes on.
    pub(super) fn memory(&self) -> StockMemory {
        let piece = |(luggage, piece): (&u32, &Piece)| {
            let (at, on) = match piece.place {
                PiecePosition::At(block) => (block, None),
                PiecePosition::On(robot) => (Block::default(), Some(robot)),
            };
            PieceMemory { luggage: *luggage, to: piece.to, at, on, given_up: piece.given_up }
        };
        let mut pieces: Vec<PieceMemory> = self.pieces.iter().map(piece).collect();
        pieces.sort_unstable_by_key(|piece| piece.luggage);
        let awaited =
            |settled: bool| self.awaited.iter().filter(move |one| one.1 == settled).map(|one| one.0).collect();
        StockMemory { pieces, delivered: self.delivered.clone(), awaited: awaited(false), settled: awaited(true) }
    }

    /// Adds a request; `false` if its number is known already.
    pub(super) fn add(&mut self, luggage: u32, from: Block, to: Block) -> bool {
        let Entry::Vacant(free) = self.pieces.entry(luggage) else { return false };
        if self.delivered.contains(luggage) {
            return false;
        }
        free.insert(Piece { to, place: PiecePosition::At(from), given_up: false });
        self.open += 1;
        true
    }

    /// Gives up a piece; `false` if it is not open.
    pub(super) fn give_up(&mut self, luggage: u32) -> bool {
        let Some(piece) = self.pieces.get_mut(&luggage).filter(|piece| piece.is_open()) else { return false };
        piece.given_up = true;
        self.open -= 1;
        true
    }

    /// The robot that carries a piece.
    pub(super) fn bearer(&self, luggage: u32) -> Option<u32> {
        match self.pieces.get(&luggage)?.place {
            PiecePosition::On(robot) => Some(robot),
            PiecePosition::At(_) => None,
        }
    }

    /// True if a piece lies on the block.
    pub(super) fn lies_at(&self, luggage: u32, block: Block) -> bool {
        self.pieces.get(&luggage).is_some_and(|piece| piece.place == PiecePosition::At(block))
    }

    /// Called after all messages of a period are handled: pieces that stay unknown for a whole period do not exist.
    pub(super) fn settle(&mut self) {
        for (_, settled) in &mut self.awaited {
            *settled = true;
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pieces.is_empty() && self.delivered.is_empty()
    }

    /// True if no piece is left to bring.
    pub(super) fn is_settled(&self) -> bool {
        self.open == 0
    }

    /// The numbers of pieces that are delivered, open (those that were given up included), and given up.
    pub(super) fn counts(&self) -> (usize, usize, usize) {
        let open = self.pieces.len();
        (self.delivered.len(), open, open.saturating_sub(self.open))
    }

    /// The open piece with the lowest number, and how many others are open.
    pub(super) fn first_open(&self) -> Option<(u32, usize)> {
        let open = self.pieces.iter().filter(|(_, piece)| piece.is_open());
        open.map(|(luggage, _)| *luggage).min().map(|first| (first, self.open.saturating_sub(1)))
    }

    /// A robot collects a piece from a block. The piece may also be on another robot that is out of service on the
    /// block.
    pub(super) fn collect(
        &mut self,
        luggage: u32,
        robot: u32,
        block: Block,
        lies_here: impl Fn(u32) -> bool,
    ) -> Result<HandlingOutcome, String> {
        if self.delivered.contains(luggage) {
            return Err(format!("luggage {luggage} is delivered already"));
        }
        let Some(piece) = self.pieces.get_mut(&luggage) else { return self.unknown(luggage) };
        self.awaited.retain(|(awaited, _)| *awaited != luggage);
        match piece.place {
            PiecePosition::At(place) if place == block => {
                piece.place = PiecePosition::On(robot);
                Ok(HandlingOutcome::Handled)
            }
            PiecePosition::On(other) if lies_here(other) => {
                piece.place = PiecePosition::On(robot);
                Ok(HandlingOutcome::Handled)
            }
            PiecePosition::At(place) => Err(format!("luggage {luggage} is not here: it is at {place}")),
            PiecePosition::On(other) => Err(format!("luggage {luggage} is on robot {other}")),
        }
    }

    pub(super) fn deposit(&mut self, luggage: u32, robot: u32, block: Block) -> Result<HandlingOutcome, String> {
        let piece = self.pieces.get_mut(&luggage).filter(|piece| piece.place == PiecePosition::On(robot));
        let Some(piece) = piece else { return Err(format!("it does not carry luggage {luggage}")) };
        if block != piece.to {
            piece.place = PiecePosition::At(block);
            return Ok(HandlingOutcome::Handled);
        }
        if piece.is_open() {
            self.open -= 1;
        }
        let given_up = piece.given_up;
        self.pieces.remove(&luggage);
        self.delivered.insert(luggage);
        Ok(HandlingOutcome::Delivered { given_up })
    }

    /// The pieces that a robot carries to this block, by number.
    pub(super) fn carried_to(&self, robot: u32, block: Block) -> Vec<u32> {
        let arrived = |piece: &Piece| piece.place == PiecePosition::On(robot) && piece.to == block;
        let pieces = self.pieces.iter().filter(|(_, piece)| arrived(piece));
        let mut pieces: Vec<u32> = pieces.map(|(luggage, _)| *luggage).collect();
        pieces.sort_unstable();
        pieces
    }

    /// Puts all pieces that a robot carries on a block. Returns their numbers.
    pub(super) fn unload(&mut self, robot: u32, block: Block) -> Vec<u32> {
        let carried = self.pieces.iter_mut().filter(|(_, piece)| piece.place == PiecePosition::On(robot));
        let mut unloaded: Vec<u32> = carried
            .map(|(luggage, piece)| {
                piece.place = PiecePosition::At(block);
                *luggage
            })
            .collect();
        unloaded.sort_unstable();
        unloaded
    }

    fn unknown(&mut self, luggage: u32) -> Result<HandlingOutcome, String> {
        match self.awaited.iter().position(|(awaited, _)| *awaited == luggage) {
            None => {
                self.awaited.push((luggage, false));
                Ok(HandlingOutcome::Unknown)
            }
            Some(place) if self.awaited[place].1 => {
                self.awaited.remove(place);
                Err(format!("there is no luggage {luggage}"))
            }
            Some(_) => Ok(HandlingOutcome::Unknown),
        }
    }
}

use saoms_api::Field;

use crate::grid::Block;

/// What a robot's hardware can do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum ActionKind {
    /// Move the wheels to a block beside the present one.
    #[default]
    Move,
    /// Collect luggage at the present block.
    Collect,
    /// Deposit it there.
    Deposit,
}

/// One action of a robot's hardware.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub struct Action {
    /// What to do.
    pub kind: ActionKind,
    /// Where to go, or where the luggage is collected or deposited.
    pub block: Block,
    /// The luggage's number; 0 for a move.
    pub luggage: u32,
}

impl Action {
    /// A move to a block.
    pub const fn move_to(block: Block) -> Action {
        Action { kind: ActionKind::Move, block, luggage: 0 }
    }

    /// Collecting luggage.
    pub const fn collect(luggage: u32, block: Block) -> Action {
        Action { kind: ActionKind::Collect, block, luggage }
    }

    /// Depositing luggage.
    pub const fn deposit(luggage: u32, block: Block) -> Action {
        Action { kind: ActionKind::Deposit, block, luggage }
    }
}

/// How an action goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
pub enum Progress {
    /// It takes its time; ask again in the next period.
    Running,
    /// It is done.
    Done,
    /// It is over and failed; the hardware said why in its own words.
    Failed,
}

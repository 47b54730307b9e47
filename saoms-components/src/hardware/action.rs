use std::fmt;

use saoms_api::Field;

use crate::grid::Block;

/// Kinds of actions of a robot's hardware.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum ActionKind {
    /// Move to an adjacent block.
    #[default]
    Move,
    /// Collect luggage.
    Collect,
    /// Deposit luggage.
    Deposit,
}

/// An action of a robot's hardware.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub struct Action {
    /// Kind of the action.
    pub kind: ActionKind,
    /// Block to move to, or where luggage is collected or deposited.
    pub block: Block,
    /// Number of the luggage; 0 for a move.
    pub luggage: u32,
}

impl Action {
    /// A move to a block.
    pub const fn move_to(block: Block) -> Action {
        Action { kind: ActionKind::Move, block, luggage: 0 }
    }

    /// Collection of luggage.
    pub const fn collect(luggage: u32, block: Block) -> Action {
        Action { kind: ActionKind::Collect, block, luggage }
    }

    /// Deposit of luggage.
    pub const fn deposit(luggage: u32, block: Block) -> Action {
        Action { kind: ActionKind::Deposit, block, luggage }
    }
}

impl fmt::Display for Action {
    /// What the robot does: `move to (3,1)`.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Action { kind, block, luggage } = self;
        match kind {
            ActionKind::Move => write!(formatter, "move to {block}"),
            ActionKind::Collect => write!(formatter, "collect luggage {luggage} at {block}"),
            ActionKind::Deposit => write!(formatter, "deposit luggage {luggage} at {block}"),
        }
    }
}

/// Progress of an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
pub enum Progress {
    /// The action is running; ask again in the next period.
    Running,
    /// The action is done.
    Done,
    /// The action failed; the hardware has logged the reason.
    Failed,
}

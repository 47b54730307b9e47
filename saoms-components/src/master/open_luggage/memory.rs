//! Open luggage, for a master that goes on after a failure.

use std::time::Duration;

use saoms_api::{Field, Time};

use super::outages::Failed;
use super::{Active, OpenLuggage, Piece};
use crate::gone::Gone;
use crate::grid::Block;
use crate::messages::{CriticalSituation, Removal, is_visit};

/// Open luggage, for a master that goes on.
#[derive(Clone, Debug, Field)]
pub(in crate::master) struct OpenMemory {
    pieces: Vec<PieceMemory>,
    helps: Vec<CriticalSituation>,
    active: Vec<ActiveMemory>,
    breaking: Vec<BreakingMemory>,
    broken: Vec<u32>,
    gone: Gone,
    failed: Vec<Failed>,
    left: Vec<Removal>,
    left_visits: Vec<u32>,
    seen: bool,
    changed: bool,
}

#[derive(Clone, Debug, Field)]
struct PieceMemory {
    luggage: u32,
    from: Block,
    to: Block,
    refused: Vec<u32>,
    waits: bool,
    taken: Option<u32>,
    asked: Option<u32>,
    left_by: Option<u32>,
    stops: Vec<Block>,
    only: Option<u32>,
    since: Time,
    contenders: Vec<u32>,
    unheard: bool,
}

#[derive(Clone, Copy, Debug, Field)]
struct ActiveMemory {
    robot: u32,
    period_us: u64,
    said: Time,
}

#[derive(Clone, Copy, Debug, Field)]
struct BreakingMemory {
    robot: u32,
    until: Time,
}

impl OpenLuggage {
    /// The state for a master that goes on.
    pub(in crate::master) fn memory(&self) -> OpenMemory {
        let piece = |(luggage, piece): (&u32, &Piece)| {
            let Piece { from, to, refused, waits, taken, left_by, stops, only, since, unheard, asked, .. } = piece;
            let (refused, stops) = (refused.iter().copied().collect(), stops.clone());
            PieceMemory {
                luggage: *luggage,
                from: *from,
                to: *to,
                refused,
                waits: *waits,
                taken: *taken,
                // Who is asked to bring luggage is asked again, or the world refuses the second one.
                asked: asked.filter(|_| is_visit(*luggage)),
                left_by: *left_by,
                stops,
                only: *only,
                since: *since,
                contenders: piece.contenders.iter().copied().collect(),
                unheard: *unheard,
            }
        };
        // Periods came as whole microseconds.
        let active = |(robot, active): (&u32, &Active)| ActiveMemory {
            robot: *robot,
            period_us: u64::try_from(active.period.as_micros()).unwrap_or(u64::MAX),
            said: active.said,
        };
        let breaking = self.breaking.iter().map(|(&robot, &until)| BreakingMemory { robot, until });
        OpenMemory {
            pieces: self.pieces.iter().map(piece).collect(),
            helps: self.helps.values().cloned().collect(),
            active: self.active.iter().map(active).collect(),
            breaking: breaking.collect(),
            broken: self.broken.iter().copied().collect(),
            gone: self.gone.clone(),
            failed: self.failed.values().cloned().collect(),
            left: self.left.values().cloned().collect(),
            left_visits: self.left_visits.clone(),
            seen: self.seen,
            changed: self.changed,
        }
    }

    /// The state of a master that goes on.
    pub(in crate::master) fn of(memory: OpenMemory) -> OpenLuggage {
        let piece = |piece: PieceMemory| {
            let PieceMemory { luggage, from, to, waits, taken, left_by, stops, only, since, unheard, asked, .. } =
                piece;
            let refused = piece.refused.into_iter().collect();
            let contenders = piece.contenders.into_iter().collect();
            let discussed = since;
            let piece = Piece {
                from,
                to,
                refused,
                waits,
                taken,
                left_by,
                stops,
                only,
                since,
                asked,
                discussed,
                contenders,
                unheard,
                // Robots say it again; what one may have collected does not pass on.
                lease: None,
            };
            (luggage, piece)
        };
        let waiting = memory
            .pieces
            .iter()
            .filter(|piece| piece.waits && piece.asked.is_none())
            .map(|piece| (piece.since, piece.luggage));
        let waiting = waiting.collect();
        let active = memory.active.iter().map(|active| {
            let &ActiveMemory { robot, period_us, said } = active;
            (robot, Active { period: Duration::from_micros(period_us), said })
        });
        OpenLuggage {
            pieces: memory.pieces.into_iter().map(piece).collect(),
            helps: memory.helps.into_iter().map(|help| (help.luggage, help)).collect(),
            active: active.collect(),
            breaking: memory.breaking.iter().map(|breaking| (breaking.robot, breaking.until)).collect(),
            broken: memory.broken.into_iter().collect(),
            gone: memory.gone,
            failed: memory.failed.into_iter().map(|failed| (failed.fault.robot, failed)).collect(),
            left: memory.left.into_iter().map(|left| (left.robot, left)).collect(),
            left_visits: memory.left_visits,
            seen: memory.seen,
            changed: memory.changed,
            waiting,
        }
    }
}

//! Luggage that robots of other programs have on a lease.
//!
//! Such a robot collects luggage only once the master has answered that it may. The master answers so to the one that
//! has taken it, and gives it to no other one from then on until that one or a person says what became of it. Before,
//! it gives it to another robot when it has not heard for the time of the lease of the one that has taken it.

use std::time::Duration;

use saoms_api::Time;

use super::OpenLuggage;
use crate::messages::{EventLuggage, Lease};

/// The lease of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PieceLease {
    robot: u32,
    /// The number that the robot gave it.
    number: u64,
    /// When it is over, unless the robot is heard before.
    until: Time,
    /// True if the robot may collect the piece, and may have done so.
    granted: bool,
    /// True if it is over.
    lapsed: bool,
}

/// Luggage that passes on: its robot was not heard for the time of the lease.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::master) struct Lapsed {
    /// The robot that was to bring it.
    pub(in crate::master) robot: u32,
    /// The number of the lease.
    pub(in crate::master) number: u64,
    /// The request for other robots.
    pub(in crate::master) request: EventLuggage,
}

impl OpenLuggage {
    /// Handles what a robot has on a lease of this duration. Gives the answer, if it gets one: whether it may collect
    /// the piece.
    pub(in crate::master) fn hear_lease(&mut self, lease: &Lease, duration: Duration, now: Time) -> Option<bool> {
        let Lease { robot, luggage, number, collects } = *lease;
        let Some(piece) = self.pieces.get_mut(&luggage) else { return Some(false) };
        if piece.taken != Some(robot) {
            let is_over =
                piece.lease.is_some_and(|known| known.lapsed && (known.robot, known.number) == (robot, number));
            let is_of_other = piece.taken.or(piece.asked).is_some_and(|bearer| bearer != robot);
            if is_over || is_of_other {
                return Some(false);
            }
            // That it took the piece is on its way, and it asks again.
            let until = now + duration;
            piece.lease = Some(PieceLease { robot, number, until, granted: false, lapsed: false });
            return None;
        }
        let until = now + duration;
        match piece.lease.as_mut().filter(|known| (known.robot, known.number) == (robot, number)) {
            Some(known) => (known.until, known.granted) = (until, known.granted || collects),
            None => piece.lease = Some(PieceLease { robot, number, until, granted: collects, lapsed: false }),
        }
        collects.then_some(true)
    }

    /// The luggage whose lease is over; it waits for other robots. A master that was held up for so long has not heard
    /// what robots said meanwhile.
    pub(in crate::master) fn take_lapsed(&mut self, now: Time, held_up: Duration) -> Vec<Lapsed> {
        let mut lapsed = Vec::new();
        for (luggage, piece) in &mut self.pieces {
            let Some(lease) = piece.lease.as_mut().filter(|lease| piece.taken == Some(lease.robot)) else { continue };
            lease.until = lease.until + held_up;
            if lease.granted || lease.until > now {
                continue;
            }
            lease.lapsed = true;
            let PieceLease { robot, number, .. } = *lease;
            (piece.taken, piece.waits) = (None, true);
            self.waiting.insert((piece.since, *luggage));
            lapsed.push(Lapsed { robot, number, request: piece.request(*luggage) });
        }
        lapsed
    }

    /// True if a robot has luggage on a lease and may not collect it yet: it leaves it to another one without harm.
    pub(in crate::master) fn may_leave(&self, luggage: u32, robot: u32) -> bool {
        let lease = self.pieces.get(&luggage).and_then(|piece| piece.lease);
        lease.is_some_and(|lease| lease.robot == robot && !lease.granted)
    }
}

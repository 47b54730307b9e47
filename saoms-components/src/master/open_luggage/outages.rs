//! Robots that are out without having said so: somebody took them off the floor, or their component failed. What they
//! were to bring is opened again.

use std::collections::BTreeMap;

use saoms_api::{Field, Header, Time};

use super::OpenLuggage;
use crate::messages::{EventLuggage, Fault, Removal};

/// A robot whose component failed.
#[derive(Clone, Debug, Field)]
pub(super) struct Failed {
    /// What robots are told.
    pub(super) fault: Fault,
    /// True once they were told.
    pub(super) is_told: bool,
}

impl OpenLuggage {
    /// A robot is off the floor, or its component failed. What it was to bring is opened again once it is known where
    /// that is.
    pub(in crate::master) fn take_away(&mut self, fault: &Fault, header: Header) {
        let robot = fault.robot;
        self.gone.note(fault, header);
        self.breaking.remove(&robot);
        self.broken.remove(&robot);
        self.active.remove(&robot);
        self.changed = true;
        self.failed.remove(&robot);
        if fault.is_failure() {
            self.failed.insert(robot, Failed { fault: fault.clone(), is_told: false });
            // What the world said of an earlier failure.
            self.left.retain(|one, left| *one != robot || Some(left.since) >= fault.since);
        }
        for (luggage, piece) in &mut self.pieces {
            piece.concede(robot);
            if piece.taken == Some(robot) {
                (piece.taken, piece.left_by) = (None, Some(robot));
            } else if piece.asked == Some(robot) {
                piece.asked = None;
                self.waiting.insert((piece.since, *luggage));
            }
        }
    }

    /// The fault of a robot that the world knows, if this master has not heard of it: it began after that.
    pub(in crate::master) fn missed(&self, removal: &Removal) -> Option<Fault> {
        let fault = removal.fault().filter(|fault| fault.block.is_some())?;
        let is_back = self.active.get(&removal.robot).is_some_and(|active| active.said > removal.since);
        let is_known = self.gone.since(removal.robot).is_some_and(|since| since >= removal.since);
        (!is_back && !is_known).then_some(Fault { block: None, ..fault })
    }

    /// The world says what a robot left, and where.
    pub(in crate::master) fn hear_removal(&mut self, removal: &Removal) {
        let Removal { robot, since, block, luggage, delivered, .. } = removal;
        // The answer to a question that was asked again meanwhile, or about an earlier failure: the robot is elsewhere.
        let is_earlier = self.failed.get(robot).is_some_and(|failed| Some(*since) < failed.fault.since);
        if self.left.get(robot) == Some(removal) || is_earlier {
            return;
        }
        for luggage in luggage {
            let piece = self.pieces.get_mut(luggage);
            if let Some(piece) = piece.filter(|piece| piece.taken == Some(*robot) || piece.left_by == Some(*robot)) {
                block.iter().for_each(|block| piece.lies_at(*block));
                self.changed = true;
            }
        }
        self.left.insert(*robot, removal.clone());
        delivered.iter().for_each(|luggage| self.remove(*luggage));
    }

    /// The failures of robots that the others are not told of yet, with their blocks where a world knows them.
    pub(in crate::master) fn untold(&mut self, has_world: bool) -> Vec<Fault> {
        let OpenLuggage { failed, left, .. } = self;
        let untold = failed.iter_mut().filter(|(robot, one)| !one.is_told && (!has_world || left.contains_key(robot)));
        let told = untold.map(|(robot, one)| {
            one.is_told = true;
            // A world without the robot says nothing of its block.
            one.fault.block = left.get(robot).and_then(|removal| removal.block);
            one.fault.clone()
        });
        told.collect()
    }

    /// Robots of which no world has said what they left, which is needed to go on, with what happened to them.
    pub(in crate::master) fn unanswered(&self) -> BTreeMap<u32, Fault> {
        let untold = self.failed.iter().filter(|(_, one)| !one.is_told).map(|(robot, one)| (*robot, one.fault.clone()));
        let left = self.pieces.values().filter_map(|piece| piece.left_by).map(|robot| {
            let gone = || Fault { since: Some(self.gone.since(robot).unwrap_or(Time::START)), ..Fault::gone(robot) };
            (robot, self.failed.get(&robot).map_or_else(gone, |one| one.fault.clone()))
        });
        untold.chain(left).filter(|(robot, _)| !self.left.contains_key(robot)).collect()
    }

    /// True if the component of a robot failed, and not all was done about that.
    pub(in crate::master) fn knows_failure(&self, robot: u32) -> bool {
        self.failed.contains_key(&robot)
    }

    /// Forgets the failures of robots that are back, once all was done about them.
    pub(in crate::master) fn forget_failures(&mut self) {
        let OpenLuggage { failed, left, active, .. } = self;
        let is_over = |robot: &u32, failed: &mut Failed| failed.is_told && active.contains_key(robot);
        failed.extract_if(.., is_over).for_each(|(robot, _)| _ = left.remove(&robot));
    }

    /// The failures of robots, but of this one.
    pub(in crate::master) fn failures(&self, without: u32) -> impl Iterator<Item = &Fault> {
        self.failed.values().map(|failed| &failed.fault).filter(move |fault| fault.robot != without)
    }

    /// Robots that are off the floor.
    pub(in crate::master) fn gone(&self) -> impl Iterator<Item = u32> {
        self.gone.robots()
    }

    /// What is said of a robot that is off the floor to those that start later.
    pub(in crate::master) fn gone_since(&self, robot: u32) -> Fault {
        Fault { since: self.gone.since(robot), ..Fault::gone(robot) }
    }

    /// True if a robot is off the floor.
    pub(in crate::master) fn is_off_floor(&self, robot: u32) -> bool {
        self.gone.contains(robot)
    }

    /// True if a robot is off the floor, or its component failed.
    pub(in crate::master) fn is_out(&self, robot: u32) -> bool {
        self.gone.is_out(robot)
    }

    /// Opens the luggage of robots that are out again: what they carried is where the world says, and all else, or
    /// without a world all, where it was to be collected. Returns the robots with their requests.
    pub(in crate::master) fn open_again(&mut self, has_world: bool) -> Vec<(u32, EventLuggage)> {
        let mut again = Vec::new();
        for (luggage, piece) in &mut self.pieces {
            let Some(robot) = piece.left_by.filter(|robot| !has_world || self.left.contains_key(robot)) else {
                continue;
            };
            if let Some(left) = self.left.get(&robot).filter(|left| left.luggage.contains(luggage)) {
                left.block.iter().for_each(|block| piece.lies_at(*block));
            }
            (piece.waits, piece.left_by) = (true, None);
            self.waiting.insert((piece.since, *luggage));
            again.push((robot, piece.request(*luggage)));
        }
        again
    }
}

//! Luggage: invariants 4, 7 and 8.

use std::collections::BTreeMap;

use saoms_api::Time;
use saoms_api::host::SharedMessage;

use super::tide::Tide;
use super::{FINISHED, Finder, ONCE, TAKEN_OVER, bound};
use crate::messages::{
    Assignment, CriticalKind, CriticalSituation, CriticalStage, EventLuggage, LuggageStage, Removal, is_visit, job_name,
};

/// The pieces of luggage of a site, and the visits, which robots do once, too.
#[derive(Debug, Default)]
pub(super) struct Pieces {
    all: BTreeMap<u32, Piece>,
    /// Pieces on robots that are broken, with the robot, until somebody takes them over.
    stranded: BTreeMap<u32, (u32, Time)>,
    /// Since when robots are out of which the world said what they left.
    removed: BTreeMap<u32, Time>,
}

#[derive(Debug)]
struct Piece {
    requested: Time,
    delivered: Option<Time>,
    is_given_up: bool,
}

impl Pieces {
    /// The pieces of luggage, without visits.
    fn luggage(&self) -> impl Iterator<Item = &Piece> {
        self.all.iter().filter(|(luggage, _)| !is_visit(**luggage)).map(|(_, piece)| piece)
    }

    pub(super) fn requested(&self) -> usize {
        self.luggage().count()
    }

    pub(super) fn delivered(&self) -> usize {
        self.luggage().filter(|piece| piece.delivered.is_some()).count()
    }

    /// How long each delivered piece waited, in seconds.
    pub(super) fn waits(&self) -> impl Iterator<Item = f64> {
        self.luggage().filter_map(|piece| Some(piece.delivered?.since(piece.requested).as_secs_f64()))
    }

    pub(super) fn hear(&mut self, message: &SharedMessage, goes_on: bool, finder: &mut Finder<'_>) {
        let Some(EventLuggage { robot, luggage, stage, .. }) = message.get::<EventLuggage>().cloned() else { return };
        match stage {
            LuggageStage::Request => self.request(luggage, finder.at),
            LuggageStage::Taken => _ = self.stranded.remove(&luggage),
            LuggageStage::Delivered => {
                self.stranded.remove(&luggage);
                let (what, does, done) = match is_visit(luggage) {
                    true => (job_name(luggage), "does", "done"),
                    false => (job_name(luggage), "delivers", "delivered"),
                };
                if goes_on {
                    // It was asked for before.
                    self.request(luggage, finder.at);
                }
                match self.all.get_mut(&luggage) {
                    None => finder.note(ONCE, format!("robot {robot} {does} {what}, which nobody asked for")),
                    Some(Piece { delivered: Some(before), .. }) => {
                        finder.note(ONCE, format!("robot {robot} {does} {what}, which was {done} at {before}"));
                    }
                    Some(piece) => piece.delivered = Some(finder.at),
                }
            }
            LuggageStage::GivenUp => {
                self.stranded.remove(&luggage);
                if let Some(piece) = self.all.get_mut(&luggage) {
                    piece.is_given_up = true;
                }
            }
            LuggageStage::Interest | LuggageStage::Release | LuggageStage::Refused => {}
        }
    }

    fn request(&mut self, luggage: u32, at: Time) {
        self.all.entry(luggage).or_insert(Piece { requested: at, delivered: None, is_given_up: false });
    }

    /// A master that assigns luggage requests it from one robot.
    pub(super) fn hear_assignment(&mut self, message: &SharedMessage, at: Time) {
        if let Some(assignment) = message.get::<Assignment>().filter(|assignment| assignment.lease == 0) {
            self.request(assignment.luggage, at);
        }
    }

    pub(super) fn hear_critical(&mut self, message: &SharedMessage, at: Time) {
        let Some(said) = message.get::<CriticalSituation>() else { return };
        match said.stage {
            CriticalStage::Request if said.kind == CriticalKind::CarriesLuggage && said.luggage > 0 => {
                self.stranded.entry(said.luggage).or_insert((said.critical, at));
            }
            CriticalStage::Taken => _ = self.stranded.remove(&said.luggage),
            _ => {}
        }
    }

    /// The world says what a robot left that is gone or has failed.
    pub(super) fn hear_removal(&mut self, message: &SharedMessage, at: Time) {
        let Some(Removal { robot, since, block, luggage, delivered, .. }) = message.get::<Removal>() else { return };
        // The world may say it again.
        let last = self.removed.entry(*robot).or_default();
        let is_new = block.is_some() && since > last;
        *last = if is_new { *since } else { *last };
        for luggage in luggage.iter().filter(|_| is_new) {
            self.stranded.entry(*luggage).or_insert((*robot, at));
        }
        for luggage in delivered {
            if let Some(piece) = self.all.get_mut(luggage) {
                piece.delivered.get_or_insert(at);
            }
        }
    }

    /// Looks for pieces that nobody takes over.
    pub(super) fn look(&mut self, tide: &Tide, period: u64, finder: &mut Finder<'_>) {
        let at = finder.at;
        let is_late = |since: Time| tide.calm(since, at).is_some_and(|time| tide.is_too_long(time, bound(period)));
        let late: Vec<(u32, u32)> = self
            .stranded
            .iter()
            .filter(|(_, (_, since))| is_late(*since))
            .map(|(luggage, (robot, _))| (*luggage, *robot))
            .collect();
        for (luggage, robot) in late {
            self.stranded.remove(&luggage);
            finder.note(TAKEN_OVER, format!("nobody takes over luggage {luggage} of robot {robot}, which is broken"));
        }
    }

    /// Judges what is not finished at the end: of a run that was cut off, what was asked for long before.
    pub(super) fn end(&mut self, is_cut_off: bool, tide: &Tide, period: u64, finder: &mut Finder<'_>) {
        if tide.spoils_requests() {
            return;
        }
        let at = finder.at;
        let is_open = |piece: &Piece| {
            let time = tide.calm(piece.requested, at);
            piece.delivered.is_none()
                && !piece.is_given_up
                && (!is_cut_off || time.is_some_and(|time| time > bound(period).saturating_mul(10)))
        };
        let open: Vec<u32> = self.all.iter().filter(|(_, piece)| is_open(piece)).map(|(luggage, _)| *luggage).collect();
        for luggage in open {
            let (what, done) = (job_name(luggage), if is_visit(luggage) { "done" } else { "delivered" });
            finder.note(FINISHED, format!("{what} is not {done}, and nobody gave it up"));
        }
    }
}

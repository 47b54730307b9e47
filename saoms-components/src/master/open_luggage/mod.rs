mod leases;
mod memory;
mod outages;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use saoms_api::{Field, Header, ReportValue, Time};

use crate::gone::Gone;
use crate::grid::Block;
use crate::messages::{
    CriticalSituation, CriticalStage, EventLuggage, FIRST_VISIT, FaultKind, LuggageStage, Removal, RobotList, Visit,
};
use crate::robot::Job;

pub(super) use leases::Lapsed;
use leases::PieceLease;
pub(super) use memory::OpenMemory;
use outages::Failed;

/// Open luggage, and the robots that could bring it.
#[derive(Debug, Default)]
pub struct OpenLuggage {
    pieces: BTreeMap<u32, Piece>,
    /// Requests for help with a job that no robot has answered, by luggage.
    helps: BTreeMap<u32, CriticalSituation>,
    /// Robots that report that they are active.
    active: BTreeMap<u32, Active>,
    /// Active robots that are told to break, with the time until which they can say so themselves.
    breaking: BTreeMap<u32, Time>,
    /// Active robots that are broken.
    broken: BTreeSet<u32>,
    /// Robots that are off the floor, or whose component failed.
    gone: Gone,
    /// Robots whose component failed, until they are back.
    failed: BTreeMap<u32, Failed>,
    /// What the world says that robots left when they were taken off the floor or failed, by robot.
    left: BTreeMap<u32, Removal>,
    /// Visits that a robot left, which are not requested again yet.
    left_visits: Vec<u32>,
    /// True once there was a robot.
    seen: bool,
    /// True if something changed since the last check.
    changed: bool,
    /// Luggage that waits and that no robot was asked to bring, oldest first.
    waiting: BTreeSet<(Time, u32)>,
}

/// A robot that reports that it is active.
#[derive(Clone, Copy, Debug)]
struct Active {
    /// Period of its component.
    period: Duration,
    /// Time of its last report.
    said: Time,
}

#[derive(Debug, Default)]
struct Piece {
    from: Block,
    to: Block,
    /// Robots that can never bring it.
    refused: BTreeSet<u32>,
    /// True while no robot has taken it.
    waits: bool,
    /// The robot that has taken it, unless that one asked for help with it.
    taken: Option<u32>,
    /// The robot that had taken it, and is out since, until it is known where the piece is.
    left_by: Option<u32>,
    /// Blocks to visit, in place of bringing luggage.
    stops: Vec<Block>,
    /// The only robot that may do it.
    only: Option<u32>,
    /// Time of its request.
    since: Time,
    /// The robot to which it is assigned, until that one answers.
    asked: Option<u32>,
    /// Time until which robots may decide by themselves who takes it: one of them is interested.
    discussed: Time,
    /// Robots that are told to give it back, since another one has taken it, until they do.
    contenders: BTreeSet<u32>,
    /// True if one of these gave it back: robots that heard that it was taken do not know that it may wait since.
    unheard: bool,
    /// The last lease of a robot of another program.
    lease: Option<PieceLease>,
}

impl Piece {
    /// The request for it, under its number.
    fn request(&self, luggage: u32) -> EventLuggage {
        self.visit(luggage).map_or_else(|| EventLuggage::request(luggage, self.from, self.to), |visit| visit.request())
    }

    /// What robots have to know of a visit.
    fn visit(&self, luggage: u32) -> Option<Visit> {
        let robot = self.only.unwrap_or(0);
        (!self.stops.is_empty()).then(|| Visit { visit: luggage, robot, stops: self.stops.clone() })
    }

    /// It is at another block: whoever could not bring it from where it was may be able to now.
    fn lies_at(&mut self, block: Block) {
        if std::mem::replace(&mut self.from, block) != block {
            self.refused.clear();
        }
    }

    /// A robot does not bring it that was told to give it back.
    fn concede(&mut self, robot: u32) {
        self.unheard |= self.contenders.remove(&robot);
    }

    /// True if this robot may do it and did not refuse it.
    fn is_for(&self, robot: u32) -> bool {
        self.only.is_none_or(|only| only == robot) && !self.refused.contains(&robot)
    }
}

/// Luggage that waits and that no robot was asked to bring.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub struct WaitingPiece {
    /// The job.
    pub job: Job,
    /// Time of the request.
    pub since: Time,
    /// Number of the only robot that may do it, if it is a visit for one alone.
    pub only: Option<u32>,
}

/// Maximum number of pieces that a status lists.
const LISTED: usize = 1000;

impl OpenLuggage {
    /// What an operator wants to know: the open pieces, and which of them no robot has taken.
    pub(super) fn status(&self) -> Vec<(String, ReportValue)> {
        let block = |block: Block| ReportValue::List(vec![block.x.into(), block.y.into()]);
        let piece = |(luggage, piece): (&u32, &Piece)| {
            ReportValue::Map(ReportValue::named([
                ("luggage", ReportValue::from(*luggage)),
                ("from", block(piece.from)),
                ("to", block(piece.to)),
                ("waits", piece.waits.into()),
                ("robot", piece.taken.or(piece.asked).map_or(ReportValue::Null, ReportValue::from)),
            ]))
        };
        let number = |number: usize| ReportValue::from(i64::try_from(number).unwrap_or(i64::MAX));
        let waiting = self.pieces.values().filter(|piece| piece.waits).count();
        ReportValue::named([
            ("open", number(self.pieces.len())),
            ("waiting", number(waiting)),
            ("gone", ReportValue::List(self.gone().map(ReportValue::from).collect())),
            ("luggage", ReportValue::List(self.pieces.iter().take(LISTED).map(piece).collect())),
        ])
    }

    pub(super) fn add(&mut self, luggage: u32, from: Block, to: Block, since: Time) {
        self.put(luggage, Piece { from, to, since, ..Piece::default() });
    }

    pub(super) fn add_visit(&mut self, visit: &Visit, since: Time) {
        let ([from, to], stops) = (visit.ends(), visit.stops.clone());
        let only = Some(visit.robot).filter(|robot| *robot != 0);
        self.put(visit.visit, Piece { from, to, stops, only, since, ..Piece::default() });
    }

    fn put(&mut self, luggage: u32, piece: Piece) {
        let since = piece.since;
        self.pieces.insert(luggage, Piece { waits: true, discussed: since, ..piece });
        self.waiting.insert((since, luggage));
        self.changed = true;
    }

    /// The visit of this number.
    pub(super) fn visit(&self, number: u32) -> Option<Visit> {
        self.pieces.get(&number)?.visit(number)
    }

    /// Luggage that waits and that no robot was asked to bring, oldest first.
    pub(super) fn waiting(&self) -> impl Iterator<Item = WaitingPiece> {
        self.waiting.iter().filter_map(|(since, luggage)| {
            let piece = self.pieces.get(luggage)?;
            let job = Job { luggage: *luggage, from: piece.from, to: piece.to };
            Some(WaitingPiece { job, since: *since, only: piece.only })
        })
    }

    /// Time of the request of the oldest luggage that waits, for a robot or for help.
    pub(super) fn oldest(&self) -> Option<Time> {
        let helps = self.helps.keys().filter_map(|luggage| Some(self.pieces.get(luggage)?.since));
        self.waiting.first().map(|(since, _)| *since).into_iter().chain(helps).min()
    }

    /// True if no luggage waits.
    pub(super) fn is_nothing_waiting(&self) -> bool {
        self.waiting.is_empty()
    }

    /// The job of a piece that is open.
    pub(super) fn job(&self, luggage: u32) -> Option<WaitingPiece> {
        let piece = self.pieces.get(&luggage)?;
        let job = Job { luggage, from: piece.from, to: piece.to };
        Some(WaitingPiece { job, since: piece.since, only: piece.only })
    }

    /// True if a robot refused the luggage for good, or it is for another one alone.
    pub(super) fn is_refused(&self, luggage: u32, robot: u32) -> bool {
        self.pieces.get(&luggage).is_none_or(|piece| !piece.is_for(robot))
    }

    /// True if robots decide by themselves at present who takes the luggage.
    pub(super) fn is_discussed(&self, luggage: u32, now: Time) -> bool {
        self.pieces.get(&luggage).is_some_and(|piece| piece.discussed > now)
    }

    /// A robot is interested in luggage, and decides until this time.
    pub(super) fn discuss(&mut self, luggage: u32, until: Time) {
        if let Some(piece) = self.pieces.get_mut(&luggage) {
            piece.discussed = until;
        }
    }

    /// Luggage is assigned to a robot.
    pub(super) fn ask(&mut self, luggage: u32, robot: u32) {
        if let Some(piece) = self.pieces.get_mut(&luggage) {
            piece.asked = Some(robot);
            self.waiting.remove(&(piece.since, luggage));
        }
    }

    /// The robot does not bring the luggage that was assigned to it.
    pub(super) fn hand_back(&mut self, luggage: u32, robot: u32) {
        let Some(piece) = self.pieces.get_mut(&luggage) else { return };
        piece.concede(robot);
        if piece.asked == Some(robot) || piece.taken == Some(robot) {
            (piece.asked, piece.taken, piece.waits) = (None, None, true);
            self.waiting.insert((piece.since, luggage));
        }
    }

    /// A robot is told to give luggage back, since another one has taken it.
    pub(super) fn contend(&mut self, luggage: u32, robot: u32) {
        if let Some(piece) = self.pieces.get_mut(&luggage) {
            piece.contenders.insert(robot);
        }
    }

    /// Requests again what waits although robots heard last that it is taken.
    pub(super) fn ask_again(&mut self) -> Vec<EventLuggage> {
        let unheard = |piece: &Piece| piece.unheard && piece.waits && piece.contenders.is_empty();
        let unheard = self.pieces.iter_mut().filter(|(_, piece)| unheard(piece));
        let again = unheard.map(|(luggage, piece)| {
            piece.unheard = false;
            piece.request(*luggage)
        });
        again.collect()
    }

    /// The robot that brings luggage, or that is to.
    pub(super) fn bearer(&self, luggage: u32) -> Option<u32> {
        self.pieces.get(&luggage).and_then(|piece| piece.taken.or(piece.asked))
    }

    fn remove(&mut self, luggage: u32) {
        if let Some(piece) = self.pieces.remove(&luggage) {
            self.waiting.remove(&(piece.since, luggage));
        }
        self.helps.remove(&luggage);
    }

    /// The lowest number of open luggage, and the number of other pieces.
    pub(super) fn first(&self) -> Option<(u32, usize)> {
        self.pieces.first_key_value().map(|(first, _)| (*first, self.pieces.len() - 1))
    }

    /// A robot is told to break. It has two executions to say so itself, before its luggage is given up.
    pub(super) fn break_down(&mut self, robot: u32, now: Time) {
        let period = self.active.get(&robot).map_or(Duration::ZERO, |active| active.period);
        self.breaking.entry(robot).or_insert(now + period.saturating_mul(2));
    }

    /// The robots that bring luggage, with its number.
    pub(super) fn jobs(&self) -> impl Iterator<Item = (u32, u32)> {
        self.pieces.iter().filter_map(|(luggage, piece)| Some((piece.taken?, *luggage)))
    }

    /// Visits that other robots do since before this one began. It did not hear their blocks, and may have to take
    /// over.
    pub(super) fn taken_before(&self, robot: u32, began: Option<Time>) -> Vec<Visit> {
        let is_earlier = |piece: &&Piece| !piece.waits && began.is_some_and(|began| piece.since <= began);
        let taken = self.pieces.range(FIRST_VISIT..).filter(|(_, piece)| is_earlier(piece) && piece.is_for(robot));
        taken.filter_map(|(luggage, piece)| piece.visit(*luggage)).collect()
    }

    /// The robots that are asked to do visits, with the number of the visit.
    pub(super) fn asked(&self) -> impl Iterator<Item = (u32, u32)> {
        self.pieces.range(FIRST_VISIT..).filter_map(|(luggage, piece)| Some((piece.asked?, *luggage)))
    }

    /// Handles the state of a robot; true if it was not active before.
    pub(super) fn hear_robot(&mut self, robot: &RobotList, header: Header) -> bool {
        self.seen = true;
        if !self.gone.hears(robot, header) {
            return false;
        }
        if robot.active && !self.active.contains_key(&robot.robot) {
            match self.failed.get_mut(&robot.robot) {
                // The others have to hear that what it said before is over.
                Some(failed) if !failed.is_told => failed.fault.kind = FaultKind::Restarting,
                _ => {
                    self.failed.remove(&robot.robot);
                    self.left.remove(&robot.robot);
                }
            }
        }
        let active = Active { period: Duration::from_micros(robot.period), said: header.sent };
        let is_new = robot.active && self.active.insert(robot.robot, active).is_none();
        self.changed |= is_new;
        if !robot.active {
            // A robot that reports itself again was repaired.
            self.broken.remove(&robot.robot);
            self.breaking.remove(&robot.robot);
            self.changed |= self.active.remove(&robot.robot).is_some();
            self.pieces.values_mut().for_each(|piece| piece.concede(robot.robot));
            let left = |piece: &Piece| !piece.stops.is_empty() && piece.taken == Some(robot.robot);
            let left = self.pieces.iter().filter(|(_, piece)| left(piece));
            self.left_visits.extend(left.map(|(luggage, _)| *luggage));
        }
        is_new
    }

    /// True if a healer says that it takes a job over which another one has taken over from the same robot.
    pub(super) fn is_taken_over(&self, luggage: u32, said: &CriticalSituation) -> bool {
        let bearer = self.pieces.get(&luggage).and_then(|piece| piece.taken);
        let is_of_other = bearer.is_some_and(|bearer| bearer != said.healer && bearer != said.critical);
        said.stage == CriticalStage::Taken && is_of_other
    }

    /// Handles a request for help, or the response of a healer.
    pub(super) fn hear_situation(&mut self, situation: &CriticalSituation) {
        let Some(Job { luggage, from, .. }) = situation.job() else { return };
        match situation.stage {
            CriticalStage::Request => {
                if let Some(piece) = self.pieces.get_mut(&luggage) {
                    (piece.taken, piece.asked, piece.left_by) = (None, None, None);
                    piece.contenders.remove(&situation.critical);
                    piece.lies_at(from);
                    self.changed = true;
                    self.waiting.remove(&(piece.since, luggage));
                    self.helps.insert(luggage, situation.clone());
                }
            }
            CriticalStage::Taken => {
                self.helps.remove(&luggage);
                if let Some(piece) = self.pieces.get_mut(&luggage) {
                    // For who takes it away from the healer, it lies where the broken robot left it.
                    (piece.from, piece.taken, piece.asked) = (from, Some(situation.healer), None);
                    piece.waits = false;
                    // A robot that is out said so before.
                    piece.left_by = piece.taken.take_if(|healer| self.gone.is_out(*healer));
                    self.waiting.remove(&(piece.since, luggage));
                }
            }
            CriticalStage::Intention | CriticalStage::Release | CriticalStage::StandsIn => {}
        }
    }

    /// Requests that wait for a robot, as luggage and as calls for help, without those that this robot refused.
    pub(super) fn waiting_for(&self, robot: u32) -> (Vec<EventLuggage>, Vec<CriticalSituation>) {
        let open = |luggage: u32| self.pieces.get(&luggage).is_some_and(|piece| piece.is_for(robot));
        let waiting = self.pieces.iter().filter(|(luggage, piece)| piece.waits && open(**luggage));
        let luggage = waiting.map(|(luggage, piece)| piece.request(*luggage));
        let helps = self.helps.iter().filter(|(luggage, _)| open(**luggage)).map(|(_, help)| help.clone());
        (luggage.collect(), helps.collect())
    }

    pub(super) fn hear_response(&mut self, response: &EventLuggage) {
        match response.stage {
            LuggageStage::Delivered | LuggageStage::GivenUp => {
                self.remove(response.luggage);
            }
            LuggageStage::Request | LuggageStage::Taken => {
                if let Some(piece) = self.pieces.get_mut(&response.luggage) {
                    piece.waits = response.stage == LuggageStage::Request;
                    piece.taken = (!piece.waits).then_some(response.robot);
                    // A robot that is out said so before.
                    piece.left_by = piece.taken.take_if(|robot| self.gone.is_out(*robot));
                    piece.asked = None;
                    // A robot that did not find it where it was before asks the others to look there, too.
                    piece.unheard |= piece.waits && piece.stops.is_empty() && response.from != piece.from;
                    let key = (piece.since, response.luggage);
                    if piece.waits { _ = self.waiting.insert(key) } else { _ = self.waiting.remove(&key) }
                }
            }
            LuggageStage::Refused => {
                if let Some(piece) = self.pieces.get_mut(&response.luggage) {
                    self.changed |= piece.refused.insert(response.robot);
                    if !piece.stops.is_empty() && piece.taken == Some(response.robot) {
                        self.left_visits.push(response.luggage);
                    } else {
                        self.hand_back(response.luggage, response.robot);
                    }
                }
            }
            LuggageStage::Release => self.hand_back(response.luggage, response.robot),
            LuggageStage::Interest => {}
        }
    }

    /// Requests again the visits that a robot left.
    pub(super) fn visit_again(&mut self) -> Vec<EventLuggage> {
        let left = std::mem::take(&mut self.left_visits);
        let again = left.into_iter().filter_map(|luggage| {
            let piece = self.pieces.get_mut(&luggage).filter(|piece| piece.taken.is_some() && piece.only.is_none())?;
            (piece.waits, piece.taken) = (true, None);
            self.waiting.insert((piece.since, luggage));
            Some(piece.request(luggage))
        });
        again.collect()
    }

    /// Removes luggage that no robot can bring: every robot refused it, or no robot is left. Returns number, origin and
    /// destination of each piece.
    pub(super) fn take_hopeless(&mut self, now: Time) -> Vec<(u32, Block, Block)> {
        for (robot, _) in self.breaking.extract_if(.., |_, until| *until <= now) {
            self.changed |= self.broken.insert(robot);
        }
        if !std::mem::take(&mut self.changed) || !self.seen {
            return Vec::new();
        }
        let OpenLuggage { pieces, helps, active, broken, failed, waiting, .. } = self;
        let returning = failed.values().map(|failed| &failed.fault);
        let returning = returning.filter(|fault| fault.kind == FaultKind::Restarting).map(|fault| fault.robot);
        let able: BTreeSet<u32> =
            active.keys().copied().filter(|robot| !broken.contains(robot)).chain(returning).collect();
        let can = |piece: &Piece| able.iter().any(|robot| piece.is_for(*robot));
        let hopeless = pieces.extract_if(.., |_, piece| !can(piece));
        let hopeless = hopeless.map(|(luggage, piece)| {
            waiting.remove(&(piece.since, luggage));
            (luggage, piece.from, piece.to)
        });
        let hopeless: Vec<_> = hopeless.collect();
        hopeless.iter().for_each(|(luggage, ..)| _ = helps.remove(luggage));
        hopeless
    }
}

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use saoms_api::{Field, Header, ReportValue, Time};

use crate::gone::Gone;
use crate::grid::Block;
use crate::messages::{CriticalSituation, CriticalStage, EventLuggage, LuggageStage, Removal, RobotList, Visit};
use crate::robot::Job;

/// Open luggage, and the robots that could bring it.
#[derive(Debug, Default)]
pub(super) struct OpenLuggage {
    pieces: BTreeMap<u32, Piece>,
    /// Requests for help with a job that no robot has answered, by luggage.
    helps: BTreeMap<u32, CriticalSituation>,
    /// Robots that report that they are active, with their period.
    active: BTreeMap<u32, Duration>,
    /// Active robots that are told to break, with the time until which they can say so themselves.
    breaking: BTreeMap<u32, Time>,
    /// Active robots that are broken.
    broken: BTreeSet<u32>,
    /// Robots that are off the floor.
    gone: Gone,
    /// What the world says that robots left when they were taken off the floor, by robot.
    left: BTreeMap<u32, Removal>,
    /// Visits that a robot left, which are not requested again yet.
    left_visits: Vec<u32>,
    /// True once there was a robot.
    seen: bool,
    /// True if something changed since the last check.
    changed: bool,
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
    /// Blocks to visit, in place of bringing luggage.
    stops: Vec<Block>,
    /// The only robot that may do it.
    only: Option<u32>,
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

    /// True if this robot may do it and did not refuse it.
    fn is_for(&self, robot: u32) -> bool {
        self.only.is_none_or(|only| only == robot) && !self.refused.contains(&robot)
    }
}

/// Open luggage, for a master that goes on.
#[derive(Clone, Debug, Field)]
pub(super) struct OpenMemory {
    pieces: Vec<PieceMemory>,
    helps: Vec<CriticalSituation>,
    active: Vec<ActiveMemory>,
    breaking: Vec<BreakingMemory>,
    broken: Vec<u32>,
    gone: Gone,
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
    stops: Vec<Block>,
    only: Option<u32>,
}

#[derive(Clone, Copy, Debug, Field)]
struct ActiveMemory {
    robot: u32,
    period_us: u64,
}

#[derive(Clone, Copy, Debug, Field)]
struct BreakingMemory {
    robot: u32,
    until: Time,
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

    /// The state for a master that goes on.
    pub(super) fn memory(&self) -> OpenMemory {
        let piece = |(luggage, piece): (&u32, &Piece)| {
            let Piece { from, to, refused, waits, taken, stops, only } = piece;
            let (refused, stops) = (refused.iter().copied().collect(), stops.clone());
            PieceMemory {
                luggage: *luggage,
                from: *from,
                to: *to,
                refused,
                waits: *waits,
                taken: *taken,
                stops,
                only: *only,
            }
        };
        // Periods came as whole microseconds.
        let active = |(robot, period): (&u32, &Duration)| ActiveMemory {
            robot: *robot,
            period_us: u64::try_from(period.as_micros()).unwrap_or(u64::MAX),
        };
        let breaking = self.breaking.iter().map(|(&robot, &until)| BreakingMemory { robot, until });
        OpenMemory {
            pieces: self.pieces.iter().map(piece).collect(),
            helps: self.helps.values().cloned().collect(),
            active: self.active.iter().map(active).collect(),
            breaking: breaking.collect(),
            broken: self.broken.iter().copied().collect(),
            gone: self.gone.clone(),
            left: self.left.values().cloned().collect(),
            left_visits: self.left_visits.clone(),
            seen: self.seen,
            changed: self.changed,
        }
    }

    /// The state of a master that goes on.
    pub(super) fn of(memory: OpenMemory) -> OpenLuggage {
        let piece = |piece: PieceMemory| {
            let PieceMemory { luggage, from, to, refused, waits, taken, stops, only } = piece;
            (luggage, Piece { from, to, refused: refused.into_iter().collect(), waits, taken, stops, only })
        };
        let active = memory.active.iter().map(|active| (active.robot, Duration::from_micros(active.period_us)));
        OpenLuggage {
            pieces: memory.pieces.into_iter().map(piece).collect(),
            helps: memory.helps.into_iter().map(|help| (help.luggage, help)).collect(),
            active: active.collect(),
            breaking: memory.breaking.iter().map(|breaking| (breaking.robot, breaking.until)).collect(),
            broken: memory.broken.into_iter().collect(),
            gone: memory.gone,
            left: memory.left.into_iter().map(|left| (left.robot, left)).collect(),
            left_visits: memory.left_visits,
            seen: memory.seen,
            changed: memory.changed,
        }
    }

    pub(super) fn add(&mut self, luggage: u32, from: Block, to: Block) {
        self.pieces.insert(luggage, Piece { from, to, waits: true, ..Piece::default() });
        self.changed = true;
    }

    pub(super) fn add_visit(&mut self, visit: &Visit) {
        let ([from, to], stops) = (visit.ends(), visit.stops.clone());
        let only = Some(visit.robot).filter(|robot| *robot != 0);
        self.pieces.insert(visit.visit, Piece { from, to, stops, only, waits: true, ..Piece::default() });
        self.changed = true;
    }

    /// The visit of this number.
    pub(super) fn visit(&self, number: u32) -> Option<Visit> {
        self.pieces.get(&number)?.visit(number)
    }

    /// The lowest number of open luggage, and the number of other pieces.
    pub(super) fn first(&self) -> Option<(u32, usize)> {
        self.pieces.first_key_value().map(|(first, _)| (*first, self.pieces.len() - 1))
    }

    /// A robot is told to break. It has two executions to say so itself, before its luggage is given up.
    pub(super) fn break_down(&mut self, robot: u32, now: Time) {
        let period = self.active.get(&robot).copied().unwrap_or_default();
        self.breaking.entry(robot).or_insert(now + period.saturating_mul(2));
    }

    /// A robot is off the floor.
    pub(super) fn take_away(&mut self, robot: u32, header: Header) {
        self.gone.note(robot, header);
        self.breaking.remove(&robot);
        self.broken.remove(&robot);
        self.changed |= self.active.remove(&robot).is_some();
    }

    /// The world says what a robot left.
    pub(super) fn hear_removal(&mut self, removal: &Removal) {
        self.left.insert(removal.robot, removal.clone());
        for luggage in &removal.delivered {
            self.pieces.remove(luggage);
            self.helps.remove(luggage);
        }
    }

    /// Robots that are off the floor.
    pub(super) fn gone(&self) -> impl Iterator<Item = u32> {
        self.gone.robots()
    }

    /// Opens the luggage of robots that are off the floor again: what they carried lies where the world says, and all
    /// else, or without a world all, where it was to be collected. Returns the robots with their requests.
    pub(super) fn open_again(&mut self, has_world: bool) -> Vec<(u32, EventLuggage)> {
        let mut again = Vec::new();
        for robot in self.gone.robots() {
            let left = self.left.get(&robot);
            if has_world && left.is_none() {
                continue;
            }
            for (luggage, piece) in self.pieces.iter_mut().filter(|(_, piece)| piece.taken == Some(robot)) {
                if let Some(left) = left.filter(|left| left.luggage.contains(luggage)) {
                    piece.from = left.block;
                }
                (piece.waits, piece.taken) = (true, None);
                again.push((robot, piece.request(*luggage)));
            }
        }
        again
    }

    /// Handles the state of a robot; true if it was not active before.
    pub(super) fn hear_robot(&mut self, robot: &RobotList, header: Header) -> bool {
        self.seen = true;
        if !self.gone.hears(robot, header) {
            return false;
        }
        if robot.active && !self.active.contains_key(&robot.robot) {
            self.left.remove(&robot.robot);
        }
        let is_new = robot.active && { self.active.insert(robot.robot, Duration::from_micros(robot.period)).is_none() };
        self.changed |= is_new;
        if !robot.active {
            // A robot that reports itself again was repaired.
            self.broken.remove(&robot.robot);
            self.breaking.remove(&robot.robot);
            self.changed |= self.active.remove(&robot.robot).is_some();
            let left = |piece: &Piece| !piece.stops.is_empty() && piece.taken == Some(robot.robot);
            let left = self.pieces.iter().filter(|(_, piece)| left(piece));
            self.left_visits.extend(left.map(|(luggage, _)| *luggage));
        }
        is_new
    }

    /// Handles a request for help, or the response of a healer.
    pub(super) fn hear_situation(&mut self, situation: &CriticalSituation) {
        let Some(Job { luggage, from, .. }) = situation.job() else { return };
        match situation.stage {
            CriticalStage::Request => {
                if let Some(piece) = self.pieces.get_mut(&luggage) {
                    piece.taken = None;
                    self.helps.insert(luggage, situation.clone());
                }
            }
            CriticalStage::Taken => {
                self.helps.remove(&luggage);
                if let Some(piece) = self.pieces.get_mut(&luggage) {
                    // For who takes it away from the healer, it lies where the broken robot left it.
                    (piece.from, piece.taken) = (from, Some(situation.healer));
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
                self.pieces.remove(&response.luggage);
                self.helps.remove(&response.luggage);
            }
            LuggageStage::Request | LuggageStage::Taken => {
                if let Some(piece) = self.pieces.get_mut(&response.luggage) {
                    piece.waits = response.stage == LuggageStage::Request;
                    piece.taken = (!piece.waits).then_some(response.robot);
                }
            }
            LuggageStage::Refused => {
                if let Some(piece) = self.pieces.get_mut(&response.luggage) {
                    self.changed |= piece.refused.insert(response.robot);
                    if !piece.stops.is_empty() && piece.taken == Some(response.robot) {
                        self.left_visits.push(response.luggage);
                    }
                }
            }
            LuggageStage::Interest | LuggageStage::Release => {}
        }
    }

    /// Requests again the visits that a robot left.
    pub(super) fn visit_again(&mut self) -> Vec<EventLuggage> {
        let left = std::mem::take(&mut self.left_visits);
        let again = left.into_iter().filter_map(|luggage| {
            let piece = self.pieces.get_mut(&luggage).filter(|piece| piece.taken.is_some() && piece.only.is_none())?;
            (piece.waits, piece.taken) = (true, None);
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
        let OpenLuggage { pieces, helps, active, broken, .. } = self;
        let can =
            |piece: &Piece| active.keys().filter(|robot| !broken.contains(robot)).any(|robot| piece.is_for(*robot));
        let hopeless = pieces.extract_if(.., |_, piece| !can(piece));
        let hopeless: Vec<_> = hopeless.map(|(luggage, piece)| (luggage, piece.from, piece.to)).collect();
        hopeless.iter().for_each(|(luggage, ..)| _ = helps.remove(luggage));
        hopeless
    }
}

#[cfg(test)]
mod tests {
    use saoms_api::Cause;

    use super::*;

    fn robot(robot: u32, active: bool) -> RobotList {
        RobotList { robot, active, ..RobotList::default() }
    }

    fn heard(millis: u64) -> Header {
        Header { sender: 0, sent: at(millis), cause: Cause::default() }
    }

    fn at(millis: u64) -> Time {
        Time::START + Duration::from_millis(millis)
    }

    fn refusal(luggage: u32, robot: u32) -> EventLuggage {
        EventLuggage { luggage, robot, stage: LuggageStage::Refused, ..EventLuggage::default() }
    }

    fn hopeless(open: &mut OpenLuggage) -> Vec<u32> {
        hopeless_at(open, 0)
    }

    fn hopeless_at(open: &mut OpenLuggage, millis: u64) -> Vec<u32> {
        open.take_hopeless(at(millis)).into_iter().map(|(luggage, ..)| luggage).collect()
    }

    #[test]
    fn luggage_is_given_up_once_every_robot_refused_it() {
        let mut open = OpenLuggage::default();
        for luggage in 1..=3 {
            open.add(luggage, Block::new(0, 0), Block::new(1, 0));
        }
        assert_eq!(hopeless(&mut open), [0; 0], "no robot was there yet");
        open.hear_robot(&robot(1, true), heard(0));
        open.hear_robot(&robot(2, true), heard(0));
        open.hear_response(&refusal(2, 1));
        assert_eq!(hopeless(&mut open), [0; 0]);
        open.hear_response(&refusal(2, 2));
        assert_eq!(hopeless(&mut open), [2]);
        open.hear_response(&EventLuggage { stage: LuggageStage::Delivered, luggage: 1, ..refusal(1, 1) });
        open.hear_response(&refusal(3, 1));
        open.break_down(2, at(0));
        assert_eq!(hopeless(&mut open), [3], "the other one is broken down");
    }

    #[test]
    fn who_is_told_to_break_can_say_so_first() {
        let mut open = OpenLuggage::default();
        for number in [1, 2] {
            open.hear_robot(&RobotList { period: 500_000, ..robot(number, true) }, heard(0));
            open.add(number, Block::new(0, 0), Block::new(1, 0));
            open.break_down(number, at(1000));
        }
        assert_eq!(hopeless_at(&mut open, 1900), [0; 0]);
        open.hear_robot(&robot(2, false), heard(0));
        assert_eq!(hopeless_at(&mut open, 1950), [0; 0], "the other one may still bring it");
        assert_eq!(hopeless_at(&mut open, 2000), [1, 2], "it says nothing");
    }

    #[test]
    fn a_robot_that_starts_later_gets_what_waits() {
        let block = |x| Block::new(x, 0);
        let help = |stage| CriticalSituation { critical: 1, luggage: 2, stage, ..CriticalSituation::default() };
        let waiting = |open: &OpenLuggage, robot| {
            let (luggage, helps) = open.waiting_for(robot);
            let luggage = luggage.iter().map(|request| request.luggage).collect::<Vec<_>>();
            (luggage, helps.iter().map(|help| help.luggage).collect::<Vec<_>>())
        };
        let mut open = OpenLuggage::default();
        for luggage in 1..=3 {
            open.add(luggage, block(0), block(1));
        }
        assert!(open.hear_robot(&robot(1, true), heard(0)));
        assert!(!open.hear_robot(&robot(1, true), heard(0)), "it was active before");
        open.hear_response(&EventLuggage { stage: LuggageStage::Taken, ..refusal(2, 1) });
        open.hear_response(&refusal(3, 2));
        assert_eq!(waiting(&open, 2), (vec![1], vec![]));
        open.hear_situation(&help(CriticalStage::Request));
        open.hear_robot(&robot(1, false), heard(0));
        assert!(open.hear_robot(&robot(1, true), heard(0)));
        assert_eq!(waiting(&open, 1), (vec![1, 3], vec![2]), "a robot that starts again knows nothing");
        open.hear_situation(&help(CriticalStage::Taken));
        assert_eq!(waiting(&open, 1), (vec![1, 3], vec![]));
        open.hear_response(&EventLuggage { stage: LuggageStage::Request, ..refusal(2, 0) });
        assert_eq!(waiting(&open, 2), (vec![1, 2], vec![]));
    }

    #[test]
    fn luggage_is_given_up_once_no_robot_is_left() {
        let mut open = OpenLuggage::default();
        open.hear_robot(&robot(1, true), heard(0));
        open.add(1, Block::new(0, 0), Block::new(1, 0));
        assert_eq!(hopeless(&mut open), [0; 0]);
        open.hear_robot(&robot(1, false), heard(0));
        assert_eq!(hopeless(&mut open), [1]);
        open.hear_robot(&robot(1, true), heard(0));
        open.add(2, Block::new(0, 0), Block::new(1, 0));
        assert_eq!(hopeless(&mut open), [0; 0], "it is back");
    }

    #[test]
    fn luggage_of_a_robot_that_is_gone_waits_again_where_it_lies() {
        let block = |x| Block::new(x, 0);
        let taken = |luggage| EventLuggage { stage: LuggageStage::Taken, ..refusal(luggage, 1) };
        let again = |open: &mut OpenLuggage, has_world| {
            let all = open.open_again(has_world);
            all.iter().map(|(robot, request)| (*robot, request.luggage, request.from.x)).collect::<Vec<_>>()
        };
        let mut open = OpenLuggage::default();
        open.hear_robot(&robot(1, true), heard(0));
        open.hear_robot(&robot(2, true), heard(0));
        for luggage in 1..=4 {
            open.add(luggage, block(0), block(9));
        }
        open.hear_response(&taken(1));
        open.hear_response(&taken(2));
        open.hear_response(&EventLuggage { robot: 2, ..taken(3) });
        let help = CriticalSituation { critical: 1, luggage: 2, ..CriticalSituation::default() };
        open.hear_situation(&help);
        open.take_away(1, heard(5));
        assert_eq!(again(&mut open, true), [], "the world says where it lies");
        open.hear_removal(&Removal { robot: 1, block: block(4), luggage: vec![1], delivered: Vec::new() });
        assert_eq!(again(&mut open, true), [(1, 1, 4)], "the broken robot asked for help with the other piece");
        assert_eq!(again(&mut open, true), []);
        open.hear_response(&taken(4));
        assert_eq!(again(&mut open, true), [(1, 4, 0)], "it was on its way to say so");
        assert_eq!(open.waiting_for(3).0.iter().map(|request| request.from.x).collect::<Vec<_>>(), [4, 0]);

        assert!(!open.hear_robot(&robot(1, true), heard(5)), "it said so before");
        assert!(open.hear_robot(&robot(1, true), heard(6)), "it is back");
        open.hear_response(&taken(1));
        assert_eq!(again(&mut open, true), []);
        open.take_away(1, heard(9));
        assert_eq!(again(&mut open, false), [(1, 1, 4)], "nobody else can say where it lies");
    }
}

//! What the master knows of the robots that bring luggage.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use saoms_api::host::cdr::{DecodeError, Reader, Writer};
use saoms_api::host::declaration::ConstText;
use saoms_api::{Field, Time};

use crate::grid::Block;
use crate::messages::{CriticalSituation, CriticalStage, EventLuggage, LuggageStage, Position, RobotList, is_visit};
use crate::robot::Policy;

/// Number of periods of the slowest robot for which a robot that took no job is not asked again. It doubles each time,
/// as often as [`DOUBLED`], and beyond that while there is no news of the robot, so that a run ends in which nothing
/// changes any more. News cut the rest to what it is after [`DOUBLED`] times.
const REST: u32 = 8;
const DOUBLED: u32 = 6;
const MOST_DOUBLED: u32 = 20;

/// Number of periods of the slowest robot within which a robot answers where messages arrive at once.
const ANSWER: u32 = 8;

/// Number of answers after which most of a late one is forgotten.
const LATE_MEMORY: u32 = 32;

/// A robot, as the master knows it.
#[derive(Clone, Debug, Default, PartialEq, Field)]
pub struct Member {
    /// Number of the robot.
    pub robot: u32,
    /// Its last known block.
    pub block: Block,
    /// Block of its charger.
    pub charger: Block,
    /// Battery level in percent, as it last said.
    pub battery: f64,
    /// True if it sleeps.
    pub asleep: bool,
    /// Number of the luggage that it brings.
    pub job: Option<u32>,
    /// True if it was at the block of that luggage.
    pub collected: bool,
    /// Number of the luggage that is assigned to it, until it answers.
    pub asked: Option<u32>,
    /// Time until which it is to answer, or until which it is not asked again.
    pub until: Time,
    /// Number of the luggage that it is told to hand back, until it does.
    pub withdrawn: Option<u32>,
    /// Time until which it is not asked again where there is news of it.
    until_with_news: Time,
    period: u64,
    moved: Time,
    /// When it said last that it took luggage, or that it has done with it.
    took_at: Time,
    /// Time of the last assignment.
    asked_at: Time,
    /// The luggage of the last assignment that it did not answer in time, until it does, and when that was.
    late: Option<u32>,
    late_at: Time,
    /// How often in a row it did not answer in time.
    silent: u32,
    /// How often it handed luggage back since it took some.
    handed_back: u32,
    /// True if it works for another master, as its position says.
    engaged: bool,
    /// The luggage of another master that it brings, as far as that was heard.
    elsewhere: Option<u32>,
    /// When it said the last of what was heard about luggage of other masters.
    elsewhere_at: Time,
    /// True if it is out of earshot, with a job.
    away: bool,
    /// True if it was not heard for the time of a lease, until it is heard again.
    lapsed: bool,
    /// True if it never answers: the rules of the manual know no masters that assign.
    is_deaf: bool,
}

/// The robots that bring luggage, by number. As an entry it is a list of [`Member`].
#[derive(Debug, Default)]
pub struct Crew {
    members: BTreeMap<u32, Member>,
    /// Robots that are awake and have no job.
    free: BTreeSet<u32>,
    /// Robots to which luggage is assigned and that have not answered.
    asked: BTreeSet<u32>,
    /// Robots that broke or ended before they answered, with the luggage that was assigned to them, and the time until
    /// which an answer may still come.
    unanswered: Vec<(u32, u32, Time)>,
    /// Longest period of the robots, in microseconds.
    slowest: u64,
    /// The longest time that an answer took, and less with each further answer.
    answers_take: Duration,
    /// When robots said last that they do not bring luggage that is open, by luggage and robot.
    left: BTreeMap<(u32, u32), Time>,
    /// Shortest time from one block to the next that a robot took.
    step: Option<Duration>,
    /// True if something changed that makes other assignments possible.
    pub(in crate::master) changed: bool,
}

impl Member {
    /// The period of the robot, in microseconds.
    pub(super) fn period(&self) -> u64 {
        self.period
    }

    /// Notes that the robot is heard, and whether there is news of it. True if it may be asked earlier because of that.
    fn hear(&mut self, is_news: bool) -> bool {
        let (is_back, may_take) = (self.silent > DOUBLED, is_news && self.handed_back > DOUBLED);
        if self.asked.is_some() || !(is_back || may_take) {
            return false;
        }
        self.silent = self.silent.min(DOUBLED);
        if may_take {
            self.handed_back = DOUBLED;
        }
        let is_earlier = self.until_with_news < self.until;
        self.until = self.until.min(self.until_with_news);
        is_earlier
    }
}

impl Field for Crew {
    const TYPE: ConstText = <Vec<Member> as Field>::TYPE;
    const LEAST_SIZE: usize = <Vec<Member> as Field>::LEAST_SIZE;

    fn write(&self, writer: &mut Writer) {
        let all: Vec<Member> = self.members.values().cloned().collect();
        all.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        Err(DecodeError::new("the master keeps this list itself, by the messages that it hears", reader.offset()))
    }
}

impl Crew {
    /// Robots that are awake and have no job, and that may be asked, by number.
    pub(super) fn free(&self, now: Time) -> impl Iterator<Item = &Member> {
        self.free.iter().filter_map(|robot| self.members.get(robot)).filter(move |member| member.until <= now)
    }

    /// Robots that are awake.
    pub(super) fn awake(&self) -> impl Iterator<Item = &Member> {
        self.members.values().filter(|member| !(member.asleep || member.is_deaf))
    }

    /// Robots that sleep and that may be asked, by number.
    pub(super) fn asleep(&self, now: Time) -> impl Iterator<Item = &Member> {
        let is_asked = |member: &&Member| member.is_deaf || member.asked.is_some();
        let may = move |member: &&Member| member.asleep && member.until <= now && !is_asked(member);
        self.members.values().filter(may)
    }

    /// All robots.
    pub(super) fn members(&self) -> impl Iterator<Item = &Member> {
        self.members.values()
    }

    pub(super) fn get(&self, robot: u32) -> Option<&Member> {
        self.members.get(&robot)
    }

    /// Longest period of the robots.
    pub(super) fn slowest(&self) -> Duration {
        Duration::from_micros(self.slowest)
    }

    /// Time of a move, as far as it was seen.
    pub(super) fn step(&self) -> Duration {
        self.step.unwrap_or_else(|| self.slowest())
    }

    /// A crew of which only is known who brings what, and who is asked to visit what, after a restart of the master.
    pub(in crate::master) fn with_jobs(
        jobs: impl Iterator<Item = (u32, u32)>,
        asked: impl Iterator<Item = (u32, u32)>,
    ) -> Crew {
        // They count as out of earshot until they are heard.
        let away = |robot: u32| Member { robot, away: true, ..Member::default() };
        let mut crew = Crew::default();
        for (robot, luggage) in jobs {
            crew.members.insert(robot, Member { job: Some(luggage), collected: true, ..away(robot) });
        }
        for (robot, visit) in asked {
            crew.members.entry(robot).or_insert_with(|| away(robot)).asked = Some(visit);
            crew.asked.insert(robot);
        }
        crew
    }

    /// Handles the state of a robot.
    pub(in crate::master) fn hear_robot(&mut self, said: &RobotList) {
        if !said.active {
            return self.remove(said.robot);
        }
        let member = self.members.entry(said.robot).or_insert_with(|| {
            self.changed = true;
            Member { robot: said.robot, block: said.block, ..Member::default() }
        });
        let is_news = (member.charger, member.battery, member.asleep) != (said.charger, said.battery, said.asleep);
        self.changed |= member.hear(is_news) || member.asleep != said.asleep;
        let fills_up = said.battery >= 100.0 && member.battery < 100.0;
        if fills_up && member.handed_back > 0 && member.asked.is_none() {
            // Its battery may last now for what it handed back.
            (member.until, self.changed) = (Time::START, true);
        }
        (member.charger, member.battery, member.asleep, member.period) =
            (said.charger, said.battery, said.asleep, said.period);
        (member.away, member.lapsed, member.is_deaf) = (false, false, said.policy == Policy::Classic);
        self.slowest = self.slowest.max(said.period);
        self.sort(said.robot);
    }

    /// A robot is out of earshot. One that has a job is kept until that is over.
    pub(in crate::master) fn lose(&mut self, robot: u32) {
        if let Some(member) = self.members.get_mut(&robot) {
            member.away = true;
            self.sort(robot);
        }
    }

    /// Notes whether a robot works for another master.
    pub(super) fn engage(&mut self, robot: u32, engaged: bool) {
        let Some(member) = self.members.get_mut(&robot).filter(|member| member.engaged != engaged) else { return };
        member.engaged = engaged;
        self.changed |= !engaged;
        self.sort(robot);
    }

    /// A robot is not active any more, or cannot move.
    pub(in crate::master) fn remove(&mut self, robot: u32) {
        if let Some(Member { asked, until, .. }) = self.members.remove(&robot) {
            self.unanswered.extend(asked.map(|luggage| (robot, luggage, until)));
            self.sort(robot);
        }
    }

    /// Handles what a robot said about luggage.
    pub(in crate::master) fn hear_response(&mut self, said: &EventLuggage, now: Time) {
        let rest = self.slowest().saturating_mul(REST);
        self.unanswered.retain(|(robot, luggage, _)| (*robot, *luggage) != (said.robot, said.luggage));
        let Some(member) = self.members.get_mut(&said.robot) else { return };
        let luggage = Some(said.luggage);
        (member.block, member.lapsed) = (said.block, false);
        match said.stage {
            LuggageStage::Taken => {
                (member.job, member.asked, member.collected) = (luggage, None, false);
                (member.handed_back, member.withdrawn, member.until) = (0, None, now);
                (member.engaged, member.elsewhere) = (false, None);
            }
            LuggageStage::Delivered | LuggageStage::Refused | LuggageStage::GivenUp | LuggageStage::Release => {
                if member.job == luggage {
                    // Until then its positions told of work for this master.
                    (member.job, member.until, member.engaged) = (None, now, false);
                } else if member.asked == luggage && said.stage == LuggageStage::Release {
                    member.until = now + rest.saturating_mul(1 << member.handed_back);
                    member.until_with_news = now + rest.saturating_mul(1 << member.handed_back.min(DOUBLED));
                    member.handed_back = (member.handed_back + 1).min(MOST_DOUBLED);
                }
                member.asked.take_if(|asked| Some(*asked) == luggage);
                member.withdrawn.take_if(|withdrawn| Some(*withdrawn) == luggage);
            }
            LuggageStage::Request | LuggageStage::Interest => return,
        }
        self.changed = true;
        self.sort(said.robot);
    }

    /// Handles what a robot said about luggage of another master. Where it is on its last move to its goal, its
    /// position does not tell that it works.
    pub(super) fn hear_elsewhere(&mut self, said: &EventLuggage, sent: Time) {
        let Some(member) = self.members.get_mut(&said.robot) else { return };
        if sent < member.elsewhere_at.max(member.took_at) {
            return;
        }
        member.elsewhere_at = sent;
        match said.stage {
            LuggageStage::Taken => member.elsewhere = Some(said.luggage),
            LuggageStage::Delivered | LuggageStage::Refused | LuggageStage::GivenUp | LuggageStage::Release => {
                self.changed |= member.elsewhere.take_if(|luggage| *luggage == said.luggage).is_some();
            }
            LuggageStage::Request | LuggageStage::Interest => return,
        }
        self.sort(said.robot);
    }

    /// True if a robot said since that it has left this luggage, or has taken or done with luggage: messages may
    /// overtake each other.
    pub(super) fn is_outdated(&mut self, said: &EventLuggage, sent: Time) -> bool {
        let EventLuggage { luggage, robot, stage, .. } = *said;
        match stage {
            LuggageStage::Taken => {
                let left_since = self.left.get(&(luggage, robot)).is_some_and(|left| *left > sent);
                let member = self.members.get_mut(&robot);
                let took_since = member.as_ref().is_some_and(|member| member.took_at > sent);
                if let Some(member) = member.filter(|_| !left_since && !took_since) {
                    member.took_at = sent;
                }
                left_since || took_since
            }
            LuggageStage::Release | LuggageStage::Refused => {
                let left = self.left.entry((luggage, robot)).or_default();
                *left = sent.max(*left);
                false
            }
            LuggageStage::Delivered | LuggageStage::GivenUp => {
                let of_luggage = self.left.range((luggage, 0)..=(luggage, u32::MAX)).map(|(key, _)| *key);
                for key in of_luggage.collect::<Vec<_>>() {
                    self.left.remove(&key);
                }
                // It has one job at a time: what it said of taking before is over.
                if let Some(member) = self.members.get_mut(&robot) {
                    member.took_at = member.took_at.max(sent);
                }
                false
            }
            LuggageStage::Request | LuggageStage::Interest => false,
        }
    }

    /// Notes how long a robot took to answer an assignment. True if it answers an earlier one than the last one of this
    /// luggage: the answer to that is still to come.
    pub(super) fn note_answer(&mut self, said: &EventLuggage, now: Time) -> bool {
        let stages = [LuggageStage::Taken, LuggageStage::Refused, LuggageStage::Release];
        let Some(member) = self.members.get_mut(&said.robot).filter(|_| stages.contains(&said.stage)) else {
            return false;
        };
        let luggage = Some(said.luggage);
        let (is_late, is_asked) = (member.late == luggage, member.asked == luggage);
        if !is_late && !is_asked {
            return false;
        }
        let took = now.since(if is_late { member.late_at } else { member.asked_at });
        self.answers_take = took.max(self.answers_take - self.answers_take / LATE_MEMORY);
        member.silent = 0;
        member.late.take_if(|_| is_late);
        is_late && is_asked && said.stage == LuggageStage::Release
    }

    /// Handles a call for help, or who follows it, about luggage of this master or of another one.
    pub(in crate::master) fn hear_situation(&mut self, situation: &CriticalSituation, sent: Time, is_own: bool) {
        let Some(job) = situation.job() else { return };
        let (robot, luggage) = match situation.stage {
            CriticalStage::Request => (situation.critical, None),
            CriticalStage::Taken => (situation.healer, Some(job.luggage)),
            CriticalStage::Intention | CriticalStage::Release | CriticalStage::StandsIn => return,
        };
        if let Some(member) = self.members.get_mut(&robot) {
            match is_own {
                true => (member.job, member.collected) = (luggage, true),
                false => member.elsewhere = luggage,
            }
            if is_own && luggage.is_some() {
                // Whatever it was asked before, this is its answer.
                (member.asked, member.withdrawn, member.handed_back, member.lapsed) = (None, None, 0, false);
                member.took_at = sent.max(member.took_at);
            }
            self.sort(robot);
        }
        if let Some(luggage) = luggage {
            self.unanswered.retain(|(other, of, _)| (*other, *of) != (robot, luggage));
        }
    }

    /// Handles where a robot is.
    pub(super) fn hear_position(&mut self, said: &Position, from: Option<Block>, now: Time) {
        let Some(member) = self.members.get_mut(&said.robot) else { return };
        self.changed |= member.hear(member.block != said.block);
        if member.block != said.block {
            let took = now.since(member.moved);
            if member.block.distance(said.block) == 1 && member.moved > Time::START && !took.is_zero() {
                self.step = Some(self.step.map_or(took, |step| step.min(took)));
            }
            (member.block, member.moved) = (said.block, now);
        }
        member.collected |= from == Some(said.block);
    }

    /// A robot says that it has luggage on a lease.
    pub(super) fn hear_lease(&mut self, robot: u32) {
        if let Some(member) = self.members.get_mut(&robot).filter(|member| member.lapsed) {
            (member.lapsed, self.changed) = (false, true);
            self.sort(robot);
        }
    }

    /// A robot was not heard for the time of the lease of this luggage, which is for others now.
    pub(super) fn lapse(&mut self, robot: u32, luggage: u32) {
        if let Some(member) = self.members.get_mut(&robot) {
            (member.lapsed, self.changed) = (true, true);
            member.job.take_if(|job| *job == luggage);
            member.withdrawn.take_if(|withdrawn| *withdrawn == luggage);
            self.sort(robot);
        }
    }

    /// Luggage is assigned to a robot.
    pub(in crate::master) fn ask(&mut self, robot: u32, luggage: u32, now: Time) {
        let answer = self.slowest().saturating_mul(ANSWER).max(self.answers_take.saturating_mul(2));
        if let Some(member) = self.members.get_mut(&robot) {
            (member.asked, member.asked_at) = (Some(luggage), now);
            member.until = now + answer.saturating_mul(1 << member.silent.min(DOUBLED));
            self.sort(robot);
        }
    }

    /// A robot is told to hand back its luggage.
    pub(super) fn withdraw(&mut self, robot: u32, luggage: u32) {
        if let Some(member) = self.members.get_mut(&robot).filter(|member| member.job == Some(luggage)) {
            member.withdrawn = Some(luggage);
        }
    }

    /// Robots that did not answer in time, with the luggage that was assigned to them. They are not asked again soon.
    /// For an answer to a visit the master waits for ever: the robot may have done it.
    pub(in crate::master) fn take_silent(&mut self, now: Time) -> Vec<(u32, u32)> {
        let rest = self.slowest().saturating_mul(8 * REST);
        let over = self.unanswered.extract_if(.., |(_, _, until)| *until <= now);
        let mut silent: Vec<(u32, u32)> = over.map(|(robot, luggage, _)| (robot, luggage)).collect();
        for robot in self.asked.iter().copied().collect::<Vec<_>>() {
            let is_late = |member: &&mut Member| member.until <= now && !member.asked.is_some_and(is_visit);
            if let Some(member) = self.members.get_mut(&robot).filter(is_late)
                && let Some(luggage) = member.asked.take()
            {
                member.until = now + rest.saturating_mul(1 << member.silent.saturating_sub(DOUBLED));
                member.until_with_news = now + rest;
                (member.late, member.late_at) = (Some(luggage), member.asked_at);
                member.silent = (member.silent + 1).min(MOST_DOUBLED);
                silent.push((robot, luggage));
                self.sort(robot);
            }
        }
        silent
    }

    /// Notes whether a robot can be asked.
    fn sort(&mut self, robot: u32) {
        let is_over = |member: &&Member| member.away && member.job.is_none() && member.asked.is_none();
        if self.members.get(&robot).filter(is_over).is_some() {
            self.members.remove(&robot);
        }
        let (is_free, is_asked) = self.members.get(&robot).map_or((false, false), |member| {
            let has_job = member.job.is_some() || member.asked.is_some();
            let works = has_job || member.engaged || member.elsewhere.is_some();
            let is_out = member.away || member.lapsed || member.is_deaf;
            (!(member.asleep || works || is_out), member.asked.is_some())
        });
        let note = |set: &mut BTreeSet<u32>, is_in: bool| {
            if is_in {
                set.insert(robot)
            } else {
                set.remove(&robot)
            };
        };
        note(&mut self.free, is_free);
        note(&mut self.asked, is_asked);
    }
}

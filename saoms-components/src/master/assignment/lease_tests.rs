//! A master, and robots of other programs that have luggage on leases, under anything that networks and programs do:
//! messages take any time, those of different topics overtake each other, and programs stop for any time anywhere. No
//! two robots ever collect a piece, and it is delivered once all run again.

use std::collections::VecDeque;
use std::time::Duration;

use saoms_api::host::FIRST_ELSEWHERE;
use saoms_api::{Cause, Chance, Header, Time};

use super::{AssignmentPolicy, MasterEnvironmentKnowledge};
use crate::grid::Block;
use crate::hardware::Action;
use crate::messages::{Assignment, CriticalKind, CriticalSituation, CriticalStage, Lease, LuggageStage, RobotList};
use crate::robot::{Job, Leased};

const LUGGAGE: u32 = 1;
const FROM: Block = Block::new(3, 1);
const TO: Block = Block::new(3, 9);
const JOB: Job = Job { luggage: LUGGAGE, from: FROM, to: TO };
/// The number of a robot that breaks with it.
const BROKEN: u32 = 9;

/// A robot, with what is on its way from it and to it.
#[derive(Default)]
struct Robot {
    number: u32,
    lease: Option<Leased>,
    /// True if it has looked whether it may collect the luggage, and is about to begin.
    begins: bool,
    carries: bool,
    said: VecDeque<Said>,
    /// The newest message of a state topic is enough.
    leased: Option<Lease>,
    told: VecDeque<Assignment>,
    requests: VecDeque<Request>,
}

/// What a robot says of the piece.
#[derive(Clone, Copy)]
enum Said {
    Stage(LuggageStage),
    /// That it takes it over from the broken robot.
    TakesOver,
}

/// How a robot that decides by itself hears of the piece.
#[derive(Clone, Copy)]
enum Request {
    Luggage,
    Help,
}

/// What the broken robot asks, or a robot with this number answers.
fn situation(stage: CriticalStage, healer: u32) -> CriticalSituation {
    let (critical, kind) = (BROKEN, CriticalKind::CarriesLuggage);
    CriticalSituation { critical, kind, luggage: LUGGAGE, block: FROM, to: TO, stage, healer, ..Default::default() }
}

struct Run {
    chance: Chance,
    now: Time,
    leases: u64,
    master: MasterEnvironmentKnowledge,
    robots: Vec<Robot>,
    policy: AssignmentPolicy,
    /// The robot that has collected the piece.
    collected: Option<u32>,
    delivered: bool,
}

impl Run {
    fn new(seed: u64, policy: AssignmentPolicy, first: Option<Request>) -> Run {
        let mut master = MasterEnvironmentKnowledge::new(policy);
        master.open.add(LUGGAGE, FROM, TO, Time::START);
        let robots = 1..=3;
        for robot in robots.clone() {
            let header = Header { sender: FIRST_ELSEWHERE + robot, sent: Time::START, cause: Cause::default() };
            let said = RobotList { robot, active: true, period: 100_000, ..RobotList::default() };
            master.hear_robot(&said, header);
        }
        let mut robots: Vec<Robot> = robots.map(|number| Robot { number, ..Robot::default() }).collect();
        if matches!(first, Some(Request::Help)) {
            master.open.hear_response(&JOB.response(BROKEN, FROM, LuggageStage::Taken));
            master.hear_situation(&situation(CriticalStage::Request, 0), Time::START);
        }
        robots.iter_mut().for_each(|robot| robot.requests.extend(first));
        let (now, chance) = (Time::START, Chance::for_component(seed, "lease"));
        Run { chance, now, leases: 0, master, robots, policy, collected: None, delivered: false }
    }

    fn draw(&mut self, below: usize) -> usize {
        usize::try_from(self.chance.below(below as u64)).unwrap()
    }

    /// One of the master's executions: it hears what has arrived, in any number.
    fn execute_master(&mut self, all: bool) {
        let elapsed = self.draw(4_000) as u64;
        self.now = self.now + Duration::from_millis(elapsed);
        let now = self.now;
        for place in 0..self.robots.len() {
            let most = self.robots[place].said.len();
            let count = if all { most } else { self.draw(most + 1) };
            for _ in 0..count {
                let number = self.robots[place].number;
                match self.robots[place].said.pop_front().unwrap() {
                    Said::Stage(stage) => self.master.hear_response(&JOB.response(number, FROM, stage), now, now),
                    Said::TakesOver => self.master.hear_situation(&situation(CriticalStage::Taken, number), now),
                }
            }
        }
        for place in 0..self.robots.len() {
            if all || self.draw(2) == 0 {
                let answer = self.robots[place].leased.take().and_then(|lease| self.master.hear_lease(&lease, now));
                self.robots[place].told.extend(answer);
            }
        }
        let lapsed = self.master.take_lapsed(now, Duration::ZERO);
        self.master.expire(now);
        for (lapsed, told) in lapsed {
            self.robots[place(lapsed.robot)].told.extend(told);
            self.request();
        }
        let again = !self.master.open.ask_again().is_empty();
        if self.policy == AssignmentPolicy::Robots
            && (again || self.draw(8) == 0 && !self.master.open.is_nothing_waiting())
        {
            self.request();
        }
        let free: Vec<u32> = self.master.crew.free(now).map(|member| member.robot).collect();
        if self.policy != AssignmentPolicy::Robots && !free.is_empty() && !self.master.open.is_nothing_waiting() {
            let robot = free[self.draw(free.len())];
            self.master.assign(robot, LUGGAGE, (FROM, TO), false);
        } else if self.draw(20) == 0
            && let Some(bearer) = self.master.open.bearer(LUGGAGE)
        {
            // It has a better robot for it.
            self.master.assign(bearer, LUGGAGE, (FROM, TO), true);
        }
        for assignment in std::mem::take(&mut self.master.assignments) {
            self.master.note_assigned(&assignment, now);
            self.robots[place(assignment.robot)].told.push_back(assignment);
        }
    }

    fn request(&mut self) {
        if self.policy == AssignmentPolicy::Robots {
            self.robots.iter_mut().for_each(|robot| robot.requests.push_back(Request::Luggage));
        }
    }

    /// A step of a robot: it may stop for any time after each.
    fn step(&mut self, place: usize) {
        let (is_done, choice, tires) = (self.delivered, self.draw(12), self.draw(4) == 0);
        let robot = &mut self.robots[place];
        let number = robot.number;
        if std::mem::take(&mut robot.begins) {
            assert_eq!(self.collected.replace(number), None, "robot {number} collects it, too");
            robot.carries = true;
            return;
        }
        match choice {
            0..=3 => {
                let Some(told) = robot.told.pop_front() else { return };
                let is_withdrawn = match (told.lease, &mut robot.lease) {
                    (0, _) => told.withdrawn,
                    (number, Some(lease)) => lease.answer(number, told.withdrawn),
                    _ => return,
                };
                if is_withdrawn && !robot.carries {
                    robot.lease = None;
                    robot.said.push_back(Said::Stage(LuggageStage::Release));
                } else if told.lease == 0 && !told.withdrawn && robot.lease.is_none() {
                    self.take(place, Request::Luggage);
                }
            }
            4 if robot.lease.is_none() => {
                // The robots decide by themselves, and have not heard of each other.
                if let Some(request) = robot.requests.pop_front().filter(|_| !is_done) {
                    self.take(place, request);
                }
            }
            5 | 6 if !robot.carries => {
                if let Some(lease) = &mut robot.lease {
                    lease.ask();
                    robot.leased = Some(lease.say(number));
                }
            }
            7 => {
                robot.leased =
                    robot.lease.filter(|_| !robot.carries).map(|lease| lease.say(number)).or(robot.leased.take())
            }
            8 if !robot.carries && tires => {
                if robot.lease.take().is_some() {
                    robot.said.push_back(Said::Stage(LuggageStage::Release));
                }
            }
            9 if robot.carries => {
                (robot.carries, robot.lease, self.delivered) = (false, None, true);
                robot.said.push_back(Said::Stage(LuggageStage::Delivered));
            }
            _ => {
                let collect = Action::collect(LUGGAGE, FROM);
                robot.begins = !robot.carries && robot.lease.is_some_and(|lease| !lease.forbids(collect));
            }
        }
    }

    fn take(&mut self, place: usize, request: Request) {
        self.leases += 1;
        let robot = &mut self.robots[place];
        let lease = Leased::of(LUGGAGE, self.leases);
        robot.said.push_back(match request {
            Request::Luggage => Said::Stage(LuggageStage::Taken),
            Request::Help => Said::TakesOver,
        });
        (robot.lease, robot.leased) = (Some(lease), Some(lease.say(robot.number)));
    }
}

fn place(robot: u32) -> usize {
    robot as usize - 1
}

#[track_caller]
fn no_piece_is_collected_twice(policy: AssignmentPolicy, first: Option<Request>) {
    for seed in 0..1_500 {
        let mut run = Run::new(seed, policy, first);
        // One that stops now and then: the others go on.
        let mut stopped = 0;
        for _ in 0..300 {
            if run.draw(20) == 0 {
                stopped = run.draw(5);
            }
            match run.draw(4) {
                step @ 0..=2 if step + 1 != stopped => run.step(step),
                3 if stopped != 4 => run.execute_master(false),
                _ => {}
            }
        }
        for _ in 0..3_000 {
            if run.delivered {
                break;
            }
            (0..3).for_each(|robot| run.step(robot));
            run.execute_master(true);
        }
        assert!(run.delivered, "with seed {seed}: {:?}", run.master.open.bearer(LUGGAGE));
    }
}

#[test]
fn no_piece_that_a_master_assigns_is_collected_twice() {
    no_piece_is_collected_twice(AssignmentPolicy::Oldest, None);
}

#[test]
fn no_piece_that_robots_take_by_themselves_is_collected_twice() {
    no_piece_is_collected_twice(AssignmentPolicy::Robots, Some(Request::Luggage));
}

#[test]
fn no_piece_that_robots_take_over_from_a_broken_one_is_collected_twice() {
    for policy in [AssignmentPolicy::Robots, AssignmentPolicy::Oldest] {
        no_piece_is_collected_twice(policy, Some(Request::Help));
    }
}

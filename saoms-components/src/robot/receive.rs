//! Messages that robots receive from other robots, after validation.

use saoms_api::{Context, Failure, Header, Region, Subscription, record, warn};

use super::{ASSISTANCE, Lists, Policy, RobotKnowledge};
use crate::grid::Block;
use crate::messages::{
    ASSIGNMENT, Assignment, EVENT_LUGGAGE, EventLuggage, FAULT, Fault, FaultKind, IMMOVABLE, LuggageStage, POSITION,
    Position, REMOVAL, ROBOT_LIST, Removal, RobotList, VISIT, Visit, is_visit,
};
use crate::validation::Validate;

/// Least distance within which a robot hears of other robots and of luggage, in blocks. Right of way needs three; the
/// more it hears, the farther ahead it drives around robots that cannot move, and the better it knows which chargers
/// are free.
const HEARING: u32 = 8;

/// Number of blocks that a robot drives before its region of hearing follows.
const SLACK: u32 = 2;

/// Number of blocks of a map up to which a robot hears all: a region costs more than it saves there.
pub(crate) const HEARD: usize = 82 * 82;

/// The topics that a robot hears by itself.
#[derive(Debug, Default)]
pub(super) struct Topics {
    robots: Subscription<RobotList>,
    luggage: Subscription<EventLuggage>,
    visits: Subscription<Visit>,
    positions: Subscription<Position>,
    faults: Subscription<Fault>,
    removals: Subscription<Removal>,
    assignments: Subscription<Assignment>,
    /// The block of the charger for which assignments are heard; `None` while it is for all.
    hears_for: Option<Block>,
    /// The middle of the region that is heard; `None` while it is the whole map.
    hears_around: Option<Block>,
}

impl Topics {
    pub(super) fn subscribe(context: &mut Context<'_>) -> Result<Topics, Failure> {
        Ok(Topics {
            robots: context.subscribe(&ROBOT_LIST)?,
            luggage: context.subscribe(&EVENT_LUGGAGE)?,
            visits: context.subscribe(&VISIT)?,
            positions: context.subscribe(&POSITION)?,
            faults: context.subscribe(&FAULT)?,
            removals: context.subscribe(&REMOVAL)?,
            assignments: context.subscribe(&ASSIGNMENT)?,
            hears_for: None,
            hears_around: None,
        })
    }

    /// Hears what is said around the robot alone, so that it does not grow with the fleet; before it has entered the
    /// floor, around where it starts.
    pub(super) fn hear_around(&mut self, robot: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let Block { x, y } = robot.block;
        let is_near = self.hears_around.is_some_and(|middle: Block| middle.distance(robot.block) <= SLACK);
        let is_home = self.hears_for == Some(robot.charge_block);
        if is_near && is_home
            || robot.policy != Policy::Safe
            || robot.routes.map().map_or(robot.hardware.is_wired(), |map| map.size() <= HEARD)
        {
            return Ok(());
        }
        if !is_home {
            let Block { x, y } = robot.charge_block;
            self.hears_for = Some(robot.charge_block);
            context.set_region(&self.assignments, Some(Region::around((x, y), 0)))?;
        }
        if is_near {
            return Ok(());
        }
        self.hears_around = Some(robot.block);
        let region = Region::around((x, y), HEARING + SLACK);
        context.set_region(&self.positions, Some(region))?;
        context.set_region(&self.robots, Some(region))?;
        context.set_region(&self.luggage, Some(region))?;
        robot.validator.hear_a_part();
        robot.lists.requests.keep(|from| region.contains((from.x, from.y)));
        Ok(())
    }
}

impl RobotKnowledge {
    /// True if the message is possible and sent by the robot that it names. Rejected messages are logged.
    pub(super) fn accepts<M: Validate>(&mut self, message: &M, header: Header, context: &mut Context<'_>) -> bool {
        self.validator.accepts(message, header, self.routes.map(), context)
    }

    /// Handles what other robots said about themselves, and what was said about luggage. All loops rely on it, so that
    /// the robot hears it by itself.
    ///
    /// # Errors
    /// The region in which positions are heard cannot be set.
    pub(super) fn hear(&mut self, topics: &mut Topics, context: &mut Context<'_>) -> Result<(), Failure> {
        topics.hear_around(self, context)?;
        self.hear_robots(topics.robots, context);
        self.hear_visits(topics.visits, context);
        self.hear_luggage(topics.luggage, context);
        self.hear_positions(topics.positions, context);
        if self.policy == Policy::Safe {
            self.hear_assignments(topics.assignments, context);
            self.learn_obstacles();
        }
        Ok(())
    }

    /// Hears which robots are out without having said so: somebody took them off the floor, or their component failed.
    /// `None` if this one is off the floor, and has nothing to do any more; else the others that are.
    pub(super) fn hear_gone(&mut self, topics: &Topics, context: &mut Context<'_>) -> Option<Vec<u32>> {
        let began = *self.began.get_or_insert(context.due());
        let mut others = Vec::new();
        for (header, removal) in context.receive(&topics.removals).with_headers() {
            // A master passes on what a world says here, and may be out.
            if let Some(fault) = removal.fault().filter(Fault::is_failure)
                && self.accepts(removal, header, context)
            {
                self.hear_failure(&fault, header);
            }
        }
        for (header, fault) in context.receive(&topics.faults).with_headers() {
            if !fault.silences() || !self.accepts(fault, header, context) {
                continue;
            }
            if fault.is_failure() {
                self.hear_failure(fault, header);
            } else if fault.robot != self.number {
                self.lists.gone.note(fault, header);
                others.push(fault.robot);
            } else if fault.since.unwrap_or(header.sent) > began {
                context.because(header.cause);
                return None;
            }
        }
        Some(others)
    }

    /// The component of a robot failed: the robot stands where it is, and what it had in mind does not count any more.
    fn hear_failure(&mut self, fault: &Fault, header: Header) {
        let robot = fault.robot;
        if robot == self.number {
            // It has begun anew, and the others do not know yet.
            (self.says_again, self.lists.is_doubted) = (true, true);
            return;
        }
        self.lists.gone.note(fault, header);
        self.routes.note_failure(robot, fault.kind == FaultKind::Restarting);
        self.lists.end_of(robot);
    }

    /// Forgets robots that are off the floor, after all that they said before has been heard.
    pub(super) fn forget_gone(&mut self, robots: &[u32]) {
        for robot in robots {
            self.lists.forget(*robot);
            self.routes.forget_obstacle(*robot);
        }
    }

    /// Ends the robot, which is off the floor: others carry its luggage, and it starts again at its charger.
    pub(super) fn leave_floor(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let name = &self.name;
        context.console(format_args!("{name} is gone"));
        context.effect(record!(leaves_floor: "is gone from {block}, and stops", block = self.block));
        warn!(context, "is gone from {}: it stops until it is started again", self.block);
        context.alert_over(ASSISTANCE, "");
        self.end_open_action(context);
        let before = self.noted();
        self.drop_job();
        self.note_changes(context, before);
        self.offers_help = false;
        self.gone = true;
        context.unschedule()
    }

    /// Handles the positions of other robots.
    fn hear_positions(&mut self, positions: Subscription<Position>, context: &mut Context<'_>) {
        for departed in context.departed(&positions) {
            let robot = u32::try_from(departed.key).ok();
            robot.into_iter().for_each(|robot| self.lists.peers.forget(robot));
        }
        let RobotKnowledge { validator, lists, routes, .. } = self;
        let heard = context.receive(&positions).with_headers();
        let sound = heard.filter(|(header, position)| validator.accepts(*position, *header, routes.map(), context));
        let Lists { peers, gone, .. } = lists;
        let sound = sound.filter(|(_, position)| !gone.contains(position.robot));
        peers.hear(sound.map(|(header, position)| (position, header.sent)));
        for (robot, block, since) in gone.failed() {
            if peers.stop(robot, block, since) && self.policy == Policy::Safe {
                lists.lost.push(robot);
            }
        }
    }

    /// Handles the states of other robots.
    fn hear_robots(&mut self, robots: Subscription<RobotList>, context: &mut Context<'_>) {
        for departed in context.departed(&robots) {
            let robot = u32::try_from(departed.key).ok().filter(|robot| *robot != self.number);
            if let Some(robot) = robot {
                self.lists.lose(robot);
                self.validator.forget_speaker(robot);
            }
        }
        for (header, robot) in context.receive(&robots).with_headers() {
            if self.accepts(robot, header, context) && self.lists.gone.hears(robot, header) {
                self.lists.hear_robot(robot);
                self.routes.learn_charger(robot.charger);
                if self.policy == Policy::Safe && robot.robot != self.number {
                    self.learn_lost(robot);
                }
            }
        }
    }

    /// Learns that a robot cannot move any more, or that it can.
    fn learn_lost(&mut self, robot: &RobotList) {
        self.lists.lost.retain(|lost| *lost != robot.robot);
        if robot.active {
            self.routes.forget_obstacle(robot.robot);
        } else {
            self.lists.lost.push(robot.robot);
        }
    }

    /// Records the positions of robots that cannot move any more as obstacles.
    fn learn_obstacles(&mut self) {
        let RobotKnowledge { lists, routes, .. } = self;
        lists.lost.retain(|robot| {
            let peer = lists.peers.get(*robot).filter(|peer| peer.priority == IMMOVABLE);
            if let Some(peer) = peer {
                // One that failed on its way may be on any of these.
                routes.learn_obstacle(*robot, [peer.block, peer.next, peer.wanted]);
            }
            peer.is_none()
        });
    }

    /// Handles which blocks are to be visited.
    fn hear_visits(&mut self, visits: Subscription<Visit>, context: &mut Context<'_>) {
        for (header, visit) in context.receive(&visits).with_headers() {
            if self.policy == Policy::Safe && self.accepts(visit, header, context) {
                self.lists.requests.hear_visit(visit);
            }
        }
    }

    /// Handles what a master assigned to this robot.
    fn hear_assignments(&mut self, assignments: Subscription<Assignment>, context: &mut Context<'_>) {
        for (header, assignment) in context.receive(&assignments).with_headers() {
            if assignment.robot == self.number && self.accepts(assignment, header, context) {
                match assignment.lease {
                    0 => self.lists.requests.hear_assignment(assignment, header),
                    _ => self.hear_lease(assignment, header),
                }
            }
        }
    }

    /// Handles messages about luggage.
    fn hear_luggage(&mut self, luggage: Subscription<EventLuggage>, context: &mut Context<'_>) {
        for (header, event) in context.receive(&luggage).with_headers() {
            // The manual's rules know no blocks to visit.
            let is_for_policy = !is_visit(event.luggage) || self.policy == Policy::Safe;
            // What a robot was interested in before it failed.
            let is_over = event.stage == LuggageStage::Interest && self.lists.gone.is_over(event.robot, header);
            if self.accepts(event, header, context) && is_for_policy && !is_over {
                self.lists.requests.hear(event, header);
            }
        }
        self.lists.requests.forget_silent(context.now());
    }
}

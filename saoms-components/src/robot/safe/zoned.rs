//! What a robot asks of the zones of its site.

use saoms_api::{Context, Failure, info};

use super::leg::{Leg, Urgency};
use crate::grid::Block;
use crate::hardware::{Action, ActionKind};
use crate::messages::{IMMOVABLE, Position, Standing};
use crate::robot::hardware_client::Reply;
use crate::robot::{ASSISTANCE, RobotKnowledge};
use crate::zone::Wish;

/// Number of executions after which a robot repeats its state for the first time.
const REPEAT_STATE: u64 = 50;

/// Maximum number of blocks ahead that a robot needs because zones answer late.
const MOST_BY_LATENCY: u32 = 8;

impl RobotKnowledge {
    /// Takes in what zones say.
    pub(in crate::robot) fn hear_zones(&mut self, context: &mut Context<'_>) {
        let RobotKnowledge { zones: Some(zones), routes, hardware, number, block, .. } = self else { return };
        zones.stand(context, *number, *block);
        if zones.hear(context, routes.map()) {
            let begun = if hardware.is_moving() { 2 } else { 1 };
            zones.turn(begun, |from, to| routes.between(from, to));
        }
    }

    /// True if the robot is not on the floor, and waits until it may enter it.
    pub(in crate::robot) fn waits_to_enter(&self) -> bool {
        self.zones.as_ref().is_some_and(|zones| zones.waits_to_enter())
    }

    /// Asks the zones of the site for the block where the robot starts, unless it stands on the floor already. False
    /// while it has to wait.
    ///
    /// # Errors
    /// The messages cannot be sent, or the hardware cannot be asked.
    pub(in crate::robot) fn may_enter(&mut self, context: &mut Context<'_>) -> Result<bool, Failure> {
        let Some(zones) = &mut self.zones else { return Ok(true) };
        if zones.is_new() {
            let start = self.block;
            // The hardware tells what is wrong with a start outside of the map.
            let is_free = self.routes.map().is_none_or(|map| map.contains(start) && map.is_free(start));
            match self.hardware.is_on_floor(context, self.number)? {
                Reply::Later => {}
                Reply::Answer(is_on_floor) if is_on_floor || !is_free => return Ok(true),
                Reply::Answer(_) => zones.wait_to_enter(context, self.number, start),
            }
            // That is in `initialize`, as a rule, where zones have not spoken yet.
            return Ok(false);
        }
        if !zones.waits_to_enter() {
            return Ok(true);
        }
        zones.hear(context, self.routes.map());
        if !zones.waits_to_enter() {
            context.alert_over(ASSISTANCE, "");
            return Ok(true);
        }
        match zones.waits_in_vain() {
            None => {}
            Some(Some(other)) => context.alert(
                ASSISTANCE,
                "",
                format_args!(
                    "waits to enter the floor at {}, where robot {other} is: send that one elsewhere",
                    self.block
                ),
            ),
            Some(None) => info!(context, "waits to enter the floor at {}, until a zone grants it", self.block),
        }
        let wish = Wish { charger: self.charge_block, standing: Standing::Enters, ..Wish::default() };
        zones.ask(context, wish)?;
        Ok(false)
    }

    /// Sends what zones have to know.
    ///
    /// # Errors
    /// The messages cannot be sent.
    pub(in crate::robot) fn ask_zones(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if self.zones.is_none() {
            return Ok(());
        }
        self.aim_in_zones();
        let begun = self.begun_blocks();
        let ahead = self.blocks_ahead();
        let aside = self.aside_over_edge();
        let wish = Wish {
            goal: self.goal_in_zones(),
            charger: self.charge_block,
            rank: self.rank(),
            standing: self.standing(),
            ahead,
            aside,
        };
        let Some(zones) = &mut self.zones else { return Ok(()) };
        if wish.standing != Standing::MakesWay {
            zones.stay(begun);
        }
        zones.ask(context, wish)
    }

    /// Tells zones that the robot cannot move any more, or is off the floor.
    ///
    /// # Errors
    /// The messages cannot be sent.
    pub(in crate::robot) fn leave_zones(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let (charger, begun) = (self.charge_block, self.begun_blocks());
        let Some(zones) = &mut self.zones else { return Ok(()) };
        if self.gone || zones.waits_to_enter() {
            return zones.leave_floor(context, charger);
        }
        zones.leave(begun);
        zones.ask(context, Wish { goal: None, charger, rank: 0, standing: Standing::Lost, ahead: 0, aside: None })
    }

    /// Repeats where the robot is and what it does, each time after twice as long while that stays the same: on a
    /// network where updates get lost, others may know an older state.
    ///
    /// # Errors
    /// The messages cannot be sent.
    pub(in crate::robot) fn repeat_state(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let is_due = (context.execution() + u64::from(self.number)).is_multiple_of(REPEAT_STATE);
        if self.zones.is_none() || !is_due {
            return Ok(());
        }
        let stands = self.standing() != Standing::MakesWay;
        let priority = if stands { IMMOVABLE } else { self.leg.priority(self.number) };
        let position = Position { priority, ..self.position() };
        let robot = self.robot(!(self.variables.critical || self.shut_down));
        let Some(zones) = &mut self.zones else { return Ok(()) };
        zones.repeat_presence(context)?;
        zones.repeat_state(position, robot, context)
    }

    /// Releases blocks ahead that do not lead where the robot wants to go now.
    pub(super) fn aim_in_zones(&mut self) {
        let (goal, begun) = (self.goal_in_zones(), self.begun_blocks());
        let stays = self.standing() == Standing::Stays;
        let RobotKnowledge { zones, routes, .. } = self;
        if let Some(zones) = zones {
            if stays {
                zones.stay(begun);
            }
            zones.aim(goal, begun, |from, to| routes.between(from, to));
        }
    }

    /// True if the action is a move to a block that no zone granted yet. The robot then asks for it.
    pub(in crate::robot) fn waits_for_grant(&mut self, action: Action) -> bool {
        let Some(zones) = self.zones.as_mut().filter(|_| action.kind == ActionKind::Move) else { return false };
        let waits = zones.next() != Some(action.block);
        zones.asked = Some(action.block).filter(|_| waits);
        waits
    }

    /// True if the robot waits for a zone that is out of reach, and not for other robots.
    pub(super) fn is_cut_off(&self) -> bool {
        self.zones.as_ref().is_some_and(|zones| zones.is_cut_off())
    }

    /// Number of blocks that have to be granted ahead: as many as it drives until it has an answer. With more, also on
    /// the way to its charger, others would wait for blocks long before the robot comes to them.
    fn blocks_ahead(&self) -> u32 {
        let latency = self.zones.as_ref().map_or(0, |zones| zones.latency());
        latency.div_ceil(self.energy.executions_of_move().max(1)).min(MOST_BY_LATENCY)
    }

    /// Number of blocks of its passage that it is on, or has begun to enter.
    fn begun_blocks(&self) -> usize {
        if self.hardware.is_moving() { 2 } else { 1 }
    }

    /// Where it wants to go; `None` if it wants to stay.
    fn goal_in_zones(&mut self) -> Option<Block> {
        let stays = self.is_bound() || self.job_here().is_some() || self.holds_charger();
        let asked = self.zones.as_ref().and_then(|zones| zones.asked);
        asked.or_else(|| self.leg.goal.filter(|_| self.leg.urgency != Urgency::None)).filter(|_| !stays)
    }

    /// A block of another zone to which a zone lets the robot make way, and the rank with which it does.
    fn aside_over_edge(&mut self) -> Option<(Block, u64)> {
        let own = self.leg.priority(self.number).rank;
        let makes_way = self.standing() == Standing::MakesWay;
        let zones = self.zones.as_ref().filter(|_| makes_way)?;
        zones.aside().map(|(block, rank)| (block, rank.max(own)))
    }

    /// Rank of its way. One that charges at its charger, and is not well charged yet, has that of the oldest way to a
    /// charger: if others on their way home, or to their chargers, sent it away, it would come back, and push them away
    /// in its turn, and nobody would be charged. One that is well charged, but not enough for what waits for it, has
    /// that of the oldest way home.
    fn rank(&self) -> u64 {
        let rests = self.leg.urgency == Urgency::None;
        let charges = rests && self.charging && self.is_at_charger() && !self.energy.gives_nothing;
        let leg = match charges {
            true if !self.is_well_charged() => Leg::OLDEST_TO_CHARGER,
            true if !self.has_enough() => Leg::OLDEST_HOME,
            _ => self.leg,
        };
        leg.priority(self.number).rank
    }

    fn standing(&mut self) -> Standing {
        if self.shut_down || self.variables.critical || self.trouble.is_some() {
            Standing::Lost
        } else if self.is_bound() || self.job_here().is_some() || self.holds_charger() {
            Standing::Stays
        } else {
            Standing::MakesWay
        }
    }
}

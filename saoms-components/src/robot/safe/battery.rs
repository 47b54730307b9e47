use saoms_api::{Cause, Context, Failure, Level, Loop, LoopClass, Record, Recordable, record};

use crate::grid::{Block, UNREACHABLE};
use crate::robot::{RobotKnowledge, Trouble};

/// Uses the battery, and turns back to the charger in time.
///
/// It knows how many executions the battery lasts, and how many the way to the charger takes with what is kept back for waiting and making
/// way. What a robot finishes before its battery is that low, it finishes.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.BatteryMS",
    knowledge = RobotKnowledge,
    senses("block", "next", "job", "chargeAt"),
    effects("battery", "inCharge", "chargeBlock")
)]
pub struct BatteryMS {
    charging: bool,
    /// Whether the robot is in charge, as the others learn once the loop has decided.
    in_charge: bool,
    /// How often other ways had become necessary when it looked at the way to its charger.
    changes: u32,
    /// Why it went to its charger: what becomes of it on the way follows from that.
    turned: Cause,
    /// Its own charger, while it charges at another one.
    own: Option<Block>,
}

/// What the battery allows now.
#[derive(Clone, Copy, Debug)]
pub enum BatterySymptom {
    /// It is as far down as the way to the charger allows.
    Low {
        /// What is left, in percent.
        battery: f64,
        /// For how many executions that is.
        left: u32,
        /// How many the way to the charger takes.
        home: u32,
    },
    /// It is empty, with no charger there.
    Empty,
    /// No way leads to the charger any more, and another one can be reached.
    CutOff {
        /// The charger.
        charger: Block,
        /// The other one.
        other: Block,
    },
    /// The battery does not last for the way to the charger any more, and a free one is closer.
    OutOfReach {
        /// The charger.
        charger: Block,
        /// The other one.
        other: Block,
    },
    /// At the charger it holds enough for what the robot has to do.
    Charged {
        /// What is in it, in percent.
        battery: f64,
    },
    /// The robot begins to be in charge, or no longer is.
    Charge {
        /// Whether it is.
        begins: bool,
        /// What is in it, in percent.
        battery: f64,
    },
}

/// What to do about it.
#[derive(Clone, Copy, Debug)]
pub enum BatteryDecision {
    /// Go to the charger, whatever the job.
    Charge,
    /// Stay where the robot is, and say so.
    Stop,
    /// Leave the charger.
    Leave,
    /// Charge at another charger from now on.
    Use(Block),
    /// Charge at another charger this time.
    Borrow(Block),
    /// Be in charge, or no longer.
    BeInCharge(bool),
}

impl Recordable for BatterySymptom {
    fn record(&self) -> Record {
        match *self {
            BatterySymptom::Low { battery, left, home } => record!(
                "has {battery} % left: enough for {left} executions, and the way to its charger takes {home}",
                battery,
                left,
                home
            ),
            BatterySymptom::Empty => record!("has an empty battery"),
            BatterySymptom::OutOfReach { charger, other } => record!(
                "its charger at {charger} is out of reach by now, and the one at {other} is free",
                charger,
                other
            ),
            BatterySymptom::CutOff { charger, other } => {
                record!(
                    "no way leads to its charger at {charger} any more, but one to {other}",
                    charger,
                    other
                )
            }
            BatterySymptom::Charged { battery } => record!("has charged up to {battery} %", battery),
            BatterySymptom::Charge { begins: true, battery } => {
                record!("is at its charger with {battery} %", battery)
            }
            BatterySymptom::Charge { begins: false, battery } => {
                record!("gains nothing from its charger any more, with {battery} %", battery)
            }
        }
    }
}

impl Recordable for BatteryDecision {
    fn record(&self) -> Record {
        match *self {
            BatteryDecision::Charge => record!("goes to its charger"),
            BatteryDecision::Stop => record!("stays where it is"),
            BatteryDecision::Leave => record!("has enough for what it has to do"),
            BatteryDecision::Use(other) => record!("charges at {other} from now on", other),
            BatteryDecision::Borrow(other) => record!("charges at {other} this time", other),
            BatteryDecision::BeInCharge(true) => record!("is in charge"),
            BatteryDecision::BeInCharge(false) => record!("is in charge no more"),
        }
    }
}

impl Loop for BatteryMS {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = BatterySymptom;
    type Decision = BatteryDecision;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(BatteryMS::default())
    }

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        if knowledge.hooks.has_entered() {
            self.use_battery(knowledge, context);
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<BatterySymptom>, Failure> {
        if knowledge.trouble.is_some() {
            return Ok(None);
        }
        knowledge.energy.pace().note_action(knowledge.polled);
        let changes = knowledge.routes.changes();
        if std::mem::replace(&mut self.changes, changes) != changes
            && let Some(other) = knowledge.other_charger()
        {
            let charger = knowledge.charge_block;
            return Ok(Some(BatterySymptom::CutOff { charger, other }));
        }
        let battery = knowledge.battery.percent();
        let must_charge = knowledge.energy.must_charge();
        let symptom = if knowledge.is_at_charger() {
            let lasts = self.own.is_none_or(|own| knowledge.lasts_to(own));
            (must_charge && lasts && knowledge.may_leave()).then_some(BatterySymptom::Charged { battery })
        } else if knowledge.battery.is_empty() {
            context.because(self.turned);
            Some(BatterySymptom::Empty)
        } else if must_charge {
            let charger = knowledge.charge_block;
            let other = knowledge.charger_in_reach();
            other.map(|other| {
                context.because(self.turned);
                BatterySymptom::OutOfReach { charger, other }
            })
        } else if knowledge.goes_on() {
            None
        } else {
            let (left, home) = (knowledge.battery.executions_left(), knowledge.home(knowledge.next));
            Some(BatterySymptom::Low { battery, left, home })
        };
        let begins = self.in_charge;
        let changes = knowledge.variables.in_charge != begins;
        Ok(symptom.or(changes.then_some(BatterySymptom::Charge { begins, battery })))
    }

    fn plan(
        &mut self,
        symptom: BatterySymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<BatteryDecision>, Failure> {
        Ok(Some(match symptom {
            BatterySymptom::Low { .. } => BatteryDecision::Charge,
            BatterySymptom::Empty => BatteryDecision::Stop,
            BatterySymptom::Charged { .. } => BatteryDecision::Leave,
            BatterySymptom::CutOff { other, .. } => BatteryDecision::Use(other),
            BatterySymptom::OutOfReach { other, .. } => BatteryDecision::Borrow(other),
            BatterySymptom::Charge { begins, .. } => BatteryDecision::BeInCharge(begins),
        }))
    }

    fn execute(
        &mut self,
        decision: BatteryDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        // Whatever else there is to decide, so that the journal has it.
        knowledge.variables.in_charge = self.in_charge;
        match decision {
            BatteryDecision::BeInCharge(_) => {}
            BatteryDecision::Charge => {
                self.turned = context.cause();
                knowledge.energy.turn_back();
                let (name, battery) = (&knowledge.name, &knowledge.battery);
                context.console(format_args!("{name} has low battery and is going under charge..."));
                context.info(format_args!("has low battery ({battery} %): goes to charge"));
            }
            BatteryDecision::Stop => {
                knowledge.trouble = Some(Trouble::Battery);
                context.count("stranded", 1);
                let block = knowledge.block;
                context.log(Level::Error, format_args!("is stranded at {block}: its battery is empty"));
            }
            BatteryDecision::Leave => {
                knowledge.energy.may_go();
                if let Some(own) = self.own.take().filter(|own| !knowledge.routes.is_obstacle(*own)) {
                    knowledge.use_charger(own);
                }
            }
            BatteryDecision::Use(other) => {
                self.own = None;
                knowledge.use_charger(other);
                context.info(format_args!("charges at {other} from now on"));
            }
            BatteryDecision::Borrow(other) => {
                self.own = self.own.or(Some(knowledge.charge_block));
                knowledge.use_charger(other);
                context.info(format_args!("charges at {other} this time: its own is out of reach"));
            }
        }
        Ok(())
    }
}

impl RobotKnowledge {
    /// Charges at this charger from now on.
    pub(in crate::robot) fn use_charger(&mut self, charger: Block) {
        self.charge_block = charger;
        let others = self.lists.chargers.iter().map(|(_, charger)| *charger);
        self.routes.use_charger(charger, others);
    }

    /// Where the battery does not last for the way to the charger any more: the closest other one that is closer and that nobody holds.
    fn charger_in_reach(&mut self) -> Option<Block> {
        let home = self.home(self.next);
        if self.battery.executions_left() > home || self.next != self.block {
            return None;
        }
        let RobotKnowledge { lists, routes, next, .. } = self;
        let is_free = |charger: &Block| !routes.is_obstacle(*charger) && lists.peers.on(*charger).is_none();
        let free: Vec<Block> = lists.charging_places.iter().copied().filter(is_free).collect();
        let ways = free.into_iter().map(|charger| (routes.between(*next, charger), charger));
        let (_, closest) = ways.min()?;
        (self.home_to(closest) < home).then_some(closest)
    }

    /// Another charger, where no way leads to the own one any more: the closest of those that nobody uses any more, else the closest at all, where
    /// robots charge one after the other.
    fn other_charger(&mut self) -> Option<Block> {
        if self.routes.between(self.next, self.charge_block) != UNREACHABLE
            && !self.routes.is_obstacle(self.charge_block)
        {
            return None;
        }
        let RobotKnowledge { lists, routes, next, .. } = self;
        let chargers = lists.chargers.iter().filter(|(_, charger)| !routes.is_obstacle(*charger));
        let chargers: Vec<(bool, Block)> =
            chargers.map(|(robot, charger)| (lists.is_active(*robot), *charger)).collect();
        let ways =
            chargers.into_iter().map(|(used, charger)| (used, routes.between(*next, charger), charger));
        ways.filter(|(_, way, _)| *way != UNREACHABLE).min().map(|(_, _, charger)| charger)
    }
}

impl BatteryMS {
    /// Takes what an execution needs, or gives what it gains.
    fn use_battery(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) {
        if !knowledge.is_at_charger() {
            (self.charging, self.in_charge) = (false, false);
            return knowledge.use_battery();
        }
        let charging = !knowledge.battery.is_full();
        let charged = std::mem::replace(&mut self.charging, charging);
        if charging && !charged {
            context.info(format_args!("charges (battery {} %)", knowledge.battery));
        }
        if charging {
            knowledge.charge_battery();
        } else if charged {
            context.info(format_args!("is fully charged"));
        }
        self.in_charge = charging || knowledge.variables.asleep;
    }
}

use saoms_api::{Context, Failure, Level, Loop, LoopClass, Record, Recordable, record};

use crate::robot::{RobotKnowledge, Trouble};

/// Uses the battery, and turns back to the charger in time.
///
/// It knows how many executions the battery lasts, and how many the way to the charger takes with what is kept back for waiting and making
/// way. What a robot finishes before its battery is that low, it finishes.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.BatteryMS",
    knowledge = RobotKnowledge,
    senses("block", "next", "chargeBlock", "job"),
    effects("battery", "inCharge")
)]
pub struct BatteryMS {
    charging: bool,
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
    /// At the charger it holds enough for what the robot has to do.
    Charged {
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
            BatterySymptom::Charged { battery } => record!("has charged up to {battery} %", battery),
        }
    }
}

impl Recordable for BatteryDecision {
    fn record(&self) -> Record {
        match self {
            BatteryDecision::Charge => record!("goes to its charger"),
            BatteryDecision::Stop => record!("stays where it is"),
            BatteryDecision::Leave => record!("has enough for what it has to do"),
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
        _context: &mut Context<'_>,
    ) -> Result<Option<BatterySymptom>, Failure> {
        if knowledge.trouble.is_some() {
            return Ok(None);
        }
        knowledge.energy.pace().note_action(knowledge.polled);
        let battery = knowledge.battery.percent();
        let must_charge = knowledge.energy.must_charge();
        Ok(if knowledge.is_at_charger() {
            (must_charge && knowledge.may_leave()).then_some(BatterySymptom::Charged { battery })
        } else if knowledge.battery.is_empty() {
            Some(BatterySymptom::Empty)
        } else if must_charge || knowledge.goes_on() {
            None
        } else {
            let (left, home) = (knowledge.battery.executions_left(), knowledge.home(knowledge.next));
            Some(BatterySymptom::Low { battery, left, home })
        })
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
        }))
    }

    fn execute(
        &mut self,
        decision: BatteryDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        match decision {
            BatteryDecision::Charge => {
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
            BatteryDecision::Leave => knowledge.energy.may_go(),
        }
        Ok(())
    }
}

impl BatteryMS {
    /// Takes what an execution needs, or gives what it gains.
    fn use_battery(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) {
        if !knowledge.is_at_charger() {
            self.charging = false;
            knowledge.variables.in_charge = false;
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
        knowledge.variables.in_charge = charging || knowledge.variables.asleep;
    }
}

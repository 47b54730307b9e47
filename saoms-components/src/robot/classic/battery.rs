use saoms_api::{Context, Failure, Loop, LoopClass, Record, Recordable, record};

use crate::robot::RobotKnowledge;

/// The battery level at which a robot has to charge, in percent.
const LOW: f64 = 35.0;

/// Uses the battery, and goes under charge when it is low.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.classic.BatteryMS",
    knowledge = RobotKnowledge,
    senses("block", "chargeBlock", "chargeAt"),
    effects("battery", "inCharge", "busy", "asleep", "readyToGoUnderCharge")
)]
pub struct BatteryMS;

/// How the battery stands.
#[derive(Clone, Copy, Debug)]
pub enum BatterySymptom {
    /// It is low, in percent.
    Low(f64),
    /// It is charged.
    Full,
}

/// What to do about it.
#[derive(Clone, Copy, Debug)]
pub enum BatteryDecision {
    /// Go under charge after the present job.
    Charge,
    /// Sleep until the robot is awaked or heals another one.
    Sleep,
}

impl Recordable for BatterySymptom {
    fn record(&self) -> Record {
        match *self {
            BatterySymptom::Low(battery) => record!("has low battery: {battery} %", battery),
            BatterySymptom::Full => record!("is fully charged"),
        }
    }
}

impl Recordable for BatteryDecision {
    fn record(&self) -> Record {
        match self {
            BatteryDecision::Charge => record!("goes under charge after its job"),
            BatteryDecision::Sleep => record!("sleeps until it is awaked or heals a robot"),
        }
    }
}

impl Loop for BatteryMS {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = BatterySymptom;
    type Decision = BatteryDecision;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(BatteryMS)
    }

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, _context: &mut Context<'_>) -> Result<(), Failure> {
        if knowledge.variables.in_charge {
            knowledge.variables.busy |= !knowledge.battery.is_full();
            knowledge.charge_battery();
        } else if knowledge.block != knowledge.charge_block {
            knowledge.use_battery();
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<BatterySymptom>, Failure> {
        let (variables, battery) = (&knowledge.variables, &knowledge.battery);
        if !variables.in_charge {
            let low = battery.percent() <= LOW.max(knowledge.charge_at)
                && knowledge.block != knowledge.charge_block;
            let news = low && !variables.ready_to_go_under_charge && !variables.healer;
            return Ok(news.then(|| BatterySymptom::Low(battery.percent())));
        }
        if !battery.is_full() {
            return Ok(None);
        }
        // As in figures 8.7 and 8.16 in each execution until it is awake.
        let name = &knowledge.name;
        context.console(format_args!("{name} is now fully charged and ready (but still asleep)"));
        Ok((variables.busy && !variables.healer).then_some(BatterySymptom::Full))
    }

    fn plan(
        &mut self,
        symptom: BatterySymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<BatteryDecision>, Failure> {
        Ok(Some(match symptom {
            BatterySymptom::Low(_) => BatteryDecision::Charge,
            BatterySymptom::Full => BatteryDecision::Sleep,
        }))
    }

    fn execute(
        &mut self,
        decision: BatteryDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let variables = &mut knowledge.variables;
        match decision {
            BatteryDecision::Charge => {
                variables.ready_to_go_under_charge = true;
                let battery = &knowledge.battery;
                context.info(format_args!("has low battery ({battery} %): charges after its job"));
            }
            BatteryDecision::Sleep => variables.busy = false,
        }
        Ok(())
    }
}

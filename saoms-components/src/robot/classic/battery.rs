use saoms_api::{Context, Failure, Loop, LoopClass, Record, Recordable, info, record};

use crate::robot::RobotKnowledge;
use crate::robot::battery::gain::Gain;

/// Battery level at which a robot has to charge, in percent.
const LOW: f64 = 35.0;

/// Sends the robot to charge when its battery is low, and lets it sleep when the battery is full.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.classic.BatteryMS",
    knowledge = RobotKnowledge,
    senses("block", "chargeBlock", "chargeAt", "charging"),
    effects("busy", "readyToGoUnderCharge")
)]
pub struct ClassicBattery {
    /// What the battery gains at the charger.
    gain: Gain,
}

/// State of the battery.
#[derive(Clone, Copy, Debug)]
pub enum ClassicBatterySymptom {
    /// The battery is low, in percent.
    Low(f64),
    /// The battery is full.
    Full,
}

/// Reaction to the state of the battery.
#[derive(Clone, Copy, Debug)]
pub enum ClassicBatteryDecision {
    /// Charge after the current job.
    Charge,
    /// Sleep until the robot is woken or heals another one.
    Sleep,
}

impl Recordable for ClassicBatterySymptom {
    fn record(&self) -> Record {
        match *self {
            ClassicBatterySymptom::Low(battery) => record!(low_battery: "battery is low: {battery} %", battery),
            ClassicBatterySymptom::Full => record!(fully_charged: "is fully charged"),
        }
    }
}

impl Recordable for ClassicBatteryDecision {
    fn record(&self) -> Record {
        match self {
            ClassicBatteryDecision::Charge => record!(charges_after_job: "goes to charge after its job"),
            ClassicBatteryDecision::Sleep => record!(sleeps_until_needed: "sleeps until it is woken or helps a robot"),
        }
    }
}

impl Loop for ClassicBattery {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = ClassicBatterySymptom;
    type Decision = ClassicBatteryDecision;

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        // It waits there, whatever comes of it.
        let _ = self.gain.note_aloud(knowledge, context);
        if knowledge.variables.in_charge {
            knowledge.variables.busy |= knowledge.charging;
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<ClassicBatterySymptom>, Failure> {
        let (variables, battery) = (&knowledge.variables, &knowledge.battery);
        if !variables.in_charge {
            let low = battery.percent() <= LOW.max(knowledge.charge_at) && knowledge.block != knowledge.charge_block;
            let news = low && !variables.ready_to_go_under_charge && !variables.healer;
            return Ok(news.then(|| ClassicBatterySymptom::Low(battery.percent())));
        }
        if !battery.is_full() {
            return Ok(None);
        }
        // The figures 8.7 and 8.16 show this line in each execution until the robot is awake.
        let name = &knowledge.name;
        context.console(format_args!("{name} is now fully charged and ready (but still asleep)"));
        Ok((variables.busy && !variables.healer).then_some(ClassicBatterySymptom::Full))
    }

    fn plan(
        &mut self,
        symptom: ClassicBatterySymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<ClassicBatteryDecision>, Failure> {
        Ok(Some(match symptom {
            ClassicBatterySymptom::Low(_) => ClassicBatteryDecision::Charge,
            ClassicBatterySymptom::Full => ClassicBatteryDecision::Sleep,
        }))
    }

    fn execute(
        &mut self,
        decision: ClassicBatteryDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let variables = &mut knowledge.variables;
        match decision {
            ClassicBatteryDecision::Charge => {
                variables.ready_to_go_under_charge = true;
                let battery = &knowledge.battery;
                info!(context, "battery is low ({battery} %): goes to charge after its job");
            }
            ClassicBatteryDecision::Sleep => variables.busy = false,
        }
        Ok(())
    }
}

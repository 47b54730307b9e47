use saoms_api::{Context, Failure, Loop, LoopClass, Record, Recordable, Saved, info, record};

use crate::grid::Block;
use crate::robot::battery::gain::Gain;
use crate::robot::memory::lasting::lasting;
use crate::robot::{RobotKnowledge, Trouble};

/// Returns to the charger in time, and leaves it when the battery lasts for the robot's work.
///
/// The robot knows how many executions the battery lasts, and how many the way to the charger takes, with a reserve for
/// waiting and making way. A job that ends before the battery is that low is finished. A robot whose battery gains
/// nothing at its charger takes another one, or waits there.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.BatteryMS",
    knowledge = RobotKnowledge,
    senses(
        "block", "next", "job", "chargeAt", "askedToCharge", "charging", "lasts", "wayHome", "reserve", "robots",
        "positions"
    ),
    effects("mustCharge", "inCharge", "chargeBlock", "trouble", "reserve")
)]
pub struct SafeBattery {
    charging: bool,
    /// True if the robot charges; other robots learn that once the loop has decided.
    in_charge: bool,
    /// Number of changes of the ways at the last check of the way to the charger.
    changes: u32,
    /// Its own charger, while it charges at another one.
    own: Option<Block>,
    /// Battery level that the journal has.
    noted: Option<f64>,
    /// What the battery gains at the charger.
    gain: Gain,
}

/// Change of the battery level that is written to the journal, in percent.
const LEVEL_STEP: f64 = 5.0;

/// State of the battery.
#[derive(Clone, Copy, Debug)]
pub enum SafeBatterySymptom {
    /// The battery is as low as the way to the charger allows.
    Low {
        /// Battery level in percent.
        battery: f64,
        /// Number of executions that it lasts.
        left: u32,
        /// Number of executions that the way to the charger takes.
        home: u32,
    },
    /// A loop asked the robot to charge, and it has no job.
    Asked,
    /// The battery is empty, away from a charger.
    Empty,
    /// No way leads to the charger any more, and another charger can be reached.
    CutOff {
        /// Block of the charger.
        charger: Block,
        /// Block of the other charger.
        other: Block,
        /// True if a robot is in the way that has failed and starts again.
        for_now: bool,
    },
    /// A way leads to its own charger again.
    Open {
        /// Block of its charger.
        own: Block,
    },
    /// Others are in the way to the charger for long, and another charger is free.
    HeldUp {
        /// Block of the charger.
        charger: Block,
        /// Block of the other charger.
        other: Block,
    },
    /// The battery does not last for the way to the charger any more, and a free charger is closer.
    OutOfReach {
        /// Block of the charger.
        charger: Block,
        /// Block of the other charger.
        other: Block,
    },
    /// The battery gains nothing at the charger.
    NoGain {
        /// Block of the charger.
        charger: Block,
        /// Battery level in percent.
        battery: f64,
        /// Block of another charger, which is free and in reach.
        other: Option<Block>,
    },
    /// The battery at the charger has enough for the robot's work.
    Charged {
        /// Battery level in percent.
        battery: f64,
    },
    /// The robot starts or ends charging.
    Charge {
        /// True if it starts.
        begins: bool,
        /// Battery level in percent.
        battery: f64,
    },
}

/// Reaction to the state of the battery.
#[derive(Clone, Copy, Debug)]
pub enum SafeBatteryDecision {
    /// Go to the charger, in spite of the job.
    Charge,
    /// Stay at the charger that gives nothing, until it does.
    Wait,
    /// Stay at the block, and report that.
    Stop,
    /// Leave the charger.
    Leave,
    /// Charge at another charger from now on.
    Use(Block),
    /// Charge at another charger until a way leads to its own one again.
    Replace(Block),
    /// Charge at another charger this time.
    Borrow(Block),
    /// Start or end charging.
    BeInCharge(bool),
}

impl Recordable for SafeBatterySymptom {
    fn record(&self) -> Record {
        match *self {
            SafeBatterySymptom::Low { battery, left, home } => record!(
                low_battery_for_way_home:
                    "battery at {battery} % lasts {left} {left:execution|executions}; the way to its charger takes \
                     {home}",
                battery,
                left,
                home
            ),
            SafeBatterySymptom::Asked => record!(asked_to_charge: "is to charge, and has no job"),
            SafeBatterySymptom::Empty => record!(battery_empty: "battery is empty"),
            SafeBatterySymptom::OutOfReach { charger, other } => record!(
                charger_out_of_reach: "its charger at {charger} is out of reach, and the one at {other} is free",
                charger,
                other
            ),
            SafeBatterySymptom::HeldUp { charger, other } => record!(
                held_up_on_way_home: "others are in the way to its charger at {charger}, and the one at {other} is free",
                charger,
                other
            ),
            SafeBatterySymptom::Open { own } => {
                record!(charger_open: "a path leads to its charger at {own} again", own)
            }
            SafeBatterySymptom::CutOff { charger, other, .. } => {
                record!(
                    charger_cut_off: "no path leads to its charger at {charger} any more, but one leads to {other}",
                    charger,
                    other
                )
            }
            SafeBatterySymptom::NoGain { charger, battery, .. } => {
                record!(
                    charger_gives_nothing: "battery gains nothing at its charger at {charger}: it stays at {battery} %",
                    charger,
                    battery
                )
            }
            SafeBatterySymptom::Charged { battery } => {
                record!(charged_enough: "has charged to {battery} %", battery)
            }
            SafeBatterySymptom::Charge { begins: true, battery } => {
                record!(at_charger: "is at its charger with {battery} %", battery)
            }
            SafeBatterySymptom::Charge { begins: false, battery } => {
                record!(charging_is_over: "charging is over at {battery} %", battery)
            }
        }
    }
}

impl Recordable for SafeBatteryDecision {
    fn record(&self) -> Record {
        match *self {
            SafeBatteryDecision::Charge => record!(goes_to_charge: "goes to charge"),
            SafeBatteryDecision::Wait => record!(waits_at_charger: "waits there until it gives something"),
            SafeBatteryDecision::Stop => record!(stops_with_empty_battery: "stops where it is"),
            SafeBatteryDecision::Leave => record!(leaves_charger: "leaves its charger: the battery lasts for its work"),
            SafeBatteryDecision::Use(other) => record!(changes_charger: "charges at {other} from now on", other),
            SafeBatteryDecision::Replace(other) => {
                record!(replaces_charger: "charges at {other} until a path leads to its own charger again", other)
            }
            SafeBatteryDecision::Borrow(other) => record!(borrows_charger: "charges at {other} this time", other),
            SafeBatteryDecision::BeInCharge(true) => record!(starts_charging: "starts charging"),
            SafeBatteryDecision::BeInCharge(false) => record!(stops_charging: "stops charging"),
        }
    }
}

lasting! {
    SafeBattery as BatteryMemory {
        charging: bool,
        in_charge: bool,
        changes: u32,
        own: Option<Block>,
        noted: Option<f64>,
        gain: Gain,
    }
}

impl Loop for SafeBattery {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = SafeBatterySymptom;
    type Decision = SafeBatteryDecision;

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        if knowledge.hardware.has_entered() {
            self.look_at_battery(knowledge, context);
            knowledge.energy.gives_nothing = !self.gain.gives(knowledge.charge_block, context.now());
            knowledge.energy.borrows = self.own.is_some();
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<SafeBatterySymptom>, Failure> {
        if std::mem::take(&mut knowledge.has_new_charger) {
            self.own = None;
        }
        if knowledge.trouble.is_some() {
            return Ok(None);
        }
        let changes = knowledge.routes.changes();
        if std::mem::replace(&mut self.changes, changes) != changes
            && let Some(symptom) = self.look_at_ways(knowledge)
        {
            return Ok(Some(symptom));
        }
        let battery = knowledge.battery.percent();
        let must_charge = knowledge.must_charge;
        let symptom = if let Some(symptom) = self.without_gain(knowledge, context) {
            Some(symptom)
        } else if knowledge.is_at_charger() {
            let is_spared = |own: Block| self.gain.gives(own, context.now()) || knowledge.battery.is_full();
            let spared = self.own.is_none_or(is_spared);
            // Nobody is served by one that leaves the charger of another robot with no more than it needs to leave it.
            let is_done = knowledge.is_well_charged() || knowledge.is_claimed(knowledge.charge_block);
            let lasts = spared && self.own.is_none_or(|own| is_done && knowledge.lasts_to(own));
            (must_charge && lasts && knowledge.may_leave()).then_some(SafeBatterySymptom::Charged { battery })
        } else if knowledge.battery.is_empty() {
            context.because(knowledge.energy.turned);
            Some(SafeBatterySymptom::Empty)
        } else if must_charge {
            let charger = knowledge.charge_block;
            let now = context.now();
            let out_of_reach = |other| SafeBatterySymptom::OutOfReach { charger, other };
            let symptom = if self.gain.gives(charger, now) {
                knowledge.charger_in_reach(|other| self.gain.gives(other, now)).map(out_of_reach).or_else(|| {
                    let other = knowledge.charger_on_detour(|other| self.gain.gives(other, now))?;
                    Some(SafeBatterySymptom::HeldUp { charger, other })
                })
            } else {
                knowledge.charger_elsewhere(|other| self.gain.gives(other, now)).map(out_of_reach)
            };
            if symptom.is_some() {
                context.because(knowledge.energy.turned);
            }
            symptom
        } else if knowledge.goes_on() {
            None
        } else if knowledge.asked_to_charge && !knowledge.variables.busy {
            Some(SafeBatterySymptom::Asked)
        } else {
            let (left, home) = (knowledge.executions_left(), knowledge.home(knowledge.next));
            Some(SafeBatterySymptom::Low { battery, left, home })
        };
        let begins = self.in_charge;
        let changes = knowledge.variables.in_charge != begins;
        Ok(symptom.or(changes.then_some(SafeBatterySymptom::Charge { begins, battery })))
    }

    fn plan(
        &mut self,
        symptom: SafeBatterySymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<SafeBatteryDecision>, Failure> {
        Ok(Some(match symptom {
            SafeBatterySymptom::Low { .. } | SafeBatterySymptom::Asked => SafeBatteryDecision::Charge,
            SafeBatterySymptom::Empty => SafeBatteryDecision::Stop,
            SafeBatterySymptom::NoGain { other: Some(other), .. } => SafeBatteryDecision::Borrow(other),
            SafeBatterySymptom::NoGain { other: None, .. } => SafeBatteryDecision::Wait,
            SafeBatterySymptom::Charged { .. } => SafeBatteryDecision::Leave,
            SafeBatterySymptom::CutOff { other, for_now: true, .. } => SafeBatteryDecision::Replace(other),
            SafeBatterySymptom::CutOff { other, .. } | SafeBatterySymptom::Open { own: other } => {
                SafeBatteryDecision::Use(other)
            }
            SafeBatterySymptom::OutOfReach { other, .. } | SafeBatterySymptom::HeldUp { other, .. } => {
                SafeBatteryDecision::Borrow(other)
            }
            SafeBatterySymptom::Charge { begins, .. } => SafeBatteryDecision::BeInCharge(begins),
        }))
    }

    fn execute(
        &mut self,
        decision: SafeBatteryDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        // In addition to any other decision, so that the journal has it.
        knowledge.variables.in_charge = self.in_charge;
        match decision {
            SafeBatteryDecision::BeInCharge(_) | SafeBatteryDecision::Wait => {}
            SafeBatteryDecision::Charge => {
                knowledge.energy.turned = context.cause();
                knowledge.turn_back();
                let (name, battery) = (&knowledge.name, &knowledge.battery);
                context.console(format_args!("{name} has low battery and is going under charge..."));
                info!(context, "battery is low ({battery} %): goes to charge");
            }
            SafeBatteryDecision::Stop => {
                knowledge.trouble = Some(Trouble::Battery);
                context.count("stranded", 1);
                let block = knowledge.block;
                context.alert("stranded", "", format_args!("is stranded at {block}: its battery is empty"));
            }
            SafeBatteryDecision::Leave => {
                knowledge.may_go();
                if let Some(own) = self.own.take().filter(|own| !knowledge.routes.is_obstacle(*own)) {
                    knowledge.use_charger(own);
                }
            }
            SafeBatteryDecision::Use(other) => {
                let when = if self.own.take() == Some(other) { "again" } else { "from now on" };
                knowledge.use_charger(other);
                info!(context, "charges at {other} {when}");
            }
            SafeBatteryDecision::Replace(other) => {
                self.own = self.own.or(Some(knowledge.charge_block));
                knowledge.use_charger(other);
                info!(context, "charges at {other} until a path leads to its own charger again");
            }
            SafeBatteryDecision::Borrow(other) => {
                let charger = knowledge.charge_block;
                let why = match self.gain.gives(charger, context.now()) {
                    false => "gives nothing",
                    true if knowledge.executions_left() > knowledge.home(knowledge.next) => "is behind other robots",
                    true => "is out of reach",
                };
                self.own = self.own.or(Some(charger));
                knowledge.turn_back();
                knowledge.use_charger(other);
                info!(context, "charges at {other} this time: its own {why}");
            }
        }
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(self.saved())
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.go_on(saved)
    }
}

impl RobotKnowledge {
    /// Makes this block the robot's charger from now on.
    pub(in crate::robot) fn use_charger(&mut self, charger: Block) {
        self.charge_block = charger;
        let others = self.lists.chargers.iter().map(|(_, charger)| *charger);
        self.routes.use_charger(charger, others);
    }
}

impl SafeBattery {
    /// Checks the way to the charger when the ways changed.
    fn look_at_ways(&mut self, knowledge: &mut RobotKnowledge) -> Option<SafeBatterySymptom> {
        let (next, charger) = (knowledge.next, knowledge.charge_block);
        if let Some(own) = self.own.filter(|_| !knowledge.must_charge)
            && knowledge.leads_to(own)
        {
            return Some(SafeBatterySymptom::Open { own });
        }
        let other = knowledge.other_charger()?;
        // One that its robot has only borrowed or been given for now is replaced by any other one.
        let for_now = self.own.is_some() || knowledge.routes.may_open(next, charger);
        Some(SafeBatterySymptom::CutOff { charger, other, for_now })
    }

    /// The symptom of a charger that gives nothing: at first, and now and then once another one may be free.
    fn without_gain(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Option<SafeBatterySymptom> {
        let (charger, battery) = (knowledge.charge_block, knowledge.charge);
        let is_first = self.gain.note_aloud(knowledge, context)?;
        let needs = (knowledge.must_charge || !knowledge.is_well_charged()) && !knowledge.variables.asleep;
        let now = context.now();
        let other = needs.then(|| knowledge.charger_elsewhere(|other| self.gain.gives(other, now))).flatten();
        (is_first || other.is_some()).then_some(SafeBatterySymptom::NoGain { charger, battery, other })
    }

    /// Sees whether the battery gains.
    fn look_at_battery(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) {
        if !knowledge.is_at_charger() {
            (self.charging, self.in_charge) = (false, false);
            return self.note_level(knowledge, context);
        }
        let charging = knowledge.charging;
        let charged = std::mem::replace(&mut self.charging, charging);
        if charging && !charged {
            let (name, battery) = (&knowledge.name, knowledge.level_before);
            context.console(format_args!("{name} says: I've arrived to charge position."));
            info!(context, "starts charging (battery {battery:.1} %)");
        }
        if !charging && charged && knowledge.battery.is_full() {
            let (name, asleep) = (&knowledge.name, knowledge.variables.asleep);
            let still = if asleep { " (but still asleep)" } else { "" };
            context.console(format_args!("{name} is now fully charged and ready{still}"));
            info!(context, "is fully charged");
        }
        self.note_level(knowledge, context);
        self.in_charge = charging || knowledge.variables.asleep;
    }

    /// Writes the battery level to the journal, where it has changed so much.
    fn note_level(&mut self, knowledge: &RobotKnowledge, context: &mut Context<'_>) {
        let (before, now) = (self.noted, knowledge.charge);
        if before.is_none_or(|before| (now - before).abs() >= LEVEL_STEP) {
            self.noted = Some(now);
            context.changed("battery", before.unwrap_or(now), now);
        }
    }
}

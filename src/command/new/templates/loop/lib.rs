//! A loop that makes a robot charge early.

use saoms_api::{
    Context, Effector, Entry, Failure, Knowledge, Loop, LoopClass, Properties, Record, record,
};

/// Properties of the loop.
#[derive(Debug, Properties)]
pub struct MyPluginProperties {
    /// Battery level at which the robot charges.
    #[property(default = 60.0, range = 0.0..=100.0, unit = "%")]
    threshold: f64,
}

/// A loop that makes a robot charge earlier.
#[derive(Debug, LoopClass)]
#[looping(name = "my_plugin.MyPlugin", senses("battery"), effects("chargeAt"))]
pub struct MyPlugin {
    properties: MyPluginProperties,
    battery: Entry<f64>,
    charge_at: Effector<f64>,
}

impl Loop for MyPlugin {
    type Properties = MyPluginProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Record;
    type Decision = Record;

    fn new(properties: MyPluginProperties) -> Result<Self, Failure> {
        Ok(MyPlugin { properties, battery: Entry::default(), charge_at: Effector::default() })
    }

    fn initialize(&mut self, knowledge: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.battery = knowledge.entry("battery")?;
        self.charge_at = knowledge.effector("chargeAt")?;
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<Record>, Failure> {
        let (battery, threshold) = (self.battery.get(knowledge)?, self.properties.threshold);
        let set = self.charge_at.get(knowledge)? == threshold;
        Ok((!set).then(|| record!(would_charge_late: "battery is at {battery} %, and it would charge too late", battery)))
    }

    fn plan(
        &mut self,
        _: Record,
        _: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<Record>, Failure> {
        Ok(Some(record!(sets_charge_level: "lets it charge at {threshold} %", threshold = self.properties.threshold)))
    }

    fn execute(
        &mut self,
        _: Record,
        knowledge: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.charge_at.set(knowledge, self.properties.threshold)
    }
}

saoms_api::plugin! {
    loops: [MyPlugin],
}

//! A loop that makes a robot charge early.

use saoms_api::{
    Adaptation, Context, Effector, Entry, Failure, Knowledge, LoopClass, Own, SimpleLoop, record,
};

/// A loop that makes a robot charge earlier.
#[derive(Debug, LoopClass)]
#[looping(name = "my_plugin.MyPlugin")]
pub struct MyPlugin {
    /// Battery level at which the robot charges.
    #[property(default = 60.0, range = 0.0..=100.0, unit = "%")]
    threshold: f64,
    #[senses]
    battery: Entry<f64>,
    #[effects]
    charge_at: Effector<f64>,
}

impl SimpleLoop for MyPlugin {
    type Properties = Own<Self>;

    fn adapt(
        &mut self,
        robot: &dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<Adaptation>, Failure> {
        let (battery, threshold) = (self.battery.get(robot)?, self.threshold);
        if self.charge_at.get(robot)? == threshold {
            return Ok(None);
        }
        let late = record!(would_charge_late: "battery is at {battery} %, and it would charge too late", battery);
        let level = record!(sets_charge_level: "lets it charge at {threshold} %", threshold);
        Ok(Some(Adaptation::of(late).decides(level).sets(&self.charge_at, threshold)))
    }
}

saoms_api::plugin! {
    loops: [MyPlugin],
}

#[cfg(test)]
mod tests {
    use super::*;
    use saoms_api::Extras;
    use saoms_testkit::LoopBench;

    /// The entries of a robot that the loop needs.
    #[derive(Default, Knowledge)]
    #[knowledge(name = "test.Robot")]
    struct TestRobot {
        #[entry(unit = "%")]
        battery: f64,
        #[entry(effector, unit = "%")]
        charge_at: f64,
        #[extras]
        extras: Extras,
    }

    #[test]
    fn it_decides_once() -> Result<(), Failure> {
        let mut bench = LoopBench::of::<MyPlugin>(TestRobot::default(), &[("threshold", "80")])?;
        bench.start()?;
        bench.execute()?;
        assert_eq!(bench.knowledge().charge_at, 80.0);
        bench.execute()?;
        assert_eq!(bench.journal(), [""; 0]);
        Ok(())
    }

    #[test]
    fn it_keeps_what_every_loop_keeps() {
        saoms_testkit::comply_loop::<MyPlugin, TestRobot>(TestRobot::default, &[]);
    }
}

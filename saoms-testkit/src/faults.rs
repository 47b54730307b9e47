//! Faults of a run: components that are slow or fail, and messages that are lost, late or come twice.

use std::ops::Range;
use std::time::Duration;

use saoms_api::Time;
use saoms_api::event::fault::{FaultCall, FaultKind, Rate};
use saoms_core::fault::TimedFault;
use saoms_lang::assembly::{Assembly, fault_subjects};

use crate::Fleet;

impl Fleet {
    /// The same fleet, in which the first execution of a component at a time of the run or later takes this long.
    /// Until it ends the component is busy: calls are answered [`CallError::Busy`](saoms_api::CallError::Busy), as by
    /// hardware that is slow.
    ///
    /// ```
    /// use std::time::Duration;
    ///
    /// use saoms_components as _;
    /// use saoms_testkit::Fleet;
    ///
    /// let fleet = Fleet::of_text(r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="fleet"
    ///     targetNamespace="urn:fleet">
    ///   <component name="Robot1">
    ///     <implementation.java class="saoms.Robot"/>
    ///     <property name="ID">Robot1</property>
    ///     <property name="period">100ms</property>
    ///   </component></composite>"#);
    /// let slow = fleet.slow("Robot1", Duration::from_secs(1), Duration::from_secs(5));
    /// let robot = &slow.run(0, Duration::from_secs(10)).into_report().components[0];
    /// assert_eq!(robot.missed, 49, "all that were due while the execution ran, but the last");
    /// ```
    #[must_use]
    pub fn slow(self, component: &str, at: Duration, lasting: Duration) -> Fleet {
        self.with(at, FaultCall::new(FaultKind::Stall).lasting(lasting).to(component))
    }

    /// The same fleet, in which the first execution of a component at a time of the run or later is a failure. Its
    /// `restart` policy decides what follows.
    ///
    /// ```
    /// use std::time::Duration;
    ///
    /// use saoms_components as _;
    /// use saoms_testkit::Fleet;
    ///
    /// let fleet = Fleet::of_file("../composites/hall.composite").fail("World", Duration::from_secs(2));
    /// let run = fleet.run(0, Duration::from_secs(10));
    /// assert_eq!(run.components.iter().find(|one| one.name == "World").unwrap().failures, 1);
    /// ```
    #[must_use]
    pub fn fail(self, component: &str, at: Duration) -> Fleet {
        self.with(at, FaultCall::new(FaultKind::Fail).to(component))
    }

    /// The same fleet, in which messages of a topic that are sent in this part of the run reach no other component. The
    /// topic has the name that it has after `topicRename`.
    ///
    /// ```
    /// use std::time::Duration;
    ///
    /// use saoms_components as _;
    /// use saoms_testkit::Fleet;
    ///
    /// let hall = || Fleet::of_file("../composites/hall.composite");
    /// let seconds = Duration::from_secs;
    /// // The request for luggage: no robot hears of it.
    /// let lost = hall().lose("ELMSTOPIC", seconds(0)..seconds(2)).run(0, seconds(60));
    /// assert_eq!((lost.count("luggage.requested"), lost.count("luggage.delivered")), (1, 0));
    /// // Positions of robots that nobody else has to know.
    /// let lost = hall().lose("POSTOPIC", seconds(0)..seconds(60)).run(0, seconds(60));
    /// assert_eq!(lost.count("luggage.delivered"), 1);
    /// ```
    #[must_use]
    pub fn lose(self, topic: &str, during: Range<Duration>) -> Fleet {
        self.disturb(topic, during, FaultKind::Violate(Rate::ALL))
    }

    /// The same fleet, in which messages of a topic that are sent in this part of the run reach it later by this time.
    #[must_use]
    pub fn delay(self, topic: &str, during: Range<Duration>, by: Duration) -> Fleet {
        self.disturb(topic, during, FaultKind::Delay(by, by))
    }

    /// The same fleet, in which messages of a topic that are sent in this part of the run reach it twice.
    #[must_use]
    pub fn duplicate(self, topic: &str, during: Range<Duration>) -> Fleet {
        self.disturb(topic, during, FaultKind::Duplicate(Rate::ALL))
    }

    /// The same fleet with a fault as a scenario writes it, from a time of the run on.
    ///
    /// ```
    /// use std::time::Duration;
    ///
    /// use saoms_components as _;
    /// use saoms_testkit::Fleet;
    ///
    /// let fleet = Fleet::of_file("../composites/hall.composite");
    /// let cut = fleet.with_fault(Duration::from_secs(1), "for 5s cut Robot7 from Master");
    /// let run = cut.run(0, Duration::from_secs(60));
    /// assert_eq!(run.count("luggage.delivered"), 1, "the request comes later");
    /// ```
    ///
    /// # Panics
    /// The line is none of a fault.
    #[must_use]
    #[expect(clippy::panic, reason = "a test with a slip in its fault has failed")]
    pub fn with_fault(self, at: Duration, line: &str) -> Fleet {
        match FaultCall::read(line) {
            Ok(call) => self.with(at, call),
            Err(fault) => panic!("the fault `{line}`: {fault}"),
        }
    }

    fn disturb(self, topic: &str, during: Range<Duration>, kind: FaultKind) -> Fleet {
        let lasting = during.end.saturating_sub(during.start);
        self.with(during.start, FaultCall::new(kind).lasting(lasting).on(topic))
    }

    fn with(mut self, at: Duration, call: FaultCall) -> Fleet {
        self.faults.push(TimedFault::new(time(at), call));
        self
    }

    /// Checks that faults are of components and topics that the fleet has: a slip would let every test pass.
    #[expect(clippy::panic, reason = "a test with faults of nothing has failed")]
    pub(crate) fn expect_faults_to_apply(&self, assembly: &Assembly) {
        let subjects = fault_subjects(&assembly.components);
        for TimedFault { call, .. } in &self.faults {
            if let Err(fault) = subjects.check(call) {
                panic!("the fault `{call}`: {fault}");
            }
        }
    }
}

fn time(since_start: Duration) -> Time {
    Time::from_nanos(u64::try_from(since_start.as_nanos()).unwrap_or(u64::MAX))
}

//! How a fleet adapts, in tests.

use std::sync::Arc;
use std::time::Duration;

use saoms_core::adaptation::AdaptationReport;
use saoms_core::observe::AdaptationWatch;

use crate::Fleet;

impl Fleet {
    /// How the fleet adapts to each kind of event, in a run with this seed.
    ///
    /// ```
    /// use std::time::Duration;
    ///
    /// use saoms_testkit::Fleet;
    ///
    /// let fleet = Fleet::of_file("../composites/airport.composite");
    /// let adaptation = fleet.adaptation(7, Duration::from_secs(60));
    /// let breakdown = adaptation.kinds.iter().find(|kind| kind.kind == "robot_breaks_down").unwrap();
    /// assert_eq!(breakdown.needless, 0);
    /// assert!(breakdown.settle_s.is_some_and(|settle| settle.max < 5.0), "a healer comes in time");
    /// ```
    ///
    /// # Panics
    /// As [`run`](Fleet::run).
    pub fn adaptation(&self, seed: u64, limit: Duration) -> AdaptationReport {
        let report = self.run_with(seed, limit, Arc::new(AdaptationWatch::default()));
        report.adaptation.unwrap_or_default()
    }
}

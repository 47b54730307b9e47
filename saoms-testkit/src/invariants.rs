//! The invariants of a fleet, in tests.

use std::fmt::Write;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

use saoms_core::observe::InvariantWatch;

use crate::Fleet;

impl Fleet {
    /// The violations of the invariants of the components that are linked in, in a run with this seed: a line each,
    /// such as `[1.300 s] 1 no two robots in a block: robots 1 and 2 collide at (3,5)`. Empty if there are none.
    ///
    /// ```
    /// use std::time::Duration;
    ///
    /// use saoms_components as _;
    /// use saoms_testkit::Fleet;
    ///
    /// let fleet = Fleet::of_file("../composites/hall.composite");
    /// assert_eq!(fleet.violations(7, Duration::from_secs(60)), "");
    /// ```
    ///
    /// # Panics
    /// As [`run`](Fleet::run).
    pub fn violations(&self, seed: u64, limit: Duration) -> String {
        let watch = Arc::new(InvariantWatch::default());
        self.run_with(seed, limit, Arc::clone(&watch) as Arc<_>);
        watch.violations().iter().fold(String::new(), |mut text, one| {
            let _ = writeln!(text, "[{}] {}: {}", one.at, one.invariant, one.text);
            text
        })
    }

    /// Holds runs with these seeds to the invariants.
    ///
    /// # Panics
    /// A run violates one; the message has its seed. And as [`run`](Fleet::run).
    #[track_caller]
    pub fn expect_invariants(&self, seeds: Range<u64>, limit: Duration) {
        for seed in seeds {
            let violations = self.violations(seed, limit);
            assert!(violations.is_empty(), "seed {seed}:\n{violations}");
        }
    }
}

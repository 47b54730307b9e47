//! Usage of the original system for the same fleets: Tuscany, ActiveMQ and its robots, all on one machine of two cores.

/// A fleet of the original.
pub(crate) struct Original {
    pub(crate) robots: u32,
    pub(crate) period_ms: u32,
    /// Processor time of broker and fleet, per execution of a robot; the minimum of several runs.
    pub(crate) cpu_us: f64,
    /// Memory of both, likewise.
    pub(crate) memory_mb: u32,
    /// Maximum share of `cpu_us` that this fleet may use.
    pub(crate) goal: f64,
}

/// At 100 robots of 100 ms the original lost more than half of its executions, so that there is no figure to compare
/// with.
pub(crate) const ORIGINAL: [Original; 4] = [
    Original { robots: 10, period_ms: 1000, cpu_us: 3100.0, memory_mb: 380, goal: 0.01 },
    Original { robots: 10, period_ms: 100, cpu_us: 1940.0, memory_mb: 630, goal: 0.01 },
    Original { robots: 50, period_ms: 100, cpu_us: 3290.0, memory_mb: 1360, goal: 0.01 },
    Original { robots: 100, period_ms: 1000, cpu_us: 6950.0, memory_mb: 1100, goal: 0.001 },
];

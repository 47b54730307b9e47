//! The types of the ROS 2 package of this name, for messages that have them: see [`Field`](crate::Field).

use crate::Message;

/// Nanoseconds of a second.
const SECOND: u64 = 1_000_000_000;

/// A point in time: a time of the run, or a date as seconds since 1970.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Message)]
#[message(name = "builtin_interfaces/msg/Time")]
pub struct Time {
    /// Whole seconds.
    pub sec: i32,
    /// Nanoseconds of the present second, less than 10^9.
    pub nanosec: u32,
}

/// A length of time, which may be negative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Message)]
#[message(name = "builtin_interfaces/msg/Duration")]
pub struct Duration {
    /// Whole seconds, rounded down: -0.5 s is -1 s and 500 million nanoseconds.
    pub sec: i32,
    /// Nanoseconds to add to these, less than 10^9.
    pub nanosec: u32,
}

/// The time of a run. What is more than 68 years after its start becomes the last time there is.
impl From<crate::Time> for Time {
    fn from(time: crate::Time) -> Time {
        let (sec, nanosec) = split(time.as_nanos() / SECOND, (time.as_nanos() % SECOND) as u32);
        Time { sec, nanosec }
    }
}

/// What is longer than 68 years becomes the longest duration there is.
impl From<std::time::Duration> for Duration {
    fn from(duration: std::time::Duration) -> Duration {
        let (sec, nanosec) = split(duration.as_secs(), duration.subsec_nanos());
        Duration { sec, nanosec }
    }
}

fn split(seconds: u64, nanos: u32) -> (i32, u32) {
    i32::try_from(seconds).map_or((i32::MAX, SECOND as u32 - 1), |seconds| (seconds, nanos))
}

#[cfg(test)]
mod tests {
    use super::{Duration, Time};

    #[test]
    fn times_of_a_run_become_those_of_ros() {
        assert_eq!(Time::from(crate::Time::from_nanos(2_000_000_007)), Time { sec: 2, nanosec: 7 });
        assert_eq!(Time::from(crate::Time::from_nanos(u64::MAX)), Time { sec: i32::MAX, nanosec: 999_999_999 });
        let half = Duration::from(std::time::Duration::from_millis(1_500));
        assert_eq!(half, Duration { sec: 1, nanosec: 500_000_000 });
        assert!(half < Duration::from(std::time::Duration::MAX));
    }
}

//! How long zones take to answer a robot.

use saoms_api::Field;

/// Unit of times: parts of an execution.
const PARTS: u32 = 16;

/// The measured time falls by one part of this number with each answer that comes sooner.
const MEMORY: u32 = 8;

/// The same for each execution in which no answer is waited for.
const IDLE_MEMORY: u32 = 32;

/// Maximum number of executions for which an answer is waited for.
const MOST: u32 = 64;

/// Measured time from a request until the zone's answer, in executions of the robot.
///
/// It rises at once and falls slowly: a robot that expects an answer too soon stops on its way.
#[derive(Debug, Default, Clone, Field)]
pub(super) struct Latency {
    /// In parts of an execution.
    measured: u32,
    /// The request whose answer is waited for.
    request: Option<Request>,
}

#[derive(Debug, Clone, Copy, Field)]
struct Request {
    zone: u32,
    number: u64,
    /// Number of executions since it was sent.
    age: u32,
}

impl Latency {
    /// Begins an execution.
    pub(super) fn begin_execution(&mut self) {
        let Some(request) = &mut self.request else {
            self.measured -= self.measured.div_ceil(IDLE_MEMORY);
            return;
        };
        request.age += 1;
        self.measured = self.measured.max(request.age * PARTS);
        if request.age >= MOST {
            self.request = None;
        }
    }

    /// The robot sends this request now.
    pub(super) fn asks(&mut self, zone: u32, number: u64) {
        if self.request.is_none() {
            self.request = Some(Request { zone, number, age: 0 });
        }
    }

    /// Zones have new borders: nobody answers requests to those that are known no more.
    pub(super) fn hears_zones(&mut self, is_known: impl Fn(u32) -> bool) {
        self.request = self.request.filter(|request| is_known(request.zone));
    }

    /// The zone has taken in all requests up to this one.
    pub(super) fn hears(&mut self, zone: u32, number: u64) {
        let Some(request) = self.request.filter(|request| request.zone == zone && request.number <= number) else {
            return;
        };
        self.measured = (self.measured - self.measured / MEMORY).max(request.age * PARTS);
        self.request = None;
    }

    /// Number of executions that an answer takes.
    pub(super) fn executions(&self) -> u32 {
        self.measured.div_ceil(PARTS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer_after(latency: &mut Latency, executions: u32) {
        latency.asks(1, 7);
        (0..executions).for_each(|_| latency.begin_execution());
        latency.hears(1, 7);
    }

    #[test]
    fn a_late_answer_counts_at_once_and_is_forgotten_slowly() {
        let mut latency = Latency::default();
        assert_eq!(latency.executions(), 0);
        let mut measured = Vec::new();
        for executions in [1, 1, 6, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1] {
            answer_after(&mut latency, executions);
            measured.push(latency.executions());
        }
        assert_eq!(measured, [1, 1, 6, 6, 5, 5, 4, 4, 3, 3, 3, 2, 2, 2, 2, 2, 2, 1, 1]);
    }

    #[test]
    fn an_answer_that_never_comes_counts_up_to_a_limit() {
        let mut latency = Latency::default();
        latency.asks(1, 7);
        latency.hears(2, 9);
        latency.hears(1, 6);
        (0..3).for_each(|_| latency.begin_execution());
        assert_eq!(latency.executions(), 3);
        (3..MOST).for_each(|_| latency.begin_execution());
        assert_eq!(latency.executions(), MOST);
    }

    #[test]
    fn without_requests_late_answers_are_forgotten() {
        let mut latency = Latency::default();
        answer_after(&mut latency, 10);
        (0..20).for_each(|_| latency.begin_execution());
        assert_eq!(latency.executions(), 5);
        (0..200).for_each(|_| latency.begin_execution());
        assert_eq!(latency.executions(), 0);
    }
}

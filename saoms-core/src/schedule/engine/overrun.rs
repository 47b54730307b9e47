use saoms_lang::assembly::Overrun;

/// The decision about an execution that is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Decision {
    /// It starts. The next one is due at `next`; `missed` ones are left out.
    Execute { next: u64, missed: u64 },
    /// The component stops, because `missed` executions would be left out.
    Stop { missed: u64 },
}

/// Decides about an execution that was due at `due` and can start at `now`, by the component's `overrun`.
///
/// An execution is overrun when the next one is due before it starts. Executions that would be due from `limit` on, the
/// end of the run, are not missed.
#[inline]
pub(crate) fn decide(overrun: Overrun, due: u64, now: u64, period: u64, limit: u64) -> Decision {
    let late = now.saturating_sub(due);
    let next = due.saturating_add(period);
    if late < period {
        return Decision::Execute { next, missed: 0 };
    }
    match overrun {
        Overrun::CatchUp => Decision::Execute { next, missed: 0 },
        Overrun::Stop => Decision::Stop { missed: late / period },
        Overrun::Skip => {
            let missed = now.min(limit.saturating_sub(1)).saturating_sub(due) / period;
            Decision::Execute { next: next.saturating_add(late / period * period), missed }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEVER: u64 = u64::MAX;

    #[test]
    fn overrun_executions_are_skipped_caught_up_or_end_the_component() {
        let execute = |next, missed| Decision::Execute { next, missed };
        // Due, now, limit; then skip, catch up and stop, all with a period of 10.
        let cases = [
            (20, 20, NEVER, [execute(30, 0), execute(30, 0), execute(30, 0)]),
            (20, 29, NEVER, [execute(30, 0), execute(30, 0), execute(30, 0)]),
            (20, 30, NEVER, [execute(40, 1), execute(30, 0), Decision::Stop { missed: 1 }]),
            (20, 55, NEVER, [execute(60, 3), execute(30, 0), Decision::Stop { missed: 3 }]),
            // Before its due time, as with a clock that was read earlier.
            (20, 19, NEVER, [execute(30, 0), execute(30, 0), execute(30, 0)]),
            // Executions that would be due from the end of the run on are not missed.
            (20, 55, 40, [execute(60, 1), execute(30, 0), Decision::Stop { missed: 3 }]),
            (20, 55, 41, [execute(60, 2), execute(30, 0), Decision::Stop { missed: 3 }]),
            (20, 55, 0, [execute(60, 0), execute(30, 0), Decision::Stop { missed: 3 }]),
            // At the largest time.
            (NEVER - 5, NEVER - 5, NEVER, [execute(NEVER, 0), execute(NEVER, 0), execute(NEVER, 0)]),
        ];
        for (due, now, limit, expected) in cases {
            let all = [Overrun::Skip, Overrun::CatchUp, Overrun::Stop];
            let found = all.map(|overrun| decide(overrun, due, now, 10, limit));
            assert_eq!(found, expected, "due {due}, now {now}, limit {limit}");
        }
    }
}

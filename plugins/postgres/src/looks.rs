use std::collections::HashMap;
use std::time::{Duration, Instant};

use crate::source::Run;

/// Time without news after which a run that may have been killed is looked at rarely, and time between two such looks.
const QUIET: Duration = Duration::from_secs(300);
const RARELY: Duration = Duration::from_secs(60);

/// The looks that a connection has had at runs without an end. Those that were killed never get one, and a file that is
/// old has many of them: without news, only the newest of each program is looked at all the time.
#[derive(Debug, Default)]
pub(crate) struct Looks {
    /// When there were news of a run that was looked at; `None` if there were none so far.
    news: HashMap<i64, Option<Instant>>,
    /// When all runs were looked at last.
    last_whole: Option<Instant>,
    /// True if some were left out since.
    has_left_out: bool,
}

impl Looks {
    /// The runs that are looked at now: of all, in the order of their numbers, those that are not complete, unless it
    /// is enough to look at them later.
    pub(crate) fn choose(&mut self, runs: Vec<Run>, is_complete: impl Fn(i64) -> bool, now: Instant) -> Vec<Run> {
        let newest: HashMap<String, i64> = runs.iter().map(|run| (run.program.clone(), run.run)).collect();
        let open = runs.into_iter().filter(|run| !is_complete(run.run));
        let is_whole = self.last_whole.is_none_or(|last| now.duration_since(last) >= RARELY);
        let (chosen, left_out): (Vec<Run>, Vec<Run>) = open.partition(|run| {
            is_whole || run.has_ended || newest.get(&run.program) == Some(&run.run) || !self.is_quiet(run.run, now)
        });
        if is_whole {
            self.last_whole = Some(now);
        }
        self.has_left_out = !left_out.is_empty();
        chosen
    }

    /// True if it is time to look at those that were left out, also if nothing was written since.
    pub(crate) fn is_due(&self, now: Instant) -> bool {
        self.has_left_out && self.last_whole.is_none_or(|last| now.duration_since(last) >= RARELY)
    }

    fn is_quiet(&self, run: i64, now: Instant) -> bool {
        match self.news.get(&run) {
            None => false,
            Some(news) => news.is_none_or(|news| now.duration_since(news) >= QUIET),
        }
    }

    /// Takes down that new records of a run were there.
    pub(crate) fn hear_records(&mut self, run: i64, now: Instant) {
        self.news.insert(run, Some(now));
    }

    /// Takes down that something of a run differs from what this connection knew: at the first look that is no news.
    pub(crate) fn hear_changes(&mut self, run: i64, now: Instant) {
        if let Some(news) = self.news.get_mut(&run) {
            *news = Some(now);
        }
    }

    /// Takes down that runs were looked at.
    pub(crate) fn looked_at(&mut self, runs: &[Run]) {
        for run in runs.iter().filter(|run| !run.has_ended) {
            self.news.entry(run.run).or_insert(None);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_that_were_killed_are_looked_at_rarely() {
        // Three that have no end, and one that is complete; the last of each program may go on.
        let run = |(number, program, has_ended): (i64, &str, bool)| Run {
            run: number,
            program: program.to_owned(),
            began: String::new(),
            has_ended,
        };
        let start = Instant::now();
        let mut looks = Looks::default();
        let mut look = |second: u64, heard: &[i64], changed: &[i64], ended: bool| {
            let now = start + Duration::from_secs(second);
            let is_due = looks.is_due(now);
            let runs =
                [(1, "hall", false), (2, "hall", ended), (3, "yard", false), (4, "hall", true), (5, "hall", false)];
            let chosen = looks.choose(runs.map(run).to_vec(), |run| run == 4, now);
            heard.iter().for_each(|run| looks.hear_records(*run, now));
            changed.iter().for_each(|run| looks.hear_changes(*run, now));
            looks.looked_at(&chosen);
            (is_due, chosen.iter().map(|run| run.run).collect::<Vec<_>>())
        };
        // At first all are looked at, and whatever is known of the first run then is no news.
        assert_eq!(look(0, &[2], &[1], false), (false, vec![1, 2, 3, 5]));
        assert_eq!(look(1, &[], &[], false), (false, vec![2, 3, 5]));
        assert_eq!(look(59, &[], &[], false), (false, vec![2, 3, 5]));
        assert_eq!(look(60, &[], &[1], false), (true, vec![1, 2, 3, 5]));
        assert_eq!(look(61, &[], &[], false), (false, vec![1, 2, 3, 5]));
        assert_eq!(look(299, &[], &[], false), (false, vec![1, 2, 3, 5]));
        assert_eq!(look(300, &[], &[], false), (false, vec![1, 3, 5]));
        assert_eq!(look(301, &[], &[], true), (false, vec![1, 2, 3, 5]));
    }
}

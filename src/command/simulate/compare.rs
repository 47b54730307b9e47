//! Two fleets with the same seeds, side by side.

use std::collections::{HashMap, HashSet};
use std::fmt;

use serde::Serialize;
use serde_json::{Value, json};

use super::one::SeedResult;
use super::table::Table;

/// The comparison of two fleets.
pub(super) struct Comparison<'a> {
    names: [String; 2],
    tables: [&'a Table; 2],
    figures: Vec<Compared>,
    /// Number of figures that only one of them has.
    alone: usize,
}

/// A figure of both fleets, over the seeds with which both have it.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct Compared {
    figure: String,
    pairs: usize,
    a: Moments,
    b: Moments,
    /// Of the second fleet less the first, with the same seed.
    difference: Moments,
    /// The interval that holds the mean difference with 95 %; `None` with less than two pairs.
    interval: Option<[f64; 2]>,
    /// True if that interval does not hold 0: so large a difference is seldom chance.
    is_beyond_chance: bool,
}

/// Mean and standard deviation of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Moments {
    mean: f64,
    deviation: f64,
}

impl Moments {
    fn of(values: &[f64]) -> Moments {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count.max(1.0);
        let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
        Moments { mean, deviation: (squares / (count - 1.0).max(1.0)).sqrt() }
    }
}

impl Compared {
    /// Compares the values of two fleets, pair by pair.
    fn of(figure: &str, pairs: &[(f64, f64)]) -> Compared {
        let of = |value: fn(&(f64, f64)) -> f64| pairs.iter().map(value).collect::<Vec<f64>>();
        let difference = Moments::of(&of(|(a, b)| b - a));
        let freedom = pairs.len().saturating_sub(1);
        let interval = (freedom > 0).then(|| {
            let half = quantile(freedom) * difference.deviation / (pairs.len() as f64).sqrt();
            [difference.mean - half, difference.mean + half]
        });
        Compared {
            figure: figure.to_owned(),
            pairs: pairs.len(),
            a: Moments::of(&of(|(a, _)| *a)),
            b: Moments::of(&of(|(_, b)| *b)),
            difference,
            interval,
            is_beyond_chance: interval.is_some_and(|[low, high]| low > 0.0 || high < 0.0),
        }
    }

    /// True if both fleets have the same value with each seed.
    fn is_equal(&self) -> bool {
        self.difference == Moments { mean: 0.0, deviation: 0.0 }
    }
}

/// The 97.5 % quantile of Student's t distribution, to a thousandth.
fn quantile(freedom: usize) -> f64 {
    /// The first ones, where the expansion is not exact enough.
    const FIRST: [f64; 6] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447];
    let normal: f64 = 1.959_964;
    let n = freedom as f64;
    let terms = [
        (normal.powi(3) + normal) / 4.0,
        (5.0 * normal.powi(5) + 16.0 * normal.powi(3) + 3.0 * normal) / 96.0,
        (3.0 * normal.powi(7) + 19.0 * normal.powi(5) + 17.0 * normal.powi(3) - 15.0 * normal) / 384.0,
    ];
    // Cornish and Fisher's expansion.
    let expansion = normal + terms[0] / n + terms[1] / n.powi(2) + terms[2] / n.powi(3);
    freedom.checked_sub(1).and_then(|place| FIRST.get(place)).copied().unwrap_or(expansion)
}

/// The figures of a run by name, in their order, its time first.
fn figures_of(result: &SeedResult) -> Vec<(&str, f64)> {
    // A run that crashed has none.
    let time = result.trace_hash.is_some().then_some(("time, s", result.time_s));
    time.into_iter().chain(result.measures.iter().map(|figure| (figure.name.as_str(), figure.value))).collect()
}

impl<'a> Comparison<'a> {
    pub(super) fn of(names: [String; 2], tables: [&'a Table; 2]) -> Comparison<'a> {
        let [one, other] = tables.map(Table::results);
        let figures = compared(one, other);
        let all: HashSet<&str> = one.iter().chain(other).flat_map(figures_of).map(|(name, _)| name).collect();
        let alone = all.len() - figures.len();
        Comparison { names, tables, figures, alone }
    }

    pub(super) fn json(&self) -> Value {
        let [a, b] = self.tables.map(Table::json);
        let fleets = json!({ "a": self.names[0], "b": self.names[1] });
        json!({ "fleets": fleets, "comparison": self.figures, "alone": self.alone, "a": a, "b": b })
    }
}

/// Compares the results of two fleets by seed.
fn compared(one: &[SeedResult], other: &[SeedResult]) -> Vec<Compared> {
    let others: HashMap<u64, &SeedResult> = other.iter().map(|result| (result.seed, result)).collect();
    let mut names: Vec<&str> = Vec::new();
    let mut pairs: HashMap<&str, Vec<(f64, f64)>> = HashMap::new();
    for result in one {
        let Some(other) = others.get(&result.seed) else { continue };
        let values: HashMap<&str, f64> = figures_of(other).into_iter().collect();
        for (name, a) in figures_of(result) {
            let Some(b) = values.get(name) else { continue };
            let all = pairs.entry(name).or_default();
            if all.is_empty() {
                names.push(name);
            }
            all.push((a, *b));
        }
    }
    names.into_iter().map(|name| Compared::of(name, &pairs[name])).collect()
}

impl fmt::Display for Comparison<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for ((name, fleet), table) in ["A", "B"].into_iter().zip(&self.names).zip(self.tables) {
            writeln!(formatter, "{name}: {fleet}")?;
            table.runs(formatter)?;
            table.failures(formatter)?;
            writeln!(formatter)?;
        }
        let shown: Vec<&Compared> = self.figures.iter().filter(|one| !one.is_equal()).collect();
        let equal = self.figures.len() - shown.len();
        let width = shown.iter().map(|one| one.figure.chars().count()).max().unwrap_or(0).max("mean of runs".len());
        if !shown.is_empty() {
            writeln!(
                formatter,
                "{:width$}  {:>20}  {:>20}  {:>10}  {:>24}  {:>5}  beyond chance",
                "mean of runs", "A", "B", "B - A", "95 % interval", "pairs"
            )?;
        }
        for one in shown {
            let moments = |of: Moments| format!("{:.3} \u{b1} {:.3}", of.mean, of.deviation);
            let interval = one.interval.map_or_else(|| "-".to_owned(), |[low, high]| format!("{low:.3} to {high:.3}"));
            writeln!(
                formatter,
                "{:width$}  {:>20}  {:>20}  {:>10.3}  {interval:>24}  {:>5}  {}",
                one.figure,
                moments(one.a),
                moments(one.b),
                one.difference.mean,
                one.pairs,
                match (one.interval, one.is_beyond_chance) {
                    (None, _) => "-",
                    (Some(_), true) => "yes",
                    (Some(_), false) => "no",
                }
            )?;
        }
        if equal > 0 {
            writeln!(formatter, "figures that are the same with each seed: {equal}")?;
        }
        if self.alone > 0 {
            writeln!(formatter, "figures that only one of the fleets has: {}", self.alone)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::one::Figure;
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        for (freedom, expected) in
            [(1, 12.706), (4, 2.776), (5, 2.571), (7, 2.365), (9, 2.262), (30, 2.042), (1000, 1.962)]
        {
            assert!((quantile(freedom) - expected).abs() < 0.0011, "{freedom}: {}", quantile(freedom));
        }
    }

    #[test]
    fn the_interval_is_of_the_differences_of_pairs() {
        // They vary much from seed to seed, and little within a pair.
        let pairs = [(10.0, 11.0), (20.0, 21.2), (30.0, 30.8)];
        let compared = Compared::of("time", &pairs);
        let [low, high] = compared.interval.unwrap();
        assert!((compared.difference.mean - 1.0).abs() < 1e-9 && (compared.difference.deviation - 0.2).abs() < 1e-9);
        assert!((low - (1.0 - 4.303 * 0.2 / 3_f64.sqrt())).abs() < 1e-9 && (low + high - 2.0).abs() < 1e-9);
        assert!(compared.is_beyond_chance);
        assert!(!Compared::of("time", &[(1.0, 2.0), (2.0, 1.0)]).is_beyond_chance);
        assert_eq!(Compared::of("time", &[(1.0, 2.0)]).interval, None);
        assert!(Compared::of("time", &[(1.0, 1.0), (3.0, 3.0)]).is_equal());
    }

    #[test]
    fn only_seeds_with_both_figures_are_pairs() {
        let result = |seed, value: Option<f64>| {
            let figure = |value| Figure { name: "wait".to_owned(), value, of: None };
            let trace_hash = value.map(|_| String::new());
            SeedResult { seed, trace_hash, measures: value.map(figure).into_iter().collect(), ..SeedResult::default() }
        };
        let one = [result(1, Some(1.0)), result(2, None), result(3, Some(3.0)), result(4, Some(9.0))];
        let other = [result(1, Some(2.0)), result(2, Some(5.0)), result(3, Some(5.0))];
        let found = compared(&one, &other);
        let wait = found.iter().find(|one| one.figure == "wait").unwrap();
        assert_eq!((wait.pairs, wait.a.mean, wait.b.mean, wait.difference.mean), (2, 2.0, 3.5, 1.5));
    }
}

use saoms_api::extension::Curve;

/// Samples at most; where there are more, each second one is dropped, and the step doubles.
const MOST: usize = 4096;
/// Time between two samples of a short run, in nanoseconds.
const STEP: u64 = 50_000_000;

/// Figures of a run over time, sampled.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// The curves.
    pub curves: Vec<Curve>,
    step: u64,
    /// The figures at each step from the start, one for each curve.
    rows: Vec<Vec<f64>>,
    /// The end of the run in nanoseconds, with its figures.
    end: (u64, Vec<f64>),
}

impl Samples {
    /// Without any sample.
    pub fn new(curves: Vec<Curve>) -> Samples {
        Samples { curves, step: STEP, rows: Vec::new(), end: (0, Vec::new()) }
    }

    /// Takes the samples up to this time, in nanoseconds, at which these figures still hold.
    pub fn advance(&mut self, now: u64, figures: impl FnOnce() -> Vec<f64>) {
        let mut next = self.rows.len() as u64 * self.step;
        if next > now {
            return;
        }
        let figures = figures();
        while next <= now {
            self.rows.push(figures.clone());
            if self.rows.len() == MOST {
                let mut place = 0;
                self.rows.retain(|_| {
                    place += 1;
                    place % 2 == 1
                });
                self.step = self.step.saturating_mul(2);
            }
            next = (self.rows.len() as u64).saturating_mul(self.step);
        }
    }

    /// Ends the samples at this time.
    pub fn finish(&mut self, end: u64, figures: Vec<f64>) {
        self.advance(end.saturating_sub(1), || figures.clone());
        self.end = (end, figures);
    }

    /// The points of a curve: times in seconds, and figures; NaN where a figure is not known.
    pub fn points(&self, curve: usize) -> impl Iterator<Item = (f64, f64)> {
        let time = |place: usize| place as f64 * self.step as f64 / 1e9;
        let rows = self.rows.iter().enumerate().map(move |(place, row)| (time(place), row));
        let end = (self.end.0 as f64 / 1e9, &self.end.1);
        rows.chain([end]).filter_map(move |(time, row)| Some((time, *row.get(curve)?)))
    }

    /// The work that was finished until this time, in nanoseconds.
    pub(super) fn work(&self, time: u64) -> f64 {
        let place = usize::try_from(time / self.step).unwrap_or(usize::MAX);
        let row = if time >= self.end.0 { Some(&self.end.1) } else { self.rows.get(place).or(self.rows.last()) };
        let figures = self.curves.iter().zip(row.into_iter().flatten());
        figures.filter(|(curve, figure)| curve.is_work && figure.is_finite()).map(|(_, figure)| figure).sum()
    }

    /// True if a curve counts work.
    pub(super) fn has_work(&self) -> bool {
        self.curves.iter().any(|curve| curve.is_work)
    }

    /// The end of the run, in nanoseconds.
    pub(super) fn end(&self) -> u64 {
        self.end.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORK: Curve = Curve { name: "done", panel: "done", is_work: true };

    #[test]
    fn samples_are_bounded_however_long_the_run_is() {
        let mut samples = Samples::new(vec![WORK]);
        for second in 0..100_000_u64 {
            samples.advance(second * 1_000_000_000, || vec![second as f64]);
        }
        samples.finish(100_000_000_000_000, vec![100_000.0]);
        let points: Vec<(f64, f64)> = samples.points(0).collect();
        assert!((MOST / 2..=MOST).contains(&points.len()), "{}", points.len());
        assert_eq!(points.first(), Some(&(0.0, 0.0)));
        assert_eq!(points.last(), Some(&(100_000.0, 100_000.0)));
        assert!(points.iter().all(|(time, done)| (time - done).abs() <= 1.0));
        assert!(points.windows(2).all(|pair| pair[0].0 < pair[1].0));
        assert_eq!(samples.work(u64::MAX), 100_000.0);
    }
}

use std::collections::BTreeMap;
use std::sync::Arc;

use saoms_core::adaptation::{AdaptationReport, MeasuredEvent, Samples};
use saoms_core::observe::{AdaptationWatch, Interest, Observer};
use saoms_core::report::RunReport;
use saoms_tools::timeline::{Curve, Lane, Mark, Panel, Timeline, slope, svg};

use super::outputs::Output;
use super::summary::outcome;

/// Least and greatest number of parts of a run in which its throughput is counted: a part has some pieces, where there
/// are enough.
const PARTS: (usize, usize) = (10, 60);
const PIECES: f64 = 2.0;
/// Events of a kind up to which each has a line through the panels; more would hide the curves.
const MOST_GUIDES: usize = 6;

/// The observer that draws the run over time (`--timeline`).
pub(super) struct TimelineFile {
    pub(super) output: Output,
    pub(super) title: String,
    pub(super) watch: Arc<AdaptationWatch>,
}

impl Observer for TimelineFile {
    fn interest(&self) -> Interest {
        Interest::NONE
    }

    fn end(&self, report: &RunReport) {
        let timeline = Timeline {
            title: self.title.clone(),
            subtitle: outcome(report),
            end_s: report.time_s,
            panels: panels(&self.watch.samples(), report.time_s),
            lanes: report.adaptation.as_ref().map(lanes).unwrap_or_default(),
        };
        self.output.write(|to| to.write_all(svg(&timeline).as_bytes()));
    }
}

/// The curves by their panels. Finished work is shown by its throughput.
fn panels(samples: &Samples, end_s: f64) -> Vec<Panel> {
    let mut panels: Vec<Panel> = Vec::new();
    for (place, curve) in samples.curves.iter().enumerate() {
        let points: Vec<(f64, f64)> = samples.points(place).collect();
        // Nobody says anything of it.
        if points.iter().all(|(_, value)| !value.is_finite()) {
            continue;
        }
        let (heading, points) = match curve.is_work {
            true => {
                let most = points.last().map_or(0.0, |(_, most)| *most);
                let parts = ((most / PIECES) as usize).clamp(PARTS.0, PARTS.1);
                (format!("{} per minute", curve.panel), slope(&points, end_s, parts))
            }
            false => (curve.panel.to_owned(), points),
        };
        let drawn = Curve { name: curve.name.to_owned(), points, is_filled: false };
        match panels.iter_mut().find(|panel| panel.heading == heading) {
            Some(panel) => panel.curves.push(drawn),
            None => panels.push(Panel { heading, curves: vec![drawn] }),
        }
    }
    for panel in &mut panels {
        if let [curve] = &mut panel.curves[..] {
            curve.is_filled = true;
            curve.name.clear();
        }
    }
    panels
}

/// A lane for each kind of event, in the order of the table.
fn lanes(report: &AdaptationReport) -> Vec<Lane> {
    let mut marks: BTreeMap<(bool, &str), Vec<Mark>> = BTreeMap::new();
    for event in &report.events {
        marks.entry((event.own, &event.kind)).or_default().push(mark(event));
    }
    let lanes = report.kinds.iter().map(|kind| Lane {
        name: kind.to_string(),
        is_guide: !kind.own && kind.count <= MOST_GUIDES,
        marks: marks.remove(&(kind.own, kind.kind.as_str())).unwrap_or_default(),
    });
    lanes.collect()
}

fn mark(event: &MeasuredEvent) -> Mark {
    let phases = [
        ("detected", event.detect_s),
        ("decided", event.decide_s),
        ("first effect", event.effect_s),
        ("settled", event.settle_s),
    ];
    let phases = phases.into_iter().filter_map(|(phase, time)| Some(format!(", {phase} after {:.3} s", time?)));
    Mark {
        from_s: event.time_s,
        to_s: event.settle_s.map(|settle| event.time_s + settle),
        text: format!("{} at {:.3} s{}", event.kind, event.time_s, phases.collect::<String>()),
    }
}

//! Timelines as SVG.

use std::fmt::Write as _;

use saoms_api::host::one_line;
use saoms_lang::syntax::escaped;

use super::axis::{number, scale, times};
use super::path::{Place, steps};
use super::{Lane, Mark, Panel, Timeline};

const WIDTH: f64 = 960.0;
/// The room for names of lanes and numbers of axes.
const LEFT: f64 = 190.0;
const RIGHT: f64 = 24.0;
const HEADING: f64 = 26.0;
const PANEL: f64 = 96.0;
const LANE: f64 = 20.0;
/// Lanes at most, and letters of their names.
const MOST_LANES: usize = 24;
const MOST_LETTERS: usize = 26;
/// Marks that are drawn at most; of those that would lie on each other one is drawn.
const MOST_MARKS: usize = 5000;

/// Curves with a colour of their own: of Okabe and Ito ("Color universal design", 2008) those that are seen well on
/// white, and lighter ones for black.
const COLOURS: usize = 4;

const STYLE: &str = "\
text{font-family:Helvetica,Arial,'Liberation Sans',sans-serif;font-size:12px;fill:#1c2733}\
.paper{fill:#fff}.title{font-size:18px;font-weight:bold}.heading{font-weight:bold}.small{fill:#56626f}\
.grid{stroke:#d5d9e0;fill:none}.curve{fill:none;stroke-width:1.8}.area{fill-opacity:.18}\
.curve.c0{stroke:#0072b2}.curve.c1{stroke:#d55e00}.curve.c2{stroke:#009e73}.curve.c3{stroke:#cc79a7}\
.area.c0{fill:#0072b2}.area.c1{fill:#d55e00}.area.c2{fill:#009e73}.area.c3{fill:#cc79a7}\
.guide{stroke:#b03a2e;stroke-dasharray:3 3}.span{fill:#b03a2e;fill-opacity:.1}\
.mark{fill:#b03a2e}.bar{fill:#b03a2e;fill-opacity:.45}.plain .mark{fill:#46617e}\
.plain .bar{fill:#46617e;fill-opacity:.45}\
@media (prefers-color-scheme:dark){text{fill:#e6e9ee}.paper{fill:#14181d}.small{fill:#a3adb8}.grid{stroke:#39424d}\
.guide{stroke:#f08a7e}.span{fill:#f08a7e}.mark,.bar{fill:#f08a7e}.plain .mark,.plain .bar{fill:#8fb0d3}\
.curve.c0{stroke:#56b4e9}.curve.c1{stroke:#ff9248}.curve.c2{stroke:#35c99c}.curve.c3{stroke:#e8a5cb}\
.area.c0{fill:#56b4e9}.area.c1{fill:#ff9248}.area.c2{fill:#35c99c}.area.c3{fill:#e8a5cb}}";

/// Draws a timeline as an SVG document without scripts, for light and dark backgrounds.
///
/// A mark of a lane has a bar until it is over; those of lanes with guides are lines through all panels, too. Tooltips
/// have the texts of the marks.
#[must_use]
pub fn svg(timeline: &Timeline) -> String {
    let lanes = &timeline.lanes[..timeline.lanes.len().min(MOST_LANES)];
    let panels_end = 64.0 + timeline.panels.len() as f64 * (HEADING + PANEL);
    let lanes_top = panels_end + 30.0;
    let hidden = timeline.lanes.len() - lanes.len();
    let height = lanes_top + lanes.len() as f64 * LANE + if hidden > 0 { LANE } else { 0.0 } + 12.0;
    let mut out = String::new();
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} \
         {height}\" role=\"img\">\n<title>{}</title>\n<style>{STYLE}</style>\n<rect class=\"paper\" width=\"{WIDTH}\" \
         height=\"{height}\"/>",
        shown(&timeline.title)
    );
    text(&mut out, "title", 24.0, 30.0, "start", &timeline.title);
    text(&mut out, "small", 24.0, 48.0, "start", &timeline.subtitle);
    let end = if timeline.end_s.is_finite() && timeline.end_s > 0.0 { timeline.end_s } else { 1.0 };
    let time = Place { left: LEFT, top: 0.0, width: WIDTH - LEFT - RIGHT, height: 1.0, end, most: 1.0 };
    let mut top = 64.0;
    for panel in &timeline.panels {
        draw_panel(&mut out, panel, Place { top: top + HEADING, height: PANEL - 14.0, ..time });
        top += HEADING + PANEL;
    }
    for (at, label) in times(end) {
        text(&mut out, "small", time.x(at), panels_end + 8.0, "middle", &label);
    }
    for mark in lanes.iter().filter(|lane| lane.is_guide).flat_map(known) {
        guide(&mut out, mark, &time, panels_end - 14.0);
    }
    for (place, lane) in lanes.iter().enumerate() {
        draw_lane(&mut out, lane, &time, lanes_top + place as f64 * LANE);
    }
    if hidden > 0 {
        let y = lanes_top + lanes.len() as f64 * LANE + 13.0;
        text(&mut out, "small", LEFT - 10.0, y, "end", &format!("and {hidden} more"));
    }
    out.push_str("</svg>\n");
    out
}

fn draw_panel(out: &mut String, panel: &Panel, place: Place) {
    let values = panel.curves.iter().flat_map(|curve| &curve.points).map(|(_, value)| *value);
    let (most, step) = scale(values.filter(|value| value.is_finite()).fold(0.0, f64::max));
    let place = Place { most, ..place };
    let _ = writeln!(out, "<g class=\"panel\">");
    text(out, "heading", place.left, place.top - 8.0, "start", &panel.heading);
    let lines = (0..=12_u32).map(|line| f64::from(line) * step).take_while(|value| *value <= most * 1.001);
    for value in lines {
        let (y, right) = (place.y(value), place.left + place.width);
        let _ = writeln!(out, "<path class=\"grid\" d=\"M{} {y}H{right}\"/>", place.left);
        text(out, "small", place.left - 10.0, y + 4.0, "end", &number(value).to_string());
    }
    let named = panel.curves.iter().filter(|curve| !curve.name.is_empty()).count();
    for (curve, colour) in panel.curves.iter().zip((0..COLOURS).cycle()) {
        let (line, area) = steps(&curve.points, &place);
        if curve.is_filled && !area.is_empty() {
            let _ = writeln!(out, "<path class=\"area c{colour}\" d=\"{area}\"/>");
        }
        if !line.is_empty() {
            let _ = writeln!(out, "<path class=\"curve c{colour}\" d=\"{line}\"/>");
        }
    }
    // The names stand at the right, above the panel.
    let entries = panel.curves.iter().zip((0..COLOURS).cycle()).filter(|(curve, _)| !curve.name.is_empty());
    for (entry, (curve, colour)) in entries.enumerate() {
        let x = place.left + place.width - 120.0 * (named - entry) as f64;
        let y = place.top - 12.0;
        let _ = writeln!(out, "<path class=\"curve c{colour}\" d=\"M{x} {y}h20\"/>");
        text(out, "small", x + 26.0, y + 4.0, "start", &short(&curve.name));
    }
    out.push_str("</g>\n");
}

/// The marks of a lane that have a place.
fn known(lane: &Lane) -> impl Iterator<Item = &Mark> {
    lane.marks.iter().filter(|mark| mark.from_s.is_finite())
}

fn guide(out: &mut String, mark: &Mark, time: &Place, bottom: f64) {
    let (x, top) = (time.x(mark.from_s), 64.0 + HEADING);
    if let Some(to) = mark.to_s.filter(|to| *to > mark.from_s) {
        let (width, height) = (number(time.x(to) - x), number(bottom - top));
        let _ = writeln!(out, "<rect class=\"span\" x=\"{x}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"/>");
    }
    let _ = writeln!(out, "<path class=\"guide\" d=\"M{x} {top}V{bottom}\"/>");
}

fn draw_lane(out: &mut String, lane: &Lane, time: &Place, top: f64) {
    let kind = if lane.is_guide { "lane" } else { "lane plain" };
    let _ = writeln!(out, "<g class=\"{kind}\">");
    text(out, "small", LEFT - 10.0, top + 13.0, "end", &short(&lane.name));
    let (middle, right) = (top + 9.0, time.left + time.width);
    let _ = writeln!(out, "<path class=\"grid\" d=\"M{} {middle}H{right}\"/>", time.left);
    let mut last = None;
    for mark in known(lane).take(MOST_MARKS) {
        let x = time.x(mark.from_s);
        let to = mark.to_s.map_or(x, |to| time.x(to));
        // It would cover another one.
        if last == Some((x, to)) {
            continue;
        }
        last = Some((x, to));
        let _ = write!(out, "<g><title>{}</title>", shown(&mark.text));
        if to > x {
            let (y, width) = (middle - 3.0, number(to - x));
            let _ = write!(out, "<rect class=\"bar\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"6\"/>");
        }
        let (left, y) = (number(x - 1.0), middle - 6.0);
        let _ = writeln!(out, "<rect class=\"mark\" x=\"{left}\" y=\"{y}\" width=\"2\" height=\"12\"/></g>");
    }
    out.push_str("</g>\n");
}

fn text(out: &mut String, class: &str, x: f64, y: f64, anchor: &str, text: &str) {
    let (x, y) = (number(x), number(y));
    let _ =
        writeln!(out, "<text class=\"{class}\" x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\">{}</text>", shown(text));
}

/// A text from outside.
fn shown(text: &str) -> String {
    escaped(&one_line(text)).to_string()
}

/// The beginning of a name that is too long.
fn short(name: &str) -> String {
    if name.chars().count() <= MOST_LETTERS {
        return name.to_owned();
    }
    name.chars().take(MOST_LETTERS - 1).chain(['\u{2026}']).collect()
}

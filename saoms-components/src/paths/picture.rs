//! The whole picture: the area with everything in it, and the legend beside or below it.

use super::density::{self, Shades};
use super::frame::{AXIS, Area, Frame};
use super::glyphs;
use super::lanes::{Lanes, Sharing, lanes};
use super::legend::{self, COLUMN};
use super::lines::{Ends, Lines};
use super::marks::{Marks, Tag};
use super::meaning;
use super::palette::{LOOKS, look};
use super::path::{Leg, Path, Robot};
use super::recording::Recording;
use super::svg::{Svg, number, shown};

/// The edge of the paper.
const MARGIN: f64 = 24.0;
/// The room of title and outcome.
const HEAD: f64 = 56.0;
/// The least distance of lanes that can be distinguished, and the largest that looks good.
const SPACING: (f64, f64) = (2.2, 5.5);
/// The longest side of an area on the paper.
const LONGEST: f64 = 2600.0;

/// Columns that a legend on the right may have, and the height that it may always have.
const ASIDE: usize = 3;
const SHORT: f64 = 420.0;

/// A path that is pointed at stands out: the others fade.
const STYLE: &str = "text { font-family: system-ui, Helvetica, Arial, sans-serif } \
                     .robots:hover .robot:not(:hover) { opacity: 0.15 }";

/// The style in which paths are shown.
pub(super) enum Style {
    Lines { lanes: Lanes, spacing: f64, sharing: Sharing },
    Density,
}

/// A robot that said where it is: its number, what is known of it, its path.
pub(super) type Moved<'a> = (u32, &'a Robot, &'a Path);

/// Draws a recording, under a title and a line about the end of the run.
pub(super) fn draw(recording: &Recording, title: &str, outcome: &str) -> String {
    let (svg, width, height) = drawn(recording, title, outcome);
    svg.finish(width, height, title)
}

/// A world with its robots, in a picture of several.
#[derive(Debug)]
pub(super) struct Panel {
    pub(super) name: String,
    pub(super) recording: Recording,
}

/// Draws several worlds below each other, each under its name.
pub(super) fn draw_several(panels: &[Panel], title: &str, outcome: &str) -> String {
    let mut svg = Svg::default();
    head(&mut svg, title, outcome);
    let mut size = (MARGIN + 7.2 * outcome.chars().count() as f64, MARGIN + HEAD);
    for Panel { name, recording } in panels {
        let (panel, width, height) = drawn(recording, name, "");
        svg.nest(&panel, size.1, (width, height), name);
        size = (size.0.max(width), size.1 + height);
    }
    svg.finish(size.0 + MARGIN, size.1 + MARGIN, title)
}

/// A recording with its title and a line below that, and the size of all.
fn drawn(recording: &Recording, title: &str, outcome: &str) -> (Svg, f64, f64) {
    let all = recording.robots.iter();
    let robots: Vec<Moved<'_>> =
        all.filter_map(|(number, robot)| Some((*number, robot, robot.path.as_ref()?))).collect();
    let mut svg = Svg::default();
    let Some(area) = Area::of(recording) else {
        head(&mut svg, title, "no robot said where it is: there is nothing to draw");
        return (svg, 640.0, MARGIN + HEAD);
    };
    let (style, cell) = choose(recording, &robots, &area);
    let frame = Frame { area, cell, left: MARGIN + AXIS, top: MARGIN + HEAD + AXIS };
    head(&mut svg, title, outcome);
    let marks = Marks { frame: &frame, recording };
    frame.draw_ground(&mut svg, recording.map.as_ref());
    let shades = match &style {
        Style::Lines { lanes, spacing, .. } => {
            marks.draw_chargers(&mut svg);
            frame.draw_grid(&mut svg);
            let lines = Lines { frame: &frame, lanes, spacing: *spacing };
            let tags = draw_lines(&mut svg, &lines, &robots);
            marks.draw(&mut svg, &tags);
            None
        }
        Style::Density => Some(draw_density(&mut svg, &marks, &robots)),
    };
    marks.draw_incidents(&mut svg);
    let groups = meaning::of(&marks, &style, &robots, shades.as_ref());
    // The legend stands on the right of an area that is not much wider than high, unless it is much longer than that.
    let fits = |columns: &usize| legend::height(&groups, *columns) <= frame.height().max(SHORT);
    let aside = (1..=ASIDE).find(fits).filter(|_| frame.width() <= 1.4 * frame.height());
    let columns = aside.unwrap_or(((frame.width() / COLUMN) as usize).max(1));
    let bottom = frame.top + frame.height();
    let (left, top) =
        if aside.is_some() { (frame.left + frame.width() + 32.0, frame.top) } else { (frame.left, bottom + 28.0) };
    let height = legend::draw(&mut svg, &groups, left, top, columns);
    let right = (frame.left + frame.width())
        .max(left + columns as f64 * COLUMN)
        .max(MARGIN + 7.2 * outcome.chars().count() as f64);
    (svg, right + MARGIN, bottom.max(top + height) + MARGIN)
}

/// Each pass has its own line where there is room for that; otherwise passes share lines, and in the end there are
/// none.
fn choose(recording: &Recording, robots: &[Moved<'_>], area: &Area) -> (Style, f64) {
    let widest = LONGEST / area.longest();
    let legs: Vec<&[Leg]> = robots.iter().map(|(.., path)| path.legs.as_slice()).collect();
    if robots.len() <= LOOKS && !recording.is_too_long() {
        for sharing in [Sharing::None, Sharing::Direction, Sharing::Robot] {
            let Some(lanes) = lanes(&legs, sharing) else { continue };
            let side_by_side = lanes.most.max(1) as f64;
            // Two corners for marks, and the lanes between them.
            let cell = (32.0 + SPACING.1 * side_by_side).clamp(64.0, 96.0).min(widest);
            let spacing = ((cell - 2.0 * (cell * 0.2).min(14.0)) / side_by_side).min(SPACING.1);
            if spacing >= SPACING.0 {
                return (Style::Lines { lanes, spacing, sharing }, cell);
            }
        }
    }
    (Style::Density, (1400.0 / area.longest()).clamp(2.0, 56.0).min(widest))
}

fn head(svg: &mut Svg, title: &str, outcome: &str) {
    svg.element("style", format_args!(""), STYLE);
    svg.leaf("rect", format_args!(r##"width="100%" height="100%" fill="#fff""##));
    let line = |svg: &mut Svg, y: f64, style: &str, text: &str| {
        svg.element("text", format_args!(r#"x="{}" y="{}" {style}"#, number(MARGIN), number(y)), text);
    };
    line(svg, MARGIN + 18.0, r##"class="title" font-size="20" font-weight="bold" fill="#16191f""##, title);
    line(svg, MARGIN + 40.0, r##"class="outcome" font-size="13" fill="#5b6270""##, outcome);
}

/// Lines, then the points where they begin and end; what is left to draw are the robots' numbers there.
fn draw_lines(svg: &mut Svg, lines: &Lines<'_>, robots: &[Moved<'_>]) -> Vec<Tag> {
    let mut tags = Vec::new();
    let mut ends: Vec<Ends> = Vec::new();
    svg.open("g", format_args!(r#"class="robots""#));
    for (place, (_, robot, path)) in robots.iter().enumerate() {
        svg.open("g", format_args!(r#"class="robot" data-robot="{}""#, shown(&robot.name)));
        svg.element("title", format_args!(""), &format!("{}: {}", robot.name, meaning::deeds(robot, path)));
        ends.push(lines.draw(svg, place, path));
        svg.close();
    }
    svg.close();
    for (place, (ends, (number, _, path))) in ends.iter().zip(robots).enumerate() {
        let look = look(place);
        let width = lines.width();
        glyphs::end(svg, ends.end.0, ends.end.1, width, &look, true);
        glyphs::end(svg, ends.start.0, ends.start.1, width, &look, false);
        for (block, hollow) in [(path.start, false), (path.now, true)] {
            tags.push(Tag { block, text: number.to_string(), look, hollow });
        }
    }
    tags
}

/// Shades instead of lines, with a point where each robot ended.
fn draw_density(svg: &mut Svg, marks: &Marks<'_>, robots: &[Moved<'_>]) -> Shades {
    let (frame, recording) = (marks.frame, marks.recording);
    let shades = density::draw(svg, frame, recording);
    frame.draw_grid(svg);
    marks.draw_chargers_outlined(svg);
    marks.draw(svg, &[]);
    svg.open("g", format_args!(r##"class="last" fill="#000" stroke="#fff""##));
    for (_, robot, path) in robots.iter().filter(|(.., path)| frame.area.contains(path.now)) {
        let (x, y) = frame.middle(path.now);
        let place =
            format!(r#"cx="{}" cy="{}" r="{}""#, number(x), number(y), number((frame.cell * 0.2).clamp(1.0, 5.0)));
        svg.open("circle", format_args!("{place}"));
        svg.element("title", format_args!(""), &format!("{}: {}", robot.name, meaning::deeds(robot, path)));
        svg.close();
    }
    svg.close();
    shades
}

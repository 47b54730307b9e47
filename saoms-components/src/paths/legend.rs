//! The legend: the meaning of signs and colours, and the deeds of each robot.

use super::glyphs::{self, Incident};
use super::lines::dashes;
use super::palette::Look;
use super::svg::{Svg, number};

/// The width of a column.
pub(super) const COLUMN: f64 = 284.0;

/// Letters of a robot's name and of what it did that fit into a column.
const NAME: usize = 26;
pub(super) const DEEDS: usize = 34;

/// One line of the legend.
pub(super) enum Entry {
    /// A robot with its line, and what it did.
    Robot { look: Look, number: String, name: String, deeds: String },
    /// A robot in a picture without lines.
    Plain { name: String, deeds: String },
    /// A sign and its meaning.
    Sign { sign: Sign, text: String },
}

/// A sign that needs an explanation.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sign {
    Blocked,
    Charger,
    Collect,
    Wait,
    Deliver,
    Start,
    End,
    Unheard,
    /// An arrow in a block.
    Flow,
    Incident(Incident),
    Shade(&'static str),
    /// No picture: the text alone.
    Note,
}

impl Entry {
    fn height(&self) -> f64 {
        match self {
            Entry::Robot { .. } => 36.0,
            Entry::Plain { .. } => 19.0,
            Entry::Sign { .. } => 22.0,
        }
    }

    fn draw(&self, svg: &mut Svg, x: f64, y: f64) {
        match self {
            Entry::Robot { look, number, name, deeds } => {
                glyphs::tag(svg, x, y + 2.0, number, look, false);
                let (from, to) = (x + 34.0, x + 68.0);
                svg.leaf(
                    "path",
                    format_args!(
                        r#"d="M{} {}H{}" fill="none" stroke="{}" stroke-width="3"{}"#,
                        self::number(from),
                        self::number(y + 9.0),
                        self::number(to),
                        look.colour,
                        dashes(look, 3.0)
                    ),
                );
                text(svg, x + 76.0, y + 13.0, 13, "#16191f", &short(name, NAME));
                text(svg, x + 76.0, y + 27.0, 11, "#5b6270", &short(deeds, DEEDS));
            }
            Entry::Plain { name, deeds } => {
                text(svg, x, y + 13.0, 12, "#16191f", &short(&format!("{name}: {deeds}"), 40));
            }
            Entry::Sign { sign, text: meaning } => {
                sign.draw(svg, x + 12.0, y + 9.0);
                let indent = if matches!(sign, Sign::Note) { 0.0 } else { 34.0 };
                text(svg, x + indent, y + 13.0, 12, "#2f343d", meaning);
            }
        }
    }
}

impl Sign {
    fn draw(self, svg: &mut Svg, x: f64, y: f64) {
        let tile = |svg: &mut Svg, fill: &str| {
            svg.leaf(
                "rect",
                format_args!(
                    r##"x="{}" y="{}" width="18" height="14" fill="{fill}" stroke="#d5d9e0""##,
                    number(x - 9.0),
                    number(y - 7.0)
                ),
            );
        };
        match self {
            Sign::Blocked => tile(svg, "#8a8f98"),
            Sign::Shade(shade) => tile(svg, shade),
            Sign::Charger => {
                tile(svg, glyphs::CHARGER);
                glyphs::bolt(svg, x, y, 11.0);
            }
            Sign::Collect => glyphs::luggage(svg, x, y, 11.0, "collect"),
            Sign::Wait => glyphs::luggage(svg, x, y, 11.0, "wait"),
            Sign::Deliver => glyphs::luggage(svg, x, y, 11.0, "deliver"),
            Sign::Start => glyphs::end(svg, x, y, 3.0, &super::palette::look(4), false),
            Sign::End => glyphs::end(svg, x, y, 3.0, &super::palette::look(4), true),
            Sign::Unheard => svg.leaf(
                "path",
                format_args!(r##"d="M{} {}h24" stroke="#000" stroke-dasharray="2 4""##, number(x - 12.0), number(y)),
            ),
            Sign::Flow => svg.leaf(
                "path",
                format_args!(
                    r##"d="M{} {}l6 6l-6 6" fill="none" stroke="#2f343d" stroke-width="1.1""##,
                    number(x - 3.0),
                    number(y - 6.0)
                ),
            ),
            Sign::Incident(incident) => glyphs::incident(svg, x, y, 17.0, incident, 1),
            Sign::Note => {}
        }
    }
}

/// Entries under a heading.
pub(super) struct Group {
    pub(super) heading: &'static str,
    pub(super) entries: Vec<Entry>,
}

/// The height of groups in so many columns.
pub(super) fn height(groups: &[Group], columns: usize) -> f64 {
    draw(&mut Svg::default(), groups, 0.0, 0.0, columns)
}

/// Draws the groups one below the other, each in so many columns, and returns how high they are together.
pub(super) fn draw(svg: &mut Svg, groups: &[Group], left: f64, top: f64, columns: usize) -> f64 {
    let mut y = top;
    svg.open("g", format_args!(r#"class="legend""#));
    for group in groups.iter().filter(|group| !group.entries.is_empty()) {
        svg.element(
            "text",
            format_args!(
                r##"x="{}" y="{}" font-size="13" font-weight="bold" fill="#16191f""##,
                number(left),
                number(y + 13.0)
            ),
            group.heading,
        );
        y += 24.0;
        let rows = group.entries.len().div_ceil(columns.max(1));
        let mut lowest = y;
        for (column, entries) in group.entries.chunks(rows.max(1)).enumerate() {
            let mut at = y;
            for entry in entries {
                entry.draw(svg, left + column as f64 * COLUMN, at);
                at += entry.height();
            }
            lowest = lowest.max(at);
        }
        y = lowest + 14.0;
    }
    svg.close();
    y - top
}

fn text(svg: &mut Svg, x: f64, y: f64, size: u32, fill: &str, text: &str) {
    svg.element("text", format_args!(r#"x="{}" y="{}" font-size="{size}" fill="{fill}""#, number(x), number(y)), text);
}

/// The end of a name says more than its beginning: that is what is left out.
fn short(text: &str, most: usize) -> String {
    let length = text.chars().count();
    if length <= most {
        return text.to_owned();
    }
    let rest: String = text.chars().skip(length + 1 - most).collect();
    format!("\u{2026}{rest}")
}

//! The signs of a picture, each in a square of a given size around a point.

use super::palette::Look;
use super::svg::{Svg, number, shown};

/// An incident of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Incident {
    Collision,
    Stranded,
    Breakdown,
}

const ALARM: &str = "#b3001b";
const INK: &str = "#2f343d";

/// The colour of blocks with a charger.
pub(super) const CHARGER: &str = "#fdf0c0";

pub(super) fn bolt(svg: &mut Svg, x: f64, y: f64, size: f64) {
    let at = |dx: f64, dy: f64| format!("{} {}", number(x + dx * size), number(y + dy * size));
    let corners = [(0.1, -0.5), (-0.35, 0.08), (-0.02, 0.08), (-0.15, 0.5), (0.35, -0.12), (0.02, -0.12)];
    let d = corners.map(|(dx, dy)| at(dx, dy)).join("L");
    svg.leaf("path", format_args!(r##"class="charger-sign" d="M{d}z" fill="#8a5a00""##));
}

/// A triangle that points up where luggage is collected, and down where it is delivered; hollow while it waits.
pub(super) fn luggage(svg: &mut Svg, x: f64, y: f64, size: f64, class: &str) {
    let (half, tip) = (size / 2.0, if class == "deliver" { 1.0 } else { -1.0 });
    let (tip, base) = (y + tip * half * 0.9, y - tip * half * 0.9);
    let (fill, edge) = if class == "wait" { ("#fff", INK) } else { (INK, "#fff") };
    svg.leaf("path", format_args!(
        r#"class="{class}" d="M{} {}L{} {}L{} {}z" fill="{fill}" stroke="{edge}" stroke-width="1" stroke-linejoin="round""#,
        number(x), number(tip), number(x - half), number(base), number(x + half), number(base)
    ));
}

/// A mark with what happened, and how often where that was more than once.
pub(super) fn incident(svg: &mut Svg, x: f64, y: f64, size: f64, incident: Incident, count: u32) {
    let half = size / 2.0;
    let style = format!(r##"fill="{ALARM}" stroke="#fff" stroke-width="1.5" stroke-linejoin="round""##);
    let (class, sign) = match incident {
        Incident::Collision => ("collision", "\u{d7}"),
        Incident::Stranded => ("stranded", "0"),
        Incident::Breakdown => ("breakdown", "!"),
    };
    svg.open("g", format_args!(r#"class="{class}""#));
    match incident {
        Incident::Collision => {
            let points: Vec<String> = (0..16)
                .map(|point| {
                    let (radius, angle) = (
                        if point % 2 == 0 { half } else { half * 0.68 },
                        f64::from(point) * std::f64::consts::PI / 8.0,
                    );
                    format!("{} {}", number(x + radius * angle.sin()), number(y - radius * angle.cos()))
                })
                .collect();
            svg.leaf("path", format_args!(r#"d="M{}z" {style}"#, points.join("L")));
        }
        Incident::Stranded => {
            svg.leaf(
                "path",
                format_args!(
                    r#"d="M{} {}h{}v{}h{}v{}h{}v{}h-{}z" {style}"#,
                    number(x - half * 0.9),
                    number(y - half * 0.62),
                    number(size * 0.8),
                    number(half * 0.32),
                    number(size * 0.12),
                    number(half * 0.6),
                    number(-size * 0.12),
                    number(half * 0.32),
                    number(size * 0.8)
                ),
            );
        }
        Incident::Breakdown => {
            let (long, short) = (half * 0.92, half * 0.38);
            let corners = [
                (-short, -long),
                (short, -long),
                (long, -short),
                (long, short),
                (short, long),
                (-short, long),
                (-long, short),
                (-long, -short),
            ];
            let d = corners.map(|(dx, dy)| format!("{} {}", number(x + dx), number(y + dy))).join("L");
            svg.leaf("path", format_args!(r#"d="M{d}z" {style}"#));
        }
    }
    if size >= 10.0 {
        let sign = if count > 1 { count.to_string() } else { sign.to_owned() };
        let font = if sign.chars().count() > 2 { size * 0.38 } else { size * 0.55 };
        svg.element(
            "text",
            format_args!(
                r##"x="{}" y="{}" font-size="{}" font-weight="bold" fill="#fff" text-anchor="middle""##,
                number(x),
                number(y + font * 0.36),
                number(font)
            ),
            &sign,
        );
    }
    svg.close();
}

/// The width of the label with a robot's number.
pub(super) fn tag_width(text: &str) -> f64 {
    6.6 * text.chars().count() as f64 + 7.0
}

/// The height of such a label.
pub(super) const TAG: f64 = 14.0;

/// A label with a robot's number, from its upper left corner: full where the robot starts, hollow where it ends.
pub(super) fn tag(svg: &mut Svg, x: f64, y: f64, text: &str, look: &Look, hollow: bool) {
    let (width, fill, ink) =
        (tag_width(text), if hollow { "#fff" } else { look.colour }, if hollow { "#000" } else { look.on_colour });
    let class = if hollow { "end" } else { "start" };
    svg.open("g", format_args!(r#"class="tag {class}" data-robot="{}""#, shown(text)));
    svg.leaf(
        "rect",
        format_args!(
            r#"x="{}" y="{}" width="{}" height="{}" rx="3" fill="{fill}" stroke="{}" stroke-width="1.5""#,
            number(x),
            number(y),
            number(width),
            number(TAG),
            look.colour
        ),
    );
    svg.element(
        "text",
        format_args!(
            r#"x="{}" y="{}" font-size="11" font-weight="bold" fill="{ink}" text-anchor="middle""#,
            number(x + width / 2.0),
            number(y + 11.0)
        ),
        text,
    );
    svg.close();
}

/// The point where a path begins, or ends.
pub(super) fn end(svg: &mut Svg, x: f64, y: f64, width: f64, look: &Look, hollow: bool) {
    let colour = look.colour;
    if hollow {
        let side = width * 2.6;
        svg.leaf(
            "rect",
            format_args!(
                r##"x="{}" y="{}" width="{}" height="{}" fill="#fff" stroke="{colour}" stroke-width="{}""##,
                number(x - side / 2.0),
                number(y - side / 2.0),
                number(side),
                number(side),
                number(width * 0.7)
            ),
        );
    } else {
        svg.leaf(
            "circle",
            format_args!(
                r##"cx="{}" cy="{}" r="{}" fill="{colour}" stroke="#fff" stroke-width="1""##,
                number(x),
                number(y),
                number(width * 1.6)
            ),
        );
    }
}

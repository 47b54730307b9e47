//! Timelines: curves of a run over time, and below them lanes with what happened.
//!
//! A [`Timeline`] is what there is to draw, [`svg`] draws it. It knows neither a run nor what the curves mean.

mod axis;
mod draw;
mod path;
#[cfg(test)]
mod tests;

pub use draw::svg;

/// A timeline from 0 to its end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timeline {
    /// The title.
    pub title: String,
    /// A line below it.
    pub subtitle: String,
    /// The end, in seconds.
    pub end_s: f64,
    /// The panels, one below the other.
    pub panels: Vec<Panel>,
    /// The lanes below them.
    pub lanes: Vec<Lane>,
}

/// Curves of one unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// The heading, with the unit.
    pub heading: String,
    /// The curves.
    pub curves: Vec<Curve>,
}

/// A curve, constant from each of its points to the next.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// The name; empty where the heading says it.
    pub name: String,
    /// Seconds and values; a value that is not finite is a gap.
    pub points: Vec<(f64, f64)>,
    /// True if the area below it is filled.
    pub is_filled: bool,
}

/// Events of one kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lane {
    /// The name.
    pub name: String,
    /// True if its marks are drawn through the panels, too.
    pub is_guide: bool,
    /// The events.
    pub marks: Vec<Mark>,
}

/// An event.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mark {
    /// When it happened, in seconds.
    pub from_s: f64,
    /// When it was over, in seconds; `None` if that is not known.
    pub to_s: Option<f64>,
    /// Its tooltip.
    pub text: String,
}

/// The slope of a curve that only grows, a minute, in so many equal parts of the time until `end_s`.
///
/// ```
/// use saoms_tools::timeline::slope;
///
/// let done = [(0.0, 0.0), (30.0, 4.0), (60.0, 4.0)];
/// assert_eq!(slope(&done, 60.0, 2), [(0.0, 8.0), (30.0, 0.0), (60.0, 0.0)]);
/// ```
#[must_use]
pub fn slope(points: &[(f64, f64)], end_s: f64, parts: usize) -> Vec<(f64, f64)> {
    let width = end_s / parts.max(1) as f64;
    if !width.is_finite() || width <= 0.0 {
        return Vec::new();
    }
    let at = |time: f64| {
        let after = points.partition_point(|(point, _)| *point <= time + width * 1e-9);
        after.checked_sub(1).and_then(|place| points.get(place)).map_or(0.0, |(_, value)| *value)
    };
    let rate = |part: usize| (at((part + 1) as f64 * width) - at(part as f64 * width)) * 60.0 / width;
    let mut slope: Vec<(f64, f64)> = (0..parts).map(|part| (part as f64 * width, rate(part))).collect();
    slope.extend(slope.last().map(|(_, last)| (end_s, *last)));
    slope
}

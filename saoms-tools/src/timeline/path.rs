//! The path of a curve in a panel.

use std::fmt::Write as _;

use super::axis::number;

/// Where values are in the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
    /// The end of the time, in seconds, and of the values.
    pub(super) end: f64,
    pub(super) most: f64,
}

impl Place {
    pub(super) fn x(&self, time: f64) -> f64 {
        tenth(self.left + (time / self.end).clamp(0.0, 1.0) * self.width)
    }

    pub(super) fn y(&self, value: f64) -> f64 {
        tenth(self.top + (1.0 - (value / self.most).clamp(0.0, 1.0)) * self.height)
    }
}

fn tenth(value: f64) -> f64 {
    number((value * 10.0).round() / 10.0)
}

/// The path of steps through these points, and that of the area below them. What cannot be seen is left out: points
/// without a change of a tenth of a pixel.
pub(super) fn steps(points: &[(f64, f64)], place: &Place) -> (String, String) {
    let (mut line, mut area) = (String::new(), String::new());
    let bottom = place.y(0.0);
    let mut last: Option<(f64, f64)> = None;
    for (time, value) in points {
        let x = place.x(*time);
        match (last, value.is_finite()) {
            (None, true) => {
                let y = place.y(*value);
                let _ = write!(line, "M{x} {y}");
                let _ = write!(area, "M{x} {bottom}V{y}");
                last = Some((x, y));
            }
            (Some((_, before)), true) => {
                let y = place.y(*value);
                if (y - before).abs() > f64::EPSILON {
                    let _ = write!(line, "H{x}V{y}");
                    let _ = write!(area, "H{x}V{y}");
                }
                last = Some((x, y));
            }
            (Some(_), false) => {
                let _ = write!(line, "H{x}");
                let _ = write!(area, "H{x}V{bottom}Z");
                last = None;
            }
            (None, false) => {}
        }
    }
    if let Some((x, _)) = last {
        let _ = write!(line, "H{x}");
        let _ = write!(area, "H{x}V{bottom}Z");
    }
    (line, area)
}

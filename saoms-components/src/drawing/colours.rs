//! The colours of a drawing: those of the dashboard, which are told apart on light and on dark grounds.

use super::messages::Color;

/// A robot that is free, and texts.
pub(super) const MUTED: Color = colour(0x5A_6978);
/// A robot that goes to luggage, luggage that has a robot, and zones.
pub(super) const ACCENT: Color = colour(0x1F_5FD0);
/// A robot that carries luggage.
pub(super) const GOOD: Color = colour(0x1B_7A50);
/// Luggage that waits for a robot, and chargers.
pub(super) const WARN: Color = colour(0xB2_6A00);
/// A robot that cannot go on.
pub(super) const DANGER: Color = colour(0xC0_311E);
/// A robot that sleeps, and blocks.
pub(super) const PALE: Color = colour(0x96_A4B3);

const fn colour(rgb: u32) -> Color {
    Color { r: part(rgb >> 16), g: part(rgb >> 8), b: part(rgb), a: 1.0 }
}

const fn part(byte: u32) -> f64 {
    (byte & 0xFF) as f64 / 255.0
}

/// The same colour, through which others are seen.
pub(super) const fn clear(Color { r, g, b, .. }: Color) -> Color {
    Color { r, g, b, a: 0.4 }
}

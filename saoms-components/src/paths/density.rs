//! The picture of too many paths to distinguish them: blocks shaded by how often they were entered.

use super::frame::Frame;
use super::palette::SHADES;
use super::recording::Recording;
use super::svg::{Svg, number};

/// Blocks at least that long have room for an arrow.
pub(super) const ARROWED: f64 = 12.0;

/// The classes of a picture: from how many times on each shade is used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Shades {
    /// The least number of each class, ascending.
    from: Vec<u64>,
    most: u64,
}

impl Shades {
    /// Classes for numbers up to `most`: classes of small numbers are finer.
    pub(super) fn up_to(most: u64) -> Shades {
        let classes = SHADES.len() as u64;
        let mut from: Vec<u64> =
            (0..classes).map(|class| (most * class * class).div_ceil(classes * classes).max(class + 1)).collect();
        from.retain(|least| *least <= most.max(1));
        Shades { from, most }
    }

    fn class(&self, count: u64) -> usize {
        self.from.partition_point(|least| *least <= count).saturating_sub(1)
    }

    fn shade(&self, class: usize) -> &'static str {
        // Few classes are spread over all shades.
        let last = self.from.len().saturating_sub(1);
        SHADES[(class * (SHADES.len() - 1)).checked_div(last).unwrap_or(0)]
    }

    /// Each shade, and the numbers that it represents.
    pub(super) fn legend(&self) -> impl Iterator<Item = (&'static str, String)> {
        self.from.iter().enumerate().map(|(class, least)| {
            let most = self.from.get(class + 1).map_or(self.most, |next| next - 1);
            let text = if most <= *least { least.to_string() } else { format!("{least}\u{2013}{most}") };
            (self.shade(class), text)
        })
    }
}

/// Shades the blocks, and shows by an arrow which way most went where there was one.
pub(super) fn draw(svg: &mut Svg, frame: &Frame, recording: &Recording) -> Shades {
    let visits = recording.visits.iter().filter(|(block, _)| frame.area.contains(**block));
    let shades = Shades::up_to(visits.clone().map(|(_, visits)| visits.count).max().unwrap_or(0));
    let mut tiles = vec![String::new(); shades.from.len()];
    let mut arrows = String::new();
    let cell = number(frame.cell);
    for (block, visits) in visits {
        let (x, y) = frame.corner(*block);
        tiles[shades.class(visits.count)].push_str(&format!("M{} {}h{cell}v{cell}h-{cell}z", number(x), number(y)));
        let (right, down) = (visits.right.unsigned_abs(), visits.down.unsigned_abs());
        if frame.cell >= ARROWED && right.max(down) * 2 > visits.count {
            let (x, y) = frame.middle(*block);
            let long = (frame.cell * 0.22).min(6.0);
            let (dx, dy) = if right > down {
                (long * visits.right.signum() as f64, 0.0)
            } else {
                (0.0, long * visits.down.signum() as f64)
            };
            arrows.push_str(&format!(
                "M{} {}L{} {}L{} {}",
                number(x - dx * 0.5 - dy),
                number(y - dy * 0.5 - dx),
                number(x + dx * 0.5),
                number(y + dy * 0.5),
                number(x - dx * 0.5 + dy),
                number(y - dy * 0.5 + dx)
            ));
        }
    }
    svg.open("g", format_args!(r#"class="density""#));
    for (class, tiles) in tiles.iter().enumerate().filter(|(_, tiles)| !tiles.is_empty()) {
        svg.leaf("path", format_args!(r#"d="{tiles}" fill="{}""#, shades.shade(class)));
    }
    svg.close();
    if !arrows.is_empty() {
        svg.leaf("path", format_args!(
            r##"class="flow" d="{arrows}" fill="none" stroke="#fff" stroke-width="2.2" stroke-linecap="round" stroke-linejoin="round""##
        ));
        svg.leaf("path", format_args!(
            r##"class="flow" d="{arrows}" fill="none" stroke="#2f343d" stroke-width="1.1" stroke-linecap="round" stroke-linejoin="round""##
        ));
    }
    shades
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_has_the_shade_that_the_legend_says() {
        for most in [1, 2, 5, 6, 7, 36, 100, 12_345] {
            let shades = Shades::up_to(most);
            let legend: Vec<String> = shades.legend().map(|(_, text)| text).collect();
            let mut expected = 1;
            for text in &legend {
                let (least, last) = text.split_once('\u{2013}').unwrap_or((text, text));
                assert_eq!(least.parse(), Ok(expected), "{most}: {legend:?}");
                expected = last.parse::<u64>().unwrap() + 1;
                for count in [least.parse().unwrap(), expected - 1] {
                    assert_eq!(legend[shades.class(count)], *text);
                }
            }
            assert_eq!(expected, most + 1, "{legend:?}");
        }
    }
}

//! Marks in blocks, beside paths: chargers, luggage, the robots' numbers, and incidents.

use std::collections::{BTreeMap, BTreeSet};

use crate::grid::Block;

use super::frame::Frame;
use super::glyphs::{self, Incident};
use super::palette::Look;
use super::path::Pieces;
use super::recording::Recording;
use super::svg::{Svg, number};

/// Blocks at least that long have room for numbers.
pub(super) const NUMBERED: f64 = 44.0;

/// The distance of marks from the edge of their block.
const INSET: f64 = 3.0;

/// A robot's number where it starts, or ends.
pub(super) struct Tag {
    pub(super) block: Block,
    pub(super) text: String,
    pub(super) look: Look,
    pub(super) hollow: bool,
}

pub(super) struct Marks<'a> {
    pub(super) frame: &'a Frame,
    pub(super) recording: &'a Recording,
}

impl Marks<'_> {
    /// The size of the marks in the corners of blocks.
    fn size(&self) -> f64 {
        (self.frame.cell * 0.2).clamp(3.0, 12.0)
    }

    fn inside<T>(&self, block: &Block, value: T) -> Option<T> {
        self.frame.area.contains(*block).then_some(value)
    }

    /// The blocks that chargers stand on, all of them.
    pub(super) fn chargers(&self) -> BTreeSet<Block> {
        let chargers = self.recording.robots.values().filter_map(|robot| robot.charger);
        chargers.filter(|block| self.frame.area.contains(*block)).collect()
    }

    /// Below the grid: the ground of blocks with a charger.
    pub(super) fn draw_chargers(&self, svg: &mut Svg) {
        let cell = number(self.frame.cell);
        let tiles: String = self
            .chargers()
            .into_iter()
            .map(|block| {
                let (x, y) = self.frame.corner(block);
                format!("M{} {}h{cell}v{cell}h-{cell}z", number(x), number(y))
            })
            .collect();
        if !tiles.is_empty() {
            svg.leaf("path", format_args!(r#"class="chargers" d="{tiles}" fill="{}""#, glyphs::CHARGER));
        }
    }

    /// Above shades: the outlines of these blocks.
    pub(super) fn draw_chargers_outlined(&self, svg: &mut Svg) {
        let width = (self.frame.cell * 0.12).clamp(0.6, 3.0);
        let side = number(self.frame.cell - width);
        for block in self.chargers() {
            let (x, y) = self.frame.corner(block);
            svg.leaf("rect", format_args!(
                r##"class="charger" x="{}" y="{}" width="{side}" height="{side}" fill="none" stroke="#e0a100" stroke-width="{}""##,
                number(x + width / 2.0), number(y + width / 2.0), number(width)
            ));
        }
    }

    /// The signs in the corners of blocks, and the numbers of the robots that start and end there.
    pub(super) fn draw(&self, svg: &mut Svg, tags: &[Tag]) {
        let size = self.size();
        if self.frame.cell >= 16.0 {
            for block in self.chargers() {
                let (x, y) = self.frame.corner(block);
                glyphs::bolt(svg, x + INSET + size / 2.0, y + INSET + size / 2.0, size);
            }
        }
        let mut waiting: BTreeMap<Block, Pieces> = BTreeMap::new();
        for (luggage, block) in &self.recording.open {
            waiting.entry(*block).or_default().add(*luggage);
        }
        let mut by_block: BTreeMap<Block, Vec<&Tag>> = BTreeMap::new();
        for tag in tags {
            by_block.entry(tag.block).or_default().push(tag);
        }
        let cell = self.frame.cell;
        for (block, pieces) in &self.recording.collected {
            let bolt = if self.chargers().contains(block) { size + INSET } else { 0.0 };
            self.draw_luggage(svg, *block, "collect", pieces, cell - bolt);
        }
        for (block, pieces) in waiting {
            // Beside the luggage that was collected there.
            let taken = if self.recording.collected.contains_key(&block) { cell / 2.0 } else { 0.0 };
            self.draw_luggage(svg, block, "wait", &pieces, cell - taken);
        }
        for (block, pieces) in &self.recording.delivered {
            let tags = by_block.get(block).into_iter().flatten();
            let taken: f64 = tags.map(|tag| glyphs::tag_width(&tag.text) + 2.0).sum();
            self.draw_luggage(svg, *block, "deliver", pieces, cell - taken);
        }
        for (block, tags) in by_block {
            self.draw_tags(svg, block, &tags);
        }
    }

    /// A triangle in a corner with the numbers of the luggage, or how many pieces it is, as far as there is room.
    fn draw_luggage(&self, svg: &mut Svg, block: Block, class: &str, pieces: &Pieces, room: f64) {
        let (size, cell) = (self.size(), self.frame.cell);
        if cell < 8.0 {
            return;
        }
        let Some((left, top)) = self.inside(&block, self.frame.corner(block)) else { return };
        let y = if class == "deliver" { top + cell - INSET - size / 2.0 } else { top + INSET + size / 2.0 };
        let taken = cell.min(room);
        let x = if class == "wait" && taken < cell { left + taken - INSET } else { left + cell - INSET } - size / 2.0;
        glyphs::luggage(svg, x, y, size, class);
        let label = pieces.numbers(2).unwrap_or_else(|| format!("\u{d7}{}", pieces.count));
        let width = 6.0 * label.chars().count() as f64;
        if cell < NUMBERED || room < width + size + 3.0 * INSET {
            return;
        }
        let at = format!(r#"x="{}" y="{}""#, number(x - size / 2.0 - 2.5), number(y + 3.6));
        svg.element("text", format_args!(
            r##"class="pieces" {at} font-size="10" fill="#2f343d" text-anchor="end" stroke="#fff" stroke-width="2.5" paint-order="stroke""##
        ), &label);
    }

    /// Numbers in the lower left corner, as many as there is room for.
    fn draw_tags(&self, svg: &mut Svg, block: Block, tags: &[&Tag]) {
        let Some((left, top)) = self.inside(&block, self.frame.corner(block)) else { return };
        let end = left + self.frame.cell;
        let mut x = left + INSET - 1.0;
        let y = top + (self.frame.cell - glyphs::TAG - INSET + 1.0).max(0.0);
        for tag in tags {
            let width = glyphs::tag_width(&tag.text);
            if x > left + INSET && x + width > end {
                break;
            }
            glyphs::tag(svg, x, y, &tag.text, &tag.look, tag.hollow);
            x += width + 2.0;
        }
    }

    /// The number of incidents, by block and kind.
    pub(super) fn incidents(&self) -> BTreeMap<(Block, Incident), u32> {
        let mut found = BTreeMap::new();
        let mut add = |block: Block, incident: Incident, count: u32| {
            if self.frame.area.contains(block) {
                *found.entry((block, incident)).or_insert(0) += count;
            }
        };
        for (block, count) in &self.recording.collisions {
            add(*block, Incident::Collision, *count);
        }
        for (block, count) in &self.recording.breakdowns {
            add(*block, Incident::Breakdown, *count);
        }
        for robot in self.recording.robots.values().filter(|robot| robot.empty) {
            if let Some(path) = &robot.path {
                add(path.now, Incident::Stranded, 1);
            }
        }
        found
    }

    pub(super) fn draw_incidents(&self, svg: &mut Svg) {
        let size = (self.frame.cell * 0.42).clamp(8.0, 24.0);
        for ((block, incident), count) in self.incidents() {
            let (x, y) = self.frame.middle(block);
            let aside = match incident {
                Incident::Collision => 0.0,
                Incident::Stranded => size * 0.7,
                Incident::Breakdown => -size * 0.7,
            };
            glyphs::incident(svg, x + aside, y, size, incident, count);
        }
    }
}

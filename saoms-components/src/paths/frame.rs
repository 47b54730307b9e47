use crate::grid::{Block, Map};

use super::recording::Recording;
use super::svg::{Svg, number};

/// The blocks that a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Area {
    left: i32,
    top: i32,
    width: u32,
    height: u32,
}

impl Area {
    /// The world's map or, without a world, all blocks from (0,0) on that somebody was on or spoke of. `None` where
    /// that is none.
    pub(super) fn of(recording: &Recording) -> Option<Area> {
        if let Some(map) = &recording.map {
            return Some(Area { left: 0, top: 0, width: map.width(), height: map.height() });
        }
        let chargers = recording.robots.values().filter_map(|robot| robot.charger);
        let luggage = recording.collected.keys().chain(recording.delivered.keys()).chain(recording.open.values());
        let blocks: Vec<Block> = recording.visits.keys().chain(luggage).copied().chain(chargers).collect();
        let side = |at: fn(&Block) -> i32| {
            let (least, most) = (blocks.iter().map(at).min()?, blocks.iter().map(at).max()?);
            let least = least.min(0);
            Some((least, most.abs_diff(least).saturating_add(1).min(Map::LONGEST)))
        };
        let ((left, width), (top, height)) = (side(|block| block.x)?, side(|block| block.y)?);
        Some(Area { left, top, width, height })
    }

    /// The number of blocks of its longer side.
    pub(super) fn longest(&self) -> f64 {
        f64::from(self.width.max(self.height))
    }

    pub(super) fn contains(&self, block: Block) -> bool {
        let inside = |at: i32, from: i32, length: u32| at >= from && at.abs_diff(from) < length;
        inside(block.x, self.left, self.width) && inside(block.y, self.top, self.height)
    }
}

/// An area on the paper.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) area: Area,
    /// The side of a block.
    pub(super) cell: f64,
    /// The upper left corner of the area.
    pub(super) left: f64,
    pub(super) top: f64,
}

/// The room that the numbers of the rows take.
pub(super) const AXIS: f64 = 26.0;

impl Frame {
    pub(super) fn width(&self) -> f64 {
        f64::from(self.area.width) * self.cell
    }

    pub(super) fn height(&self) -> f64 {
        f64::from(self.area.height) * self.cell
    }

    /// The upper left corner of a block.
    pub(super) fn corner(&self, block: Block) -> (f64, f64) {
        let (x, y) = (f64::from(block.x) - f64::from(self.area.left), f64::from(block.y) - f64::from(self.area.top));
        (self.left + x * self.cell, self.top + y * self.cell)
    }

    pub(super) fn middle(&self, block: Block) -> (f64, f64) {
        let (x, y) = self.corner(block);
        (x + self.cell / 2.0, y + self.cell / 2.0)
    }

    /// The paper and the blocked blocks.
    pub(super) fn draw_ground(&self, svg: &mut Svg, map: Option<&Map>) {
        let place = format!(
            r#"x="{}" y="{}" width="{}" height="{}""#,
            number(self.left),
            number(self.top),
            number(self.width()),
            number(self.height())
        );
        svg.leaf("rect", format_args!(r##"class="area" {place} fill="#fff""##));
        let blocked = map.map(|map| self.blocked(map)).unwrap_or_default();
        if !blocked.is_empty() {
            svg.leaf("path", format_args!(r##"class="blocked" d="{blocked}" fill="#8a8f98""##));
        }
    }

    /// The lines between blocks and the numbers of columns and rows.
    pub(super) fn draw_grid(&self, svg: &mut Svg) {
        let (right, bottom) = (self.left + self.width(), self.top + self.height());
        let mut lines = String::new();
        for column in 0..=self.area.width {
            let x = number(self.left + f64::from(column) * self.cell);
            lines.push_str(&format!("M{x} {}V{}", number(self.top), number(bottom)));
        }
        for row in 0..=self.area.height {
            let y = number(self.top + f64::from(row) * self.cell);
            lines.push_str(&format!("M{} {y}H{}", number(self.left), number(right)));
        }
        let width = if self.cell < 12.0 { 0.4 } else { 1.0 };
        svg.leaf(
            "path",
            format_args!(r##"class="grid" d="{lines}" fill="none" stroke="#d5d9e0" stroke-width="{width}""##),
        );
        svg.open("g", format_args!(r##"class="axis" font-size="12" fill="#5b6270" text-anchor="middle""##));
        let end = i64::from(self.area.left) + i64::from(self.area.width);
        for column in self.numbers(self.area.left, end) {
            let x = self.left + (column - f64::from(self.area.left) + 0.5) * self.cell;
            let at = format!(r#"x="{}" y="{}""#, number(x), number(self.top - 8.0));
            svg.element("text", format_args!("{at}"), &column.to_string());
        }
        let end = i64::from(self.area.top) + i64::from(self.area.height);
        for row in self.numbers(self.area.top, end) {
            let y = self.top + (row - f64::from(self.area.top) + 0.5) * self.cell + 4.0;
            let at = format!(r#"x="{}" y="{}" text-anchor="end""#, number(self.left - 8.0), number(y));
            svg.element("text", format_args!("{at}"), &row.to_string());
        }
        svg.close();
    }

    /// The columns or rows that get a number: every one, or every 2, 5, 10 ... where the blocks are small.
    fn numbers(&self, first: i32, end: i64) -> impl Iterator<Item = f64> + use<> {
        let room = 12.0 + 7.0 * (end.to_string().len() as f64);
        let steps = (0..6).flat_map(|power| [1, 2, 5].map(|step| step * 10_i64.pow(power)));
        let cell = self.cell;
        let step = steps.into_iter().find(|step| *step as f64 * cell >= room).unwrap_or(i64::from(Map::LONGEST));
        (i64::from(first)..end).filter(move |at| at % step == 0).map(|at| at as f64)
    }

    /// The outline of all blocked blocks, those beside each other in one.
    fn blocked(&self, map: &Map) -> String {
        let mut outline = String::new();
        let (width, cell) = (map.width() as usize, self.cell);
        let mut place = 0;
        while place < map.size() {
            let end = place - place % width + width;
            let first = place;
            while place < end && !map.is_free(map.block(place)) {
                place += 1;
            }
            if place > first {
                let (x, y) = self.corner(map.block(first));
                let length = number((place - first) as f64 * cell);
                outline.push_str(&format!("M{} {}h{length}v{}h-{length}z", number(x), number(y), number(cell)));
            } else {
                place += 1;
            }
        }
        outline
    }
}

//! Heights of items: each stands on a line with what it is joined to, as far as its neighbours leave room.

use super::items::{Items, Kind};
use super::measure::GRID;

/// Times that all columns are gone through, to the right and back.
const SWEEPS: usize = 3;
/// The weight of an item without a line to the current column: others push it aside.
const LIGHT: f64 = 0.01;

pub(super) fn place(all: &mut Items) {
    let offsets: Vec<Vec<i32>> = all.columns.iter().map(|column| stacked(all, column)).collect();
    let heights = all.columns.iter().zip(&offsets).map(|(column, offsets)| {
        column.last().zip(offsets.last()).map_or(0, |(item, offset)| offset + all.items[*item].height)
    });
    let heights: Vec<i32> = heights.collect();
    let highest = heights.iter().copied().max().unwrap_or(0);
    for (column, offsets) in offsets.iter().enumerate() {
        let free = (highest - heights[column]) / 2 / GRID * GRID;
        for (place, offset) in offsets.iter().enumerate() {
            all.items[all.columns[column][place]].y = free + offset;
        }
    }
    let mut wanted = vec![Vec::new(); all.items.len()];
    for _ in 0..SWEEPS {
        for is_left in [true, false] {
            for side in &mut wanted {
                side.clear();
            }
            for (index, joint) in all.joints.iter().enumerate() {
                wanted[if is_left { joint.right.item } else { joint.left.item }].push(index);
            }
            let count = all.columns.len();
            for step in 0..count {
                let column = if is_left { step } else { count - 1 - step };
                fit(all, column, &offsets[column], &wanted, is_left, highest - heights[column]);
            }
        }
    }
    let top = all.items.iter().map(|item| item.y).min().unwrap_or(0);
    all.items.iter_mut().for_each(|item| item.y -= top);
}

/// The heights of the items of a column without room to spare.
fn stacked(all: &Items, column: &[usize]) -> Vec<i32> {
    let mut y = 0;
    let mut before: Option<Kind> = None;
    let mut offsets = Vec::with_capacity(column.len());
    for &item in column {
        let item = &all.items[item];
        y += match (before, item.kind) {
            (None, _) => 0,
            (Some(Kind::Component(_)), Kind::Component(_)) => 3 * GRID,
            _ => GRID,
        };
        offsets.push(y);
        y += item.height;
        before = Some(item.kind);
    }
    offsets
}

/// Moves the items of a column to where their joints on one side are straight, at the least sum of squares of what is
/// left: neighbours that would overlap move as one (pool adjacent violators; Barlow et al., Statistical inference under
/// order restrictions, 1972).
fn fit(all: &mut Items, column: usize, offsets: &[i32], wanted: &[Vec<usize>], is_left: bool, free: i32) {
    struct Block {
        sum: f64,
        weight: f64,
        count: usize,
    }
    let mut blocks: Vec<Block> = Vec::new();
    for (place, &item) in all.columns[column].iter().enumerate() {
        let joints = &wanted[item];
        let (mut value, mut weight) = (f64::from(all.items[item].y), LIGHT);
        if !joints.is_empty() {
            let tops = joints.iter().map(|&joint| {
                let joint = all.joints[joint];
                let (here, there) = if is_left { (joint.right, joint.left) } else { (joint.left, joint.right) };
                f64::from(all.line(there) - here.offset)
            });
            (value, weight) = (tops.sum::<f64>() / joints.len() as f64, 1.0);
        }
        let value = value - f64::from(offsets[place]);
        let mut last = Block { sum: value * weight, weight, count: 1 };
        while let Some(before) = blocks.pop_if(|before| before.sum / before.weight >= last.sum / last.weight) {
            last = Block {
                sum: before.sum + last.sum,
                weight: before.weight + last.weight,
                count: before.count + last.count,
            };
        }
        blocks.push(last);
    }
    let mut place = 0;
    for block in blocks {
        // No column grows beyond the highest one.
        let shift = (block.sum / block.weight / f64::from(GRID)).round() as i32 * GRID;
        let shift = shift.clamp(0, free.max(0));
        for _ in 0..block.count {
            all.items[all.columns[column][place]].y = shift + offsets[place];
            place += 1;
        }
    }
}

//! The order of items in each column: beside what they are joined to, so that few lines cross (the barycenter method of
//! Sugiyama, Tagawa and Toda, 1981).

use super::items::Items;

/// Times that all columns are gone through, to the right and back.
const SWEEPS: usize = 4;

pub(super) fn order(all: &mut Items) {
    let mut left = vec![Vec::new(); all.items.len()];
    let mut right = vec![Vec::new(); all.items.len()];
    for joint in &all.joints {
        left[joint.right.item].push(joint.left);
        right[joint.left.item].push(joint.right);
    }
    let mut places = vec![0.0; all.items.len()];
    for column in &all.columns {
        number(column, &mut places);
    }
    for _ in 0..SWEEPS {
        let count = all.columns.len();
        for (column, neighbours) in (0..count).map(|at| (at, &left)).chain((0..count).rev().map(|at| (at, &right))) {
            let mut keyed: Vec<(f64, usize)> = all.columns[column]
                .iter()
                .map(|&item| {
                    let near = &neighbours[item];
                    // The pins of one item stand in their order; together they count for less than the next item.
                    let sum: f64 = near.iter().map(|pin| places[pin.item] + f64::from(pin.offset) * 1e-6).sum();
                    (if near.is_empty() { places[item] } else { sum / near.len() as f64 }, item)
                })
                .collect();
            keyed.sort_by(|one, other| one.0.total_cmp(&other.0));
            all.columns[column] = keyed.into_iter().map(|(_, item)| item).collect();
            number(&all.columns[column], &mut places);
        }
    }
}

/// Numbers the items of a column from 0 to 1, so that columns of all lengths compare.
fn number(column: &[usize], places: &mut [f64]) {
    for (place, &item) in column.iter().enumerate() {
        places[item] = (place as f64 + 0.5) / column.len() as f64;
    }
}

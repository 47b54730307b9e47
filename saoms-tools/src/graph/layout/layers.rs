//! In which column each component stands: what calls to the left of what is called (Sugiyama, Tagawa, Toda: Methods for
//! visual understanding of hierarchical system structures, 1981), columns cut where they would become too high.

use std::collections::BTreeSet;

/// The columns of `count` components with these wires, each with at most `rows` components.
pub(super) fn columns(count: usize, wires: &[(usize, usize)], rows: usize) -> Vec<Vec<usize>> {
    let layers = layers(count, wires);
    let depth = layers.iter().flatten().max().map_or(0, |deepest| deepest + 1);
    let mut members = vec![Vec::new(); depth];
    for (component, layer) in layers.iter().enumerate() {
        if let Some(layer) = layer {
            members[*layer].push(component);
        }
    }
    let mut columns: Vec<Vec<usize>> = Vec::new();
    for layer in members {
        // All parts of about one height.
        let parts = layer.len().div_ceil(rows).max(1);
        columns.extend(layer.chunks(layer.len().div_ceil(parts).max(1)).map(<[usize]>::to_vec));
    }
    // What has no wires stands wherever there is room: in the shortest column.
    let room = columns.iter().enumerate().filter(|(_, column)| column.len() < rows);
    let mut room: BTreeSet<(usize, usize)> = room.map(|(place, column)| (column.len(), place)).collect();
    for component in (0..count).filter(|component| layers[*component].is_none()) {
        let place = match room.pop_first() {
            Some((_, place)) => place,
            None => {
                columns.push(Vec::new());
                columns.len() - 1
            }
        };
        columns[place].push(component);
        if columns[place].len() < rows {
            room.insert((columns[place].len(), place));
        }
    }
    columns
}

/// The longest way of wires to each component; `None` for one without wires.
fn layers(count: usize, wires: &[(usize, usize)]) -> Vec<Option<usize>> {
    let mut targets = vec![Vec::new(); count];
    let mut is_wired = vec![false; count];
    let mut is_called = vec![false; count];
    for &(from, to) in wires {
        targets[from].push(to);
        (is_wired[from], is_wired[to], is_called[to]) = (true, true, true);
    }
    let order = without_circles(&mut targets);
    let mut layers = vec![0; count];
    for &component in &order {
        for &target in &targets[component] {
            layers[target] = layers[target].max(layers[component] + 1);
        }
    }
    // What nothing calls stands right beside what it calls.
    for component in (0..count).filter(|component| !is_called[*component]) {
        if let Some(nearest) = targets[component].iter().map(|target| layers[*target]).min() {
            layers[component] = nearest - 1;
        }
    }
    (0..count).map(|component| is_wired[component].then_some(layers[component])).collect()
}

/// Takes out the wires that close a circle. Gives the components so that all wires lead on.
fn without_circles(targets: &mut [Vec<usize>]) -> Vec<usize> {
    const NONE: usize = usize::MAX;
    #[derive(Clone, Copy, PartialEq)]
    enum Mark {
        New,
        Open,
        Done,
    }
    let mut marks = vec![Mark::New; targets.len()];
    let mut order = Vec::with_capacity(targets.len());
    for first in 0..targets.len() {
        if marks[first] != Mark::New {
            continue;
        }
        marks[first] = Mark::Open;
        let mut path = vec![(first, 0)];
        while let Some((component, next)) = path.last_mut() {
            let component = *component;
            match targets[component].get(*next).copied() {
                None => {
                    marks[component] = Mark::Done;
                    order.push(component);
                    path.pop();
                }
                Some(target) => match marks[target] {
                    Mark::Open => {
                        targets[component][*next] = NONE;
                        *next += 1;
                    }
                    Mark::Done => *next += 1,
                    Mark::New => {
                        *next += 1;
                        marks[target] = Mark::Open;
                        path.push((target, 0));
                    }
                },
            }
        }
    }
    for targets in targets {
        targets.retain(|target| *target != NONE);
    }
    order.reverse();
    order
}

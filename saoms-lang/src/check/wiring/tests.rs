//! Cycles of calls, without composites.

use std::collections::HashSet;

use proptest::prelude::*;

fn cycles(nodes: usize, edges: &[(usize, usize)]) -> Vec<Vec<usize>> {
    let mut all = Vec::new();
    super::call_cycle::cycles(nodes, edges, |cycle| all.push(cycle.to_vec()));
    all
}

#[test]
fn every_cycle_is_cut_at_the_wire_that_closes_it() {
    assert_eq!(cycles(3, &[(0, 1), (1, 2), (0, 2)]), Vec::<Vec<usize>>::new());
    assert_eq!(cycles(3, &[(0, 1), (1, 2), (2, 0)]), [[0, 1, 2]]);
    assert_eq!(cycles(1, &[(0, 0)]), [[0]]);
    assert_eq!(cycles(4, &[(0, 1), (1, 2), (2, 1), (2, 3), (3, 1)]), [vec![1, 2], vec![1, 3, 4]]);
}

#[test]
fn a_long_chain_costs_no_stack() {
    let wires: Vec<_> = (0..200_000).map(|node| (node, (node + 1) % 200_000)).collect();
    assert_eq!(cycles(200_000, &wires).len(), 1);
}

#[test]
fn cycles_that_have_most_of_their_edges_in_common_cost_no_memory() {
    // Each calls the next one, and each the first one: all cycles together have five thousand million edges.
    let next = (0..100_000).map(|node| (node, node + 1));
    let wires: Vec<_> = next.chain((1..100_000).map(|node| (node, 0))).collect();
    let (mut count, mut edges) = (0, 0);
    super::call_cycle::cycles(100_001, &wires, |cycle| (count, edges) = (count + 1, edges + cycle.len()));
    assert_eq!((count, edges), (99_999, 5_000_049_999));
}

/// True if there is a cycle, found another way: by taking away what nothing leads to.
fn has_cycle(nodes: usize, wires: &[(usize, usize)]) -> bool {
    let mut left: HashSet<usize> = (0..nodes).collect();
    loop {
        let reached: HashSet<usize> = wires.iter().filter(|(from, _)| left.contains(from)).map(|(_, to)| *to).collect();
        let before = left.len();
        left.retain(|node| reached.contains(node));
        if left.len() == before {
            return !left.is_empty();
        }
    }
}

proptest! {
    #[test]
    fn without_the_closing_wires_there_is_no_cycle(wires in prop::collection::vec((0..8usize, 0..8usize), 0..20)) {
        let found = cycles(8, &wires);
        prop_assert_eq!(!found.is_empty(), has_cycle(8, &wires));
        for cycle in &found {
            let next = cycle.iter().cycle().skip(1);
            for (wire, next) in cycle.iter().zip(next) {
                prop_assert_eq!(wires[*wire].1, wires[*next].0, "the wires follow each other");
            }
        }
        let closing: HashSet<usize> = found.iter().filter_map(|cycle| cycle.last().copied()).collect();
        let others: Vec<_> = wires.iter().enumerate().filter(|(wire, _)| !closing.contains(wire)).map(|(_, ends)| *ends).collect();
        prop_assert!(!has_cycle(8, &others));
    }
}

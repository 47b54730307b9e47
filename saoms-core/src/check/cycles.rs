//! Cycles in a directed graph.

/// An edge of the graph: where it leads, and what the caller knows it by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Edge {
    pub(super) to: usize,
    pub(super) wire: usize,
}

/// The wires of cycles, each in the order of walking it, one cycle for each wire that leads back to where a walk in
/// order of the nodes came from: without all those wires there is no cycle. Time and space are linear in the graph.
pub(super) fn cycles(edges: &[Vec<Edge>]) -> Vec<Vec<usize>> {
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        New,
        /// On the path, at this place.
        Open(usize),
        Done,
    }
    let mut states = vec![State::New; edges.len()];
    let mut found = Vec::new();
    for start in 0..edges.len() {
        if states[start] != State::New || edges[start].is_empty() {
            continue;
        }
        // Nodes from `start`, each with how many of its edges were taken, and the wires between them.
        let mut path = vec![(start, 0)];
        let mut wires: Vec<usize> = Vec::new();
        states[start] = State::Open(0);
        while let Some((node, taken)) = path.last_mut() {
            let node = *node;
            let Some(edge) = edges[node].get(*taken) else {
                states[node] = State::Done;
                path.pop();
                wires.pop();
                continue;
            };
            *taken += 1;
            match states[edge.to] {
                State::New => {
                    states[edge.to] = State::Open(path.len());
                    path.push((edge.to, 0));
                    wires.push(edge.wire);
                }
                State::Open(place) => {
                    let mut cycle = wires[place..].to_vec();
                    cycle.push(edge.wire);
                    found.push(cycle);
                }
                State::Done => {}
            }
        }
    }
    found
}

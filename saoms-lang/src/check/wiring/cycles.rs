//! Cycles in a directed graph.

/// Finds the cycles among so many nodes that have these edges, each from a node to another one.
///
/// A cycle is the places of its edges in the order of walking it; there is one for each edge that leads back to where a
/// walk in order of the nodes came from: without all those there is no cycle. Time and space are linear in the graph;
/// all cycles together can have as many edges as its square, so that each is only lent to `found`.
pub(crate) fn cycles(nodes: usize, edges: &[(usize, usize)], mut found: impl FnMut(&[usize])) {
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        New,
        /// On the path, at this place.
        Open(usize),
        Done,
    }
    // The edges of all nodes in order, and where those of each start.
    let mut starts = vec![0; nodes + 1];
    edges.iter().for_each(|(from, _)| starts[from + 1] += 1);
    for node in 0..nodes {
        starts[node + 1] += starts[node];
    }
    let mut leaving: Vec<usize> = (0..edges.len()).collect();
    leaving.sort_by_key(|edge| edges[*edge].0);
    let mut states = vec![State::New; nodes];
    // Nodes from the start of a walk, each with its next edge, and the edges between them.
    let mut path: Vec<(usize, usize)> = Vec::new();
    let mut walked: Vec<usize> = Vec::new();
    for start in 0..nodes {
        if states[start] != State::New || starts[start] == starts[start + 1] {
            continue;
        }
        path.push((start, starts[start]));
        states[start] = State::Open(0);
        while let Some((node, next)) = path.last_mut() {
            let node = *node;
            if *next == starts[node + 1] {
                states[node] = State::Done;
                path.pop();
                walked.pop();
                continue;
            }
            let edge = leaving[*next];
            let to = edges[edge].1;
            *next += 1;
            match states[to] {
                State::New => {
                    states[to] = State::Open(path.len());
                    path.push((to, starts[to]));
                    walked.push(edge);
                }
                State::Open(place) => {
                    walked.push(edge);
                    found(&walked[place..]);
                    walked.pop();
                }
                State::Done => {}
            }
        }
    }
}

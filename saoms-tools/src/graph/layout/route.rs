//! Lines between columns: each net has a vertical track of its own in the channel between two columns.

use super::measure::GRID;

/// A route in one channel: ends at its left and right, and a place far above or below that it leads to.
#[derive(Clone, Debug, Default)]
pub(super) struct Strand {
    pub(super) left: Vec<i32>,
    pub(super) right: Vec<i32>,
    pub(super) far: Option<i32>,
    /// Its place in the channel; `None` for one that is straight.
    pub(super) track: Option<usize>,
    /// The distance below its right end at which it runs where another line would be in the way.
    pub(super) nudge: i32,
}

impl Strand {
    fn is_straight(&self) -> bool {
        self.far.is_none() && self.left.len() == 1 && self.left == self.right
    }

    fn ends(&self) -> impl Iterator<Item = i32> {
        let right = self.right.iter().map(|end| end + self.nudge);
        self.left.iter().copied().chain(right).chain(self.far)
    }

    /// The vertical part.
    pub(super) fn span(&self) -> (i32, i32) {
        (self.ends().min().unwrap_or(0), self.ends().max().unwrap_or(0))
    }

    /// Those that come from above turn down behind those that come from below, and the other way round, so that they do
    /// not cross; those that leave the columns stand next to their component.
    fn rank(&self) -> (u8, i32) {
        let first = |ends: &[i32]| ends.first().copied().unwrap_or(0);
        match (self.far, self.left.is_empty()) {
            (Some(_), true) => (2, first(&self.right)),
            (Some(_), false) => (0, -first(&self.left)),
            (None, _) if first(&self.right) > first(&self.left) => (1, -first(&self.left)),
            (None, _) => (1, first(&self.left)),
        }
    }
}

/// Gives each strand of a channel its track; how many there are.
///
/// If a line from the left and one to the right are at the same height, the first must turn away before the other one
/// comes. Circles of such are cut anywhere, and the second line goes beside the first one there.
pub(super) fn tracks(strands: &mut [Strand]) -> usize {
    let mut order: Vec<usize> = (0..strands.len()).filter(|&strand| !strands[strand].is_straight()).collect();
    order.sort_by_key(|&strand| strands[strand].rank());
    let mut rights: Vec<(i32, usize)> = Vec::new();
    for &strand in &order {
        rights.extend(strands[strand].right.iter().map(|&end| (end, strand)));
    }
    rights.sort_unstable();
    let mut after: Vec<Vec<usize>> = vec![Vec::new(); strands.len()];
    let mut waits = vec![0; strands.len()];
    for &strand in &order {
        for &end in &strands[strand].left {
            let from = rights.partition_point(|(other, _)| *other < end);
            for &(_, other) in rights[from..].iter().take_while(|(other, _)| *other == end) {
                if other != strand {
                    after[strand].push(other);
                    waits[other] += 1;
                }
            }
        }
    }
    let mut rank = vec![0; strands.len()];
    for (place, &strand) in order.iter().enumerate() {
        rank[strand] = place;
    }
    let mut ready: std::collections::BTreeSet<(usize, usize)> =
        order.iter().filter(|&&strand| waits[strand] == 0).map(|&strand| (rank[strand], strand)).collect();
    let mut rest = order.clone().into_iter();
    let mut count = 0;
    loop {
        let next = ready.pop_first().map(|(_, strand)| strand);
        let next = next.or_else(|| rest.find(|&strand| strands[strand].track.is_none()));
        let Some(strand) = next else { break };
        if strands[strand].track.is_some() {
            continue;
        }
        strands[strand].track = Some(count);
        count += 1;
        for &other in &after[strand] {
            waits[other] -= 1;
            if waits[other] == 0 && strands[other].track.is_none() {
                ready.insert((rank[other], other));
            }
        }
    }
    for strand in order {
        let crossed = after[strand].iter().filter(|&&other| strands[other].track < strands[strand].track);
        for other in crossed.copied().collect::<Vec<_>>() {
            strands[other].nudge = GRID / 2;
        }
    }
    count
}

/// From the edge of a channel to its first track, and the least width of a channel.
pub(super) const MARGIN: i32 = 2 * GRID;

/// The width of a channel with so many tracks.
pub(super) fn width(tracks: usize) -> i32 {
    2 * MARGIN + GRID * (tracks as i32 - 1).max(0)
}

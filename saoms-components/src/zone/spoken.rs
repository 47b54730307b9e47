//! When robots spoke to their zone, and how long their moves take.

use std::collections::BTreeMap;
use std::time::Duration;

use saoms_api::Time;

use crate::grid::Block;
use crate::messages::GrantRequest;

/// When a robot spoke in its newest incarnation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spoken {
    pub(super) incarnation: u64,
    pub(super) first: Time,
    pub(super) last: Time,
    pace: Pace,
}

/// The last move of a robot, as its requests say.
#[derive(Clone, Copy, Debug, Default)]
struct Pace {
    block: Option<Block>,
    /// Since when it has had a block to drive to.
    since: Option<Time>,
    /// How long its last move took.
    lasted: Duration,
}

impl Spoken {
    /// One whose first word was at this time.
    pub(super) fn at(incarnation: u64, first: Time) -> Spoken {
        Spoken { incarnation, first, last: first, pace: Pace::default() }
    }

    /// Takes in its newest request, which was sent at this time.
    pub(super) fn hear(&mut self, request: &GrantRequest, sent: Time) {
        let Pace { block, since, lasted } = &mut self.pace;
        let before = block.replace(request.block);
        if before.is_some_and(|before| before != request.block)
            && let Some(since) = since.take()
        {
            *lasted = sent.since(since);
        }
        if request.end == request.block {
            *since = None;
        } else {
            since.get_or_insert(sent);
        }
    }
}

/// Notes that a robot spoke; `None` if it has said something newer before.
pub(super) fn newest(
    spoke: &mut BTreeMap<u32, Spoken>,
    robot: u32,
    incarnation: u64,
    sent: Time,
) -> Option<&mut Spoken> {
    let spoken = spoke.entry(robot).or_insert(Spoken::at(incarnation, sent));
    if incarnation > spoken.incarnation {
        *spoken = Spoken { pace: spoken.pace, ..Spoken::at(incarnation, sent) };
    }
    let is_newest = incarnation == spoken.incarnation && sent >= spoken.last;
    if incarnation == spoken.incarnation {
        (spoken.first, spoken.last) = (spoken.first.min(sent), spoken.last.max(sent));
    }
    is_newest.then_some(spoken)
}

/// The longest of the last moves of all robots.
pub(super) fn longest_move(spoke: &BTreeMap<u32, Spoken>) -> Duration {
    spoke.values().map(|spoken| spoken.pace.lasted).max().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_move_lasts_from_the_grant_of_its_block_to_the_word_that_the_robot_is_there() {
        let mut spoke = BTreeMap::new();
        let mut says = |seconds: u64, x: i32, end: i32| {
            let sent = Time::START + Duration::from_secs(seconds);
            let request = GrantRequest { block: Block::new(x, 0), end: Block::new(end, 0), ..Default::default() };
            newest(&mut spoke, 1, 5, sent).unwrap().hear(&request, sent);
            longest_move(&spoke).as_secs()
        };
        assert_eq!([says(0, 0, 0), says(10, 0, 2), says(12, 0, 2), says(14, 1, 2)], [0, 0, 0, 4]);
        assert_eq!([says(19, 2, 2), says(50, 2, 3), says(51, 3, 3)], [5, 5, 1], "it waited in between");
        let late = newest(&mut spoke, 1, 4, Time::START + Duration::from_secs(60)).is_some();
        assert!(!late, "of an earlier incarnation");
    }
}

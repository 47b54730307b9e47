//! When robots spoke to their zone, and how long their moves take.

use std::collections::BTreeMap;
use std::time::Duration;

use saoms_api::Time;

use crate::grid::Block;
use crate::messages::{GrantRequest, Territory};

/// What no move takes. What seems to take longer is a time that a robot was not heard for.
const LONGEST: Duration = Duration::from_mins(1);

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

    /// Takes in its newest request to the zone of this territory, which was sent at this time.
    pub(super) fn hear(&mut self, request: &GrantRequest, sent: Time, territory: &Territory) {
        let Pace { block, since, lasted } = &mut self.pace;
        let before = block.replace(request.block);
        if let Some(before) = before.filter(|before| *before != request.block)
            && let Some(since) = since.take()
            && before.distance(request.block) == 1
        {
            *lasted = sent.since(since);
        }
        // Of one that is away the zone hears no more until it comes back.
        let is_here = territory.is_near(request.block) || territory.is_near(request.end);
        if request.end == request.block || !is_here {
            *since = None;
        } else {
            since.get_or_insert(sent);
        }
    }

    /// Forgets how long its moves take: it is off the floor.
    pub(super) fn forget_pace(&mut self) {
        self.pace = Pace::default();
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
        // It may have been off for long since its last move.
        let pace = Pace { lasted: spoken.pace.lasted, ..Pace::default() };
        *spoken = Spoken { pace, ..Spoken::at(incarnation, sent) };
    }
    let is_newest = incarnation == spoken.incarnation && sent >= spoken.last;
    if incarnation == spoken.incarnation {
        (spoken.first, spoken.last) = (spoken.first.min(sent), spoken.last.max(sent));
    }
    is_newest.then_some(spoken)
}

/// The longest of the last moves of all robots, a minute at most.
pub(super) fn longest_move(spoke: &BTreeMap<u32, Spoken>) -> Duration {
    spoke.values().map(|spoken| spoken.pace.lasted).max().unwrap_or_default().min(LONGEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ZONE: Territory = Territory { zone: 1, term: 1, corner: Block::new(0, 0), width: 4, height: 1 };

    /// A robot of this incarnation says where it is and where its passage ends. Gives the longest move in seconds.
    fn says(spoke: &mut BTreeMap<u32, Spoken>, incarnation: u64, seconds: u64, x: i32, end: i32) -> u64 {
        let sent = Time::START + Duration::from_secs(seconds);
        let request = GrantRequest { block: Block::new(x, 0), end: Block::new(end, 0), ..Default::default() };
        newest(spoke, 1, incarnation, sent).unwrap().hear(&request, sent, &ZONE);
        longest_move(spoke).as_secs()
    }

    #[test]
    fn a_move_lasts_from_the_grant_of_its_block_to_the_word_that_the_robot_is_there() {
        let mut spoke = BTreeMap::new();
        let mut says = |seconds, x, end| says(&mut spoke, 5, seconds, x, end);
        assert_eq!([says(0, 0, 0), says(10, 0, 2), says(12, 0, 2), says(14, 1, 2)], [0, 0, 0, 4]);
        assert_eq!([says(19, 2, 2), says(50, 2, 3), says(51, 3, 3)], [5, 5, 1], "it waited in between");
        let late = newest(&mut spoke, 1, 4, Time::START + Duration::from_secs(60)).is_some();
        assert!(!late, "of an earlier incarnation");
    }

    #[test]
    fn the_time_that_a_robot_is_away_is_no_move() {
        let mut spoke = BTreeMap::new();
        let mut says = |seconds, x, end| says(&mut spoke, 5, seconds, x, end);
        assert_eq!([says(0, 7, 8), says(3, 8, 9), says(40, 7, 6), says(42, 6, 6)], [0, 3, 3, 2], "it was far off");
        assert_eq!([says(50, 6, 7), says(80, 3, 2), says(81, 2, 2)], [2, 2, 1], "it came back from elsewhere");
        assert_eq!([says(90, 2, 3), says(9_000, 3, 3)], [1, 60], "it was not heard");
    }

    #[test]
    fn the_time_that_a_robot_is_off_is_no_move() {
        let mut spoke = BTreeMap::new();
        assert_eq!([says(&mut spoke, 5, 0, 0, 1), says(&mut spoke, 5, 2, 1, 2)], [0, 2]);
        assert_eq!(says(&mut spoke, 6, 40, 2, 3), 2, "it began anew");
        assert_eq!(says(&mut spoke, 6, 45, 3, 3), 5);
        spoke.get_mut(&1).unwrap().forget_pace();
        assert_eq!(longest_move(&spoke).as_secs(), 0, "it is gone");
    }
}

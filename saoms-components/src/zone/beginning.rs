//! With which record a zone begins: with its own, or with what former zones had granted of its blocks.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

use saoms_api::Time;

use super::ledger::{Ledger, Member};
use super::memory::Record;
use crate::grid::{Block, Map};
use crate::messages::{GrantRequest, LAST_NUMBER, Standing, Step, Territory, link};

/// The beginning of a zone.
#[derive(Debug)]
pub(super) struct Beginning {
    pub(super) ledger: Ledger,
    /// The newest incarnation of each robot that is known, and the time of its first word.
    pub(super) spoke: BTreeMap<u32, (u64, Time)>,
    /// True if the record has all that robots may hold.
    pub(super) is_complete: bool,
    /// True if it is a new term, in which robots have to say what they hold.
    pub(super) is_new: bool,
}

impl Beginning {
    /// The beginning of a zone of this territory, in this term or a higher one. `own` is what the zone kept, and
    /// `others` what those kept that were zones until now.
    pub(super) fn of(territory: Territory, own: Option<Record>, others: Vec<Record>, map: &Map) -> Beginning {
        match own {
            Some(own) if is_same(own.ledger.territory(), &territory) && !is_former(&own, &others) => {
                Beginning::again(own, territory.term)
            }
            own => Beginning::drawn(territory, own.into_iter().chain(others).collect(), map),
        }
    }

    /// Goes on with its own record. Where that lacks what robots may hold, each has to say where it is first.
    fn again(own: Record, term: u64) -> Beginning {
        let spoke = spoken(std::slice::from_ref(&own));
        let Record { mut ledger, is_open, .. } = own;
        if !is_open {
            ledger.begin_term(term);
        }
        Beginning { ledger, spoke, is_complete: is_open, is_new: !is_open }
    }

    /// Begins with what former zones counted as held, in a term above all of theirs.
    fn drawn(territory: Territory, former: Vec<Record>, map: &Map) -> Beginning {
        let above = former.iter().map(|record| record.ledger.territory().term.saturating_add(1));
        let territory = Territory { term: above.fold(territory.term, u64::max), ..territory };
        let ledgers: Vec<&Ledger> = former.iter().map(|record| &record.ledger).collect();
        let is_known = |block: &Block| last(&ledgers, *block).is_some_and(|place| former[place].is_open);
        let is_complete = blocks(&territory).filter(|block| map.is_free(*block)).all(|block| is_known(&block));
        let ledger = Ledger::drawn(territory, &ledgers);
        Beginning { ledger, spoke: spoken(&former), is_complete, is_new: true }
    }
}

impl Ledger {
    /// The record of a zone that begins where former ones were: what these counted as held of its blocks. Whatever a
    /// robot says next counts; until then it gets no grant, and does not make way.
    pub(super) fn drawn(territory: Territory, former: &[&Ledger]) -> Ledger {
        let robots: BTreeSet<u32> = former.iter().flat_map(|ledger| ledger.members().keys().copied()).collect();
        let member = |robot: u32| Some((robot, inherited(robot, &territory, former)?));
        let members = robots.into_iter().filter_map(member).collect();
        Ledger::with(territory, members)
    }
}

/// What is left of a robot to a zone that begins.
fn inherited(robot: u32, territory: &Territory, former: &[&Ledger]) -> Option<Member> {
    let known = || former.iter().enumerate().filter_map(|(place, ledger)| Some((place, ledger.member(robot)?)));
    let mut steps: Vec<Step> = Vec::new();
    for (place, member) in known() {
        let is_left = |step: &&Step| territory.contains(step.block) && last(former, step.block) == Some(place);
        steps.extend(member.steps.iter().filter(is_left));
    }
    let newest = |is_over: Option<bool>| {
        let members = known().map(|(_, member)| member);
        let members = members.filter(|member| is_over.is_none_or(|is_over| member.is_over() == is_over));
        members.max_by_key(|member| member.request.incarnation)
    };
    let stands_there = |member: &&Member| member.steps.iter().any(|step| step.block == member.request.block);
    // The zone knows best where it is that granted it that block.
    let member = known().map(|(_, member)| member).find(stands_there).or_else(|| newest(None))?;
    let of_zone = |request: &GrantRequest| GrantRequest {
        link: link(territory.zone, robot),
        zone: territory.zone,
        term: territory.term,
        at: territory.closest(request.block),
        ..request.clone()
    };
    let over = newest(Some(true));
    // Somebody said of one to some of the zones alone that it is off the floor.
    let is_off = over.is_some_and(|over| {
        let incarnations = known().map(|(_, member)| member.request.incarnation);
        incarnations.min() > Some(0) && newest(Some(false)).is_none_or(|other| !is_after(other, over))
    });
    if !steps.is_empty() && !is_off {
        let granted = steps.iter().map(|step| step.number).max().unwrap_or(0);
        let is_lost = member.request.standing == Standing::Lost;
        let request = GrantRequest {
            incarnation: 0,
            number: 0,
            received: granted,
            held: steps.clone(),
            goal: member.request.end,
            rank: 0,
            standing: if is_lost { Standing::Lost } else { Standing::Stays },
            ahead: 0,
            ..of_zone(&member.request)
        };
        return Some(Member::new(request, steps, granted));
    }
    // Of one that somebody took off the floor only a new incarnation is taken.
    let over = over?;
    let is_back = newest(Some(false)).is_some_and(|other| is_after(other, over));
    (!is_back).then(|| Member::new(of_zone(&over.request), Vec::new(), LAST_NUMBER))
}

/// True if this is a later incarnation of the robot.
fn is_after(one: &Member, other: &Member) -> bool {
    one.request.incarnation > other.request.incarnation
}

/// The place of the last of some zones that had a block; of records of one term, the first one.
fn last(former: &[&Ledger], block: Block) -> Option<usize> {
    let had = former.iter().enumerate().filter(|(_, ledger)| ledger.territory().contains(block));
    had.rev().max_by_key(|(_, ledger)| ledger.territory().term).map(|(place, _)| place)
}

fn blocks(territory: &Territory) -> impl Iterator<Item = Block> + use<> {
    let Territory { corner, width, height, .. } = *territory;
    let columns = corner.x..corner.x.saturating_add_unsigned(width);
    let rows = corner.y..corner.y.saturating_add_unsigned(height);
    rows.flat_map(move |y| columns.clone().map(move |x| Block::new(x, y)))
}

/// The newest incarnation of each robot, and the time of its first word.
fn spoken(records: &[Record]) -> BTreeMap<u32, (u64, Time)> {
    let mut spoken: BTreeMap<u32, (u64, Time)> = BTreeMap::new();
    for Record { ledger, first_heard, .. } in records {
        for (robot, member) in ledger.members() {
            let (incarnation, first) = (member.request.incarnation, first_heard.get(robot).copied());
            let first = first.unwrap_or(Time::START);
            let known = spoken.entry(*robot).or_insert((incarnation, first));
            match incarnation.cmp(&known.0) {
                Ordering::Greater => *known = (incarnation, first),
                Ordering::Equal => known.1 = known.1.min(first),
                Ordering::Less => {}
            }
        }
    }
    spoken
}

/// True if two territories have the same blocks.
fn is_same(one: &Territory, other: &Territory) -> bool {
    (one.zone, one.corner, one.width, one.height) == (other.zone, other.corner, other.width, other.height)
}

/// True if another zone had some of its blocks after it.
fn is_former(own: &Record, others: &[Record]) -> bool {
    let own = own.ledger.territory();
    let is_later = |other: &Territory| other.term > own.term && other.shares(own) > 0;
    others.iter().any(|other| is_later(other.ledger.territory()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAP: &str = "......\n@@....";

    fn territory(zone: u32, term: u64, x: i32, width: u32) -> Territory {
        Territory { zone, term, corner: Block::new(x, 0), width, height: 2 }
    }

    /// The record of a zone with robots that hold blocks of its first row, in their incarnation 5.
    fn record(territory: Territory, robots: &[(u32, &[i32])]) -> Record {
        let mut ledger = Ledger::new(territory.clone());
        for (robot, columns) in robots {
            let held = (4..).zip(*columns).map(|(number, x)| Step { number, block: Block::new(*x, 0) });
            let held: Vec<Step> = held.collect();
            let end = held.last().map_or(Block::new(0, 0), |step| step.block);
            let block = held.first().map_or(end, |step| step.block);
            let Territory { zone, term, .. } = territory;
            let request = GrantRequest { zone, term, robot: *robot, incarnation: 5, number: 9, ..Default::default() };
            ledger.hear(&GrantRequest { received: 4, held, block, end, rank: 7, ..request });
        }
        let first_heard = robots.iter().map(|(robot, _)| (*robot, Time::START)).collect();
        Record { ledger, first_heard, is_open: true }
    }

    fn begin(territory: Territory, own: Option<Record>, others: Vec<Record>) -> Beginning {
        Beginning::of(territory, own, others, &Map::read(MAP).unwrap())
    }

    fn held(beginning: &Beginning, robot: u32) -> Vec<i32> {
        beginning.ledger.member(robot).map_or_else(Vec::new, |member| member.blocks().map(|block| block.x).collect())
    }

    #[test]
    fn a_zone_goes_on_from_those_that_had_its_blocks() {
        let first = || record(territory(1, 50, 0, 3), &[(1, &[1, 2]), (2, &[0])]);
        let second = || record(territory(2, 70, 3, 3), &[(1, &[3]), (3, &[5])]);
        let moved = begin(territory(1, 60, 0, 4), Some(first()), vec![second()]);
        assert!(moved.is_complete && moved.is_new);
        assert_eq!(moved.ledger.territory().term, 71, "above those of all former zones");
        assert_eq!([1, 2, 3].map(|robot| held(&moved, robot)), [vec![1, 2, 3], vec![0], vec![]]);
        assert_eq!(moved.spoke[&3], (5, Time::START));
        // It says what it holds in the new term, and only then gets grants.
        let member = moved.ledger.member(1).unwrap();
        assert!(!member.wants_to_go() && member.request.incarnation == 0 && member.request.standing == Standing::Stays);
        let other = begin(territory(2, 60, 4, 2), Some(second()), vec![first()]);
        assert_eq!((held(&other, 1), held(&other, 3), other.is_complete), (vec![], vec![5], true));
        // The zone that it was itself goes on.
        let same = begin(territory(2, 60, 3, 3), Some(second()), vec![first()]);
        assert_eq!((same.ledger.territory().term, same.is_new, same.is_complete), (70, false, true));
    }

    #[test]
    fn a_zone_asks_all_robots_whose_blocks_were_of_no_zone_that_granted() {
        let first = || record(territory(1, 50, 0, 3), &[(2, &[0])]);
        let closed = Record { is_open: false, ..record(territory(2, 70, 3, 3), &[]) };
        let beginning = begin(territory(1, 60, 0, 4), Some(first()), vec![closed]);
        assert_eq!((beginning.is_complete, held(&beginning, 2)), (false, vec![0]));
        assert!(!begin(territory(1, 60, 0, 4), Some(first()), vec![]).is_complete);
        assert!(!begin(territory(1, 60, 0, 4), None, vec![]).is_complete);
        let again = begin(territory(1, 60, 0, 3), Some(Record { is_open: false, ..first() }), vec![]);
        assert_eq!((again.is_complete, again.is_new, again.ledger.territory().term), (false, true, 60));
    }

    #[test]
    fn the_last_zone_of_a_block_counts() {
        // A border that was moved there and back while the first zone did not run.
        let own = || record(territory(1, 50, 0, 4), &[(1, &[3]), (2, &[0])]);
        let between = || record(territory(2, 60, 3, 3), &[(3, &[3])]);
        let back = begin(territory(1, 55, 0, 4), Some(own()), vec![between()]);
        assert_eq!((back.ledger.territory().term, back.is_new, back.is_complete), (61, true, true));
        assert_eq!([1, 2, 3].map(|robot| held(&back, robot)), [vec![], vec![0], vec![3]]);
    }

    #[test]
    fn a_robot_that_only_one_zone_knows_to_be_off_the_floor_holds_nothing() {
        let first = || {
            let mut first = record(territory(1, 50, 0, 3), &[(1, &[])]);
            first.ledger.end(1, 5);
            first
        };
        let beginning =
            begin(territory(3, 60, 0, 6), None, vec![first(), record(territory(2, 70, 3, 3), &[(1, &[4])])]);
        assert!(held(&beginning, 1).is_empty() && beginning.ledger.has_ended(1, 5));
        // It may have come back where its incarnation is not known yet.
        let mut second = record(territory(2, 70, 3, 3), &[(1, &[4])]);
        second.ledger.begin_term(71);
        let beginning = begin(territory(3, 60, 0, 6), None, vec![first(), second]);
        assert_eq!(held(&beginning, 1), [4]);
    }

    #[test]
    fn of_two_records_of_a_term_the_newer_one_counts() {
        // A zone that was replaced without other borders, and what it had left to another one that never began.
        let own = record(territory(1, 50, 0, 4), &[(1, &[3])]);
        let left = record(territory(1, 50, 0, 4), &[(1, &[2])]);
        let beginning = begin(territory(1, 60, 0, 5), Some(own), vec![left]);
        assert_eq!(held(&beginning, 1), [3]);
    }

    #[test]
    fn robots_that_are_off_the_floor_stay_off() {
        let mut first = record(territory(1, 50, 0, 3), &[(1, &[1]), (2, &[0])]);
        first.ledger.end(1, 5);
        let second = record(territory(2, 70, 3, 3), &[(1, &[])]);
        let beginning = begin(territory(3, 60, 0, 6), None, vec![first, second]);
        assert!(beginning.ledger.has_ended(1, 5) && !beginning.ledger.has_ended(2, 5));
    }
}

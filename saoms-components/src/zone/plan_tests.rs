//! What a zone plans and says of robots that cannot move, that charge, and that are in other zones.

use std::collections::{BTreeMap, BTreeSet};

use super::asides::Asides;
use super::deadlock::StandingStill;
use super::ground::Ground;
use super::ledger::{Ledger, Member};
use super::maneuver::Maneuver;
use super::passage::{Held, Link, Passage, Wish};
use super::plan::plan;
use super::territories::Territories;
use crate::grid::{Block, Map};
use crate::messages::{GrantRequest, Standing, Step, Territory, link};
use crate::precedence::Precedence;

const fn at(x: i32, y: i32) -> Block {
    Block::new(x, y)
}

/// A zone with the first columns of a map.
struct Site {
    ledger: Ledger,
    ground: Ground,
    maneuvers: Vec<Maneuver>,
}

impl Site {
    fn new(map: &str, width: u32) -> Site {
        let map = Map::read(map).unwrap();
        let territory = Territory { zone: 1, term: 1, corner: at(0, 0), width, height: map.height() };
        Site { ledger: Ledger::new(territory), ground: Ground::new(map), maneuvers: Vec::new() }
    }

    /// A robot says that it holds these blocks, the last of which is the end of its passage.
    fn hold(&mut self, robot: u32, blocks: &[Block], goal: Block, rank: u64) {
        let known = self.ledger.member(robot).map_or(0, |member| member.request.number);
        let steps = blocks.iter().zip(0..).map(|(block, number)| Step { number, block: *block });
        let held: Vec<Step> = steps.filter(|step| self.ledger.territory().contains(step.block)).collect();
        self.ledger.hear(&GrantRequest {
            link: link(1, robot),
            zone: 1,
            term: 1,
            robot,
            incarnation: 1,
            number: known + 1,
            block: blocks[0],
            end: blocks[blocks.len() - 1],
            received: held.last().map_or(0, |step| step.number),
            held,
            goal,
            rank,
            ..GrantRequest::default()
        });
    }

    /// A robot arrives at the end of what was granted to it.
    fn arrive(&mut self, robot: u32) {
        let Member { request, steps, granted, .. } = self.ledger.member(robot).unwrap().clone();
        let Some(last) = steps.last().copied() else { return };
        let number = request.number + 1;
        let (block, end) = (last.block, last.block);
        self.ledger.hear(&GrantRequest { number, block, end, received: granted, held: vec![last], ..request });
    }

    fn round(&mut self) {
        let members = self.ledger.members().values().filter(|member| member.is_obstacle());
        let obstacles = members.flat_map(Member::blocks).collect();
        self.ground.begin_round(obstacles);
        plan(&mut self.ledger, &mut self.maneuvers, &mut self.ground, 1);
        self.ledger.end_round();
    }

    fn member(&self, robot: u32) -> &Member {
        self.ledger.member(robot).unwrap()
    }
}

#[test]
fn a_robot_that_was_stopped_on_its_way_is_at_rest_where_it_stands() {
    let mut site = Site::new("....", 4);
    site.hold(1, &[at(0, 0), at(1, 0), at(2, 0)], at(3, 0), 5);
    site.ledger.stop(1, Some(at(0, 0)));
    assert_eq!((site.member(1).end(), site.member(1).is_at_rest()), (at(0, 0), true));
    assert!(!site.member(1).wants_to_go() && site.member(1).is_obstacle());
    assert_eq!([0, 1, 2].map(|x| site.ledger.holder(at(x, 0))), [Some(1), None, None]);
    // It goes on, and says so.
    site.hold(1, &[at(0, 0)], at(3, 0), 5);
    assert!(site.member(1).wants_to_go() && !site.member(1).is_obstacle());
}

#[test]
fn blocks_ahead_of_a_robot_that_was_stopped_outside_of_a_zone_are_free() {
    let mut site = Site::new("......", 2);
    site.hold(1, &[at(3, 0), at(2, 0)], at(0, 0), 5);
    assert_eq!(site.ledger.outside(), BTreeMap::from([(at(2, 0), 1), (at(3, 0), 1)]));
    site.ledger.stop(1, Some(at(3, 0)));
    assert_eq!(site.ledger.outside(), BTreeMap::from([(at(3, 0), 1)]));
}

/// Robots that get past each other beside a bay, and a third one beside them that failed on its way.
#[test]
fn robots_get_past_each_other_beside_one_that_failed_while_it_moved() {
    for stopped in [Some(at(3, 0)), None] {
        let mut site = Site::new(".....\n@.@@@", 5);
        site.hold(1, &[at(0, 0)], at(2, 0), 9);
        site.hold(2, &[at(2, 0)], at(0, 0), 8);
        site.hold(3, &[at(3, 0), at(4, 0)], at(4, 0), 7);
        site.ledger.stop(3, stopped);
        for _ in 0..80 {
            site.round();
            [1, 2].into_iter().for_each(|robot| site.arrive(robot));
        }
        assert_eq!([1, 2].map(|robot| site.member(robot).end()), [at(2, 0), at(0, 0)], "stopped at {stopped:?}");
    }
}

/// True if there is a deadlock behind a robot that rests at the end of a corridor, with these robots in a maneuver.
fn is_deadlock_behind(rank: u64, moving: &[u32]) -> bool {
    let mut site = Site::new("...", 3);
    site.hold(1, &[at(0, 0)], at(2, 0), 5);
    site.hold(2, &[at(1, 0)], at(2, 0), 6);
    site.hold(3, &[at(2, 0)], at(2, 0), rank);
    let moving: BTreeSet<u32> = moving.iter().copied().collect();
    let mut standing_still = StandingStill::default();
    let mut found = Vec::new();
    for _ in 0..100 {
        site.round();
        found = standing_still.count(&site.ledger, &mut site.ground, &moving, || 0);
    }
    !found.is_empty()
}

#[test]
fn robots_behind_one_that_charges_are_in_no_deadlock() {
    assert!(is_deadlock_behind(0, &[]), "it rests, and cannot make way");
    assert!(is_deadlock_behind(6, &[]), "it would make way for the robot that waits");
    assert!(!is_deadlock_behind(7, &[]), "it stays until it is charged");
}

/// The deadlocks after some rounds with robots that stand on these blocks and go to these goals, the most urgent first.
fn deadlocks(map: &str, width: u32, ways: &[(Block, Block)]) -> Vec<String> {
    let mut site = Site::new(map, width);
    let robots: Vec<u32> = (1..).take(ways.len()).collect();
    for (robot, (from, goal)) in robots.iter().zip(ways) {
        site.hold(*robot, &[*from], *goal, 100 - u64::from(*robot));
    }
    let mut standing_still = StandingStill::default();
    let mut found = Vec::new();
    for _ in 0..50 {
        site.round();
        robots.iter().for_each(|robot| site.arrive(*robot));
        found = standing_still.count(&site.ledger, &mut site.ground, &BTreeSet::new(), || 0);
    }
    found.iter().map(ToString::to_string).collect()
}

#[test]
fn all_robots_of_a_deadlock_are_named() {
    let ring = [(at(0, 0), at(1, 0)), (at(1, 0), at(1, 1)), (at(1, 1), at(0, 1)), (at(0, 1), at(0, 0))];
    let told = "robots 1 at (0,0), 2 at (1,0), 3 at (1,1), 4 at (0,1) are in each other's way, and cannot get past";
    assert_eq!(deadlocks("..\n..", 2, &ring), [told]);
    let line = [(at(0, 0), at(2, 0)), (at(1, 0), at(0, 0)), (at(2, 0), at(0, 0))];
    let told = "robots 1 at (0,0), 2 at (1,0) are in each other's way, and cannot get past";
    assert_eq!(deadlocks("...", 3, &line), [told]);
    // With room beside them they get past each other.
    assert_eq!(deadlocks("...\n...", 3, &line), [""; 0]);
}

#[test]
fn a_deadlock_that_was_named_lasts_although_longer_moves_are_heard_of_later() {
    let mut site = Site::new("...", 3);
    site.hold(1, &[at(0, 0)], at(2, 0), 99);
    site.hold(2, &[at(1, 0)], at(0, 0), 98);
    let mut standing_still = StandingStill::default();
    let mut named = |site: &mut Site, rounds: u32, longest_move: u32| -> Vec<bool> {
        let mut count = || {
            site.round();
            [1, 2].into_iter().for_each(|robot| site.arrive(robot));
            !standing_still.count(&site.ledger, &mut site.ground, &BTreeSet::new(), || longest_move).is_empty()
        };
        (0..rounds).map(|_| count()).collect()
    };
    assert_eq!(named(&mut site, 60, 10), [false; 60], "a move may end yet");
    assert_eq!(named(&mut site, 1, 0), [true]);
    assert_eq!(named(&mut site, 20, 10), [true; 20]);
    site.ledger.end(1, 1);
    assert_eq!(named(&mut site, 2, 0), [false; 2], "the other one goes on");
}

#[test]
fn robots_that_wait_for_their_moves_in_a_maneuver_are_in_no_deadlock() {
    for moving in [[2].as_slice(), &[3], &[1, 2, 3]] {
        assert!(!is_deadlock_behind(0, moving), "{moving:?}");
    }
}

#[test]
fn a_robot_that_is_gone_from_a_border_and_begins_anew_elsewhere_is_not_there_any_more() {
    let mut site = Site::new("............", 2);
    site.hold(1, &[at(2, 0)], at(0, 0), 5);
    site.ledger.end(1, 1);
    assert!(site.ledger.hear_clear(1, 2, (at(11, 0), at(10, 0))));
    assert_eq!(site.ledger.outside(), BTreeMap::new());
    let request = &site.member(1).request;
    assert_eq!((request.block, request.end, request.standing), (at(11, 0), at(10, 0), Standing::MakesWay));
    assert!(!site.member(1).wants_to_go());
}

#[test]
fn a_robot_takes_the_first_step_of_a_zone_that_heard_its_presence_before_its_request() {
    let robot = |zone: u32, received: u64| {
        let territory = Territory { zone, term: 1, corner: at(0, 0), width: 2, height: 1 };
        let link = Link { territory: territory.clone(), received, said: GrantRequest::default(), heard: 0 };
        let held = vec![Held { zone: 0, step: Step { number: 0, block: at(2, 0) } }];
        Passage::with(1, 7, (held, false), Territories::with(vec![territory], Vec::new()), vec![link])
    };
    let mut passage = robot(1, 20);
    let mut site = Site::new("...", 2);
    // It is known of earlier, in a former incarnation as far as the zone can tell.
    site.hold(1, &[at(1, 0)], at(0, 0), 5);
    site.ledger.begin_term(2);
    passage.hear_territory(site.ledger.territory());
    let wish = Wish { goal: Some(at(0, 0)), ..Wish::default() };
    let [request] = &passage.requests(wish, false)[..] else { panic!() };
    assert!(site.ledger.hear_clear(1, 7, (at(2, 0), at(2, 0))));
    site.ledger.hear(request);
    assert!(site.ledger.grant(1, at(1, 0)));
    assert!(passage.hear(&site.ledger.message(1).unwrap()));
    assert_eq!(passage.next(), Some(at(1, 0)));
}

#[test]
fn a_robot_makes_way_over_an_edge_for_one_of_the_lowest_rank() {
    let mut site = Site::new("....", 2);
    site.hold(1, &[at(1, 0)], at(1, 0), 0);
    let rank = |site: &Site| site.ledger.message(1).unwrap().aside_rank;
    assert_eq!(rank(&site), 0);
    for (given, said) in [(0, 1), (7, 7)] {
        site.ledger.member_mut(1).unwrap().aside = Some((at(2, 0), given));
        assert_eq!(rank(&site), said);
    }
}

/// A robot of another zone wants to enter this one, and the robots of this one are in its way.
#[test]
fn robots_of_other_zones_do_not_count_as_waiting_here_and_hear_who_is_in_the_way() {
    let mut site = Site::new("...", 2);
    site.hold(1, &[at(2, 0)], at(0, 0), 5);
    site.hold(2, &[at(1, 0)], at(2, 0), 9);
    for _ in 0..3 {
        site.round();
    }
    assert_eq!((site.member(1).waited, site.member(2).waited), (0, 3));
    assert_eq!(site.member(1).in_the_way, Some((at(1, 0), 2)));
    // It does not want to go on any more.
    site.hold(2, &[at(1, 0)], at(1, 0), 9);
    site.round();
    assert_eq!(site.member(2).waited, 0);
}

#[test]
fn a_zone_knows_why_the_robot_that_is_waited_for_goes_first() {
    let why = |map: &str, robots: &[(u32, &[Block], Block)], stays: &[u32]| {
        let mut site = Site::new(map, 3);
        for (robot, blocks, goal) in robots {
            site.hold(*robot, blocks, *goal, 10 - u64::from(*robot));
        }
        for robot in stays {
            site.ledger.member_mut(*robot).unwrap().request.standing = Standing::Stays;
        }
        site.round();
        let member = site.member(1);
        (member.in_the_way, member.rule)
    };
    let floor = "...\n...";
    let waits: (u32, &[Block], Block) = (1, &[at(0, 0)], at(2, 0));
    let there: (u32, &[Block], Block) = (2, &[at(1, 0)], at(1, 0));
    assert_eq!(why(floor, &[waits, there], &[]), (Some((at(1, 0), 2)), Precedence::There));
    assert_eq!(why(floor, &[waits, there], &[2]), (Some((at(1, 0), 2)), Precedence::Stays));
    let comes = (2, &[at(1, 1), at(1, 0)][..], at(1, 0));
    assert_eq!(why(floor, &[waits, comes], &[]), (Some((at(1, 0), 2)), Precedence::Granted));
    let into: (u32, &[Block], Block) = (1, &[at(0, 2)], at(1, 0));
    let out_of: (u32, &[Block], Block) = (2, &[at(1, 1)], at(2, 3));
    let stands: (u32, &[Block], Block) = (3, &[at(1, 2)], at(1, 2));
    let dead_end = why("@.@\n@.@\n...\n...", &[into, out_of, stands], &[3]);
    assert_eq!(dead_end, (Some((at(1, 1), 2)), Precedence::ComesOut));
}

#[test]
fn a_robot_that_does_not_make_way_over_an_edge_hears_of_it_no_more_after_a_while() {
    let mut site = Site::new("....", 2);
    site.hold(1, &[at(1, 0)], at(1, 0), 0);
    let mut asides = Asides::default();
    let mut heard = |site: &mut Site, aside: Block, executions: std::ops::Range<u64>| {
        site.ledger.member_mut(1).unwrap().aside = Some((aside, 9));
        executions.filter(|execution| asides.note(&site.ledger, &[], *execution) == [1]).count()
    };
    assert_eq!(heard(&mut site, at(2, 0), 0..200), 61);
    assert_eq!(heard(&mut site, at(2, 0), 200..300), 0);
    assert_eq!(heard(&mut site, at(1, 0), 300..400), 61, "it has to stay");
    site.hold(1, &[at(0, 0)], at(0, 0), 0);
    assert_eq!(heard(&mut site, at(1, 0), 400..500), 61, "it has moved");
}

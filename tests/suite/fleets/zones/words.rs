//! What a zone makes of words about robots that are not near it.

use std::time::Duration;

use saoms_api::Time;
use saoms_components::grid::Block;
use saoms_components::messages::{
    ClearTerm, FAULT, Fault, GRANT, GRANT_REQUEST, Grant, GrantRequest, LAST_NUMBER, PRESENCE, Presence, Standing,
    Step, TERRITORY, link,
};
use saoms_components::zone::Zone;
use saoms_testkit::Bench;

/// The zone of the right half of a corridor.
struct Right {
    zone: Bench,
    term: u64,
}

const NUMBER: u32 = 2;

/// After all that was said.
const HOUR: Duration = Duration::from_secs(3600);

const fn at(x: i32) -> Block {
    Block::new(x, 0)
}

impl Right {
    fn new() -> Right {
        let mut zone = Bench::of::<Zone>(&[("number", "2"), ("x", "4"), ("map", "........")]).unwrap();
        zone.start().unwrap();
        let term = zone.sent(&TERRITORY)[0].term;
        Right { zone, term }
    }

    fn request(&self, robot: u32, number: u64, block: Block, held: &[Block]) -> GrantRequest {
        let end = held.last().copied().unwrap_or(block);
        GrantRequest {
            link: link(NUMBER, robot),
            zone: NUMBER,
            term: self.term,
            robot,
            incarnation: 7,
            number,
            at: at(4),
            block,
            end,
            received: 0,
            held: held.iter().zip(0..).map(|(block, number)| Step { number, block: *block }).collect(),
            goal: end,
            charger: block,
            ..GrantRequest::default()
        }
    }

    fn presence(&self, robot: u32, incarnation: u64, block: Block, is_lost: bool) -> Presence {
        let clear = vec![ClearTerm { zone: NUMBER, term: self.term }];
        Presence { robot, incarnation, block, end: block, is_lost, charger: block, clear }
    }

    fn hear(&mut self, request: GrantRequest) {
        self.zone.deliver(&GRANT_REQUEST, request);
        self.zone.execute().unwrap();
    }

    fn hear_presence(&mut self, presence: Presence) {
        self.zone.deliver(&PRESENCE, presence);
        self.zone.execute().unwrap();
    }

    fn hear_gone(&mut self, fault: Fault) {
        self.zone.deliver(&FAULT, fault);
        self.zone.execute().unwrap();
    }

    /// The blocks that robot 2, on the last one, gets on its way to the other end of the corridor.
    fn granted(&mut self) -> Vec<Block> {
        self.granted_to(at(0))
    }

    /// The same on its way to this block.
    fn granted_to(&mut self, goal: Block) -> Vec<Block> {
        let request = GrantRequest { goal, rank: 9, ..self.request(2, 1, at(7), &[at(7)]) };
        self.zone.deliver(&GRANT_REQUEST, request);
        let mut granted = Vec::new();
        for _ in 0..6 {
            self.zone.execute().unwrap();
            for grant in self.zone.sent(&GRANT).into_iter().filter(|grant| grant.robot == 2) {
                granted = grant.steps.iter().map(|step| step.block).filter(|block| *block != at(7)).collect();
            }
        }
        granted
    }
}

/// A robot that begins anew far from the zone holds nothing of it any more, although it sends it no request.
#[test]
fn what_an_earlier_incarnation_held_is_free() {
    let mut right = Right::new();
    right.hear(right.request(1, 1, at(6), &[at(6)]));
    right.hear_presence(right.presence(1, 8, at(0), false));
    // Late words of the earlier incarnation change nothing.
    right.hear(right.request(1, 2, at(6), &[at(6)]));
    assert_eq!(right.granted().first(), Some(&at(6)), "{}", right.zone.transcript());
}

#[test]
fn a_presence_of_the_same_incarnation_frees_nothing() {
    let mut right = Right::new();
    right.hear(right.request(1, 1, at(6), &[at(6)]));
    right.hear_presence(right.presence(1, 7, at(0), false));
    assert_eq!(right.granted(), [], "{}", right.zone.transcript());
}

/// The robot could not move for some time beside the zone, and drove away from it then.
#[test]
fn a_robot_that_can_move_again_closes_no_block() {
    let mut right = Right::new();
    right.hear(GrantRequest { standing: Standing::Lost, ..right.request(1, 1, at(3), &[]) });
    right.hear_presence(right.presence(1, 7, at(0), false));
    assert_eq!(right.granted().first(), Some(&at(6)), "{}", right.zone.transcript());
}

#[test]
fn a_robot_that_failed_elsewhere_closes_no_block_where_it_was_once() {
    let mut right = Right::new();
    right.hear(right.request(1, 1, at(4), &[at(4)]));
    right.hear(right.request(1, 2, at(3), &[]));
    let failed = Fault { block: Some(at(0)), ..Fault::failure(1, Time::START + HOUR, false) };
    right.zone.deliver(&FAULT, failed);
    right.zone.execute().unwrap();
    assert_eq!(right.granted_to(at(2)).first(), Some(&at(6)), "{}", right.zone.transcript());
}

#[test]
fn blocks_ahead_of_a_robot_that_failed_in_another_zone_are_free() {
    let mut right = Right::new();
    right.hear(right.request(1, 1, at(3), &[at(4), at(5), at(6)]));
    let failed = Fault { block: Some(at(2)), ..Fault::failure(1, Time::START + HOUR, false) };
    right.zone.deliver(&FAULT, failed);
    right.zone.execute().unwrap();
    assert_eq!(right.granted_to(at(3)).first(), Some(&at(6)), "{}", right.zone.transcript());
}

/// What it said before that arrives late, in any order, and another word of the event changes nothing.
#[test]
fn blocks_of_a_robot_that_is_gone_stay_free() {
    let mut right = Right::new();
    right.hear(right.request(1, 1, at(6), &[at(6)]));
    right.hear_gone(Fault::gone(1));
    right.hear(right.request(1, 3, at(5), &[at(5), at(6)]));
    right.zone.execute().unwrap();
    let told = right.zone.sent(&GRANT);
    let is_told = |grant: &Grant| grant.heard == LAST_NUMBER && grant.steps.is_empty();
    assert!(told.iter().any(is_told), "a robot that is there by mistake has to hear it: {told:?}");
    right.hear(GrantRequest { standing: Standing::Lost, ..right.request(1, 2, at(5), &[at(5)]) });
    right.hear_presence(right.presence(1, 7, at(5), true));
    assert_eq!(right.granted_to(at(4)), [at(6), at(5), at(4)], "{}", right.zone.transcript());
}

#[test]
fn a_robot_that_is_gone_and_begins_anew_is_not_gone_when_the_event_is_said_again() {
    let mut right = Right::new();
    right.hear(right.request(1, 1, at(6), &[at(6)]));
    right.hear_gone(Fault::gone(1));
    let since = Some(Time::START + Duration::from_millis(500));
    right.zone.execute_until(Duration::from_secs(1)).unwrap();
    right.hear(GrantRequest { incarnation: 8, ..right.request(1, 1, at(6), &[at(6)]) });
    right.hear_gone(Fault { since, ..Fault::gone(1) });
    assert_eq!(right.granted(), [], "{}", right.zone.transcript());
}

/// A zone that heard of a robot that it is there, and no request of it yet.
#[test]
fn a_robot_that_is_gone_gets_nothing_for_its_first_request() {
    let mut right = Right::new();
    right.hear_presence(right.presence(1, 7, at(0), false));
    right.hear_gone(Fault::gone(1));
    right.hear(GrantRequest { goal: at(6), rank: 10, ..right.request(1, 1, at(3), &[]) });
    assert_eq!(right.granted_to(at(4)), [at(6), at(5), at(4)], "{}", right.zone.transcript());
}

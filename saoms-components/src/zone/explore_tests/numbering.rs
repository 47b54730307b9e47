//! States that differ in what makes no difference are one.

use super::part::Part;
use super::state::{Message, Robot, State, Zone};
use crate::messages::{GrantRequest, LAST_NUMBER, link};
use crate::zone::passage::Passage;

/// A number of a request or of a step, on a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Number {
    of_step: bool,
    link: u64,
    pub(super) is: u64,
}

impl Number {
    /// Another one of the same kind and link.
    pub(super) fn being(self, is: u64) -> Number {
        Number { is, ..self }
    }
}

/// What has numbers.
pub(super) trait Numbered {
    /// Shows all of them, to be changed.
    fn visit(&mut self, see: See<'_>);
}

type See<'s> = &'s mut dyn FnMut(Number, &mut u64);

impl State {
    /// Drops messages from which nothing comes, and numbers requests and steps anew, from 1 on and in the same order.
    /// The protocol compares numbers, and gives new ones above all others, so that states that differ in them alone go
    /// on alike.
    pub(super) fn settle(&mut self) {
        self.drop_answered();
        let State { robots, zones, network, .. } = self;
        let mut used: Vec<Number> = Vec::with_capacity(64);
        let mut note = |numbers: &[Number]| {
            used.extend(numbers.iter().flat_map(|number| [number.being(0), *number]));
        };
        robots.iter_mut().for_each(|part| note(&part.numbers()));
        zones.iter_mut().for_each(|part| note(&part.numbers()));
        network.iter_mut().for_each(|part| note(&part.numbers()));
        used.sort_unstable();
        used.dedup();
        let place = |number: Number| used.binary_search(&number).unwrap();
        // The last number has a meaning of its own.
        let rank = |number: Number| match number.is {
            LAST_NUMBER => LAST_NUMBER,
            _ => (place(number) - place(number.being(0))) as u64,
        };
        if used.iter().any(|number| rank(*number) != number.is) {
            robots.iter_mut().for_each(|part| part.renumber(rank));
            zones.iter_mut().for_each(|part| part.renumber(rank));
            network.iter_mut().for_each(|part| part.renumber(rank));
        }
        network.sort_unstable_by_key(Part::digest);
    }
}

fn of_request(link: u64) -> Number {
    Number { of_step: false, link, is: 0 }
}

fn of_step(link: u64) -> Number {
    Number { of_step: true, link, is: 0 }
}

/// Shows the numbers of a request, as one of this link.
fn visit_request(request: &mut GrantRequest, link: u64, see: See<'_>) {
    see(of_request(link), &mut request.number);
    see(of_step(link), &mut request.received);
    request.held.iter_mut().for_each(|step| see(of_step(link), &mut step.number));
}

impl Numbered for Robot {
    fn visit(&mut self, see: See<'_>) {
        let passage = &self.passage;
        let robot = passage.robot();
        let (mut held, mut links) = (passage.held().to_vec(), passage.links().to_vec());
        for one in held.iter_mut().filter(|one| one.zone != 0) {
            see(of_step(link(one.zone, robot)), &mut one.step.number);
        }
        for one in &mut links {
            let link = link(one.territory.zone, robot);
            see(of_step(link), &mut one.received);
            visit_request(&mut one.said, link, see);
            // What was heard decides what is said again: here each message may come again anyway.
            one.heard = 0;
        }
        let held = (held, passage.enters());
        self.passage = Passage::with(robot, passage.incarnation(), held, passage.territories().clone(), links);
    }
}

impl Numbered for Zone {
    fn visit(&mut self, see: See<'_>) {
        let ledger = &mut self.ledger;
        let zone = ledger.territory().zone;
        for robot in ledger.members().keys().copied().collect::<Vec<_>>() {
            let (member, link) = (ledger.member_mut(robot).unwrap(), link(zone, robot));
            see(of_step(link), &mut member.granted);
            member.steps.iter_mut().for_each(|step| see(of_step(link), &mut step.number));
            visit_request(&mut member.request, link, see);
            // Whom it waits for, and where it makes way, it is told again in each round.
            (member.in_the_way, member.aside) = (None, None);
        }
    }
}

impl Numbered for Message {
    fn visit(&mut self, see: See<'_>) {
        match self {
            Message::Territory(..) | Message::Clear(..) | Message::Gone(..) => {}
            Message::Request(request) => visit_request(request, request.link, see),
            Message::Grant(grant) => {
                grant.steps.iter_mut().for_each(|step| see(of_step(grant.link), &mut step.number));
            }
        }
    }
}

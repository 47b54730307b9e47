//! States that differ in what makes no difference are one.

use super::{Message, Robot, State, Zone, hash};
use crate::messages::{GrantRequest, link};
use crate::zone::ledger::Heard;
use crate::zone::passage::Passage;

impl State {
    /// Drops messages about terms that nobody waits for any more, and that change nothing when they come again.
    fn drop_answered(&mut self) {
        let State { zones, robots, network, faults, drawings, .. } = self;
        let place = |zone: u32| zones.iter().position(|one| one.ledger.territory().zone == zone);
        network.retain(|message| {
            if *drawings > 0 && is_former(message, zones, robots) {
                return false;
            }
            let reader = match message {
                Message::Territory(robot, _) => *robot,
                Message::Grant(grant) => grant.robot,
                Message::Request(request) => {
                    // What changes nothing now does not later on, since the robot says nothing new.
                    let ledger = &zones[place(request.zone).unwrap()].ledger;
                    return !ledger.has_ended(request.robot, request.incarnation)
                        || ledger.clone().hear(request) != Heard::Nothing;
                }
                Message::Clear(..) | Message::Gone(..) => 0,
            };
            if reader != 0 && robots[reader as usize - 1].is_gone && faults.back == 0 {
                return false;
            }
            let (robot, zone, is_known) = match message {
                Message::Territory(robot, territory) => {
                    let known = robots[*robot as usize - 1].passage.territories().known();
                    let known = known.iter().find(|known| known.zone == territory.zone);
                    (robot, territory.zone, known.is_some_and(|known| known.term >= territory.term))
                }
                Message::Clear(robot, incarnation, clear, _) => {
                    let ledger = &zones[place(clear.zone).unwrap()].ledger;
                    let member = ledger.member(*robot);
                    let is_known = member.is_none_or(|member| member.request.incarnation >= *incarnation);
                    (robot, clear.zone, is_known || clear.term < ledger.territory().term)
                }
                Message::Request(_) | Message::Grant(_) | Message::Gone(..) => return true,
            };
            let waits = place(zone).is_some_and(|place| zones[place].unheard.contains(robot));
            !is_known || faults.zones > 0 || waits
        });
    }

    /// Numbers requests and steps anew, from 1 on and in the same order. The protocol compares them, and gives new ones
    /// numbers above all others, so that states that differ in their numbers alone go on alike.
    pub(super) fn renumber(&mut self) {
        self.drop_answered();
        let (mut requests, mut steps) = (Numbers::default(), Numbers::default());
        self.visit(|of, link, number| {
            let numbers = if of == Numbered::Request { &mut requests } else { &mut steps };
            numbers.used.extend([(link, 0), (link, *number)]);
        });
        requests.sort();
        steps.sort();
        self.visit(|of, link, number| {
            let numbers = if of == Numbered::Request { &requests } else { &steps };
            *number = numbers.rank(link, *number);
        });
        self.network.sort_by_cached_key(hash);
    }

    /// Shows all numbers of requests and steps, with their links.
    fn visit(&mut self, mut see: impl FnMut(Numbered, u64, &mut u64)) {
        let of_request = |request: &mut GrantRequest, see: &mut dyn FnMut(Numbered, u64, &mut u64)| {
            see(Numbered::Request, request.link, &mut request.number);
            see(Numbered::Step, request.link, &mut request.received);
            request.held.iter_mut().for_each(|step| see(Numbered::Step, request.link, &mut step.number));
        };
        for Robot { passage, .. } in &mut self.robots {
            let robot = passage.robot();
            let (mut held, mut links) = (passage.held().to_vec(), passage.links().to_vec());
            for one in held.iter_mut().filter(|one| one.zone != 0) {
                see(Numbered::Step, link(one.zone, robot), &mut one.step.number);
            }
            for one in &mut links {
                let link = link(one.territory.zone, robot);
                see(Numbered::Step, link, &mut one.received);
                see(Numbered::Request, link, &mut one.heard);
                // What it said before it said anything has no link.
                let before = std::mem::replace(&mut one.said.link, link);
                of_request(&mut one.said, &mut see);
                one.said.link = before;
            }
            let held = (held, passage.enters());
            *passage = Passage::with(robot, passage.incarnation(), held, passage.territories().clone(), links);
        }
        for Zone { ledger, .. } in &mut self.zones {
            let zone = ledger.territory().zone;
            for robot in ledger.members().keys().copied().collect::<Vec<_>>() {
                let member = ledger.member_mut(robot).unwrap();
                see(Numbered::Step, link(zone, robot), &mut member.granted);
                member.steps.iter_mut().for_each(|step| see(Numbered::Step, link(zone, robot), &mut step.number));
                of_request(&mut member.request, &mut see);
            }
        }
        for message in &mut self.network {
            match message {
                Message::Territory(..) | Message::Clear(..) | Message::Gone(..) => {}
                Message::Request(request) => of_request(request, &mut see),
                Message::Grant(grant) => {
                    see(Numbered::Request, grant.link, &mut grant.heard);
                    grant.steps.iter_mut().for_each(|step| see(Numbered::Step, grant.link, &mut step.number));
                }
            }
        }
    }
}

/// True for a message to a zone that is none any more, or was another one then, and for a message of such a zone to a
/// robot that knows another one there: nothing comes of it.
fn is_former(message: &Message, zones: &[Zone], robots: &[Robot]) -> bool {
    let is_over = |zone: u32, term: u64| {
        let now = zones.iter().map(|one| one.ledger.territory()).find(|now| now.zone == zone);
        now.is_none_or(|now| now.term > term)
    };
    let territories = |robot: u32| robots[robot as usize - 1].passage.territories();
    match message {
        Message::Request(request) => is_over(request.zone, request.term),
        Message::Clear(_, _, clear, _) => is_over(clear.zone, clear.term),
        Message::Gone(zone, ..) => is_over(*zone, u64::MAX),
        Message::Territory(robot, territory) => {
            is_over(territory.zone, territory.term) && !territories(*robot).clone().hear(territory)
        }
        Message::Grant(grant) => {
            let known = territories(grant.robot).known().iter().find(|known| known.zone == grant.zone);
            known.is_none_or(|known| known.term > grant.term)
        }
    }
}

/// What has a number.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Numbered {
    Request,
    Step,
}

/// The numbers that are used, by link.
#[derive(Default)]
struct Numbers {
    used: Vec<(u64, u64)>,
}

impl Numbers {
    fn sort(&mut self) {
        self.used.sort_unstable();
        self.used.dedup();
    }

    /// How many numbers of a link are below this one.
    fn rank(&self, link: u64, number: u64) -> u64 {
        let place = |number: u64| self.used.binary_search(&(link, number)).unwrap();
        (place(number) - place(0)) as u64
    }
}

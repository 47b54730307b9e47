//! Invariant 4 in each period: a piece of luggage is where it was put, on exactly one robot, or delivered.

use std::collections::BTreeMap;

use saoms_api::host::SharedMessage;

use super::{Finder, ONE_PLACE};
use crate::grid::Block;
use crate::messages::{EventLuggage, Handling, HandlingKind, LuggageStage, is_visit};

/// Where the pieces of luggage are, as a world says.
#[derive(Debug, Default)]
pub(super) struct Bearers {
    /// By the world and the number of the luggage.
    places: BTreeMap<(u32, u32), Place>,
    /// Where luggage that nobody has collected yet was requested first.
    origins: BTreeMap<u32, Block>,
    /// The worlds, and whether they have begun again: one that goes on from its memory knows where luggage was left
    /// before, of which requests say its first block.
    worlds: BTreeMap<u32, bool>,
}

/// The place of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    At(Block),
    On(u32),
    Delivered,
}

impl Bearers {
    /// A world begins: it may have forgotten where luggage is.
    pub(super) fn begin(&mut self, message: &SharedMessage) {
        let world = message.header().sender;
        self.places.retain(|(known, _), _| *known != world);
        self.origins.clear();
        self.worlds.entry(world).and_modify(|again| *again = true).or_insert(false);
    }

    /// Luggage is requested.
    pub(super) fn hear_request(&mut self, message: &SharedMessage) {
        if let Some(said) = message.get::<EventLuggage>().filter(|said| said.stage == LuggageStage::Request)
            && !is_visit(said.luggage)
        {
            self.origins.entry(said.luggage).or_insert(said.from);
        }
    }

    /// A world says what a robot did.
    pub(super) fn hear(&mut self, message: &SharedMessage, finder: &mut Finder<'_>) {
        let Some(Handling { luggage, robot, kind, block, other }) = message.get::<Handling>().cloned() else { return };
        let key = (message.header().sender, luggage);
        let has_begun_again = self.worlds.get(&key.0).is_some_and(|again| *again);
        let is_first = kind == HandlingKind::Collected && other == 0 && !has_begun_again;
        let origin = self.origins.get(&luggage).filter(|_| is_first).map(|from| Place::At(*from));
        let before = self.places.get(&key).copied().or(origin);
        let (does, expected, now) = match (kind, other) {
            (HandlingKind::Collected, 0) => ("collects", Place::At(block), Place::On(robot)),
            (HandlingKind::Collected, _) => ("collects", Place::On(other), Place::On(robot)),
            (HandlingKind::PutDown, _) => ("puts down", Place::On(robot), Place::At(block)),
            (HandlingKind::Delivered, _) => ("delivers", Place::On(robot), Place::Delivered),
        };
        if let Some(before) = before.filter(|before| *before != expected) {
            let place = match before {
                Place::At(block) => format!("is at {block}"),
                Place::On(robot) => format!("is on robot {robot}"),
                Place::Delivered => "is delivered".to_owned(),
            };
            finder.note(ONE_PLACE, format!("robot {robot} {does} luggage {luggage} at {block}, which {place}"));
        }
        self.places.insert(key, now);
    }
}

#[cfg(test)]
mod tests {
    use saoms_api::{Cause, Header, Message, Time};

    use super::*;
    use crate::hardware::Area;

    fn said<M: Message>(message: M) -> SharedMessage {
        SharedMessage::new(Header { sender: 1, sent: Time::START, cause: Cause::default() }, message)
    }

    /// What is found where a world that has begun so often says that robot 2 collects luggage 7 at a block, from a
    /// robot or none. It was requested at (1,0).
    fn found(begins: usize, x: i32, other: u32) -> Vec<String> {
        let (mut bearers, mut found) = (Bearers::default(), Vec::new());
        (0..begins).for_each(|_| bearers.begin(&said(Area::from(&crate::grid::Map::new(4, 1)))));
        bearers.hear_request(&said(EventLuggage::request(7, Block::new(1, 0), Block::new(3, 0))));
        let (kind, block) = (HandlingKind::Collected, Block::new(x, 0));
        let mut finder = Finder { site: "", at: Time::START, found: &mut found };
        bearers.hear(&said(Handling { luggage: 7, robot: 2, kind, block, other }), &mut finder);
        found.iter().map(|one| one.text.clone()).collect()
    }

    #[test]
    fn luggage_is_collected_first_where_it_was_requested() {
        assert_eq!(found(1, 1, 0), [""; 0]);
        assert_eq!(found(1, 2, 0), ["robot 2 collects luggage 7 at (2,0), which is at (1,0)"]);
    }

    #[test]
    fn a_world_that_goes_on_knows_better_than_a_request_where_luggage_is() {
        assert_eq!(found(2, 2, 0), [""; 0], "it was put down there before");
        assert_eq!(found(1, 2, 3), [""; 0], "another robot had it");
    }
}

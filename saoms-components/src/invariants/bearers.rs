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
        let origin = self.origins.get(&luggage).map(|from| Place::At(*from));
        let before = self.places.get(&key).copied().or(origin.filter(|_| kind == HandlingKind::Collected));
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

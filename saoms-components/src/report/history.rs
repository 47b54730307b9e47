//! The history of a fleet of robots: the luggage that was brought, and the blocks that were visited.

use std::collections::HashMap;

use saoms_api::Time;
use saoms_api::extension::{
    HistoryColumn, HistoryKind, HistoryRegistration, HistoryRow, HistoryTable, HistoryValue, RunHistory, submit,
};
use saoms_api::host::{SharedMessage, TopicDeclaration};

use crate::grid::Block;
use crate::messages::{
    ASSIGNMENT, Assignment, EVENT_LUGGAGE, EventLuggage, FIRST_VISIT, LuggageStage, REMOVAL, Removal, VISIT, Visit,
    carries, is_visit,
};
use crate::state::Numbers;

const fn column(name: &'static str, kind: HistoryKind, doc: &'static str) -> HistoryColumn {
    HistoryColumn { name, kind, doc }
}

const TABLES: &[HistoryTable] = &[
    HistoryTable {
        name: "deliveries",
        doc: "A piece of luggage that was brought or given up, or a visit that was done",
        columns: &[
            column("site", HistoryKind::Text, "the site, such as `North`; empty outside of sites"),
            column("piece", HistoryKind::Text, "`luggage` or `visit`"),
            column("number", HistoryKind::Integer, "the number of the luggage, or of the visit from 1 on"),
            column("outcome", HistoryKind::Text, "`delivered` or `given up`"),
            column("robot", HistoryKind::Text, "the component of the robot that brought it"),
            column("asked_s", HistoryKind::Real, "when it was asked for, in seconds of the run"),
            column("taken_s", HistoryKind::Real, "when that robot took it"),
            column("from_x", HistoryKind::Integer, "the block where it waited"),
            column("from_y", HistoryKind::Integer, ""),
            column("to_x", HistoryKind::Integer, "the block where it had to go"),
            column("to_y", HistoryKind::Integer, ""),
        ],
    },
    HistoryTable {
        name: "requests",
        doc: "A piece of luggage or a visit was asked for, or a robot took it",
        columns: &[
            column("site", HistoryKind::Text, "the site, such as `North`; empty outside of sites"),
            column("piece", HistoryKind::Text, "`luggage` or `visit`"),
            column("number", HistoryKind::Integer, "the number of the luggage, or of the visit from 1 on"),
            column("stage", HistoryKind::Text, "`asked`, or `taken` each time that a robot took it"),
            column("robot", HistoryKind::Text, "the component of the robot that took it"),
            column("from_x", HistoryKind::Integer, "the block where it waits"),
            column("from_y", HistoryKind::Integer, ""),
            column("to_x", HistoryKind::Integer, "the block where it has to go"),
            column("to_y", HistoryKind::Integer, ""),
        ],
    },
];

/// The places of the tables.
const DELIVERIES: usize = 0;
const REQUESTS: usize = 1;

submit! { HistoryRegistration { tables: TABLES, new: || Box::new(Deliveries::default()) } }

/// The luggage of a run. Luggage of different sites may have the same number.
#[derive(Debug, Default)]
struct Deliveries {
    /// By the name of the topic, what its messages are, and the site.
    topics: HashMap<String, (Content, String)>,
    sites: HashMap<String, Site>,
}

#[derive(Debug, Default)]
struct Site {
    open: HashMap<u32, Piece>,
    closed: Numbers,
}

#[derive(Debug)]
struct Piece {
    asked: Time,
    /// The component that took it last, and when.
    taken: Option<(String, Time)>,
    way: Way,
}

/// The block where a piece waits, and the one where it has to go.
type Way = [Option<Block>; 2];

/// What the messages of a topic are.
#[derive(Clone, Copy, Debug)]
enum Content {
    Assignment,
    Luggage,
    Removal,
    Visit,
}

impl Site {
    /// The row of a piece that is asked for, unless it has one.
    fn ask(&mut self, name: &str, number: u32, at: Time, way: Way) -> Option<HistoryRow> {
        if self.closed.contains(number) || self.open.contains_key(&number) {
            return None;
        }
        self.open.insert(number, Piece { asked: at, taken: None, way });
        Some(request(name, number, ASKED, None, way))
    }

    /// The row of a piece that a robot takes, unless that took it last.
    fn take(&mut self, name: &str, number: u32, at: Time, robot: &str) -> Option<HistoryRow> {
        let piece = self.open.get_mut(&number)?;
        let is_new = piece.taken.as_ref().is_none_or(|(by, _)| by != robot);
        piece.taken = Some((robot.to_owned(), at));
        is_new.then(|| request(name, number, TAKEN, Some(robot), piece.way))
    }

    /// The row of a piece, unless it has one. `way` is its way as far as the message says it that ends it.
    fn close(&mut self, name: &str, number: u32, outcome: &str, robot: Option<&str>, way: Way) -> Option<HistoryRow> {
        if !self.closed.insert(number) {
            return None;
        }
        let piece = self.open.remove(&number);
        let piece = piece.as_ref();
        let taken = piece.and_then(|piece| piece.taken.as_ref());
        let robot = robot.or(taken.filter(|_| outcome == DELIVERED).map(|(robot, _)| robot.as_str()));
        let taken = taken.filter(|(by, _)| Some(by.as_str()) == robot);
        let mut values = named(name, number);
        let more: [HistoryValue; 4] = [
            outcome.into(),
            robot.into(),
            piece.map(|piece| piece.asked.as_secs_f64()).into(),
            taken.map(|(_, at)| at.as_secs_f64()).into(),
        ];
        values.extend(more);
        values.extend(ends(piece.map_or(way, |piece| piece.way)));
        Some(HistoryRow { table: DELIVERIES, values })
    }

    /// Takes in a message; `None` for one that is not what its topic carries.
    fn hear(
        &mut self,
        (content, name): (Content, &str),
        component: &str,
        message: &SharedMessage,
    ) -> Option<Vec<HistoryRow>> {
        let at = message.header().sent;
        match content {
            Content::Luggage => {
                let &EventLuggage { luggage, stage, from, to, .. } = message.get::<EventLuggage>()?;
                let way = [Some(from), Some(to)];
                let rows = match stage {
                    LuggageStage::Delivered => [self.close(name, luggage, DELIVERED, Some(component), way), None],
                    LuggageStage::GivenUp => [self.close(name, luggage, "given up", None, way), None],
                    LuggageStage::Request => [self.ask(name, luggage, at, way), None],
                    LuggageStage::Taken => [self.ask(name, luggage, at, way), self.take(name, luggage, at, component)],
                    LuggageStage::Interest | LuggageStage::Release | LuggageStage::Refused => [None, None],
                };
                Some(rows.into_iter().flatten().collect())
            }
            Content::Assignment => {
                let &Assignment { luggage, from, to, withdrawn, .. } = message.get::<Assignment>()?;
                let row = (!withdrawn).then(|| self.ask(name, luggage, at, [Some(from), Some(to)]));
                Some(row.flatten().into_iter().collect())
            }
            Content::Visit => {
                let visit = message.get::<Visit>()?;
                let way = [visit.stops.first().copied(), visit.stops.last().copied()];
                Some(self.ask(name, visit.visit, at, way).into_iter().collect())
            }
            Content::Removal => {
                let delivered = message.get::<Removal>()?.delivered.iter();
                let close = |luggage: &u32| self.close(name, *luggage, DELIVERED, None, [None; 2]);
                Some(delivered.filter_map(close).collect())
            }
        }
    }

    /// Takes in a row of an earlier program, behind the name of its site.
    fn recall(&mut self, table: usize, at: Time, values: &[HistoryValue]) -> Option<()> {
        let [HistoryValue::Text(piece), HistoryValue::Integer(shown), rest @ ..] = values else { return None };
        let first = if piece == VISIT_PIECE { FIRST_VISIT } else { 0 };
        let number = u32::try_from(*shown).ok()?.checked_add(first)?;
        match (table, rest) {
            (DELIVERIES, _) => {
                self.closed.insert(number);
                self.open.remove(&number);
            }
            (REQUESTS, [HistoryValue::Text(stage), robot, way @ ..]) => match (stage.as_str(), robot) {
                (ASKED, _) => _ = self.ask("", number, at, read_ends(way)),
                (TAKEN, HistoryValue::Text(robot)) => _ = self.take("", number, at, robot),
                _ => {}
            },
            _ => {}
        }
        Some(())
    }
}

/// The values of a row that say which piece it is about.
fn named(site: &str, number: u32) -> Vec<HistoryValue> {
    let (kind, shown) = if is_visit(number) { (VISIT_PIECE, number - FIRST_VISIT) } else { (LUGGAGE_PIECE, number) };
    vec![Some(site).filter(|site| !site.is_empty()).into(), kind.into(), shown.into()]
}

/// The values of a row that say where a piece waits, and where it has to go.
fn ends(way: Way) -> impl Iterator<Item = HistoryValue> {
    way.into_iter().flat_map(|block| [block.map(|block| block.x), block.map(|block| block.y)]).map(HistoryValue::from)
}

/// The opposite.
fn read_ends(values: &[HistoryValue]) -> Way {
    let block = |place: usize| match values.get(place..place + 2) {
        Some([HistoryValue::Integer(x), HistoryValue::Integer(y)]) => {
            Some(Block::new(i32::try_from(*x).ok()?, i32::try_from(*y).ok()?))
        }
        _ => None,
    };
    [block(0), block(2)]
}

/// The row of a piece that is asked for or taken.
fn request(site: &str, number: u32, stage: &str, robot: Option<&str>, way: Way) -> HistoryRow {
    let mut values = named(site, number);
    values.extend([HistoryValue::from(stage), HistoryValue::from(robot)]);
    values.extend(ends(way));
    HistoryRow { table: REQUESTS, values }
}

const DELIVERED: &str = "delivered";
const ASKED: &str = "asked";
const TAKEN: &str = "taken";
const LUGGAGE_PIECE: &str = "luggage";
const VISIT_PIECE: &str = "visit";

impl RunHistory for Deliveries {
    fn wants_topic(&mut self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        let content = match declared {
            one if carries(one, &ASSIGNMENT) => Content::Assignment,
            one if carries(one, &EVENT_LUGGAGE) => Content::Luggage,
            one if carries(one, &REMOVAL) => Content::Removal,
            one if carries(one, &VISIT) => Content::Visit,
            _ => return false,
        };
        let site = name.rsplit_once('/').map_or("", |(site, _)| site);
        self.topics.insert(name.to_owned(), (content, site.to_owned()));
        true
    }

    fn message(&mut self, topic: &str, component: &str, message: &SharedMessage) -> Vec<HistoryRow> {
        let Some((content, name)) = self.topics.get(topic) else { return Vec::new() };
        if !self.sites.contains_key(name) {
            self.sites.insert(name.clone(), Site::default());
        }
        let Some(site) = self.sites.get_mut(name) else { return Vec::new() };
        site.hear((*content, name), component, message).unwrap_or_default()
    }

    fn goes_on(&mut self, time_s: f64, row: &HistoryRow) {
        let Some((site, values)) = row.values.split_first() else { return };
        let site = if let HistoryValue::Text(site) = site { site.as_str() } else { "" };
        let at = Time::from_nanos((time_s * 1e9).round() as u64);
        self.sites.entry(site.to_owned()).or_default().recall(row.table, at, values);
    }
}

#[cfg(test)]
mod tests {
    use saoms_api::{Cause, Header, Message};

    use super::*;

    fn say<M: Message>(history: &mut Deliveries, topic: &str, by: &str, second: u64, message: M) -> Vec<HistoryRow> {
        let header = Header { sender: 0, sent: Time::from_nanos(second * 1_000_000_000), cause: Cause::default() };
        history.message(topic, by, &SharedMessage::new(header, message))
    }

    #[test]
    fn a_piece_has_one_row_with_who_brought_it_and_when() {
        let mut history = Deliveries::default();
        assert!(history.wants_topic("North/luggage", &EVENT_LUGGAGE.declaration()));
        let mut luggage = |by, second, stage| {
            let message = EventLuggage { stage, ..EventLuggage::request(7, Block::new(1, 2), Block::new(3, 4)) };
            say(&mut history, "North/luggage", by, second, message)
        };
        let text = |text: &str| HistoryValue::Text(text.to_owned());
        let requested = |stage: &str, robot: HistoryValue| {
            let named = [text("North"), text("luggage"), HistoryValue::Integer(7), text(stage), robot];
            let ends = [1, 2, 3, 4].map(HistoryValue::Integer);
            [HistoryRow { table: REQUESTS, values: named.into_iter().chain(ends).collect() }]
        };
        assert_eq!(luggage("Environment", 1, LuggageStage::Request), requested("asked", HistoryValue::Null));
        assert_eq!(luggage("Robot1", 2, LuggageStage::Taken), requested("taken", text("Robot1")));
        assert_eq!(luggage("Robot1", 3, LuggageStage::Taken), [], "it is said again");
        assert_eq!(luggage("Robot2", 5, LuggageStage::Taken), requested("taken", text("Robot2")));
        let rows = luggage("Robot2", 9, LuggageStage::Delivered);
        let expected = [
            text("North"),
            text("luggage"),
            HistoryValue::Integer(7),
            text("delivered"),
            text("Robot2"),
            HistoryValue::Real(1.0),
            HistoryValue::Real(5.0),
            HistoryValue::Integer(1),
            HistoryValue::Integer(2),
            HistoryValue::Integer(3),
            HistoryValue::Integer(4),
        ];
        assert_eq!(rows, [HistoryRow { table: DELIVERIES, values: expected.to_vec() }]);
        assert_eq!(luggage("Robot2", 10, LuggageStage::Delivered), [], "it is said again");
    }

    #[test]
    fn a_history_goes_on_with_the_pieces_of_an_earlier_program() {
        let way = |luggage| EventLuggage::request(luggage, Block::new(1, 2), Block::new(3, 4));
        let mut earlier = Deliveries::default();
        assert!(earlier.wants_topic("luggage", &EVENT_LUGGAGE.declaration()));
        assert!(earlier.wants_topic("visits", &VISIT.declaration()));
        let mut rows: Vec<(u64, HistoryRow)> = Vec::new();
        for luggage in [1, 2] {
            for (second, by, stage) in [(1, "Environment", LuggageStage::Request), (2, "Robot1", LuggageStage::Taken)] {
                let said = say(&mut earlier, "luggage", by, second, EventLuggage { stage, ..way(luggage) });
                rows.extend(said.into_iter().map(|row| (second, row)));
            }
        }
        let visit = Visit { visit: FIRST_VISIT + 1, robot: 0, stops: vec![Block::new(5, 6), Block::new(7, 8)] };
        rows.extend(say(&mut earlier, "visits", "Environment", 3, visit).into_iter().map(|row| (3, row)));
        let delivered = |luggage| EventLuggage { stage: LuggageStage::Delivered, ..way(luggage) };
        rows.extend(say(&mut earlier, "luggage", "Robot1", 4, delivered(1)).into_iter().map(|row| (4, row)));
        let mut later = Deliveries::default();
        assert!(later.wants_topic("luggage", &EVENT_LUGGAGE.declaration()));
        // By their tables, as they are read.
        rows.sort_by_key(|(second, row)| (row.table, *second));
        rows.iter().for_each(|(second, row)| later.goes_on(*second as f64, row));
        assert_eq!(say(&mut later, "luggage", "Robot1", 5, delivered(1)), [], "it has its row");
        let row = say(&mut later, "luggage", "Robot1", 6, delivered(2)).remove(0);
        let expected: [HistoryValue; 7] =
            ["Robot1".into(), 1.0.into(), 2.0.into(), 1.into(), 2.into(), 3.into(), 4.into()];
        assert_eq!(row.values[4..], expected);
        let visited = EventLuggage { luggage: FIRST_VISIT + 1, ..delivered(0) };
        let row = say(&mut later, "luggage", "Robot2", 7, visited).remove(0);
        assert_eq!(row.values[1..3], [HistoryValue::from("visit"), 1.into()]);
        assert_eq!(row.values[5..], [3.0.into(), HistoryValue::Null, 5.into(), 6.into(), 7.into(), 8.into()]);
    }

    #[test]
    fn what_is_given_up_and_what_a_robot_left_at_its_destination_has_a_row() {
        let mut history = Deliveries::default();
        assert!(history.wants_topic("luggage", &EVENT_LUGGAGE.declaration()));
        assert!(history.wants_topic("removal", &REMOVAL.declaration()));
        let request = |luggage| EventLuggage::request(luggage, Block::new(0, 0), Block::new(1, 0));
        for (by, stage) in [("Environment", LuggageStage::Request), ("Robot1", LuggageStage::Taken)] {
            for luggage in [1, 2] {
                say(&mut history, "luggage", by, 1, EventLuggage { stage, ..request(luggage) });
            }
        }
        let given_up = EventLuggage { stage: LuggageStage::GivenUp, ..request(1) };
        let row = say(&mut history, "luggage", "Master", 2, given_up).remove(0);
        assert_eq!(
            row.values[3..7],
            [HistoryValue::from("given up"), HistoryValue::Null, HistoryValue::Real(1.0), HistoryValue::Null]
        );
        let removal = Removal { robot: 1, delivered: vec![2], ..Removal::default() };
        let row = say(&mut history, "removal", "World", 3, removal).remove(0);
        assert_eq!(row.values[3..5], [HistoryValue::from("delivered"), HistoryValue::from("Robot1")]);
    }
}

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

const TABLES: &[HistoryTable] = &[HistoryTable {
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
}];

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
    from: Option<Block>,
    to: Option<Block>,
}

/// What the messages of a topic are.
#[derive(Clone, Copy, Debug)]
enum Content {
    Assignment,
    Luggage,
    Removal,
    Visit,
}

impl Site {
    fn ask(&mut self, number: u32, at: Time, from: Option<Block>, to: Option<Block>) {
        if !self.closed.contains(number) {
            self.open.entry(number).or_insert(Piece { asked: at, taken: None, from, to });
        }
    }

    /// The row of a piece, unless it has one.
    fn close(&mut self, name: &str, number: u32, outcome: &str, robot: Option<&str>) -> Option<HistoryRow> {
        if !self.closed.insert(number) {
            return None;
        }
        let piece = self.open.remove(&number);
        let piece = piece.as_ref();
        let taken = piece.and_then(|piece| piece.taken.as_ref());
        let robot = robot.or(taken.filter(|_| outcome == DELIVERED).map(|(robot, _)| robot.as_str()));
        let taken = taken.filter(|(by, _)| Some(by.as_str()) == robot);
        let [from, to] = [piece.and_then(|piece| piece.from), piece.and_then(|piece| piece.to)];
        let (kind, shown) = if is_visit(number) { ("visit", number - FIRST_VISIT) } else { ("luggage", number) };
        let values = vec![
            Some(name).filter(|name| !name.is_empty()).into(),
            kind.into(),
            shown.into(),
            outcome.into(),
            robot.into(),
            piece.map(|piece| piece.asked.as_secs_f64()).into(),
            taken.map(|(_, at)| at.as_secs_f64()).into(),
            from.map(|block| block.x).into(),
            from.map(|block| block.y).into(),
            to.map(|block| block.x).into(),
            HistoryValue::from(to.map(|block| block.y)),
        ];
        Some(HistoryRow { table: 0, values })
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
                let row = match stage {
                    LuggageStage::Delivered => self.close(name, luggage, DELIVERED, Some(component)),
                    LuggageStage::GivenUp => self.close(name, luggage, "given up", None),
                    LuggageStage::Request | LuggageStage::Taken => {
                        self.ask(luggage, at, Some(from), Some(to));
                        if let Some(piece) = self.open.get_mut(&luggage).filter(|_| stage == LuggageStage::Taken) {
                            piece.taken = Some((component.to_owned(), at));
                        }
                        None
                    }
                    LuggageStage::Interest | LuggageStage::Release | LuggageStage::Refused => None,
                };
                return Some(row.into_iter().collect());
            }
            Content::Assignment => {
                let &Assignment { luggage, from, to, withdrawn, .. } = message.get::<Assignment>()?;
                if !withdrawn {
                    self.ask(luggage, at, Some(from), Some(to));
                }
            }
            Content::Visit => {
                let visit = message.get::<Visit>()?;
                self.ask(visit.visit, at, visit.stops.first().copied(), visit.stops.last().copied());
            }
            Content::Removal => {
                let delivered = message.get::<Removal>()?.delivered.iter();
                return Some(delivered.filter_map(|luggage| self.close(name, *luggage, DELIVERED, None)).collect());
            }
        }
        Some(Vec::new())
    }
}

const DELIVERED: &str = "delivered";

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
        assert_eq!(luggage("Environment", 1, LuggageStage::Request), []);
        assert_eq!(luggage("Robot1", 2, LuggageStage::Taken), []);
        assert_eq!(luggage("Robot2", 5, LuggageStage::Taken), []);
        let rows = luggage("Robot2", 9, LuggageStage::Delivered);
        let text = |text: &str| HistoryValue::Text(text.to_owned());
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
        assert_eq!(rows, [HistoryRow { table: 0, values: expected.to_vec() }]);
        assert_eq!(luggage("Robot2", 10, LuggageStage::Delivered), [], "it is said again");
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

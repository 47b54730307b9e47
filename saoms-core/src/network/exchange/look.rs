//! Reading cells of a state topic: which ones, and what is asked and answered of them.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::sync::Arc;

use saoms_api::host::cdr;

use super::action::{Action, Destination, Keys, News};
use super::around::ReadCells;
use super::incoming::Arrived;
use super::outgoing::{Kept, Sent, StateKey};
use super::wire::{Around, AroundState, CellName, KnownState, LARGEST_NUMBER, Look};
use super::{Exchange, MILLISECOND};
use crate::bus::Cell;

/// Time for which a cell is still read that no component wants any more: one that comes back does not begin anew.
const LINGER: u64 = 10_000 * MILLISECOND;
/// Cells of one answer, at most, and its bytes, at most, beside those of the last cell.
const MOST_CELLS: usize = 1_024;
const MOST_BYTES: usize = 256 << 10;

/// A cell that this program reads.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// The number of the first look at it.
    since: u64,
    /// When it is read no more, because no component wants it.
    until: Option<u64>,
}

/// Cells of a topic that this program reads.
pub(super) type WantedCells = BTreeMap<Cell, Wanted>;

/// How they are read of a program.
pub(super) fn read(cells: &WantedCells) -> ReadCells {
    ReadCells::new(cells.iter().map(|(cell, wanted)| (*cell, wanted.since)))
}

impl Exchange {
    /// Components of this program want the messages of these cells of a state topic alone from now on, or of all of it.
    pub fn want(&mut self, topic: &Arc<str>, cells: Option<&BTreeSet<Cell>>, now: u64) {
        self.pass(now);
        match cells {
            Some(cells) => self.want_cells(topic, cells),
            None => self.want_all(topic),
        }
    }

    fn want_all(&mut self, topic: &Arc<str>) {
        let Some(before) = self.reads.get_mut(topic).and_then(|own| own.cells.take()) else { return };
        self.actions.push(Action::Subscribe(Keys::All(Arc::clone(topic))));
        let cells = before.into_keys().map(|cell| Keys::Cell(Arc::clone(topic), cell));
        let old = cells.chain([Keys::Elsewhere(Arc::clone(topic))]);
        self.actions.extend(old.map(Action::Unsubscribe));
        let incoming = self.peers.values_mut().filter_map(|peer| peer.incoming.get_mut(topic));
        incoming.for_each(|incoming| incoming.read_all());
    }

    fn want_cells(&mut self, topic: &Arc<str>, cells: &BTreeSet<Cell>) {
        let Some(own) = self.reads.get_mut(topic).filter(|own| own.is_state) else { return };
        let is_first = own.cells.is_none();
        let wanted = own.cells.get_or_insert_default();
        if is_first {
            let both = [Keys::Around, Keys::Elsewhere].map(|keys| keys(Arc::clone(topic)));
            self.actions.extend(both.map(Action::Subscribe));
        }
        for (_, dropped) in wanted.iter_mut().filter(|(cell, _)| !cells.contains(cell)) {
            let until = *dropped.until.get_or_insert(self.now + LINGER);
            self.drop_at = self.drop_at.min(until);
        }
        let mut new = Vec::new();
        for cell in cells {
            wanted.entry(*cell).and_modify(|wanted| wanted.until = None).or_insert_with(|| {
                new.push(*cell);
                Wanted { since: self.looks + 1, until: None }
            });
        }
        let keys = |cell: &Cell| Keys::Cell(Arc::clone(topic), *cell);
        self.actions.extend(new.iter().map(keys).map(Action::Subscribe));
        for incoming in self.peers.values_mut().filter_map(|peer| peer.incoming.get_mut(topic)) {
            match &mut incoming.around {
                Some(around) => new.iter().for_each(|cell| around.add(*cell, self.looks + 1)),
                around if incoming.is_by_cells => *around = Some(read(wanted)),
                _ => {}
            }
        }
        if is_first {
            self.actions.push(Action::Unsubscribe(Keys::All(Arc::clone(topic))));
        }
    }

    /// Reads cells no more that nobody has wanted for some time.
    pub(super) fn drop_cells(&mut self, now: u64) {
        if now < self.drop_at {
            return;
        }
        self.drop_at = u64::MAX;
        for (topic, own) in &mut self.reads {
            let Some(wanted) = &mut own.cells else { continue };
            let is_over = |wanted: &Wanted| wanted.until.is_some_and(|until| until <= now);
            let over: Vec<Cell> = wanted.iter().filter(|(_, one)| is_over(one)).map(|(cell, _)| *cell).collect();
            for cell in over {
                wanted.remove(&cell);
                self.actions.push(Action::Unsubscribe(Keys::Cell(Arc::clone(topic), cell)));
                let incoming = self.peers.values_mut().filter_map(|peer| peer.incoming.get_mut(topic));
                incoming.filter_map(|incoming| incoming.around.as_mut()).for_each(|around| around.remove(cell));
            }
            self.drop_at = wanted.values().filter_map(|wanted| wanted.until).fold(self.drop_at, u64::min);
        }
    }

    /// Asks programs for the states of cells of which something is missing. Gives the time at which that is due next.
    pub(super) fn look(&mut self, now: u64) -> u64 {
        let mut next = u64::MAX;
        for (program, peer) in self.peers.iter_mut().filter(|(_, peer)| peer.is_reachable) {
            for (topic, incoming) in &mut peer.incoming {
                let Some(around) = &mut incoming.around else { continue };
                if around.look_at.is_some_and(|at| at <= now) {
                    let cells: BTreeSet<Cell> = around.look(now).into_iter().collect();
                    if !cells.is_empty() {
                        self.looks += 1;
                        let look = Look {
                            reader: self.settings.program,
                            topic: topic.to_string(),
                            number: self.looks,
                            cells: cells.iter().map(named).collect(),
                            known: incoming.known_in(&cells),
                        };
                        let (to, bytes) = (Destination::Look(*program), cdr::encode(&look).into());
                        self.actions.push(Action::Put { to, bytes });
                    }
                }
                next = next.min(incoming.around.as_ref().and_then(|around| around.look_at).unwrap_or(u64::MAX));
            }
        }
        next
    }

    /// Another program asks for the states of cells.
    pub fn show(&mut self, look: &Look) {
        let Some((topic, outgoing)) = self.outgoing.get_key_value(look.topic.as_str()) else { return };
        let Kept::States { newest, .. } = &outgoing.kept else { return };
        let known: HashMap<StateKey, u64> = look.known.iter().map(|one| (key_of(one), one.number)).collect();
        let is_new = |sent: &Sent| known.get(&sent.key()).is_none_or(|number| *number < sent.number);
        let cells: BTreeSet<Cell> = look.cells.iter().take(MOST_CELLS).map(|cell| (cell.x, cell.y)).collect();
        let mut inside: BTreeMap<Cell, Vec<&Sent>> = BTreeMap::new();
        for sent in newest.values() {
            if let Some(cell) = sent.cell().filter(|cell| cells.contains(cell)) {
                inside.entry(cell).or_default().push(sent);
            }
        }
        let left = known.keys().filter_map(|key| outgoing.newest(key));
        let mut found: Vec<&Sent> =
            left.filter(|sent| is_new(sent) && sent.cell().is_none_or(|cell| !cells.contains(&cell))).collect();
        let mut size = found.iter().map(|sent| sent.bytes.len()).sum::<usize>();
        let (mut shown, mut here) = (Vec::new(), Vec::new());
        for cell in cells {
            if size > MOST_BYTES {
                break;
            }
            let (new, known): (Vec<&Sent>, Vec<&Sent>) =
                inside.remove(&cell).unwrap_or_default().into_iter().partition(|sent| is_new(sent));
            size += new.iter().map(|sent| sent.bytes.len()).sum::<usize>();
            here.extend(known.into_iter().map(|sent| sent.number));
            found.extend(new);
            shown.push(named(&cell));
        }
        let around = Around {
            program: self.settings.program,
            topic: topic.to_string(),
            number: look.number,
            last: outgoing.last,
            cells: shown,
            schema: found.first().map_or(0, |sent| sent.schema),
            here,
            messages: found.into_iter().map(state).collect(),
        };
        let to = Destination::Around(look.reader, Arc::clone(topic));
        self.actions.push(Action::Put { to, bytes: cdr::encode(&around).into() });
    }

    /// Another program answers what this one asked of cells. True if something is missing still.
    pub fn see(&mut self, around: Around, now: u64) -> bool {
        let Around { program, topic, number: look, last, cells, schema, here, messages } = around;
        let Some((topic, own)) = self.reads.get_key_value(topic.as_str()) else { return false };
        let (topic, expected) = (Arc::clone(topic), own.schema);
        let Some(peer) = self.peers.get_mut(&program).filter(|_| last <= LARGEST_NUMBER) else { return false };
        if schema != expected
            && let Some(first) = messages.first()
            && peer.differing.insert(Arc::clone(&topic))
        {
            let (name, component) = (Arc::clone(&peer.name), first.component.as_str().into());
            self.actions.push(Action::Tell(News::Differs { program, name, component, topic: Arc::clone(&topic) }));
        }
        let Some(incoming) = peer.incoming.get_mut(&topic).filter(|incoming| incoming.around.is_some()) else {
            return false;
        };
        let here: HashSet<u64> = here.into_iter().chain(messages.iter().map(|message| message.number)).collect();
        let (mut ready, mut is_missing) = (Vec::new(), false);
        for message in messages.into_iter().filter(|message| message.number <= LARGEST_NUMBER) {
            let (number, cell) = (message.number, message.cell.map(|CellName { x, y }| (x, y)));
            ready.extend(incoming.take_newest(number, arrived(message), cell));
        }
        let cells: BTreeSet<Cell> = cells.iter().map(|cell| (cell.x, cell.y)).collect();
        let ghosts = incoming.ghosts(&cells, last, &here);
        if let Some(read) = &mut incoming.around {
            cells.iter().for_each(|cell| read.see(*cell, look, last));
            read.doubt(&ghosts, now);
            read.settle(now);
            is_missing = read.look_at.is_some();
        }
        self.has_news = true;
        self.deliver(program, &topic, ready);
        is_missing
    }
}

fn named((x, y): &Cell) -> CellName {
    CellName { x: *x, y: *y }
}

fn key_of(known: &KnownState) -> StateKey {
    (known.component.as_str().into(), known.has_key.then_some(known.key))
}

fn state(sent: &Sent) -> AroundState {
    AroundState {
        number: sent.number,
        component: sent.component.to_string(),
        to: sent.to.as_deref().unwrap_or_default().to_owned(),
        key: sent.key.unwrap_or_default(),
        has_key: sent.key.is_some(),
        sent: sent.sent,
        cause: sent.cause,
        cell: sent.cell().as_ref().map(named),
        bytes: sent.bytes.to_vec(),
    }
}

fn arrived(AroundState { number, component, to, key, has_key, sent, cause, bytes, .. }: AroundState) -> Arrived {
    let key = has_key.then_some(key);
    Arrived { component: component.into(), to, key, sent, cause, bytes, origin: 0, number }
}

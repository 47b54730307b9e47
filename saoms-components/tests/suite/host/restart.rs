//! A crash of the program, after which all components go on from what they saved, as with a state folder.

use saoms_api::Saved;
use saoms_api::host::SharedMessage;

use super::Fleet;

impl Fleet {
    /// Lets a component execute in vain: what it knew before, and what it had not read, is there again, while the
    /// components that it called know of that execution. Then all start again.
    pub(super) fn crash_in(&mut self, lost: usize) {
        let before = self.saved(lost);
        let seat = &self.seats[lost];
        let (unread, kept) = (seat.inboxes.clone(), seat.kept.clone());
        self.call(lost, |component, context| component.execute(context)).unwrap();
        let seat = &mut self.seats[lost];
        seat.outbox.clear();
        (seat.inboxes, seat.kept) = (unread, kept);
        let saved: Vec<Saved> =
            (0..self.seats.len()).map(|index| if index == lost { before.clone() } else { self.saved(index) }).collect();
        let unread: Vec<Vec<Vec<SharedMessage>>> =
            self.seats.iter_mut().map(|seat| std::mem::take(&mut seat.inboxes)).collect();
        self.topics.iter_mut().for_each(|topic| topic.readers.clear());
        for (index, saved) in saved.iter().enumerate() {
            let seat = &mut self.seats[index];
            seat.publishes.clear();
            (seat.execution, seat.vote) = (0, None);
            (seat.goes_on, seat.kept_before) = (!saved.is_nothing(), !seat.kept.is_empty());
            self.components[index] = Some((seat.make)());
            self.call(index, |component, context| component.initialize(context)).unwrap();
            self.seats[index].goes_on = false;
            if !saved.is_nothing() {
                self.components[index].as_mut().unwrap().restore(saved).unwrap();
            }
        }
        for topic in &self.topics {
            for (reader, inbox) in &topic.readers {
                self.seats[*reader].inboxes[*inbox].extend(topic.newest.values().cloned());
            }
        }
        for (seat, unread) in self.seats.iter_mut().zip(unread) {
            for (inbox, unread) in seat.inboxes.iter_mut().zip(unread) {
                let known: Vec<usize> = inbox.iter().map(SharedMessage::address).collect();
                inbox.splice(0..0, unread.into_iter().filter(|message| !known.contains(&message.address())));
            }
        }
        for index in 0..self.seats.len() {
            let outbox = std::mem::take(&mut self.seats[index].outbox);
            self.deliver(index, outbox);
        }
    }

    fn saved(&mut self, index: usize) -> Saved {
        self.components[index].as_mut().unwrap().save().unwrap()
    }
}

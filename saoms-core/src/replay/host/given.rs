//! What the host of a replay takes from a step.

use saoms_api::Departed;
use saoms_api::host::cdr;

use super::ReplayHost;
use crate::tape::{Act, ActKind, Step};

impl ReplayHost {
    /// Takes in what an act says of the world of the component.
    pub(super) fn take(&mut self, act: &Act, is_refused: bool) {
        let topic = || (act.name.clone(), act.text().into_owned());
        match act.what {
            ActKind::Class => self.sender = act.number as u32,
            ActKind::Kept => drop(self.kept.insert(act.number, act.bytes.clone())),
            ActKind::Chance => {
                if let Ok(chance) = cdr::decode(&act.bytes) {
                    self.chance = chance;
                }
            }
            ActKind::NameOf => drop(self.names.insert(act.number as u32, act.text().into_owned())),
            ActKind::KeptByOthers => self.others = cdr::decode(&act.bytes).unwrap_or_default(),
            ActKind::Publisher if !is_refused => drop(self.publishers_then.insert(act.number, topic())),
            ActKind::Subscription if !is_refused => drop(self.subscriptions_then.insert(act.number, topic())),
            ActKind::Reference if !is_refused => drop(self.references.insert(act.number as u32, topic())),
            _ => {}
        }
    }

    /// Puts the messages of a step where the component reads them today: of several subscriptions of one topic each has
    /// those of its place among them.
    pub(super) fn give(&mut self, step: &Step) {
        self.inboxes.clear();
        self.inboxes.resize_with(self.subscriptions.len(), Vec::new);
        self.departed.clear();
        self.departed.resize_with(self.subscriptions.len(), Vec::new);
        for heard in &step.heard {
            let then = u64::from(heard.subscription);
            let Some((topic, _)) = self.subscriptions_then.get(&then) else { continue };
            let before = self.subscriptions_then.range(..then).filter(|(_, (other, _))| other == topic).count();
            let mut today = self.subscriptions.iter().enumerate().filter(|(_, other)| *other == topic);
            let Some((place, _)) = today.nth(before) else { continue };
            match heard.has_left {
                true => {
                    self.departed[place].push(Departed { sender: heard.sender, key: heard.key.unwrap_or_default() });
                }
                false => self.inboxes[place].push(heard.message()),
            }
        }
    }
}

//! What state topics retain, as rows of a recording.

use std::collections::HashMap;
use std::sync::Arc;

use saoms_api::host::SharedMessage;
use saoms_core::observe::StateOfTopic;
use saoms_lang::schema::Schema;

use super::cells::{Cells, Subject};
use crate::content::content;

/// A topic with what it retained at the last sample.
#[derive(Debug, Default)]
pub(super) struct RetainedTopic {
    /// The schema of its messages as text, and as it is read.
    schema: Option<(Arc<str>, Option<Schema>)>,
    /// The fields that are recorded.
    fields: Vec<&'static str>,
    /// The messages with their rows, by their addresses, which no others have while these are kept.
    known: HashMap<usize, (SharedMessage, usize)>,
}

impl RetainedTopic {
    /// Records what the topic retains. Of most topics, most messages are those of the last sample.
    pub(super) fn record(
        &mut self,
        cells: &mut Cells,
        topic: &StateOfTopic,
        fields_of: impl FnOnce(&str) -> Vec<&'static str>,
    ) {
        if self.schema.as_ref().is_none_or(|(text, _)| *text != topic.schema) {
            self.schema = Some((Arc::clone(&topic.schema), Schema::parse(&topic.schema).ok()));
            self.fields = fields_of(&topic.message);
            self.known.clear();
        }
        let Some((_, Some(schema))) = &self.schema else { return };
        let mut before = std::mem::take(&mut self.known);
        for sent in &topic.retained {
            let address = sent.message.address();
            if let Some((message, row)) = before.remove(&address) {
                cells.keep_all(row);
                self.known.insert(address, (message, row));
                continue;
            }
            let message = content(sent, schema);
            let key = sent.message.key().map(|key| key.to_string());
            let row = cells.row(&Subject::Message {
                topic: &topic.topic,
                message: &topic.message,
                component: &sent.component,
                key: key.as_deref(),
            });
            for field in &self.fields {
                if let Some(value) = message.get(field) {
                    cells.put(row, &[field], value);
                }
            }
            self.known.insert(address, (sent.message.clone(), row));
        }
    }
}

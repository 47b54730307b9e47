use std::collections::HashMap;
use std::sync::Arc;

/// Names of components, loops and entries as numbers, from 0 in the order of their first use.
#[derive(Debug, Default)]
pub(super) struct Names {
    numbers: HashMap<Arc<str>, u32>,
}

impl Names {
    /// The number of a name; a new one gets the next.
    pub(super) fn number(&mut self, name: &str) -> u32 {
        if let Some(number) = self.numbers.get(name) {
            return *number;
        }
        let number = self.numbers.len() as u32;
        self.numbers.insert(Arc::from(name), number);
        number
    }
}

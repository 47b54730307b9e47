//! What a step gives to a component.

use std::any::Any;

use saoms_api::CallError;
use saoms_api::host::{Operation, ServiceCall};
use saoms_lang::assembly::ComponentSpec;

use super::Values;
use crate::tape::{Act, ActKind, Step, loop_of_bytes, values_of_bytes};

/// Class, values and loops of an instance.
#[derive(Clone, Debug, Default)]
pub(super) struct Setting {
    pub(super) class: String,
    pub(super) values: Values,
    /// Name, class and values of each loop.
    pub(super) loops: Vec<(String, String, Values)>,
    /// The values that the instance on the tape has.
    pub(super) recorded: Values,
}

impl Setting {
    /// That of an instance that starts in this step; a composite of today counts more.
    pub(super) fn of(step: &Step, spec: Option<&ComponentSpec>) -> Option<Setting> {
        let recorded = values_of_bytes(&step.act(ActKind::Values)?.bytes)?;
        if let Some(spec) = spec {
            let loops =
                spec.loops.iter().map(|one| (one.name.clone(), one.class.name().to_owned(), one.values.clone()));
            let (class, values) = (spec.class.name().to_owned(), spec.values.clone());
            return Some(Setting { class, values, loops: loops.collect(), recorded });
        }
        let loops = step.acts.iter().filter(|act| act.what == ActKind::Loop);
        let loops = loops.map(|act| loop_of_bytes(&act.bytes).map(|(class, values)| (act.name.clone(), class, values)));
        let class = step.act(ActKind::Class)?.name.clone();
        Some(Setting { class, values: recorded.clone(), loops: loops.collect::<Option<_>>()?, recorded })
    }

    /// The values of the instance once that on the tape takes these: what changed there changes here.
    pub(super) fn updated(&self, taken: &Values) -> Values {
        let mut values = self.values.clone();
        for (name, value) in taken {
            if !self.recorded.iter().any(|known| known == &(name.clone(), value.clone())) {
                values.retain(|(known, _)| known != name);
                values.push((name.clone(), value.clone()));
            }
        }
        for (name, _) in &self.recorded {
            if !taken.iter().any(|(other, _)| other == name) {
                values.retain(|(known, _)| known != name);
            }
        }
        values
    }
}

/// A call that a component serves, as bytes.
pub(super) struct ServedCall {
    operation: Operation,
    arguments: Vec<u8>,
    pub(super) reply: Vec<u8>,
}

impl ServedCall {
    pub(super) fn of(act: &Act) -> ServedCall {
        let operation = Operation::try_from(act.number).unwrap_or(Operation::MAX);
        ServedCall { operation, arguments: act.bytes.clone(), reply: Vec::new() }
    }
}

impl ServiceCall for ServedCall {
    fn operation(&self) -> Operation {
        self.operation
    }

    fn typed(&mut self) -> Option<(&mut dyn Any, &mut dyn Any)> {
        None
    }

    fn arguments(&mut self) -> Vec<u8> {
        self.arguments.clone()
    }

    fn reply(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        self.reply = bytes.to_vec();
        Ok(())
    }
}

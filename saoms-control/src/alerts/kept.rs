//! Acknowledgements that outlive the program: of the alerts that are not over.

use serde::{Deserialize, Serialize};

use super::list::{Acknowledgement, Alert};

/// An alert that somebody took notice of, as the next program knows it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Noted {
    component: Option<String>,
    kind: String,
    subject: String,
    acknowledged: Acknowledgement,
}

impl Noted {
    /// True if this is about the same.
    pub(super) fn is_about(&self, component: Option<&str>, kind: &str, subject: &str) -> bool {
        (self.component.as_deref(), &*self.kind, &*self.subject) == (component, kind, subject)
    }

    pub(super) fn acknowledged(self) -> Acknowledgement {
        self.acknowledged
    }
}

/// The text for the next program, with what the earlier one left that was not raised again yet.
pub(super) fn text<'a>(alerts: impl Iterator<Item = &'a Alert>, left: &[Noted]) -> String {
    let noted = |alert: &Alert| {
        let acknowledged = alert.acknowledged.clone().filter(|_| alert.over_s.is_none())?;
        let Alert { component, kind, subject, .. } = alert.clone();
        Some(Noted { component, kind, subject, acknowledged })
    };
    let all: Vec<Noted> = alerts.filter_map(noted).chain(left.iter().cloned()).collect();
    if all.is_empty() { String::new() } else { serde_json::to_string(&all).unwrap_or_default() }
}

/// What an earlier program left; nothing where that is of another form.
pub(super) fn read(text: &str) -> Vec<Noted> {
    serde_json::from_str(text).unwrap_or_default()
}

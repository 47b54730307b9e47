//! Components of a fleet.

use crate::check::unfolding::replica::Instance;
use crate::expression::has_expression;
use crate::model::{ComponentElement, Composite};

/// A component with what is found out about it.
pub(crate) struct Member<'a> {
    /// The composite that it is written in.
    pub(crate) composite: &'a Composite,
    pub(crate) unit: usize,
    pub(crate) scope: usize,
    pub(crate) component: &'a ComponentElement,
    /// True if its composite asks for autowire.
    pub(crate) autowire: bool,
    pub(crate) kind: Kind,
    /// The replica that it is.
    pub(crate) instance: Option<&'a Instance>,
    /// True if it, or a component around it, is a replica.
    pub(crate) is_copy: bool,
    /// True if a condition keeps it away: it is checked as far as it can be known, and is in no fleet.
    pub(crate) is_absent: bool,
    /// True if it stands for one that a fault keeps from being made: what is known of it is checked, and nothing is
    /// said of what others would share with it.
    pub(crate) is_partial: bool,
    /// True if it has the name of an earlier one, which is reported.
    pub(crate) is_repeated: bool,
    /// Its path, where that is more than its name.
    path: Option<String>,
}

/// The implementation of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Nothing that could run; that is reported.
    Nothing,
    /// The class of this place.
    Class(usize),
    /// The composite of this scope.
    Composite(usize),
    /// Something that is taken as given.
    Given,
}

impl<'a> Member<'a> {
    pub(crate) fn new(composite: &'a Composite, unit: usize, scope: usize, component: &'a ComponentElement) -> Self {
        Self {
            composite,
            unit,
            scope,
            component,
            autowire: false,
            kind: Kind::Nothing,
            instance: None,
            is_copy: false,
            is_absent: false,
            is_partial: false,
            is_repeated: false,
            path: None,
        }
    }

    /// The name that tells it from all others of the fleet: the names of the components around it, and its own.
    pub(crate) fn path(&self) -> &str {
        self.path.as_deref().unwrap_or(&self.component.name)
    }

    /// True if it is there in a run, rather than the composite that it is.
    pub(crate) fn runs(&self) -> bool {
        !matches!(self.kind, Kind::Composite(_))
    }

    /// True if a table that is not known may give it other values.
    pub(crate) fn lacks_table(&self) -> bool {
        self.instance.and_then(|instance| instance.partial).is_some_and(|partial| partial.has_table)
    }

    /// True if it may give other properties than those that are known: a table is not, or what one of them is called.
    pub(crate) fn may_give_others(&self) -> bool {
        let Some(partial) = self.instance.and_then(|instance| instance.partial) else { return false };
        partial.has_table || self.component.properties.iter().any(|one| has_expression(&one.name))
    }

    pub(crate) fn set_path(&mut self, path: String) {
        self.path = Some(path);
    }
}

//! Intents and policy sets.

use crate::source::Text;

/// The intents that a part requires and the policy sets attached to it; almost always neither.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Policy(Option<Box<Lists>>);

#[derive(Clone, Debug, PartialEq, Eq)]
struct Lists {
    requires: Vec<Text>,
    policy_sets: Vec<Text>,
}

impl Policy {
    /// Neither.
    pub const NONE: Self = Self(None);

    /// Each QName of `requires` and of `policySets` with its place.
    pub fn new(requires: Vec<Text>, policy_sets: Vec<Text>) -> Self {
        let none = requires.is_empty() && policy_sets.is_empty();
        Self((!none).then(|| Box::new(Lists { requires, policy_sets })))
    }

    /// The QNames of the required intents as written.
    pub fn requires(&self) -> &[Text] {
        self.0.as_ref().map_or(&[], |lists| &lists.requires)
    }

    /// The QNames of the policy sets as written.
    pub fn policy_sets(&self) -> &[Text] {
        self.0.as_ref().map_or(&[], |lists| &lists.policy_sets)
    }
}

//! What a component asks of the fleet, held to what its class and its loops declare.

use std::fmt;

use saoms_api::host::{Host, TopicDeclaration};
use saoms_api::{Failure, Level};
use saoms_lang::assembly::TaskProperties;
use saoms_lang::registry::{ClassDeclaration, ClassTopic, LoopDeclaration};

use super::host::{ComponentHost, MAX_HANDLES};
use crate::report::Sections;

impl ComponentHost<'_> {
    /// Checks that the component may use a topic now, and returns its task settings.
    pub(super) fn may_use(&self, topic: &str, use_as: TopicUse) -> Result<Option<&TaskProperties>, Failure> {
        let verb = use_as.verb();
        if self.part.publishers.len().max(self.part.subscriptions.len()) >= MAX_HANDLES {
            return Err(Failure::new(format!(
                "topic `{topic}`: a component can {verb} at most {MAX_HANDLES} times: keep what it returns"
            )));
        }
        if !self.part.initializing {
            return Err(Failure::new(format!(
                "topic `{topic}`: a component can only {verb} in `initialize`; keep what it returns"
            )));
        }
        let task = self.spec().task.as_ref();
        if task.is_some_and(|task| !task.use_jms) {
            return Err(Failure::new(format!(
                "topic `{topic}`: component `{}` has `useJMS` false and can neither publish nor subscribe: set it to true",
                self.part.name
            )));
        }
        // Only declared topics: the checker and the pictures of a fleet know no others.
        if self.declared(use_as).all(|declared| declared.name != topic) {
            let spec = self.spec();
            let attribute = use_as.attribute();
            return Err(Failure::new(format!(
                "topic `{topic}`: neither class `{}` nor a loop of component `{}` declares that it {attribute} it: write `{attribute}(...)` in its `#[class(...)]` or `#[looping(...)]`",
                spec.class.name(),
                self.part.name
            )));
        }
        Ok(task)
    }

    /// The topics that the class and the loops declare to use so.
    fn declared(&self, use_as: TopicUse) -> impl Iterator<Item = &ClassTopic> {
        let spec = self.spec();
        let of_loops = spec.loops.iter().flat_map(move |one| use_as.declared_of_loop(one.class.declaration()));
        use_as.declared(spec.class.declaration()).iter().chain(of_loops)
    }

    /// Holds a use of a topic, where this is the first one, to its declaration: later ones are held to the first.
    pub(super) fn is_as_declared(
        &self,
        topic: &TopicDeclaration<'_>,
        use_as: TopicUse,
        is_first: bool,
    ) -> Result<(), Failure> {
        if is_first && self.differs_from_declaration(topic, use_as) { Err(self.undeclared(topic)) } else { Ok(()) }
    }

    fn differs_from_declaration(&self, topic: &TopicDeclaration<'_>, use_as: TopicUse) -> bool {
        let schema: Option<serde_json::Value> = serde_json::from_str(topic.schema).ok();
        let is_it = |declared: &ClassTopic| {
            declared.name == topic.name
                && declared.kind == topic.kind
                && declared.message == topic.message
                && schema.as_ref() == Some(&*declared.schema)
        };
        !self.declared(use_as).any(is_it)
    }

    fn undeclared(&self, topic: &TopicDeclaration<'_>) -> Failure {
        Failure::new(format!(
            "topic `{}`: class `{}` or its loop declares another kind or type of messages than component `{}` uses: {} \
             messages `{}` with the schema {}",
            topic.name,
            self.spec().class.name(),
            self.part.name,
            topic.kind.name(),
            topic.message,
            topic.schema
        ))
    }

    /// Why a topic that others use cannot be used: its own declaration, if that is what it does not keep.
    pub(super) fn differs(
        &self,
        topic: &TopicDeclaration<'_>,
        use_as: TopicUse,
        mismatch: impl fmt::Display,
    ) -> Failure {
        match self.differs_from_declaration(topic, use_as) {
            true => self.undeclared(topic),
            false => Failure::new(mismatch.to_string()),
        }
    }

    /// True if the path is not one of the report's own fields, and not too deep.
    pub(super) fn may_report(&mut self, path: &str) -> bool {
        if Sections::is_too_deep(path) {
            let shown: String = path.chars().take(40).collect();
            let line = format_args!("`{shown}...` was left out of the report: it is more than 64 parts deep");
            self.log(Level::Warning, line);
            return false;
        }
        let reserved = Sections::is_reserved(path);
        if reserved {
            self.log(Level::Warning, format_args!("`{path}` of the report belongs to the program, and is not changed"));
        }
        !reserved
    }

    /// Tells, once, that the report has no room for what a component contributes.
    #[cold]
    pub(super) fn cannot_report(&mut self, path: &str) {
        if !std::mem::replace(&mut self.part.is_report_full, true) {
            let shown: String = path.chars().take(40).collect();
            let line = format_args!(
                "`{shown}` and more were left out of the report: a path has at most 1000 bytes, and a report a million \
                 paths"
            );
            self.log(Level::Warning, line);
        }
    }
}

/// Use of a topic by a component.
#[derive(Clone, Copy)]
pub(super) enum TopicUse {
    Publish,
    Subscribe,
}

impl TopicUse {
    const fn verb(self) -> &'static str {
        match self {
            TopicUse::Publish => "publish",
            TopicUse::Subscribe => "subscribe",
        }
    }

    /// The attribute that declares the use, which messages take as a verb, too.
    const fn attribute(self) -> &'static str {
        match self {
            TopicUse::Publish => "publishes",
            TopicUse::Subscribe => "subscribes",
        }
    }

    fn declared(self, class: &ClassDeclaration) -> &[ClassTopic] {
        match self {
            TopicUse::Publish => &class.publishes,
            TopicUse::Subscribe => &class.subscribes,
        }
    }

    fn declared_of_loop(self, one: &LoopDeclaration) -> &[ClassTopic] {
        match self {
            TopicUse::Publish => &one.publishes,
            TopicUse::Subscribe => &one.subscribes,
        }
    }
}

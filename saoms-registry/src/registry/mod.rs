//! The classes and the loops that composites can name.
//!
//! A [`Registry`] is a value. [`Registry::linked`] has the classes that are linked into the program, tests fill their
//! own. It is built from the text of declarations alone, so that it can know classes whose code it has not run.

mod class;
mod declaration;
mod error;
mod extend;
mod looping;
mod near;
mod read;
mod rule;
mod schemas;
mod speaker;
mod team;
#[cfg(test)]
mod tests;
mod validate;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use saoms_api::event::Events;
use saoms_api::host::{LoopRegistration, Registration};
use saoms_api::rule::{Code, FleetRule};

pub use class::{Provider, RegisteredClass};
pub use declaration::{
    Alias, ClassDeclaration, ClassKind, ClassTopic, InterfaceDeclaration, PropertyDeclaration, ReferenceDeclaration,
    ServiceDeclaration, TakenEvent,
};
pub use declaration::{inner_type, signature, type_name, type_words};
pub use error::{Holder, RegistryError};
pub use looping::{DeclaredEntry, DefaultLoops, KnowledgeDeclaration, LoopDeclaration, LoopProvider, RegisteredLoop};
pub use rule::{RegisteredRule, RuleProvider};
pub use speaker::SpeakerField;
pub use team::{Team, TeamFault};

use crate::ReservedCodes;
use near::{near, simple};
use schemas::Schemas;

/// Classes and loops by name.
///
/// ```
/// use saoms_api::host::Registration;
/// use saoms_api::{Class, Component, Failure};
/// use saoms_registry::registry::Registry;
///
/// /// Stands around.
/// #[derive(Class)]
/// #[class(name = "example.Lamp", passive)]
/// struct Lamp;
///
/// impl Component for Lamp {
///     type Properties = ();
///
///     fn new(_: ()) -> Result<Self, Failure> {
///         Ok(Lamp)
///     }
/// }
///
/// let mut registry = Registry::new();
/// registry.add(Registration::of::<Lamp>())?;
/// assert_eq!(registry.get("example.Lamp").unwrap().declaration().doc, "Stands around.");
/// assert_eq!(registry.nearest("example.Lmap"), ["example.Lamp"]);
/// assert!(registry.add(Registration::of::<Lamp>()).is_err(), "the name is taken");
/// # Ok::<(), saoms_registry::registry::RegistryError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Registry {
    classes: BTreeMap<String, Arc<RegisteredClass>>,
    loops: BTreeMap<String, Arc<RegisteredLoop>>,
    rules: Vec<RegisteredRule>,
    schemas: Schemas,
}

impl Registry {
    /// No classes.
    pub fn new() -> Self {
        Self::default()
    }

    /// The classes, loops and rules that are linked into this program.
    ///
    /// # Errors
    /// As [`Registry::add`], [`Registry::add_loop`] and [`Registry::add_rule`].
    pub fn linked() -> Result<Self, RegistryError> {
        let mut all: Vec<&Registration> = Registration::linked().collect();
        // The linker's order would decide which of two faults is reported.
        all.sort_unstable_by_key(|registration| registration.declaration());
        let mut registry = Self::new();
        let mut loops: Vec<&LoopRegistration> = LoopRegistration::linked().collect();
        loops.sort_unstable_by_key(|registration| registration.declaration());
        loops.into_iter().try_for_each(|registration| registry.add_loop(*registration))?;
        all.into_iter().try_for_each(|registration| registry.add(*registration))?;
        FleetRule::linked().try_for_each(|rule| registry.add_rule(rule))?;
        Ok(registry)
    }

    /// Adds a rule over whole fleets.
    ///
    /// # Errors
    /// Its code is that of another rule, or of the checker itself.
    pub fn add_rule(&mut self, rule: &'static FleetRule) -> Result<(), RegistryError> {
        self.add_rule_provided(&rule.code, rule.judges_parts, rule.prevents_start, Arc::new(rule))
    }

    /// Adds a rule by its code and where its own code comes from.
    ///
    /// # Errors
    /// As [`Registry::add_rule`].
    pub fn add_rule_provided(
        &mut self,
        code: &'static Code,
        judges_parts: bool,
        prevents_start: bool,
        provider: Arc<dyn RuleProvider>,
    ) -> Result<(), RegistryError> {
        let rule = RegisteredRule { code, judges_parts, prevents_start, provider };
        let taken = |known: &Code, origin| RegistryError::NameTaken {
            name: code.id.to_owned(),
            first: Holder::new("rule", known.name, origin),
            second: Holder::new("rule", code.name, rule.origin()),
        };
        if let Some(known) =
            inventory::iter::<ReservedCodes>().flat_map(|codes| codes.0).find(|known| known.id == code.id)
        {
            return Err(taken(known, None));
        }
        match self.rules.binary_search_by_key(&code.id, |known| known.code.id) {
            Ok(place) => Err(taken(self.rules[place].code, self.rules[place].origin())),
            Err(place) => {
                self.rules.insert(place, rule);
                Ok(())
            }
        }
    }

    /// The rules over whole fleets, by their codes.
    pub fn rules(&self) -> &[RegisteredRule] {
        &self.rules
    }

    /// Adds a class under all its names, and the loops that it has. After an error the registry is as it was before.
    ///
    /// # Errors
    /// The declaration is malformed or of another version of the contract, or one of its names is taken; or as
    /// [`Registry::add_loop`].
    pub fn add(&mut self, registration: Registration) -> Result<(), RegistryError> {
        let before = (!registration.loops().is_empty()).then(|| self.loops.clone());
        let loops = registration.loops().iter().try_for_each(|one| self.add_loop(*one));
        let added = loops.and_then(|()| self.add_provided(registration.declaration(), Arc::new(registration)));
        if let (Err(_), Some(before)) = (&added, before) {
            self.loops = before;
        }
        added
    }

    /// Adds a loop. One that is there already, with the very same declaration, stays as it is: classes share loops.
    ///
    /// # Errors
    /// The declaration is malformed or of another version of the contract, or its name is taken.
    pub fn add_loop(&mut self, registration: LoopRegistration) -> Result<(), RegistryError> {
        self.add_loop_provided(registration.declaration(), Arc::new(registration))
    }

    /// Adds a loop by its declaration and where its code comes from.
    ///
    /// # Errors
    /// As [`Registry::add_loop`].
    pub fn add_loop_provided(
        &mut self,
        declaration: &str,
        provider: Arc<dyn LoopProvider>,
    ) -> Result<(), RegistryError> {
        let same = |known: &&Arc<RegisteredLoop>| &*known.text == declaration;
        if self.loops.values().find(same).is_some_and(|same| same.origin() == provider.origin()) {
            return Ok(());
        }
        let added = read::looping(declaration, provider, &mut self.schemas)?;
        let name = added.name();
        if let Some(first) = self.holder(name) {
            let second = Holder::new("loop", name, added.origin());
            return Err(RegistryError::NameTaken { name: name.to_owned(), first, second });
        }
        self.loops.insert(name.to_owned(), Arc::new(added));
        Ok(())
    }

    /// Adds a class by its declaration and where its code comes from, under all its names. After an error the registry
    /// is as it was before.
    ///
    /// # Errors
    /// As [`Registry::add`].
    pub fn add_provided(&mut self, declaration: &str, provider: Arc<dyn Provider>) -> Result<(), RegistryError> {
        let classes = read::class(declaration, &provider, &mut self.schemas)?;
        for (place, class) in classes.iter().enumerate() {
            let holder = |class: &RegisteredClass| Holder::new("class", &class.declaration.name, class.origin());
            let again = classes[..place].iter().find(|other| other.name == class.name);
            if let Some(first) = self.holder(&class.name).or(again.map(holder)) {
                let (name, second) = (class.name.clone(), holder(class));
                return Err(RegistryError::NameTaken { name, first, second });
            }
        }
        for class in &classes {
            let refuse = |message| RegistryError::Malformed { class: class.name.clone(), message };
            self.check_loops(&class.declaration).map_err(refuse)?;
        }
        self.classes.extend(classes.into_iter().map(|class| (class.name.clone(), Arc::new(class))));
        Ok(())
    }

    /// The holder of a name.
    fn holder(&self, name: &str) -> Option<Holder> {
        let class = self.classes.get(name);
        let class = class.map(|class| Holder::new("class", &class.declaration.name, class.origin()));
        class.or_else(|| self.loops.get(name).map(|one| Holder::new("loop", name, one.origin())))
    }

    /// The libraries of classes, loops and rules, some of them several times.
    pub fn origins(&self) -> impl Iterator<Item = &Path> {
        let classes = self.classes.values().filter_map(|class| class.origin());
        let loops = self.loops.values().filter_map(|one| one.origin());
        classes.chain(loops).chain(self.rules.iter().filter_map(RegisteredRule::origin))
    }

    /// The names of the classes of a library.
    pub fn of(&self, library: &Path) -> impl Iterator<Item = &str> {
        self.classes.values().filter(move |class| class.origin() == Some(library)).map(|class| class.name())
    }

    /// The class of this name.
    pub fn get(&self, name: &str) -> Option<&Arc<RegisteredClass>> {
        self.classes.get(name)
    }

    /// The loop of this name.
    pub fn get_loop(&self, name: &str) -> Option<&Arc<RegisteredLoop>> {
        self.loops.get(name)
    }

    /// All loops, sorted by name.
    pub fn loops(&self) -> impl ExactSizeIterator<Item = &Arc<RegisteredLoop>> {
        self.loops.values()
    }

    /// All classes under all their names, sorted by name.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Arc<RegisteredClass>> {
        self.classes.values()
    }

    /// The events that classes take.
    pub fn events(&self) -> Events {
        let classes = self.classes.values().filter(|class| !class.is_alias());
        Events::of(classes.flat_map(|class| class.declaration.events()))
    }

    /// The number of names.
    pub fn len(&self) -> usize {
        self.classes.len()
    }

    /// True if there is no class.
    pub fn is_empty(&self) -> bool {
        self.classes.is_empty()
    }

    /// Up to three names that are like `name`, the likeliest first: those that end alike behind the last dot, or else
    /// those that are spelt alike, or else those that contain it. The name of a class comes before its aliases.
    pub fn nearest(&self, name: &str) -> Vec<&str> {
        let names = self.classes.values().map(|class| (class.name(), class.is_alias()));
        near(name, names)
    }

    /// Up to three names of loops that are like `name`; see [`Registry::nearest`].
    pub fn nearest_loops(&self, name: &str) -> Vec<&str> {
        near(name, self.loops.keys().map(|name| (name.as_str(), false)))
    }

    /// Checks that each list of loops that a class has by default can work together, as far as they are known.
    fn check_loops(&self, class: &ClassDeclaration) -> Result<(), String> {
        for (value, names) in class.loops.all() {
            let known = || names.iter().filter_map(|name| self.loops.get(name));
            if known().count() < names.len() {
                continue;
            }
            let which = value.map_or_else(String::new, |value| format!(" for `{value}`"));
            if let Some((one, property)) = known().find_map(|one| Some((one, one.required()?))) {
                return Err(format!("its loop `{}` has to be given `{property}`", one.name()));
            }
            let team = Team::of(class, known().map(|one| one.declaration()).collect());
            if let Some(fault) = team.faults().first() {
                return Err(format!("its loops{which} do not fit together: {}", fault.describe(names)));
            }
        }
        Ok(())
    }
}

//! The loops of a component, as far as they can be known.

use saoms_api::host::{PropertyValue, SmolStr};
use saoms_lang::registry::{RegisteredClass, RegisteredLoop};

use super::Scene;
use super::outline::{Component, Loop};

impl Scene {
    /// The loops that a component of a file has unless it says otherwise: their short names and their classes. Where it
    /// cannot be known which list of the class is chosen, those of all lists, each name once.
    pub(crate) fn default_loops<'s>(&'s self, (file, component): (usize, &Component)) -> Vec<(&'s str, &'s str)> {
        let Some(class) = self.class(component) else { return Vec::new() };
        let loops = &class.declaration().loops;
        let choice = self.choice(class, file, component);
        let chosen = choice.as_deref().filter(|value| loops.lists.contains_key(*value));
        let mut all: Vec<(&str, &str)> = Vec::new();
        for (value, names) in loops.all() {
            if chosen.is_some() && value != chosen {
                continue;
            }
            for name in names {
                let short = name.rsplit('.').next().unwrap_or(name);
                if all.iter().all(|(known, _)| *known != short) {
                    all.push((short, name));
                }
            }
        }
        all
    }

    /// The value of the property that chooses a list of loops: what the composite gives, what the class's name presets,
    /// or the default.
    fn choice(&self, class: &RegisteredClass, file: usize, component: &Component) -> Option<SmolStr> {
        let declaration = class.declaration();
        let property = declaration.loops.property.as_deref()?;
        if let Some(given) = component.properties.iter().find(|one| one.text == property) {
            return self.given(file, given.element).map(SmolStr::from);
        }
        match class.presets().iter().find(|(name, _)| name == property) {
            Some((_, PropertyValue::Scalar(scalar))) => Some(scalar.text()),
            _ => declaration.property(property)?.default.as_ref().map(SmolStr::from),
        }
    }

    /// The loops of a component with what it adds: their classes.
    pub(crate) fn loops(&self, of: (usize, &Component)) -> impl Iterator<Item = &RegisteredLoop> {
        let added = of.1.loops.iter().filter_map(move |one| self.class_of_loop(of, one));
        let all = self.default_loops(of).into_iter().map(|(_, class)| class.to_owned()).chain(added);
        let all: Vec<String> = all.collect();
        all.into_iter().filter_map(|name| self.registry.get_loop(&name)).map(AsRef::as_ref)
    }

    /// The class of a loop: what the element says, or what the component's class has under this name.
    pub(crate) fn class_of_loop(&self, of: (usize, &Component), one: &Loop) -> Option<String> {
        if let Some(class) = &one.class {
            return Some(class.text.clone());
        }
        let all = self.default_loops(of);
        all.iter().find(|(short, _)| *short == one.name.text).map(|(_, class)| (*class).to_owned())
    }
}

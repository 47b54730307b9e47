//! Classes that extend others: what they have from them.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::{ClassDeclaration, ClassKind, DefaultLoops};

/// The limit of a chain of classes that extend each other: a longer one is a mistake.
const LONGEST: usize = 32;

/// The declaration of a class that another one extends.
#[derive(Deserialize)]
struct Head<'a> {
    #[serde(borrow)]
    extends: Option<&'a RawValue>,
}

/// The declarations of the classes that the one with this declaration extends, as their authors' builds wrote them, the
/// nearest first.
pub(super) fn lineage(mut text: &str) -> Result<Vec<&str>, String> {
    let mut all = Vec::new();
    loop {
        let head: Head<'_> = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let Some(base) = head.extends else { return Ok(all) };
        if all.len() == LONGEST {
            return Err(format!("it extends more than {LONGEST} classes"));
        }
        text = base.get();
        all.push(text);
    }
}

/// Adds to a class what it has from the one that it extends.
pub(super) fn inherit(class: &mut ClassDeclaration, base: ClassDeclaration) -> Result<(), String> {
    let name = &base.name;
    let refuse = |what: String| Err(format!("it extends `{name}`, and {what}"));
    if class.kind == ClassKind::Passive && base.kind == ClassKind::Periodic {
        return refuse("would never be executed: what extends a periodic class is `periodic`".to_owned());
    }
    if class.knowledge.is_some() || class.loops != DefaultLoops::default() {
        return refuse("has a knowledge or loops of its own, too".to_owned());
    }
    let topics = [(&mut class.publishes, base.publishes), (&mut class.subscribes, base.subscribes)];
    for (own, inherited) in topics {
        if let Some(other) = add(own, inherited, |topic| &topic.name) {
            return refuse(format!("has another topic `{other}`"));
        }
    }
    if let Some(other) = add(&mut class.takes, base.takes, |taken| &taken.event) {
        return refuse(format!("takes another event `{other}`"));
    }
    if let Some(other) = add(&mut class.references, base.references, |reference| &reference.name) {
        return refuse(format!("has another reference `{other}`"));
    }
    // A service of its own takes the place of the one that it would have.
    let own: Vec<String> = class.services.iter().map(|service| service.name.clone()).collect();
    let inherited = base.services.into_iter().filter(|service| !own.contains(&service.name));
    class.services.splice(0..0, inherited);
    class.reacts |= base.reacts;
    class.stops |= base.stops;
    class.apart |= base.apart;
    class.alternates |= base.alternates;
    class.knowledge = base.knowledge;
    class.loops = base.loops;
    class.extends.push(base.name);
    class.extends.extend(base.extends);
    Ok(())
}

/// Puts what is inherited before what is there; the name of one that is there in another form.
fn add<T: PartialEq>(own: &mut Vec<T>, inherited: Vec<T>, name: impl Fn(&T) -> &String) -> Option<String> {
    let same = |one: &T| own.iter().find(|other| name(other) == name(one));
    if let Some(other) = inherited.iter().find(|one| same(one).is_some_and(|other| other != *one)) {
        return Some(name(other).clone());
    }
    let new: Vec<T> = inherited.into_iter().filter(|one| !own.contains(one)).collect();
    own.splice(0..0, new);
    None
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use saoms_api::Failure;
    use saoms_api::host::{DynComponent, PropertyValue};
    use serde_json::{Value, json};
    use smol_str::SmolStr;

    use crate::registry::{Provider, RegisteredClass, Registry};

    #[derive(Debug)]
    struct Nowhere;

    impl Provider for Nowhere {
        fn construct(&self, _: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
            Err("nowhere".into())
        }

        fn origin(&self) -> Option<&std::path::Path> {
            None
        }
    }

    fn topic(name: &str, message: &str) -> Value {
        json!({"topic": name, "kind": "event", "message": message, "schema": {"name": message, "fields": []}})
    }

    fn service(name: &str) -> Value {
        json!({"name": name, "interface": {"name": "a.Wheels", "operations": []}})
    }

    fn base() -> Value {
        json!({
            "contract": 1, "class": "a.Cart", "kind": "periodic", "also": [{"class": "a.Other"}],
            "properties": [{"name": "number", "type": "integer", "default": "1"}],
            "publishes": [topic("ONE", "A")], "subscribes": [topic("TWO", "B")], "services": [service("move")],
            "references": [service("gps")],
            "knowledge": {"name": "a.Cart", "entries": []}, "loops": {"default": ["a.Drive"]}
        })
    }

    fn extension() -> Value {
        json!({
            "contract": 1, "class": "b.Cart", "kind": "periodic", "extends": base(),
            "publishes": [topic("ONE", "A"), topic("THREE", "C")], "services": [service("stop")]
        })
    }

    fn read(declaration: &Value) -> Result<RegisteredClass, String> {
        let mut registry = Registry::new();
        let added = registry.add_provided(&declaration.to_string(), Arc::new(Nowhere));
        added.map_err(|error| error.to_string())?;
        let name = declaration["class"].as_str().unwrap_or_default();
        Ok(registry.get(name).map(|class| (**class).clone()).unwrap())
    }

    #[test]
    fn a_class_has_what_it_extends_and_its_own() {
        let mut third = extension();
        third["class"] = json!("c.Cart");
        third["extends"] = extension();
        third["publishes"] = json!([topic("FOUR", "D")]);
        third["services"] = json!([]);
        let class = read(&third).unwrap();
        let declaration = class.declaration();
        let topics: Vec<_> = declaration.publishes.iter().map(|topic| topic.name.as_str()).collect();
        assert_eq!(topics, ["ONE", "THREE", "FOUR"]);
        assert_eq!(declaration.subscribes.len(), 1);
        let services: Vec<_> = declaration.services.iter().map(|service| service.name.as_str()).collect();
        assert_eq!(services, ["move", "stop"]);
        assert_eq!(declaration.references[0].name, "gps");
        assert_eq!(declaration.knowledge.as_ref().unwrap().name, "a.Cart");
        assert_eq!(declaration.extends, ["b.Cart", "a.Cart"]);
        assert!(declaration.properties.is_empty() && declaration.also.is_empty(), "those are of each class");
        assert_eq!(class.extended_json().last(), Some(base().to_string().as_str()));
    }

    #[test]
    fn what_does_not_go_with_what_is_extended_is_refused() {
        let refused = |change: fn(&mut Value)| {
            let mut declaration = extension();
            change(&mut declaration);
            read(&declaration).unwrap_err()
        };
        let malformed =
            |what: &str| format!("the declaration of class `b.Cart` is malformed: it extends `a.Cart`, and {what}");
        assert_eq!(refused(|class| class["publishes"][0] = topic("ONE", "Z")), malformed("has another topic `ONE`"));
        assert_eq!(
            refused(|class| class["kind"] = json!("passive")),
            malformed("would never be executed: what extends a periodic class is `periodic`")
        );
        assert_eq!(
            refused(|class| class["loops"] = json!({"default": ["b.Drive"]})),
            malformed("has a knowledge or loops of its own, too")
        );
        assert!(refused(|class| class["extends"]["contract"] = json!(2)).contains("contract 2"));
        assert!(refused(|class| class["extends"]["kind"] = json!("often")).contains("`a.Cart` is malformed"));
    }

    #[test]
    fn no_line_of_classes_is_too_long_to_be_read() {
        let mut declaration = base();
        for _ in 0..40 {
            declaration = json!({"contract": 1, "class": "b.Cart", "kind": "periodic", "extends": declaration});
        }
        assert!(read(&declaration).unwrap_err().contains("extends more than 32 classes"));
    }
}

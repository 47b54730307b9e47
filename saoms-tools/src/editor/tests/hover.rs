use saoms_lang::diagnostic::codes;
use saoms_lang::load::vocabulary::{COMPOSITE, Kind, LOOP, SEVERITY, children, own_attributes};
use saoms_lang::registry::Registry;

use crate::editor::describe::properties;
use crate::editor::hover::hover;
use crate::editor::testing::{composite, scene};

/// The hover text at the cursor, and its range.
fn said(inside: &str) -> Option<(String, String)> {
    let (scene, at) = scene(&composite(inside), &[]);
    hover(&scene, at).map(|(text, range)| (text, scene.file().text[range].to_owned()))
}

/// Asserts that the hover text at the cursor is about `about` and holds all of these.
fn says(inside: &str, about: &str, parts: &[&str]) {
    let (text, at) = said(inside).unwrap_or_default();
    assert_eq!(at, about, "{inside}");
    for part in parts {
        assert!(text.contains(part), "{inside}: {part} is not in {text}");
    }
}

#[test]
fn everything_is_explained() {
    let robot = "<component name=\"R\"><implementation.rust class=\"saoms.Robot\"/>";
    says("<comp|onent name=\"R\"/>", "component", &["**component**", "`name`"]);
    says("<component name=\"R\"></comp|onent>", "component", &["**component**"]);
    says("<component auto|wire=\"true\"/>", "autowire", &["wired"]);
    says("<component s:co|unt=\"2\"/>", "s:count", &["replicas"]);
    says("<component name=\"R|\"/>", "R", &["without an implementation"]);
    says(
        &robot.replace("saoms.Robot", "saoms.R|obot"),
        "saoms.Robot",
        &["periodic", "`period`", "world", "COLLISIONTOPIC"],
    );
    says(
        &format!("{robot}<property name=\"peri|od\">1s</property>"),
        "period",
        &["a duration from 100us to 24h", "required"],
    );
    says(&format!("{robot}<property name=\"period\">1|s</property>"), "1s", &["a duration"]);
    says(
        &format!("{robot}<property name=\"battery\" value=\"1|0\"/>"),
        "10",
        &["from 0.0 to 100.0 [%]", "default `100.0`"],
    );
    says(
        &format!("{robot}<property name=\"topicRename\">COLL|ISIONTOPIC,x</property>"),
        "COLLISIONTOPIC",
        &["a topic of `Collision`"],
    );
    says(&format!("{robot}<reference name=\"wor|ld\"/>"), "world", &["`0..1`", "saoms.Hardware"]);
    says(&format!("{robot}</component><wire source=\"R|/world\" target=\"\"/>"), "R", &["of the class `saoms.Robot`"]);
    says(&format!("{robot}<s:loop name=\"Battery|MS\"/>"), "BatteryMS", &["(loop)", "Senses"]);
    says(
        "<property name=\"p\">100</property><component name=\"R\"><property name=\"x\" source=\"$p|\"/>",
        "p",
        &["`100`"],
    );
    says(
        "<property name=\"p\">100</property><component name=\"R\"><property name=\"x\" source=\"concat('$p', $q/a[b &lt; 1], $p|[2])\"/>",
        "p",
        &["`100`"],
    );
    says("<s:severity code=\"S40|01\"/>", "S4001", &["task-id-shared"]);
    assert_eq!(said("<!-- comp|onent -->"), None);
    // Of what is not known, what it should be.
    says(&format!("{robot}<property name=\"non|sense\"/>"), "nonsense", &["**name**", "property"]);
    says("<component name=\"R\" s:count=\"1|2\"/>", "12", &["The number of replicas"]);
    says("<wire source=\"nowhere\" replace=\"tr|ue\"/>", "true", &["replaces the targets"]);
}

/// Every element that can stand in one of a kind, with the path of elements around it.
fn walk(kind: &'static Kind, around: &[&'static str], seen: &mut Vec<*const Kind>) {
    if seen.iter().any(|known| std::ptr::eq(*known, kind)) {
        return;
    }
    seen.push(kind);
    let own = |name: &str| if name == "loop" || name == "severity" { format!("s:{name}") } else { name.to_owned() };
    let text = |last: &str| {
        let open: String = around[1..].iter().map(|name| format!("<{}>", own(name))).collect();
        let close: String = around[1..].iter().rev().map(|name| format!("</{}>", own(name))).collect();
        format!("{open}{last}{close}")
    };
    let attributes = kind.attributes.iter().map(|known| (known.name.to_owned(), known));
    let added = own_attributes(kind).map(|known| (format!("s:{}", known.name), known));
    for (name, known) in attributes.chain(added) {
        let element = own(kind.name);
        if around.is_empty() {
            continue;
        }
        says(&text(&format!("<{element} {name}|=\"\"/>")), &name, &[known.doc]);
        let value = said(&text(&format!("<{element} {name}=\"z|z\"/>")));
        assert!(value.is_some(), "the value of {name} of {element}");
    }
    let inside: Vec<&'static str> = around.iter().copied().chain([kind.name]).collect();
    for name in children(kind) {
        match kind.child(name) {
            Some(child) => walk(child, &inside, seen),
            None => {
                let open: String = inside[1..].iter().map(|name| format!("<{}>", own(name))).collect();
                let text = said(&format!("{open}<{name}|/>")).unwrap_or_default().0;
                assert!(text.len() > 10, "{name} in {}", kind.name);
            }
        }
    }
}

#[test]
fn every_element_attribute_and_value_is_explained() {
    let mut seen = Vec::new();
    walk(&COMPOSITE, &[], &mut seen);
    for kind in [&LOOP, &SEVERITY] {
        walk(kind, &["composite", "component"], &mut seen);
    }
    assert!(seen.len() > 15, "{}", seen.len());
}

#[test]
fn every_class_property_loop_and_code_is_explained() {
    let registry = Registry::linked().unwrap();
    for class in registry.iter() {
        let of = format!("<component name=\"X\"><implementation.rust class=\"{}\"/>", class.name());
        let marked = of.replace("\"/>", "|\"/>");
        says(&marked, class.name(), &[class.declaration().doc.as_str()]);
        for property in properties(class.declaration()) {
            let name = &property.name;
            let facts = [property.expected(), property.doc.clone()];
            let facts = facts.each_ref().map(String::as_str);
            assert!(!facts[1].is_empty(), "{name} of {}", class.name());
            says(&format!("{of}<property name=\"{name}|\"/>"), name, &facts);
        }
        for one in class.declaration().offers() {
            says(&format!("{of}<service name=\"{}|\"/>", one.name), &one.name, &[&one.interface.name]);
        }
        for one in &class.declaration().references {
            says(&format!("{of}<reference name=\"{}|\"/>", one.name), &one.name, &[&one.interface.name]);
        }
    }
    for one in registry.loops() {
        let of = format!("<component name=\"X\"><s:loop name=\"l\" class=\"{}|\"/>", one.name());
        says(&of, one.name(), &[&one.declaration().doc]);
    }
    for code in codes::ALL.iter().copied().chain(registry.rules().iter().map(|rule| rule.code())) {
        says(&format!("<s:severity code=\"{}|\"/>", code.id), code.id, &[code.name, code.meaning]);
    }
}

use std::sync::Arc;
use std::time::Duration;

use saoms_api::host::{PropertyValue, Registration};
use saoms_api::{Class, Component, Failure, Properties};

use super::{ChangePlan, Difference, fingerprint, members};
use saoms_lang::assembly::{Assembly, ComponentSpec, TaskProperties, Wire, WireTarget};
use saoms_lang::registry::Registry;

#[derive(Properties)]
struct Size {
    #[property(default = 1)]
    #[expect(dead_code, reason = "declared only")]
    size: u32,
}

macro_rules! class {
    ($name:ident, $($class:tt)*) => {
        #[derive(Class)]
        #[class($($class)*)]
        struct $name;

        impl Component for $name {
            type Properties = Size;

            fn new(_: Size) -> Result<Self, Failure> {
                Ok($name)
            }
        }
    };
}

class!(Box1, name = "box", passive);
class!(Bag, name = "bag", passive);
class!(Belt, name = "belt", periodic);

/// Components as text: `NAME CLASS [value of size] [>TARGET]...`, one in a line.
fn assembly(text: &str) -> Assembly {
    let mut registry = Registry::new();
    for class in [Registration::of::<Box1>(), Registration::of::<Bag>(), Registration::of::<Belt>()] {
        registry.add(class).unwrap();
    }
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
    let place = |name: &str| lines.iter().position(|words| words[0] == name);
    let components = lines.iter().map(|words| {
        let class = Arc::clone(registry.get(words[1]).unwrap());
        let mut spec = ComponentSpec {
            path: words[0].to_owned(),
            site: Default::default(),
            node: Default::default(),
            fault_node: Default::default(),
            task: class.declaration().is_periodic().then(|| {
                let values = [("ID", words[0]), ("period", "10")];
                let values = values.map(|(name, value)| (name.into(), PropertyValue::from(value)));
                TaskProperties::from_values(&values).unwrap()
            }),
            class,
            library: None,
            values: Vec::new(),
            written: Default::default(),
            references: Vec::new(),
            loops: std::sync::Arc::default(),
            web: Box::default(),
        };
        for word in &words[2..] {
            match word.strip_prefix('>') {
                None => spec.values.push(("size".into(), PropertyValue::from(*word))),
                Some(target) => spec.references.push(Wire {
                    reference: format!("r{}", spec.references.len()),
                    interface: "i".to_owned(),
                    targets: place(target)
                        .map(|component| WireTarget { component, service: "s".to_owned() })
                        .into_iter()
                        .collect(),
                    elsewhere: Box::default(),
                    web: Box::default(),
                    deadline: None,
                }),
            }
        }
        spec
    });
    Assembly { components: components.collect(), ..Assembly::default() }
}

/// A plan in words, with the names of both assemblies.
fn plan(current: &str, wanted: &str) -> String {
    let (current, wanted) = (assembly(current), assembly(wanted));
    let plan = ChangePlan::between(&members(&current), &members(&wanted));
    let old = |place: &usize| current.components[*place].path.clone();
    let new = |place: &usize| wanted.components[*place].path.clone();
    let mut words: Vec<String> = plan.remove.iter().map(|place| format!("-{}", old(place))).collect();
    words.extend(plan.replace.iter().map(|replacement| {
        assert_eq!(old(&replacement.current), new(&replacement.wanted));
        let why: Vec<String> = replacement.differences.iter().map(|difference| format!("{difference:?}")).collect();
        format!("~{}({})", new(&replacement.wanted), why.join(" "))
    }));
    words.extend(plan.add.iter().map(|place| format!("+{}", new(place))));
    words.extend(plan.keep.iter().map(|(before, after)| {
        assert_eq!(old(before), new(after));
        format!("={}", new(after))
    }));
    assert_eq!(plan.is_empty(), plan.keep.len() == words.len());
    assert_eq!(plan.is_empty(), fingerprint(&current) == fingerprint(&wanted));
    words.join(" ")
}

#[test]
fn from_nothing_all_start_providers_first() {
    assert_eq!(plan("", "A box\nB box\nC box"), "+A +B +C");
    assert_eq!(plan("", "A box >B >D\nB box >C\nC box\nD box"), "+C +B +D +A");
}

#[test]
fn to_nothing_all_end_users_first() {
    assert_eq!(plan("A box >B >D\nB box >C\nC box\nD box", ""), "-A -D -B -C");
}

#[test]
fn what_is_the_same_stays_wherever_it_stands() {
    assert_eq!(plan("A box 5\nB box >A", "B box >A\nX bag\nA box 5"), "+X =A =B");
    assert_eq!(plan("A box 5\nB box >A", "B box >A\nA box 5"), "=A =B");
}

#[test]
fn what_differs_is_replaced_and_says_why() {
    assert_eq!(plan("A box", "A bag"), "~A(Class)");
    assert_eq!(plan("A box 1", "A box 2"), "~A(Value(\"size\"))");
    assert_eq!(plan("A box 1", "A box"), "~A(Value(\"size\"))");
    assert_eq!(plan("A box", "A box 1"), "~A(Value(\"size\"))");
    assert_eq!(plan("A box >B\nB box\nC box", "A box >C\nB box\nC box"), "~A(Reference(\"r0\")) =C =B");
    assert_eq!(plan("A box >B\nB box", "A box >B"), "-B ~A(Reference(\"r0\"))");
    let (before, mut after) = (assembly("A belt"), assembly("A belt"));
    assert!(ChangePlan::between(&members(&before), &members(&after)).is_empty());
    assert_eq!(fingerprint(&before), fingerprint(&after));
    after.components[0].task.as_mut().unwrap().period = Duration::from_millis(11);
    assert_ne!(fingerprint(&before), fingerprint(&after));
    assert_eq!(ChangePlan::between(&members(&before), &members(&after)).replace[0].differences, [Difference::Task]);
}

#[test]
fn cycles_and_long_chains_of_wires_end() {
    assert_eq!(plan("", "A box >B\nB box >C\nC box >A"), "+C +B +A");
    let chain: String = (0..20_000).map(|n| format!("A{n} box >A{}\n", n + 1)).collect();
    let order = ChangePlan::between(&[], &members(&assembly_of_chain(&chain))).add;
    assert!(order.iter().rev().copied().eq(0..20_000));
}

/// As [`assembly`], for texts in which each component leads to the next: finding names takes too long there.
fn assembly_of_chain(text: &str) -> Assembly {
    let mut assembly = assembly(&text.lines().next().unwrap().replace('>', ""));
    let first = assembly.components.remove(0);
    let count = text.lines().count();
    for (place, line) in text.lines().enumerate() {
        let targets = (place + 1 < count)
            .then(|| WireTarget { component: place + 1, service: "s".to_owned() })
            .into_iter()
            .collect();
        let wire = Wire {
            reference: "next".to_owned(),
            interface: "i".to_owned(),
            targets,
            elsewhere: Box::default(),
            web: Box::default(),
            deadline: None,
        };
        let path = line.split(' ').next().unwrap().to_owned();
        assembly.components.push(ComponentSpec { path, references: vec![wire], ..first.clone() });
    }
    assembly
}

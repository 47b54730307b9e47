//! `docs/messages.md`: the topics of the classes that ship, with the fields of their messages, made from their
//! declarations. What a field means is its doc comment: schemas carry none, since both ends of a topic compare them.
//!
//! `UPDATE_EXPECT=1 cargo test --test suite messages` writes the page anew.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use expect_test::expect_file;
use saoms_components as _;
use saoms_lang::registry::{ClassTopic, Registry, inner_type};
use serde_json::Value;

use crate::support::{project, root};

const HEAD: &str = "\
# Messages

The topics of the classes that ship, under their names before any `topicRename`, and the fields of their messages. A state
topic keeps the newest message of each publisher, or of each key; an event topic loses none. A plugin in Rust has the same
messages from `saoms_components::messages`; another one declares them with these names and types. `saoms check --wiring`
shows the topics of a fleet. *Sender* is the field with the number of the component that sends the message: a message from
outside with the number of a component of the fleet is refused. A `time` is a `uint64`: nanoseconds since the start of the
run, and since 1970 between programs. This page is generated from the declarations of the classes and the docs of the
fields.
";

/// A topic, and the classes and loops at its ends.
struct Ends<'r> {
    topic: &'r ClassTopic,
    publishers: BTreeSet<&'r str>,
    readers: BTreeSet<&'r str>,
}

#[test]
fn messages_are_documented() {
    let registry = Registry::linked().unwrap();
    let mut topics: BTreeMap<&str, Ends<'_>> = BTreeMap::new();
    let mut add = |name, publishes, subscribes| {
        for (all, publishes) in [(publishes, true), (subscribes, false)] {
            let all: &[ClassTopic] = all;
            for topic in all {
                let new = || Ends { topic, publishers: BTreeSet::new(), readers: BTreeSet::new() };
                let ends = topics.entry(&topic.name).or_insert_with(new);
                if publishes {
                    ends.publishers.insert(name)
                } else {
                    ends.readers.insert(name)
                };
            }
        }
    };
    let ships = |name: &str| name.starts_with("saoms.");
    for class in registry.iter().filter(|class| !class.is_alias() && ships(class.name())) {
        let declaration = class.declaration();
        add(class.name(), &declaration.publishes, &declaration.subscribes);
    }
    for one in registry.loops().filter(|one| ships(one.name())) {
        add(one.name(), &one.declaration().publishes, &one.declaration().subscribes);
    }
    let mut meanings = Meanings::of_sources(&root().join("saoms-components/src"));
    meanings.add(&project("saoms-api/src/builtin_interfaces.rs"));
    let (mut page, mut types) = (HEAD.to_owned(), BTreeMap::new());
    for ends in topics.values() {
        page += &section(ends, &meanings, &mut types);
    }
    page += "\n## Types\n";
    // The fields of a type can be of further types.
    let mut written = BTreeSet::new();
    while let Some((name, schema)) = types.pop_first() {
        if written.insert(name.clone()) {
            let _ = write!(page, "\n### {name}\n\n{}", fields((&name, &schema), &meanings, &mut types));
        }
    }
    expect_file!["../../../docs/messages.md"].assert_eq(&page);
}

/// The docs of the fields of structs, by the names of both.
struct Meanings(BTreeMap<(String, String), String>);

impl Meanings {
    /// Reads all sources in a folder.
    fn of_sources(folder: &Path) -> Meanings {
        let mut all = Meanings(BTreeMap::new());
        let mut waiting = vec![folder.to_owned()];
        while let Some(folder) = waiting.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                match path.is_dir() {
                    true => waiting.push(path),
                    false => all.add(&fs::read_to_string(path).unwrap()),
                }
            }
        }
        all
    }

    fn add(&mut self, source: &str) {
        let (mut owner, mut docs) = (None, Vec::new());
        for line in source.lines() {
            let text = line.trim();
            if let Some(name) = line.strip_prefix("pub struct ").and_then(|rest| rest.strip_suffix(" {")) {
                owner = Some(name.to_owned());
            } else if line == "}" {
                owner = None;
            }
            if let Some(doc) = text.strip_prefix("///") {
                docs.push(doc.trim());
                continue;
            }
            let field = text.strip_prefix("pub ").and_then(|rest| rest.split_once(':')).map(|(name, _)| name);
            if let (Some(owner), Some(field)) = (&owner, field) {
                self.0.insert((owner.clone(), field.to_owned()), plain(&docs.join(" ")));
            }
            if !text.starts_with("#[") {
                docs.clear();
            }
        }
    }

    /// The meaning of a field, which each has.
    fn get(&self, owner: &str, field: &str) -> &str {
        // Types of packages of ROS 2 have their package before their name.
        let owner = owner.rsplit('/').next().unwrap_or(owner);
        let found = self.0.get(&(owner.to_owned(), field.to_owned())).filter(|meaning| !meaning.is_empty());
        found.unwrap_or_else(|| panic!("`{owner}::{field}` has no docs"))
    }
}

/// A doc without links to other items.
fn plain(doc: &str) -> String {
    let mut plain = String::new();
    let mut rest = doc;
    while let Some((before, behind)) = rest.split_once("[`") {
        let (name, behind) = behind.split_once("`]").unwrap();
        plain += &format!("{before}`{name}`");
        rest = behind.strip_prefix('(').and_then(|target| target.split_once(')')).map_or(behind, |(_, rest)| rest);
    }
    plain + rest
}

fn section(ends: &Ends<'_>, meanings: &Meanings, types: &mut BTreeMap<String, Value>) -> String {
    let Ends { topic, publishers, readers } = ends;
    let list = |names: &BTreeSet<&str>| match names.len() {
        0 => "no class that ships".to_owned(),
        _ => names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
    };
    let key = topic.schema["key"].as_str().map_or_else(String::new, |key| format!(", one for each `{key}`"));
    let place = topic.schema["place"].as_str().map_or_else(String::new, |place| {
        format!(" A subscription with a region receives the messages whose `{place}` is in it.")
    });
    let speakers: Vec<String> = topic.speakers.iter().map(ToString::to_string).collect();
    let speakers = match &speakers[..] {
        [] => String::new(),
        all => format!(" Sender: {}.", all.join("; ")),
    };
    format!(
        "\n## {}\n\n{} topic of `{}`{key}. Published by {}; read by {}.{speakers}{place}\n\n{}",
        topic.name,
        if topic.kind == saoms_api::host::TopicKind::State { "State" } else { "Event" },
        topic.message,
        list(publishers),
        list(readers),
        fields((&topic.message, &topic.schema), meanings, types)
    )
}

/// A table of the fields of a message or a type. Types of fields are noted.
fn fields((owner, schema): (&str, &Value), meanings: &Meanings, types: &mut BTreeMap<String, Value>) -> String {
    let mut table = "| field | type | meaning |\n| --- | --- | --- |\n".to_owned();
    for field in schema["fields"].as_array().unwrap() {
        let (name, of) = (field["name"].as_str().unwrap(), type_name(&field["type"], types));
        let _ = writeln!(table, "| `{name}` | {of} | {} |", meanings.get(owner, name));
    }
    for one in schema["constants"].as_array().into_iter().flatten() {
        let (name, of) = (one["name"].as_str().unwrap(), type_name(&one["type"], types));
        let _ = writeln!(table, "| constant `{name}` = `{}` | {of} |  |", one["value"]);
    }
    table
}

fn type_name(of: &Value, types: &mut BTreeMap<String, Value>) -> String {
    if let Some(name) = of.as_str() {
        return format!("`{name}`");
    }
    if let Some(values) = of["values"].as_object() {
        let mut values: Vec<(i64, &str)> =
            values.iter().map(|(name, number)| (number.as_i64().unwrap(), &**name)).collect();
        values.sort_unstable();
        let values: Vec<String> = values.iter().map(|(number, name)| format!("`{name}` {number}")).collect();
        return format!("`{}`: {}", of["enumeration"].as_str().unwrap(), values.join(", "));
    }
    if let Some(name) = of["name"].as_str() {
        types.insert(name.to_owned(), of.clone());
        return format!("[{name}](#{})", name.to_lowercase().replace('/', ""));
    }
    let inner = inner_type(of).unwrap_or_else(|| panic!("a type without a name: {of}"));
    if let (Some(most), Some(element)) = (of.get("most"), inner.get("sequence")) {
        return format!("list of at most {most} {}", type_name(element, types));
    }
    let inner = type_name(inner, types);
    match (of.get("optional"), of.get("length"), of.get("most")) {
        (Some(_), ..) => format!("optional {inner}"),
        (_, Some(length), _) => format!("array of {length} {inner}"),
        (.., Some(most)) => format!("{inner} of at most {most} bytes"),
        _ => format!("list of {inner}"),
    }
}

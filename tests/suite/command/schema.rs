//! `saoms schema` as a user meets it; `schema/` is what it writes with the classes that ship.
//!
//! `UPDATE_EXPECT=1 cargo test --test suite schema` writes the folder anew.

use std::path::Path;
use std::process::Output;
use std::{env, fs};

use roxmltree::Document;
use saoms_api::Properties;
use saoms_components as _;
use saoms_lang::assembly::TaskProperties;
use saoms_lang::registry::Registry;

use crate::support::{root, saoms};

const XSD: &str = "http://www.w3.org/2001/XMLSchema";
/// Packages of classes and loops that are linked into these tests, but not into the command.
const TESTS_ALONE: [&str; 11] =
    ["bad.", "counter.", "own.", "test.", "expand.", "hello.", "camera.", "flights.", "sprinkler.", "drive.", "saver."];
const FILES: [&str; 5] = ["sca-1.1.xsd", "sca-1.1-draft.xsd", "sca-1.0.xsd", "saoms.xsd", "catalog.xml"];

fn schema(folder: &Path, arguments: &[&str]) -> Output {
    saoms(&[&["schema", "-o", folder.to_str().unwrap()], arguments].concat())
}

fn written(arguments: &[&str]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("a/b");
    let output = schema(&inner, arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let listed = String::from_utf8(output.stdout).unwrap();
    assert_eq!(listed.lines().count(), FILES.len(), "{listed}");
    FILES.map(|file| fs::read_to_string(inner.join(file)).unwrap()).into()
}

#[test]
fn the_folder_schema_is_what_the_command_writes() {
    let folder = root().join("schema");
    for (file, text) in FILES.into_iter().zip(written(&[])) {
        let path = folder.join(file);
        if env::var_os("UPDATE_EXPECT").is_some() {
            fs::write(path, text).unwrap();
        } else {
            let is_same = fs::read_to_string(path).unwrap() == text;
            assert!(is_same, "schema/{file} is out of date: run with UPDATE_EXPECT=1");
        }
    }
}

/// The characters that can stand behind `\` in a pattern: XML Schema 1.0, part 2, F.1.1. `$` and `/` are not among
/// them, and some validators refuse a whole schema for it.
#[test]
fn patterns_have_escapes_that_xml_schema_knows() {
    const KNOWN: &str = r"nrt\|.?*+(){}-[]^sSiIcCdDwWpP";
    let (mut patterns, mut escapes) = (0, 0);
    for text in [written(&[]), written(&["--xsd", "1.1"])].iter().flatten() {
        let document = Document::parse(text).unwrap();
        for node in document.descendants().filter(|node| node.has_tag_name((XSD, "pattern"))) {
            let pattern = node.attribute("value").unwrap();
            let mut characters = pattern.chars();
            while let Some(one) = characters.next() {
                if one == '\\' {
                    let escaped = characters.next().unwrap();
                    assert!(KNOWN.contains(escaped), "`\\{escaped}` in {pattern}");
                    escapes += 1;
                }
            }
            patterns += 1;
        }
    }
    assert!(patterns > 0 && escapes > 0);
}

#[test]
fn all_that_is_registered_is_named() {
    let all = written(&[]);
    let document = Document::parse(&all[3]).unwrap();
    let names = |of: &str| -> Vec<String> {
        let mut types = document.root_element().children();
        let found = types.find(|node| node.attribute("name") == Some(of)).unwrap();
        found.descendants().filter_map(|node| node.attribute("value")).map(str::to_owned).collect()
    };
    let registry = Registry::linked().unwrap();
    let (classes, loops, properties) = (names("ClassName"), names("LoopClassName"), names("PropertyName"));
    assert!(classes.len() > 20 && loops.len() > 10);
    let is_shipped = |name: &str| !TESTS_ALONE.iter().any(|package| name.starts_with(package));
    for class in registry.iter().filter(|class| is_shipped(&class.declaration().name)) {
        assert!(classes.iter().any(|name| name == class.name()), "{}", class.name());
        for property in &class.declaration().properties {
            assert!(properties.contains(&property.name), "{} of {}", property.name, class.name());
        }
    }
    for one in registry.loops().filter(|one| is_shipped(one.name())) {
        assert!(loops.iter().any(|name| name == one.name()), "{}", one.name());
        assert!(one.declaration().properties.iter().all(|property| properties.contains(&property.name)));
    }
    assert!(
        TaskProperties::DECLARATION.contains("runOnStartup") && properties.iter().any(|name| name == "runOnStartup")
    );
}

#[test]
fn xsd_1_1_asserts_what_xsd_1_0_cannot_say() {
    let all = written(&["--xsd", "1.1"]);
    let document = Document::parse(&all[0]).unwrap();
    let tests: Vec<&str> = document.descendants().filter_map(|node| node.attribute("test")).collect();
    assert!(tests.len() > 50, "{}", tests.len());
    let battery = tests.iter().find(|test| test.contains("'battery'") && test.contains("xs:double")).unwrap();
    assert!(battery.contains("'robot.Robot010'") && battery.contains("xs:double($v) le 100.0"), "{battery}");
}

#[test]
fn repeated_components_are_refused_unless_a_condition_or_an_index_decides() {
    for arguments in [&[][..], &["--xsd", "1.1"]] {
        let all = written(arguments);
        for text in &all[..3] {
            let document = Document::parse(text).unwrap();
            let named = |name: &str| {
                let found = document.descendants().find(|node| node.attribute("name") == Some(name)).unwrap();
                let paths = found.children().filter_map(|node| node.attribute("xpath"));
                paths.collect::<Vec<_>>()
            };
            assert_eq!(named("component-of-composite"), ["sca:component", "@name", "@saoms:if", "@saoms:from"]);
            assert_eq!(named("property-of-component"), ["sca:property", "@name"]);
        }
        // Without defaults only those would be compared that have all of them.
        let own = Document::parse(&all[3]).unwrap();
        let default = |name: &str| {
            let mut attributes = own.root_element().children().filter(|node| node.has_tag_name((XSD, "attribute")));
            attributes.find(|node| node.attribute("name") == Some(name)).unwrap().attribute("default")
        };
        assert_eq!([default("if"), default("from"), default("count")], [Some("true"), Some("1"), None]);
    }
}

#[test]
fn unknown_attributes_of_saoms_are_refused() {
    let (plain, asserting) = (written(&[]), written(&["--xsd", "1.1"]));
    for (place, target) in [(0, "##targetNamespace ##local urn:saoms:1"), (2, "urn:saoms:1")] {
        let open = |text: &str, attribute: &str| -> Vec<String> {
            let document = Document::parse(text).unwrap();
            let all = document.descendants().filter(|node| node.has_tag_name((XSD, "anyAttribute")));
            let all = all.filter(|node| node.attribute("processContents") == Some("lax"));
            all.map(|node| node.attribute(attribute).unwrap().to_owned()).collect()
        };
        let known = open(&plain[place], "namespace");
        assert!(known.len() > 10 && known.iter().all(|one| !one.contains("saoms") && !one.contains("##other")));
        assert!(known.iter().all(|one| one.contains("http://www.w3.org/XML/1998/namespace")));
        assert!(open(&asserting[place], "notNamespace").iter().all(|one| one == target));
    }
    assert!(plain.iter().all(|text| !text.contains("notNamespace") && !text.contains("xs:assert")));
}

#[test]
fn a_folder_that_cannot_be_made_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let output = schema(&file.join("inner"), &[]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(
        output.status.code() == Some(1) && error.starts_with("error: the schema cannot be written to `"),
        "{error}"
    );
}

use saoms_lang::diagnostic::{Diagnostic, Edit, codes};
use saoms_lang::source::{FileId, Location, Sources, Span};
use serde_json::json;

use super::{json, sarif};

const FLEET: &str = "<composite>\n\t<component name=\"Röbot\" nmae='x'/>\n</composite>\n";

fn place(sources: &Sources, file: FileId, needle: &str) -> Location {
    let start = sources.get(file).text().find(needle).unwrap() as u32;
    Span::new(start, start + needle.len() as u32).in_file(file)
}

fn fleet() -> (Sources, Diagnostic) {
    let mut sources = Sources::new();
    let file = sources.add("fleet.composite", FLEET);
    let at = place(&sources, file, "nmae");
    let one = Diagnostic::new(&codes::XML_ATTRIBUTE, at, "no such attribute `nmae`")
        .at("not known here")
        .label(place(&sources, file, "component"), "in this component")
        .help("attributes are name and autowire")
        .rule("ASM13001")
        .suggest("replace `nmae` with `name`", at, "name");
    (sources, one)
}

#[test]
fn machines_see_the_same() {
    let (sources, one) = fleet();
    let at = |end_column: u32, column: u32, key: &str, text: &str| {
        json!({"file": "fleet.composite", "line": 2, "column": column, "end_line": 2, "end_column": end_column,
            key: text})
    };
    let mut expected = at(30, 26, "message", "no such attribute `nmae`");
    expected["severity"] = "error".into();
    expected["code"] = "S0105".into();
    expected["rule"] = "ASM13001".into();
    expected["help"] = "replace `nmae` with `name`\nattributes are name and autowire".into();
    expected["labels"] = json!([at(12, 3, "text", "in this component")]);
    expected["suggestions"] =
        json!([{"description": "replace `nmae` with `name`", "edits": [at(30, 26, "replacement", "name")]}]);
    assert_eq!(json(&[one], &sources), [expected]);
}

#[test]
fn nothing_to_say_is_null_and_empty() {
    let mut sources = Sources::new();
    let file = sources.add("none", "");
    let one = Diagnostic::new(&codes::FILE_EMPTY, Span::empty(0).in_file(file), "empty");
    let object = &json(&[one], &sources)[0];
    assert_eq!((&object["rule"], &object["help"]), (&json!(null), &json!(null)));
    assert_eq!((&object["labels"], &object["line"], &object["end_column"]), (&json!([]), &json!(1), &json!(1)));
}

#[test]
fn code_scanning_sees_the_same() {
    let (mut sources, one) = fleet();
    let file = sources.add("/tmp/two: a.composite", "{x}");
    let missing = sources.add("not:there", "");
    let braces = Diagnostic::new(&codes::UNUSED_PROPERTY, place(&sources, file, "x"), "`{x}`").suggest_edits(
        "move it",
        vec![
            Edit { location: place(&sources, file, "x"), replacement: String::new() },
            Edit { location: Span::empty(0).in_file(one.location.file), replacement: "{x}".to_owned() },
            Edit { location: Span::empty(3).in_file(file), replacement: "y".to_owned() },
        ],
    );
    let lost = Diagnostic::new(&codes::FILE_NOT_FOUND, Span::empty(0).in_file(missing), "there is no such file");
    let log = json!(sarif(&[one, braces, lost], &sources, "1.2.3", None::<()>));
    assert_eq!(log["version"], "2.1.0");
    let run = &log["runs"][0];
    assert_eq!(run["tool"]["driver"]["semanticVersion"], "1.2.3");
    let rules = run["tool"]["driver"]["rules"].as_array().unwrap();
    assert_eq!(rules.len(), codes::ALL.len());
    for result in run["results"].as_array().unwrap() {
        assert_eq!(rules[result["ruleIndex"].as_u64().unwrap() as usize]["id"], result["ruleId"]);
    }
    let region =
        |line, start, end| json!({ "startLine": line, "startColumn": start, "endLine": line, "endColumn": end });
    let fleet = json!({ "uri": "fleet.composite" });
    let two = json!({ "uri": "file:///tmp/two:%20a.composite" });
    let mut found = run["results"].clone();
    found.as_array_mut().unwrap().iter_mut().for_each(|one| _ = one.as_object_mut().unwrap().remove("ruleIndex"));
    assert_eq!(
        found,
        json!([
            {
                "ruleId": "S0105",
                "level": "error",
                "message": { "text": "no such attribute `nmae`\nreplace `nmae` with `name`\nattributes are name and autowire" },
                "locations": [{ "physicalLocation": { "artifactLocation": fleet, "region": region(2, 26, 30) } }],
                "properties": { "tags": ["ASM13001"] },
                "relatedLocations": [{
                    "physicalLocation": { "artifactLocation": fleet, "region": region(2, 3, 12) },
                    "message": { "text": "in this component" },
                }],
                "fixes": [{
                    "description": { "text": "replace `nmae` with `name`" },
                    "artifactChanges": [{
                        "artifactLocation": fleet,
                        "replacements": [{ "deletedRegion": region(2, 26, 30), "insertedContent": { "text": "name" } }],
                    }],
                }],
            },
            {
                "ruleId": "S2026",
                "level": "warning",
                "message": { "text": "`{{x}}`\nmove it" },
                "locations": [{ "physicalLocation": { "artifactLocation": two, "region": region(1, 2, 3) } }],
                "fixes": [{
                    "description": { "text": "move it" },
                    "artifactChanges": [
                        {
                            "artifactLocation": two,
                            "replacements": [
                                { "deletedRegion": region(1, 2, 3) },
                                { "deletedRegion": region(1, 4, 4), "insertedContent": { "text": "y" } },
                            ],
                        },
                        {
                            "artifactLocation": fleet,
                            "replacements": [{ "deletedRegion": region(1, 1, 1), "insertedContent": { "text": "{x}" } }],
                        },
                    ],
                }],
            },
            {
                "ruleId": "S0001",
                "level": "error",
                "message": { "text": "there is no such file" },
                "locations": [{ "physicalLocation": { "artifactLocation": { "uri": "./not:there" } } }],
            },
        ])
    );
}

use saoms_lang::diagnostic::{Diagnostic, Edit, codes};
use saoms_lang::source::{FileId, Location, Sources, Span};
use serde_json::json;

use super::{human, json, sarif};

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

#[test]
fn people_see_the_place() {
    let (sources, one) = fleet();
    let expected = "\
error[S0105, ASM13001]: no such attribute `nmae`
 --> fleet.composite:2:26
  |
2 |     <component name=\"Röbot\" nmae='x'/>
  |      ---------              ^^^^ not known here
  |      |
  |      in this component
  |
  = help: replace `nmae` with `name`
  = help: attributes are name and autowire
";
    assert_eq!(human(&[one], &sources, false), expected);
}

#[test]
fn an_empty_file_has_a_place() {
    let mut sources = Sources::new();
    let file = sources.add("none", "");
    let one = Diagnostic::new(&codes::FILE_EMPTY, Span::empty(0).in_file(file), "empty");
    assert_eq!(human(&[one], &sources, false), "error[S0005]: empty\n--> none\n");
}

#[test]
fn a_long_line_is_cut_around_the_mark_and_keeps_its_column() {
    let mut sources = Sources::new();
    let file = sources.add("t", format!("{}<bad/>{}", "x".repeat(5000), "y".repeat(5000)));
    let at = place(&sources, file, "bad");
    let shown = human(&[Diagnostic::new(&codes::XML_SYNTAX, at, "m").at("here")], &sources, false);
    assert!(shown.contains("t:1:5002") && shown.contains("<bad/>") && shown.contains("^^^ here"), "{shown}");
}

#[test]
fn people_see_one_of_many_that_are_alike() {
    let mut sources = Sources::new();
    let text: String = (1..=14).map(|number| format!("<r{number:02}/>\n")).collect();
    let file = sources.add("many.composite", text);
    let at = |number: u32| Span::new((number - 1) * 7 + 1, (number - 1) * 7 + 4).in_file(file);
    let one = |number: u32| Diagnostic::new(&codes::UNUSED_PROPERTY, at(number), format!("robot {number} is wrong"));
    let other = Diagnostic::new(&codes::UNUSED_PROPERTY, at(2), "robot 2 is right");
    let shown = |numbers: &[u32]| {
        let all: Vec<Diagnostic> = numbers.iter().map(|number| one(*number)).chain([other.clone()]).collect();
        let shown = human(&all, &sources, false);
        let told = shown.lines().filter(|line| line.contains("robot") || line.contains("more"));
        told.map(str::to_owned).collect::<Vec<_>>()
    };
    let others = "warning[S2026]: robot 2 is right".to_owned();
    assert_eq!(shown(&[3, 4, 5, 6]).len(), 5, "few are shown one by one");
    assert_eq!(
        shown(&[3, 4, 5, 6, 14]),
        ["warning[S2026]: robot 3 is wrong", "  = note: and 4 more like it, in lines 4, 5, 6 and 14", &others]
    );
    let all: Vec<u32> = (1..=14).collect();
    let lines = "  = note: and 13 more like it, in lines 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 and 3 others";
    assert_eq!(shown(&all), ["warning[S2026]: robot 1 is wrong", lines, &others]);
    assert_eq!(shown(&[2; 5])[1], "  = note: and 4 more like it, in line 2");
}

/// Everything a picture could stumble over: marks of no length, at ends, over many lines, in endless lines.
#[test]
fn pictures_of_awkward_places_stay_small() {
    let long = format!("<a>{}<b/>{}</a>", "é".repeat(100_000), "x".repeat(100_000));
    let tall = "<a>\n".repeat(5_000);
    for text in [&*long, &*tall, "a\tb", "\r\n", "é", "\u{feff}<a", "a\r"] {
        let mut sources = Sources::new();
        let file = sources.add("t", text);
        let len = text.len() as u32;
        let starts = [0, 1, len / 2, len.saturating_sub(1), len, len + 9];
        for start in starts {
            for end in [start, start + 1, len / 2 + 4, len] {
                let span = Span::new(start, end).in_file(file);
                let other = Span::new(len / 3, len / 3 + 2).in_file(file);
                let one = Diagnostic::new(&codes::XML_SYNTAX, span, "m").label(other, "label");
                let shown = human(std::slice::from_ref(&one), &sources, false);
                assert!(shown.contains(" t:") && shown.len() < 3_000, "{start}..{end}: {shown}");
            }
        }
    }
}

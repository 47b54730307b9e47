use std::collections::HashSet;

use super::*;
use crate::source::{FileId, Sources, Span};

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
fn codes_are_unique_grouped_and_documented() {
    let mut seen = HashSet::new();
    for code in codes::ALL {
        assert!(seen.insert(code.id) && seen.insert(code.name), "{} or its name is used twice", code.id);
        let digits = code.id.strip_prefix('S').unwrap_or_else(|| panic!("{} starts with S", code.id));
        assert!(digits.len() == 4 && digits.bytes().all(|byte| byte.is_ascii_digit()), "{}", code.id);
        assert!(code.name.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'-'), "{}", code.name);
        assert!(code.meaning.ends_with('.') && code.meaning.contains(' '), "{} is documented", code.id);
    }
    assert!(codes::ALL.is_sorted_by_key(|code| code.id), "the table is in order");
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

#[test]
fn a_long_line_is_cut_around_the_mark_and_keeps_its_column() {
    let mut sources = Sources::new();
    let file = sources.add("t", format!("{}<bad/>{}", "x".repeat(5000), "y".repeat(5000)));
    let at = place(&sources, file, "bad");
    let shown = human(&[Diagnostic::new(&codes::XML_SYNTAX, at, "m").at("here")], &sources, false);
    assert!(shown.contains("t:1:5002") && shown.contains("<bad/>") && shown.contains("^^^ here"), "{shown}");
}

#[test]
fn of_many_alike_the_first_thousand_are_kept_and_all_counted() {
    let mut all = Diagnostics::new();
    let file = FileId(0);
    for at in (0..1500).rev() {
        all.push(Diagnostic::new(&codes::XML_SYNTAX, Span::empty(at).in_file(file), format!("{at}")));
    }
    all.push(Diagnostic::new(&codes::XML_NAME, Span::empty(7).in_file(file), "other").severity(Severity::Warning));
    assert_eq!((all.errors(), all.warnings(), all.has_errors()), (1500, 1, true));
    let sorted = all.into_sorted();
    assert_eq!(sorted.len(), 1002);
    assert!(sorted.is_sorted_by_key(|one| one.location));
    let more: Vec<_> = sorted.iter().filter(|one| one.code == &codes::TOO_MANY).collect();
    assert_eq!(more.len(), 1);
    assert_eq!(more[0].message, "500 more of the kind S0101 (xml-syntax)");
}

#[test]
fn the_nearest_name_is_the_one_that_was_meant() {
    let names = ["period", "delay", "runOnStartup", "mayInterruptIfRunning", "useJMS", "url", "user"];
    for (typed, meant) in [
        ("peroid", Some("period")),
        ("runonstartup", Some("runOnStartup")),
        ("USEJMS", Some("useJMS")),
        ("mayInteruptIfRuning", Some("mayInterruptIfRunning")),
        ("usr", Some("user")),
        ("x", None),
        ("", None),
        ("ID", None),
        ("targetNamespace", None),
    ] {
        assert_eq!(nearest(typed, names), meant, "{typed}");
    }
    assert_eq!(nearest_few("usrl", names, 3), ["url"]);
    assert_eq!(
        nearest_few("robot.Robot01", ["robot.Robot001", "robot.Robot010", "gps"], 3),
        ["robot.Robot001", "robot.Robot010"]
    );
    assert_eq!(nearest(&"a".repeat(100_000), ["a"]), None);
    assert_eq!(nearest("é", ["è"]), None);
    assert_eq!(nearest("éa", ["èa"]), Some("èa"));
}

#[test]
fn of_many_kinds_in_one_file_each_is_told_and_all_are_counted() {
    let kinds = || codes::ALL.iter().filter(|code| code.id != codes::TOO_MANY.id).take(20);
    let mut diagnostics = Diagnostics::new();
    for at in 0..900 {
        for code in kinds() {
            diagnostics.push(Diagnostic::new(code, Span::empty(at).in_file(FileId(0)), "m"));
        }
    }
    assert_eq!(diagnostics.errors() + diagnostics.warnings(), 18_000);
    assert!((2000..2020).contains(&diagnostics.iter().count()), "{}", diagnostics.iter().count());
    let all = diagnostics.into_sorted();
    for code in kinds() {
        let kept = all.iter().filter(|one| one.code.id == code.id).count();
        let more = format!("{} more of the kind {} ({})", 900 - kept, code.id, code.name);
        assert!(kept > 0 && all.iter().any(|one| one.message == more), "{more}");
    }
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

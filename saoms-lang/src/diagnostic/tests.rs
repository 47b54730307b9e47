use std::collections::HashSet;

use super::*;
use crate::source::{FileId, Span};

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
    assert_eq!(more[0].message, "500 more of S0101 (xml-syntax), not shown");
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
        let more = format!("{} more of {} ({}), not shown", 900 - kept, code.id, code.name);
        assert!(kept > 0 && all.iter().any(|one| one.message == more), "{more}");
    }
}

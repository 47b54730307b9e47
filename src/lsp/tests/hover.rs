use crate::lsp::hover::hover;
use crate::lsp::testing::{composite, scene};

/// What is said at the cursor, and about which text.
fn said(inside: &str) -> Option<(String, String)> {
    let (scene, at) = scene(&composite(inside), &[]);
    hover(&scene, at).map(|(text, range)| (text, scene.file().text[range].to_owned()))
}

/// That what is said at the cursor is about `about` and holds all of these.
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
    says(
        &format!("{robot}</component><wire source=\"R|/world\" target=\"\"/>"),
        "R",
        &["of the class `saoms.Robot`"],
    );
    says(&format!("{robot}<s:loop name=\"Battery|MS\"/>"), "BatteryMS", &["(loop)", "Senses"]);
    says(
        "<property name=\"p\">100</property><component name=\"R\"><property name=\"x\" source=\"$p|\"/>",
        "p",
        &["`100`"],
    );
    says("<s:severity code=\"S40|01\"/>", "S4001", &["task-id-shared"]);
    assert_eq!(said("<!-- comp|onent -->"), None);
    assert_eq!(said(&format!("{robot}<property name=\"non|sense\"/>")), None);
}

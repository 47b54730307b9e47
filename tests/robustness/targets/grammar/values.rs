//! Values of attributes and of properties, most of them right.

use saoms_api::host::declaration::PropertyKind;
use saoms_lang::diagnostic::{SeverityLevel, codes};
use saoms_lang::load::vocabulary::Holds;
use saoms_lang::registry::{PropertyDeclaration, Registry};

use super::choices::Choices;
use super::component::COMPONENTS;
use super::expression;

/// Texts that are not meant anywhere, or mean something elsewhere.
const ODD: &[&str] = &[
    "", " ", "$", "${", "${index}", "$${", "/", "//", "::", ",", "-1", "1e999", "nan", "99999999999999999999", "é🤖",
    "&<>\"'", "true", "*", "(0,0)", "R1/TaskInterface/b", "t:a", "t:", ":a", "xsd:int", "\t\n", "100us", "a\u{301}",
];

/// The text of a composite's property, or of a file.
pub(super) fn text<'t>(choices: &mut Choices<'_>) -> &'t str {
    match choices.below(8) {
        0 => choices.of(ODD),
        _ => choices.of(&["1", "2", "true", "100", "north", "R1", "500ms", "safe", "3", "false"]),
    }
}

/// The table of what differs from replica to replica.
pub(super) fn table(choices: &mut Choices<'_>) -> String {
    let mut text = choices
        .of(&["index,battery", "name,ID", "index,period,scenario", "indx,a", "index", "\u{feff}index , \"chargeX\""])
        .to_owned();
    for _ in 0..choices.below(4) {
        text.push_str(choices.of(&["\n", "\r\n", "\n\n"]));
        text.push_str(choices.of(&["1", "2", "R11", "W1", "9", "\"1\"", "x"]));
        for _ in 0..choices.below(3) {
            text.push(',');
            text.push_str(choices.of(&["", "5", "\"a\"\"b\"", "\"", "${index}", "60 ", "\"x\"y"]));
        }
    }
    text
}

/// The value of an attribute.
pub(super) fn held(choices: &mut Choices<'_>, holds: Holds, registry: &Registry) -> String {
    if choices.once_in(24) {
        return choices.of(ODD).to_owned();
    }
    let end = |choices: &mut Choices<'_>| {
        let (component, _) = COMPONENTS[choices.below(COMPONENTS.len())];
        let part =
            choices.of(&["", "/TaskInterface", "/Hardware", "/world", "/s", "/r", "/Hardware/b", "*", "*/world"]);
        format!("{component}{part}")
    };
    match holds {
        Holds::Name => choices.of(&["p", "q", "s", "r", "site", "R1", "x"]).to_owned(),
        Holds::PropertyName => choices.of(&["ID", "period", "battery", "scenario", "p", "topicRename"]).to_owned(),
        Holds::ServiceName => choices.of(&["TaskInterface", "Hardware", "s"]).to_owned(),
        Holds::ReferenceName => choices.of(&["world", "r", "move"]).to_owned(),
        Holds::Class => {
            registry.iter().nth(choices.below(registry.len())).map_or_else(String::new, |class| class.name().to_owned())
        }
        Holds::Interface => choices.of(&["saoms.Hardware", "unibg.robotics.tca.TaskInterface", "a.B"]).to_owned(),
        Holds::LoopName => choices.of(&["BatteryMS", "CollisionMS", "RobotMS", "l", "BreakdownMS"]).to_owned(),
        Holds::LoopClass => registry
            .loops()
            .nth(choices.below(registry.loops().len()))
            .map_or_else(String::new, |one| one.name().to_owned()),
        Holds::Composite => choices.of(&["t:a", "t:b", "o:b", "b", "a", "t:fleet", "t:c"]).to_owned(),
        Holds::End => end(choices),
        Holds::Ends => (0..=choices.below(3)).map(|_| end(choices)).collect::<Vec<_>>().join(" "),
        Holds::Value => text(choices).to_owned(),
        Holds::Source => choices.of(&["$p", "$q", "$site", "$p/a", "$q/a/b", "p", "$none"]).to_owned(),
        Holds::Boolean => choices.of(&["true", "false", "1", "0", "yes"]).to_owned(),
        Holds::Multiplicity => choices.of(&["0..1", "1..1", "0..n", "1..n", "n..0"]).to_owned(),
        Holds::Uri => choices.of(&["W/x", "none", "urn:t", "http://a:1/b", "https://a", "http://a@b"]).to_owned(),
        Holds::File => choices.of(&["value.txt", "table.csv", "../value.txt", "none", "."]).to_owned(),
        Holds::Table => choices.of(&["table.csv", "table.csv", "value.txt", "none"]).to_owned(),
        Holds::Library => choices.of(&["none", "value.txt", "lib.so"]).to_owned(),
        Holds::Namespace => choices.of(&["urn:t", "urn:o", "urn:saoms:1"]).to_owned(),
        Holds::Type => choices.of(&["xsd:string", "xsd:int", "xsd:boolean", "t:x"]).to_owned(),
        Holds::Element => choices.of(&["t:x", "x"]).to_owned(),
        Holds::Names => choices.of(&["t:a", "t:a o:b", "a", "zz:a"]).to_owned(),
        Holds::Number => expression::number(choices, 3),
        Holds::Condition => expression::condition(choices, 3),
        Holds::Duration => choices.of(&["500ms", "100", "1s", "0", "-1s", "soon"]).to_owned(),
        Holds::Variable => choices.of(&["SAOMS_ROBUSTNESS", "HOME", "9", "A=B"]).to_owned(),
        Holds::Code => codes::ALL[choices.below(codes::ALL.len())].id.to_owned(),
        Holds::Level => SeverityLevel::ALL[choices.below(SeverityLevel::ALL.len())].name().to_owned(),
        Holds::Hangup => choices.of(&["end", "hold", "goOn", "go on"]).to_owned(),
        Holds::Text => choices.of(&["xsd:string", "xsd:int", "xsd:boolean", "because", "t:x", "W/R1"]).to_owned(),
    }
}

/// A value of a property of the component at this place.
pub(super) fn of(choices: &mut Choices<'_>, declared: &PropertyDeclaration, place: usize) -> String {
    if choices.once_in(32) {
        return choices.of(ODD).to_owned();
    }
    let bounds = || [&declared.min, &declared.max, &declared.default].into_iter().flatten().map(String::as_str);
    let bounded = |choices: &mut Choices<'_>, usual: &[&'static str]| {
        let all: Vec<&str> = usual.iter().copied().chain(bounds()).collect();
        choices.of(&all).to_owned()
    };
    match declared.kind {
        PropertyKind::Boolean => choices.of(&["true", "false", "1", "0"]).to_owned(),
        PropertyKind::Integer if declared.unique.is_some() => format!("{}", place + 1),
        PropertyKind::Integer => bounded(choices, &["1", "2", "3", "10", "+5"]),
        PropertyKind::Float => bounded(choices, &["1", "50", "0.5", "1e1"]),
        PropertyKind::Duration => bounded(choices, &["500ms", "100", "250us", "1s", "0.1s", "1h"]),
        PropertyKind::Enumeration => {
            let all: Vec<&str> = declared.allowed.iter().map(String::as_str).collect();
            if all.is_empty() { String::new() } else { choices.of(&all).to_owned() }
        }
        PropertyKind::Complex => {
            let parts = declared.properties.iter();
            parts.map(|part| format!("<{0} xmlns=\"\">{1}</{0}>", part.name, of(choices, part, place))).collect()
        }
        PropertyKind::String => worded(choices, &declared.name, place),
    }
}

/// The value of a text, as its name lets one expect.
fn worded(choices: &mut Choices<'_>, name: &str, place: usize) -> String {
    let all: &[&str] = match name {
        "scenario" => {
            return (0..choices.below(4)).map(|_| scenario_line(choices)).collect();
        }
        "topicRename" => &[
            "COLLISIONTOPIC,x",
            "ETOPIC,e::AREATOPIC,a",
            "A,b",
            "COLLISIONTOPIC,x::COLLISIONTOPIC,y",
            "ETOPIC,COLLISIONTOPIC",
        ],
        "url" => &["localhost:61616", "[::1]:1", "tcp://x:1", "127.0.0.1:0"],
        "map" => &["..\n..", "..@\n...\n", "type octile\nheight 1\nwidth 2\nmap\n..", "@", ".\n.."],
        "blocked" => &["(3,4)", "(0,0)", "3,4", "(1,1) (2,2)"],
        "path" => &["1,1", "(1.5,2)", "x"],
        "ID" => return format!("{}{place}", choices.of(&["R", "W", "ä "])),
        "IP" => &["localhost", "127.0.0.1", "::1"],
        _ => &["a", "R1", "x y", "<b>"],
    };
    choices.of(all).to_owned()
}

fn scenario_line(choices: &mut Choices<'_>) -> String {
    let time = choices.of(&[
        "at 1s", "then 500ms", "at 2s", "from 1s every 5s 3 times", "from 0ms every 2s..8s 2 times", "at 0s",
        "after 1s", "every 1s",
    ]);
    let what = choices.of(&[
        "luggage (3,1) to (3,10)",
        "luggage random to random",
        "luggage (1,0)..(10,10) to (3,1)",
        "landing 4",
        "takeoff 1",
        "breakdown R1",
        "breakdown random",
        "landing -1",
        "luggage (1,1) to (99999,0)",
        "# x",
    ]);
    let end = choices.of(&["\n", ";", "\r\n", " # y\n", ""]);
    format!("{time} {what}{end}")
}

//! The pages in `docs/` are true: their composites and scenarios have no fault of their own, their commands have the
//! options that they name, and what is printed there is printed.

use std::fs;
use std::path::PathBuf;

use saoms_components as _;
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;
use saoms_tools::diagnostics::human_of;

use crate::support::{project, root, saoms, stdout};

const NAMESPACE: &str = "http://docs.oasis-open.org/ns/opencsa/sca/200912";

/// The pages, each with its text. Those of the diagnostics and rules are made by other tests.
fn pages() -> Vec<(PathBuf, String)> {
    let all = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let all = all.filter(|path| path.extension().is_some_and(|ending| ending == "md"));
    let mut pages: Vec<PathBuf> = all.filter(|path| !path.ends_with("diagnostics.md")).collect();
    pages.push(root().join("README.md"));
    pages.sort();
    pages.into_iter().map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// The blocks of a language in a page.
fn blocks<'p>(page: &'p str, language: &str) -> Vec<&'p str> {
    let fence = format!("```{language}\n");
    page.split(&fence).skip(1).map(|rest| rest.split("```").next().unwrap()).collect()
}

/// The diagnostics of a composite as the command shows them, and their codes.
fn faults(text: &str) -> (String, Vec<&'static str>) {
    let project = Project::new().in_memory().text("page.composite", text);
    let compilation = project.compile(&Registry::linked().unwrap());
    (human_of(&compilation), compilation.reported().map(|one| one.code.id).collect())
}

/// A part of a composite as a whole one.
fn whole(part: &str) -> String {
    if part.starts_with("<composite") {
        // What a page leaves out.
        let attributes = format!("xmlns=\"{NAMESPACE}\" targetNamespace=\"urn:page\" name=\"page\"");
        let text = part.replacen("<composite ...", &format!("<composite {attributes}"), 1);
        let open = text.matches("<component").count() > text.matches("</component").count();
        let closed = if open { "</component></composite>" } else { "" };
        return without_gaps(&text) + closed;
    }
    let namespaces = format!(
        "xmlns=\"{NAMESPACE}\" xmlns:saoms=\"urn:saoms:1\" xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\" xmlns:t=\"urn:t\""
    );
    let part = part.replace(">...<", "><");
    // What stands in a component stands in one.
    let part = match part.split_once("\n...\n") {
        Some((before, behind)) => {
            let class = "<implementation.rust class=\"saoms.Robot\"/>";
            format!("{before}<component name=\"C\">{class}{behind}</component>")
        }
        None if part.starts_with("<implementation") => format!("<component name=\"C\">{part}</component>"),
        None => part,
    };
    let part = without_gaps(&part);
    format!("<composite {namespaces} targetNamespace=\"urn:page\" name=\"page\">\n{part}</composite>")
}

/// Without the lines that mark omissions of a page.
fn without_gaps(text: &str) -> String {
    text.lines().filter(|line| line.trim() != "...").map(|line| format!("{line}\n")).collect()
}

/// The missing context of parts of composites, because a page does not show all of one: files, implementations,
/// components, classes of plugins, properties.
const LACKING: [&str; 14] = [
    "S0003", "S1010", "S2011", "S2022", "S2024", "S2025", "S2026", "S2030", "S2031", "S2045", "S2049", "S3001",
    "S3006", "S3015",
];

#[test]
fn composites_have_no_fault_of_their_own() {
    let mut count = 0;
    for (path, page) in pages() {
        for block in blocks(&page, "xml") {
            if ["<contribution", "<values"].iter().any(|root| block.starts_with(root)) {
                continue;
            }
            let (shown, codes) = faults(&whole(block));
            // A block can say which it has.
            let is_lacking = |code: &&str| LACKING.contains(code) || block.contains(*code);
            assert!(codes.iter().all(is_lacking), "{}:\n{block}\n{shown}", path.display());
            count += 1;
        }
    }
    assert!(count >= 10, "there are {count} blocks");
}

#[test]
fn scenarios_are_right() {
    let (_, page) = pages().into_iter().find(|(path, _)| path.ends_with("scenarios.md")).unwrap();
    let scenarios = blocks(&page, "scenario");
    assert!(scenarios.len() >= 4);
    // Faults name components.
    let component = |name: &str, class: &str| {
        format!(
            "<component name=\"{name}\"><implementation.rust class=\"{class}\"/><property name=\"ID\">{name}</property><property name=\"period\">100</property></component>"
        )
    };
    let others = [
        ("Robot1", "saoms.Robot"),
        ("Robot2", "saoms.Robot"),
        ("Robot3", "saoms.Robot"),
        ("MasterRobot", "saoms.MasterRobot"),
    ];
    let others: String = others.iter().map(|(name, class)| component(name, class)).collect();
    for scenario in scenarios {
        let environment = format!(
            "<component name=\"E\"><implementation.rust class=\"saoms.Environment\"/><property name=\"ID\">E</property><property name=\"period\">100</property><property name=\"scenario\">{scenario}</property></component>"
        );
        let (shown, codes) = faults(&whole(&format!("{environment}{others}")));
        assert!(!codes.contains(&"S3014"), "{scenario}\n{shown}");
    }
}

#[test]
fn commands_have_the_options_that_pages_give_them() {
    let mut count = 0;
    for (path, page) in pages() {
        let blocks = ["console", "sh"].into_iter().flat_map(|language| blocks(&page, language));
        for line in blocks.flat_map(str::lines) {
            let line = line.strip_prefix("$ ").unwrap_or(line).split(" #").next().unwrap();
            let Some(arguments) = line.strip_prefix("saoms ") else { continue };
            let words: Vec<&str> = arguments.split_whitespace().collect();
            let named = if ["new", "record"].contains(&words[0]) { 2 } else { 1 };
            let help = stdout(&saoms(&[&words[..named], &["--help"]].concat()));
            for option in words.iter().filter(|word| word.starts_with("--")) {
                let option = option.split('=').next().unwrap();
                assert!(help.contains(option), "{}: `{line}` has no {option}", path.display());
            }
            count += 1;
        }
    }
    assert!(count >= 5, "there are {count} commands");
}

#[test]
fn the_diagnostic_of_many_replicas_is_real() {
    let (_, page) = pages().into_iter().find(|(path, _)| path.ends_with("fleets.md")).unwrap();
    let robots = blocks(&page, "xml")[0];
    let world = "<component name=\"World\"><implementation.rust class=\"saoms.World\"/><property name=\"ID\">World</property><property name=\"period\">500ms</property><property name=\"width\">24</property><property name=\"height\">22</property></component>";
    let fleet = whole(&format!("{world}\n{robots}"));
    assert_eq!(faults(&fleet).0, "", "the fleet of the page is right");
    let (shown, _) = faults(&fleet.replace("\"height\">22", "\"height\">11"));
    assert_eq!(shown.lines().next().unwrap(), blocks(&page, "text")[0].trim_end());
}

#[test]
fn the_wiring_report_is_real() {
    let (_, page) = pages().into_iter().find(|(path, _)| path.ends_with("wiring.md")).unwrap();
    let report = stdout(&saoms(&["check", "--wiring", "composites/hangar.composite"]));
    assert!(report.contains(blocks(&page, "text")[0]), "{report}");
}

#[test]
fn the_driver_on_the_page_about_hardware_is_the_one_under_test() {
    let page = fs::read_to_string(root().join("docs/hardware.md")).unwrap();
    let shown = blocks(&page, "rust,ignore");
    assert!(shown.len() >= 5);
    let files = ["driver.rs", "lib.rs"].map(|file| project(&format!("plugins/wheels/src/{file}")));
    for block in shown {
        assert!(files.iter().any(|file| file.contains(block.trim_end())), "in no file of `plugins/wheels`:\n{block}");
    }
}

/// A page without its blocks and pieces of code.
fn prose(page: &str) -> String {
    let outside = page.split("```").step_by(2);
    outside.flat_map(|text| text.split('`').step_by(2)).collect()
}

/// What leads to the headings of a page.
fn anchors(page: &str) -> Vec<String> {
    let headings = page.split("```").step_by(2).flat_map(str::lines).filter(|line| line.starts_with('#'));
    let anchor = |heading: &str| {
        let text = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = text.chars().filter(|sign| sign.is_alphanumeric() || matches!(sign, ' ' | '-' | '_'));
        kept.map(|sign| if sign == ' ' { '-' } else { sign }).collect()
    };
    headings.map(anchor).collect()
}

#[test]
fn links_of_pages_lead_to_files_and_headings_that_are_there() {
    let others = ["benches/README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/diagnostics.md"];
    let others = others.map(|name| (root().join(name), project(name)));
    let (mut count, mut lost) = (0, Vec::new());
    for (path, page) in pages().into_iter().chain(others) {
        let text = prose(&page);
        for link in text.split("](").skip(1).filter_map(|rest| Some(rest.split_once(')')?.0)) {
            if link.contains("://") || link.starts_with("mailto:") {
                continue;
            }
            count += 1;
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() { path.clone() } else { path.parent().unwrap().join(file) };
            let is_there = match anchor {
                "" => target.exists(),
                anchor => fs::read_to_string(&target).is_ok_and(|page| anchors(&page).iter().any(|one| one == anchor)),
            };
            if !is_there {
                lost.push(format!("{}: {link}", path.display()));
            }
        }
    }
    assert!(count >= 50, "there are {count} links");
    assert_eq!(lost, [""; 0]);
}

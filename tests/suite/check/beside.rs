//! Mistakes in what stands beside a fleet, in other files and contributions: what is told to do makes it right.

use super::hints::{assert_hint, told_of};

const HALL: &str = include_str!("../../../composites/hall.composite");
const SITE: &str = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:saoms="urn:saoms:1"
    xmlns:h="urn:hall" name="depot" targetNamespace="urn:depot">
  <component name="North" saoms:site="North"><implementation.composite name="h:hall"/></component>
</composite>
"#;

/// A description with these imports and exports.
fn description(inside: &str) -> String {
    format!("<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\">{inside}</contribution>")
}

#[test]
fn a_composite_without_a_target_namespace_is_told_to_have_it() {
    let right = " targetNamespace=\"urn:hall\"";
    for (test, wrong) in [("none", ""), ("other case", " targetnamespace=\"urn:hall\"")] {
        let hall = HALL.replace(right, wrong);
        let told = told_of(test, &[("depot.composite", SITE), ("hall.composite", &hall)], &["depot.composite"]);
        let help = "has a composite `hall` without a target namespace: write `targetNamespace=\"urn:hall\"` in its";
        assert_hint(test, &told, "S2031", help);
    }
    let told = told_of("given", &[("depot.composite", SITE), ("hall.composite", HALL)], &["depot.composite"]);
    assert_eq!(told, [""; 0]);
}

#[test]
fn a_new_name_of_a_topic_with_the_site_is_no_other_site() {
    let pair = "<property name=\"topicRename\">ETOPIC,North/ETOPIC</property>";
    let hall = HALL.replace("\"saoms.MasterEnvironment\"/>", &format!("\"saoms.MasterEnvironment\"/>{pair}"));
    let told = told_of("rename", &[("depot.composite", SITE), ("hall.composite", &hall)], &["depot.composite"]);
    let help = "its `topicRename` gives `ETOPIC` the name `North/North/ETOPIC`: remove that pair";
    assert_hint("rename", &told, "S5008", help);
}

#[test]
fn an_export_that_is_missing_or_misspelt_is_told_at_its_contribution() {
    let app = description("<import namespace=\"urn:hall\"/>");
    let told = |test, app: &str, lib: &str| {
        let files = [
            ("app/sca-contribution.xml", app),
            ("app/depot.composite", SITE),
            ("lib/sca-contribution.xml", lib),
            ("lib/hall.composite", HALL),
        ];
        told_of(test, &files, &["app"])
    };
    for (test, exported) in [("missing", ""), ("misspelt", "<export namespace=\"urn:hal\"/>")] {
        let told = told(test, &app, &description(exported));
        let help = "has it: write `<export namespace=\"urn:hall\"/>` in";
        assert!(told.iter().any(|line| line.contains(help)), "{test}: {told:#?}");
        assert!(told.iter().all(|line| !line.contains("with `urn:hal`")), "{test}: {told:#?}");
    }
    assert_eq!(told("exported", &app, &description("<export namespace=\"urn:hall\"/>")), [""; 0]);
}

#[test]
fn a_description_is_told_what_it_lacks() {
    let told =
        |test, text: &str| told_of(test, &[("app/sca-contribution.xml", text), ("app/hall.composite", HALL)], &["app"]);
    assert_hint("empty", &told("empty", " \n"), "S0005", "write at least `<contribution xmlns=\"...\"/>`");
    let one = "<deployable xmlns:h=\"urn:hall\" composite=\"h:hall\"/>";
    let list = description(&format!("<deployables>{one}</deployables>"));
    assert_hint(
        "list",
        &told("list", &list),
        "S1004",
        "remove its start tag and end tag: its content belongs in `contribution`",
    );
    assert_eq!(told("right", &description(one)), [""; 0]);
}

#[test]
fn a_file_of_a_value_by_another_name_is_read() {
    let map = |name: &str| {
        HALL.replace("\"saoms.World\"/>", &format!("\"saoms.World\"/><property name=\"map\" {name}=\"map.txt\"/>"))
    };
    let rows = "...........\n".repeat(11);
    let told =
        |test, name: &str| told_of(test, &[("hall.composite", &map(name)), ("map.txt", &rows)], &["hall.composite"]);
    assert_hint("src", &told("src", "src"), "S1007", "replace `src` with `file`");
    assert_eq!(told("file", "file"), [""; 0]);
}

#[test]
fn rows_of_blanks_at_the_ends_of_a_map_file_are_told() {
    let composite = HALL.replace("\"saoms.World\"/>", "\"saoms.World\"/><property name=\"map\" file=\"map.txt\"/>");
    let (rows, blank) = ("...........\n".repeat(11), format!("{}\n", " ".repeat(11)));
    for map in [format!("{blank}{rows}"), format!("{rows}{blank}")] {
        let told = told_of("blank rows", &[("hall.composite", &composite), ("map.txt", &map)], &["hall.composite"]);
        assert_hint("blank rows", &told, "S3014", "write `....` for four free blocks");
    }
}

#[test]
fn a_target_outside_of_the_composite_is_promoted() {
    let (others, robot) = HALL.split_once("  <component name=\"Robot7\">").unwrap();
    let (root, others) = others.split_once("name=\"hall\" targetNamespace=\"urn:hall\">").unwrap();
    let hall = format!("{root} name=\"hall\" targetNamespace=\"urn:hall\"><component name=\"Robot7\">{robot}");
    let depot = format!(
        "{root} xmlns:h=\"urn:hall\" name=\"depot\" targetNamespace=\"urn:depot\">{others}\
         <component name=\"A\"><implementation.composite name=\"h:hall\"/></component></composite>\n"
    );
    let told = told_of("outside", &[("depot.composite", &depot), ("hall.composite", &hall)], &["depot.composite"]);
    assert_hint("outside", &told, "S2011", "`World` is outside of this composite, beside `A`: promote the reference");
    assert_eq!(told.len(), 2, "{told:#?}");
}

#[test]
fn uses_with_one_world_are_not_told_to_be_sites() {
    let (others, robot) = HALL.split_once("  <component name=\"Robot7\">").unwrap();
    let (root, others) = others.split_once("name=\"hall\" targetNamespace=\"urn:hall\">").unwrap();
    let robot = robot.replace("    <reference name=\"world\" target=\"World\"/>\n", "");
    let hall = format!(
        "{root} name=\"hall\" targetNamespace=\"urn:hall\"><reference name=\"world\" promote=\"Robot7/world\"/>\n\
         <component name=\"Robot7\">{robot}"
    );
    let uses = ["A", "B"].map(|name| {
        format!(
            "<component name=\"{name}\"><implementation.composite name=\"h:hall\"/>\
             <reference name=\"world\" target=\"World\"/></component>"
        )
    });
    let depot = format!(
        "{root} xmlns:h=\"urn:hall\" name=\"depot\" targetNamespace=\"urn:depot\">{others}{}</composite>\n",
        uses.concat()
    );
    let told = told_of("one world", &[("depot.composite", &depot), ("hall.composite", &hall)], &["depot.composite"]);
    assert_hint("one world", &told, "S3013", "so they work together: give their components IDs of their own");
    assert!(told.iter().all(|line| !line.contains("saoms:site")), "{told:#?}");
    // Those that are sites already are not told to become some.
    let sites = ["A", "B"].iter().fold(
        depot.replacen(root, &format!("{root} xmlns:saoms=\"urn:saoms:1\""), 1),
        |text, name| {
            let start = format!("<component name=\"{name}\"");
            text.replace(&start, &format!("{start} saoms:site=\"{name}\""))
        },
    );
    let told = told_of("two sites", &[("depot.composite", &sites), ("hall.composite", &hall)], &["depot.composite"]);
    for code in ["S5012", "S5004"] {
        assert!(told.iter().any(|line| line.contains(code)), "{told:#?}");
    }
    assert!(told.iter().all(|line| !line.contains("both take this value from here")), "{told:#?}");
}

//! `saoms graph` as a user meets it.

use std::fs;
use std::path::Path;

use tempfile::tempdir;

use crate::support::{answer, saoms};

/// Runs `saoms graph` in the folder of the repository.
fn graph(arguments: &[&str]) -> (i32, String, String) {
    answer(&saoms(&[&["graph"], arguments].concat()))
}

fn written(folder: &Path, name: &str, arguments: &[&str]) -> String {
    let path = folder.join(name);
    let all = [arguments, &["-o", path.to_str().unwrap()]].concat();
    assert_eq!(graph(&all), (0, String::new(), String::new()), "{name}");
    fs::read_to_string(path).unwrap()
}

#[test]
fn the_ending_says_the_format_and_the_airport_is_in_the_picture() {
    let folder = tempdir().unwrap();
    let airport = &["composites/airport.composite"][..];
    let svg = written(folder.path(), "a.svg", airport);
    for part in [">airport<", ">Robot002<", ">MasterRobot<", ">hardware<", ">ELMSTOPIC<", "period = 100<"] {
        assert!(svg.contains(part), "{part}");
    }
    let mermaid = written(folder.path(), "a.mmd", airport);
    assert!(mermaid.starts_with("flowchart LR\n") && mermaid.contains("\"world → hardware\""));
    assert!(written(folder.path(), "a.DOT", airport).starts_with("digraph \"airport\" {\n"));
    assert_eq!(written(folder.path(), "a.txt", &[airport, &["--format", "mermaid"]].concat()), mermaid);
    assert_eq!(graph(airport), (0, svg, String::new()));
}

#[test]
fn several_files_are_one_fleet() {
    let folder = tempdir().unwrap();
    let head = "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' targetNamespace='urn:c'";
    let file = |name: &str, inside: &str| {
        let path = folder.path().join(name);
        fs::write(&path, format!("{head} name='{name}'>{inside}</composite>")).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let robot = "<component name='R'><implementation.java class='saoms.Robot'/><property name='ID'>R1</property><property name='period'>9</property>";
    let robots = file("robots", &format!("{robot}<reference name='world' target='W'/></component>"));
    let world = "<component name='W'><implementation.java class='saoms.World'/><property name='ID'>W</property><property name='period'>9</property></component>";
    let (code, picture, error) = graph(&[&robots, &file("world", world), "--format", "mermaid"]);
    assert_eq!((code, error.as_str()), (0, ""));
    assert!(picture.contains("robots, world") && picture.contains("\"world → hardware\""), "{picture}");
}

#[test]
fn mistakes_are_drawn_and_what_is_no_composite_is_told() {
    let folder = tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let head = "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' name='c' targetNamespace='urn:c'>";
    let wrong =
        format!("{head}<component name='A'><implementation.java class='no.Such'/><oops/></component></composite>");
    let (code, picture, error) = graph(&[&file("wrong.composite", &wrong)]);
    assert!(code == 0 && picture.contains("no such class is registered"), "{picture}");
    assert!(
        error.starts_with("warning: the picture is incomplete, since the composite has errors; `saoms check "),
        "{error}"
    );
    let (code, picture, error) = graph(&[&file("half-typed.composite", &wrong[..wrong.len() - 30])]);
    assert!(code == 0 && picture.contains("no such class is registered"), "{picture}");
    assert!(
        error.starts_with("warning: the picture is incomplete, since the composite has errors; `saoms check "),
        "{error}"
    );
    let (code, picture, error) = graph(&[&file("page.composite", "<html><body/></html>")]);
    assert!((code, picture.as_str()) == (2, "") && error.contains("error[S1001]"), "{error}");
    let (code, picture, error) = graph(&["composites/hall.composite", "no-such.png"]);
    assert!((code, picture.as_str()) == (2, "") && error.starts_with("error[S0001]"), "{error}");
    let (code, _, error) = graph(&["composites/hall.composite", "-o", "hall.jpeg"]);
    assert!(code == 2 && error.contains("`hall.jpeg` is not that of a format"), "{error}");
    let (code, _, error) = graph(&["composites/hall.composite", "-o", "no/such/folder/hall.svg"]);
    assert!(code == 1 && error.contains("cannot be written to `no/such/folder/hall.svg`"), "{error}");
    // What is written while it is made can fail in its middle.
    let (code, _, error) = graph(&["composites/hall.composite", "--format", "svg", "-o", "/dev/full"]);
    assert!(cfg!(not(target_os = "linux")) || code == 1 && error.contains("No space left"), "{error}");
}

#[test]
fn replicas_are_one_box_with_their_number_and_what_is_not_there_is_left_out() {
    let hangar = "composites/hangar.composite";
    let (code, shown, errors) = graph(&[hangar, "--format", "mermaid"]);
    assert_eq!((code, errors.as_str()), (0, ""));
    assert!(shown.contains("Robot* \u{d7} 40") && shown.contains("MasterRobot"), "{shown}");
    assert!(shown.contains("\"world \u{2192} hardware\""), "{shown}");
    let (_, shown, _) = graph(&[hangar, "--format", "mermaid", "--set", "robots=14", "--set", "landings=false"]);
    assert!(shown.contains("Robot* \u{d7} 14") && !shown.contains("MasterRobot"), "{shown}");
    let (code, _, errors) = graph(&[hangar, "--set", "robot=14"]);
    assert!(code == 2 && errors.contains("replace `robot` with `robots`"), "{errors}");
}

/// Robots talk by their loops: the picture and the report of the wiring are to show the same topics with the same ends.
#[test]
fn topics_of_loops_are_drawn_as_the_wiring_report_has_them() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("halls.composite");
    let text = "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' xmlns:s='urn:saoms:1' name='h' targetNamespace='urn:h'>
      <property name='own'>POSTOPIC,MINE</property>
      <component name='W'><implementation.java class='saoms.World'/><property name='ID'>W</property><property name='period'>9</property></component>
      <component name='R${index}' s:count='2'><implementation.java class='saoms.Robot'/><property name='ID'>R${index}</property><property name='period'>9</property>
        <property name='topicRename' source='$own'/><reference name='world' target='W'/></component>
    </composite>";
    fs::write(&path, text).unwrap();
    let path = path.to_str().unwrap();
    let (code, picture, error) = graph(&[path, "--format", "dot", "--set", "own=POSTOPIC,OTHER"]);
    assert_eq!((code, error.as_str()), (0, ""));
    let mut drawn: Vec<&str> = picture
        .lines()
        .filter(|line| line.contains("shape=ellipse"))
        .map(|line| line.split("label=\"").nth(1).unwrap().split('"').next().unwrap())
        .collect();
    drawn.sort_unstable();
    let report = saoms(&["check", "--wiring", "--format", "json", "--set", "own=POSTOPIC,OTHER", path]);
    let report: serde_json::Value = serde_json::from_slice(&report.stdout).unwrap();
    let topics = report["wiring"]["topics"].as_array().unwrap();
    let reported: Vec<&str> = topics.iter().map(|topic| topic["name"].as_str().unwrap()).collect();
    assert_eq!(drawn, reported);
    assert!(drawn.contains(&"OTHER") && drawn.contains(&"CSMSTOPIC"), "{drawn:?}");
}

/// An inner composite is drawn as often as it occurs in one of the composites around it, and its promotions are joined
/// to its component.
#[test]
fn what_is_in_replicas_is_counted_in_each_of_them() {
    let folder = tempdir().unwrap();
    let composite = |file: &str, inside: &str| {
        let head = "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' xmlns:s='urn:saoms:1' xmlns:h='urn:h' targetNamespace='urn:h'";
        fs::write(
            folder.path().join(format!("{file}.composite")),
            format!("{head} name='{file}'>{inside}</composite>"),
        )
        .unwrap();
    };
    let hall = |name: &str, count: &str, hall: &str| {
        format!(
            "<component name='{name}' {count}><implementation.composite name='h:hall'/><property name='hall'>{hall}</property><property name='bots'>{}</property><reference name='world' target='W'/></component>",
            if hall == "9" { 5 } else { 2 }
        )
    };
    let world = "<component name='W'><implementation.rust class='saoms.World'/><property name='ID'>W</property><property name='period'>9</property></component>";
    let halls = hall("Hall${index}", "s:count='3'", "${index}");
    composite(
        "site",
        &format!(
            "{world}{halls}{}<component name='Lost'><implementation.composite name='h:no'/></component>",
            hall("North", "", "9")
        ),
    );
    composite(
        "hall",
        "<property name='hall'>1</property><property name='bots'>2</property><reference name='world' promote='Bot*/world'/>
         <component name='Bot${index}' s:count='bots'><implementation.rust class='saoms.Robot'/><property name='ID'>R${hall}${index}</property>
         <property name='period'>9</property><property name='chargeX'>1</property><property name='chargeY'>${index}</property><property name='topicRename'>POSTOPIC,pos${hall}</property></component>",
    );
    let path = folder.path().join("site.composite").display().to_string();
    let (code, shown, _) = graph(&[&path]);
    assert_eq!(code, 0);
    for part in [
        ">Hall* \u{d7} 3<", ">Bot* \u{d7} 2<", ">Bot* \u{d7} 5<", ">pos*<", "pos1, pos2, pos3\n", ">pos9<",
        "no such composite is found", ">reads a topic<",
    ] {
        assert!(shown.contains(part), "{part} in {shown}");
    }
    let (_, shown, _) = graph(&[&path, "--format", "mermaid"]);
    assert!(shown.contains("c1_r0 -->|\"world \u{2192} hardware\"| c0"), "{shown}");
    let (_, shown, _) = graph(&[&path, "--format", "dot"]);
    assert!(shown.contains("c1_r0 -> c0:s0:w;"), "{shown}");
    // The legend has what the picture has.
    let lone = folder.path().join("lone.composite");
    composite("lone", world);
    let (_, shown, _) = graph(&[lone.to_str().unwrap()]);
    assert!(shown.contains(">property<") && !shown.contains(">promotion<") && !shown.contains(">wire<"), "{shown}");
}

#[test]
fn long_names_keep_their_ends() {
    let folder = tempdir().unwrap();
    let long = "TheVeryLongNameOfAComponentThatSomebodyWrites";
    let of = |number: u32| {
        format!("<component name='{long}{number}'><implementation.rust class='saoms.World'/></component>")
    };
    let head = "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' name='c' targetNamespace='urn:c'>";
    let path = folder.path().join("c.composite");
    fs::write(&path, format!("{head}{}{}</composite>", of(1), of(2))).unwrap();
    let (_, shown, _) = graph(&[path.to_str().unwrap()]);
    for number in [1, 2] {
        assert!(shown.contains(&format!("<title>{long}{number}")), "{shown}");
        assert!(shown.contains(&format!("TheVeryLongNameO\u{2026}SomebodyWrites{number}<")), "{shown}");
    }
}

#[test]
fn severities_count_as_for_the_check_that_it_points_to() {
    let folder = tempfile::tempdir().unwrap();
    let composite = |file: &str, name: &str, inside: &str| {
        let text = format!(
            "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' targetNamespace='urn:h' name='{name}'>{inside}</composite>"
        );
        fs::write(folder.path().join(file), text).unwrap();
    };
    composite("fleet.composite", "fleet", "<include name='hall'/>");
    composite("hall.composite", "hall", "");
    composite("other.composite", "hall", "");
    let path = folder.path().join("fleet.composite").display().to_string();
    let of = |severity: &str| graph(&[&path, "--format", "dot", "--severity", severity]);
    let (code, _, told) = of("S2001=note");
    assert_eq!((code, told.as_str()), (0, ""));
    let (code, _, told) = of("S2001=error");
    assert!(code == 0 && told.contains("shows them"), "{told}");
    let (code, _, told) = of("S2001=eror");
    assert!(code == 2 && told.contains("replace it with `error`"), "{told}");
}

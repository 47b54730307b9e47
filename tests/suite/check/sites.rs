//! The rules over fleets in several sites: who hears whom follows the names that topics have on the bus.

use std::fmt::Write;

use saoms_testkit::Fleet;

/// Events outside of all sites.
const SHARED: &str = "topicRename=ETOPIC,/ETOPIC";

/// A component as `Name:Class:Site@target properties`. Properties have
/// `|` between them. The ID is the name without the letter of its site.
fn component(line: &str) -> String {
    let (head, properties) = line.split_once(' ').unwrap_or((line, ""));
    let (head, wire) = head.split_once('@').unwrap_or((head, ""));
    let &[name, class, site] = &head.split(':').collect::<Vec<_>>()[..] else { panic!("{line}") };
    let site = if site.is_empty() { String::new() } else { format!(" saoms:site=\"{site}\"") };
    let mut text = format!("<component name=\"{name}\"{site}><implementation.rust class=\"saoms.{class}\"/>");
    let given = properties.split('|').filter_map(|one| one.split_once('='));
    let id = ("ID", name.trim_start_matches(['N', 'S']));
    for (property, value) in [id, ("period", "100ms")].into_iter().chain(given) {
        let _ = write!(text, "<property name=\"{property}\">{value}</property>");
    }
    let reference = if class == "Shift" { "tasks" } else { "world" };
    if !wire.is_empty() {
        let _ = write!(text, "<reference name=\"{reference}\" target=\"{wire}\"/>");
    }
    text + "</component>\n"
}

/// The codes and messages of what is found in a fleet of these components, one a line.
pub(super) fn found(lines: &str) -> Vec<String> {
    let components: String = lines.lines().map(str::trim).filter(|line| !line.is_empty()).map(component).collect();
    let text = format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:saoms=\"urn:saoms:1\" name=\"t\" \
         targetNamespace=\"urn:t\">\n{components}</composite>"
    );
    let found = Fleet::of_text(text).diagnostics();
    let plain = |line: &str| {
        let words: Vec<&str> = line.splitn(4, ' ').collect();
        format!("{} {}", words[1], words[3])
    };
    found.lines().filter(|line| line.starts_with(char::is_alphabetic)).map(plain).collect()
}

#[test]
fn rules_follow_the_names_that_topics_have_on_the_bus() {
    // What the case is about, the components, and how the messages begin.
    let cases: &[(&str, &str, &[&str])] = &[
        (
            "S5001: luggage is in the world that hears of it, not in that of the other site",
            "NWorld:World:North width=3|height=3
             NEnvironment:Environment:North scenario=at 1s luggage (1,1) to (5,5)|topicRename=ETOPIC,/events::ELMSTOPIC,/South/ELMSTOPIC
             World:World:South topicRename=ETOPIC,/events
             SMaster:MasterEnvironment:South topicRename=ETOPIC,/events
             SRobot1:Robot:South@World",
            &[],
        ),
        (
            "S5001: luggage outside the one world that hears of it, of two that are connected",
            "NWorld:World:North width=3|height=3
             NEnvironment:Environment:North scenario=at 1s luggage (1,1) to (2,2)
             NMaster:MasterEnvironment:North topicRename=EETOPIC,/EETOPIC
             NRobot1:Robot:North@NWorld
             World:World:South width=3|height=3
             SEnvironment:Environment:South scenario=at 1s luggage (1,1) to (5,5)
             SMaster:MasterEnvironment:South topicRename=EETOPIC,/EETOPIC
             SRobot1:Robot:South@World",
            &["S5001 luggage cannot be at (5,5)"],
        ),
        (
            "S5001: both ends of a piece outside the map are one mistake",
            "World:World: width=3
             Environment:Environment: scenario=at 1s luggage (3,1) to (3,10)
             Master:MasterEnvironment:
             Robot1:Robot:@World",
            &["S5001 luggage cannot be at (3,1) and (3,10): these blocks are outside the map"],
        ),
        (
            "S5003: robots off the map are told of that alone",
            "World:World: width=3
             Robot1:Robot:@World chargeX=9
             Robot2:Robot:@World chargeX=9|chargeY=1",
            &["S5002 the charger of robot 1 is at (9,1)", "S5002 the charger of robot 2 is at (9,1)"],
        ),
        (
            "S5009: a world outside of the sites of all robots",
            "World:World:
             NWorld:World:North
             NEnvironment:Environment:North scenario=at 1s luggage (1,1) to (5,5)
             NMaster:MasterEnvironment:North
             NRobot1:Robot:North@NWorld",
            &["S5009 no robot is in this world: it is in no site, or the fleet has no robot there"],
        ),
        (
            "S5008: an environment outside of the site does not hear of its luggage",
            "Environment:Environment: scenario=at 1s luggage (1,1) to (5,5)|topicRename=ETOPIC,North/ETOPIC
             NWorld:World:North
             NMaster:MasterEnvironment:North
             NRobot1:Robot:North@NWorld",
            &["S5008 `Environment` does not receive what becomes of this luggage, so the run never ends"],
        ),
        (
            "S5018: a site without an environment, and one whose environment has no scenario",
            "NWorld:World:North
             NMaster:MasterEnvironment:North
             NRobot1:Robot:North@NWorld
             World:World:South
             SEnvironment:Environment:South
             SMaster:MasterEnvironment:South
             SRobot1:Robot:South@World",
            &[
                "S5018 no component sends events to this master, so the robots never get work",
                "S5018 this environment has no scenario, so the robots never get work",
            ],
        ),
        (
            "S5018: events may come from another program",
            "Master:MasterEnvironment: url=localhost:61616
             Robot1:Robot:",
            &[],
        ),
        (
            "S5001: an area of another site is not heard",
            "World:World: topicRename=ETOPIC,North/ETOPIC::ELMSTOPIC,North/ELMSTOPIC
             NEnvironment:Environment:North scenario=at 1s luggage random to (2,2)
             NMaster:MasterEnvironment:North
             NRobot1:Robot:North@World",
            &["S5001 `random` needs an area to draw a block from"],
        ),
        (
            "S5002: a robot of a site without a world is on no map",
            "NEnvironment:Environment:North scenario=at 1s landing 3|topicRename=ETOPIC,/ETOPIC
             NRobot1:Robot:North chargeX=7
             World:World:South width=3|height=3
             SMaster:MasterEnvironment:South topicRename=ETOPIC,/ETOPIC
             SMasterRobot:MasterRobot:South
             SRobot1:Robot:South@World",
            &[],
        ),
        (
            "S5003: two robots of two sites that hear of each other start on one block",
            "NRobot1:Robot:North chargeY=1|topicRename=RLMSTOPIC,/robots
             SRobot2:Robot:South chargeY=1|topicRename=RLMSTOPIC,/robots",
            &["S5003 robots 1 and 2 both start at (0,1): their chargers are on the same block"],
        ),
        (
            "S5003: robots of two sites that share the events alone do not",
            "NRobot1:Robot:North chargeY=1|topicRename=RMSTOPIC,/wake
             SRobot2:Robot:South chargeY=1|topicRename=RMSTOPIC,/wake",
            &[],
        ),
        (
            "S5004: two robots of one number hear of the same luggage",
            "NRobot1:Robot:North chargeY=1|topicRename=ELMSTOPIC,/luggage
             SRobot1:Robot:South chargeY=2|topicRename=ELMSTOPIC,/luggage",
            &["S5004 robots `NRobot1` and `SRobot1` both have the number 1"],
        ),
        (
            "S5004: two robots of one number are told of the same airplanes",
            "NRobot1:Robot:North topicRename=RMSTOPIC,/wake
             SRobot1:Robot:South topicRename=RMSTOPIC,/wake",
            &[],
        ),
        (
            "S5005: a robot of another site hears of the breakdown",
            "NEnvironment:Environment:North scenario=at 1s breakdown Robot7
             NMaster:MasterEnvironment:North topicRename=FAULTTOPIC,/faults
             SRobot7:Robot:South topicRename=FAULTTOPIC,/faults",
            &[],
        ),
        (
            "S5005: a robot of another site does not hear of it",
            "NEnvironment:Environment:North scenario=at 1s breakdown Robot7
             NMaster:MasterEnvironment:North topicRename=EETOPIC,/EETOPIC
             SMasterRobot:MasterRobot:South topicRename=EETOPIC,/EETOPIC
             SRobot7:Robot:South",
            &["S5005 robot 7 does not receive this event"],
        ),
        (
            "S5005: the path of a robot of another site, whose number a robot here has, too",
            "NEnvironment:Environment:North scenario=at 1s breakdown SRobot1
             NMaster:MasterEnvironment:North topicRename=EETOPIC,/EETOPIC
             NRobot1:Robot:North
             SMasterRobot:MasterRobot:South topicRename=EETOPIC,/EETOPIC
             SRobot1:Robot:South",
            &["S5005 robot `SRobot1` does not receive this event"],
        ),
        (
            "S5006: the robots of the other site do not bring it",
            "World:World:North width=60
             NEnvironment:Environment:North scenario=at 1s luggage (0,0) to (55,1)
             NMaster:MasterEnvironment:North topicRename=EETOPIC,/EETOPIC
             NRobot1:Robot:North@World
             SMaster:MasterRobot:South topicRename=EETOPIC,/EETOPIC
             SRobot1:Robot:South chargeX=50",
            &["S5006 no robot can bring luggage to (55,1)"],
        ),
        (
            "S5007: the map is that of the world that hears of it",
            "NEnvironment:Environment:North scenario=at 1s luggage (0,0) to (4,1)|topicRename=ETOPIC,/ETOPIC::ELMSTOPIC,/South/ELMSTOPIC
             NWorld:World:North map=...@..&#10;...@..
             NRobot1:Robot:North@NWorld
             World:World:South topicRename=ETOPIC,/ETOPIC|map=...@..&#10;...@..
             SMaster:MasterEnvironment:South topicRename=ETOPIC,/ETOPIC
             SRobot1:Robot:South@World",
            &["S5007 the map has no path from any robot's charger to (4,1)"],
        ),
        (
            "S5008: the master of another site hears the events",
            "NEnvironment:Environment:North scenario=at 1s luggage (1,1) to (2,2)|topicRename=ETOPIC,/ETOPIC::ELMSTOPIC,/South/ELMSTOPIC
             World:World:South topicRename=ETOPIC,/ETOPIC
             SMaster:MasterEnvironment:South topicRename=ETOPIC,/ETOPIC
             SRobot1:Robot:South@World",
            &[],
        ),
        (
            "S5008: it does not hear them",
            "NEnvironment:Environment:North scenario=at 1s luggage (1,1) to (2,2)
             World:World:South topicRename=ETOPIC,/ETOPIC
             SMaster:MasterEnvironment:South topicRename=ETOPIC,/ETOPIC
             SRobot1:Robot:South@World",
            &["S5008 no component forwards the events of this scenario to the robots"],
        ),
        (
            "S5008: a master of the same site hears others",
            "Environment:Environment:North scenario=at 1s luggage (1,1) to (2,2)
             Master:MasterEnvironment:North topicRename=ETOPIC,/ETOPIC
             Robot1:Robot:North",
            &["S5008 no component forwards the events of this scenario to the robots"],
        ),
        (
            "S5008: the robots of another site hear of no luggage",
            "NEnvironment:Environment:North scenario=at 1s luggage (1,1) to (2,2)
             NMaster:MasterEnvironment:North topicRename=EETOPIC,/EETOPIC
             SMasterRobot:MasterRobot:South topicRename=EETOPIC,/EETOPIC
             SRobot1:Robot:South",
            &["S5008 no robot receives the luggage of this scenario"],
        ),
        (
            "S5008: a world outside does not hear where the luggage is",
            "World:World:
             NEnvironment:Environment:North scenario=at 1s luggage (1,1) to (2,2)
             NMaster:MasterEnvironment:North
             NRobot1:Robot:North@World",
            &["S5008 the world of the robots does not receive the luggage of this scenario"],
        ),
        (
            "S5008: a world outside hears of it",
            "World:World: topicRename=ETOPIC,North/ETOPIC::ELMSTOPIC,North/ELMSTOPIC::RLMSTOPIC,North/RLMSTOPIC
             NEnvironment:Environment:North scenario=at 1s luggage (1,1) to (2,2)
             NMaster:MasterEnvironment:North
             NRobot1:Robot:North@World",
            &[],
        ),
        (
            "S5008: a master alone in another site",
            "World:World:
             Environment:Environment: scenario=at 1s luggage (1,1) to (2,2)
             NMaster:MasterEnvironment:North
             Robot1:Robot:@World",
            &["S5008 no component forwards the events of this scenario to the robots"],
        ),
        (
            "S5008: a world and its robot in another site",
            "NWorld:World:North
             Environment:Environment: scenario=at 1s luggage (1,1) to (2,2)
             Master:MasterEnvironment:
             NRobot1:Robot:North@NWorld",
            &["S5008 no robot receives the luggage of this scenario"],
        ),
        (
            "S5008: one that another site has is not that of this one",
            "NEnvironment:Environment:North scenario=at 1s landing 3
             NMaster:MasterEnvironment:North
             NMasterRobot:MasterRobot:North
             NRobot1:Robot:North
             SEnvironment:Environment:South scenario=at 1s luggage (1,1) to (2,2)
             SMaster:MasterEnvironment:South
             SRobot2:Robot:South",
            &[],
        ),
        (
            "S5012: a robot wired to the world of another site",
            "NWorld:World:North
             NEnvironment:Environment:North scenario=at 1s luggage (1,1) to (2,2)
             NMaster:MasterEnvironment:North
             NRobot1:Robot:North@NWorld
             World:World:South
             SEnvironment:Environment:South scenario=at 1s luggage (1,1) to (2,2)
             SMaster:MasterEnvironment:South
             SRobot1:Robot:South@NWorld",
            &["S5012 robot 1 is wired to `NWorld`, which does not receive its messages"],
        ),
        (
            "S5008: a landing in one site wakes the robots of another",
            "NEnvironment:Environment:North scenario=at 1s landing 3
             NMaster:MasterEnvironment:North topicRename=EETOPIC,/EETOPIC
             SMasterRobot:MasterRobot:South topicRename=EETOPIC,/EETOPIC
             SRobot1:Robot:South",
            &[],
        ),
        (
            "S5008: a landing in one site does not",
            "NEnvironment:Environment:North scenario=at 1s landing 3
             NMaster:MasterEnvironment:North topicRename=ELMSTOPIC,/luggage
             SMasterRobot:MasterRobot:South
             SRobot1:Robot:South topicRename=ELMSTOPIC,/luggage",
            &["S5008 no component reacts to the landings and take-offs of this scenario"],
        ),
        (
            "S5008: robots that sleep are woken for landings that they hear of",
            "NEnvironment:Environment:North scenario=at 1s landing 3
             NMaster:MasterEnvironment:North topicRename=FAULTTOPIC,/faults
             NMasterRobot:MasterRobot:North
             SEnvironment:Environment:South scenario=at 1s luggage (1,1) to (2,2)
             SMaster:MasterEnvironment:South topicRename=FAULTTOPIC,/faults
             SMasterRobot:MasterRobot:South
             SRobot1:Robot:South policy=classic|asleep=true",
            &["S5008 all robots sleep"],
        ),
        (
            "S5009: a world of a site without robots is not that of the robots of another",
            "NWorld:World:North topicRename=ETOPIC,/ETOPIC
             World:World:South topicRename=ETOPIC,/ETOPIC
             SRobot1:Robot:South@World",
            &[],
        ),
        (
            "S5009: a world hears of robots that are not wired to it",
            "NWorld:World:North topicRename=RLMSTOPIC,/robots
             SRobot1:Robot:South topicRename=RLMSTOPIC,/robots",
            &["S5009 robot `SRobot1` is not wired to the world"],
        ),
        (
            "S5010: masters of two sites pass on the same events",
            "NMaster:MasterEnvironment:North topicRename=ETOPIC,/ETOPIC
             SMaster:MasterEnvironment:South topicRename=ETOPIC,/ETOPIC",
            &["S5010 `SMaster` forwards the same events as `NMaster`"],
        ),
        (
            "S5010: masters of two sites pass on their own",
            "NMaster:MasterEnvironment:North topicRename=ELMSTOPIC,/luggage
             SMaster:MasterEnvironment:South topicRename=ELMSTOPIC,/luggage",
            &[],
        ),
        (
            "S5011: luggage of two sites is on one topic",
            "NEnvironment:Environment:North scenario=at 1s luggage (1,1) to (2,2)|topicRename=ETOPIC,/ETOPIC::ELMSTOPIC,/ELMSTOPIC
             SEnvironment:Environment:South scenario=at 1s luggage (1,1) to (2,2)|topicRename=ETOPIC,/ETOPIC::ELMSTOPIC,/ELMSTOPIC
             Master:MasterEnvironment:
             Robot1:Robot:",
            &["S5011 `NEnvironment` and `SEnvironment` both number their luggage from 1:"],
        ),
        (
            "S5011: masters of two sites pass it on on one topic",
            "NEnvironment:Environment:North scenario=at 1s luggage (1,1) to (2,2)|topicRename=ELMSTOPIC,/ELMSTOPIC
             NMaster:MasterEnvironment:North topicRename=ELMSTOPIC,/ELMSTOPIC
             SEnvironment:Environment:South scenario=at 1s luggage (1,1) to (2,2)|topicRename=ELMSTOPIC,/ELMSTOPIC
             SMaster:MasterEnvironment:South topicRename=ELMSTOPIC,/ELMSTOPIC
             Robot1:Robot:",
            &["S5011 `NEnvironment` and `SEnvironment` both number their luggage from 1:"],
        ),
        (
            "S5012: robots of two sites in one world know where they are",
            "World:World:
             NRobot1:Robot:North@World topicRename=POSTOPIC,/POSTOPIC::CSMSTOPIC,/CSMSTOPIC::RLMSTOPIC,/RLMSTOPIC
             SRobot2:Robot:South@World topicRename=POSTOPIC,/POSTOPIC::CSMSTOPIC,/CSMSTOPIC::RLMSTOPIC,/RLMSTOPIC",
            &[],
        ),
        (
            "S5012: they do not",
            "World:World:
             NRobot1:Robot:North@World topicRename=RLMSTOPIC,/RLMSTOPIC
             SRobot2:Robot:South@World topicRename=RLMSTOPIC,/RLMSTOPIC",
            &["S5012 robot 2 uses the topic `South/POSTOPIC` where the other robots in its world use `North/POSTOPIC`"],
        ),
        (
            "S5015: a robot of another site is repaired, this one is not",
            "NEnvironment:Environment:North scenario=at 1s breakdown Robot1; at 2s breakdown Robot1
             NMaster:MasterEnvironment:North topicRename=EETOPIC,/EETOPIC
             NRobot1:Robot:North
             SMaster:MasterRobot:South topicRename=EETOPIC,/EETOPIC
             SRobot1:Robot:South runOnStartup=false
             SShift:Shift:South@SRobot1/TaskInterface work=1s",
            &["S5015 robot 1 breaks down twice: the second breakdown has no effect"],
        ),
        (
            "S5016: the worlds of two sites hear of one environment",
            "NWorld:World:North topicRename=ETOPIC,/ETOPIC
             World:World:South topicRename=ETOPIC,/ETOPIC
             Environment:Environment: scenario=at 1s luggage (1,1) to (2,2)
             Master:MasterEnvironment:
             Robot1:Robot:South@World topicRename=ELMSTOPIC,/ELMSTOPIC
             NRobot2:Robot:North@NWorld topicRename=ELMSTOPIC,/ELMSTOPIC",
            &["S5016 `NWorld` and `World` both wait for all luggage of one environment"],
        ),
    ];
    for (name, lines, expected) in cases {
        let found = found(lines);
        let is_expected = found.len() == expected.len()
            && found.iter().zip(*expected).all(|(found, expected)| found.starts_with(expected));
        assert!(is_expected, "{name}: {found:#?}");
    }
}

#[test]
fn a_site_that_cannot_be_read_is_one_of_its_own() {
    let (folder, part) = (tempfile::tempdir().unwrap(), |lines: &str| lines.lines().map(component).collect::<String>());
    let composite = |name: &str, inside: &str| {
        let text = format!(
            "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:saoms=\"urn:saoms:1\" \
             xmlns:t=\"urn:t\" name=\"{name}\" targetNamespace=\"urn:t\">\n{inside}</composite>"
        );
        std::fs::write(folder.path().join(format!("{name}.composite")), &text).unwrap();
        text
    };
    let use_of_inner = |inside: &str| {
        let implementation = "<implementation.composite name=\"t:inner\"/>";
        format!("<component name=\"North\" saoms:site=\"North\">{implementation}{inside}</component>\n")
    };
    let inner = composite(
        "inner",
        &part(
            "Environment:Environment: scenario=at 1s luggage random to (2,2); at 2s breakdown Robot7\n\
             World:World:\nMaster:MasterEnvironment:\nRobot7:Robot:@World",
        ),
    );
    let codes = |text: &str, outer: &str| {
        std::fs::write(folder.path().join("inner.composite"), text).unwrap();
        composite("outer", outer);
        let found = Fleet::of_file(folder.path().join("outer.composite")).diagnostics();
        let mut codes: Vec<&str> = found.lines().filter_map(|line| line.split(' ').nth(1)).collect();
        codes.sort_unstable();
        codes.join(" ")
    };
    assert_eq!(codes(&inner, &use_of_inner("")), "");
    let at = inner.find("</component>").unwrap();
    let (cut, other) = (inner[..at].to_owned(), inner.replace("composite", "compo"));
    // What the site has, or takes, is not known.
    let property = use_of_inner("<property name=\"table\">x</property><reference name=\"hall\" target=\"Hall\"/>");
    let property = property + &part("Hall:World:\nRobot1:Robot:");
    assert_eq!(codes(&cut, &use_of_inner("")), "S0103");
    assert_eq!(codes(&cut, &property), "S0103");
    assert_eq!(codes("", &property), "S0005");
    assert_eq!(codes(&other, &property), "S1001");
    // The others are judged all the same, but where what they say may be heard in it.
    let south = |renamed: &str| {
        let south = format!("Environment:Environment:South scenario=at 1s luggage (1,1) to (2,2)|{renamed}");
        use_of_inner("") + &part(&south)
    };
    assert_eq!(codes("", &south("")), "S0005 S5008");
    assert_eq!(codes(&cut, &south("")), "S0103 S5008");
    assert_eq!(codes("", &south(SHARED)), "S0005");
}

#[test]
fn a_breakdown_names_no_robot_of_a_site_apart() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    let head =
        "xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:saoms=\"urn:saoms:1\" xmlns:h=\"urn:h\"";
    let site = |name: &str, scenario: &str| {
        format!(
            "<component name=\"{name}\" saoms:site=\"{name}\"><implementation.composite name=\"h:hall\"/>\
             <property name=\"scenario\">{scenario}</property></component>"
        )
    };
    let hall =
        ["Environment:Environment:", "Master:MasterEnvironment:", "Robot1:Robot:", "Robot2:Robot:"].map(component);
    let scenario = "<property name=\"scenario\" source=\"$scenario\"/></component>";
    let hall = format!("{}{}", hall[0].trim_end().trim_end_matches("</component>"), scenario) + &hall[1..].concat();
    write(
        "hall.composite",
        format!(
            "<composite {head} name=\"hall\" targetNamespace=\"urn:h\"><property name=\"scenario\"/>{hall}</composite>"
        ),
    );
    let told = |robot: &str| {
        let sites = site("North", "at 1s breakdown 1") + &site("South", &format!("at 1s breakdown {robot}"));
        write(
            "sites.composite",
            format!("<composite {head} name=\"sites\" targetNamespace=\"urn:s\">{sites}</composite>"),
        );
        Fleet::of_file(folder.path().join("sites.composite")).diagnostics()
    };
    let other = told("North/Robot1");
    assert!(other.starts_with("error S5005 ") && other.contains("site `South` has no robot `North/Robot1`"), "{other}");
    assert_eq!(other.matches("S5005").count(), 1, "{other}");
    for own in ["South/Robot1", "Robot1", "1"] {
        assert_eq!(told(own), "", "{own}");
    }
}

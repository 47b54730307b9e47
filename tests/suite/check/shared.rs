//! The rules about what components of a fleet share: events, numbers of luggage, topics, blocks and shifts.

use super::rules::{Component, MASTER, ROBOT, found};

const WORLD: Component<'_> = ("World", "saoms.World", &[], false);

const ENVIRONMENT: Component<'_> =
    ("Environment", "saoms.Environment", &[("scenario", "at 1s luggage (3,1) to (4,2)")], false);

#[test]
fn one_master_passes_on_the_events_of_an_environment() {
    let second = |properties: &'static [(&str, &str)]| -> Component<'_> {
        ("Master2", "saoms.MasterEnvironment", properties, false)
    };
    let with = |properties| found(&[WORLD, ENVIRONMENT, MASTER, second(properties), ROBOT]);
    let message =
        "error S5010 `Master2` forwards the same events as `Master`: all luggage is requested and counted twice";
    assert_eq!(with(&[]), [message]);
    assert_eq!(with(&[("topicRename", "ELMSTOPIC,jobs")])[0], message);
    assert!(with(&[("runOnStartup", "false")]).is_empty(), "it may relieve the other one");
    assert!(!with(&[("topicRename", "ETOPIC,events")]).concat().contains("S5010"), "it hears other events");
}

#[test]
fn one_environment_numbers_the_luggage() {
    let second = |properties: &'static [(&str, &str)]| -> Component<'_> {
        ("Environment2", "saoms.Environment", properties, false)
    };
    let with = |properties| found(&[WORLD, ENVIRONMENT, second(properties), MASTER, ROBOT]);
    assert_eq!(
        with(&[("scenario", "at 9s breakdown Robot1; at 5s luggage (1,1) to (2,2)")]),
        ["error S5011 `Environment` and `Environment2` both number their luggage from 1: of two pieces with the same \
            number, only the first is delivered"]
    );
    assert!(with(&[("scenario", "at 9s breakdown Robot1")]).is_empty(), "it has no luggage");
    let elsewhere = with(&[("scenario", "at 5s luggage (1,1) to (2,2)"), ("topicRename", "ETOPIC,events")]);
    assert!(!elsewhere.concat().contains("S5011"), "{elsewhere:?}");
}

#[test]
fn robots_of_a_world_share_their_topics() {
    fn robot<'a>(name: &'a str, renamed: &'a [(&'a str, &'a str)]) -> Component<'a> {
        (name, "saoms.Robot", renamed, true)
    }
    let with = |one, two, three| {
        let renamed = [one, two, three].map(|pairs| [("topicRename", pairs)]);
        let robot = |place: usize| robot(["Robot1", "Robot2", "Robot3"][place], &renamed[place]);
        found(&[WORLD, ENVIRONMENT, MASTER, robot(0), robot(1), robot(2)])
    };
    let collide = "they do not know where it is and collide with it";
    assert_eq!(
        with("POSTOPIC,far", "", ""),
        [format!(
            "error S5012 robot 1 uses the topic `far` where the other robots in its world use `POSTOPIC`: {collide}"
        )]
    );
    assert_eq!(
        with("POSTOPIC,far", "", "POSTOPIC,far"),
        [format!(
            "error S5012 robot 2 uses the topic `POSTOPIC` where the other robots in its world use `far`: {collide}"
        )]
    );
    assert!(with("POSTOPIC,far", "POSTOPIC,far", "POSTOPIC,far").is_empty());
    // One finding a robot, the worst.
    assert_eq!(with("RLMSTOPIC,a::POSTOPIC,b", "", "").len(), 1);
    let apart = with("CSMSTOPIC,alone", "", "").concat();
    assert!(apart.starts_with("warning S5012 robot 1 uses the topic `alone`"), "{apart}");
    let idle = "robot 1 uses the topic `alone` where the other robots in its world use `ELMSTOPIC`";
    assert_eq!(with("ELMSTOPIC,alone", "", ""), [format!("warning S5012 {idle}: it is never asked to bring luggage")]);
    // A master of its own asks it.
    let alone = [("topicRename", "ELMSTOPIC,alone")];
    let own = ("Own", "saoms.MasterEnvironment", &[("topicRename", "ELMSTOPIC,alone::ETOPIC,own")][..], false);
    let fleet = [WORLD, ENVIRONMENT, MASTER, own, robot("Robot1", &alone), robot("Robot2", &[]), robot("Robot3", &[])];
    let told = found(&fleet).concat();
    assert!(!told.contains("S5012"), "{told}");
    // Each of two halls has topics of its own.
    let far = [("topicRename", "POSTOPIC,far")];
    let halls = [WORLD, ENVIRONMENT, MASTER, ROBOT, ("Robot2", "saoms.Robot", &far, false)];
    assert!(!found(&halls).concat().contains("S5012"));
}

#[test]
fn robots_beside_the_world_need_chargers_of_their_own() {
    let beside = ("Robot2", "saoms.Robot", &[("chargeY", "1")][..], false);
    let told = found(&[WORLD, ENVIRONMENT, MASTER, ROBOT, beside]);
    assert_eq!(told[1], "error S5003 robots 1 and 2 both start at (0,1): their chargers are on the same block");
}

#[test]
fn sides_beside_a_map_are_its_own() {
    let with = |width: &str, height: &str| {
        let world = [("map", "....\n...."), ("width", width), ("height", height)];
        found(&[("World", "saoms.World", &world, false), ROBOT])
    };
    assert!(with("4", "2").is_empty());
    assert_eq!(
        with("9", "11"),
        [
            "warning S5014 `width` is 9, but the map has 4 columns: the size of the map is used",
            "warning S5014 `height` is 11, but the map has 2 rows: the size of the map is used",
        ]
    );
}

#[test]
fn a_breakdown_is_of_a_robot_that_hears_of_it() {
    let breakdown: &[(&str, &str)] = &[("scenario", "at 1s breakdown Robot1; at 2s breakdown Robot2")];
    let environment = ("Environment", "saoms.Environment", breakdown, false);
    let with = |renamed: &[(&str, &str)], more: &[Component<'_>]| {
        let found =
            found(&[&[WORLD, environment, MASTER, ROBOT, ("Robot2", "saoms.Robot", renamed, true)], more].concat());
        found.into_iter().filter(|line| line.contains("S5005")).collect::<Vec<String>>()
    };
    let far = [("topicRename", "FAULTTOPIC,far")];
    assert!(with(&[], &[]).is_empty());
    let told = "error S5005 robot 2 does not receive this event: it receives breakdowns on the topic `far`";
    assert_eq!(with(&far, &[]), [told]);
    let second = |renamed: &'static [(&'static str, &'static str)]| -> Component<'_> {
        ("Master2", "saoms.MasterEnvironment", renamed, false)
    };
    assert_eq!(with(&far, &[second(&[("topicRename", "FAULTTOPIC,far::ETOPIC,far2")])]), [told]);
    assert!(with(&far, &[second(&[("topicRename", "FAULTTOPIC,far")])]).is_empty());
}

#[test]
fn a_robot_that_is_gone_has_no_more_events() {
    let with = |scenario| {
        let environment = [("scenario", scenario)];
        found(&[WORLD, ("Environment", "saoms.Environment", &environment, false), MASTER, ROBOT])
    };
    assert!(with("at 1s breakdown Robot1; at 2s gone 1; at 3s end").is_empty(), "a broken robot is carried away");
    let twice = "warning S5015 robot 1 is gone twice: the second time has no effect";
    assert_eq!(with("at 1s gone Robot1; at 2s gone 1"), [twice]);
    let after = "warning S5015 robot 1 breaks down after it is gone: that has no effect";
    assert_eq!(with("at 5s breakdown Robot1; at 2s gone 1"), [after]);
    assert_eq!(with("at 2s gone Robot1; then 1s breakdown 1"), [after]);
    let again = "warning S5015 robot 1 is gone repeatedly: only the first time has an effect";
    assert_eq!(with("from 1s every 1s 3 times gone 1"), [again]);
}

#[test]
fn a_broken_robot_is_not_broken_again() {
    let with = |scenario| {
        let environment = [("scenario", scenario)];
        found(&[WORLD, ("Environment", "saoms.Environment", &environment, false), MASTER, ROBOT])
    };
    assert!(with("at 1s breakdown Robot1; at 2s breakdown 1..1; at 3s end").len() == 1);
    let twice = "warning S5015 robot 1 breaks down twice: the second breakdown has no effect";
    assert_eq!(with("at 1s breakdown Robot1; at 2s breakdown 1"), [twice]);
    let again = "warning S5015 robot 1 breaks down repeatedly: only the first breakdown has an effect";
    assert_eq!(with("from 1s every 2s breakdown 1"), [again]);
}

#[test]
fn what_another_program_may_supply_is_a_warning() {
    let with = |url: &[(&str, &str)], scenario, map| {
        let scenario = [("scenario", scenario)];
        let map = [("map", map)];
        found(&[
            ("World", "saoms.World", &map, false),
            ("Environment", "saoms.Environment", &scenario, false),
            MASTER,
            ("Robot1", "saoms.Robot", url, true),
        ])
    };
    let divided = "...@..\n...@..";
    let (luggage, broken) = ("at 1s luggage (0,0) to (4,1)", "at 1s luggage (0,0) to (1,1); at 1s breakdown Robot7");
    for (scenario, code) in [(luggage, "S5007"), (broken, "S5005")] {
        let url = [("url", "localhost:61616")];
        let (alone, served) = (with(&[], scenario, divided), with(&url, scenario, divided));
        assert_eq!(alone.len(), 1, "{alone:?}");
        assert!(alone[0].starts_with(&format!("error {code}")), "{alone:?}");
        let peers =
            "warning S5025 a robot of the policy `safe` sends its position through a broker, and its site has no zone";
        assert_eq!(served, [alone[0].replace("error", "warning"), peers.to_owned()]);
    }
}

#[test]
fn one_robot_has_to_reach_both_ends_of_luggage() {
    let map = format!("{}\n{0}", ".".repeat(41));
    let with = |scenario: &str| {
        let scenario = [("scenario", scenario)];
        let far = [("chargeX", "40"), ("chargeY", "1")];
        found(&[
            ("World", "saoms.World", &[("map", &map)], false),
            ("Environment", "saoms.Environment", &scenario, false),
            MASTER,
            ROBOT,
            ("Robot2", "saoms.Robot", &far, true),
        ])
    };
    assert!(with("at 1s luggage (0,0) to (20,1); at 1s luggage (21,0)..(30,0) to (40,1)").is_empty());
    let far = "the charger of each robot is too far from one of the two";
    let told = |what: &str, from: &str| format!("{what} S5006 no robot can bring luggage {from}: {far}");
    assert_eq!(with("at 1s luggage (3,1) to (30,1)"), [told("error", "from (3,1) to (30,1)") + " blocks"]);
    assert_eq!(
        with("at 1s luggage (3,1)..(4,1) to (30,1)"),
        [told("error", "between 2 of the 2 pairs of blocks here, such as (3,1) and (30,1)")]
    );
    assert_eq!(
        with("at 1s luggage (15,1)..(25,1) to (30,1)"),
        [told("warning", "between 5 of the 11 pairs of blocks here, such as (15,1) and (30,1)")]
    );
}

#[test]
fn worlds_with_robots_have_environments_of_their_own() {
    let text = |robot: &str| {
        let fleet = std::fs::read_to_string(crate::support::root().join("tests/rules/S5016.composite")).unwrap();
        fleet.replace("<reference name=\"world\" target=\"Hall\"/>", robot)
    };
    let of_rule = |text: String| {
        let found = saoms_testkit::Fleet::of_text(text).diagnostics();
        found.lines().filter(|line| line.contains("S5016")).count()
    };
    assert_eq!(of_rule(text("<reference name=\"world\" target=\"Hall\"/>")), 1);
    assert_eq!(of_rule(text("<reference name=\"world\" target=\"World\"/>")), 0, "nobody is in the other world");
    let renamed = text("<reference name=\"world\" target=\"Hall\"/>").replacen(
        "<property name=\"ID\">Hall</property>",
        "<property name=\"ID\">Hall</property><property name=\"topicRename\">ETOPIC,far</property>",
        1,
    );
    assert_eq!(of_rule(renamed), 0, "it hears of other luggage");
}

#[test]
fn an_id_with_an_expression_that_nobody_reads_says_so_once() {
    let robot = "<implementation.java class=\"saoms.Robot\"/><property name=\"ID\">Robot${row}</property>";
    let text = format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" targetNamespace=\"urn:t\" name=\"t\">\n\
         <property name=\"row\">3</property><component name=\"R\">{robot}<property name=\"period\">1s</property></component>\n\
         </composite>"
    );
    let found = saoms_testkit::Fleet::of_text(text).diagnostics();
    let told = "`${...}` in `Robot${row}` is not evaluated";
    assert_eq!(found.lines().count(), 1, "{found}");
    assert!(found.starts_with("error S3014") && found.contains(told), "{found}");
}

/// The findings about shifts with these properties, wired to these components.
fn shifts(all: &[(&str, &str, &str)], waits: bool) -> Vec<String> {
    let mut text = "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" targetNamespace=\"urn:t\" \
                    name=\"t\">\n"
        .to_owned();
    let component = |name: &str, class: &str, properties: &str, inside: &str| {
        let given = [("ID", name), ("period", "100")].into_iter();
        let more = properties.split(' ').filter_map(|one| one.split_once('='));
        let given = given.chain(more).map(|(name, value)| format!("<property name=\"{name}\">{value}</property>"));
        let given: String = given.collect();
        format!("<component name=\"{name}\"><implementation.java class=\"{class}\"/>{given}{inside}</component>\n")
    };
    for (name, properties, task) in all {
        let wire = format!("<reference name=\"tasks\" target=\"{task}/TaskInterface\"/>");
        text += &component(name, "saoms.Shift", properties, &wire);
    }
    text += &component("Robot1", "saoms.Robot", &format!("runOnStartup={}", !waits), "");
    text += "</composite>";
    let found = saoms_testkit::Fleet::of_text(text).diagnostics();
    found.lines().map(|line| line.splitn(4, ' ').last().unwrap_or(line).to_owned()).collect()
}

#[test]
fn shifts_schedule_others_that_wait_for_them() {
    assert!(shifts(&[("Early", "work=1s", "Robot1")], true).is_empty());
    assert_eq!(
        shifts(&[("Early", "work=1s", "Robot1")], false),
        ["`Robot1` runs from the start of the fleet, but `Early` schedules it only for its shifts"]
    );
    assert_eq!(
        shifts(&[("Early", "work=1s", "Early")], false),
        ["`Early` schedules itself: it stops at the end of its first shift"]
    );
}

#[test]
fn a_world_and_a_master_work_in_no_shifts() {
    let hall = std::fs::read_to_string(crate::support::root().join("composites/hall.composite")).unwrap();
    for name in ["World", "Master"] {
        let shift = format!(
            "<component name=\"Shift\"><implementation.rust class=\"saoms.Shift\"/><property name=\"ID\">S</property>\
             <property name=\"period\">1s</property><property name=\"work\">9s</property>\
             <reference name=\"tasks\" target=\"{name}/TaskInterface\"/></component>\n</composite>"
        );
        let id = format!("<property name=\"ID\" value=\"{name}\"/>");
        let waits = format!("{id}<property name=\"runOnStartup\" value=\"false\"/>");
        let text = hall.replace("</composite>", &shift).replace(&id, &waits);
        let found = saoms_testkit::Fleet::of_text(text).diagnostics();
        let message = format!(
            "`{name}` is scheduled in shifts by `Shift`: between them the robots cannot work, and the run has no end"
        );
        assert!(found.contains(&message) && found.lines().count() == 1, "{found}");
    }
}

#[test]
fn what_waits_for_a_shift_and_has_none_never_runs() {
    for name in ["World", "Environment", "Master", "Robot7"] {
        let robot = ("Robot7", "saoms.Robot", &[][..], true);
        let all: Vec<Component<'_>> = [WORLD, ENVIRONMENT, MASTER, robot]
            .into_iter()
            .map(|one| if one.0 == name { (one.0, one.1, &[("runOnStartup", "false")][..], one.3) } else { one })
            .collect();
        let message = format!("warning S5013 `{name}` never runs: it waits to be scheduled, and nothing schedules it");
        assert_eq!(found(&all), [message]);
    }
}

#[test]
fn two_shifts_of_a_component_do_not_overlap() {
    let two = |early, late| shifts(&[("Early", early, "Robot1"), ("Late", late, "Robot1")], true);
    assert!(two("work=1s pause=1s", "start=1s work=1s pause=1s").is_empty());
    assert!(two("work=1s shifts=5", "start=5s work=9s").is_empty());
    assert_eq!(
        two("work=1s pause=1s", "start=3s work=1500ms pause=500ms"),
        ["the shifts of `Early` and `Late` overlap: both schedule `Robot1` at 4s, and the shift that starts later \
            decides when it stops"]
    );
}

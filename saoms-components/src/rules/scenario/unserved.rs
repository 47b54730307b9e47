//! Rule: a scenario has events that no component handles, so that a run would wait for ever.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::ops::Range;

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::environment::{Environment, EnvironmentProperties, EventSpec, Scenario};
use crate::master::{MasterEnvironment, MasterRobot};
use crate::messages::{ENVIRONMENT, EVENT_LUGGAGE, EXCEPTIONAL_EVENT, ROBOT_STATE};
use crate::robot::{Policy, Robot};
use crate::rules::hearing::{events, hearing, passed_on, site_of, together};
use crate::rules::robots::{FleetRobot, may_be_others, publishers_beside_robots, robots, unless_elsewhere};
use crate::world::World;

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5008",
        name: "unserved",
        meaning: "A scenario has no effect: it has no events, no component forwards its events, no robot or world receives them, or \
            all robots are classic robots that sleep, and nothing wakes them. Components of other sites receive them \
            only on topics outside of sites. Or the environment does not receive what becomes of its luggage, and the \
            run never ends.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let mut findings: Vec<Finding> = fleet.all::<Environment>().filter_map(|one| without_events(fleet, one)).collect();
    if !may_be_others(fleet) {
        findings.extend(without_effect(fleet));
    }
    findings
}

/// A finding about a scenario that is given and has no line.
fn without_events(fleet: &FleetView<'_>, (index, properties): (usize, EnvironmentProperties)) -> Option<Finding> {
    let is_given = fleet.components()[index].values.iter().any(|(given, _)| given == "scenario");
    let (scenario, faults) = Scenario::read_partly(&properties.scenario);
    let is_empty = is_given && scenario.lines().is_empty() && faults.is_empty();
    is_empty.then(|| {
        Finding::new(Place::property("scenario").in_component(index), "this scenario has no events")
            .help("write a line such as `at 6s luggage (3,1) to (3,10)`, or remove the property")
    })
}

/// The findings about scenarios whose events do nothing.
fn without_effect(fleet: &FleetView<'_>) -> Vec<Finding> {
    let scenarios = fleet.all::<Environment>();
    let scenarios: Vec<(usize, FirstEvents)> =
        scenarios.map(|(index, properties)| (index, FirstEvents::of(&properties.scenario))).collect();
    let with_airplanes = scenarios.iter().filter(|(_, has)| has.airplanes.is_some());
    let with_airplanes: BTreeSet<&str> = with_airplanes.map(|(index, _)| events(fleet, *index)).collect();
    let woken = woken(fleet, &with_airplanes);
    let mut known: HashMap<&str, Served> = HashMap::new();
    let judged = scenarios.iter().filter_map(|(index, has)| {
        let events = events(fleet, *index);
        let served = known.entry(events).or_insert_with(|| Served::of(fleet, events, &woken));
        let (first, mistake) = served.find_mistake(has)?;
        let place = Place::property("scenario").part(first.0, first.1.clone()).in_component(*index);
        let Some(other) = &mistake.other else {
            // A composite that is used several times lacks the component once, whatever scenarios it is given.
            let is_inside = fleet.components()[*index].path.contains('/');
            let finding = match is_inside {
                true => Finding::new(Place::component(*index), mistake.message).label(place, "the first such event"),
                false => Finding::new(place, mistake.message),
            };
            return Some(finding.help(mistake.help.clone()));
        };
        let finding = other.finding(fleet, mistake, place);
        Some(match site_of(ENVIRONMENT.name(), events) {
            None | Some("") => finding,
            Some(site) => finding.label(
                Place::topic(ENVIRONMENT.name()).in_component(*index),
                format!("the scenario is in the site `{site}`"),
            ),
        })
    });
    let unheard = scenarios.iter().filter_map(|(index, has)| without_news(fleet, *index, has));
    unless_elsewhere(fleet, judged.chain(unheard).collect())
}

/// A finding about an environment that does not receive what becomes of its luggage.
fn without_news(fleet: &FleetView<'_>, index: usize, has: &FirstEvents) -> Option<Finding> {
    let first = has.luggage.as_ref()?;
    let environment = &fleet.components()[index];
    let own = environment.topic(EVENT_LUGGAGE.name());
    let told = passed_on(fleet, events(fleet, index), EVENT_LUGGAGE.name());
    // Where nobody passes it on, that is the mistake.
    let name = told.first().filter(|_| !told.contains(own))?;
    let message = format!(
        "`{}` does not receive what becomes of this luggage, so the run never ends: masters and robots report it on \
         the topic `{name}`, and `{}` receives `{own}`",
        environment.path, environment.path
    );
    let outside = if own.contains('/') { "/" } else { "" };
    let topic = EVENT_LUGGAGE.name();
    let help = match own == topic || own.ends_with(&format!("/{topic}")) {
        true => format!("add the pair `{topic},{outside}{name}` to the `topicRename` of `{}`", environment.path),
        false => together(topic, environment, ("its luggage", name)),
    };
    let place = Place::property("scenario").part(first.0, first.1.clone()).in_component(index);
    Some(Finding::new(place, message).help(help))
}

/// Index of the text and byte range of the word at which a scenario first has a kind of event.
type First = (usize, Range<usize>);

/// First event of each kind in a scenario.
struct FirstEvents {
    events: Option<First>,
    /// Luggage, or blocks to visit.
    luggage: Option<First>,
    visits: Option<First>,
    airplanes: Option<First>,
}

impl FirstEvents {
    fn of(texts: &[String]) -> FirstEvents {
        let (scenario, _) = Scenario::read_partly(texts);
        let first = |is: fn(&EventSpec) -> bool| {
            let line = scenario.lines().iter().find(|line| is(&line.event))?;
            Some((line.text as usize, line.bytes.clone()))
        };
        FirstEvents {
            events: first(|one| !matches!(one, EventSpec::Raised(_) | EventSpec::End)),
            luggage: first(|one| matches!(one, EventSpec::Luggage { .. } | EventSpec::Visit { .. })),
            visits: first(|one| matches!(one, EventSpec::Visit { .. })),
            airplanes: first(|one| matches!(one, EventSpec::Landing(_) | EventSpec::Takeoff(_))),
        }
    }
}

/// Reason why a scenario has no effect.
struct Mistake {
    message: &'static str,
    help: String,
    /// Another component that does not use the same topic.
    other: Option<Other>,
}

/// A component that has another name of a topic than the scenario needs.
struct Other {
    index: usize,
    topic: &'static str,
    /// The name that the scenario needs.
    needed: String,
    label: String,
}

impl Other {
    /// The finding at this component, if it gives the topic a new name or is in a site, or else at the scenario.
    fn finding(&self, fleet: &FleetView<'_>, mistake: &Mistake, scenario: Place) -> Finding {
        let Other { index, topic, needed, label } = self;
        let (own, place) = (fleet.components()[*index].topic(topic), Place::topic(topic).in_component(*index));
        if own == *topic {
            return Finding::new(scenario, mistake.message).label(place, label.clone()).help(mistake.help.clone());
        }
        let finding =
            Finding::new(place, format!("{}: {label}", mistake.message)).label(scenario, "the first such event");
        match own.contains('/') || needed.contains('/') {
            true => finding.help(mistake.help.clone()),
            false if needed == topic => finding.help(format!("remove the pair `{topic},{own}`")),
            false => finding.instead(needed),
        }
    }
}

/// What hinders the events of one name on the bus.
struct Served {
    /// Any event, luggage, blocks to visit, and landings and take-offs.
    events: Option<Mistake>,
    luggage: Option<Mistake>,
    visits: Option<Mistake>,
    airplanes: Option<Mistake>,
}

impl Served {
    fn of(fleet: &FleetView<'_>, events: &str, woken: &Woken<'_>) -> Served {
        let luggage = passed_on(fleet, events, EVENT_LUGGAGE.name());
        Served {
            events: luggage.is_empty().then(|| without_master(fleet, events)),
            luggage: not_brought(fleet, events, &luggage, woken),
            visits: not_visited(fleet, &luggage),
            airplanes: not_handled(fleet, events),
        }
    }

    /// The first event that something hinders, and what that is.
    fn find_mistake<'h>(&'h self, has: &'h FirstEvents) -> Option<(&'h First, &'h Mistake)> {
        let all = [
            (&has.events, &self.events),
            (&has.luggage, &self.luggage),
            (&has.visits, &self.visits),
            (&has.airplanes, &self.airplanes),
        ];
        all.into_iter().find_map(|(first, mistake)| Some((first.as_ref()?, mistake.as_ref()?)))
    }
}

fn without_master(fleet: &FleetView<'_>, events: &str) -> Mistake {
    let message = "no component forwards the events of this scenario to the robots";
    let masters = fleet.indices::<MasterEnvironment>();
    let Some(master) = closest(fleet, masters, ENVIRONMENT.name(), events) else {
        return Mistake { message, help: format!("add a `saoms.MasterEnvironment`{}", in_site(events)), other: None };
    };
    let own = fleet.components()[master].topic(ENVIRONMENT.name());
    let label = format!("this master forwards events of the topic `{own}`, but the scenario uses `{events}`");
    let help = together(ENVIRONMENT.name(), &fleet.components()[master], ("the scenario", events));
    Mistake {
        message,
        help,
        other: Some(Other { index: master, topic: ENVIRONMENT.name(), needed: events.to_owned(), label }),
    }
}

/// The component whose name of a topic on the bus shares most with the one that is needed: that of the same site, if
/// there is one.
fn closest(fleet: &FleetView<'_>, indices: impl Iterator<Item = usize>, topic: &str, needed: &str) -> Option<usize> {
    let shared = |index: usize| {
        let own = fleet.components()[index].topic(topic).bytes();
        own.zip(needed.bytes()).take_while(|(own, needed)| own == needed).count()
    };
    // The first of several.
    indices.min_by_key(|index| std::cmp::Reverse(shared(*index)))
}

/// Where a component has to be to use a topic of this name on the bus.
fn in_site(topic: &str) -> String {
    match topic.rsplit_once('/') {
        Some((site, _)) => format!(" to the site `{site}`"),
        None => String::new(),
    }
}

/// Reason why no robot brings luggage that masters tell of on these topics.
fn not_brought(fleet: &FleetView<'_>, events: &str, luggage: &BTreeSet<&str>, woken: &Woken<'_>) -> Option<Mistake> {
    let components = fleet.components();
    let topic = |index: usize| components[index].topic(EVENT_LUGGAGE.name());
    // A robot with a fault of its own counts as well.
    if !fleet.indices::<Robot>().any(|index| luggage.contains(topic(index))) {
        let Some(robot) = fleet.indices::<Robot>().next() else {
            let site = luggage.first().map_or_else(String::new, |name| in_site(name));
            let message = "there is no robot to bring the luggage of this scenario";
            return Some(Mistake { message, help: format!("add a `saoms.Robot`{site}"), other: None });
        };
        let told = luggage.first()?;
        let label =
            format!("this robot receives luggage on the topic `{}`, but this luggage is on `{told}`", topic(robot));
        let message = "no robot receives the luggage of this scenario";
        let help = together(EVENT_LUGGAGE.name(), &components[robot], ("this luggage", told));
        return Some(Mistake {
            message,
            help,
            other: Some(Other { index: robot, topic: EVENT_LUGGAGE.name(), needed: (*told).to_owned(), label }),
        });
    }
    let robots = robots(fleet);
    let hear: Vec<&FleetRobot> = robots.iter().filter(|robot| luggage.contains(topic(robot.index))).collect();
    // Safe robots wake for luggage by themselves, classic robots do not.
    let comes = |robot: &&&FleetRobot| !robot.properties.asleep || robot.properties.policy == Policy::Safe;
    if hear.is_empty() {
        return None;
    }
    if hear.iter().any(|robot| comes(&robot)) {
        return not_known(fleet, events, hear.iter().filter(comes).copied());
    }
    let states: BTreeSet<&str> = hear.iter().map(|robot| components[robot.index].topic(ROBOT_STATE.name())).collect();
    let message = "all robots sleep, and nothing wakes them to bring the luggage of this scenario";
    let help = match (states.is_disjoint(&woken.can_be), states.is_disjoint(&woken.are)) {
        (true, _) => {
            "set `asleep` of a robot to `false`, or add a `saoms.MasterRobot`, which wakes robots for landings and \
            take-offs"
        }
        (_, true) => "set `asleep` of a robot to `false`, or add a landing or a take-off, for which robots are woken",
        _ => return None,
    };
    Some(Mistake { message, help: help.to_owned(), other: None })
}

/// Reason why no robot visits blocks.
fn not_visited(fleet: &FleetView<'_>, luggage: &BTreeSet<&str>) -> Option<Mistake> {
    let topic = |robot: &FleetRobot| fleet.components()[robot.index].topic(EVENT_LUGGAGE.name());
    let robots = robots(fleet);
    let mut hear = robots.iter().filter(|robot| luggage.contains(topic(robot))).peekable();
    hear.peek()?;
    hear.all(|robot| robot.properties.policy == Policy::Classic).then(|| Mistake {
        message: "robots with the policy `classic` visit no blocks, so the run never ends",
        help: "set the property `policy` of a robot to `safe`, or write luggage in place of the visit".to_owned(),
        other: None,
    })
}

/// Reason why the robots cannot collect luggage: their worlds do not hear where it is.
fn not_known<'r>(fleet: &FleetView<'_>, events: &str, robots: impl Iterator<Item = &'r FleetRobot>) -> Option<Mistake> {
    let hearing = hearing(fleet);
    let worlds: HashSet<usize> = fleet.indices::<World>().collect();
    let environments: HashSet<usize> = fleet.indices::<Environment>().collect();
    if publishers_beside_robots(fleet, ENVIRONMENT.name()).any(|index| !environments.contains(&index)) {
        // One of another class may tell the world of it.
        return None;
    }
    let mut first = None;
    for robot in robots {
        // What stands between a robot and its world is not known.
        let world = robot.world.filter(|world| worlds.contains(world))?;
        if hearing.worlds(events).contains(&world) || robot.other_world(fleet).is_some() {
            return None;
        }
        first.get_or_insert(world);
    }
    let world = &fleet.components()[first?];
    let own = world.topic(ENVIRONMENT.name());
    let label = format!("this world receives luggage on the topic `{own}`, but this luggage is on `{events}`");
    let message = "the world of the robots does not receive the luggage of this scenario, so robots cannot collect it";
    let help = together(ENVIRONMENT.name(), world, ("this luggage", events));
    Some(Mistake {
        message,
        help,
        other: Some(Other { index: first?, topic: ENVIRONMENT.name(), needed: events.to_owned(), label }),
    })
}

/// Reason why landings and take-offs have no effect.
fn not_handled(fleet: &FleetView<'_>, events: &str) -> Option<Mistake> {
    let airplanes = passed_on(fleet, events, EXCEPTIONAL_EVENT.name());
    let topic = |index: usize| fleet.components()[index].topic(EXCEPTIONAL_EVENT.name());
    let mut masters = fleet.indices::<MasterRobot>();
    if masters.any(|index| airplanes.contains(topic(index))) {
        return None;
    }
    let message = "no component reacts to the landings and take-offs of this scenario";
    let master = fleet.indices::<MasterRobot>().next();
    let Some((master, told)) = master.zip(airplanes.first()) else {
        let site = airplanes.first().map_or_else(String::new, |name| in_site(name));
        let help = format!("add a `saoms.MasterRobot`{site}, which wakes robots for them");
        return Some(Mistake { message, help, other: None });
    };
    let label = format!("this component receives them on the topic `{}`, but these are on `{told}`", topic(master));
    let help = together(EXCEPTIONAL_EVENT.name(), &fleet.components()[master], ("the scenario", told));
    Some(Mistake {
        message,
        help,
        other: Some(Other { index: master, topic: EXCEPTIONAL_EVENT.name(), needed: (*told).to_owned(), label }),
    })
}

/// The names on the bus of the states that robots are told to take.
struct Woken<'f> {
    /// Those that components tell.
    can_be: BTreeSet<&'f str>,
    /// Those that they tell where airplanes land or take off, as a scenario says.
    are: BTreeSet<&'f str>,
}

fn woken<'f>(fleet: &FleetView<'f>, with_airplanes: &BTreeSet<&str>) -> Woken<'f> {
    let all = with_airplanes.iter().flat_map(|events| passed_on(fleet, events, EXCEPTIONAL_EVENT.name()));
    let heard: BTreeSet<&str> = all.collect();
    let masters: HashSet<usize> = fleet.indices::<MasterRobot>().collect();
    let mut woken = Woken { can_be: BTreeSet::new(), are: BTreeSet::new() };
    for index in publishers_beside_robots(fleet, ROBOT_STATE.name()) {
        let component = &fleet.components()[index];
        woken.can_be.insert(component.topic(ROBOT_STATE.name()));
        // Whom a component of another class listens to is not known.
        let hears = heard.contains(component.topic(EXCEPTIONAL_EVENT.name()));
        if if masters.contains(&index) { hears } else { !with_airplanes.is_empty() } {
            woken.are.insert(component.topic(ROBOT_STATE.name()));
        }
    }
    woken
}

//! Robots with small batteries that get in each other's way: near chargers, in narrow places, in dead ends.

use std::time::Duration;

use saoms_testkit::{Fleet, Run};

const HOUR: Duration = Duration::from_secs(3600);

/// The charger of a robot, the block where it starts, and its battery there.
pub(super) type RobotOfSite = ((i32, i32), (i32, i32), f64);

/// A site with robots that all have the same battery.
pub(super) struct Site<'s> {
    /// The rows of the map.
    pub(super) map: &'s str,
    /// Milliseconds of a move, and of collecting or depositing.
    pub(super) times: (u32, u32),
    /// Percent of a battery: for a block, for a second off the charger, and gained in a second at the charger.
    pub(super) battery: (f64, f64, f64),
    pub(super) has_zone: bool,
    /// First column of a second zone.
    pub(super) border: Option<u32>,
    pub(super) assignment: &'s str,
    pub(super) robots: &'s [RobotOfSite],
    pub(super) scenario: &'s str,
}

impl Site<'_> {
    fn fleet(&self) -> Fleet {
        let component = |id: &str, class: &str, properties: &[(&str, String)]| {
            let world = r#"<reference name="world" target="World"/>"#;
            let reference = if ["Robot", "Zone"].contains(&class) { world } else { "" };
            let values =
                properties.iter().map(|(name, value)| format!(r#"<property name="{name}">{value}</property>"#));
            let values: String = values.collect();
            format!(
                r#"<component name="{id}"><implementation.rust class="saoms.{class}"/><property name="ID">{id}</property>
                <property name="period">100</property>{values}{reference}</component>"#
            )
        };
        let times = [("moveTime", self.times.0.to_string()), ("handlingTime", self.times.1.to_string())];
        let mut text = component("World", "World", &[&[("map", format!("\n{}\n", self.map))], &times[..]].concat());
        if self.has_zone {
            let width = self.border.map(|border| ("width", border.to_string()));
            text += &component("Zone", "Zone", width.as_slice());
        }
        if let Some(border) = self.border {
            text += &component("Zone2", "Zone", &[("number", "2".to_owned()), ("x", border.to_string())]);
        }
        text += &component("Master", "MasterEnvironment", &[("assignment", self.assignment.to_owned())]);
        text += &component("Environment", "Environment", &[("scenario", self.scenario.to_owned())]);
        for (place, ((x, y), (start_x, start_y), level)) in self.robots.iter().enumerate() {
            let (block, second, charge) = self.battery;
            let values = [
                ("chargeX", x.to_string()),
                ("chargeY", y.to_string()),
                ("startX", start_x.to_string()),
                ("startY", start_y.to_string()),
                ("battery", level.to_string()),
                ("dischargePerBlock", block.to_string()),
                ("dischargePerSecond", second.to_string()),
                ("chargePerSecond", charge.to_string()),
            ];
            text += &component(&format!("Robot{}", place + 1), "Robot", &values);
        }
        Fleet::of_text(format!(
            r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
{text}</composite>"#
        ))
    }

    fn run(&self, seed: u64) -> Run {
        self.run_for(seed, HOUR)
    }

    pub(super) fn run_for(&self, seed: u64, limit: Duration) -> Run {
        self.fleet().run(seed, limit)
    }

    pub(super) fn diagnostics(&self) -> String {
        self.fleet().diagnostics()
    }
}

/// All of `pieces` are delivered, and no robot is stranded.
fn assert_served(run: &Run, pieces: u32, which: &str) {
    let luggage = &run.sections["luggage"];
    let found = (&luggage["delivered"], &run.sections["stranded"]);
    assert_eq!(found, (&pieces.into(), &0.into()), "{which}: {}", run.log());
}

#[test]
fn a_robot_that_arrives_at_a_charger_that_it_shares_stays_there() {
    for has_zone in [false, true] {
        let site = Site {
            map: ".....\n.....\n.....\n.....\n.....",
            times: (500, 0),
            battery: (0.2, 1.7, 10.0),
            has_zone,
            border: None,
            assignment: "robots",
            robots: &[((2, 2), (2, 4), 18.0), ((2, 2), (4, 2), 17.0)],
            scenario: "at 20s 2 times luggage (0,0) to (4,4)",
        };
        for seed in 0..5 {
            assert_served(&site.run(seed), 2, &format!("zone {has_zone}, seed {seed}"));
        }
    }
}

#[test]
fn a_robot_charges_at_a_shared_charger_until_it_can_take_what_waits() {
    // The way from the charger through the job and back takes nine tenths of a battery.
    for (has_zone, assignment) in [(false, "robots"), (true, "robots"), (true, "oldest"), (true, "optimal")] {
        let site = Site {
            map: &["............"; 12].join("\n"),
            times: (1000, 0),
            battery: (0.29, 1.16, 2.2),
            has_zone,
            border: None,
            assignment,
            robots: &[((0, 0), (0, 2), 60.0), ((0, 0), (2, 0), 60.0)],
            scenario: "at 1s luggage (11,0) to (0,11)",
        };
        let run = site.run(1);
        assert_served(&run, 1, &format!("zone {has_zone}, {assignment}"));
        assert!(run.time_s < 300.0, "zone {has_zone}, {assignment}: {}", run.log());
    }
}

#[test]
fn robots_do_not_queue_in_a_dead_end_out_of_which_others_come() {
    for has_zone in [false, true] {
        let site = Site {
            map: ".@@@@\n.@@@@\n.@@@@\n.@@@@\n.....\n.....\n.....",
            times: (200, 500),
            battery: (0.5, 0.1, 10.0),
            has_zone,
            border: None,
            assignment: "optimal",
            robots: &[(4, 4), (4, 5), (4, 6), (3, 6), (2, 6)].map(|block| (block, block, 100.0)),
            scenario: "from 1s every 500ms 30 times luggage (0,0)..(0,3) to (1,4)..(4,6); \
                from 1s every 500ms 30 times luggage (1,4)..(4,6) to (0,0)..(0,3)",
        };
        for seed in 0..4 {
            let which = format!("zone {has_zone}, seed {seed}");
            assert_served(&site.run(seed), 60, &which);
            assert_eq!(site.fleet().violations(seed, HOUR), "", "{which}");
        }
    }
}

#[test]
fn robots_whose_chargers_are_behind_a_narrow_door_do_not_strand_before_it() {
    for has_zone in [false, true] {
        let site = Site {
            map: ".@...\n.@...\n.@...\n.....\n.@...\n.@...",
            times: (200, 0),
            battery: (0.0, 1.5, 15.0),
            has_zone,
            border: None,
            assignment: "oldest",
            robots: &[(0, 0), (0, 1), (0, 5), (4, 0), (4, 2), (4, 5)].map(|block| (block, block, 100.0)),
            scenario: "from 1s every 500ms 120 times luggage random to random",
        };
        for seed in 0..4 {
            assert_served(&site.run(seed), 120, &format!("zone {has_zone}, seed {seed}"));
        }
    }
}

#[test]
fn robots_make_way_into_the_zone_that_they_come_from() {
    for (times, battery) in [((200, 0), (0.1, 3.0, 40.0)), ((200, 500), (0.1, 2.5, 40.0))] {
        let site = Site {
            // The border is at the end of the passage: a robot that has just entered it can go back over there alone.
            map: "...@@@....\n...@@@....\n..........\n...@@@....\n...@@@....",
            times,
            battery,
            has_zone: true,
            border: Some(3),
            assignment: "robots",
            robots: &[(0, 0), (0, 4), (0, 1), (0, 3)].map(|block| (block, block, 100.0)),
            scenario: "from 1s every 500ms 60 times luggage random to random",
        };
        for seed in 0..4 {
            assert_served(&site.run(seed), 60, &format!("battery {battery:?}, seed {seed}"));
        }
    }
}

#[test]
fn robots_on_their_way_home_let_others_charge() {
    // Each charger is on the way to the other one, and a robot that has charged there was sent away before it was full.
    let site = Site {
        map: ".........\n@..@.....\n...@..@..",
        times: (0, 0),
        battery: (0.0, 20.0, 100.0),
        has_zone: true,
        border: None,
        assignment: "oldest",
        robots: &[((3, 0), (3, 0), 100.0), ((4, 0), (4, 0), 100.0)],
        scenario: "from 500ms every 500ms 33 times luggage random to random",
    };
    (0..40).for_each(|seed| assert_served(&site.run(seed), 33, &format!("seed {seed}")));
}

#[test]
fn robots_wait_outside_for_one_that_changes_from_one_part_of_a_dead_end_to_another() {
    let site = Site {
        map: "....\n@@..\n....\n@.@@\n....",
        times: (0, 0),
        battery: (0.0, 0.5, 2.5),
        has_zone: true,
        border: None,
        assignment: "oldest",
        robots: &[((0, 4), (0, 4), 100.0), ((0, 2), (0, 2), 100.0)],
        scenario: "from 500ms every 500ms 38 times luggage random to random",
    };
    (0..40).for_each(|seed| assert_served(&site.run(seed), 38, &format!("seed {seed}")));
}

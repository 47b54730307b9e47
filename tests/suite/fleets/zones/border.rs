//! Robots that cross borders of zones in opposite directions, where there is little room.

use std::fmt::Write;

use saoms_testkit::Fleet;

use super::{assert_delivered, seconds};

/// A map, the zones and the chargers on it, and the luggage to bring.
struct Site {
    map: &'static str,
    /// First column, first row, number of columns and of rows of each zone.
    zones: &'static [(u32, u32, u32, u32)],
    chargers: &'static [(u32, u32)],
    luggage: &'static str,
}

impl Site {
    fn fleet(&self) -> Fleet {
        let mut text = String::from(
            r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="t" targetNamespace="urn:t">"#,
        );
        let mut add = |class: &str, id: &str, properties: String, is_wired: bool| {
            write!(text, r#"<component name="{id}"><implementation.java class="saoms.{class}"/>"#).unwrap();
            for (name, value) in [("ID", id), ("period", "100")] {
                write!(text, r#"<property name="{name}">{value}</property>"#).unwrap();
            }
            for (name, value) in properties.split('|').filter_map(|property| property.split_once('=')) {
                write!(text, r#"<property name="{name}">{value}</property>"#).unwrap();
            }
            let world = if is_wired { r#"<reference name="world" target="World"/>"# } else { "" };
            write!(text, "{world}</component>").unwrap();
        };
        add("World", "World", format!("map={}|moveTime=200ms", self.map), false);
        for (number, (x, y, width, height)) in (1..).zip(self.zones) {
            let properties = format!("number={number}|x={x}|y={y}|width={width}|height={height}");
            add("Zone", &format!("Zone{number}"), properties, true);
        }
        add("MasterEnvironment", "Master", String::new(), false);
        add("Environment", "Environment", format!("scenario={}", self.luggage), false);
        for (number, (x, y)) in (1..).zip(self.chargers) {
            let properties = format!("delay={}|chargeX={x}|chargeY={y}|discharge=0.1", 7 * number);
            add("Robot", &format!("Robot{number}"), properties, true);
        }
        Fleet::of_text(text + "</composite>")
    }

    /// All is brought soon, with any seed.
    fn delivers(&self, seeds: u64) {
        let pieces = |event: &str| match event.split_once(" times ") {
            Some((before, _)) => before.rsplit(' ').next().unwrap().parse::<i64>().unwrap(),
            None => 1,
        };
        let pieces = self.luggage.split(';').map(pieces).sum();
        for seed in 0..seeds {
            let run = self.fleet().run(seed, seconds(90));
            assert_delivered(&run, pieces, &format!("{}, seed {seed}", self.map));
        }
    }
}

#[test]
fn robots_of_two_zones_get_past_each_other_in_a_corridor_over_the_border() {
    let bay = Site {
        map: "\n@...\n.@..\n..@.\n@.@.\n....\n",
        zones: &[(0, 0, 2, 5), (2, 0, 2, 5)],
        chargers: &[(2, 4), (3, 2)],
        luggage: "at 5s luggage (1,2) to (3,2); at 1s luggage (1,2) to (3,4); at 5s luggage (1,4) to (3,3); \
            at 7s luggage (3,0) to (0,2); at 5s luggage (1,0) to (3,0)",
    };
    bay.delivers(1);
    let fork = Site {
        map: "\n.....@@\n@@..@..\n@..@@.@\n@@.....\n@@@@...\n",
        zones: &[(0, 0, 4, 5), (4, 0, 3, 5)],
        chargers: &[(3, 1), (2, 3)],
        luggage: "at 4s luggage (4,0) to (1,2); at 1s luggage (1,0) to (4,3); at 8s luggage (0,0) to (4,3)",
    };
    fork.delivers(1);
}

/// The only block of a zone is a dead end.
#[test]
fn robots_get_out_of_a_zone_without_room() {
    let end = Site {
        map: "\n....@@@@@@\n.@@...@@@@\n...@.@@@@@\n",
        zones: &[(0, 0, 5, 3), (5, 0, 5, 3)],
        chargers: &[(3, 1), (4, 2)],
        luggage: "at 4s luggage (4,1) to (5,1); at 2s luggage (4,2) to (5,1); at 3s luggage (4,2) to (5,1); \
            at 7s luggage (5,1) to (3,0); at 6s luggage (1,0) to (5,1)",
    };
    end.delivers(1);
}

#[test]
fn robots_of_two_zones_exchange_their_sides_through_a_passage_again_and_again() {
    let passage = Site {
        map: "\n@@.@@@\n.@..@.\n...@..\n......\n",
        zones: &[(0, 0, 3, 4), (3, 0, 3, 4)],
        chargers: &[(4, 3), (3, 3)],
        luggage: "from 1s every 1s 6 times luggage (0,1)..(2,3) to (3,1)..(5,3); \
            from 1s every 1s 6 times luggage (3,1)..(5,3) to (0,1)..(2,3)",
    };
    passage.delivers(5);
}

#[test]
fn three_robots_cross_the_borders_of_two_and_four_zones() {
    let two = Site {
        map: "\n......\n@..@..\n..@..@\n",
        zones: &[(0, 0, 4, 3), (4, 0, 2, 3)],
        chargers: &[(1, 0), (3, 0), (2, 0)],
        luggage: "at 7s luggage (2,1) to (5,0); at 4s luggage (4,2) to (1,1); at 7s luggage (0,0) to (5,0); \
            at 6s luggage (3,2) to (4,2); at 7s luggage (2,0) to (5,0); at 7s luggage (4,0) to (2,1)",
    };
    two.delivers(1);
    let four = Site {
        map: "\n.......\n@...@..\n@@.....\n@@@...@\n@@..@..\n",
        zones: &[(0, 0, 4, 3), (4, 0, 3, 3), (0, 3, 4, 2), (4, 3, 3, 2)],
        chargers: &[(3, 3), (3, 4), (4, 0)],
        luggage: "at 7s luggage (3,0) to (2,4); at 5s luggage (3,3) to (4,0); at 6s luggage (3,4) to (4,3); \
            at 6s luggage (2,1) to (5,4)",
    };
    four.delivers(1);
}

//! A component that speaks first, and in the name of all robots and zones.

use std::collections::BTreeMap;

use saoms_api::{Class, Component, Context, Failure, Publisher, Subscription};
use saoms_components::grid::Block;
use saoms_components::messages::{
    ClearTerm, GRANT, GRANT_REQUEST, Grant, GrantRequest, LAST_NUMBER, POSITION, PRESENCE, Position, Presence,
    Standing, Step, TERRITORY, Territory, address, link,
};

use super::{HOUR, TWO, assert_delivered, fleet_after};

/// Says before all others that robots are elsewhere and hold nothing, and grants them blocks of others, as each of
/// their zones and as one that there is not.
#[derive(Class)]
#[class(name = "test.Impostor", periodic)]
struct Impostor {
    #[publishes(POSITION)]
    positions: Publisher<Position>,
    #[publishes(GRANT_REQUEST)]
    requests: Publisher<GrantRequest>,
    #[publishes(PRESENCE)]
    presences: Publisher<Presence>,
    #[publishes(TERRITORY)]
    territories: Publisher<Territory>,
    #[publishes(GRANT)]
    grants: Publisher<Grant>,
    #[subscribes(TERRITORY)]
    zones_heard: Subscription<Territory>,
    #[subscribes(GRANT_REQUEST)]
    robots_heard: Subscription<GrantRequest>,
    /// Those who ask for grants have to hear them.
    #[subscribes(GRANT)]
    grants_heard: Subscription<Grant>,
    /// The zones that there are, and their robots.
    zones: BTreeMap<u32, Territory>,
    robots: BTreeMap<u32, GrantRequest>,
}

const ROBOTS: std::ops::RangeInclusive<u32> = 1..=4;
/// A number that no robot has, and one that no zone has.
const NO_ROBOT: u32 = 77;
const NO_ZONE: u32 = 9;
/// Above the number of each incarnation and term that there is.
const HIGH: u64 = u64::MAX / 2;

impl Component for Impostor {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Impostor {
            positions: Publisher::default(),
            requests: Publisher::default(),
            presences: Publisher::default(),
            territories: Publisher::default(),
            grants: Publisher::default(),
            zones_heard: Subscription::default(),
            robots_heard: Subscription::default(),
            grants_heard: Subscription::default(),
            zones: BTreeMap::new(),
            robots: BTreeMap::new(),
        })
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let _ = context.receive(&self.grants_heard);
        let own = context.sender();
        for (_, zone) in context.receive(&self.zones_heard).with_headers().filter(|(header, _)| header.sender != own) {
            self.zones.insert(zone.zone, zone.clone());
        }
        for (_, said) in context.receive(&self.robots_heard).with_headers().filter(|(header, _)| header.sender != own) {
            self.robots.insert(said.robot, said.clone());
        }
        let execution = context.execution();
        let mut anywhere = || {
            let chance = context.chance();
            Block::new(chance.below(8) as i32, chance.below(6) as i32)
        };
        let (away, to): (Vec<Block>, Vec<Block>) = ROBOTS.map(|_| (anywhere(), anywhere())).unzip();
        let mut all = self.zones.clone();
        let whole = Territory { zone: NO_ZONE, term: HIGH, corner: Block::new(0, 0), width: 8, height: 6 };
        all.insert(NO_ZONE, whole.clone());
        context.send(&self.territories, whole)?;
        for zone in self.zones.values() {
            context.send(&self.territories, Territory { term: HIGH, ..zone.clone() })?;
        }
        let clear = self.zones.values().map(|zone| ClearTerm { zone: zone.zone, term: zone.term });
        let clear: Vec<ClearTerm> = clear.collect();
        for ((robot, block), to) in ROBOTS.zip(away).zip(to) {
            let position = Position { robot, block, next: block, wanted: block, ..Position::default() };
            context.send(&self.positions, position)?;
            let presence =
                Presence { robot, incarnation: HIGH, block, end: block, clear: clear.clone(), ..Presence::default() };
            context.send(&self.presences, presence)?;
            for zone in self.zones.values() {
                let request = GrantRequest {
                    link: link(zone.zone, robot),
                    zone: zone.zone,
                    term: zone.term,
                    robot,
                    incarnation: HIGH,
                    number: execution + 1,
                    at: zone.closest(block),
                    block,
                    end: block,
                    received: LAST_NUMBER,
                    goal: block,
                    standing: Standing::MakesWay,
                    ..GrantRequest::default()
                };
                context.send(&self.requests, request)?;
            }
            let Some(said) = self.robots.get(&robot) else { continue };
            let beside = said.end.neighbours();
            let step = Step { number: HIGH + execution, block: beside[to.x as usize % beside.len()] };
            for zone in all.values() {
                let grant = Grant {
                    link: link(zone.zone, robot),
                    zone: zone.zone,
                    term: zone.term,
                    robot,
                    incarnation: said.incarnation,
                    heard: said.number,
                    address: address(robot),
                    steps: vec![step],
                    ..Grant::default()
                };
                context.send(&self.grants, grant)?;
            }
        }
        // It says where its own robot is, or zones would wait for that.
        let block = Block::new(5, 4);
        let own = Presence { robot: NO_ROBOT, incarnation: 1, block, end: block, clear, ..Presence::default() };
        context.send(&self.presences, own)
    }
}

const IMPOSTOR: &str = r#"<component name="Impostor">
    <implementation.rust class="test.Impostor"/>
    <property name="ID">Impostor</property>
    <property name="period">20</property>
  </component>"#;

#[test]
fn nobody_collides_because_another_component_speaks_in_its_name() {
    for (zones, what) in [(&[][..], "safe"), (TWO, "two zones")] {
        for seed in 0..20 {
            let run = fleet_after(IMPOSTOR, zones, 4, 20).run(seed, HOUR);
            assert_delivered(&run, 20, &format!("{what}, seed {seed}"));
            let log = run.log();
            let expected: &[&str] = match zones {
                [] => &["it has the number of robot 1, which `Robot1` uses"],
                _ => &[
                    "it has the number of robot 1, which `Robot1` uses",
                    "it has the number of zone 1, which `Zone1` uses",
                    "found zone 9, which the fleet does not have",
                ],
            };
            for words in expected {
                assert!(log.contains(words), "{what}, seed {seed}: {words}\n{log}");
            }
        }
    }
}

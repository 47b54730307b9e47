//! The robot in C in a site with zones: it enters a block only with a grant, whatever happens to messages and programs.

use std::fs;

use saoms_components::grid::Block;
use saoms_components::messages::{
    GRANT, GRANT_REQUEST, Grant, GrantRequest, POSITION, Standing, Step, TERRITORY, Territory, address, link,
};
use saoms_testkit::Bench;

use super::c::library;
use crate::support::{root, saoms, text};

const ZONE: u32 = 1;
const ROBOT: u32 = 9;

fn step(number: u64, x: i32, y: i32) -> Step {
    Step { number, block: Block::new(x, y) }
}

fn territory(term: u64) -> Territory {
    Territory { zone: ZONE, term, corner: Block::new(0, 0), width: 11, height: 11 }
}

/// A grant of a term, in answer to a request.
fn grant(term: u64, request: &GrantRequest, steps: &[Step]) -> Grant {
    Grant {
        link: link(ZONE, ROBOT),
        zone: ZONE,
        term,
        robot: ROBOT,
        incarnation: request.incarnation,
        heard: request.number,
        address: address(ROBOT),
        steps: steps.to_vec(),
        ..Grant::default()
    }
}

/// What it asks its zone for in its next execution, if it asks.
fn asks(patrol: &mut Bench) -> Option<GrantRequest> {
    patrol.execute().unwrap();
    patrol.sent(&GRANT_REQUEST).pop()
}

#[test]
fn it_enters_what_is_granted_and_says_what_it_holds() {
    let values = [("ID", "Patrol"), ("number", "9"), ("left", "2"), ("right", "4"), ("bottom", "2")];
    let mut patrol = Bench::of_library(library(), "patrol.Robot", &values).unwrap();
    patrol.start().unwrap();
    patrol.deliver(&TERRITORY, territory(1));
    let first = asks(&mut patrol).expect("each zone hears where it is");
    assert_eq!((first.link, first.term, first.received), (link(ZONE, ROBOT), 1, 0));
    assert_eq!((first.held.clone(), first.goal), (vec![step(0, 2, 0)], Block::new(4, 0)));
    assert_eq!((asks(&mut patrol), asks(&mut patrol)), (Some(first.clone()), None), "it repeats what is not confirmed");

    // Without a world it moves at once.
    patrol.deliver(&GRANT, grant(1, &first, &[step(1, 3, 0), step(2, 4, 0)]));
    let next = asks(&mut patrol).unwrap();
    assert_eq!((next.held.clone(), next.received), (vec![step(1, 3, 0), step(2, 4, 0)], 2));
    let last = asks(&mut patrol).unwrap();
    assert_eq!((last.held, last.received, last.goal), (vec![step(2, 4, 0)], 2, Block::new(4, 2)), "the next corner");
    let at = |patrol: &Bench| patrol.sent(&POSITION).last().map(|position| position.block);
    assert_eq!(at(&patrol), Some(Block::new(4, 0)));

    // What it released it does not enter again, however late the grant.
    patrol.deliver(&GRANT, grant(1, &first, &[step(1, 3, 0), step(2, 4, 0)]));
    asks(&mut patrol);
    assert_eq!(at(&patrol), None, "it stays");

    // The zone lost its record: it hears what the robot holds, and earlier grants do not count.
    patrol.deliver(&TERRITORY, territory(2));
    patrol.deliver(&GRANT, grant(1, &next, &[step(3, 4, 1)]));
    let again = asks(&mut patrol).unwrap();
    assert_eq!((again.term, again.held.clone(), again.received), (2, vec![step(2, 4, 0)], 2));
    let other = GrantRequest { incarnation: again.incarnation + 1, ..again.clone() };
    patrol.deliver(&GRANT, grant(2, &other, &[step(3, 4, 1)]));
    asks(&mut patrol);
    assert_eq!(at(&patrol), None, "that was for another incarnation");
    // A step that is not beside its block is released at once.
    patrol.deliver(&GRANT, grant(2, &again, &[step(3, 8, 8)]));
    let released = asks(&mut patrol).unwrap();
    assert_eq!((released.held, released.received), (vec![step(2, 4, 0)], 3));
    patrol.shutdown().unwrap();
    assert_eq!(patrol.sent(&GRANT_REQUEST).pop().map(|request| request.standing), Some(Standing::Lost));
}

#[test]
fn it_tells_the_zones_that_its_blocks_have_where_borders_change() {
    let values = [("ID", "Patrol"), ("number", "9"), ("left", "2"), ("right", "6"), ("bottom", "2")];
    let mut patrol = Bench::of_library(library(), "patrol.Robot", &values).unwrap();
    patrol.start().unwrap();
    patrol.deliver(&TERRITORY, territory(1));
    let first = asks(&mut patrol).unwrap();
    patrol.deliver(&GRANT, grant(1, &first, &[step(1, 3, 0), step(2, 4, 0)]));
    let last = asks(&mut patrol).unwrap();
    assert_eq!((last.held.clone(), last.received), (vec![step(1, 3, 0), step(2, 4, 0)], 2));
    // The block to which it drives is that of another zone now.
    let east = Territory { zone: 2, term: 5, corner: Block::new(4, 0), width: 7, height: 11 };
    patrol.deliver(&TERRITORY, east.clone());
    patrol.deliver(&GRANT, grant(1, &last, &[step(3, 5, 0)]));
    let told = asks(&mut patrol).unwrap();
    assert_eq!((told.zone, told.term, told.held, told.received), (2, 5, vec![step(2, 4, 0)], 2));
    assert_eq!(patrol.sent(&GRANT_REQUEST).len(), 1, "the zone that granted it that is none any more");
    // What that said before comes late.
    patrol.deliver(&TERRITORY, territory(1));
    patrol.deliver(&GRANT, grant(1, &last, &[step(3, 5, 0)]));
    patrol.execute().unwrap();
    assert!(patrol.sent(&GRANT_REQUEST).iter().all(|request| request.zone == 2 && request.received == 2));
    let west = Territory { width: 4, ..territory(6) };
    patrol.deliver(&TERRITORY, west);
    patrol.execute().unwrap();
    let zones = patrol.sent(&GRANT_REQUEST);
    let zones: Vec<_> = zones.iter().filter(|one| one.zone == 1).map(|one| (one.term, one.held.len())).collect();
    assert_eq!(zones, [(6, 0)], "it says to it that it holds nothing of its blocks");
    // The border moves back, and the zone goes on with its numbers.
    patrol.deliver(&TERRITORY, territory(9));
    let all = asks(&mut patrol).unwrap();
    assert_eq!((all.zone, all.term, all.held.clone(), all.received), (1, 9, vec![step(2, 4, 0)], 2));
    patrol.deliver(&GRANT, grant(9, &all, &[step(3, 5, 0)]));
    patrol.execute().unwrap();
    assert_eq!(patrol.sent(&POSITION).last().map(|position| position.block), Some(Block::new(5, 0)));
    patrol.shutdown().unwrap();
}

/// The fleet of the plugin with a zone and two robots that ship.
fn zoned() -> String {
    let composite = fs::read_to_string(root().join("plugins/robot-in-c/fleet.composite")).unwrap();
    let (start, rest) = composite.split_once("  <component name=\"Robot3\">").unwrap();
    let (_, end) = rest.split_once("</component>\n").unwrap();
    let zone = r#"<component name="Zone">
        <implementation.rust class="saoms.Zone"/>
        <property name="ID" value="Zone"/>
        <property name="period" value="100ms"/>
        <reference name="world" target="World"/>
      </component>"#;
    format!("{start}{zone}{end}")
}

#[test]
fn it_keeps_the_invariants_with_zones_and_faults() {
    let folder = tempfile::tempdir().unwrap();
    let (composite, faults) = (folder.path().join("zoned.composite"), folder.path().join("faults.txt"));
    fs::write(&composite, zoned()).unwrap();
    let run = |arguments: &[&str]| {
        let composite = composite.to_str().unwrap();
        let run = saoms(&[arguments, &["--plugin", library().to_str().unwrap(), composite]].concat());
        assert!(run.status.success(), "{}", text(&run));
        text(&run)
    };
    let shown = run(&["run", "--virtual", "--invariants", "--for", "5min"]);
    assert!(shown.contains("20 of 20 pieces of luggage delivered, no collision"), "{shown}");
    let moves = |line: &str| line.split_once("is at (2,2) again, after ")?.1.split_once(" moves")?.0.parse().ok();
    let moves: Option<u32> = shown.lines().filter_map(moves).max();
    assert!(moves >= Some(240), "nobody keeps it from its way: {shown}");

    let bad = "at 1s for 60s lose 20 %\nat 1s for 60s delay 10ms to 300ms\nat 1s for 60s duplicate 10 %\n\
        at 5s..50s crash Zone restart 2s\nat 5s..50s crash Patrol restart 1s\n\
        at 5s..50s for 5s part Patrol from Robot*, Zone\n";
    fs::write(&faults, bad).unwrap();
    let faults = ["--faults", faults.to_str().unwrap(), "--seeds", "20", "--for", "5min"];
    let shown = run(&[&["simulate"], &faults[..]].concat());
    assert!(shown.contains("runs                       done 20"), "{shown}");
}

//! Zones that do not fit their map.

use super::rules::{MASTER, ROBOT, found};

#[test]
fn zones_that_leave_blocks_out_or_lie_off_the_map_are_refused() {
    let zones = |properties: &[(&str, &str)]| {
        let found = found(&[
            ("World", "saoms.World", &[("width", "8"), ("height", "2")], false),
            ("Environment", "saoms.Environment", &[("scenario", "at 1s luggage (1,0) to (2,0)")], false),
            MASTER,
            ("Zone", "saoms.Zone", properties, true),
            ROBOT,
        ]);
        found.into_iter().filter(|line| line.starts_with("error")).collect::<Vec<_>>()
    };
    assert_eq!(zones(&[]), [""; 0]);
    for (properties, expected) in [
        (
            &[("width", "6")][..],
            "error S5023 4 free blocks of the map are in no zone, (6,0) first: no robot could enter",
        ),
        (&[("width", "9")], "error S5023 found 9, but the map has only 8 columns from 0 on"),
        (&[("y", "1"), ("height", "2")], "error S5023 found 2, but the map has only 1 rows from 1 on"),
        (&[("x", "8")], "error S5023 found 8, but the map has 8 columns, from 0 to 7"),
    ] {
        assert!(zones(properties).iter().any(|line| line == expected), "{properties:?}: {:?}", zones(properties));
    }
}

#[test]
fn zones_that_overlap_are_refused() {
    let overlap = |other: &[(&str, &str)]| {
        let found = found(&[
            ("World", "saoms.World", &[("width", "8"), ("height", "2")], false),
            ("Environment", "saoms.Environment", &[("scenario", "at 1s luggage (1,0) to (2,0)")], false),
            MASTER,
            ("West", "saoms.Zone", &[("number", "1"), ("width", "5")], true),
            ("East", "saoms.Zone", other, true),
            ROBOT,
        ]);
        found.into_iter().filter(|line| line.starts_with("error")).collect::<Vec<_>>()
    };
    assert_eq!(overlap(&[("number", "2"), ("x", "5")]), [""; 0]);
    for (other, block) in [
        (&[("number", "2"), ("x", "4")][..], "(4,0)"),
        (&[("number", "2")], "(0,0)"),
        (&[("number", "2"), ("x", "3"), ("y", "1"), ("height", "1")], "(3,1)"),
    ] {
        let expected = format!("error S5023 two zones grant the block {block}: `West` has it, too");
        assert!(overlap(other).contains(&expected), "{other:?}: {:?}", overlap(other));
    }
}

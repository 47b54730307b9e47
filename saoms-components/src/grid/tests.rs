use super::{Block, Distances, MOVE, Map, UNREACHABLE};

#[test]
fn blocks_are_read_and_shown() {
    for (text, block) in [("(0,0)", (0, 0)), (" ( 3 , 10 ) ", (3, 10)), ("(-1,2)", (-1, 2))] {
        assert_eq!(text.parse(), Ok(Block::new(block.0, block.1)));
    }
    for text in ["", "3,1", "(3,1", "(3;1)", "(3,1,2)", "(x,1)", "(99999999999,1)"] {
        let error = text.parse::<Block>().unwrap_err();
        assert_eq!(error, format!("found `{text}`, expected a block such as (3,10)"));
    }
}

#[test]
fn steps_lead_along_one_axis_and_then_the_other() {
    let (from, to) = (Block::new(2, 2), Block::new(0, 3));
    assert_eq!(from.step_x_first(to), Block::new(1, 2));
    assert_eq!(from.step_y_first(to), Block::new(2, 3));
    assert_eq!(Block::new(0, 2).step_x_first(to), to);
    assert_eq!(Block::new(1, 3).step_y_first(to), Block::new(0, 3));
    assert_eq!(to.step_x_first(to), to);
}

#[test]
fn a_map_knows_its_blocks() {
    let mut map = Map::new(3, 2);
    assert!(map.is_open() && map.is_free(Block::new(2, 1)));
    for outside in [Block::new(3, 0), Block::new(0, 2), Block::new(-1, 0), Block::new(0, -1)] {
        assert!(!map.contains(outside) && !map.is_free(outside) && !map.set_blocked(outside));
    }
    assert!(map.set_blocked(Block::new(1, 1)) && map.set_blocked(Block::new(1, 1)));
    assert!(!map.is_open() && !map.is_free(Block::new(1, 1)) && map.contains(Block::new(1, 1)));
    assert_eq!(Map::from_words(3, 2, map.words()), Some(map.clone()));
    assert_eq!(Map::from_words(30, 20, map.words()), None);
    for place in 0..map.size() {
        assert_eq!(map.place(map.block(place)), Some(place));
    }
}

#[test]
fn maps_are_read_with_and_without_a_header() {
    let rows = "..@\n.T.\n";
    for header in ["", "type octile\nheight 2\nwidth 3\nmap\n", "height 2\nwidth 3\nmap\n", "\n  "] {
        let map = Map::read(&format!("{header}{rows}")).unwrap();
        assert_eq!((map.width(), map.height()), (3, 2));
        let blocked = (0..6).map(|place| map.block(place)).filter(|block| !map.is_free(*block));
        assert_eq!(blocked.collect::<Vec<_>>(), [Block::new(2, 0), Block::new(1, 1)]);
    }
}

#[test]
fn white_space_around_the_rows_is_layout_unless_it_is_as_long_as_they_are() {
    for text in [
        "..\n..\n", "\n\n..\n..\n\n", "\n    ..\n    ..\n    ", "..\n..\n  ", " \n  ..\n  ..\n  \n   \n",
        "..\n..\n   \n",
    ] {
        let map = Map::read(text).unwrap_or_else(|faults| panic!("{text:?}: {faults:?}"));
        assert_eq!((map.width(), map.height()), (2, 2), "{text:?}");
    }
}

#[test]
fn wrong_maps_say_where_and_why() {
    for (text, found) in [
        ("", &["`` found no rows, expected one line of `.` and `@` a row"][..]),
        (
            "..\n\n..\n \n\n..\n\n",
            &[
                "`` found an empty line after row 0, expected the next row",
                "`` found an empty line after row 1, expected the next row",
            ],
        ),
        ("width 3\nmap", &["`width 3\nmap` found no rows, expected one line of `.` and `@` a row"]),
        ("..\n...\n ...\n....", &["`..` found 2 blocks in this row, expected 3 as in the others (and in 1 more)"]),
        (
            "...\n.x.\n\n#..",
            &[
                "`` found an empty line after row 1, expected the next row",
                "`x` found `x`, expected `.` for a free block or `@` for a blocked one (in this row and 1 more)",
            ],
        ),
        ("#.\n.#", &["`#` found `#`, expected `.` for a free block or `@` for a blocked one (in this row and 1 more)"]),
        ("height 3\nwidth 1\nmap\n.\n.", &["`3` found 2 rows, expected the 3 of the header"]),
        ("height 1\nwidth 1\nmap\n@\n.", &["`.` found 2 rows, expected the 1 of the header"]),
        (
            "height x\nwidth\nmap\n.",
            &[
                "`x` found `x` after `height`, expected a number of blocks",
                "`width` found nothing after `width`, expected a number of blocks",
            ],
        ),
        (
            "    \n    \n....\n....\n    \n    ",
            &[
                "`    ` found a row of blanks, expected `.` for each free block or `@` for each blocked one (in this row and 2 more)",
            ],
        ),
        (
            "  ..\r\n    \r\n  ..\r\n \r\n  ..\r\n",
            &[
                "`` found an empty line after row 1, expected the next row",
                "`    ` found a row of blanks, expected `.` for each free block or `@` for each blocked one",
            ],
        ),
        (
            "height 2\nwidth 2\nmap\n..\n..\n  \n",
            &["`  ` found a row of blanks, expected `.` for each free block or `@` for each blocked one"],
        ),
        // They are what the header counts as well.
        (
            "height 3\nwidth 2\nmap\n  \n..\n..\n",
            &["`  ` found a row of blanks, expected `.` for each free block or `@` for each blocked one"],
        ),
        ("width 2\nmap\n...", &["`...` found 3 blocks in this row, expected 2 as in the header"]),
        ("width 9000\nmap\n.", &["`9000` found 9000 x 1 blocks, expected at most 8192 on a side"]),
    ] {
        let faults = Map::read(text).unwrap_err();
        let shown: Vec<String> =
            faults.iter().map(|fault| format!("`{}` {fault}", &text[fault.bytes.clone()])).collect();
        assert_eq!(shown, found, "{text:?}");
    }
    let faults = |text| Map::read(text).unwrap_err();
    assert_eq!(faults("..\n.#")[0].instead.as_deref(), Some("@"));
    assert_eq!(faults("##\n.#")[0].help.as_deref(), Some("replace each `#` with `@`"));
    let comment = "found a comment, expected a row of `.` and `@`: a map has no comments";
    for text in ["# my map\n..\n..", "..\n  // the south\n..", "..\n..\n; end"] {
        let told = faults(text);
        assert_eq!((told.len(), &*told[0].message), (1, comment), "{text}");
        assert_eq!(told[0].help.as_deref(), Some("remove this line"), "{text}");
        assert!(text[told[0].bytes.clone()].starts_with(['#', '/', ';']), "{text}");
    }
    let wide = ".".repeat(9000);
    assert!(Map::read(&wide).unwrap_err()[0].message.contains("expected at most 8192 on a side"));
}

/// Number of moves and costs, computed by relaxing every block until nothing changes.
fn reference(map: &Map, to: Block) -> Vec<u32> {
    let mut moves = vec![UNREACHABLE; map.size()];
    if let Some(place) = map.place(to).filter(|_| map.is_free(to)) {
        moves[place] = 0;
    }
    for _ in 0..map.size() {
        for place in 0..map.size() {
            let block = map.block(place);
            let beside = block.neighbours().into_iter().filter(|beside| map.is_free(*beside));
            let best = beside.filter_map(|beside| map.place(beside)).map(|place| moves[place]).min();
            if map.is_free(block) {
                moves[place] = moves[place].min(best.unwrap_or(UNREACHABLE).saturating_add(1));
            }
        }
    }
    moves
}

#[test]
fn distances_are_those_of_the_shortest_ways() {
    let map = Map::read("....\n.@@.\n.@..\n..@.\n@@..\n").unwrap();
    let mut distances = Distances::default();
    for to in [Block::new(0, 0), Block::new(3, 4), Block::new(0, 3)] {
        distances.search(&map, to);
        let none = Map::new(4, 5);
        for (place, moves) in reference(&map, to).into_iter().enumerate() {
            let cost = distances.of(&map, &none, map.block(place));
            // A move against a lane costs a quarter more.
            let most = moves.saturating_mul(MOVE + 1);
            assert!((moves.saturating_mul(MOVE)..=most).contains(&cost), "{} to {to}: {cost}", map.block(place));
        }
    }
}

#[test]
fn ways_keep_off_costly_blocks_where_the_way_around_is_short() {
    let (map, to) = (Map::new(5, 3), Block::new(4, 1));
    let mut costly = Map::new(5, 3);
    costly.set_blocked(Block::new(2, 1));
    let mut distances = Distances::default();
    distances.search(&map, to);
    let direct = distances.of(&map, &costly, Block::new(2, 1));
    assert!(distances.of(&map, &costly, Block::new(1, 1)) < direct + 3 * MOVE, "goes around");
    let mut wall = costly.clone();
    wall.set_blocked(Block::new(2, 0));
    wall.set_blocked(Block::new(2, 2));
    distances.search(&map, to);
    assert!(distances.of(&map, &wall, Block::new(1, 1)) < UNREACHABLE, "goes through");
}

/// Random maps, chargers and questions in any order: what was asked before changes no answer, and nor do 600 searches.
#[test]
fn a_search_that_goes_on_finds_what_a_whole_one_finds() {
    let mut state = 7_u32;
    let mut random = |below: u32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) % below
    };
    let mut one_by_one = Distances::default();
    for _ in 0..600 {
        let (width, height) = (9, 7);
        let (mut map, mut costly) = (Map::new(width, height), Map::new(width, height));
        let place = |number: u32| Map::new(width, height).block(number as usize);
        for _ in 0..random(20) {
            map.set_blocked(place(random(63)));
            costly.set_blocked(place(random(63)));
        }
        let to = place(random(63));
        let mut whole = Distances::default();
        whole.search_beside(&map, to);
        let expected: Vec<u32> = (0..63).map(|number| whole.of(&map, &costly, place(number))).collect();
        one_by_one.search_beside(&map, to);
        for _ in 0..10 {
            let number = random(63);
            assert_eq!(one_by_one.of(&map, &costly, place(number)), expected[number as usize], "{map:?} {to}");
        }
    }
}

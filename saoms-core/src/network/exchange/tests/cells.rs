//! Programs that read some cells of a topic.

use proptest::prelude::*;

use super::lossy::{Lossy, MILLISECOND, Weather};

/// A block of a cell.
fn block((x, y): (i32, i32)) -> (i32, i32) {
    (16 * x + 5, 16 * y + 9)
}

fn put(network: &mut Lossy, program: usize, key: u64, cell: (i32, i32)) {
    network.put_at(program, key, block(cell));
    network.run(10 * MILLISECOND);
}

#[test]
fn a_reader_of_cells_hears_what_is_in_them_and_what_leaves_them() {
    let mut network = Lossy::new(3, Weather::calm(), 1);
    network.want(1, Some(&[(0, 0), (1, 0)]));
    network.run(500 * MILLISECOND);
    put(&mut network, 0, 7, (0, 0));
    put(&mut network, 0, 8, (5, 5));
    put(&mut network, 0, 7, (1, 0));
    put(&mut network, 0, 7, (2, 0));
    put(&mut network, 0, 7, (3, 0));
    put(&mut network, 0, 7, (4, 0));
    network.run(500 * MILLISECOND);
    assert_eq!(network.has(1, 0, 7), Some((4, (2, 0))), "it has left, and where it is now is not heard");
    assert_eq!(network.has(1, 0, 8), None);
    assert_eq!((network.has(2, 0, 7), network.has(2, 0, 8)), (Some((6, (4, 0))), Some((2, (5, 5)))));
    assert_eq!(network.carried[&1], 4, "two moves within its cells, one of them under both keys, and one out of them");
    assert!(network.programs.iter().all(|one| one.exchange.is_complete()));
}

#[test]
fn who_begins_to_read_a_cell_receives_its_states_and_forgets_what_left_it_meanwhile() {
    let mut network = Lossy::new(2, Weather::calm(), 1);
    network.want(1, Some(&[(0, 0)]));
    network.run(500 * MILLISECOND);
    (0..300).for_each(|key| network.put_at(0, key, block((3, 3))));
    put(&mut network, 0, 500, (0, 0));
    put(&mut network, 0, 501, (0, 0));
    network.want(1, Some(&[(3, 3)]));
    network.run(500 * MILLISECOND);
    assert!((0..300).all(|key| network.has(1, 0, key) == Some((key + 1, (3, 3)))));
    // It has stopped to read the first cell when one of its states leaves it.
    network.run(11_000 * MILLISECOND);
    put(&mut network, 0, 500, (9, 9));
    assert_eq!(network.has(1, 0, 500), Some((301, (0, 0))));
    network.want(1, Some(&[(0, 0)]));
    network.run(500 * MILLISECOND);
    assert_eq!(network.has(1, 0, 500), Some((303, (9, 9))));
    assert_eq!(network.has(1, 0, 501), Some((302, (0, 0))));
    network.want(1, None);
    put(&mut network, 0, 500, (8, 8));
    put(&mut network, 0, 502, (7, 7));
    network.run(500 * MILLISECOND);
    assert_eq!((network.has(1, 0, 500), network.has(1, 0, 502)), (Some((304, (8, 8))), Some((305, (7, 7)))));
}

#[test]
fn what_is_far_away_costs_a_reader_of_cells_nothing() {
    let mut network = Lossy::new(8, Weather::calm(), 1);
    for program in 0..8 {
        let x = 10 * program as i32;
        network.want(program, Some(&[(x - 1, 0), (x, 0), (x + 1, 0)]));
    }
    network.run(1_000 * MILLISECOND);
    for round in 0..100 {
        for program in 0..8 {
            network.put_at(program, 1, (16 * 10 * program as i32 + round % 16, 3));
        }
        network.run(20 * MILLISECOND);
    }
    assert_eq!((network.put, network.carried.values().sum::<u64>()), (800, 0));
}

#[test]
fn what_the_network_lost_of_a_cell_is_asked_for_although_nothing_follows() {
    let mut network = Lossy::new(2, Weather::calm(), 1);
    network.want(1, Some(&[(0, 0), (1, 0)]));
    network.run(500 * MILLISECOND);
    put(&mut network, 0, 7, (0, 0));
    network.is_cut = true;
    put(&mut network, 0, 8, (1, 0));
    put(&mut network, 0, 7, (6, 0));
    network.is_cut = false;
    network.run(500 * MILLISECOND);
    assert_eq!((network.has(1, 0, 7), network.has(1, 0, 8)), (Some((3, (6, 0))), Some((2, (1, 0)))));
}

#[test]
fn who_was_away_looks_at_its_cells_when_it_is_back() {
    for puts_at_once in [false, true] {
        let mut network = Lossy::new(3, Weather::calm(), 1);
        network.want(1, Some(&[(0, 0)]));
        network.run(500 * MILLISECOND);
        put(&mut network, 0, 7, (0, 0));
        network.run(500 * MILLISECOND);
        network.programs[1].is_stopped = true;
        network.run(3_000 * MILLISECOND);
        put(&mut network, 0, 8, (0, 0));
        put(&mut network, 0, 7, (6, 0));
        network.run(3_000 * MILLISECOND);
        network.programs[1].is_stopped = false;
        if puts_at_once {
            // It arrives before a sign of life does.
            put(&mut network, 0, 9, (0, 0));
        }
        network.run(1_000 * MILLISECOND);
        assert_eq!((network.has(1, 0, 7), network.has(1, 0, 8)), (Some((3, (6, 0))), Some((2, (0, 0)))));
    }
}

/// Cells as a number: those of a row of four whose bits are set; 16 is all of the topic.
fn cells_of(number: u8) -> Option<Vec<(i32, i32)>> {
    (number < 16).then(|| (0..4).filter(|bit| number & 1 << bit != 0).map(|x| (x, 0)).collect())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn each_reader_has_the_newest_state_in_its_cells_and_nothing_there_that_has_left(
        loss in 0..40_u32, repeats in 0..30_u32, jitter in 0..120_u64,
        seed in any::<u64>(),
        steps in prop::collection::vec((0..3_usize, 0..12_u8, 0..17_u8, 0..400_u64), 1..120),
    ) {
        let mut network = Lossy::new(3, Weather::calm(), seed);
        network.run(800 * MILLISECOND);
        network.change(Weather { loss, repeats, jitter });
        let mut wanted = vec![cells_of(16); 3];
        let mut newest = std::collections::BTreeMap::new();
        let mut last = [0; 3];
        for (program, what, number, time) in steps {
            match what {
                0 => network.is_cut = !network.is_cut,
                1 => network.run(11_000 * MILLISECOND),
                2 if network.programs.len() < 5 => {
                    network.join();
                    wanted.push(cells_of(16));
                }
                3..6 => {
                    let reader = usize::from(what + number) % wanted.len();
                    network.want(reader, cells_of(number).as_deref());
                    wanted[reader] = cells_of(number);
                }
                _ => {
                    let (key, cell) = (u64::from(number % 3), (i32::from(what) % 5, 0));
                    network.put_at(program, key, block(cell));
                    last[program] += 1;
                    newest.insert((program, key), (last[program], cell));
                }
            }
            network.run(time * MILLISECOND / 4);
        }
        network.is_cut = false;
        network.run(30_000 * MILLISECOND);
        for (reader, wanted) in wanted.iter().enumerate() {
            let is_wanted = |cell: &(i32, i32)| wanted.as_ref().is_none_or(|wanted| wanted.contains(cell));
            for ((sender, key), (number, cell)) in newest.iter().filter(|((sender, _), _)| *sender != reader) {
                let has = network.has(reader, *sender, *key);
                let is_right = match is_wanted(cell) {
                    true => has == Some((*number, *cell)),
                    false => has.is_none_or(|(_, cell)| !is_wanted(&cell)),
                };
                prop_assert!(is_right, "{reader} has {has:?} of {sender} {key}, which is {number} in {cell:?}; wants {wanted:?}");
            }
        }
    }
}

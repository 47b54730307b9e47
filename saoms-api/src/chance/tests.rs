use super::*;

/// The numbers that the authors' C code gives for this state (`xoshiro256plusplus.c`, state 1, 2, 3, 4).
#[test]
fn the_generator_is_xoshiro256_plus_plus() {
    let mut chance = Chance { state: [1, 2, 3, 4] };
    let expected = [
        41_943_041, 58_720_359, 3_588_806_011_781_223, 3_591_011_842_654_386, 9_228_616_714_210_784_205,
        9_973_669_472_204_895_162, 14_011_001_112_246_962_877, 12_406_186_145_184_390_807, 15_849_039_046_786_891_736,
        10_450_023_813_501_588_000,
    ];
    assert_eq!(expected.map(|_| chance.next_u64()), expected);
}

/// The numbers that the authors' C code gives for this seed (`splitmix64.c`).
#[test]
fn the_seed_is_spread_by_split_mix() {
    let expected =
        [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423, 4_593_380_528_125_082_431];
    assert_eq!(Chance::new(1_234_567), Chance { state: expected });
}

/// A run has to be the same next year and on another machine.
#[test]
fn streams_of_components_are_fixed() {
    let first = |seed, name| Chance::for_component(seed, name).next_u64();
    assert_eq!(first(0, "Robot001"), 9_653_064_649_864_699_339);
    assert_eq!(first(0, "Robot002"), 1_133_782_750_637_576_892);
    assert_eq!(first(1, "Robot001"), 16_715_148_056_820_231_354);
    assert_eq!(first(7, "hall/Robot001"), 11_417_668_126_198_175_469);
}

#[test]
fn streams_of_components_share_nothing() {
    let mut seen = std::collections::HashSet::new();
    for seed in 0..50 {
        for robot in 0..50 {
            let mut chance = Chance::for_component(seed, &format!("Robot{robot:03}"));
            assert!((0..10).all(|_| seen.insert(chance.next_u64())), "seed {seed}, robot {robot}");
        }
    }
}

#[test]
fn ranges_are_kept_and_filled() {
    let mut chance = Chance::new(1);
    let mut seen = [0_u32; 11];
    for _ in 0..11_000 {
        seen[chance.range(0..=10_usize)] += 1;
    }
    assert!(seen.iter().all(|count| (850..1150).contains(count)), "{seen:?}");
    for _ in 0..1000 {
        assert!((-5..7).contains(&chance.range(-5..7_i8)));
        assert!(chance.range(..3_u8) < 3);
        assert!(chance.range(u64::MAX - 1..) >= u64::MAX - 1);
        let _ = (chance.range::<i64>(..), chance.range(0..=u64::MAX));
    }
}

#[test]
#[expect(clippy::reversed_empty_ranges, reason = "they are what is tested")]
fn empty_ranges_give_their_start() {
    let mut chance = Chance::new(1);
    assert_eq!((chance.range(4..4), chance.range(4_u8..=3), chance.range(9..=-9)), (4, 4, 9));
    assert_eq!((chance.below(0), chance.below(1)), (0, 0));
    assert_eq!(chance.pick::<u8>(&[]), None);
    assert_eq!(chance.pick(&[7]), Some(&7));
}

#[test]
fn units_and_probabilities_are_kept() {
    let mut chance = Chance::new(2);
    let mut sum = 0.0;
    for _ in 0..10_000 {
        let unit = chance.unit();
        assert!((0.0..1.0).contains(&unit));
        sum += unit;
    }
    assert!((4_850.0..5_150.0).contains(&sum), "{sum}");
    assert!((0..1000).all(|_| !chance.chance(0.0) && chance.chance(1.0)));
    let often = (0..10_000).filter(|_| chance.chance(0.25)).count();
    assert!((2_300..2_700).contains(&often), "{often}");
}

#[test]
fn shuffling_keeps_the_items_and_moves_each_everywhere() {
    let mut chance = Chance::new(3);
    let mut first = [0_u32; 4];
    for _ in 0..4_000 {
        let mut items = [0, 1, 2, 3];
        chance.shuffle(&mut items);
        first[items[0]] += 1;
        items.sort_unstable();
        assert_eq!(items, [0, 1, 2, 3]);
    }
    assert!(first.iter().all(|count| (880..1120).contains(count)), "{first:?}");
}

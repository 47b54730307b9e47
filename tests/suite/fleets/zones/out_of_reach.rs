//! Zones that robots cannot hear for a while, as over a network that is down.

use std::time::Duration;

use super::apart::{delivered, robot, site, zones};

#[test]
fn robots_keep_their_luggage_for_as_long_as_a_zone_is_out_of_reach() {
    let map = [".".repeat(8), "\n".to_owned()].concat().repeat(8);
    let robots: String = (0..3).map(|number| robot(number + 1, 0, 2 * number)).collect();
    for (count, lasting) in [(1, 60), (1, 300), (2, 120)] {
        let scenario = format!(
            "from 1s every 2s 12 times luggage random to random
            at 6s for {lasting}s part Robot* from Zone*"
        );
        let fleet = site(&[("map", map.clone())], &zones(count, 8 / count), &robots, &scenario);
        for seed in 0..6 {
            let run = fleet.run(seed, Duration::from_secs(900));
            assert_eq!(delivered(&run), 12, "{count} zones, {lasting} s, {seed}: {}", run.log());
        }
    }
}

/// A zone that was out of reach for long hears of it soon, and the fleet still stands still in between.
#[test]
fn robots_that_cannot_move_say_so_again_and_again() {
    let map = [".".repeat(8), "\n".to_owned()].concat().repeat(8);
    let robots: String = (0..2).map(|number| robot(number + 1, 0, 2 * number)).collect();
    let scenario = "at 1s breakdown Robot1
        at 40s breakdown Robot2
        at 45s crash Master
        at 50s luggage (4,4) to (6,6)";
    let fleet = site(&[("map", map)], &zones(2, 4), &robots, scenario);
    let said = |seconds: u64| {
        let run = fleet.run(1, Duration::from_secs(seconds));
        ["Robot1", "Robot2"].map(|name| run.components.iter().find(|one| one.name == name).unwrap().messages.sent)
    };
    let (before, after) = (said(2000), said(2900));
    for (before, after) in before.into_iter().zip(after) {
        assert!((10..20).contains(&(after - before)), "{before} and {after} messages");
    }
    let run = fleet.run(1, Duration::MAX);
    assert!(run.standstill.as_ref().is_some_and(|standstill| standstill.ends), "{:?}", run.outcome);
}

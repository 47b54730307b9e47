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

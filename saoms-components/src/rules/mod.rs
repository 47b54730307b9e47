//! Rules over a whole fleet, for mistakes that no single component can see.
//!
//! Each rule has a file and a code of its own. A rule reports an error only if it is certain. If robots of other
//! classes, or a message broker, may make up for the mistake, it warns or reports nothing.

mod apart;
mod budget;
mod charger;
mod classic_walls;
mod crash;
mod cuts;
mod divided;
mod environments;
mod hearing;
mod map;
pub(crate) mod masters;
mod missing_loop;
mod number;
pub(crate) mod peers;
mod robots;
pub(crate) mod scenario;
mod shifts;
mod start;
mod sustain;
mod unlikely;
pub(crate) mod worlds;
mod zones;

saoms_api::fleet_rules!(
    scenario::luggage::RULE,
    charger::RULE,
    start::RULE,
    number::RULE,
    scenario::unknown_robot::RULE,
    sustain::RULE,
    divided::RULE,
    scenario::unserved::RULE,
    worlds::unused::RULE,
    masters::RULE,
    environments::RULE,
    apart::RULE,
    shifts::RULE,
    map::size::RULE,
    scenario::broken_twice::RULE,
    worlds::mixed::RULE,
    missing_loop::RULE,
    scenario::no_work::RULE,
    scenario::early_end::RULE,
    unlikely::RULE,
    classic_walls::RULE,
    worlds::slow::RULE,
    zones::RULE,
    peers::FAULTS,
    peers::BROKER,
    scenario::strain::RULE,
    zones::corridors::RULE,
    masters::FORGETS,
    sustain::crowded::RULE,
    zones::nodes::RULE,
    worlds::forgets::RULE,
    masters::ENDS,
);

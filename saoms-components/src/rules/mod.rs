//! Rules over a whole fleet, for mistakes that no single component can see.
//!
//! Each rule has a file and a code of its own. A rule reports an error only if it is certain. If robots of other
//! classes, or a message broker, may make up for the mistake, it warns or reports nothing.

mod apart;
mod broken_twice;
mod budget;
mod charger;
mod divided;
mod environments;
mod hearing;
mod luggage;
mod map;
mod masters;
mod motionless;
pub(crate) mod no_work;
mod number;
mod robots;
mod shifts;
mod start;
mod sustain;
mod unknown_robot;
mod unserved;
mod unused_world;
mod worlds;

saoms_api::fleet_rules!(
    luggage::RULE,
    charger::RULE,
    start::RULE,
    number::RULE,
    unknown_robot::RULE,
    sustain::RULE,
    divided::RULE,
    unserved::RULE,
    unused_world::RULE,
    masters::RULE,
    environments::RULE,
    apart::RULE,
    shifts::RULE,
    map::size::RULE,
    broken_twice::RULE,
    worlds::RULE,
    motionless::RULE,
    no_work::RULE,
);

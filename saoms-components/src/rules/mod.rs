//! What the checker finds in a whole fleet that no component can see alone.
//!
//! Each rule has a file and a code of its own. A rule finds what is certainly wrong: where robots of other classes, or a message broker,
//! may make right what looks wrong, it warns or says nothing.

mod charger;
mod divided;
mod looks;
mod luggage;
mod map;
mod number;
mod robots;
mod start;
mod sustain;
mod unknown_robot;
mod unserved;
mod unused_world;

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
);

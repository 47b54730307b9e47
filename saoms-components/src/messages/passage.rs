//! Messages between zones and robots: who may enter which block.

use saoms_api::{Field, Message, Topic};

use crate::grid::{Block, Map};
use crate::validation::{MessageValidator, Problem, Sender, Validate, of_robot};

/// Territories of zones, the newest message of each.
///
/// Published by zones; read by robots and zones.
pub const TERRITORY: Topic<Territory> = Topic::state("ZONETOPIC").optional();

/// Requests of robots to zones, the newest of each robot to each zone.
///
/// Published by robots; read by zones.
pub const GRANT_REQUEST: Topic<GrantRequest> = Topic::state("GRANTREQUESTTOPIC").optional();

/// Where robots are, for all zones at once, the newest message of each robot.
///
/// Published by robots; read by zones.
pub const PRESENCE: Topic<Presence> = Topic::state("PRESENCETOPIC").optional();

/// Grants of zones to robots, the newest of each zone to each robot.
///
/// Published by zones; read by robots.
pub const GRANT: Topic<Grant> = Topic::state("GRANTTOPIC").optional();

/// Blocks for which a zone grants passage: a rectangle of the map.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Message)]
#[message(
    key = "zone",
    speaker("zone", instead = "to end a zone, stop its component; its robots keep the blocks that they hold")
)]
pub struct Territory {
    /// Number of the zone.
    pub zone: u32,
    /// Term of the zone. A zone that lost its record of grants begins a higher one.
    pub term: u64,
    /// Its first block.
    pub corner: Block,
    /// Number of its columns.
    pub width: u32,
    /// Number of its rows.
    pub height: u32,
}

impl Territory {
    /// True if the zone grants passage through the block.
    pub fn contains(&self, block: Block) -> bool {
        let Territory { corner, width, height, .. } = *self;
        let inside = |value: i32, from: i32, length: u32| {
            i64::from(value) >= i64::from(from) && i64::from(value) < i64::from(from) + i64::from(length)
        };
        inside(block.x, corner.x, width) && inside(block.y, corner.y, height)
    }

    /// True if a robot at this block tells the zone where it is.
    pub fn is_near(&self, block: Block) -> bool {
        self.closest(block).distance(block) <= NEAR
    }

    /// The block of the zone that is closest to a block.
    pub fn closest(&self, block: Block) -> Block {
        let Territory { corner, width, height, .. } = *self;
        let within = |value: i32, from: i32, length: u32| {
            value.max(from).min(from.saturating_add_unsigned(length.saturating_sub(1)))
        };
        Block::new(within(block.x, corner.x, width), within(block.y, corner.y, height))
    }

    /// The first and the last block that two zones share.
    pub(crate) fn shared(&self, other: &Territory) -> Option<(Block, Block)> {
        let last = |zone: &Territory| {
            let end = |from: i32, length: u32| from.saturating_add_unsigned(length.saturating_sub(1));
            Block::new(end(zone.corner.x, zone.width), end(zone.corner.y, zone.height))
        };
        let (ends, other_ends) = (last(self), last(other));
        let from = Block::new(self.corner.x.max(other.corner.x), self.corner.y.max(other.corner.y));
        let to = Block::new(ends.x.min(other_ends.x), ends.y.min(other_ends.y));
        (from.x <= to.x && from.y <= to.y).then_some((from, to))
    }

    /// The number of blocks that two zones share.
    pub(crate) fn shares(&self, other: &Territory) -> u64 {
        self.shared(other).map_or(0, |(from, to)| {
            let length = |from: i32, to: i32| u64::from(to.abs_diff(from)) + 1;
            length(from.x, to.x).saturating_mul(length(from.y, to.y))
        })
    }
}

/// Distance from a zone within which robots tell it where they are, in blocks.
const NEAR: u32 = 4;

/// A block of a robot's passage through a zone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Field)]
pub struct Step {
    /// Number of the step: a zone counts the steps that it grants to a robot. 0 is the block where the robot stood
    /// when it began, without a grant.
    pub number: u64,
    /// The block.
    pub block: Block,
}

/// What a robot holds of a zone, and where it wants to go.
///
/// The newest request replaces all earlier ones. What a robot released it holds never again, so that a request that
/// arrives late, twice or after a newer one does no harm.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Message)]
#[message(
    key = "link",
    place = "at",
    speaker(
        "robot",
        instead = "to keep the robot at its block, stop it with `estop`; if it was removed from the floor, send `gone`"
    )
)]
pub struct GrantRequest {
    /// Number of the robot and of the zone, in one number.
    pub link: u64,
    /// Number of the zone.
    pub zone: u32,
    /// Term of the zone that the robot knows.
    pub term: u64,
    /// Number of the robot.
    pub robot: u32,
    /// Number that grows when the robot begins anew, without memory of its grants.
    pub incarnation: u64,
    /// Number of the request, in the order in which the robot wrote its requests to this zone.
    pub number: u64,
    /// Block of the zone that is closest to the robot: a zone hears requests on its own blocks.
    pub at: Block,
    /// Position of the robot.
    pub block: Block,
    /// End of the robot's passage: the last block that it holds.
    pub end: Block,
    /// Highest number of a step that the robot has received; the highest number of all when it leaves the fleet, since
    /// it takes none any more.
    pub received: u64,
    /// Steps that the robot holds. It released all others up to `received`.
    pub held: Vec<Step>,
    /// Block where it wants to go; the same as `end` if it wants to stay.
    pub goal: Block,
    /// Block of its charger.
    pub charger: Block,
    /// Rank of its way: the higher rank goes first.
    pub rank: u64,
    /// What it does when another robot wants its block.
    pub standing: Standing,
    /// Number of blocks that have to be granted ahead, so that the robot does not stop to wait for grants. The zone may
    /// grant fewer.
    pub ahead: u32,
}

/// Where a robot is, and of which zones it holds nothing.
///
/// It answers all zones that ask where the robot is. Zones of which it holds blocks, those within 4 blocks of it or of
/// the end of its passage, and that of its charger also get a request.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Message)]
#[message(
    key = "robot",
    speaker(
        "robot",
        instead = "to keep the robot at its block, stop it with `estop`; if it was removed from the floor, send `gone`"
    )
)]
pub struct Presence {
    /// Number of the robot.
    pub robot: u32,
    /// Number that grows when the robot begins anew, without memory of its grants. It is not 0.
    pub incarnation: u64,
    /// Position of the robot.
    pub block: Block,
    /// End of the robot's passage: the last block that it holds.
    pub end: Block,
    /// True if it cannot move any more, so that others have to drive around it.
    pub is_lost: bool,
    /// Block of its charger, which the ways of others avoid.
    pub charger: Block,
    /// Terms of zones that the robot knows, and in which it holds nothing: it ignores grants of their earlier terms.
    pub clear: Vec<ClearTerm>,
}

/// A term of a zone in which a robot holds nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Field)]
pub struct ClearTerm {
    /// Number of the zone.
    pub zone: u32,
    /// The term.
    pub term: u64,
}

/// What a robot does when another one wants its block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Field)]
pub enum Standing {
    /// It makes way.
    #[default]
    MakesWay,
    /// It stays for now: it handles luggage, has to charge, or is stopped.
    Stays,
    /// It cannot move any more, so that others have to drive around it.
    Lost,
    /// It is not on the floor, and waits until it may enter it at its block.
    Enters,
}

/// The address of a robot: the place of messages that are for it alone, which is no block of a map. Its column is the
/// number of the robot, and its row 0.
pub const fn address(robot: u32) -> Block {
    Block::new(robot.cast_signed(), 0)
}

/// The steps that a zone granted to a robot, and that the robot did not release.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Message)]
#[message(key = "link", place = "address", speaker("zone", instead = "stop the zone, if it has to grant nothing"))]
pub struct Grant {
    /// Number of the robot and of the zone, in one number.
    pub link: u64,
    /// Number of the zone.
    pub zone: u32,
    /// Term of the zone.
    pub term: u64,
    /// Number of the robot.
    pub robot: u32,
    /// Incarnation of the robot to which it is granted.
    pub incarnation: u64,
    /// Number of the robot's newest request that the zone took in. The highest number of all says that somebody took
    /// the robot off the floor, so that it holds nothing any more, and has to stop.
    pub heard: u64,
    /// Address of the robot ([`address`]): it receives grants of its own address alone, wherever it is.
    pub address: Block,
    /// The steps, in their order.
    pub steps: Vec<Step>,
    /// Robot that holds the block where this one waits to go; 0 if it does not wait for a robot.
    pub waits_for: u32,
    /// The block for which it waits.
    pub wanted: Block,
    /// Block of another zone for which the robot has to ask, beside the end of its passage, so that another robot gets
    /// on. If its passage ends there, it has to stay there meanwhile.
    pub aside: Block,
    /// Rank with which it asks for that block: that of the robot that gets on; 0 if it need not.
    pub aside_rank: u64,
}

/// The number after which none follows: of the last request of a robot, and of the last step that it received.
pub const LAST_NUMBER: u64 = u64::MAX;

/// Number of a robot and a zone in one number, the key of their messages.
pub fn link(zone: u32, robot: u32) -> u64 {
    u64::from(zone) << 32 | u64::from(robot)
}

impl Validate for Territory {
    const WHAT: &'static str = "the territory";
    const SPOKEN_ON: Option<Topic<Territory>> = Some(TERRITORY);

    fn about(&self) -> String {
        format!("zone {}", self.zone)
    }

    fn validate(
        &self,
        sender: Sender<'_>,
        validator: &mut MessageValidator,
        _area: Option<&Map>,
    ) -> Result<(), Problem> {
        // Zones have numbers of their own: a validator of territories sees no robots.
        validator.check_zone(self.zone, sender)
    }
}

impl Validate for GrantRequest {
    const WHAT: &'static str = "the request for a grant";
    const SPOKEN_ON: Option<Topic<GrantRequest>> = Some(GRANT_REQUEST);

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(
        &self,
        sender: Sender<'_>,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        let held = self.held.iter().map(|step| step.block);
        for block in [self.block, self.end, self.at, self.goal, self.charger].into_iter().chain(held) {
            Problem::of_block(block, area)?;
        }
        validator.check_speaker(self.robot, sender)
    }
}

impl Validate for Presence {
    const WHAT: &'static str = "where the robot is";
    const SPOKEN_ON: Option<Topic<Presence>> = Some(PRESENCE);

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(
        &self,
        sender: Sender<'_>,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        for block in [self.block, self.end, self.charger] {
            Problem::of_block(block, area)?;
        }
        validator.check_speaker(self.robot, sender)
    }
}

impl Validate for Grant {
    const WHAT: &'static str = "the grant";
    const SPOKEN_ON: Option<Topic<Grant>> = Some(GRANT);

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(
        &self,
        sender: Sender<'_>,
        validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        for step in &self.steps {
            Problem::of_block(step.block, area)?;
        }
        validator.check_known(self.zone)?;
        validator.check_zone(self.zone, sender)
    }
}

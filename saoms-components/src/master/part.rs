//! The part of a site whose luggage a master assigns: the blocks of a zone.

use std::time::Duration;

use saoms_api::{Context, Failure, Header, Region, Subscription};

use crate::grid::{Block, Map};
use crate::messages::{EventLuggage, Position, RobotList, TERRITORY, Territory, Visit};

/// Number of the zone whose master also passes on what belongs to no block.
pub(crate) const FIRST: u32 = 1;

/// Least number of blocks around the zone within which the master knows robots.
const MARGIN: u32 = 8;

/// Number of blocks around a zone that is the whole map, whichever it is.
const EVERYWHERE: u32 = 8192;

/// Luggage or a visit that was requested before the blocks of the zone were known.
#[derive(Clone, Debug)]
pub(super) enum Early {
    Luggage(EventLuggage),
    Visit(Visit),
}

/// The blocks of a zone, and the robots around them.
#[derive(Debug)]
pub(in crate::master) struct Part {
    zone: u32,
    territory: Option<Territory>,
    territories: Subscription<Territory>,
    /// Number of blocks around the zone within which robots are known; `None` until that is set.
    margin: Option<u32>,
    early: Vec<(Header, Early)>,
}

impl Part {
    pub(super) fn of(zone: u32) -> Part {
        Part { zone, territory: None, territories: Subscription::default(), margin: None, early: Vec::new() }
    }

    pub(super) fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.territories = context.subscribe(&TERRITORY)?;
        Ok(())
    }

    /// Learns the blocks of the zone. Returns what was requested before they were known.
    pub(super) fn learn(&mut self, context: &Context<'_>) -> Vec<(Header, Early)> {
        let zone = self.zone;
        let mut all = context.receive(&self.territories).with_headers();
        let is_its = |sender: u32| context.speaker(&TERRITORY, zone).is_none_or(|own| own == sender);
        let own = all.rfind(|(header, territory)| territory.zone == zone && is_its(header.sender));
        self.territory = own.map(|(_, territory)| territory.clone()).or_else(|| self.territory.take());
        if self.territory.is_some() { std::mem::take(&mut self.early) } else { Vec::new() }
    }

    /// Keeps what is requested before the blocks of the zone are known.
    pub(super) fn keep(&mut self, header: Header, early: Early) {
        self.early.push((header, early));
    }

    /// True if what begins at this block is for this master; `None` while it does not know the blocks of its zone. What
    /// can begin nowhere is for the first one, which says so.
    pub(super) fn contains(&self, from: Block, area: Option<&Map>) -> Option<bool> {
        let territory = self.territory.as_ref()?;
        let is_nowhere = || self.is_first() && area.is_some_and(|area| !area.is_free(from));
        Some(territory.contains(from) || is_nowhere())
    }

    /// True if this master also passes on what belongs to no block.
    pub(super) fn is_first(&self) -> bool {
        self.zone == FIRST
    }

    /// True if it knows all robots.
    pub(super) fn knows_all(&self, area: Option<&Map>) -> bool {
        self.margin >= Some(area.map_or(EVERYWHERE, |area| area.width().max(area.height())))
    }

    /// Knows robots farther away, the longer luggage waits: as many blocks around the zone as a robot drives in that
    /// time.
    ///
    /// # Errors
    /// The region of hearing cannot be set.
    pub(super) fn look_around(
        &mut self,
        waited: Option<Duration>,
        step: Duration,
        (positions, robots): (&Subscription<Position>, &Subscription<RobotList>),
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let Some(Territory { corner, width, height, .. }) = self.territory else { return Ok(()) };
        // Before the first robot is known, a move takes no time.
        let moves = waited.unwrap_or_default().as_nanos() / step.as_nanos().max(1);
        let moves = u32::try_from(moves).unwrap_or(EVERYWHERE).min(EVERYWHERE);
        let margin = moves.next_power_of_two().max(MARGIN);
        if self.margin == Some(margin) {
            return Ok(());
        }
        self.margin = Some(margin);
        let columns = corner.x.saturating_sub_unsigned(margin)..=corner.x.saturating_add_unsigned(width - 1 + margin);
        let rows = corner.y.saturating_sub_unsigned(margin)..=corner.y.saturating_add_unsigned(height - 1 + margin);
        let region = Some(Region::new(columns, rows));
        context.set_region(positions, region)?;
        context.set_region(robots, region)
    }
}

//! A zone's record of grants in the bytes that it keeps: its territory, and what it knows of each robot.

use std::collections::BTreeMap;

use saoms_api::host::cdr;
use saoms_api::{Failure, Message, Saved, Time};

use super::ledger::{Ledger, Member};
use crate::messages::{GrantRequest, Step, Territory};

/// Where the territory is kept. A robot is kept under its number, which is never 0.
const TERRITORY: u64 = 0;

/// The territory of a zone, and the form in which robots are kept.
#[derive(Clone, Debug, Message)]
struct TerritoryMemory {
    territory: Territory,
    form: String,
    /// True if it grants: the record has all that robots may hold.
    is_open: bool,
}

/// What a zone knows of a robot.
#[derive(Clone, Debug, Message)]
struct MemberMemory {
    request: GrantRequest,
    steps: Vec<Step>,
    granted: u64,
    /// Time of the first request of this incarnation that the zone heard.
    first: Time,
}

/// A record of grants that was kept.
#[derive(Debug)]
pub(super) struct Record {
    pub(super) ledger: Ledger,
    /// Time of the first request of each robot's newest incarnation.
    pub(super) first_heard: BTreeMap<u32, Time>,
    /// True if it has all that robots may hold.
    pub(super) is_open: bool,
}

/// The bytes of the territory, of a zone that grants or not.
pub(super) fn territory(ledger: &Ledger, is_open: bool) -> (u64, Vec<u8>) {
    let (territory, form) = (ledger.territory().clone(), MemberMemory::SCHEMA.to_owned());
    let memory = TerritoryMemory { territory, form, is_open };
    (TERRITORY, Saved::of(&memory).bytes().to_vec())
}

/// The bytes of a robot, which began to speak at this time; none for one that the zone does not know any more.
pub(super) fn member(ledger: &Ledger, robot: u32, first: Time) -> (u64, Vec<u8>) {
    let member = ledger.member(robot).map(|Member { request, steps, granted, .. }| MemberMemory {
        request: request.clone(),
        steps: steps.clone(),
        granted: *granted,
        first,
    });
    (u64::from(robot), member.map_or_else(Vec::new, |member| cdr::encode(&member)))
}

/// True if the record of a zone has something to keep under a key.
pub(super) fn is_current(ledger: &Ledger, key: u64) -> bool {
    key == TERRITORY || u32::try_from(key).is_ok_and(|robot| ledger.member(robot).is_some())
}

/// The record of a zone, with the time at which each robot began to speak; `None` if there is none.
///
/// # Errors
/// The bytes are no record of this build.
pub(super) fn record(kept: &BTreeMap<u64, &[u8]>) -> Result<Option<Record>, Failure> {
    let Some(territory) = kept.get(&TERRITORY) else { return Ok(None) };
    let Some(TerritoryMemory { territory, form, is_open }) = Saved::from_bytes(territory.to_vec()).read()? else {
        return Ok(None);
    };
    if form != MemberMemory::SCHEMA {
        return Err(Failure::new(format!(
            "an earlier build kept robots as {form}, and this one keeps them as {}",
            MemberMemory::SCHEMA
        )));
    }
    let (mut members, mut first_heard) = (BTreeMap::new(), BTreeMap::new());
    for (_, bytes) in kept.range(TERRITORY + 1..) {
        let MemberMemory { request, steps, granted, first } = cdr::decode(bytes)
            .map_err(|error| Failure::new(format!("what was kept of a robot cannot be read: {error}")))?;
        first_heard.insert(request.robot, first);
        members.insert(request.robot, Member::new(request, steps, granted));
    }
    Ok(Some(Record { ledger: Ledger::with(territory, members), first_heard, is_open }))
}

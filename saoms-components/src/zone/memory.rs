//! A zone's record of grants in the bytes that it keeps.

use saoms_api::{Failure, Field, Message, Saved};

use super::ledger::{Ledger, Member};
use crate::messages::{GrantRequest, Step, Territory};

#[derive(Clone, Debug, Message)]
struct LedgerMemory {
    territory: Territory,
    members: Vec<MemberMemory>,
    /// True if the zone grants: all robots have said where they are.
    open: bool,
}

#[derive(Clone, Debug, Field)]
struct MemberMemory {
    request: GrantRequest,
    steps: Vec<Step>,
    granted: u64,
}

/// The bytes of a record, of a zone that grants or does not yet.
pub(super) fn to_bytes(ledger: &Ledger, open: bool) -> Saved {
    let members = ledger.members().values().map(|Member { request, steps, granted, .. }| MemberMemory {
        request: request.clone(),
        steps: steps.clone(),
        granted: *granted,
    });
    Saved::of(&LedgerMemory { territory: ledger.territory().clone(), members: members.collect(), open })
}

/// The record of these bytes; `None` if there are none.
///
/// # Errors
/// The bytes are no record of this build.
pub(super) fn from_bytes(bytes: &[u8]) -> Result<Option<(Ledger, bool)>, Failure> {
    let Some(LedgerMemory { territory, members, open }) = Saved::from_bytes(bytes.to_vec()).read()? else {
        return Ok(None);
    };
    let members = members
        .into_iter()
        .map(|MemberMemory { request, steps, granted }| (request.robot, Member::new(request, steps, granted)));
    Ok(Some((Ledger::with(territory, members.collect()), open)))
}

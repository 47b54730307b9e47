//! Replicas that there are not, named by numbers that none has.

use crate::check::fleet::Fleet;
use crate::check::report::replacing;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::source::Location;
use crate::syntax::escaped;

/// The probable meaning of the name of a replica whose index is out of range.
pub(crate) struct Beyond<'f> {
    /// The replica whose number is the nearest.
    meant: &'f str,
    /// The replicas.
    help: String,
}

impl Beyond<'_> {
    /// The diagnostic about the name, which `own` has written: that means another one.
    pub(crate) fn diagnostic(self, name: &str, own: Option<&str>, at: Location, message: String) -> Diagnostic {
        let one = Diagnostic::new(&codes::UNKNOWN_COMPONENT, at, message).help(self.help);
        match Some(self.meant) == own {
            true => one,
            false => one.suggest(replacing(name, self.meant), at, escaped(self.meant)),
        }
    }
}

/// The replica of a scope with the number that is the nearest to that of a name which is like those of a group: `R02`
/// for `R03`, and for `R2`.
pub(crate) fn beyond<'f>(name: &str, scope: usize, fleet: &'f Fleet<'_>) -> Option<Beyond<'f>> {
    let bytes = name.as_bytes();
    let mut end = 0;
    while let Some(start) = (end..bytes.len()).find(|at| bytes[*at].is_ascii_digit()) {
        end = (start..bytes.len()).find(|at| !bytes[*at].is_ascii_digit()).unwrap_or(bytes.len());
        let (before, behind) = (&name[..start], &name[end..]);
        let Some(group) = fleet.group(scope, &format!("{before}*{behind}")) else { continue };
        let replica = |place: usize| fleet.members[group[place]].component.name.as_str();
        let number = |name: &str| name.strip_prefix(before)?.strip_suffix(behind)?.parse::<u64>().ok();
        let last = group.len().checked_sub(1)?;
        let (from, to) = (number(replica(0))?, number(replica(last))?);
        // As a rule they are numbered one by one. A number of too many digits is larger than all.
        let wanted = number(name).unwrap_or(u64::MAX).clamp(from.min(to), from.max(to));
        let place = usize::try_from(wanted.abs_diff(from)).ok().filter(|place| *place <= last)?;
        let help = match last {
            0 => format!("the only replica is {}", quoted(replica(0))),
            _ => format!("the replicas are {} to {}", quoted(replica(0)), quoted(replica(last))),
        };
        return Some(Beyond { meant: replica(place), help });
    }
    None
}

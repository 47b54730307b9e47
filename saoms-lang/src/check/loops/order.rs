//! The order of a component's loops.
//!
//! Those that are not moved keep the order of the class, added ones behind them in document order. A loop that is moved
//! stands directly before or after another, which may be moved as well: such loops hang on each other like the nodes of
//! a tree, whose roots are the loops that are not moved. What hangs on no root hangs on itself, in a circle.

use std::collections::{HashMap, HashSet};

use super::Planned;
use super::list::report_unknown;
use crate::check::fleet::Member;
use crate::check::report::{Report, list};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::LoopElement;
use crate::source::Text;

/// Loops of a circle that are shown with their places.
const MOST_SHOWN: usize = 30;

/// Brings the loops into the order that the elements ask for; `false` where they ask for none that is possible.
pub(super) fn sort<'a>(
    loops: &mut Vec<Planned<'a>>,
    elements: &[&'a LoopElement],
    removed: &HashMap<&str, &LoopElement>,
    member: &Member<'_>,
    names: &[&str],
    report: &mut Report<'_>,
) -> bool {
    let mut is_sound = true;
    // By the loop they stand at: the moved loops before it, and those after it, in document order.
    let mut beside: HashMap<&str, [Vec<&str>; 2]> = HashMap::new();
    let mut moved: HashMap<&str, &Text> = HashMap::new();
    let known: HashSet<&str> = loops.iter().map(|one| one.name).collect();
    let given: HashSet<&str> = elements.iter().map(|one| one.name.as_str()).collect();
    for one in elements {
        let (place, target) = match (&one.before, &one.after) {
            (Some(before), None) => (0, before),
            (None, Some(after)) => (1, after),
            _ => continue,
        };
        if let Some(removal) = removed.get(target.as_str()) {
            let message =
                format!("the loop {} is placed beside {}, which is removed", quoted(&one.name), quoted(target));
            let one = Diagnostic::new(&codes::LOOP_ORDER, target.location, message);
            let one = one.label(removal.name.location, "removed here");
            report.push(one.help("place it before or after another loop, or keep the removed loop"));
            is_sound = false;
        } else if !known.contains(target.as_str()) {
            // One that is given and wrong is reported already.
            if !given.contains(target.as_str()) {
                report_unknown(target, member, names, true, report);
            }
            is_sound = false;
        } else {
            beside.entry(target).or_default()[place].push(&one.name);
            moved.insert(&one.name, target);
        }
    }
    if moved.is_empty() {
        return is_sound;
    }
    let mut order: Vec<&str> = Vec::with_capacity(loops.len());
    for one in loops.iter().filter(|one| !moved.contains_key(one.name)) {
        put(one.name, &beside, &mut order);
    }
    let places: HashMap<&str, usize> = order.into_iter().zip(0..).collect();
    let is_stuck = |name: &str| moved.contains_key(name) && !places.contains_key(name);
    let stuck: Vec<&&LoopElement> = elements.iter().filter(|one| is_stuck(&one.name)).collect();
    if let Some((last, others)) = stuck.split_last() {
        let target = moved[last.name.as_str()];
        let message = match others {
            [] => format!("the loop {} is placed beside itself", quoted(&last.name)),
            _ => {
                let names = list(stuck.iter().map(|one| one.name.as_str()));
                format!("the order of the loops {names} is circular")
            }
        };
        let mut one = Diagnostic::new(&codes::LOOP_ORDER, target.location, message)
            .help("place one of them before or after a loop that is not moved");
        for other in others.iter().take(MOST_SHOWN) {
            let target = moved[other.name.as_str()];
            one = one.label(target.location, format!("{} is placed beside {}", quoted(&other.name), quoted(target)));
        }
        report.push(one);
        return false;
    }
    loops.sort_by_key(|one| places.get(one.name));
    is_sound
}

/// Puts a loop with all that hang on it.
fn put<'n>(name: &'n str, beside: &HashMap<&str, [Vec<&'n str>; 2]>, order: &mut Vec<&'n str>) {
    let none = [Vec::new(), Vec::new()];
    let mut open = vec![(name, false)];
    while let Some((name, is_done)) = open.pop() {
        let [before, after] = beside.get(name).unwrap_or(&none);
        if is_done {
            order.push(name);
            continue;
        }
        // From the last to the first: what is put on the stack last comes first.
        open.extend(after.iter().rev().map(|one| (*one, false)));
        open.push((name, true));
        open.extend(before.iter().rev().map(|one| (*one, false)));
    }
}

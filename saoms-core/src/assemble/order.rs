use super::Members;

/// The numbers of the components of a fleet, each after those whose services it calls, in their own order otherwise.
///
/// A component may call its references from `initialize` and `shutdown` on: its providers have to start before it and
/// end after it. Depth-first search over the wires, without recursion because a chain of wires may be as long as the
/// fleet. In a cycle, which the checker refuses, the order is some order.
pub(crate) fn providers_first(components: &Members<'_>) -> Vec<usize> {
    let mut order = Vec::with_capacity(components.len());
    let mut seen = vec![false; components.len()];
    // Components, each with the place of the next wire to follow: reference and target.
    let mut path: Vec<(usize, usize, usize)> = Vec::new();
    for root in (0..components.len()).filter(|number| components[*number].is_some()) {
        visit(root, &mut seen, &mut path);
        while let Some((component, reference, next)) = path.last_mut() {
            let component = *component;
            let Some(wire) = components[component].and_then(|spec| spec.references.get(*reference)) else {
                order.push(component);
                path.pop();
                continue;
            };
            let Some(target) = wire.targets.get(*next) else {
                (*reference, *next) = (*reference + 1, 0);
                continue;
            };
            *next += 1;
            if components.get(target.component).is_some_and(Option::is_some) {
                visit(target.component, &mut seen, &mut path);
            }
        }
    }
    order
}

fn visit(component: usize, seen: &mut [bool], path: &mut Vec<(usize, usize, usize)>) {
    if !std::mem::replace(&mut seen[component], true) {
        path.push((component, 0, 0));
    }
}

//! Making components: one as it is written, or its replicas. Where a fault keeps replicas from being made, one stands
//! for them, so that everything else about them is checked all the same.

use std::rc::Rc;

use super::Unfolding;
use super::conditions::Presence;
use super::replica_plan::{Plan, condition, first_index};
use crate::check::judged::{Faulty, Judged};
use crate::check::values::expression_scope::Names;
use crate::check::values::replica::{Instance, Partial, Replica};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::expression::{ExpressionFault, has_expression, pattern, render};
use crate::model::{ComponentElement, Replicas, Table};
use crate::source::{Location, Text};

impl<'a> Unfolding<'a, '_, '_> {
    /// Makes what stands next in the composite at hand.
    pub(crate) fn component(&mut self, component: &'a ComponentElement) {
        let Some(open) = self.open.last() else { return };
        let (unit, document) = (open.unit, &open.composite.document);
        let Some(replicas) = component.replicas.as_ref() else {
            let condition = component.condition.as_ref();
            let holds = condition.map_or(Ok(true), |condition| self.holds(condition, unit));
            let presence = holds.map_or(Presence::Unknown, Presence::of);
            return self.member(component, component, None, presence);
        };
        let names = self.names(unit);
        let table = self.table(replicas, &names);
        let Ok(plan) = Plan::of(
            component,
            replicas,
            document,
            &names,
            table,
            (self.replicas_left.left(), self.lowers_attributes),
            self.report,
        ) else {
            return self.unplanned(component, replicas, &names);
        };
        let (is_empty, index) = (plan.left.is_empty(), plan.first);
        let group = (self.fleet.units[unit].scope, pattern(&component.name));
        self.fleet.groups.entry(group).or_default();
        if self.complex(component, &plan.instance(index)) {
            let (_, _, presence) = self.made(component, &plan.instance(index), None);
            return self.partial(component, Some(index), &names, presence);
        }
        if is_empty {
            let instance = plan.instance(index);
            let (made, faults) = instance.of(component, None);
            if !faults.is_empty() {
                // What is no number without replicas is no fault of an expression; what is one is told.
                let is_of_count = |one: &ExpressionFault| one.problem.is_arithmetic;
                let faults = faults.into_iter().map(|(text, faults)| {
                    (text, faults.into_iter().filter(|one| !is_of_count(one)).collect::<Vec<ExpressionFault>>())
                });
                let faults: Vec<(Text, Vec<ExpressionFault>)> =
                    faults.filter(|(_, faults)| !faults.is_empty()).collect();
                if !faults.is_empty() {
                    self.faults(&names, &faults);
                    return self.partial(component, Some(index), &names, Presence::Absent);
                }
                let partial = Some(Partial { has_table: true, lacks_index: false });
                let instance = Instance { partial, ..instance };
                let Replica { component: made, instance } = self.replicas.add(Replica { component: made, instance });
                return self.member(component, made, Some(instance), Presence::Absent);
            }
            if let Some(asked) = component.condition.as_ref() {
                _ = condition(asked, &names, &mut |name| instance.value(name), self.report);
            }
            let Replica { component: made, instance } = self.replicas.add(Replica { component: made, instance });
            return self.member(component, made, Some(instance), Presence::Absent);
        }
        self.replicas_left.spend(plan.cost);
        if let Some(open) = self.open.last_mut() {
            open.plan = Some(plan);
        }
    }

    /// Makes one of the replicas of a component; `false` with a fault that the others would have as well.
    pub(crate) fn replica(&mut self, plan: &Plan<'a>, index: i64) -> bool {
        let Some(open) = self.open.last() else { return false };
        let (unit, scope) = (open.unit, self.fleet.units[open.unit].scope);
        let instance = plan.instance(index);
        let (made, is_faulty, presence) = self.made(plan.component, &instance, plan.row(index));
        if is_faulty && index == plan.first {
            self.partial(plan.component, Some(index), &plan.names, presence);
            // In how many others it is.
            plan.left.clone().for_each(|other| _ = self.made(plan.component, &plan.instance(other), plan.row(other)));
            return false;
        }
        if is_faulty || self.is_beyond(plan.component) {
            self.miss(unit, pattern(&plan.component.name));
            return false;
        }
        let Replica { component, instance } = self.replicas.add(Replica { component: made, instance });
        let member = self.fleet.members.len();
        self.member(plan.component, component, Some(instance), presence);
        if presence != Presence::Absent && !self.fleet.units[unit].is_absent {
            self.fleet.groups.entry((scope, pattern(&plan.component.name))).or_default().push(member);
        }
        true
    }

    /// The table of replicas. One that was not read is reported, and is wanted where its name is an expression: each
    /// use of a composite may have its own.
    fn table(&mut self, replicas: &'a Replicas, names: &Names) -> Judged<Option<&'a Table>> {
        let Some(file) = &replicas.overrides else { return Ok(None) };
        let table = if !has_expression(file) {
            replicas.table.as_deref()
        } else {
            let name = render(file, &mut |name| names.value(name)).map_err(|faults| {
                self.faults(names, &[(file.clone(), faults)]);
                Faulty
            })?;
            // A whole path is from the folder of who writes it, a part of one from that of the rest.
            let property = file.strip_prefix("${").and_then(|rest| rest.strip_suffix('}'));
            let value = property.and_then(|name| names.place(name.trim())).unwrap_or(file.location);
            if name.contains('\n') {
                return self.contents_for_name(property.unwrap_or_default().trim(), value);
            }
            let table = self.fleet.contribution.table(value.file, &name);
            if table.is_none() {
                self.fleet.wanted_tables.push((Text::new(name.into(), value), file.location));
            }
            table
        };
        // As a rule it was reported by who tried to read it.
        if table.is_none() && !self.report.has_errors() {
            self.report.push(Diagnostic::new(&codes::FILE_UNREADABLE, file.location, "the file was not read"));
        }
        table.map(Some).ok_or(Faulty)
    }

    /// Reports a table whose name comes from a file, in which its contents are.
    fn contents_for_name(&mut self, property: &str, value: Location) -> Judged<Option<&'a Table>> {
        let unit = self.open.last().map(|open| &self.fleet.units[open.unit]);
        let owner = unit.and_then(|unit| self.fleet.scopes[unit.scope].owner).map(|owner| &self.fleet.members[owner]);
        let given = owner.and_then(|owner| {
            let given = owner.component.properties.iter().find(|one| one.name == *property)?;
            let attribute = given.origin.element(&owner.composite.document).attribute("file")?;
            Some((given.file()?, attribute.name_location()))
        });
        let one = |at, what: &str| {
            let message =
                format!("found the contents of {what} for {}, expected the name of a table", quoted(property));
            Diagnostic::new(&codes::OVERRIDES, at, message)
        };
        self.report.push(match given {
            Some((file, attribute)) => {
                let one = one(file.location, &format!("the file {}", quoted(file)));
                one.suggest("replace `file` with `value`", attribute, "value")
            }
            None => one(value, "a file").help("give the name of the file"),
        });
        Err(Faulty)
    }

    /// Looks at a component whose number of replicas is not known.
    fn unplanned(&mut self, component: &'a ComponentElement, replicas: &Replicas, names: &Rc<Names>) {
        let first = first_index(replicas, names);
        let index = first.unwrap_or(1);
        let instance = Instance { index, names: Rc::clone(names), partial: None };
        let mut presence = Presence::There;
        if first.is_some() {
            self.complex(component, &instance);
            (_, _, presence) = self.made(component, &instance, None);
        }
        self.partial(component, first, names, presence);
    }

    /// One of the replicas, whether it has faults, which are reported, and whether its condition keeps it away.
    fn made(
        &mut self,
        component: &ComponentElement,
        instance: &Instance,
        row: Option<(&Table, usize)>,
    ) -> (ComponentElement, bool, Presence) {
        let (made, faults) = instance.of(component, row);
        self.report.about_replica(&made.name, Some(instance.index));
        self.faults(&instance.names, &faults);
        let asked = component.condition.as_ref();
        let value = &mut |name: &str| instance.value(name);
        let holds = asked.map(|text| condition(text, &instance.names, value, self.report));
        self.report.about_all();
        let is_faulty = !faults.is_empty() || holds == Some(Err(Faulty));
        (made, is_faulty, Presence::of(holds != Some(Ok(false))))
    }

    /// Adds one that stands for replicas that are not made, with the index of the first, as far as it is known.
    fn partial(&mut self, component: &'a ComponentElement, index: Option<i64>, names: &Rc<Names>, presence: Presence) {
        let Some(open) = self.open.last() else { return };
        let (unit, scope) = (open.unit, self.fleet.units[open.unit].scope);
        let has_table = component.replicas.as_ref().is_some_and(|replicas| replicas.overrides.is_some());
        let partial = Some(Partial { has_table, lacks_index: index.is_none() });
        let instance = Instance { index: index.unwrap_or(1), names: Rc::clone(names), partial };
        let (made, _) = instance.of(component, None);
        let Replica { component: made, instance } = self.replicas.add(Replica { component: made, instance });
        let group = pattern(&component.name);
        let is_open = group.contains('*');
        self.miss(unit, if is_open { group.clone() } else { format!("{group}*") });
        let member = self.fleet.members.len();
        self.member(component, made, Some(instance), presence);
        let members = self.fleet.groups.entry((scope, group)).or_default();
        if presence != Presence::Absent {
            members.push(member);
        }
    }
}

use std::ffi::c_void;
use std::rc::Rc;
use std::time::Duration;

use saoms_abi::{FindingSink, FleetList, MemberView, RuleTable, Sink, Status, TextList, list};

use crate::Failure;
use crate::host::{PropertyValue, SmolStr};
use crate::rule::{ClassView, ComponentView, FleetRule, FleetView};

use super::convert::{put_findings, read_properties};
use super::guard::guarded;

/// The table of a rule.
pub const fn rule_table(rule: &'static FleetRule) -> RuleTable {
    RuleTable { size: size_of::<RuleTable>(), state: (&raw const *rule).cast(), check }
}

unsafe extern "C" fn check(
    state: *const c_void,
    fleet: *const FleetList,
    findings: FindingSink,
    error: Sink,
) -> Status {
    // SAFETY: the host passes the state of the table, and lends the rest to this call.
    unsafe {
        guarded(error, || {
            let rule = &*state.cast::<FleetRule>();
            let fleet = &*fleet;
            let views = list(fleet.components, fleet.component_count)?;
            let values = views
                .iter()
                .map(|view| read_properties(view.values, view.value_count))
                .collect::<Result<Vec<_>, _>>()?;
            let wires = views.iter().map(|view| read_wires(view)).collect::<Result<Vec<_>, _>>()?;
            let renamed = views.iter().map(|view| read_renamed(view)).collect::<Result<Vec<_>, _>>()?;
            let components = views
                .iter()
                .zip(values.iter().zip(wires.iter().zip(&renamed)))
                .map(|(view, (values, (wires, renamed)))| read_member(view, values, wires, renamed))
                .collect::<Result<Vec<_>, _>>()?;
            let missing = list(fleet.missing, fleet.missing_count)?
                .iter()
                .map(|one| (one.count != 0).then(|| read_texts(one)).transpose())
                .collect::<Result<Vec<_>, _>>()?;
            put_findings(findings, &(rule.check)(&FleetView::new(&components).without(&missing)));
            Ok(())
        })
    }
}

/// # Safety
/// The list and its texts are readable for as long as the result is used.
unsafe fn read_texts<'a>(view: &TextList) -> Result<Vec<&'a str>, Failure> {
    // SAFETY: as the caller promises.
    unsafe { list(view.texts, view.count)?.iter().map(|text| Ok(text.get_text()?)).collect() }
}

/// # Safety
/// The view and what it leads to are readable for as long as the result is used.
unsafe fn read_wires<'a>(view: &MemberView) -> Result<Vec<(&'a str, usize)>, Failure> {
    // SAFETY: as the caller promises.
    unsafe {
        let wires = list(view.wires, view.wire_count)?.iter();
        wires.map(|wire| Ok((wire.reference.get_text()?, wire.target))).collect()
    }
}

/// # Safety
/// The view and what it leads to are readable for as long as the result is used.
unsafe fn read_renamed<'a>(view: &MemberView) -> Result<Vec<(&'a str, &'a str)>, Failure> {
    // SAFETY: as the caller promises.
    unsafe {
        let renamed = list(view.renamed, view.renamed_count)?.iter();
        renamed.map(|one| Ok((one.declared.get_text()?, one.on_bus.get_text()?))).collect()
    }
}

/// # Safety
/// The view and what it leads to are readable for as long as the result is used.
unsafe fn read_member<'a>(
    view: &MemberView,
    values: &'a [(SmolStr, PropertyValue)],
    wires: &'a [(&'a str, usize)],
    renamed: &'a [(&'a str, &'a str)],
) -> Result<ComponentView<'a>, Failure> {
    // SAFETY: as the caller promises.
    unsafe {
        Ok(ComponentView {
            path: view.path.get_text()?,
            class: Rc::new(ClassView {
                name: view.class_name.get_text()?,
                declaration: view.declaration.get_text()?,
                extends: read_texts(&view.extends)?,
                publishes: read_texts(&view.publishes)?,
                loops: read_texts(&view.loops)?,
                subscribes: Vec::new(),
                takes: Vec::new(),
            }),
            values,
            period: (view.period != u64::MAX).then(|| Duration::from_nanos(view.period)),
            starts: view.starts != 0,
            restarts: false,
            node: "",
            has_broker: view.has_broker != 0,
            renamed,
            wires,
        })
    }
}

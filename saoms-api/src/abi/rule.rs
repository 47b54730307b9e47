use std::ffi::c_void;
use std::rc::Rc;
use std::time::Duration;

use crate::{ClassView, ComponentView, Failure, Finding, FleetRule, FleetView};

use super::data::{PropertyViews, list};
use super::guard::guarded;
use super::lease::call_with_findings;
use super::{Bytes, FindingSink, PropertyView, Sink, Status};

/// A rule over whole fleets: what the checker finds that no component can see alone.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct RuleTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// The first argument of `check`.
    pub state: *const c_void,
    /// Puts what it finds in a fleet.
    pub check: unsafe extern "C" fn(
        state: *const c_void,
        fleet: *const FleetList,
        findings: FindingSink,
        error: Sink,
    ) -> Status,
}

/// The components of a fleet.
#[repr(C)]
#[derive(Debug)]
pub struct FleetList {
    /// The components in document order; the place of one here is its index.
    pub components: *const MemberView,
    /// How many there are.
    pub component_count: usize,
    /// Those that are left out for a fault of their own: the declarations of the class of each and of those that this extends; none where
    /// the class is not known.
    pub missing: *const TextList,
    /// How many there are.
    pub missing_count: usize,
}

/// A list of texts.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct TextList {
    /// The first.
    pub texts: *const Bytes,
    /// How many there are.
    pub count: usize,
}

/// A component of a fleet.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct MemberView {
    /// Its path in the composite.
    pub path: Bytes,
    /// The name of its class, as declared.
    pub class_name: Bytes,
    /// The declaration of its class.
    pub declaration: Bytes,
    /// The declarations of the classes that its class extends, the nearest first.
    pub extends: TextList,
    /// The values of the class's own properties, presets included; what is absent takes its default.
    pub values: *const PropertyView,
    /// How many there are.
    pub value_count: usize,
    /// From one execution to the next, in nanoseconds; `UINT64_MAX`: it is not periodic.
    pub period: u64,
    /// Whether its messages go to a broker, where others may be that this fleet does not know: 0 or 1.
    pub has_broker: u32,
    /// The topics that it publishes, by their names before any `topicRename`.
    pub publishes: TextList,
    /// The classes of its loops, in their order.
    pub loops: TextList,
    /// Its references that are wired.
    pub wires: *const WireView,
    /// How many there are.
    pub wire_count: usize,
}

/// A reference of a component that is wired.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct WireView {
    /// Its name.
    pub reference: Bytes,
    /// The index of the component that it leads to.
    pub target: usize,
}

// SAFETY: what the pointer leads to is constant.
unsafe impl Sync for RuleTable {}

impl RuleTable {
    /// The table of a rule.
    pub const fn of(rule: &'static FleetRule) -> RuleTable {
        RuleTable { size: size_of::<RuleTable>(), state: (&raw const *rule).cast(), check }
    }
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
                .map(|view| PropertyView::read(view.values, view.value_count))
                .collect::<Result<Vec<_>, _>>()?;
            let wires = views.iter().map(|view| view.read_wires()).collect::<Result<Vec<_>, _>>()?;
            let components = views
                .iter()
                .zip(values.iter().zip(&wires))
                .map(|(view, (values, wires))| view.read(values, wires))
                .collect::<Result<Vec<_>, _>>()?;
            let missing = list(fleet.missing, fleet.missing_count)?
                .iter()
                .map(|one| (one.count != 0).then(|| one.read()).transpose())
                .collect::<Result<Vec<_>, _>>()?;
            findings.put_all(&(rule.check)(&FleetView::new(&components).without(&missing)));
            Ok(())
        })
    }
}

/// Texts as [`TextList`] lends them.
struct Texts(Vec<Bytes>);

impl Texts {
    fn of(texts: &[&str]) -> Texts {
        Texts(texts.iter().map(|text| Bytes::text(text)).collect())
    }

    fn list(&self) -> TextList {
        TextList { texts: self.0.as_ptr(), count: self.0.len() }
    }
}

impl TextList {
    /// # Safety
    /// The list and its texts are readable for as long as the result is used.
    unsafe fn read<'a>(&self) -> Result<Vec<&'a str>, Failure> {
        // SAFETY: as the caller promises.
        unsafe { list(self.texts, self.count)?.iter().map(|text| text.get_text()).collect() }
    }
}

impl MemberView {
    /// # Safety
    /// The view and what it leads to are readable for as long as the result is used.
    unsafe fn read_wires<'a>(&self) -> Result<Vec<(&'a str, usize)>, Failure> {
        // SAFETY: as the caller promises.
        unsafe {
            let wires = list(self.wires, self.wire_count)?.iter();
            wires.map(|wire| Ok((wire.reference.get_text()?, wire.target))).collect()
        }
    }

    /// # Safety
    /// The view and what it leads to are readable for as long as the result is used.
    unsafe fn read<'a>(
        &self,
        values: &'a [(crate::SmolStr, crate::PropertyValue)],
        wires: &'a [(&'a str, usize)],
    ) -> Result<ComponentView<'a>, Failure> {
        // SAFETY: as the caller promises.
        unsafe {
            Ok(ComponentView {
                path: self.path.get_text()?,
                class: Rc::new(ClassView {
                    name: self.class_name.get_text()?,
                    declaration: self.declaration.get_text()?,
                    extends: self.extends.read()?,
                    publishes: self.publishes.read()?,
                    loops: self.loops.read()?,
                }),
                values,
                period: (self.period != u64::MAX).then(|| Duration::from_nanos(self.period)),
                has_broker: self.has_broker != 0,
                wires,
            })
        }
    }
}

/// A rule of the other side.
#[derive(Clone, Copy, Debug)]
pub struct ImportedRule {
    table: RuleTable,
}

// SAFETY: the rules of the boundary say that a rule is pure: any thread may ask it, also several at a time.
unsafe impl Send for ImportedRule {}
// SAFETY: the same.
unsafe impl Sync for ImportedRule {}

impl ImportedRule {
    /// A rule by its table.
    ///
    /// # Safety
    /// The function of the table keeps the rules of [the boundary](super), for as long as the program runs.
    pub const unsafe fn new(table: RuleTable) -> ImportedRule {
        ImportedRule { table }
    }

    /// Asks it about a fleet.
    ///
    /// # Errors
    /// The rule fails or panics, or one of its findings cannot be read.
    pub fn check(&self, fleet: &FleetView<'_>) -> Result<Vec<Finding>, Failure> {
        let components = fleet.components();
        let values: Vec<_> = components.iter().map(|one| PropertyViews::of(one.values)).collect();
        let texts: Vec<_> = components
            .iter()
            .map(|one| {
                [&one.class.extends, &one.class.publishes, &one.class.loops].map(|texts| Texts::of(texts))
            })
            .collect();
        let wires: Vec<Vec<_>> = components
            .iter()
            .map(|one| {
                let wire = |(name, target): &(&str, usize)| WireView {
                    reference: Bytes::text(name),
                    target: *target,
                };
                one.wires.iter().map(wire).collect()
            })
            .collect();
        let views: Vec<_> = components
            .iter()
            .enumerate()
            .map(|(place, one)| MemberView {
                path: Bytes::text(one.path),
                class_name: Bytes::text(one.class.name),
                declaration: Bytes::text(one.class.declaration),
                extends: texts[place][0].list(),
                values: values[place].top.as_ptr(),
                value_count: values[place].top.len(),
                period: one.period.map_or(u64::MAX, |period| period.as_nanos() as u64),
                has_broker: u32::from(one.has_broker),
                publishes: texts[place][1].list(),
                loops: texts[place][2].list(),
                wires: wires[place].as_ptr(),
                wire_count: wires[place].len(),
            })
            .collect();
        let missing: Vec<_> =
            fleet.missing().iter().map(|one| Texts::of(one.as_deref().unwrap_or_default())).collect();
        let missing: Vec<_> = missing.iter().map(Texts::list).collect();
        let list = FleetList {
            components: views.as_ptr(),
            component_count: views.len(),
            missing: missing.as_ptr(),
            missing_count: missing.len(),
        };
        let table = self.table;
        // SAFETY: `new`'s caller promised that the function keeps the rules; the rest is lent to this call.
        let (result, findings) = call_with_findings(|findings, error| unsafe {
            (table.check)(table.state, &raw const list, findings, error)
        });
        result.and_then(|()| findings.into_iter().collect())
    }
}

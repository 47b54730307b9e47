use saoms_abi::{Bytes, FleetList, MemberView, RenamedView, RuleTable, TextList, WireView};
use saoms_api::boundary::{PropertyViews, call_with_findings};
use saoms_api::host::present::{Function, Owner, enter};
use saoms_api::rule::FleetView;
use saoms_api::{Failure, Finding};

/// A rule of a plugin.
#[derive(Clone, Copy, Debug)]
pub struct ImportedRule {
    table: RuleTable,
    owner: &'static Owner,
}

// SAFETY: the rules of the boundary say that a rule is pure: any thread may ask it, also several at a time.
unsafe impl Send for ImportedRule {}
// SAFETY: the same.
unsafe impl Sync for ImportedRule {}

impl ImportedRule {
    /// A rule from its table, and the names of rule and library.
    ///
    /// # Safety
    /// The function of the table keeps the rules of [the boundary](saoms_abi), for as long as the program runs.
    pub const unsafe fn new(table: RuleTable, owner: &'static Owner) -> ImportedRule {
        ImportedRule { table, owner }
    }

    /// Checks a fleet with the rule.
    ///
    /// # Errors
    /// The rule fails or panics, or one of its findings cannot be read.
    pub fn check(&self, fleet: &FleetView<'_>) -> Result<Vec<Finding>, Failure> {
        let components = fleet.components();
        let values: Vec<_> = components.iter().map(|one| PropertyViews::of(one.values)).collect();
        let texts: Vec<_> = components
            .iter()
            .map(|one| [&one.class.extends, &one.class.publishes, &one.class.loops].map(|texts| Texts::of(texts)))
            .collect();
        let wires: Vec<Vec<_>> = components
            .iter()
            .map(|one| {
                let wire = |(name, target): &(&str, usize)| WireView { reference: Bytes::text(name), target: *target };
                one.wires.iter().map(wire).collect()
            })
            .collect();
        let renamed: Vec<Vec<_>> = components
            .iter()
            .map(|one| {
                let renamed = |(declared, on_bus): &(&str, &str)| RenamedView {
                    declared: Bytes::text(declared),
                    on_bus: Bytes::text(on_bus),
                };
                one.renamed.iter().map(renamed).collect()
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
                renamed: renamed[place].as_ptr(),
                renamed_count: renamed[place].len(),
                starts: u32::from(one.starts),
            })
            .collect();
        let missing: Vec<_> = fleet.missing().iter().map(|one| Texts::of(one.as_deref().unwrap_or_default())).collect();
        let missing: Vec<_> = missing.iter().map(Texts::list).collect();
        let list = FleetList {
            components: views.as_ptr(),
            component_count: views.len(),
            missing: missing.as_ptr(),
            missing_count: missing.len(),
        };
        let table = self.table;
        let _entered = enter(self.owner, Function::Check);
        // SAFETY: `new`'s caller promised that the function keeps the rules; the rest is lent to this call.
        let (result, findings) = call_with_findings(|findings, error| unsafe {
            (table.check)(table.state, &raw const list, findings, error)
        });
        result.and_then(|()| findings.into_iter().collect())
    }
}

/// Texts as a [`TextList`] lends them.
struct Texts(Vec<Bytes>);

impl Texts {
    fn of(texts: &[&str]) -> Texts {
        Texts(texts.iter().map(|text| Bytes::text(text)).collect())
    }

    fn list(&self) -> TextList {
        TextList { texts: self.0.as_ptr(), count: self.0.len() }
    }
}

use crate::rule::FleetView;

/// A limit of what may change in a fleet while it runs.
///
/// `judge` gets the components of one site, as they are and as they are wanted, those of other programs among them, and
/// says why these may not become those: nothing where they may. It is pure: the same fleets, the same answer.
///
/// ```
/// use saoms_api::extension::{ChangeLimit, ChangeObjection, submit};
/// use saoms_api::rule::FleetView;
///
/// fn judge(present: &FleetView<'_>, wanted: &FleetView<'_>) -> Vec<ChangeObjection> {
///     let shrinks = wanted.components().len() < present.components().len();
///     shrinks.then(|| ChangeObjection::new("this fleet only grows")).into_iter().collect()
/// }
///
/// submit! { ChangeLimit { judge } }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ChangeLimit {
    /// The reasons against a change from the first view to the second one.
    pub judge: fn(&FleetView<'_>, &FleetView<'_>) -> Vec<ChangeObjection>,
}

/// A reason against a change of a fleet that runs.
///
/// ```
/// use saoms_api::extension::ChangeObjection;
///
/// let objection = ChangeObjection::new("the door is locked").about("Door");
/// assert_eq!(objection.component.as_deref(), Some("Door"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChangeObjection {
    /// The reason, for the person who wants the change.
    pub reason: String,
    /// The path of the component that it is about, where it is about one: its place in the composites is shown.
    pub component: Option<String>,
}

impl ChangeObjection {
    /// A reason that is about no component alone.
    pub fn new(reason: impl Into<String>) -> ChangeObjection {
        ChangeObjection { reason: reason.into(), component: None }
    }

    /// The same about the component with this path.
    #[must_use]
    pub fn about(self, component: impl Into<String>) -> ChangeObjection {
        ChangeObjection { component: Some(component.into()), ..self }
    }
}

inventory::collect!(ChangeLimit);

impl ChangeLimit {
    /// The limits that are linked in.
    pub fn linked() -> impl Iterator<Item = &'static ChangeLimit> {
        inventory::iter::<ChangeLimit>()
    }
}

/// What follows of a change of a fleet that runs, where that is not seen from its components: `saoms plan` shows it.
///
/// `tell` gets the components of one site, as they are and as they are wanted, and says what follows, a line each. It
/// is pure: the same fleets, the same answer.
///
/// ```
/// use saoms_api::extension::{ChangeConsequence, submit};
/// use saoms_api::rule::FleetView;
///
/// fn tell(present: &FleetView<'_>, wanted: &FleetView<'_>) -> Vec<String> {
///     let (before, after) = (present.components().len(), wanted.components().len());
///     (before != after).then(|| format!("size of the fleet: {before} -> {after}")).into_iter().collect()
/// }
///
/// submit! { ChangeConsequence { tell } }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ChangeConsequence {
    /// What follows of a change from the first view to the second one, as `blocks (5,0)..(9,9): zone 1 -> zone 2`.
    pub tell: fn(&FleetView<'_>, &FleetView<'_>) -> Vec<String>,
}

inventory::collect!(ChangeConsequence);

impl ChangeConsequence {
    /// The consequences that are linked in.
    pub fn linked() -> impl Iterator<Item = &'static ChangeConsequence> {
        inventory::iter::<ChangeConsequence>()
    }
}

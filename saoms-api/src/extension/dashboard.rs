/// A view of a fleet in the dashboard (`saoms run --serve`): what a crate shows of its domain beside components, topics
/// and alerts.
///
/// `docs/dashboard.md` describes what a view exports, and what the page lends it.
#[derive(Clone, Copy, Debug)]
pub struct DashboardView {
    /// Its name: that of the folder of its files, in small letters and digits.
    pub name: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// Its files by their names, of which the page loads the module `view.js` and the style sheet `view.css`.
    pub files: &'static [(&'static str, &'static str)],
    /// What state topics retain that it shows, which is recorded for runs that are looked at later (`saoms view`).
    pub states: &'static [DashboardState],
    /// Its plots, from what components say of themselves.
    pub plots: &'static [DashboardPlot],
}

/// Figures of a fleet over time, in one plot.
#[derive(Clone, Copy, Debug)]
pub struct DashboardPlot {
    /// The title.
    pub title: &'static str,
    /// The unit, such as `%`; empty without one.
    pub unit: &'static str,
    /// The lines, at most four.
    pub lines: &'static [DashboardLine],
}

/// A figure of a fleet over time: what its components say in a field of their status, as one number.
#[derive(Clone, Copy, Debug)]
pub struct DashboardLine {
    /// What the figure is.
    pub title: &'static str,
    /// The field of the status.
    pub field: &'static str,
    /// How many values become one.
    pub by: Summary,
    /// Whose values: those of components that also have the first of these fields that any component has. Without
    /// fields, those of all components.
    pub of: &'static [&'static str],
}

/// How values of many components become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Summary {
    /// Their sum.
    Sum,
    /// The growth of their sum in a minute.
    PerMinute,
    /// The number of components that have a value.
    Count,
    /// Their mean.
    Mean,
    /// The least of them.
    Least,
}

/// What a [`DashboardView`] shows of the messages of state topics.
#[derive(Clone, Copy, Debug)]
pub struct DashboardState {
    /// The name of the messages, as their declaration has it.
    pub message: &'static str,
    /// The fields that it shows.
    pub fields: &'static [&'static str],
}

inventory::collect!(DashboardView);

impl DashboardView {
    /// The views that are linked into this program, by their names.
    pub fn linked() -> Vec<&'static DashboardView> {
        let mut all: Vec<&DashboardView> = inventory::iter::<DashboardView>().collect();
        all.sort_by_key(|view| view.name);
        all
    }
}

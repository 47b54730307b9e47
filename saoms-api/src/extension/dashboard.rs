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

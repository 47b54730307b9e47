use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::source::Location;

/// The names of properties that settings of networks come from.
pub(crate) const OF_NETWORKS: [&str; 11] = [
    "url", "IP", "port", "transport", "user", "password", "passwordFile", "users", "tlsCa", "tlsCertificate", "tlsKey",
];

/// Where components and their settings of networks are written, for who finds later that they cannot be used.
#[derive(Clone, Debug, Default)]
pub struct ComponentPlaces {
    /// The folder of the first composite, from which the paths of their files start.
    pub folder: PathBuf,
    /// By the paths of components, the places of the values of their properties, and under an empty name that of the
    /// component's own.
    pub(crate) places: BTreeMap<String, Vec<(&'static str, Location)>>,
}

impl ComponentPlaces {
    /// Where a component, by its path, gives a property; or else where its name is.
    pub fn get(&self, component: &str, property: &str) -> Option<Location> {
        let places = self.places.get(component)?;
        let of = |name: &str| places.iter().find(|(known, _)| *known == name).map(|(_, at)| *at);
        of(property).or_else(|| of(""))
    }
}

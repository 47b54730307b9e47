//! Units: the files whose components, wires and properties form one composite.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::outline::Component;
use super::symbol::{is_replica, pieces};
use super::{Scene, reached};

/// The units of a scene, each found when it is needed, and once for all of its files.
#[derive(Debug, Default)]
pub(super) struct Units {
    /// The files that include each file.
    includers: Vec<Vec<usize>>,
    /// The units of files.
    of: Vec<OnceLock<Arc<Unit>>>,
    /// By the files that no other file of the unit includes.
    by_roots: Mutex<HashMap<Vec<usize>, Arc<Unit>>>,
    /// Each file and what it includes, in turn.
    included: Vec<OnceLock<Vec<usize>>>,
}

/// The files of one composite, with the places of names in them.
#[derive(Debug)]
pub(super) struct Unit {
    files: Vec<usize>,
    known: HashSet<usize>,
    /// Each component by its name: its file, and its place in it.
    components: HashMap<String, (usize, usize)>,
    /// The file that declares each property.
    properties: HashMap<String, usize>,
    /// The components whose names have expressions, by the texts before the first one and behind the last one.
    patterns: HashMap<(String, String), Vec<(usize, usize)>>,
    /// The lengths of these texts.
    lengths: BTreeSet<(usize, usize)>,
}

impl Units {
    pub(super) fn new(includes: &[Vec<usize>]) -> Self {
        let mut includers = vec![Vec::new(); includes.len()];
        for (file, included) in includes.iter().enumerate() {
            included.iter().for_each(|one| includers[*one].push(file));
        }
        let (of, included) = (includes.iter().map(|_| OnceLock::new()), includes.iter().map(|_| OnceLock::new()));
        Self { includers, of: of.collect(), included: included.collect(), ..Self::default() }
    }
}

impl Unit {
    fn new(scene: &Scene, files: Vec<usize>) -> Self {
        let (mut components, mut properties) = (HashMap::new(), HashMap::new());
        let mut patterns: HashMap<(String, String), Vec<(usize, usize)>> = HashMap::new();
        for &file in &files {
            let outline = &scene.files[file].outline;
            for (place, component) in outline.components.iter().enumerate() {
                let Entry::Vacant(new) = components.entry(component.name.text.clone()) else { continue };
                new.insert((file, place));
                if let [before, .., behind] = pieces(&component.name.text)[..] {
                    patterns.entry((before.to_owned(), behind.to_owned())).or_default().push((file, place));
                }
            }
            for property in &outline.properties {
                properties.entry(property.text.clone()).or_insert(file);
            }
        }
        let lengths = patterns.keys().map(|(before, behind)| (before.len(), behind.len())).collect();
        let known = files.iter().copied().collect();
        Self { files, known, components, properties, patterns, lengths }
    }

    pub(super) fn component(&self, name: &str) -> Option<(usize, usize)> {
        self.components.get(name).copied()
    }
}

impl Scene {
    pub(super) fn unit(&self, file: usize) -> &Unit {
        self.units.of[file].get_or_init(|| {
            let outer = reached(vec![file], |place| self.units.includers[place].as_slice());
            let mut roots: Vec<usize> =
                outer.iter().copied().filter(|one| self.units.includers[*one].is_empty()).collect();
            roots.sort_unstable();
            let mut units = self.units.by_roots.lock().unwrap_or_else(PoisonError::into_inner);
            let holds_all = |unit: &&Arc<Unit>| outer.iter().all(|one| unit.known.contains(one));
            if let Some(known) = units.get(&roots).filter(holds_all) {
                return Arc::clone(known);
            }
            // Files that include each other have nothing around them.
            let start = if roots.is_empty() { outer.clone() } else { roots.clone() };
            let mut files = reached(start, |place| self.includes[place].as_slice());
            if !outer.iter().all(|one| files.contains(one)) {
                files = reached(outer, |place| self.includes[place].as_slice());
            }
            let unit = Arc::new(Unit::new(self, files));
            units.insert(roots, Arc::clone(&unit));
            unit
        })
    }

    /// The files that form one composite with this one: those that include it, and what all these include.
    pub(crate) fn unit_of(&self, file: usize) -> &[usize] {
        &self.unit(file).files
    }

    /// This file and those that include it, in turn.
    pub(crate) fn including(&self, file: usize) -> HashSet<usize> {
        reached(vec![file], |place| &self.units.includers[place]).into_iter().collect()
    }

    /// This file and what it includes, in turn.
    pub(crate) fn with_included(&self, file: usize) -> &[usize] {
        self.units.included[file].get_or_init(|| reached(vec![file], |place| self.includes[place].as_slice()))
    }

    /// The file that declares a property of the composite that a file is part of.
    pub(crate) fn declaring(&self, file: usize, property: &str) -> Option<usize> {
        let is_own = self.files[file].names().property(property).is_some();
        if is_own { Some(file) } else { self.unit(file).properties.get(property).copied() }
    }

    /// The component of a composite, in all its files, that a name means as one of its replicas.
    pub(crate) fn pattern(&self, file: usize, name: &str) -> Option<(usize, &Component)> {
        let Unit { patterns, lengths, .. } = self.unit(file);
        let written = |&(file, place): &(usize, usize)| (file, &self.files[file].outline.components[place]);
        // Whatever the number is, the name begins and ends as the pattern does.
        let starts = lengths.iter().filter_map(|(before, behind)| {
            let behind = name.len().checked_sub(*behind)?;
            patterns.get(&(name.get(..*before)?.to_owned(), name.get(behind..)?.to_owned()))
        });
        let mut all = starts.flatten().map(written);
        all.find(|(_, one)| is_replica(&one.name.text, name))
    }
}

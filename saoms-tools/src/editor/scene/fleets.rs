//! Fleets: composites that are checked as one.

use std::collections::{BTreeSet, HashMap, HashSet};

use super::outline::Named;
use super::{Scene, reached};

/// Composites that are checked as one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFleet {
    /// The files of its composites, by their places in the scene.
    pub files: Vec<usize>,
    /// True if others elsewhere may use it, so that what it leaves open is no fault.
    pub may_be_part: bool,
}

/// Relations between the composites of a scene, from which the fleets follow.
#[derive(Debug)]
pub(super) struct Fleets {
    /// The composites that each file names, by includes and implementations.
    names: Vec<Vec<usize>>,
    /// The files of the contribution that name each file.
    users: Vec<Vec<usize>>,
    /// The composites that take values from each file.
    owners: HashMap<usize, Vec<usize>>,
    /// The composites that the description of the contribution calls deployable.
    deployed: BTreeSet<usize>,
    /// These and what they name, in turn.
    running: HashSet<usize>,
    /// The namespaces whose composites the contribution gives to others.
    exports: HashSet<String>,
    may_be_part: bool,
}

impl Fleets {
    fn of(scene: &Scene) -> Self {
        let (names, users) = naming(scene);
        let mut owners: HashMap<usize, Vec<usize>> = HashMap::new();
        for (file, one) in scene.files.iter().enumerate() {
            let beside = one.outline.beside.iter().filter_map(|name| scene.beside(file, name));
            let beside: BTreeSet<usize> = beside.collect();
            beside.into_iter().for_each(|one| owners.entry(one).or_default().push(file));
        }
        let described =
            scene.files.iter().enumerate().flat_map(|(file, one)| {
                one.outline.deployables.iter().filter_map(move |name| scene.composite(file, name))
            });
        let deployed: BTreeSet<usize> = described.collect();
        let running =
            reached(deployed.iter().copied().collect(), |place| names[place].as_slice()).into_iter().collect();
        let exports = scene.files[..scene.own].iter().flat_map(|one| one.outline.exports.iter().cloned()).collect();
        let mut fleets = Self { names, users, owners, deployed, running, exports, may_be_part: false };
        let composites = (0..scene.own).filter(|one| scene.files[*one].outline.name.is_some());
        let others = composites.filter(|one| fleets.is_alone(*one)).count();
        fleets.may_be_part = others + usize::from(!fleets.deployed.is_empty()) > 1;
        fleets
    }

    /// True if a composite is a fleet of its own.
    fn is_alone(&self, one: usize) -> bool {
        self.users[one].is_empty() && !self.deployed.contains(&one)
    }
}

impl Scene {
    fn all_fleets(&self) -> &Fleets {
        self.fleets.get_or_init(|| Fleets::of(self))
    }

    /// The fleets that the first file is part of, see [`Scene::fleets_of`].
    pub fn fleets(&self) -> Vec<SceneFleet> {
        self.fleets_of(0)
    }

    /// The fleets that a file is part of, as a check of the whole folder has them: what the description of the
    /// contribution calls deployable is one, and every other composite that no composite names is one of its own. A
    /// file of values is part of those that take values from it.
    pub fn fleets_of(&self, place: usize) -> Vec<SceneFleet> {
        let fleets = self.all_fleets();
        let start: Vec<usize> = match &self.files[place] {
            one if one.is_beside => self.owners_of(place).to_vec(),
            // A description is wrong or right whatever runs.
            one if one.is_description() => match fleets.deployed.first() {
                Some(first) => vec![*first],
                None => (0..self.own).find(|one| *one != place && fleets.is_alone(*one)).into_iter().collect(),
            },
            _ => vec![place],
        };
        if start.is_empty() {
            return Vec::new();
        }
        let around = reached(start.clone(), |place| fleets.users[place].as_slice()).into_iter();
        let alone = around.filter(|one| fleets.is_alone(*one)).map(|root| {
            let is_exported = fleets.exports.contains(&self.files[root].outline.namespace);
            SceneFleet { files: vec![root], may_be_part: fleets.may_be_part || is_exported }
        });
        let mut found: Vec<SceneFleet> = alone.collect();
        if start.iter().any(|one| fleets.running.contains(one)) {
            let deployed = fleets.deployed.iter().copied().collect();
            found.insert(0, SceneFleet { files: deployed, may_be_part: false });
        }
        // Composites that go around in circles have nothing around them.
        if found.is_empty() { vec![SceneFleet { files: vec![start[0]], may_be_part: false }] } else { found }
    }

    /// The files of the fleets that the first one is part of.
    pub(crate) fn fleet_files(&self) -> Vec<usize> {
        let fleets = self.all_fleets();
        let start = if self.file().is_beside { self.owners().to_vec() } else { vec![0] };
        let around = reached(start, |place| fleets.users[place].as_slice());
        reached(around, |place| fleets.names[place].as_slice())
    }

    /// The composites that take values from the first file.
    pub(crate) fn owners(&self) -> &[usize] {
        self.owners_of(0)
    }

    fn owners_of(&self, place: usize) -> &[usize] {
        self.all_fleets().owners.get(&place).map_or(&[], Vec::as_slice)
    }

    /// True if a composite calls the first file so.
    pub(crate) fn is_first(&self, file: usize, name: &Named) -> bool {
        self.beside(file, name) == Some(0)
    }
}

/// The composites that each file names, by includes and implementations, and those of the contribution that name it.
fn naming(scene: &Scene) -> (Vec<Vec<usize>>, Vec<Vec<usize>>) {
    let (mut names, mut users) = (Vec::new(), vec![Vec::new(); scene.files.len()]);
    for place in 0..scene.files.len() {
        let implementations = scene.files[place].outline.components.iter().filter_map(|one| scene.inner(place, one));
        let named: BTreeSet<usize> = scene.includes[place].iter().copied().chain(implementations).collect();
        let others = named.iter().filter(|one| **one != place && !scene.is_imported(place));
        others.for_each(|one| users[*one].push(place));
        names.push(named.into_iter().collect());
    }
    (names, users)
}

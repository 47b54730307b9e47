//! The assembly of a fleet without errors.

use std::path::Path;
use std::sync::Arc;

use saoms_api::Secret;
use saoms_api::extension::RouterClass;
use saoms_api::host::PropertyValue;
use smol_str::SmolStr;

use crate::assembly::{Assembly, ComponentPlaces, ComponentSpec, OF_NETWORKS, Wire, WireTarget, Written};
use crate::check::classes;
use crate::check::component::ComponentCheck;
use crate::check::fleet::Fleet;
use crate::check::fleet::class_index::ClassIndex;
use crate::check::options::ENVIRONMENT;
use crate::check::placement::fault_nodes::FaultNodes;
use crate::check::properties::given_values::ValuePlace;
use crate::check::run_settings;
use crate::check::web::Web;
use crate::check::wiring::Wiring;
use crate::source::{Location, Sources};

/// The assembly of a fleet without errors; `None` if something is taken as given.
pub(crate) fn assemble(
    fleet: &Fleet<'_>,
    checks: Vec<ComponentCheck<'_>>,
    (wiring, mut web): (&Wiring, Web),
    sources: &Sources,
) -> Option<Assembly> {
    // Components that composites implement are in no assembly.
    let mut count = 0;
    let indices = fleet.members.iter().map(|member| {
        count += usize::from(member.runs());
        count.saturating_sub(1)
    });
    let indices: Vec<usize> = indices.collect();
    let mut components = Vec::with_capacity(count);
    let first = fleet.contribution.asked_for().first().map(|first| Path::new(sources.get(first.file()).path()));
    let folder = first.and_then(Path::parent).unwrap_or(Path::new("")).to_owned();
    let mut written = ComponentPlaces { folder, ..ComponentPlaces::default() };
    let fault_nodes = FaultNodes::of(fleet, &checks);
    for (place, check) in checks.into_iter().enumerate() {
        let member = &fleet.members[place];
        if !member.runs() {
            continue;
        }
        if !check.is_sound() {
            return None;
        }
        let class = fleet.class_of(place)?;
        let mut task = check.task;
        if let Some(task) = &mut task
            && let Some(place) = check.given.get("password").map(|given| given.place)
        {
            task.password = task.password.take().map(|secret| from_variable(secret, place, sources));
        }
        let is_on_network = task.as_ref().is_some_and(|task| task.url.is_some());
        let is_router = || RouterClass::linked().any(|router| router.class == class.class.declaration().name);
        let of_networks = if is_on_network || is_router() { &OF_NETWORKS[..] } else { &[] };
        let given = of_networks.iter().filter_map(|name| Some((*name, check.given.get(name)?.place)));
        let places = given.chain([("", member.component.name.location)]).collect();
        written.places.insert(member.path().to_owned(), places);
        let (values, own_texts, places) = check.given.into_own();
        let own_texts = without_secrets(class, &values, own_texts, &places, sources);
        let references = class.references.iter().zip(&wiring[place]).enumerate();
        let references = references.map(|(number, (declared, targets))| Wire {
            reference: declared.name.clone(),
            interface: declared.interface.name.clone(),
            targets: targets
                .iter()
                .flatten()
                .filter_map(|provider| {
                    let class = fleet.class_of(provider.member)?;
                    let service = class.services[provider.service].name.clone();
                    Some(WireTarget { component: indices[provider.member], service })
                })
                .collect(),
            elsewhere: Box::default(),
            web: web.targets.remove(&(place, number)).unwrap_or_default().into(),
            deadline: member
                .component
                .reference(&declared.name)
                .and_then(|one| one.deadline.as_ref())
                .map(|one| one.value),
        });
        components.push(ComponentSpec {
            path: member.path().to_owned(),
            site: member.site.clone(),
            node: member.node.clone(),
            fault_node: fault_nodes.of_member(member),
            class: Arc::clone(class.class),
            library: classes::library(member.component, fleet.contribution, sources),
            values,
            written: own_texts,
            task,
            references: references.collect(),
            loops: check.loops?.specs,
            web: web.services.remove(&place).unwrap_or_default().into(),
        });
    }
    Some(Assembly {
        components,
        elsewhere: Vec::new(),
        node: SmolStr::default(),
        run: run_settings::policy(fleet, sources),
        places: written,
    })
}

/// A secret with the environment variable that it came from, where it did.
fn from_variable(secret: Secret, place: Location, sources: &Sources) -> Secret {
    let file = sources.get(place.file);
    match file.text().split_once('=').filter(|_| file.path() == ENVIRONMENT) {
        Some((name, _)) => secret.from_variable(name),
        None => secret,
    }
}

/// What the composite writes for properties of a class, with what stands for secrets in place of these.
fn without_secrets(
    class: &ClassIndex<'_>,
    values: &[(SmolStr, PropertyValue)],
    written: Written,
    places: &[ValuePlace],
    sources: &Sources,
) -> Written {
    let declared = &class.class.declaration().properties;
    let is_secret = |name: &str| declared.iter().any(|property| property.secret && property.name == name);
    if !values.iter().any(|(name, _)| is_secret(name)) {
        return written;
    }
    let mut shown = written.unwrap_or_else(|| values.into());
    for ((name, value), at) in shown.iter_mut().zip(places) {
        let (true, Some(text), Some(place)) = (is_secret(name), value.as_text(), at.places.first()) else { continue };
        *value = from_variable(Secret::new(text.clone()), *place, sources).shown().as_str().into();
    }
    Some(shown)
}

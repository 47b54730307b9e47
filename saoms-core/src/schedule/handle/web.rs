//! The web: services that are offered there, and whoever calls others.

use std::sync::Arc;

use saoms_lang::assembly::WebService;

use super::Handle;
use crate::web::WebClient;

/// A service that a component of a running fleet offers over the web.
#[derive(Clone, Debug, PartialEq)]
pub struct OfferedService {
    /// The path of the component.
    pub component: String,
    /// The service.
    pub service: WebService,
}

impl Handle {
    /// The services that the components of the fleet offer over the web now, by their paths on the server. Whoever
    /// offers them calls them by [`Order::Call`](crate::schedule::Order::Call).
    pub fn web_services(&self) -> Vec<OfferedService> {
        let mut all = self.shared.look(|engine| {
            let members = engine.slots.iter().filter(|slot| slot.is_member() && !slot.spec.web.is_empty());
            let offered = members.flat_map(|slot| {
                let component = &slot.spec.path;
                slot.spec.web.iter().map(|one| OfferedService { component: component.clone(), service: one.clone() })
            });
            offered.collect::<Vec<_>>()
        });
        all.sort_by(|one, other| one.service.path.cmp(&other.service.path));
        all
    }

    /// Has calls of services of the web made by a client: in the code that gets the control [before components
    /// initialize](crate::schedule::RunningFleet::start_with), and once. Without one, and in virtual time, they fail.
    pub fn use_web(&self, client: Arc<dyn WebClient>) {
        if !self.shared.clock.is_virtual() {
            // A second one would be a mistake of the caller, and changes nothing.
            let _ = self.shared.web.set(client);
        }
    }
}

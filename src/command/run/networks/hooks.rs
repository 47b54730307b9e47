//! What happens in the program when its link to a network is lost, or when an operator asks it something over one.

use std::sync::OnceLock;

use saoms_api::Level;
use saoms_control::{ControlServer, NetworkDoor, refuse};
use saoms_core::network::control::{ControlRequest, Reply};
use saoms_core::schedule::{Handle, NetworkHooks, Order};
use saoms_lang::model::Hangup;

use super::super::ending::OperatorEnd;

/// Who orders the emergency stop when a link is lost.
const LOST_LINK: &str = "lost-link";

/// The server of this program for what operators ask over a network; none until it has begun, or without one.
#[derive(Debug, Default)]
pub(in crate::command::run) struct Door(OnceLock<Option<NetworkDoor>>);

impl Door {
    /// Serves from now on, or never.
    pub(in crate::command::run) fn open(&self, server: Option<&ControlServer>) {
        // Nobody else sets it.
        let _ = self.0.set(server.map(ControlServer::door));
    }
}

/// What a network asks of the program.
pub(super) struct Hooks {
    pub(super) fleet: Handle,
    /// What a lost link leads to.
    pub(super) lost_link: Hangup,
    pub(super) ending: OperatorEnd,
    pub(super) door: std::sync::Arc<Door>,
}

impl NetworkHooks for Hooks {
    fn lose(&self) {
        let warn = |text: String| self.fleet.note(Level::Warning, text);
        match self.lost_link {
            Hangup::GoOn => {}
            Hangup::Hold => {
                warn("all that moves is stopped until `saoms release`".to_owned());
                let stop = Order::EmergencyStop { components: Vec::new(), by: Some(LOST_LINK.to_owned()) };
                if let Err(error) = self.fleet.order(stop, None) {
                    warn(format!("nothing is stopped: {error}"));
                }
            }
            Hangup::End => {
                warn("the run ends".to_owned());
                self.ending.interrupt(&self.fleet);
            }
        }
    }

    fn is_interrupted(&self) -> bool {
        self.ending.has_come()
    }

    fn control(&self, request: ControlRequest, reply: Reply) {
        match self.door.0.get() {
            Some(Some(door)) => door.serve(request, reply),
            Some(None) => refuse(&reply, 403, "it runs with `--control none`: operators cannot reach it"),
            None => refuse(&reply, 503, "it starts"),
        }
    }
}

//! What a composite says of the run of its fleet.

use super::Loader;
use super::vocabulary::{COMPOSITE, own_names};
use crate::diagnostic::{Diagnostic, codes, nearest, quoted};
use crate::model::{AddressHelp, Hangup, HttpAddress, RunSettings, SAOMS_NAMESPACE};
use crate::source::{Located, Text};
use crate::syntax::{Element, escaped};

impl Loader<'_> {
    /// Reads the attributes of SAOMS in the start tag of a composite.
    pub(super) fn run_settings(&mut self, root: Element<'_>) -> RunSettings {
        let known = own_names(&COMPOSITE).filter_map(|name| root.attribute_in(SAOMS_NAMESPACE, name));
        let written: Vec<Text> = known.map(|one| Located::new(one.name().into(), one.location())).collect();
        if written.is_empty() {
            return RunSettings::default();
        }
        let settings = RunSettings {
            alert_url: self.alert_url(root),
            alert_token_env: self.variable(root, "alertTokenEnv"),
            alert_command: self.own(root, "alertCommand"),
            hangup: self.hangup(root, "hangup"),
            lost_link: self.hangup(root, "lostLink"),
            default_node: self.own(root, "defaultNode"),
            written,
        };
        if let Some(token) = root.attribute_in(SAOMS_NAMESPACE, "alertTokenEnv")
            && root.attribute_in(SAOMS_NAMESPACE, "alertUrl").is_none()
        {
            let prefix = token.prefix().unwrap_or_default();
            let message = format!("{} needs the attribute `{prefix}:alertUrl`", quoted(token.name()));
            let one = Diagnostic::new(&codes::MISSING_ATTRIBUTE, token.name_location(), message);
            self.report(
                one.help("add the address for which the token is; a command can read a token from its environment"),
            );
        }
        settings
    }

    fn alert_url(&mut self, root: Element<'_>) -> Option<Located<HttpAddress>> {
        let text = self.own(root, "alertUrl")?;
        match HttpAddress::parse(&text, &AddressHelp::ALERTS) {
            Ok(address) => Some(Located::new(address, text.location)),
            Err(fault) => {
                let message = format!("{} {}", quoted(&text), fault.message);
                let mut one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, text.location, message).help(fault.help);
                if let Some(meant) = fault.meant {
                    one = one.mend(format!("replace it with {}", quoted(&meant)), escaped(&meant));
                }
                self.report(one);
                None
            }
        }
    }

    /// The value of an attribute that says what a loss leads to.
    fn hangup(&mut self, root: Element<'_>, name: &'static str) -> Option<Located<Hangup>> {
        let text = self.own(root, name)?;
        if let Some(value) = Hangup::from_name(&text) {
            return Some(Located::new(value, text.location));
        }
        let plain: String = text.chars().filter(|letter| letter.is_alphanumeric()).collect();
        let meant = match plain.to_ascii_lowercase().as_str() {
            "goon" | "continue" | "ignore" | "none" | "nothing" | "run" => Some(Hangup::GoOn.name()),
            "estop" | "emergencystop" | "pause" => Some(Hangup::Hold.name()),
            "stop" | "exit" | "terminate" | "down" | "quit" => Some(Hangup::End.name()),
            other => nearest(other, Hangup::ALL.map(Hangup::name)),
        };
        let attribute = root.attribute_in(SAOMS_NAMESPACE, name)?;
        let message = format!("{} is {}, expected `end`, `hold` or `goOn`", quoted(attribute.name()), quoted(&text));
        self.value_fault(attribute, message, meant);
        None
    }
}

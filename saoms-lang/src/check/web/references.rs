//! References that lead to HTTP servers: each has an address, and a class that may wait for the answer.

use std::collections::{BTreeMap, HashSet};
use std::net::IpAddr;

use super::{operations, wrong_address};
use crate::assembly::WebTarget;
use crate::check::fleet::Fleet;
use crate::check::report::Report;
use crate::check::wiring::{WebEnd, WebEnds};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{AddressFault, AddressHelp, Binding, HttpAddress, Part, ReferenceElement};
use crate::source::Location;

/// What encrypts on the way to a server.
const PROXIES: &str = "`stunnel`, `nginx` or a tunnel of `ssh -L`";

/// Where references lead on the web. Faults are reported.
pub(super) fn check(
    fleet: &Fleet<'_>,
    ends: &WebEnds<'_>,
    report: &mut Report<'_>,
) -> BTreeMap<(usize, usize), Vec<WebTarget>> {
    let mut all = BTreeMap::new();
    // Replicas and uses of one composite share what is written.
    let mut told: HashSet<Location> = HashSet::new();
    for (&(member, place), ends) in ends {
        let Some(class) = fleet.class_of(member) else { continue };
        report.about(&fleet.members[member]);
        let declared = class.references[place];
        let name = quoted(&declared.name);
        if !class.class.declaration().apart {
            let component = quoted(fleet.members[member].path());
            let class = quoted(class.class.name());
            let message = format!(
                "reference {name} of {component} leads to a web server: a call waits for its answer, and class {class} \
                 is not `apart`"
            );
            let one = Diagnostic::new(&codes::WEB_REFERENCE, ends[0].place(), message);
            report.push(one.help(
                "call from a class that declares `apart`: its components run on threads of their own, and others wire \
                 to one of them",
            ));
            continue;
        }
        let operations = match operations(&declared.interface) {
            Ok(operations) => operations,
            Err(why) => {
                let interface = quoted(&declared.interface.name);
                let message =
                    format!("the interface {interface} of reference {name} cannot be called over the web: {why}");
                report.push(Diagnostic::new(&codes::WEB_REFERENCE, ends[0].place(), message));
                continue;
            }
        };
        let targets = ends.iter().filter_map(|end| {
            let is_new = told.insert(end.place());
            let address = match address(end.binding) {
                Ok(address) => address,
                Err(one) => {
                    if is_new {
                        report.push(*one);
                    }
                    return None;
                }
            };
            let token = end.reference.token_env.as_ref();
            let place = token.map_or(end.place(), |name| name.location);
            let token_env = token.map(|name| name.to_string());
            Some(WebTarget { address, token_env, operations: operations.clone(), place })
        });
        all.insert((member, place), targets.collect());
    }
    report.about_all();
    all
}

/// The address to which a binding leads.
fn address(binding: &Binding) -> Result<HttpAddress, Box<Diagnostic>> {
    let Some(uri) = binding.uri.as_ref().filter(|uri| !uri.is_empty()) else {
        let message = "`binding.rest` of a reference has no `uri`";
        let one = Diagnostic::new(&codes::WEB_ADDRESS, binding.tag(), message);
        return Err(Box::new(one.help("write the address of the service: `uri=\"http://host:port/path\"`")));
    };
    let address = HttpAddress::parse(uri, &AddressHelp::SERVICES)
        .map_err(|fault| Box::new(wrong_address(uri, uri.location, fault)))?;
    if address.target.contains('?') {
        let fault = AddressFault {
            message: "has a query after `?`: the operation follows the path".to_owned(),
            help: "leave the query out; arguments are in the body of the request".to_owned(),
            meant: None,
        };
        return Err(Box::new(wrong_address(uri, uri.location, fault)));
    }
    Ok(address)
}

/// Reports tokens of references that lead to no server, or to several, each of which would get it.
pub(super) fn tokens(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    let of_members = fleet.members.iter().flat_map(|member| &member.component.references);
    let of_units = fleet.units.iter().flat_map(|unit| unit.references());
    let mut told: HashSet<Location> = HashSet::new();
    for reference in of_members.chain(of_units) {
        let Some(token) = &reference.token_env else { continue };
        if !told.insert(token.location) {
            continue;
        }
        let servers = servers(reference);
        let one = match servers.len() {
            1 if servers.iter().all(is_on_this_machine) => continue,
            1 => {
                let message = format!(
                    "the token of reference {} leaves this machine unencrypted: everybody in the network can read it",
                    quoted(&reference.name)
                );
                let one = Diagnostic::new(&codes::WEB_TOKEN, token.location, message).severity(Severity::Warning);
                one.help(format!("reach the server by a proxy on this machine that encrypts: {PROXIES}"))
            }
            0 => {
                let message = format!("the token of reference {} is for no server", quoted(&reference.name));
                let one = Diagnostic::new(&codes::WEB_TOKEN, token.location, message).severity(Severity::Warning);
                one.help("remove `tokenEnv`, or let a `binding.rest` of this reference lead to a server")
            }
            count => {
                let message =
                    format!("each of the {count} servers of reference {} would get its token", quoted(&reference.name));
                let one = Diagnostic::new(&codes::WEB_TOKEN, token.location, message);
                one.help("let each server have a reference, or a component, of its own")
            }
        };
        report.push(one);
    }
}

/// The servers to which a reference leads; one whose address is wrong, which is reported, counts as one of this
/// machine.
fn servers(reference: &ReferenceElement) -> HashSet<(String, u16)> {
    let ends = WebEnd::of(reference);
    let server = |end: WebEnd<'_>| address(end.binding).map(|address| (address.host, address.port));
    ends.map(|end| server(end).unwrap_or_default()).collect()
}

fn is_on_this_machine((host, _): &(String, u16)) -> bool {
    host.is_empty()
        || host.eq_ignore_ascii_case("localhost")
        || host.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
}

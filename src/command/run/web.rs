//! The web: who calls the services there, and what has to be said of those that the fleet offers.

use std::collections::{BTreeSet, HashMap};
use std::env;
use std::sync::Arc;

use saoms_api::Level;
use saoms_control::{HttpClient, Token};
use saoms_core::schedule::Handle;
use saoms_lang::assembly::{Assembly, WebTarget};
use saoms_lang::diagnostic::{Diagnostic, codes, quoted};

use super::RunArguments;
use super::control;
use crate::Exit;
use crate::output::eprint;

/// Paths of services that are named in the log.
const SHOWN: usize = 8;

/// What a run does on the web.
#[derive(Debug, Default)]
pub(super) struct Web {
    /// The client for the services that components call; `None` where none is called.
    client: Option<HttpClient>,
    /// Where services are offered.
    paths: Vec<String>,
    /// Why `--allow-web` has no effect.
    idle: Option<&'static str>,
}

/// The web servers that the references of a fleet lead to, each with the environment variable whose token it gets.
#[derive(Clone, Debug, Default)]
pub(super) struct WebAccesses(BTreeSet<(String, Option<String>)>);

impl WebAccesses {
    pub(super) fn of(assembly: &Assembly) -> WebAccesses {
        let wires = assembly.components.iter().flat_map(|component| &component.references);
        let targets = wires.flat_map(|wire| &wire.web);
        let access = |target: &WebTarget| (target.address.authority.to_ascii_lowercase(), target.token_env.clone());
        WebAccesses(targets.map(access).collect())
    }

    /// Why a running fleet with these cannot become one with others: `--allow-web` was given, and tokens were read, for
    /// what the composites said at the start. `None` where there are no new ones.
    pub(super) fn refusal(&self, wanted: &WebAccesses) -> Option<String> {
        let (server, token) = wanted.0.difference(&self.0).next()?;
        let with = token.as_ref().map(|name| format!(" with the token in `{name}`")).unwrap_or_default();
        Some(format!("references lead to `http://{server}`{with}, and did not when the fleet started: restart it"))
    }
}

impl Web {
    /// What an assembly needs of the web. What is missing is added to `diagnostics`.
    pub(super) fn of(arguments: &RunArguments, assembly: &Assembly, diagnostics: &mut Vec<Diagnostic>) -> Web {
        let mut web = Web::default();
        let services = || assembly.components.iter().flat_map(|spec| &spec.web);
        web.paths = services().map(|service| service.path.to_string()).collect();
        if let Some(first) = services().next().filter(|_| !control::is_reached(arguments)) {
            let message = "the services that are offered over the web are not served: this run has no control server";
            let one = Diagnostic::new(&codes::WEB_UNSERVED, first.place, message);
            diagnostics.push(one.help("serve them: `--serve 127.0.0.1:8080`"));
        }
        let wires = assembly.components.iter().flat_map(|spec| &spec.references);
        let targets: Vec<&WebTarget> = wires.flat_map(|wire| &wire.web).collect();
        let Some(first) = targets.first() else {
            web.idle = arguments.allow_web.then_some("nothing to allow: no reference leads to a web server");
            return web;
        };
        if arguments.virtual_time {
            web.idle =
                arguments.allow_web.then_some("no effect with `--virtual`: no web server is called in virtual time");
            let message = "web servers are not called in virtual time: calls of them fail";
            let one = Diagnostic::new(&codes::WEB_UNSERVED, first.place, message);
            diagnostics.push(one.help(
                "run in real time; for a simulation, wire the reference to a component that stands for the server",
            ));
            return web;
        }
        if !arguments.allow_web {
            diagnostics.push(not_allowed(first, &targets));
            return web;
        }
        let mut tokens = HashMap::new();
        for target in targets {
            let Some(name) = target.token_env.as_ref().filter(|name| !tokens.contains_key(*name)) else { continue };
            let token = match token(name) {
                Ok(token) => Some(token),
                Err((why, help)) => {
                    diagnostics.push(Diagnostic::new(&codes::WEB_TOKEN, target.place, why).help(help));
                    None
                }
            };
            tokens.insert(name.clone(), token);
        }
        let tokens = tokens.into_iter().filter_map(|(name, token)| Some((name, token?)));
        web.client = Some(HttpClient::new(tokens.collect()));
        web
    }

    /// Refuses an option without effect, which is reported.
    pub(super) fn judge(&self) -> Result<(), Exit> {
        let Some(why) = self.idle else { return Ok(()) };
        eprint(&format!("error: `--allow-web` has {why}\n  = help: leave it out\n\n1 error: nothing was started\n"));
        Err(Exit::WrongInput)
    }

    /// Calls services of the web for a fleet from now on, and says where its own are offered.
    pub(super) fn start(self, handle: &Handle, url: Option<&str>, is_served: bool) {
        if let Some(client) = self.client {
            handle.use_web(Arc::new(client));
        }
        if !is_served || self.paths.is_empty() {
            return;
        }
        let mut paths = self.paths.iter().take(SHOWN).map(|path| format!("`{path}`")).collect::<Vec<_>>().join(", ");
        if self.paths.len() > SHOWN {
            paths += &format!(" and {} more", self.paths.len() - SHOWN);
        }
        handle.note(Level::Info, match url {
            Some(url) => format!("offers services over the web at {url}: {paths}"),
            None => format!(
                "offers services over the web at its socket alone, {paths}: `--serve ADDRESS:PORT` offers them on the \
                 network"
            ),
        });
    }
}

/// The fault of a fleet that would call servers without being allowed to.
fn not_allowed(first: &WebTarget, targets: &[&WebTarget]) -> Diagnostic {
    let servers = listed(targets.iter().map(|target| format!("http://{}", target.address.authority)));
    let tokens = listed(targets.iter().filter_map(|target| target.token_env.clone()));
    let with =
        if tokens.is_empty() { String::new() } else { format!(", with tokens of the environment from {tokens}") };
    let message = format!("references lead to the web, to {servers}{with}: `--allow-web` is missing");
    Diagnostic::new(&codes::WEB_NOT_ALLOWED, first.place, message).help(
        "allow it with `--allow-web`, if you trust the composite: it decides where requests and tokens of the \
         environment go",
    )
}

/// Names, each once, as far as a line has room.
fn listed(names: impl Iterator<Item = String>) -> String {
    let names: BTreeSet<String> = names.collect();
    let shown: Vec<String> = names.iter().take(SHOWN).map(|name| quoted(name)).collect();
    let more = names.len().saturating_sub(SHOWN);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    shown.join(", ") + &more
}

/// The token in an environment variable, or what is wrong with it and what to do.
fn token(name: &str) -> Result<Token, (String, &'static str)> {
    let Some(value) = env::var_os(name).filter(|value| !value.is_empty()) else {
        let why = format!("the environment variable {} is not set", quoted(name));
        return Err((why, "set it to the token that the server asks for"));
    };
    // Its text is shown nowhere.
    value.to_str().and_then(Token::of).ok_or_else(|| {
        let why = format!("the environment variable {} holds no token", quoted(name));
        (why, "a token has visible ASCII characters alone, at most 1024")
    })
}

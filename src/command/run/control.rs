//! The server with which operators reach the running fleet (`saoms status`, `saoms down`).

use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use clap::Args;
use saoms_api::Level;
use saoms_api::host::one_line;
use saoms_control::{
    AlertList, ControlServer, ControlledFleet, FigureWatch, FleetDescription, Listener, LogTail, LossCounts,
    NetworkError, NetworkListener, Places, SentLine, TokenFile, Tokens, TopicWatch, default_socket, token_beside,
    view_token_beside,
};
use saoms_core::observe::Observer;
use saoms_core::schedule::Handle;

use super::RunArguments;
use super::changes::FleetChanges;
use super::ending::Signalled;
use super::events::{Languages, Numbers, Sent};
use super::history;
use super::picture;
use crate::Exit;
use crate::output::{displayed, eprint};

/// The value of `--control` for a fleet that nobody can reach.
const NONE: &str = "none";

/// Where a fleet is reached over the network.
#[derive(Clone, Debug, Args)]
pub(crate) struct NetworkArguments {
    /// Also serve the dashboard, and clients with a token, at this address, such as `127.0.0.1:8080`; with port 0 the
    /// system chooses a port. Without `--token-file` and `--view-token-file`, new tokens are written to files beside
    /// the socket
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub(crate) serve: Option<String>,

    /// The file with the token for `--serve` that allows everything: at least 16 visible characters; no other user may
    /// be able to read the file
    #[arg(long, value_name = "FILE", requires = "serve")]
    pub(crate) token_file: Option<PathBuf>,

    /// The file with the token for `--serve` that allows to see everything, and to order nothing
    #[arg(long, value_name = "FILE", requires = "serve")]
    pub(crate) view_token_file: Option<PathBuf>,

    /// Allow `--serve` at an address that other machines can reach, although nothing is encrypted: anyone who can read
    /// the network traffic gets the token, and can control the fleet
    #[arg(long, requires = "serve")]
    pub(crate) serve_unencrypted: bool,
}

/// The places at which the fleet will be reached.
pub(super) struct Control {
    places: Places,
    description: FleetDescription,
    /// The log of the fleet, an observer of it.
    log: Arc<LogTail>,
    /// The topics of the fleet, an observer of it.
    topics: Arc<TopicWatch>,
    /// Its figures, an observer of it.
    figures: Arc<FigureWatch>,
}

impl Control {
    /// Listens where the command line says, or where the commands look. In virtual time nobody listens unless that is
    /// asked for. Why a place that was named cannot be used is reported; one that was not named is done without.
    pub(super) fn of(
        arguments: &RunArguments,
        figures: &Arc<FigureWatch>,
        notes: &mut Vec<String>,
    ) -> Result<Option<Control>, Exit> {
        let mut description = description(arguments);
        let usual = default_socket(&description.name, description.pid);
        let socket = match arguments.control.as_deref() {
            _ if !has_socket(arguments) => None,
            Some(path) => {
                let told = |error| unusable(&format!("--control {}", displayed(Path::new(path))), &error, "");
                Some(Listener::bind(Path::new(path)).map_err(told)?)
            }
            None => Listener::bind(&usual)
                .inspect_err(|error| {
                    notes.push(format!("commands such as `saoms status` cannot reach this fleet: {error}"));
                })
                .ok(),
        };
        let beside = arguments.control.as_deref().filter(|path| *path != NONE).map_or(usual.as_path(), Path::new);
        let network = network(&arguments.network, beside)?;
        description.url = network.as_ref().map(NetworkListener::url);
        let file = |token: &TokenFile| token.path().display().to_string();
        description.token_file = network.as_ref().map(|network| file(&network.tokens().control));
        description.view_token_file = network.as_ref().map(|network| file(&network.tokens().view));
        let places = Places { socket, network };
        let is_reached = places.socket.is_some() || places.network.is_some();
        let (log, topics, figures) = (Arc::default(), Arc::default(), Arc::clone(figures));
        Ok(is_reached.then_some(Control { places, description, log, topics, figures }))
    }

    /// Its address on the network.
    pub(super) fn url(&self) -> Option<&str> {
        self.description.url.as_deref()
    }

    /// The observers of the fleet with which it serves.
    pub(super) fn observers(&self) -> [Arc<dyn Observer>; 2] {
        [Arc::clone(&self.log) as _, Arc::clone(&self.topics) as _]
    }

    /// Serves operators from now on.
    pub(super) fn serve(
        self,
        handle: &Handle,
        signals: &Signalled,
        numbers: &Numbers,
        losses: LossCounts,
        alerts: &Arc<AlertList>,
        changes: &Arc<FleetChanges>,
    ) -> Option<ControlServer> {
        let Control { places, description, log, topics, figures } = self;
        let place =
            description.url.clone().zip(description.token_file.clone()).zip(description.view_token_file.clone());
        let languages = Mutex::new(Languages::of(("(operators)", "a line of an operator"), numbers));
        let fleet = handle.clone();
        let send = move |line: &str| {
            let sent = languages.lock().unwrap_or_else(PoisonError::into_inner).send(line, &fleet)?;
            Ok(match sent {
                Sent::Events(count) => SentLine::Events(count),
                // What takes effect later has no answer yet.
                Sent::Order(_, Some(at)) if at > fleet.progress().time => SentLine::Events(1),
                Sent::Order(ticket, _) => SentLine::Order(ticket),
            })
        };
        let (fleet, ending) = (handle.clone(), signals.ending());
        let fleet =
            ControlledFleet::new(description, handle.clone(), (log, topics, Arc::clone(alerts)), send, move || {
                ending.down(&fleet)
            });
        let (drawn, changed) = (Arc::clone(changes), Arc::clone(changes));
        let fleet =
            fleet.with_figures(figures).with_losses(losses).with_picture(move || picture::drawn(&drawn.present()));
        let fleet = fleet.with_changes(move |request, withdrawal| changed.answer(&request, withdrawal));
        match ControlServer::start(places, fleet) {
            Ok(server) => {
                if let Some(((url, file), view)) = place {
                    let text = format!("is served at {url}, with the token in `{file}`; to see alone, `{view}`");
                    handle.note(Level::Info, text);
                }
                Some(server)
            }
            Err(error) => {
                let text = format!("commands such as `saoms status` cannot reach this fleet: {error}");
                handle.note(Level::Warning, text);
                None
            }
        }
    }
}

/// True if the command line wants a socket: in virtual time, a run that is over soon has none unless it is named.
fn has_socket(arguments: &RunArguments) -> bool {
    match arguments.control.as_deref() {
        Some(place) => place != NONE,
        None => !arguments.virtual_time || arguments.stay || arguments.paused || arguments.speed.is_some(),
    }
}

/// True if somebody can reach the fleet, as far as the command line says.
pub(super) fn is_reached(arguments: &RunArguments) -> bool {
    has_socket(arguments) || arguments.network.serve.is_some()
}

/// Listens on the network if the command line says so, with the tokens in its files, or new ones beside the socket.
fn network(arguments: &NetworkArguments, socket: &Path) -> Result<Option<NetworkListener>, Exit> {
    let Some(address) = &arguments.serve else { return Ok(None) };
    let token = |option: &str, given: &Option<PathBuf>, beside: PathBuf| match given {
        Some(file) => {
            TokenFile::given(file).map_err(|error| unusable(&format!("{option} {}", displayed(file)), &error, ""))
        }
        None => TokenFile::create(&beside).map_err(|error| {
            let help = format!("  = help: name a file with a token: `{option}`\n");
            unusable(&format!("--serve {}", one_line(address)), &format!("`{}`: {error}", displayed(&beside)), &help)
        }),
    };
    let control = token("--token-file", &arguments.token_file, token_beside(socket))?;
    let view = token("--view-token-file", &arguments.view_token_file, view_token_beside(socket))?;
    let tokens = Tokens { control, view };
    if tokens.are_one() {
        let why = "it holds the token of `--token-file`: who may see the fleet could control it";
        let help = "  = help: write another token into one of the two files\n";
        return Err(unusable(&format!("--view-token-file {}", displayed(tokens.view.path())), &why, help));
    }
    let bound = NetworkListener::bind(address, arguments.serve_unencrypted, tokens).map_err(|error| {
        let help = match &error {
            NetworkError::NotLoopback(_) => {
                "  = help: reach 127.0.0.1 from there through a tunnel such as `ssh -L`, or allow it with `--serve-unencrypted`\n"
            }
            NetworkError::Malformed(_) | NetworkError::System(_) => "",
        };
        unusable(&format!("--serve {}", one_line(address)), &error, help)
    })?;
    Ok(Some(bound))
}

/// Reports that a place of the command line cannot be used.
fn unusable(option: &str, error: &impl Display, help: &str) -> Exit {
    eprint(&format!("error: `{option}`: {error}\n{help}\n1 error: nothing was started\n"));
    Exit::WrongInput
}

/// The name by which commands know the fleet.
pub(super) fn fleet_name(arguments: &RunArguments) -> String {
    let stem = arguments.fleet.files.first().and_then(|path| path.file_stem()).filter(|stem| *stem != "-");
    stem.map_or_else(|| "fleet".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

fn description(arguments: &RunArguments) -> FleetDescription {
    let files = &arguments.fleet.files;
    FleetDescription {
        name: fleet_name(arguments),
        pid: std::process::id(),
        composites: files.iter().map(|path| path.display().to_string()).collect(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        started: SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs(),
        is_virtual: arguments.virtual_time,
        url: None,
        token_file: None,
        view_token_file: None,
        history: history::path(arguments).map(|path| path.display().to_string()),
        seed: arguments.seed,
    }
}

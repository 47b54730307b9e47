//! Programs of a fleet, which exchange their messages over the transport of Zenoh.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use saoms_core::network::control::{ControlRequest, Reply};
use saoms_core::network::exchange;
use saoms_core::network::transport::{Opened, SessionSettings, Transport, TransportSession};
use saoms_core::network::{Client, Entrance, Membership, Port};
use saoms_core::schedule::{NetworkHooks, RunningFleet, Settings, StartError};

use super::common::composite::{Composite, Task};
use super::common::deploy;
use super::{MARGIN, Outcome, PERIOD, Part, Program};

/// Time without a sign of life after which a program is missed, in nanoseconds.
const PATIENCE: u64 = 1_000_000_000;
/// Bytes of events that are kept: as in the command.
const LIMIT: usize = 256 << 20;

/// A program that nobody asks.
struct Alone;

impl NetworkHooks for Alone {
    fn is_interrupted(&self) -> bool {
        false
    }

    fn lose(&self) {}

    fn control(&self, _request: ControlRequest, _reply: Reply) {}
}

/// Runs one of the programs.
pub(super) fn run(program: &Program) -> Outcome<()> {
    let url = format!("127.0.0.1:{}", program.port);
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/release/libsaoms_zenoh.so");
    let transport = Transport::find(&url, &[library])?;
    let is_router = matches!(program.part, Part::Router);
    let settings = SessionSettings {
        url: url.clone(),
        listen: is_router,
        peer: None,
        account: None,
        users: Vec::new(),
        access: Vec::new(),
        tls: None,
    };
    let port: Arc<Port> = Arc::default();
    let session = match TransportSession::open(transport, &settings, Arc::clone(&port) as Arc<_>)? {
        Opened::Session(session) => session,
        Opened::Unreachable(why) => return Err(why.into()),
    };
    if is_router {
        loop {
            sleep(MARGIN);
        }
    }
    let seconds = Duration::from_secs(program.seconds.into());
    let limit = match program.part {
        Part::Sink => 2 * MARGIN + seconds,
        _ => MARGIN + seconds + MARGIN / 2,
    };
    let settings = Settings { limit: Some(limit), ..Settings::default() };
    let kind = if matches!(program.part, Part::Sink) { "Sink" } else { "Source" };
    let name = format!("{kind}{}", std::process::id());
    let text = composite(program, &name, &url);
    let mut client = None;
    let fleet = RunningFleet::start_with(deploy::checked(text)?.assembly, settings, Vec::new(), |handle| {
        let fleet = handle.use_network(&url, &port, Alone);
        let member = exchange::Settings {
            program: u64::from(std::process::id()),
            began: 0,
            name: name.clone(),
            patience: PATIENCE,
            limit: LIMIT,
            linger: 0,
            components: BTreeSet::from([name.clone()]),
            others: BTreeSet::new(),
            memory: None,
        };
        let (mut entrance, membership) = (Entrance::default(), Membership::default());
        let failed = |error| StartError::Network { url: url.clone(), error };
        entrance.add(session, &port, member, &membership, false, Instant::now()).map_err(failed)?;
        if let Some(entered) = entrance.into_all().pop() {
            client.insert(Client::prepare(entered, membership, fleet).map_err(failed)?).begin();
        }
        Ok(())
    })?;
    let ended = deploy::finish(fleet).map(|_| ());
    drop(client);
    ended
}

fn composite(program: &Program, name: &str, url: &str) -> String {
    let mut composite = Composite::new();
    let mut add = |class, period, delay, properties: &[(&str, &str)]| {
        let properties: Vec<_> = properties.iter().copied().chain([("url", url)]).collect();
        composite.add(&Task { class, name: name.to_owned(), period, delay }, &properties);
    };
    match program.part {
        Part::Source { messages } => {
            let (messages, executions) = (messages.to_string(), (program.seconds * 1_000).to_string());
            let properties = [("messages", messages.as_str()), ("executions", &executions)];
            add("bench.Source", PERIOD, MARGIN, &properties);
        }
        _ => {
            let properties = [("trigger", "BENCHMARK"), ("minimum", "1us"), ("queue", "1000000")];
            add("bench.Sink", Duration::from_secs(1), Duration::ZERO, &properties);
        }
    }
    composite.finish()
}

//! The running fleet that a command is for.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use saoms_api::host::one_line;
use saoms_api::rule::nearest;
use saoms_control::{Client, ClientError, FleetDescription, Response, Token, running};
use serde_json::Value;

use crate::Exit;
use crate::arguments::Format;
use crate::output::{displayed, eprint, eprint_json, print_json};

/// The variable of the environment that names the file with the token.
const TOKEN_FILE: &str = "SAOMS_TOKEN_FILE";

/// Options of commands for a running fleet.
#[derive(Clone, Debug, Args)]
pub(crate) struct RunningFleetArguments {
    /// The fleet, if several run on this machine: its name, its process ID, or the path of its socket. `saoms ps` lists
    /// them. `http://ADDRESS:PORT` is one that `saoms run --serve` serves
    #[arg(long = "fleet", value_name = "NAME")]
    pub(crate) name: Option<String>,

    /// The file with the token for a fleet at an address; without this option, the file that `SAOMS_TOKEN_FILE` names
    #[arg(long, value_name = "FILE", requires = "name")]
    pub(crate) token_file: Option<PathBuf>,

    /// The format of the answer: for people, or JSON
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub(crate) format: Format,
}

impl RunningFleetArguments {
    /// The fleet that is meant. Why there is none is reported.
    pub(crate) fn client(&self) -> Result<Client, Exit> {
        match self.name.as_deref() {
            Some(url) if url.contains("://") => return self.client_of_network(url),
            Some(path) if path.contains('/') => return Ok(Client::new(Path::new(path))),
            _ => {}
        }
        let all = running();
        let is_meant = |one: &FleetDescription| match self.name.as_deref() {
            None => true,
            Some(name) => one.name == name || one.pid.to_string() == name || unique(one) == name,
        };
        let mut meant = all.iter().filter(|(_, one)| is_meant(one));
        match (meant.next(), meant.next()) {
            (Some((client, _)), None) => Ok(client.clone()),
            (found, _) => Err(self.refuse(&unclear(self.name.as_deref(), found.is_some(), &all), Exit::WrongInput)),
        }
    }

    fn client_of_network(&self, url: &str) -> Result<Client, Exit> {
        let named = self.token_file.clone().or_else(|| std::env::var_os(TOKEN_FILE).map(PathBuf::from));
        let Some(file) = named else {
            let message = format!(
                "the fleet at `{}` requires a token\n  = help: name its file with `--token-file`, or with `{TOKEN_FILE}`",
                one_line(url)
            );
            return Err(self.refuse(&message, Exit::WrongInput));
        };
        let token = Token::read(&file).map_err(|error| {
            self.refuse(&format!("the token in `{}` cannot be used: {error}", displayed(&file)), Exit::WrongInput)
        })?;
        Client::of_network(url, token)
            .map_err(|error| self.refuse(&format!("`--fleet {}`: {error}", one_line(url)), Exit::WrongInput))
    }

    /// Sends a request to the fleet that is meant. What hinders it is reported.
    pub(crate) fn request(&self, method: &str, path: &str, body: &str) -> Result<Response, Exit> {
        let client = self.client()?;
        client.request(method, path, body).map_err(|error| self.refused(&error))
    }

    /// The same for an answer that takes longer.
    pub(crate) fn request_within(
        &self,
        patience: Duration,
        method: &str,
        path: &str,
        body: &str,
    ) -> Result<Response, Exit> {
        let client = self.client()?;
        client.request_within(patience, method, path, body).map_err(|error| self.refused(&error))
    }

    /// The answer to a request as JSON.
    pub(crate) fn ask(&self, method: &str, path: &str, body: &str) -> Result<Value, Exit> {
        self.request(method, path, body)?.json().map_err(|error| self.refused(&error))
    }

    fn refused(&self, error: &ClientError) -> Exit {
        self.refuse(&error.to_string(), Exit::WrongInput)
    }

    /// Reports what hinders the command.
    pub(crate) fn refuse(&self, message: &str, exit: Exit) -> Exit {
        match self.format {
            Format::Human => eprint(&format!("error: {message}\n")),
            Format::Json => eprint_json(&serde_json::json!({"error": message})),
        }
        exit
    }

    /// Prints the answer: as JSON, or in these words.
    pub(crate) fn show(&self, answer: &Value, words: impl FnOnce() -> String) {
        match self.format {
            Format::Human => crate::output::print(&words()),
            Format::Json => print_json(answer),
        }
    }
}

/// The name that no other fleet has.
pub(crate) fn unique(fleet: &FleetDescription) -> String {
    format!("{}-{}", fleet.name, fleet.pid)
}

/// Why it is not clear which fleet is meant.
fn unclear(name: Option<&str>, has_several: bool, all: &[(Client, FleetDescription)]) -> String {
    let names: Vec<String> = all.iter().map(|(_, one)| one_line(&unique(one)).into_owned()).collect();
    let list = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    match (name, &names[..]) {
        (None, []) => "no fleet runs on this machine\n  = help: start one with `saoms run`".to_owned(),
        (None, [first, ..]) => {
            format!("several fleets run on this machine: {list}\n  = help: choose one, as with `--fleet {first}`")
        }
        (Some(name), []) => format!("there is no fleet `{name}`: no fleet runs on this machine"),
        (Some(name), _) if has_several => {
            let meant = all.iter().filter(|(_, one)| one.name == name).map(|(_, one)| format!("`{}`", unique(one)));
            let meant = meant.collect::<Vec<_>>().join(", ");
            format!("several fleets have the name `{name}`: {meant}\n  = help: write the name with its process")
        }
        (Some(name), _) => {
            let known = all.iter().map(|(_, one)| one.name.as_str());
            match nearest(name, known) {
                Some(near) => format!("there is no fleet `{name}`; did you mean `{near}`?"),
                None => format!("there is no fleet `{name}`; the fleets of this machine are {list}"),
            }
        }
    }
}

/// A name as a part of a path of HTTP.
pub(crate) fn escape(name: &str) -> String {
    let mut escaped = String::with_capacity(name.len());
    for byte in name.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' => escaped.push(char::from(byte)),
            _ => escaped.push_str(&format!("%{byte:02X}")),
        }
    }
    escaped
}

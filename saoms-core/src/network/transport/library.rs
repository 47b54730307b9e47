use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use saoms_abi::{TRANSPORT_SECTION, TRANSPORT_VERSION, TopicTransportTable, TransportTable};
use serde::Deserialize;

use super::error::shown;
use super::session::judge;
use super::{SessionSettings, SettingFault, TransportError};
use crate::plugin::{PluginError, beside_the_program, libraries, load_table, read_section};

/// What a transport carries that is not for what our programs say to each other.
const TOPICS: &str = "topics";

/// What the metadata of a transport say.
#[derive(Clone, Debug, Deserialize)]
pub struct TransportInfo {
    /// The name of its library.
    #[serde(default)]
    pub package: String,
    /// The version of its library.
    #[serde(default)]
    pub version: String,
    /// The schemes of the urls that it serves; an empty one is `host:port`.
    pub schemes: Vec<String>,
    /// `topics` where it carries the topics of programs that do not speak our language.
    #[serde(default)]
    carries: Option<String>,
    entry: String,
}

/// A transport that is loaded.
#[derive(Clone, Copy, Debug)]
pub struct Transport {
    pub(super) table: &'static TransportTable,
}

/// A transport that is loaded, of topics of programs that do not speak our language.
#[derive(Clone, Copy, Debug)]
pub struct TopicTransport {
    pub(super) table: &'static TopicTransportTable,
}

/// What serves a url.
#[derive(Clone, Copy, Debug)]
pub enum Carrier {
    /// A transport for what our programs say to each other.
    Messages(Transport),
    /// A transport of topics of other programs.
    Topics(TopicTransport),
}

/// The scheme of a url; empty for `host:port`.
pub fn scheme(url: &str) -> &str {
    url.split_once("://").map_or("", |(scheme, _)| scheme)
}

/// The programs of a network without a router, each with its name and where it listens, if its url names them.
pub fn peers(url: &str) -> Option<impl Iterator<Item = (&str, &str)>> {
    let (scheme, list) = url.split_once("://")?;
    let named = list.split(',').map(|peer| peer.split_once('=').unwrap_or(("", peer)));
    matches!(scheme, "peers" | "peers+tls").then_some(named)
}

impl Transport {
    #[cfg(test)]
    pub(in crate::network) fn of(table: &'static TransportTable) -> Transport {
        Transport { table }
    }

    /// The transport for a url, as [`Carrier::find`] finds it.
    ///
    /// # Errors
    /// There is none, it cannot be loaded, or it carries the topics of other programs.
    pub fn find(url: &str, named: &[PathBuf]) -> Result<Transport, TransportError> {
        match Carrier::find(url, named)? {
            Carrier::Messages(transport) => Ok(transport),
            Carrier::Topics(_) => Err(TransportError::Topics { scheme: scheme(url).to_owned() }),
        }
    }

    /// The urls that the libraries beside the program serve, as messages show them. What cannot be used serves none.
    pub fn served_beside_the_program() -> BTreeSet<String> {
        let libraries = beside_the_program().into_iter().flat_map(|place| libraries_at(&place));
        let infos = libraries.filter_map(|path| TransportInfo::read(&path).ok().flatten());
        infos.flat_map(|info| info.shown_schemes()).collect()
    }
}

impl TopicTransport {
    #[cfg(test)]
    pub(in crate::network) fn of(table: &'static TopicTransportTable) -> TopicTransport {
        TopicTransport { table }
    }
}

impl Carrier {
    /// The transport for a url: from the places that the user named (libraries or folders), then from where libraries
    /// lie beside the program.
    ///
    /// # Errors
    /// There is none, or it cannot be loaded.
    pub fn find(url: &str, named: &[PathBuf]) -> Result<Carrier, TransportError> {
        let scheme = scheme(url);
        let searched: Vec<PathBuf> = named.iter().cloned().chain(beside_the_program()).collect();
        let mut known = BTreeSet::new();
        for path in searched.iter().flat_map(|place| libraries_at(place)) {
            let info = match TransportInfo::read(&path) {
                Ok(Some(info)) => info,
                Ok(None) => continue,
                Err(error) => return Err(error),
            };
            if info.schemes.iter().any(|one| one == scheme) {
                return Carrier::load(&path, &info);
            }
            known.extend(info.shown_schemes());
        }
        let (scheme, known) = (scheme.to_owned(), known.into_iter().collect());
        Err(TransportError::Missing { scheme, searched, known, installed: beside_the_program().pop() })
    }

    fn load(path: &Path, info: &TransportInfo) -> Result<Carrier, TransportError> {
        if info.carries.is_some() {
            let (version, size) =
                (|table: &TopicTransportTable| table.version, |table: &TopicTransportTable| table.size);
            let table = loaded::<TopicTransportTable>(path, info, version, size)?;
            return Ok(Carrier::Topics(TopicTransport { table }));
        }
        let table = loaded::<TransportTable>(path, info, |table| table.version, |table| table.size)?;
        Ok(Carrier::Messages(Transport { table }))
    }

    /// Looks at settings without joining the network: what cannot be used, and why.
    pub fn judge(self, settings: &SessionSettings) -> Vec<SettingFault> {
        match self {
            Carrier::Messages(transport) => transport.judge(settings),
            Carrier::Topics(transport) => judge(transport.table.judge, settings),
        }
    }
}

/// The table of a library, if it is of this version.
fn loaded<T>(
    path: &Path,
    info: &TransportInfo,
    version: impl Fn(&T) -> u32,
    size: impl Fn(&T) -> usize,
) -> Result<&'static T, TransportError> {
    let loaded = load_table::<T>(path, &info.package, &info.entry, TRANSPORT_VERSION);
    let (_, table) = loaded.map_err(TransportError::Library)?;
    let unloadable = |message: &str| {
        let (path, package) = (path.to_owned(), info.package.clone());
        TransportError::Library(PluginError::Unloadable { path, package, message: message.to_owned() })
    };
    // SAFETY: by the rules of the boundary the table is null or constant.
    let table = unsafe { table.as_ref() }.ok_or_else(|| unloadable("it returns no table"))?;
    if version(table) != TRANSPORT_VERSION || size(table) < size_of::<T>() {
        return Err(unloadable("its code and its metadata are not from the same build"));
    }
    Ok(table)
}

impl TransportInfo {
    /// The urls that it serves, as messages show them.
    fn shown_schemes(&self) -> Vec<String> {
        self.schemes.iter().map(|scheme| shown(scheme)).collect()
    }

    /// The metadata of a library; `None` where it is no transport.
    fn read(path: &Path) -> Result<Option<TransportInfo>, TransportError> {
        #[derive(Deserialize)]
        struct Head {
            saoms: String,
            abi: u32,
        }
        let text = match read_section(path, TRANSPORT_SECTION) {
            Ok(text) => text,
            Err(PluginError::NoMetadata { .. } | PluginError::NoLibrary { .. }) => return Ok(None),
            Err(error) => return Err(TransportError::Library(error)),
        };
        let malformed = |message: String| TransportError::Metadata { path: path.to_owned(), message };
        // The version first: metadata of another version may have another shape.
        let head: Head = serde_json::from_str(&text).map_err(|error| malformed(error.to_string()))?;
        if head.saoms != "transport" {
            return Err(malformed(format!("found `{}` for `saoms`, expected `transport`", head.saoms)));
        }
        if head.abi != TRANSPORT_VERSION {
            let (path, found, expected) = (path.to_owned(), head.abi, TRANSPORT_VERSION);
            return Err(TransportError::Version { path, found, expected });
        }
        let info: TransportInfo = serde_json::from_str(&text).map_err(|error| malformed(error.to_string()))?;
        match info.carries.as_deref().filter(|carries| *carries != TOPICS) {
            Some(found) => Err(malformed(format!("found `{found}` for `carries`, expected `{TOPICS}`"))),
            None => Ok(Some(info)),
        }
    }
}

/// The libraries of a place: a folder, or a library itself.
fn libraries_at(place: &Path) -> Vec<PathBuf> {
    if place.is_file() { vec![place.to_owned()] } else { libraries(place) }
}

//! `saoms --version`: which build this is, and what it loads.

use saoms_core::network::transport::Transport;

/// What `--version` prints behind the name; `-V` prints the first line alone.
pub(super) const BUILD: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\ncommit: ",
    env!("SAOMS_BUILD_COMMIT"),
    "\ntarget: ",
    env!("SAOMS_BUILD_TARGET")
);

/// What follows: the versions of the boundaries to libraries, and the urls that transports beside the program serve.
pub(super) fn libraries() -> String {
    let served: Vec<String> = Transport::served_beside_the_program().into_iter().collect();
    let served = if served.is_empty() { "none was found".to_owned() } else { served.join(", ") };
    let (plugins, transports) = (saoms_abi::VERSION, saoms_abi::TRANSPORT_VERSION);
    format!("plugins: version {plugins} of the boundary\ntransports: version {transports} of the boundary, {served}\n")
}

//! Control of running fleets: a server in the program of a fleet, and its client.
//!
//! The server speaks HTTP on a Unix socket of the user, and on the network for clients with its token. It has threads
//! of its own: the timer of the fleet never waits for it. `openapi` describes its routes. Commands such as
//! `saoms status` use the [`Client`]; so does any program that speaks HTTP, such as `curl --unix-socket`. Browsers get
//! the dashboard at `/`, which uses the same routes.

mod alerts;
mod change;
mod client;
mod content;
mod counts;
mod date;
mod description;
mod figures;
mod http;
mod log;
mod metrics;
mod network;
mod place;
mod recording;
mod server;
mod token;
mod topics;
mod web;

pub use alerts::{Acknowledgement, Alert, AlertList, AlertTarget};
pub use change::{ChangeAnswer, ChangeFailure, ChangeRequest};
pub use client::{Client, ClientError, Response, running};
pub use counts::LossCounts;
pub use date::date;
pub use description::FleetDescription;
pub use figures::FigureWatch;
pub use log::{LogLine, LogTail};
pub use metrics::{METRICS, Metric};
pub use network::{NetworkError, NetworkListener};
pub use place::{Listener, default_socket, token_beside, view_token_beside};
pub use recording::{FinishedRun, Recorder, RunReadError};
pub use server::{ControlServer, ControlledFleet, NetworkDoor, Places, SentLine, ViewServer, openapi, refuse};
pub use token::{Token, TokenFile, Tokens};
pub use topics::TopicWatch;
pub use web::HttpClient;

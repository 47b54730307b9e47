use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::body::Bytes;
use saoms_core::schedule::Handle;
use serde_json::json;

use super::connections::ClientCounts;
use crate::description::FleetDescription;
use crate::log::LogTail;
use crate::topics::TopicWatch;

/// Time for which a snapshot is given to further clients.
const FRESH: Duration = Duration::from_millis(100);

/// Code that lets the events of a line happen, and gives their number or what is wrong.
type SendLine = dyn Fn(&str) -> Result<u64, String> + Send + Sync;

/// A fleet and what can be done with it.
pub struct ControlledFleet {
    /// How it introduces itself.
    pub(super) description: FleetDescription,
    /// Its remote control.
    pub(super) handle: Handle,
    /// Its log.
    pub(super) log: Arc<LogTail>,
    /// What passes the messages of its topics on.
    pub(super) topics: Arc<TopicWatch>,
    /// Lets the events of a line happen; gives their number, or what is wrong.
    pub(super) send: Box<SendLine>,
    /// Ends the fleet.
    pub(super) down: Box<dyn Fn() + Send + Sync>,
    /// What is counted of its clients.
    pub(super) counts: Arc<ClientCounts>,
    /// The last snapshot and its time.
    snapshot: Mutex<Option<(Instant, Bytes)>>,
}

impl ControlledFleet {
    /// A fleet with its remote control, its log and its topics, which are observers of it. `send` lets the events of a
    /// line happen, and gives their number or what is wrong; `down` ends the fleet.
    pub fn new(
        description: FleetDescription,
        handle: Handle,
        (log, topics): (Arc<LogTail>, Arc<TopicWatch>),
        send: impl Fn(&str) -> Result<u64, String> + Send + Sync + 'static,
        down: impl Fn() + Send + Sync + 'static,
    ) -> ControlledFleet {
        let (send, down) = (Box::new(send), Box::new(down));
        ControlledFleet {
            description,
            handle,
            log,
            topics,
            send,
            down,
            counts: Arc::default(),
            snapshot: Mutex::default(),
        }
    }

    /// The snapshot, if it is new enough.
    pub(super) fn cached(&self) -> Option<Bytes> {
        let snapshot = self.snapshot.lock().unwrap_or_else(PoisonError::into_inner);
        snapshot.as_ref().filter(|(at, _)| at.elapsed() < FRESH).map(|(_, bytes)| bytes.clone())
    }

    /// A snapshot as JSON. However many clients ask, the fleet is asked once.
    pub(super) fn snapshot(&self) -> Bytes {
        let mut snapshot = self.snapshot.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((at, bytes)) = &*snapshot
            && at.elapsed() < FRESH
        {
            return bytes.clone();
        }
        let bytes = Bytes::from(json!({"fleet": self.description, "status": self.handle.status()}).to_string());
        *snapshot = Some((Instant::now(), bytes.clone()));
        bytes
    }
}

impl fmt::Debug for ControlledFleet {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("ControlledFleet").field("description", &self.description).finish_non_exhaustive()
    }
}

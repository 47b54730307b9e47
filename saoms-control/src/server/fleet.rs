use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::body::Bytes;
use saoms_core::schedule::{Handle, OrderTicket};
use serde_json::json;

use super::connections::ClientCounts;
use crate::description::FleetDescription;
use crate::log::LogTail;
use crate::topics::TopicWatch;

/// Time for which a snapshot is given to further clients.
const FRESH: Duration = Duration::from_millis(100);

/// Code that takes a line of events or an order, and says what is wrong with it.
type SendLine = dyn Fn(&str) -> Result<SentLine, String> + Send + Sync;

/// A line that was taken.
#[derive(Debug)]
pub enum SentLine {
    /// So many events happen.
    Events(i64),
    /// An order takes effect at the next instant.
    Order(OrderTicket),
}

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
    /// Takes a line of events, or an order.
    pub(super) send: Box<SendLine>,
    /// Ends the fleet.
    pub(super) down: Box<dyn Fn() + Send + Sync>,
    /// What is counted of its clients.
    pub(super) counts: Arc<ClientCounts>,
    /// The last snapshot and its time.
    snapshot: Mutex<Option<(Instant, Bytes)>>,
}

impl ControlledFleet {
    /// A fleet with its remote control, its log and its topics, which are observers of it. `send` takes a line
    /// of events or an order, or says what is wrong with it; `down` ends the fleet.
    pub fn new(
        description: FleetDescription,
        handle: Handle,
        (log, topics): (Arc<LogTail>, Arc<TopicWatch>),
        send: impl Fn(&str) -> Result<SentLine, String> + Send + Sync + 'static,
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

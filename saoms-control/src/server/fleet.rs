use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::body::Bytes;
use saoms_core::schedule::{ChangeWithdrawal, Handle, OfferedService, OrderTicket};
use saoms_core::status::FleetStatus;
use serde_json::json;
use tokio::sync;

use super::answer::{Refusal, waiting};
use super::services::CallPlaces;
use crate::alerts::AlertList;
use crate::change::{ChangeAnswer, ChangeRequest};
use crate::counts::{ClientCounts, LossCounts};
use crate::description::FleetDescription;
use crate::figures::FigureWatch;
use crate::log::LogTail;
use crate::metrics::{self, Measured};
use crate::topics::TopicWatch;

/// Time for which a snapshot is given to further clients.
const FRESH: Duration = Duration::from_millis(100);

/// Code that takes a line of events or an order, and says what is wrong with it.
type SendLine = dyn Fn(&str) -> Result<SentLine, String> + Send + Sync;

/// Code that draws the composites, or says why it cannot.
type DrawPicture = dyn Fn() -> Result<String, String> + Send + Sync;

/// Code that reads the files of a wanted fleet, and says what would change, or also changes it. An error is one of the
/// program.
type ChangeFleet = dyn Fn(ChangeRequest, Option<ChangeWithdrawal>) -> Result<ChangeAnswer, String> + Send + Sync;

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
    description: Mutex<FleetDescription>,
    /// Its remote control.
    pub(super) handle: Handle,
    /// Its log.
    pub(super) log: Arc<LogTail>,
    /// Its alerts.
    pub(super) alerts: Arc<AlertList>,
    /// What passes the messages of its topics on.
    pub(super) topics: Arc<TopicWatch>,
    /// Takes a line of events, or an order.
    pub(super) send: Box<SendLine>,
    /// Ends the fleet.
    pub(super) down: Box<dyn Fn() + Send + Sync>,
    /// Draws its composites.
    pub(super) picture: Box<DrawPicture>,
    /// Says what the files of a client would change, or changes it.
    pub(super) change: Box<ChangeFleet>,
    /// What is counted of its clients.
    pub(super) counts: Arc<ClientCounts>,
    /// Its figures over time.
    pub(super) figures: Arc<FigureWatch>,
    /// What could not be written to the files of the run.
    losses: LossCounts,
    /// The last snapshot, as text and as it is compared with the one before.
    pub(super) snapshot: Kept<Bytes>,
    pub(super) status: Kept<Arc<FleetStatus>>,
    /// The last metrics.
    pub(super) metrics: Kept<Bytes>,
    /// The services that are offered over the web.
    pub(super) services: Kept<Arc<[OfferedService]>>,
    pub(super) call_places: CallPlaces,
}

impl ControlledFleet {
    /// A fleet with its remote control, its log, its topics and its alerts, which are observers of it. `send`
    /// takes a line of events or an order, or says what is wrong with it; `down` ends the fleet.
    pub fn new(
        description: FleetDescription,
        handle: Handle,
        (log, topics, alerts): (Arc<LogTail>, Arc<TopicWatch>, Arc<AlertList>),
        send: impl Fn(&str) -> Result<SentLine, String> + Send + Sync + 'static,
        down: impl Fn() + Send + Sync + 'static,
    ) -> ControlledFleet {
        let (send, down) = (Box::new(send), Box::new(down));
        ControlledFleet {
            description: Mutex::new(description),
            handle,
            log,
            topics,
            alerts,
            send,
            down,
            picture: Box::new(|| Err("this program cannot draw its composites".to_owned())),
            change: Box::new(|_, _| Err("this program cannot change its fleet".to_owned())),
            counts: Arc::default(),
            figures: Arc::new(FigureWatch::new(true)),
            losses: LossCounts::default(),
            snapshot: Kept::default(),
            status: Kept::default(),
            metrics: Kept::default(),
            services: Kept::default(),
            call_places: CallPlaces::default(),
        }
    }

    /// The same fleet, with its figures, which are an observer of it.
    #[must_use]
    pub fn with_figures(self, figures: Arc<FigureWatch>) -> ControlledFleet {
        ControlledFleet { figures, ..self }
    }

    /// The same fleet, with the counts of what could not be written to the files of its run.
    #[must_use]
    pub fn with_losses(self, losses: LossCounts) -> ControlledFleet {
        ControlledFleet { losses, ..self }
    }

    /// The same fleet, with code that draws its composites when somebody wants to see them.
    #[must_use]
    pub fn with_picture(self, draw: impl Fn() -> Result<String, String> + Send + Sync + 'static) -> ControlledFleet {
        ControlledFleet { picture: Box::new(draw), ..self }
    }

    /// The same fleet, with code that reads the files of a wanted fleet: it says what would change, or also changes it
    /// where there is a way to take that back.
    #[must_use]
    pub fn with_changes(
        self,
        change: impl Fn(ChangeRequest, Option<ChangeWithdrawal>) -> Result<ChangeAnswer, String> + Send + Sync + 'static,
    ) -> ControlledFleet {
        ControlledFleet { change: Box::new(change), ..self }
    }

    /// How it introduces itself.
    pub(super) fn description(&self) -> FleetDescription {
        self.description.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// It is the fleet of these composites from now on.
    pub(super) fn now_has(&self, composites: Vec<String>) {
        self.description.lock().unwrap_or_else(PoisonError::into_inner).composites = composites;
    }

    /// A snapshot as JSON.
    pub(super) fn snapshot_text(&self) -> String {
        json!({"fleet": self.description(), "status": self.handle.status(), "alerts": self.alerts.waiting()})
            .to_string()
    }

    /// The metrics as text.
    pub(super) fn metrics_text(&self) -> String {
        let fleet = self.handle.metrics();
        let ControlledFleet { counts: clients, losses, .. } = self;
        let description = &self.description();
        metrics::text(&Measured { description, fleet: &fleet, clients, losses, alerts: self.alerts.counts() })
    }
}

/// An answer that is given to all who ask within a short time: however many clients ask, the fleet is asked once.
pub(super) struct Kept<T>(sync::Mutex<Option<(Instant, T)>>);

impl<T> Default for Kept<T> {
    fn default() -> Kept<T> {
        Kept(sync::Mutex::default())
    }
}

impl<T: Clone + Send + 'static> Kept<T> {
    /// The answer if it is new enough, or else a new one, which is made beside the thread of the server.
    pub(super) async fn get<M: Into<T> + Send + 'static>(
        &self,
        make: impl FnOnce() -> M + Send + 'static,
    ) -> Result<T, Refusal> {
        // Who asks meanwhile waits for the same answer.
        let mut kept = self.0.lock().await;
        if let Some((at, answer)) = &*kept
            && at.elapsed() < FRESH
        {
            return Ok(answer.clone());
        }
        let answer: T = waiting(make).await?.into();
        *kept = Some((Instant::now(), answer.clone()));
        Ok(answer)
    }

    /// Forgets the answer: the next one is made anew.
    pub(super) async fn forget(&self) {
        *self.0.lock().await = None;
    }
}

impl fmt::Debug for ControlledFleet {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("ControlledFleet").field("description", &self.description()).finish_non_exhaustive()
    }
}
